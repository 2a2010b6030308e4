"""Columns in every n-th row only: held, or taken between, by every reader that judges, and said; holes stay holes."""

from pathlib import Path

import numpy as np
import pytest

from winch_friction.commissioning.check import quick_check
from winch_friction.identification.one_group import run_as_main
from winch_friction.identification.plateaus import find_plateaus
from winch_friction.physics.signals import Run
from winch_friction.records.crane_file import load_crane
from winch_friction.records.run_checks import checked_run, rows_between
from winch_friction.records.runs import apart, filled, read_run

EXAMPLES = Path(__file__).parents[2] / "config" / "examples" / "practice_150t"
TIME = 0.02 * np.arange(600)


def sparse(values, every, first=0):
    return np.where(np.arange(len(values)) % every == first, values, np.nan)


def log(**slow):
    speed, pressure = 50.0 * np.sin(TIME), 2e7 + 1e6 * np.sin(TIME)
    return Run("r.csv", {"time": TIME, "motor_speed": speed, "main.pressure_a": pressure,
                         "hook_load": 5e4 + 10.0 * TIME} | slow)  # fmt: skip


def test_a_load_in_every_fiftieth_row_is_held_and_a_pressure_taken_between():
    run, notes = filled(log(hook_load=sparse(5e4 + 10.0 * TIME, 50, 3), **{"main.pressure_a": sparse(2e7 + TIME, 5)}))
    assert run["hook_load"][[0, 3, 52, 53]] == pytest.approx(5e4 + 10.0 * TIME[[3, 3, 3, 53]])
    assert run["main.pressure_a"][:596] == pytest.approx((2e7 + TIME)[:596], rel=1e-9)
    assert notes == [
        "r.csv: main.pressure_a has a value in every 5 rows: taken between them",
        "r.csv: hook_load has a value in every 50 rows: held at its latest value",
    ]


def test_a_slow_speed_says_which_rows_are_looked_at_and_others_in_rows_of_their_own_meet_it_there():
    given = log(motor_speed=sparse(TIME, 5, 1), **{"main.pressure_a": sparse(1e7 * TIME, 5, 2)})
    run, _ = filled(given)
    assert run.time == pytest.approx(TIME[1::5])
    assert run["main.pressure_a"][1:] == pytest.approx(1e7 * TIME[6::5])


@pytest.mark.parametrize(
    "values",
    [np.where(TIME < 6.0, TIME, np.nan), np.where(TIME % 3.0 < 2.7, TIME, np.nan), np.where(TIME < 0.1, 1.0, np.nan)],
    ids=["dead from half on", "short holes", "five values"],
)
def test_holes_are_no_rhythm(values):
    assert rows_between(values) == 0.0
    run = log(hook_load=values)
    assert filled(run) == (run, [])


def test_the_reader_says_how_often_instead_of_counting_cells():
    run = checked_run("r.csv", dict(log(hook_load=sparse(TIME, 50)).columns), place=str, complete=False)
    assert run.warnings == ("r.csv: column 'hook_load' has a value in every 50 rows only",)
    assert np.isnan(run["hook_load"]).sum() == 588  # what was read stays what stands there


def test_check_gap_and_the_practice_see_the_load_that_a_slow_column_holds():
    whole, crane = read_run(EXAMPLES / "test_05.parquet"), load_crane("crane_150t")
    run = Run(whole.name, dict(whole.columns) | {"hook_load": sparse(whole["hook_load"], 50)})
    (part,), said = apart([run])
    assert np.isfinite(part["hook_load"]).all()
    assert said == [f"{whole.name}: hook_load has a value in every 50 rows: held at its latest value"]
    wrong = Run(whole.name, dict(run.columns) | {"hook_load": 9.81 * run["hook_load"]})
    assert [each.sentence[:9] for each in quick_check([wrong], crane) if each.contradicts] == ["hook_load"]
    loads = [[each.drum_torque for each in find_plateaus(run_as_main(each, crane), crane)] for each in (whole, run)]
    assert loads[0] == pytest.approx(loads[1], rel=0.01)
