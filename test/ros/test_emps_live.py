"""Measured data over DDS: the EMPS drive through the real nodes, equal to the same steps without ROS."""

from pathlib import Path

import numpy as np
import pytest
from dds_bench import Bench, efforts, stamps

from winch_friction.compensation import FeedforwardCompensator
from winch_friction.estimation import FrictionEstimator
from winch_friction.nodes.inputs import ROS
from winch_friction.nodes.qos import OUTPUT
from winch_friction.records.crane_file import load_crane
from winch_friction.records.emps import read_emps
from winch_friction.records.model_file import load_model
from winch_friction.records.strict_yaml import config_directory
from winch_friction.records.topics import crane_topics, whole_nanoseconds
from winch_friction.replay.settings import settings_from_file

SAMPLES = 1500
PARAMETERS = config_directory() / "nodes" / "emps.yaml"


@pytest.mark.shared
def test_measured_samples_give_the_same_live_and_replayed(bench: Bench, shared_data: Path) -> None:
    crane, seed = load_crane("emps"), load_model("emps_viscous")
    run = read_emps(shared_data / "emps" / "DATA_EMPS.mat")
    given = [each for each, _ in zip(run.samples(), range(SAMPLES), strict=False)]
    common = {"model_file": "emps_viscous", "watchdog_timeout": 60.0}
    bench.start("compensator", "--params-file", str(PARAMETERS), follow_model_topic=False, **common)
    bench.start("estimator", "--params-file", str(PARAMETERS), **common)
    fed, learned = (bench.listen(f"{node}/friction_torque") for node in ("compensator", "estimator"))
    topics = crane_topics(crane)
    publishers = {}
    for topic, message in topics.encode(given[0], ROS):
        publishers[topic] = bench.node.create_publisher(type(message), topic, OUTPUT)
    everyone = lambda: all(each.get_subscription_count() == 2 for each in publishers.values())
    assert bench.spin(40.0, everyone)
    bench.spin(0.5)
    for number, sample in enumerate(given, 1):
        sample.time = whole_nanoseconds(sample.time)
        for topic, message in topics.encode(sample, ROS):
            publishers[topic].publish(message)
        answered = lambda n=number: len(fed) >= n and len(learned) >= n
        assert bench.spin(5.0, answered), f"no answer to sample {number}"
    settings = settings_from_file(PARAMETERS)
    compensator = FeedforwardCompensator(crane, seed, settings.phases[0].config)
    estimator = FrictionEstimator(crane, seed, settings.estimator)
    expected = np.array([(compensator.step(s).friction_torque, estimator.step(s).friction_torque) for s in given])
    assert stamps(fed) == [sample.time for sample in given]
    np.testing.assert_allclose(efforts(fed), expected[:, 0], rtol=1e-9, atol=1e-12)
    finite = np.isfinite(expected[:, 1])
    np.testing.assert_allclose(np.array(efforts(learned))[finite], expected[finite, 1], rtol=1e-9, atol=1e-12)
    assert finite.sum() > 0.9 * SAMPLES
