"""A loss that changes from run to run: said where it is sure and matters, unless a temperature was logged."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import linregress

from winch_friction.discrepancy.drift import drift_note

DRIVE = 100.0


def side(losses, present=frozenset(), scatter=0.05):
    """Runs an hour apart that lose so much against either motion; `scatter` beside the straight line."""
    direction = np.tile([1.0, -1.0], 20)
    runs = [
        SimpleNamespace(
            start=3600.0 * k, present=present, used=np.ones(40, bool), gap=np.zeros(40), predicted=np.full(40, DRIVE),
            drive_torque=np.full(40, DRIVE), unit_torque=1.0,
        )
        for k in range(len(losses))
    ]  # fmt: skip
    off = scatter * np.resize([1.0, -1.0, -1.0, 1.0], len(losses))
    after = np.concatenate([(loss + o) * direction for loss, o in zip(losses, off, strict=True)])
    blocks = SimpleNamespace(run=np.repeat(np.arange(len(losses)), 40), direction=np.tile(direction, len(losses)))
    return SimpleNamespace(runs=tuple(runs), blocks=blocks, after=after)


RISING = np.linspace(0.0, 10.0, 9)


def test_a_loss_that_rises_with_the_hours_is_undecided_between_temperature_and_wear():
    said = drift_note([side(RISING)], [], "bar")
    assert "over 8.0 h the loss along the motion changes by +10" in said
    assert "undecided between temperature and wear" in said


def test_falling_is_said_with_its_sign():
    assert "changes by -9.97" in drift_note([side(-RISING)], [], "bar")


@pytest.mark.parametrize(
    ("sides", "named"),
    [
        ([side(RISING, present=frozenset({"oil_temperature"}))], []),
        ([side(RISING)], ["wear_drift"]),
        ([side(RISING[:5])], []),  # too few runs
        ([side(0.1 * RISING)], []),  # 1 % of the drive
        ([side(RISING, scatter=30.0)], []),  # by chance
    ],
)
def test_nothing_is_said_where_it_is_told_apart_small_or_by_chance(sides, named):
    assert drift_note(sides, named, "bar") == ""


def judged(scatter):
    """The chance and the slope of the same points by SciPy's regression, and what is said of them."""
    off = scatter * np.resize([1.0, -1.0, -1.0, 1.0], len(RISING))
    found = linregress(np.arange(len(RISING)), RISING + off)
    return found, drift_note([side(RISING, scatter=scatter)], [], "bar")


def test_a_drift_is_sure_to_one_in_a_hundred_and_said_with_its_chance_and_its_interval():
    said = {}
    for scatter in np.linspace(1.0, 12.0, 45):
        found, note = judged(scatter)
        said[found.pvalue] = bool(note)
        if note:
            assert (
                f"by {8.0 * found.slope:+.3g} ± {1.96 * 8.0 * found.stderr:.2g} bar (95 %, p = {found.pvalue:.1g})"
                in note
            )
    assert {p: p <= 0.01 for p in said} == said
    assert sum(0.01 < p < 0.05 for p in said) > 3


@pytest.mark.parametrize(("share", "matters"), [(0.019, False), (0.021, True)])
def test_a_drift_matters_from_two_per_cent_of_the_drive_over_the_whole_time_on(share, matters):
    assert bool(drift_note([side(share * DRIVE * np.linspace(0.0, 1.0, 9), scatter=0.0)], [], "bar")) is matters


def test_six_runs_may_drift_and_both_sides_of_the_split_count():
    first, second = side(RISING[:3]), side(RISING[3:6])
    for run in second.runs:
        run.start += 3 * 3600.0
    assert "over 5.0 h" in drift_note([first, second], [], "bar")
    assert drift_note([first], [], "bar") == drift_note([side(RISING)], ["viscosity_temperature"], "bar") == ""
