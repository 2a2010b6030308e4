"""A suspected delay as what the runs are without it: at five values, with a swing on the wire that is told once."""

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy.candidates.candidate import Candidate, Shape
from winch_friction.discrepancy.candidates.signals import PRESSURES, SPEED
from winch_friction.discrepancy.detectors import delay
from winch_friction.discrepancy.engine.blocks import Slot

SIZE, MODE = 0.1, (3.0, 0.05, None)
TIME = np.linspace(0.0, 150.0, 101)  # a clock that drifts is late by SIZE in the middle


@dataclass
class Model:
    """A model that is asked for its corrections alone."""

    corrections: tuple = ()


def prepared(gap, mode=None):
    return SimpleNamespace(name="run", start=0.0, time=TIME, gap=gap, wire_mode=mode)


def test_the_five_values_share_the_swing_that_is_told_without_the_first_estimate(monkeypatch):
    asked, clocks = [], []

    def gap_without(model):
        (late,) = model.corrections
        return np.full(len(TIME), 2.0 - late.value * (100.0 if late.name == "signal_clock" else 1.0))

    def meet(runs, crane, model, _):
        asked.append(("told", model.corrections[0].value))
        return SimpleNamespace(prepared=(prepared(gap_without(model), MODE),))

    def in_turn(given, model, modes):
        asked.append((modes["run"], model.corrections[0].value))
        clocks.append(model.corrections[0].name == "signal_clock")
        yield prepared(gap_without(model))

    monkeypatch.setattr(delay, "meet", meet)
    monkeypatch.setattr(delay, "met_in_turn", in_turn)
    given = SimpleNamespace(runs=(), crane=None, model=Model(), prepared=(prepared(np.full(len(TIME), 2.0)),))
    shape = Shape("late", {"ahead": SIZE, "behind": 0.0, "late": SPEED})
    suspect = Slot(delay.DELAY, "late", (0,), origin=(None, shape))
    own = Candidate(delay.DELAY, columns=lambda run, values: values["ahead"] * run.gap[:, None], shapes=lambda _: [])
    (found,) = delay.without_delay(given, [own], suspect, None, SimpleNamespace(slots=()))
    assert asked[0] == ("told", pytest.approx(SIZE))
    assert [mode for mode, _ in asked[1:]] == [MODE] * 7
    assert clocks == [False] * 4 + [True] * 3
    assert sorted(value / SIZE for _, value in asked[:5]) == pytest.approx(sorted(delay.AROUND))
    # of a clock that is late by as much in the middle of a run
    assert [75.0 * value / SIZE for _, value in asked[5:]] == pytest.approx(delay.GROWING)
    for each in found.shapes([]):  # what a delay of one second would leave
        np.testing.assert_allclose(found.columns(given.prepared[0], each.values), 1.0)
    assert len(found.shapes([])) == 8
    # shapes of other sizes are the first derivative's
    small = found.columns(given.prepared[0], {"ahead": 0.01, "behind": 0.0, "late": SPEED})
    np.testing.assert_allclose(small, 0.01 * 2.0)


@pytest.mark.parametrize(("late", "sign"), [(SPEED, 1.0), (PRESSURES, -1.0)])
def test_what_is_suspected_of_a_clock_that_drifts_is_its_delay_in_the_middle(late, sign):
    shape = delay._shape(sign * 0.3, late, by_time=True)
    suspect = Slot(delay.DELAY, shape.label, (0,), origin=(None, shape))
    assert delay._size(suspect, None, SimpleNamespace(slots=()), half=60.0) == pytest.approx(sign * 0.3 * 0.6)
    one = delay._delay(sign * 0.3, late, by_time=True)
    assert (one.name, one.value) == ("signal_clock" if late == SPEED else "pressure_clock", pytest.approx(0.003))
    assert "late by 300 ms after 100 s" in shape.label
