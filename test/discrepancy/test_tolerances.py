"""A delay within a sample and a zero within a transducer's step are no names, whatever they take off a gap."""

from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.estimates import takes_little, within_a_sample, within_a_step

WARMTH = np.linspace(-1.0, 1.0, 201)


@pytest.mark.parametrize(("late", "step", "named"), [(0.004, 0.02, False), (0.014, 0.01, True), (0.014, 0.02, True)])
def test_a_delay_within_half_a_sample_is_no_name(late, step, named):
    found, side = {"tau": SimpleNamespace(value=-late)}, SimpleNamespace(runs=[SimpleNamespace(dt=step)])
    assert (within_a_sample({"signal_delay": found}, side) == "") is named
    assert within_a_sample({}, side) == ""


@pytest.mark.parametrize("name", ["pressure_offset", "torque_offset", "tare_load"])
@pytest.mark.parametrize(
    ("zero", "drift", "named"),
    [(0.0, 0.2, False), (0.1, 0.15, False), (0.2, 0.0, True), (0.0, 0.3, True), (-0.2, 0.0, True), (-0.1, 0.0, False)],
)
def test_a_zero_within_a_step_is_no_name_however_it_moves(zero, drift, named, name):
    """0.2 bar over the warmth are 0.12 in the mean; a 12-bit transducer of 600 bar steps by 0.15 bar. 13 kg of 15 t,
    by which a load cell and a drive's torque were off, were a tare of a winch that lacks nothing."""
    zeros = Slot(name, "thermal zero shift", (1, 2))
    x = np.column_stack([np.full(201, 9.0), np.ones(201), WARMTH])
    problem = SimpleNamespace(
        blocks=SimpleNamespace(x=x), columns=lambda slots: (0, *(c for s in slots for c in s.columns))
    )
    fitted = SimpleNamespace(slots=(zeros,), beta=np.array([5.0, zero, drift]))
    assert (within_a_step(SimpleNamespace(problem=problem), [fitted], 0.1) == "") is named


def test_what_does_as_well_as_a_zero_within_a_step_is_no_name_either():
    """Once the tare was refused its rival, a gear's friction one way that hardly follows the load, had its name."""
    zero, gear = Slot("tare_load", "", (1,)), Slot("gear_asymmetry", "", (2,))
    x = np.column_stack([np.full(201, 9.0), np.ones(201), 1.0 + 0.01 * WARMTH])
    problem = SimpleNamespace(
        blocks=SimpleNamespace(x=x), columns=lambda slots: (0, *(c for s in slots for c in s.columns))
    )
    one, other = (SimpleNamespace(slots=(slot,), beta=np.array([5.0, 0.1])) for slot in (gear, zero))
    assert within_a_step(SimpleNamespace(problem=problem), [one], 0.1) == ""
    assert within_a_step(SimpleNamespace(problem=problem), [one, other], 0.1)


def test_another_name_of_that_size_is_none_of_a_transducers_zeros():
    gain = Slot("pressure_scale", "", (1, 2))
    problem = SimpleNamespace(blocks=SimpleNamespace(x=np.ones((9, 3))), columns=lambda slots: (0, 1, 2))
    fitted = SimpleNamespace(slots=(gain,), beta=np.array([0.0, 0.01, 0.0]))
    assert within_a_step(SimpleNamespace(problem=problem), [fitted], 0.1) == ""


@pytest.mark.parametrize(
    ("whole", "left", "little"),
    [(0.77, 0.72, True), (0.77, 0.3, False), (-0.8, -0.9, True), (0.0, -0.5, True), (9.0, 4.6, True)],
)
def test_names_that_take_less_than_half_of_what_a_refit_leaves_take_little(whole, left, little):
    """A ripple's remains were 0.77 of the noise's square; a high-pressure loss took a fifteenth of it and was named."""
    assert (
        takes_little(SimpleNamespace(excess=lambda each: {"refit": whole, "names": left}[each]), "refit", "names")
        is little
    )
