"""A whole run in one go: what its rows one by one would have given, however sound they are."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from sea import CRANE, SEED

from winch_friction import simulate
from winch_friction.online.inputs import InputGate, ServiceOptions
from winch_friction.physics.channels import SLOW_INPUTS
from winch_friction.physics.signals import Run
from winch_friction.records.sample_stream import InputHold
from winch_friction.records.topics import TopicMap

ROW = 40


def _gate(run: Run) -> InputGate:
    return InputGate(
        CRANE, TopicMap(groups=run.groups), InputHold(run.groups, 0.1, dict(SLOW_INPUTS)), ServiceOptions(), list
    )


def _with(column: str, value: float, added: bool = False) -> Callable[[Run], Run]:
    """A run with another value in one row, or with so much added to it."""

    def changed(run: Run) -> Run:
        values = run[column].copy()
        values[ROW] = values[ROW] + value if added else value
        return replace(run, columns={**run.columns, column: values})

    return changed


def _without(*columns: str) -> Callable[[Run], Run]:
    return lambda run: replace(run, columns={name: run.columns[name] for name in run.columns if name not in columns})


def _after_a_pause(run: Run) -> Run:
    later = run.time > 1.0
    moved = {"time": np.where(later, 3.0, 0.0), "oil_temperature": np.where(later, 30.0, 0.0)}
    return replace(run, columns={**run.columns, **{name: run[name] + more for name, more in moved.items()}})


RUNS: dict[str, Callable[[Run], Run]] = {
    "sound": lambda run: run,
    "a hole": _with("active.pressure_a", np.nan),
    "a slow channel": _with("hook_load", np.nan),
    "no sensor can say it": _with("passive.pressure_a", 1e12),
    "not this crane's": _with("active.displacement", 25.0 * CRANE.max_displacement),
    "too fast": _with("motor_speed", 150.0, added=True),
    "too fast, downwards": _with("motor_speed", -150.0, added=True),
    "other oil after a pause": _after_a_pause,
    "no command": _without("speed_reference"),
    "no load": _without("hook_load"),
    "no pressure": _without("passive.pressure_b"),
}


@pytest.fixture(scope="module")
def sound() -> Run:
    return simulate("ahc_55t_215", CRANE, SEED, duration=2.0).run


@pytest.mark.parametrize("which", RUNS)
def test_a_run_in_one_go_is_its_rows_one_by_one(sound: Run, which: str) -> None:
    run = RUNS[which](sound)
    whole, single = _gate(run), _gate(run)
    columns = ["speed_reference", "hook_load"]
    count = 0
    for fast, row in zip(whole.rows(run), run.samples(), strict=True):
        slow = single.fill(row)
        assert repr(fast) == repr(slow)
        assert [str(whole.stamp(c, fast.time)) for c in columns] == [str(single.stamp(c, slow.time)) for c in columns]
        assert (whole.last_stamp, whole.last_arrival) == (single.last_stamp, single.last_arrival)
        count += 1
    assert count == len(sound)


@pytest.mark.parametrize("which", RUNS)
def test_only_a_run_without_a_hole_or_a_doubt_goes_through_unheld(sound: Run, which: str) -> None:
    run = RUNS[which](sound)
    gate = _gate(run)
    assert len(list(gate.rows(run))) == len(sound)
    assert (not gate.ages()) == (which in ("sound", "other oil after a pause", "no command", "no load"))


def test_a_run_after_a_message_is_taken_row_by_row(sound: Run) -> None:
    """What is held may fill its first rows."""
    gate = _gate(sound)
    gate.hold.put("rope_force", float(sound.time[0]), 5e5)
    assert [sample.rope_force for sample in gate.rows(sound)][:2] == [5e5, 5e5]
