"""What makes a verdict: what is left where nothing swings and where something does, large gaps, ripples, and size."""

import pickle
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy.answer import (
    MISSING,
    NOTHING,
    UNEXPLAINED,
    Combination,
    GapOptions,
    decide,
    steady_excess,
)
from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.engine.chance import Dependence
from winch_friction.discrepancy.engine.crossfit import CrossFit
from winch_friction.discrepancy.thresholds import LIMITS

SIZE = 1000  # blocks
STEADY = np.arange(SIZE) < SIZE // 2
SWINGS = np.where(STEADY, 0.0, 1.0)  # acceleration


def left(steady, swinging):
    """A remainder of so much above the noise variance where the shaft keeps its speed, and where it does not."""
    return np.sqrt(1.0 + np.where(STEADY, steady, swinging))


class Crossed(SimpleNamespace):
    inside_excess = CrossFit.inside_excess


def crossed(acceleration=SWINGS, matters=0.0):
    problem = SimpleNamespace(
        matters=matters, blocks=SimpleNamespace(features={"acceleration": acceleration}), unresolved=np.zeros(SIZE)
    )
    return Crossed(
        problem=problem, remainder=lambda each: each, at_bound=lambda *_: False,
        excess=lambda each: float(np.mean(each**2 - 1.0)),
    )  # fmt: skip


class _Remainder(np.ndarray):
    names = ("wave",)


def verdict(before, after=None, depends=(), matters=0.0, plain=(), **more):
    """Of one named effect, or of none without `after`."""
    names = ("wave", *plain)
    found = [SimpleNamespace(slot=Slot(each, "", (), plain=each in plain), rivals=()) for each in names]
    final = (before if after is None else after).view(_Remainder)
    selection = SimpleNamespace(base=before, final=final, found=[] if after is None else found, untold="")
    return decide(crossed(matters=matters), selection, list(depends), **more)


@pytest.mark.parametrize(("rippled", "kind"), [(False, UNEXPLAINED), (True, NOTHING)])
def test_twice_the_noise_is_something_unless_a_ripple_may_be_a_part_of_it(rippled, kind):
    assert verdict(left(4.0, 4.0), rippled=rippled).kind == kind


@pytest.mark.parametrize(
    ("share", "swinging", "kind"),
    [(0.1, 2.0, UNEXPLAINED), (0.06, 2.0, MISSING), (0.1, 0.5, MISSING)],  # 0.25 of the noise is nobody's effect
)
def test_what_is_left_while_the_speed_changes_counts_where_a_signal_predicts_it(share, swinging, kind):
    found = verdict(left(4.0, 4.0), left(0.0, swinging), [Dependence("acceleration", share, 1e-3)])
    assert found.kind == kind
    assert found.leaves is (kind == UNEXPLAINED)


@pytest.mark.parametrize(("kept", "kind"), [(5.0, UNEXPLAINED), (3.0, MISSING), (1.9, MISSING)])
def test_of_a_large_gap_a_smaller_share_is_something(kept, kind):
    """Four per cent of a hundred times the noise, although it is less than 15."""
    assert verdict(left(100.0, 100.0), left(kept, kept)).kind == kind


@pytest.mark.parametrize(("size", "kind"), [(0.2, UNEXPLAINED), (0.05, NOTHING)])
def test_what_a_signal_predicts_is_nothing_where_it_is_smaller_than_what_matters(size, kind):
    depends = [Dependence("speed", 0.2, 1e-3, size)]
    assert verdict(left(0.2, 0.2), depends=depends, matters=0.1).kind == kind


@pytest.mark.parametrize("count", [LIMITS.most_named - 1, LIMITS.most_named + 2])
def test_plain_terms_of_a_bare_model_may_be_several(count):
    assert verdict(left(4.0, 4.0), left(0.0, 0.0), plain=[f"plain {k}" for k in range(count)]).kind == MISSING


@pytest.mark.parametrize(("steady", "excess"), [(LIMITS.fewest_steady, 0.0), (LIMITS.fewest_steady - 1, None)])
def test_the_steady_blocks_speak_alone_where_there_are_enough_of_them(steady, excess):
    """One jolt, a thousand times what a sea does, does not make the sea steady."""
    acceleration = np.where(np.arange(SIZE) < steady, 0.0, 1.0)
    acceleration[-1] = 1000.0
    remainder = np.where(np.arange(SIZE) < steady, 1.0, 3.0)
    whole = 8.0 * (SIZE - steady) / SIZE
    assert steady_excess(crossed(acceleration), remainder) == pytest.approx(whole if excess is None else excess)


def test_a_combinations_interval_is_one_of_95_per_cent():
    low, high = Combination("x + y", 3.0, 0.5, "kg", "tied").content()["interval"]
    assert (low, high) == pytest.approx((3.0 - 0.98, 3.0 + 0.98))


def test_what_a_user_has_chosen_goes_to_other_processes():
    """Many cranes are searched at once."""
    chosen = GapOptions(seed=3, plan=False)
    assert pickle.loads(pickle.dumps(chosen)) == chosen
