"""Of load cells that are off by another amount in each run some law takes a part by chance: that is no name."""

from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy.candidates.signals import WEIGHT
from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.engine.problem import of_base
from winch_friction.discrepancy.outdone import told_by_chance

RUNS, EACH = 12, 40
RUN = np.repeat(np.arange(RUNS), EACH)
WAY = np.tile([1.0, -1.0], RUNS * EACH // 2)
LOAD = np.repeat(np.linspace(80.0, 500.0, RUNS)[np.random.default_rng(1).permutation(RUNS)], EACH)  # N m
LAYER = np.repeat(np.tile([0.0, 1.0], RUNS // 2), EACH)
CELLS = np.repeat(np.random.default_rng(5).normal(0.0, 1.5e-3, RUNS), EACH)  # of the load, by run
DRAWN = np.repeat(np.random.default_rng(6).normal(0.0, 1.0, (4, RUNS)), EACH, axis=1)  # by run, as any signal may be
NOISE = np.random.default_rng(2).normal(0.0, 0.1, len(RUN))
LEAST = 0.1  # N m


def slot_of(law="", opposing=False, column=1):
    return Slot("layer_radius", "", (column,), origin=(SimpleNamespace(opposing=opposing), None), law=law)


def trial_of(gap, slot, others=34, column=None, runs=RUNS, beside=()):
    """A trial that stands by one name, or two: its column beside the weight's, over so many runs."""
    own = runs > RUN
    x = np.column_stack([1e-3 * LOAD, LAYER * LOAD if column is None else column, *(each * LOAD for each in DRAWN)])[
        own
    ]
    gap = gap[own]

    def explain(slots):
        at = [0, *(c for each in slots for c in each.columns)]
        return SimpleNamespace(slots=tuple(slots), beta=np.linalg.lstsq(x[:, at], gap, rcond=None)[0], at=at)

    problem = SimpleNamespace(
        base=SimpleNamespace(names=(WEIGHT,), scale=np.array([1e-3])),
        blocks=SimpleNamespace(x=x, run=RUN[own], direction=WAY[own]),
        slots=[slot, *(slot_of(f"law {k}") for k in range(others))],
        columns=lambda slots: (0, *(c for each in slots for c in each.columns)),
    )
    cross = SimpleNamespace(
        problem=problem, explain=explain, remainder=lambda each: (gap - x[:, each.at] @ each.beta) / 0.1
    )
    expansion = SimpleNamespace(cross=lambda names, known: cross, layout=SimpleNamespace(slot_like=lambda each: each))
    side = SimpleNamespace(least_noise=LEAST, runs=[SimpleNamespace(name=f"run {k}") for k in range(RUNS)])
    search = SimpleNamespace(cross=cross, expansion=expansion, explanation=SimpleNamespace(slots=(slot, *beside)))
    return SimpleNamespace(search=search, train=side, holdout=side)


def test_a_law_that_takes_a_part_of_levels_that_are_drawn_is_no_name():
    """Of four nulls whose cells were off by 0.15 % three got a name: a radius, a tare and a feedback that bows."""
    why = told_by_chance(trial_of(CELLS * LOAD + NOISE, slot_of()))
    assert why.startswith("layer_radius: adds to each run's load alone and keeps ")
    assert "12 runs" in why


def test_a_law_that_tells_the_levels_beside_such_cells_is_one():
    assert told_by_chance(trial_of(0.02 * LAYER * LOAD + CELLS * LOAD + NOISE, slot_of())) == ""


def test_levels_that_a_law_tells_as_chance_would_are_counted_for_every_law_that_adds_to_a_load():
    """The same levels are told by one law alone, and not by the best of many."""
    gap = 0.004 * LAYER * LOAD + CELLS * LOAD + NOISE
    assert told_by_chance(trial_of(gap, slot_of(), others=0)) == ""
    assert told_by_chance(trial_of(gap, slot_of(), others=400))


@pytest.mark.parametrize(("within", "by_chance"), [(50.0, True), (1000.0, False)])
def test_what_changes_within_the_runs_is_no_level(within, by_chance):
    column = LAYER * LOAD + within * np.tile(np.sin(np.arange(EACH)), RUNS)
    gap = CELLS * LOAD + NOISE + 1e-3 * column
    assert bool(told_by_chance(trial_of(gap, slot_of(), column=column))) is by_chance


@pytest.mark.parametrize(("times", "by_chance"), [(1.0, True), (60.0, False)])
def test_more_than_load_cells_are_off_by_is_no_cells(times, by_chance):
    assert bool(told_by_chance(trial_of(times * (CELLS + 0.0015 * LAYER) * LOAD + NOISE, slot_of()))) is by_chance


def test_a_gain_that_is_the_same_in_all_runs_is_no_cells():
    """A 100 kW winch's radius is off by 14 %; beside it the cycles hardly differ, and it had lost its name."""
    column = (1.0 + 0.01 * LAYER) * LOAD
    assert told_by_chance(trial_of(0.14 * column + CELLS * LOAD + NOISE, slot_of(), column=column)) == ""


def test_friction_beside_it_is_no_level_and_few_runs_do_not_tell():
    gap = CELLS * LOAD + NOISE
    assert told_by_chance(trial_of(gap, slot_of(opposing=True))) == ""
    assert told_by_chance(trial_of(gap, slot_of(), runs=5)) == ""


def test_every_amount_that_adds_to_the_load_takes_a_run():
    """A second name of four amounts leaves few of eight runs to say how far off their cells are."""
    gap = 0.008 * LAYER * LOAD + CELLS * LOAD + NOISE
    other = Slot("tare_load", "", (2, 3, 4, 5), origin=(SimpleNamespace(opposing=False), None))
    assert told_by_chance(trial_of(gap, slot_of(), others=4, runs=8)) == ""
    assert told_by_chance(trial_of(gap, slot_of(), others=4, runs=8, beside=(other,))).startswith("layer_radius")


def test_of_what_a_run_shows_nothing_no_share_is_told():
    """An empty hook, or a run that nobody weighed: its share would be nothing over nothing."""
    base, run = SimpleNamespace(names=("K1", WEIGHT), scale=np.array([1.0, 1e-3])), np.array([0, 0, 1, 1])

    def column_of(*torque, name=WEIGHT):
        blocks = SimpleNamespace(x=np.column_stack([np.ones(4), torque]), run=run)
        return of_base(SimpleNamespace(base=base, blocks=blocks), name)

    assert column_of(0.1, 0.2, 0.0, 0.4) == pytest.approx([100.0, 200.0, 0.0, 400.0])
    assert column_of(0.1, 0.2, 0.0, 0.0) is None
    assert column_of(0.1, 0.2, 0.0, 0.4, name="rope_force") is None
