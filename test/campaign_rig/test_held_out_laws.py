"""Held-out laws are held out: nothing that the package has for their cause fits them, whatever its shape and size.

Runs without noise, of a plant whose base friction is the seed model's, with the effect and without: the difference of
their gaps is the effect alone. Every law of the literature under the cause's name is fitted to it without bounds; what
is left must be a fair share of it. Curves that the data draw do not count: they are the package's answer to other laws.
"""

from dataclasses import replace

import numpy as np
import pytest

from campaign import rig
from campaign.rig.flavour import ALL, FLAVOURS
from campaign.rig.truth import CRANE2
from winch_friction.discrepancy.candidates.candidate import MOVING
from winch_friction.discrepancy.catalogue import candidates_for, run_states
from winch_friction.discrepancy.catalogue import testable as usable_of
from winch_friction.discrepancy.expansion import meet
from winch_friction.physics.signals import Run

LEAST = 0.05  # of the effect's own rms that the package's best law must leave
# found beside the balance of moving samples, each by a detector that knows one law and fits no other
BESIDE = ("presliding", "entrained_air", "slip_leakage", "torque_ripple")
HELD_OUT = [f"{c}:{law.name}" for c, laws in rig.LAWS.items() for law in laws if law.held_out and c not in BESIDE]
OWN = ["churning:catalogue", "line_pressure_drop:check_valve", "low_displacement_loss:quadratic"]


@pytest.fixture(scope="module", autouse=True)
def silent():
    """A way of logging without noise."""
    FLAVOURS["silent"] = replace(
        FLAVOURS["no_reference"], name="silent", pressure_noise=0.0, noise_color=0.0, pressure_step=1e-6, pulses=10**7,
        speed_noise=0.0, channels=ALL, layers=(5, 6),
    )  # fmt: skip
    yield
    del FLAVOURS["silent"]


def _gap(runs, crane, model):
    given = meet([Run(f"run_{k:02d}", columns) for k, columns in enumerate(runs)], crane, model)
    return given.prepared


def _stacked(prepared, columns):
    return np.concatenate([(c.T / run.unit_torque).T[run.used] for run, c in zip(prepared, columns, strict=True)])


def share_left(effect: str, crane, model) -> float:
    """What the package's best law leaves of an effect's gap, as a share of its rms."""
    cause = rig.cause_of(effect)
    with_it, without = (
        _gap(rig.make_dataset(61, "silent", [(effect, size)], CRANE2, length=0.3), crane, model) for size in (1.0, 0.0)
    )
    prepared = [replace(run, used=run.used & null.used) for run, null in zip(with_it, without, strict=True)]
    y = _stacked(prepared, [run.gap - null.gap for run, null in zip(with_it, without, strict=True)])
    states = run_states(
        [replace(run, gap=run.gap - null.gap) for run, null in zip(prepared, without, strict=True)], model
    )
    known = [
        c for c in (*candidates_for(prepared, model), *states) if c.name == cause and c.regime == MOVING and not c.free
    ]
    usable, _ = usable_of(known, prepared, model)
    assert usable, cause
    left = []
    for candidate in usable:
        shapes = candidate.shapes(prepared)
        scores = [_left(candidate, shape, prepared, y) for shape in shapes]
        best = shapes[int(np.argmin(scores))]
        finer = candidate.refined(best).shapes(prepared)[len(shapes) :]
        left.append(min([*scores, *(_left(candidate, shape, prepared, y) for shape in finer)]))
    return min(left) / float(np.sqrt(np.mean(y**2)))


def _left(candidate, shape, prepared, y) -> float:
    x = _stacked(prepared, [candidate.columns(run, shape.values) for run in prepared])
    scale = np.maximum(np.abs(x).max(axis=0), 1e-300)
    beta = np.linalg.lstsq(x / scale, y, rcond=None)[0]
    return float(np.sqrt(np.mean((y - x / scale @ beta) ** 2)))


@pytest.mark.parametrize(
    "effect", [pytest.param(each, marks=pytest.mark.long if k % 4 else []) for k, each in enumerate(HELD_OUT)]
)
def test_no_law_of_the_package_fits_a_held_out_law(effect, crane_150t, crane2_model):
    left = share_left(effect, crane_150t, crane2_model)
    print(effect, left)
    assert left > LEAST


@pytest.mark.parametrize("effect", OWN)
def test_a_law_that_the_package_has_fits(effect, crane_150t, crane2_model):
    """The rule can tell: a law that is not held out leaves next to nothing."""
    left = share_left(effect, crane_150t, crane2_model)
    print(effect, left)
    assert left < LEAST
