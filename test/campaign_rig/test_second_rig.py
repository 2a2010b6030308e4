"""The second rig shares nothing with package and first rig, obeys the balance of torques, and goes the user's path."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from imported import imported

from campaign import second_rig
from campaign.second import _outcome, command, diagnose, in_turn
from campaign.second_report import write_table
from campaign.second_rig import SETS, write_set
from campaign.second_rig.sets import EFFECT, LOAD_CELL, NULL, OUTSIDE, PAIR
from campaign.second_rig.voyages import Logging

FOREIGN = ("winch_friction", "campaign.rig")
SILENT = Logging(
    rate=50.0, pressure_noise=0.0, pressure_range=0.01, pulses=10**7, displacement_noise=0.0,
    displacement_steps=10**9, load_noise=0.0, load_steps=10**9, time_noise=0.0,
)  # fmt: skip


def test_the_second_rig_imports_nothing_of_the_package_or_of_the_first_rig():
    for path in Path(second_rig.__file__).parent.glob("*.py"):
        for name in imported(path):
            assert not any(f"{name}.".startswith(f"{foreign}.") for foreign in FOREIGN), (path, name)


def test_no_file_is_longer_than_a_sitting():
    for path in Path(second_rig.__file__).parent.glob("*.py"):
        assert len(path.read_text().splitlines()) <= 300, path


def _silent(key):
    chosen = SETS[key]
    zeros = {(group, side): 0.0 for group in ("main", "active", "passive") for side in "ab"}
    options = replace(chosen.options, logging=SILENT, of_every_run=chosen.options.of_every_run | {"zeros": zeros})
    return replace(chosen, options=options)


def _residual(run, columns):
    """N m at the motor shaft that docs/physics.md's balance leaves of a log, and the losses, after the two papers."""
    crane, truth, voyage = run.crane, run.truth, run.voyage
    speed = columns["motor_speed"]
    radius = crane.radii[voyage.layer - 1]
    load = columns["hook_load"] * 9.81 * radius / crane.gear
    heave = columns.get("heave_velocity", np.zeros_like(speed))
    time = columns["time"]
    load_lifted = columns["hook_load"] * np.gradient(speed * radius / crane.gear + heave, time) * radius / crane.gear
    driven, losses = np.zeros_like(speed), np.zeros_like(speed)
    w = np.abs(speed)
    for group, motors in run.groups.items():
        pressure = columns[f"{group}.pressure_a"] - columns[f"{group}.pressure_b"]
        d, p = columns[f"{group}.displacement"], np.abs(pressure)
        driven += motors * d * pressure
        motor = truth["K1"] * w + truth["K2"] * d**3 * w**2 + truth["K3"] * p * d + truth["K4"] + truth["K5"] * p**2
        losses += motors * motor
    drum_torque = columns["hook_load"] * 9.81 * radius
    falling = np.exp(-w / (truth["C4"] * 2 * np.pi / 60))
    winch = (truth["C1"] * drum_torque + truth["C3"]) * falling + truth["C5"] * w + truth["C6"] * drum_torque
    losses += crane.motors * winch
    inertia = crane.inertia * np.gradient(speed, time)
    return driven - load - load_lifted - inertia - np.sign(speed) * losses, losses


@pytest.mark.parametrize("key", ["null_01", "null_02", "null_03"])
def test_without_effect_and_noise_the_balance_closes_by_the_documented_signs(key, tmp_path):
    runs = []
    write_set(tmp_path, _silent(key), 7, lambda run, columns: runs.append((run, columns)))
    assert len(runs) == 12
    for run, columns in runs:
        residual, losses = _residual(run, columns)
        speed = columns["motor_speed"]
        fast = np.abs(speed) > 10.0
        assert abs(np.mean(residual[fast])) < 0.01 * np.mean(losses[fast]), run.voyage.kind
        if not run.voyage.at_sea:  # the logged heave is noisy whatever the other sensors are
            steady = (np.abs(speed) > 3.0) & (np.abs(np.gradient(speed, columns["time"])) < 1.0)
            assert np.all(np.abs(residual[steady]) < 0.01 * losses[steady]), run.voyage.kind


def test_every_kind_has_its_sets():
    kinds = [each.kind for each in SETS.values()]
    assert [kinds.count(kind) for kind in (NULL, EFFECT, OUTSIDE, PAIR, LOAD_CELL)] == [13, 38, 6, 6, 1]
    assert {each.kind for each in in_turn(list(SETS.values()))[:12]} >= {NULL, EFFECT, OUTSIDE, PAIR}


def test_outcomes():
    pair, null, outside = SETS["two_wear_tare"], SETS["null_01"], SETS["out_warm"]
    assert _outcome(pair, "missing_effect", [["wear_drift"], ["gear_asymmetry", "tare_load"]]) == "right"
    assert _outcome(pair, "missing_effect", [["wear_drift"]]) == "part"
    assert _outcome(pair, "missing_effect", [["wear_drift"], ["churning"]]) == "wrong"
    assert _outcome(pair, "unexplained", []) == "unnamed"
    assert _outcome(SETS["tare"], "nothing_missing", []) == "missed"
    assert _outcome(null, "unexplained", []) == "alarm"
    assert _outcome(null, "nothing_missing", []) == "quiet"
    assert _outcome(outside, "unexplained", []) == "unnamed"
    assert _outcome(outside, "missing_effect", [["churning"]]) == "named"


@pytest.mark.slow
@pytest.mark.long
def test_the_users_path_ends_as_expected(tmp_path):
    """Files, `check`, `gap` and `gap` with the written model: a null stays quiet, a hook block is named."""
    folder = write_set(tmp_path / "null", SETS["null_04"], SETS["null_04"].seed(1))
    checked = command("check", folder)
    assert checked.returncode == 0, checked.stdout + checked.stderr
    null, tare = diagnose(SETS["null_04"], 1), diagnose(SETS["tare"], 1)
    assert null["outcome"] == "quiet"
    assert tare["outcome"] == "right"
    assert tare["again"] == "nothing_missing"
    assert tare["after"] < tare["before"]
    write_table(tmp_path / "table.md", [tare, null], 1)
    text = (tmp_path / "table.md").read_text()
    assert "| nulls: `nothing_missing` | 1 of 1 |" in text
    assert "| one effect: right, alone or in a set of at most three | 1 of 1 |" in text
