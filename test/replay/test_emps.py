"""Real measured input: the EMPS drive's file becomes a bag, and the bag goes through estimator and compensator."""

import numpy as np
import pytest
from scipy.integrate import trapezoid

from winch_friction.compensation import FeedforwardCompensator
from winch_friction.physics.errors import InputError
from winch_friction.records.crane_file import load_crane
from winch_friction.records.emps import FORCE_GAIN, read_emps
from winch_friction.records.model_file import load_model
from winch_friction.records.runs import read_run, write_run
from winch_friction.records.strict_yaml import config_directory
from winch_friction.replay.compensator import replay_compensator
from winch_friction.replay.recording import replay_recording
from winch_friction.replay.settings import settings_from_file

PUBLISHED = {"C2": 20.39, "C5": 203.5}
INERTIA = 95.109  # kg, published
EDGE = 50  # samples that the zero-phase filter needs to settle at either end


@pytest.fixture(scope="module")
def emps(shared_data):
    return read_emps(shared_data / "emps" / "DATA_EMPS.mat")


@pytest.fixture(scope="module")
def settings():
    return settings_from_file(config_directory() / "nodes" / "emps.yaml")


@pytest.mark.shared
def test_the_file_is_read_as_the_authors_mean_it(emps, shared_data, tmp_path):
    assert len(emps) == 24841
    assert np.abs(emps["motor_torque"]).max() == pytest.approx(152, abs=1)
    moved = trapezoid(emps["motor_speed"], emps.time)
    assert moved == pytest.approx(emps["shaft_angle"][-1] - emps["shaft_angle"][0], abs=1e-4)
    causal = read_emps(shared_data / "emps" / "DATA_EMPS.mat", causal=True)
    lags = [np.std(np.roll(emps["motor_speed"], k)[99:-99] - causal["motor_speed"][99:-99]) for k in range(10)]
    assert np.argmin(lags) in (4, 5)
    assert FORCE_GAIN == 35.1507
    with pytest.raises(InputError, match="MATLAB"):
        read_emps(shared_data / "README.md")


@pytest.fixture(scope="module")
def bag(emps, tmp_path_factory):
    return write_run(emps, tmp_path_factory.mktemp("emps") / "emps_bag")


@pytest.mark.shared
def test_the_bag_holds_what_the_file_holds(emps, bag):
    back = read_run(bag, load_crane("emps"))
    for column in ("motor_speed", "motor_torque", "speed_reference", "shaft_angle"):
        np.testing.assert_allclose(back[column], emps[column], rtol=1e-12)


@pytest.fixture(scope="module")
def learned(bag, settings):
    """One pass over the bag from a seed 30 % off."""
    seed = load_model("emps_symmetric").with_values({"C2": 0.7 * 20.39, "C5": 0.7 * 203.5, "T_0": 0.0})
    return replay_recording(bag, load_crane("emps"), seed, settings)


@pytest.mark.shared
@pytest.mark.slow
def test_one_pass_finds_the_published_friction(learned):
    for each in learned.parameters:
        if each.name in PUBLISHED:
            assert each.value == pytest.approx(PUBLISHED[each.name], rel=0.05)
            assert abs(each.value - PUBLISHED[each.name]) < 2.0 * each.std
            assert each.status == "learned"


@pytest.mark.shared
@pytest.mark.slow
def test_inertia_offset_and_friction_explain_the_force(emps, learned, settings):
    compensator = FeedforwardCompensator(load_crane("emps"), learned.model, settings.phases[0].config)
    friction = replay_compensator(emps, compensator)["friction_torque"] + learned.model.value("T_0")
    force = emps["motor_torque"]
    left = (force - INERTIA * np.gradient(emps["motor_speed"], emps.time) - friction)[EDGE:-EDGE]
    assert np.linalg.norm(left) / np.linalg.norm(force[EDGE:-EDGE]) < 0.045
