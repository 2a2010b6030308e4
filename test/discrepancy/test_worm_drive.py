"""A small drive at one load and many steady speeds: an encoder that hardly counts, torques of a thousandth N m."""

from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy.answer import GapOptions
from winch_friction.discrepancy.preparation.seen import at_one_speed
from winch_friction.discrepancy.workflow import find_gap
from winch_friction.importing.carry_out import import_log
from winch_friction.importing.mapping import load_map
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model
from winch_friction.records.strict_yaml import config_directory

EXAMPLE = config_directory() / "examples" / "worm_drive"
STEP = 0.105  # rad/s, of the encoder


def counted(speed, seed=0):
    """What an encoder makes of a speed: whole steps, the next one by chance as its mean wants it."""
    return STEP * np.floor(np.asarray(speed) / STEP + np.random.default_rng(seed).uniform(size=np.size(speed)))


@pytest.mark.parametrize("speed", [0.1, -0.2, 2.0])
def test_a_steady_speed_is_known_from_the_whole_record(speed):
    assert at_one_speed(counted(np.full(500, speed)))


def test_standstill_and_a_speed_that_changes_are_no_steady_speed():
    time = np.arange(0.0, 50.0, 0.1)
    assert not at_one_speed(counted(np.zeros(500)) - 0.0)
    assert not at_one_speed(0.05 * np.random.default_rng(1).standard_normal(500))
    assert not at_one_speed(counted(2.0 + np.sin(2.0 * np.pi * time / 10.0)))


def named(logs):
    """Names, and their sets, that `gap` gives for logs of the worm drive."""
    crane, given = load_crane("worm_drive"), load_map(EXAMPLE / "map.yaml")
    runs = [import_log(path, given, crane) for path in logs]
    found = find_gap(runs, crane, load_model("worm_viscous"), GapOptions(plan=False)).content()
    return found, [{each["name"], *each["indistinguishable_from"]} for each in found["effects"]]


@pytest.mark.shared
def test_friction_of_the_real_worm_is_named_with_its_structural_rivals(shared_data):
    """Published: Coulomb, viscous, Stribeck, and thread friction that goes with the load and the direction; one load
    was run."""
    logs = sorted((shared_data / "worm_drive" / "steady_state").glob("*/*.csv"))
    found, sets = named(logs)
    assert any({"coulomb", "gear_load_loss", "stribeck"} <= each for each in sets)
    assert any({"torque_offset", "gear_asymmetry"} <= each for each in sets)
    assert not {"brake_drag", "wear_drift", "viscosity_temperature", "inertia_error"} & set().union(*sets)
    assert found["verdict"] == "ambiguous"
    assert found["gap"]["holdout"]["relative_after"] < 0.2


@pytest.mark.parametrize("kind", ["electric", "power"])
def test_what_reads_pressures_is_said_of_any_drive_without_them(kind):
    """A drive known by its power was told that an electric drive has none."""
    from winch_friction.discrepancy.candidates.candidate import Candidate

    run = SimpleNamespace(present=frozenset({"motor_speed", kind}), groups=())
    wanted = Candidate("case_pressure", "c", (), list, list, kind="signal", hydraulic=True)
    assert wanted.untestable([run]).because == "only a hydraulic drive has them"
