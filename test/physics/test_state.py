"""Memory of terms is stepped exactly."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from winch_friction.physics.friction import FrictionModel, term_named
from winch_friction.physics.friction.compiled import advance
from winch_friction.physics.winch import operating_point
from winch_friction.physics.winch.operating_point import smooth_sign, smooth_signs


@given(st.floats(-2, 2), st.floats(-1e3, 1e3), st.floats(0, 1e4), st.floats(1e-5, 1.0))
def test_two_half_steps_are_one(z, gain, decay, dt):
    once = advance(z, gain, decay, dt)
    twice = advance(advance(z, gain, decay, dt / 2), gain, decay, dt / 2)
    assert once == pytest.approx(twice, rel=1e-9, abs=1e-9)


def test_without_decay_it_integrates():
    assert advance(1.0, 3.0, 0.0, 0.5) == pytest.approx(2.5)


def test_settles_where_gain_equals_decay():
    assert advance(0.0, 6.0, 3.0, 100.0) == pytest.approx(2.0)


@given(st.floats(-500, 500, allow_nan=False), st.floats(0.01, 100))
def test_direction_scalar_and_vector_agree(speed, width):
    assert smooth_sign(speed, width) == pytest.approx(float(smooth_signs(speed, width)), abs=1e-15)
    assert abs(smooth_sign(speed, width)) <= 1.0


def test_sign_without_width():
    assert [smooth_sign(v, 0.0) for v in (-1e-9, 0.0, 1e-9)] == [-1.0, 0.0, 1.0]
    assert math.copysign(1.0, smooth_sign(5.0, 3.0)) == 1.0


@pytest.mark.parametrize("lost", [[0], [40], [40, 41, 42]])
def test_a_memory_outlives_a_speed_that_is_lost(lost):
    term = term_named("dwell_stiction")
    model = FrictionModel("dwell", (term,), tuple(each.typical for each in term.parameters))
    time = np.arange(0.0, 2.0, 0.02)
    speed = np.where(time < 1.0, 0.1, 20.0)

    def states(speed):
        x = operating_point(direction=np.sign(speed), speed=speed, drum_torque=5e5, motor_total=11, time=time)
        return model.state_history(x)[0]

    whole, holed = states(speed), states(np.where(np.isin(np.arange(len(time)), lost), np.nan, speed))
    assert whole.max() > 0.2
    assert np.delete(holed, lost) == pytest.approx(np.delete(whole, lost), abs=0.01)
