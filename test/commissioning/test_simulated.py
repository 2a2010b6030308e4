"""A user's own simulation in another unit, with the other sign, of nothing; and one that only lacks the friction."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from winch_friction.commissioning.check import quick_check, simulated_findings
from winch_friction.physics.channels import GRAVITY
from winch_friction.physics.signals import Run
from winch_friction.records.crane_file import load_crane
from winch_friction.records.runs import read_run

FOLDER = Path(__file__).parents[2] / "config" / "examples" / "practice_150t"
CRANE = load_crane("crane_150t")
HOOK, LOADED = read_run(FOLDER / "test_01.parquet"), read_run(FOLDER / "test_05.parquet")


def drop(run):
    return run["main.pressure_a"] - run["main.pressure_b"]


def without_friction(run):
    radius = CRANE.drum.layer_radii[-1]
    return run["hook_load"] * GRAVITY * radius / CRANE.gear_ratio / (CRANE.groups["main"] * run["main.displacement"])


def found(run, simulated):
    run = replace(run, columns={**run.columns, "main.pressure_drop_simulated": simulated})
    return [each for each in quick_check([run], CRANE) if each.cause == "simulation"]


@pytest.mark.parametrize(
    ("factor", "words"),
    [
        (1e-5, "it holds bar under [Pa]"),
        (14.5038, "it holds psi under [bar]"),
        (-1.0, "it counts the other way"),
        (-10.0, "it counts the other way and it holds bar under [MPa]"),
        (3.0, "is its unit right?"),
        (0.0, "was it written?"),
    ],
)
def test_a_column_that_is_no_such_signal_is_refused(factor, words):
    (finding,) = found(LOADED, factor * drop(LOADED))
    assert finding.contradicts
    assert finding.channel == "main.pressure_drop_simulated"
    assert finding.sentence.endswith(words) or words in finding.sentence


@pytest.mark.parametrize("run", [HOOK, LOADED], ids=["hook", "loaded"])
def test_a_simulation_that_lacks_all_friction_is_one(run):
    assert found(run, without_friction(run)) == []
    assert found(run, np.where(np.arange(len(run)) % 50 == 0, drop(run), np.nan)) == []


def test_of_an_electric_drive_it_is_only_said_and_other_channels_are_met_by_name():
    time = np.linspace(0.0, 10.0, 500)
    torque = np.sin(time)
    run = Run("r", {"time": time, "motor_speed": time, "motor_torque": torque, "motor_torque_simulated": -torque,
                    "rope_force_simulated": torque})  # fmt: skip
    (finding,) = simulated_findings([run], hydraulic=False)
    assert (finding.severity, finding.channel) == ("warning", "motor_torque_simulated")
