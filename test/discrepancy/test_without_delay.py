"""A suspected delay as what the runs are without it: at five values, with a swing on the wire that is told once."""

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy.candidates.candidate import Candidate, Shape
from winch_friction.discrepancy.candidates.signals import SPEED
from winch_friction.discrepancy.detectors import delay
from winch_friction.discrepancy.engine.blocks import Slot

SIZE, MODE = 0.1, (3.0, 0.05, None)
TIME = np.linspace(0.0, 10.0, 101)


@dataclass
class Model:
    """A model that is asked for its corrections alone."""

    corrections: tuple = ()


def prepared(gap, mode=None):
    return SimpleNamespace(name="run", start=0.0, time=TIME, gap=gap, wire_mode=mode)


def test_the_five_values_share_the_swing_that_is_told_without_the_first_estimate(monkeypatch):
    asked = []

    def gap_without(model):
        (delay,) = model.corrections
        return np.full(len(TIME), 2.0 - delay.value)

    def meet(runs, crane, model, _):
        asked.append(("told", model.corrections[0].value))
        return SimpleNamespace(prepared=(prepared(gap_without(model), MODE),))

    def in_turn(given, model, modes):
        asked.append((modes["run"], model.corrections[0].value))
        yield prepared(gap_without(model))

    monkeypatch.setattr(delay, "meet", meet)
    monkeypatch.setattr(delay, "met_in_turn", in_turn)
    given = SimpleNamespace(runs=(), crane=None, model=Model(), prepared=(prepared(np.full(len(TIME), 2.0)),))
    shape = Shape("late", {"ahead": SIZE, "behind": 0.0, "late": SPEED})
    suspect = Slot(delay.DELAY, "late", (0,), origin=(None, shape))
    own = Candidate(delay.DELAY, columns=lambda run, values: values["ahead"] * run.gap[:, None], shapes=lambda _: [])
    (found,) = delay.without_delay(given, [own], suspect, None, SimpleNamespace(slots=()))
    assert asked[0] == ("told", pytest.approx(SIZE))
    assert [mode for mode, _ in asked[1:]] == [MODE] * 4
    assert sorted(value / SIZE for _, value in asked) == pytest.approx(sorted(delay.AROUND))
    for each in found.shapes([]):  # what a delay of one second would leave
        np.testing.assert_allclose(found.columns(given.prepared[0], each.values), 1.0)
    assert len(found.shapes([])) == 5
    # shapes of other sizes are the first derivative's
    small = found.columns(given.prepared[0], {"ahead": 0.01, "behind": 0.0, "late": SPEED})
    np.testing.assert_allclose(small, 0.01 * 2.0)
