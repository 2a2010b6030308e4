"""The seed's stated uncertainty is put to the test: what only leaves its box is no effect; what surprises is said."""

import numpy as np
import pytest

from winch_friction.discrepancy.engine.blocks import Blocks, Slot, grams
from winch_friction.discrepancy.engine.crossfit import CrossFit
from winch_friction.discrepancy.engine.problem import Base, Layout, Problem
from winch_friction.discrepancy.estimates import _something_else, _surprise, try_seed

RUNS, BLOCKS, COUNT = 8, 200, 4
RUN, POSITION = np.repeat(np.arange(RUNS), BLOCKS), np.tile(np.arange(BLOCKS), RUNS)
SPEED = np.tile(np.linspace(-1.0, 1.0, BLOCKS), RUNS)
COLUMNS = np.column_stack([np.abs(SPEED) ** k for k in range(COUNT)]) * np.sign(SPEED)[:, None]
STRANGE = np.tile(np.sin(np.linspace(0.0, 55.0, BLOCKS)), RUNS)


class _Model:
    parameter_names, values, covariance = tuple("abcd"), (0.0,) * COUNT, np.eye(COUNT)

    def bounds_of(self, _):
        return (-1e9, 1e9)


class _Stage:
    """What `try_seed` reads of a search: a base of four parameters, one deviation each worth one noise, one candidate
    that is the tie of the third."""

    def __init__(self, truth, more=0.0):
        rng = np.random.default_rng(3)
        y = COLUMNS @ np.asarray(truth) + more * STRANGE + 0.5 * rng.standard_normal(len(RUN))
        slot = Slot("tie", "", (COUNT,), most=50.0)
        x = np.column_stack([COLUMNS, COLUMNS[:, 2]])
        features = {"speed": np.abs(SPEED), "acceleration": np.abs(STRANGE)}
        blocks = Blocks(y, x, RUN, RUN * 10 + POSITION // 20, np.full(len(y), 2.0), features, np.sign(SPEED), POSITION)
        box = np.append(np.full(COUNT, 2.0), 100.0)
        base = Base(tuple("abcd"), COUNT, np.ones(COUNT), np.zeros(COUNT), -box[:COUNT], box[:COUNT])
        layout = Layout(base, (slot,), np.ones(COUNT + 1), -box, box)
        self.cross = CrossFit(Problem(layout, blocks, grams(blocks), dict.fromkeys(range(RUNS), 0.5)))
        self.given = self.expansion = self
        self.model = _Model()
        bare, named = self.cross.explain(()), self.cross.explain((slot,))
        self.selection, self.base, self.final = self, bare, named if max(np.abs(truth)) > 2.0 else bare
        self.found = ()


def trial(truth, more=0.0):
    return try_seed(_Stage(truth, more), np.random.default_rng(0))


def test_a_seed_within_its_claim_is_left_alone():
    assert not trial((1.0, -1.0, 0.5, 0.0)).enough


def test_a_little_outside_the_box_is_no_effect_and_refutes_nothing():
    found = trial((0.0, 0.3, 2.3, 0.0))
    assert found.enough
    assert found.refuted is None


def test_far_outside_in_several_directions_is_refuted_with_what_would_mimic_it():
    found = trial((2.6, -2.7, 3.1, 2.4))
    assert found.refuted is not None
    assert found.refuted.sigma > 3.3
    assert set(found.refuted.shifts) <= set("abcd")


def test_where_something_else_is_wrong_the_seed_is_not_accused():
    stage = _Stage((0.0, 0.0, 0.0, 0.0), more=4.0)
    assert not try_seed(stage, np.random.default_rng(0)).enough
    freed = stage.cross.explain(())
    assert _something_else(stage.cross, freed, stage, np.random.default_rng(0))


def test_surprise_is_that_of_a_normal_variable():
    stage = _Stage((0.0, 0.0, 0.0, 0.0))
    assert _surprise(stage.cross, np.zeros(COUNT), COUNT)[0] == pytest.approx(0.0, abs=1e-6)
    assert _surprise(stage.cross, np.full(COUNT, 3.0), COUNT)[0] > 3.3
