"""A recording that is given twice, in another export or as a piece, is told; two drives of one profile are not one."""

from dataclasses import replace

import numpy as np
import pytest

from winch_friction.cli.main import run as command
from winch_friction.commissioning.check import same_recordings
from winch_friction.commissioning.commissioning import check
from winch_friction.discrepancy import workflow
from winch_friction.physics.signals import Run
from winch_friction.records.runs import write_run

TIME = 1.75e9 + 0.02 * np.arange(4000)


def drive(name, seed=1, start=0.0, fast=1.0):
    rng, t = np.random.default_rng(seed), TIME - TIME[0]
    speed = fast * 60.0 * np.sin(0.7 * t) + 20.0 * np.sin(0.31 * t)
    columns = {
        "time": TIME + start, "motor_speed": speed + 0.1 * rng.standard_normal(4000),
        "main.pressure_a": 2e7 + 1e6 * np.sign(speed) + 5e4 * rng.standard_normal(4000),
        "main.pressure_b": 2e6 + 5e4 * rng.standard_normal(4000), "main.displacement": np.full(4000, 3e-5),
    }  # fmt: skip
    return Run(name, columns)


def exported(run, keep=slice(None), **digits):
    """Again, with fewer digits and a clock that begins at zero."""
    columns = {name: values[keep] for name, values in run.columns.items()}
    for name, digit in {"motor_speed": 0.01, "main.pressure_a": 1e3, "main.pressure_b": 1e3, **digits}.items():
        columns[name] = np.round(columns[name] / digit) * digit
    return replace(run, name="again.csv", columns=columns)


def test_another_export_of_a_recording_is_told():
    one = drive("one.csv")
    again = exported(one)
    again.columns["time"] = np.round(one.time - one.time[0], 2)
    (said,) = same_recordings([one, drive("two.csv", 2), again])
    assert said.startswith("one.csv and again.csv seem to be one recording, given twice")
    assert said.endswith("give each run once")


def test_a_piece_of_a_recording_is_told_by_its_clock():
    one = drive("one.csv")
    assert len(same_recordings([one, exported(one, slice(700, 2000))])) == 1
    assert same_recordings([one, exported(one, slice(700, 1100))]) == []  # too short to tell
    shifted = exported(one, slice(700, 2000))
    shifted.columns["time"] = shifted.time + 3600.0
    assert same_recordings([one, shifted]) == []


@pytest.mark.parametrize("start", [0.0, 86400.0])
def test_two_drives_of_one_profile_are_two_recordings(start):
    """A PLC drives the same ramps once more: what the sensors add differs, and so does the oil."""
    assert same_recordings([drive("one.csv"), drive("two.csv", 2, start)]) == []
    warm = drive("two.csv", 1, start)
    warm.columns["main.pressure_a"] = warm["main.pressure_a"] - 5e4 * np.sign(warm["motor_speed"])
    assert same_recordings([drive("one.csv"), warm]) == []


def enough(*_, **__):
    """The doubts are said before the search, which takes ten seconds."""
    raise KeyboardInterrupt


def test_check_and_gap_tell_it(tmp_path, monkeypatch, capsys, crane_150t):
    monkeypatch.chdir(tmp_path)
    one = drive("one.csv")
    runs = [one, exported(one)]
    told = [each for each in check(runs, crane_150t, None, dict).findings if each.cause == "copy"]
    assert [each.severity for each in told] == ["warning"]
    for run in runs:
        write_run(run, tmp_path / run.name)
    monkeypatch.setattr(workflow, "find_gap", enough)
    files = ["one.csv", "again.csv"]
    assert command(["gap", *files, "--crane", "crane_150t", "--model", "a6vm215_crane2", "--out", "gap"]) == 130
    assert "one.csv and again.csv seem to be one recording" in " ".join(capsys.readouterr().err.split())
