"""One mapping: what a parameter file says to the nodes, it says to every verb that reads a bag."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml

from winch_friction.cli import main
from winch_friction.nodes.options import NodeOptions
from winch_friction.physics.errors import InputError, from_mapping
from winch_friction.physics.signals import Run
from winch_friction.records.bag_write import write_bag
from winch_friction.records.crane_file import load_crane
from winch_friction.records.input_mapping import InputMapping, bag_options_of
from winch_friction.records.runs import read_run
from winch_friction.replay.recording import replay_recording
from winch_friction.replay.settings import settings_from_file
from winch_friction.simulation.scenario import load_scenario
from winch_friction.simulation.simulator import simulate

CRANE = load_crane("crane_150t")
CONVENTIONS = {
    "speed_joint": "hoist_shaft",
    "swash_joint": "swash_of_{group}",
    "float64_inputs": ["active.pressure_a", "active.displacement", "speed_reference"],
    "pressure_reference": "absolute",
}


@pytest.fixture(scope="module")
def run(crane2_model) -> Run:
    return simulate(load_scenario("ahc_irregular").override({"duration": 6.0}), CRANE, crane2_model, seed=3).run


@pytest.fixture
def params(tmp_path: Path) -> Path:
    file = tmp_path / "nodes.yaml"
    file.write_text(yaml.safe_dump({"/**": {"ros__parameters": CONVENTIONS}}))
    return file


def _live(**more: object) -> InputMapping:
    content = {key: tuple(v) if isinstance(v, list) else v for key, v in {**CONVENTIONS, **more}.items()}
    return from_mapping(NodeOptions, content, "test")


def test_a_bag_of_other_joints_and_plain_floats_reads_by_the_nodes_own_file(run: Run, params: Path, tmp_path: Path):
    bag = write_bag(run, tmp_path / "bag", _live().topics(CRANE))
    back = read_run(bag, CRANE, **bag_options_of(params))
    for column in ("motor_speed", "active.pressure_a", "active.displacement", "passive.displacement"):
        np.testing.assert_allclose(back[column], run[column], rtol=1e-9, err_msg=column)


def test_such_a_bag_replays_with_the_parameter_file_that_works_live(
    run: Run, params: Path, tmp_path: Path, crane2_model
):
    bag = write_bag(run, tmp_path / "bag", _live().topics(CRANE))
    replayed = replay_recording(bag, CRANE, crane2_model, settings_from_file(params), **bag_options_of(params))
    assert len(replayed.compensator) == len(run)
    assert (replayed.compensator.aside["state"] == "active").sum() > 100


def test_convert_takes_the_parameter_file(run: Run, params: Path, tmp_path: Path):
    bag, out = write_bag(run, tmp_path / "bag", _live().topics(CRANE)), tmp_path / "out.csv"
    arguments = ["convert", "run", str(bag), str(out), "--crane", "crane_150t"]
    assert main.run([*arguments, "--params-file", str(params)]) == 0
    np.testing.assert_allclose(read_run(out, CRANE)["motor_speed"], run["motor_speed"], rtol=1e-9)
    assert main.run(arguments) == 2  # without it there is no such joint


def test_conventions_in_the_estimators_section_hold_too(params: Path, tmp_path: Path):
    both, one = tmp_path / "both.yaml", {"ros__parameters": {**CONVENTIONS, "pressure_reference": "gauge"}}
    both.write_text(yaml.safe_dump({"/winch/estimator": {"ros__parameters": CONVENTIONS}}))
    assert bag_options_of(both) == bag_options_of(params)
    both.write_text(yaml.safe_dump({"estimator": {"ros__parameters": CONVENTIONS}, "compensator": one}))
    assert bag_options_of(both)["pressure_reference"] == "gauge"


def test_the_drum_by_its_own_name(run: Run, tmp_path: Path):
    mapping = _live(speed_joint="drum", drum_joint="drum")
    bag = write_bag(run, tmp_path / "bag", mapping.topics(CRANE))
    back = read_run(bag, CRANE, **mapping.joints())
    np.testing.assert_allclose(back["motor_speed"], run["motor_speed"], rtol=1e-9)


def test_what_is_no_parameter_file_is_refused(tmp_path: Path):
    file = tmp_path / "x.yaml"
    file.write_text("/**:\n  groups: 3\n")
    with pytest.raises(InputError, match="ros__parameters"):
        bag_options_of(file)
    assert bag_options_of(None) == {}
    assert replace(InputMapping(), groups=("main",)).topics(CRANE).groups == ("main",)
