"""What is made of declared equations, with terms of this file: memory in each group, powers, speed and direction."""

import math
from dataclasses import replace

import numpy as np
import pytest
import sympy as sp

from winch_friction.physics.friction import Parameter
from winch_friction.physics.friction.compiled import CompiledTerms, advance_all, group_point, operating_point
from winch_friction.physics.friction.symbols import CONSTANTS, D, N, X, mu, omega, p, rho, s, w
from winch_friction.physics.friction.term import Scope, State, Term

GAIN, RATE = Parameter("a", "N*m", 2.0), Parameter("b", "rad/s", 3.0, shape=True)
POWER = Parameter("n_own", "1", 1.5, lower=0.5, upper=3.0, shape=True)
Z = sp.Symbol("z_own", real=True)
WARMS = Term("warms", GAIN.symbol * Z, (GAIN,), Scope.MOTOR, "here", "motor",
             state=State(Z, gain=p * 1e-7, decay=w * D * 1e4, initial=0.25))  # fmt: skip
DWELLS = Term("dwells", RATE.symbol * Z, (replace(RATE, shape=False),), Scope.SYSTEM, "here", "gear", opposing=False,
              state=State(Z, gain=s * w, decay=w / 2, initial=-0.5))  # fmt: skip
CURVED = Term("curved", GAIN.symbol * (1 + w / RATE.symbol) ** POWER.symbol + 5 * RATE.symbol**2, (GAIN, RATE, POWER),
              Scope.SHAFT, "here", "gear")  # fmt: skip
SIDED = Term("sided", GAIN.symbol * omega * w + 3 * w**2 * s, (GAIN,), Scope.SHAFT, "here", "gear", opposing=False)
COUNTED = Term("counted", GAIN.symbol * D, (GAIN,), Scope.MOTOR, "here", "motor")


def made(*terms, groups=2, **constants):
    return CompiledTerms(terms, groups, tuple(constants.items()))


def point(speed=-20.0, groups=((3.0, -80e5, 3e-5, 120e5), (8.0, 200e5, 1e-5, 240e5))):
    return operating_point(
        direction=math.copysign(1.0, speed), speed=speed, drum_torque=6e5, motor_total=11.0,
        groups=[tuple(map(float, group_point(*each))) for each in groups],
    )  # fmt: skip


# -- the operating point
@pytest.mark.parametrize(("drop", "higher"), [(-5e5, -1.0), (5e5, 1.0), (0.0, 1.0)])
def test_a_groups_pressures_are_a_size_and_the_port_that_is_higher(drop, higher):
    count, size, both, displacement, port, role = group_point(3, drop, 2e-5, 9e5)
    assert (count, size, both, displacement, float(port), float(role)) == (3, abs(drop), 9e5, 2e-5, higher, 0.0)
    assert group_point(3, drop, 2e-5)[2] == abs(drop)  # of the lower port none is known
    several = group_point(3, np.array([drop, -drop]), 2e-5)
    assert several[1].tolist() == [abs(drop)] * 2


def test_what_is_not_said_of_a_point_is_usual_and_what_is_not_known_is_refused():
    known = {"direction": 1.0, "speed": -4.0, "drum_torque": 1.0, "motor_total": 2.0}
    x = operating_point(**known, groups=[(1.0, 2.0, 3.0, 4.0), (1.0, 2.0, 3.0, 4.0, -1.0, -1.0)])
    assert x[:3] == (1.0, 4.0, -4.0)
    assert x[-12:] == (1.0, 2.0, 3.0, 4.0, 1.0, 0.0, 1.0, 2.0, 3.0, 4.0, -1.0, -1.0)
    with pytest.raises(TypeError, match=r"no such signals: \['colour'\]"):
        operating_point(**known, colour=1.0)
    for wrong in ((1.0, 2.0, 3.0), (1.0, 2.0, 3.0, 4.0, 1.0, 6.0, 7.0)):
        with pytest.raises(TypeError, match=f"not {len(wrong)} values"):
            operating_point(**known, groups=[wrong])


# -- how often a term counts, and with what
def test_a_motors_term_counts_by_its_group_a_systems_by_all_motors_and_a_shafts_once():
    x = point(20.0)
    assert made(COUNTED).scalar_torque(x, (2.0,), ()) == pytest.approx(2.0 * (3 * 3e-5 + 8 * 1e-5))
    flat = replace(COUNTED, equation=GAIN.symbol * sp.Integer(1))
    assert made(flat).scalar_torque(x, (2.0,), ()) == 22.0
    assert made(replace(flat, scope=Scope.SYSTEM)).scalar_torque(x, (2.0,), ()) == 22.0
    assert made(replace(flat, scope=Scope.SHAFT)).scalar_torque(x, (2.0,), ()) == 2.0
    assert made(replace(flat, scope=Scope.SHAFT, equation=GAIN.symbol * N)).scalar_torque(x, (2.0,), ()) == 22.0


def test_a_constant_that_nobody_gives_is_the_usual_one():
    usual = {each.name: each.default or 0.0 for each in CONSTANTS}
    term = replace(COUNTED, equation=GAIN.symbol * (rho + 1e5 * mu + 1e9 * X))
    expected = lambda **given: (
        11.0
        * 2.0
        * sum(
            factor * {**usual, **given}[name]
            for name, factor in (("density", 1), ("viscosity", 1e5), ("max_displacement", 1e9))
        )
    )
    assert usual["density"] > 800.0
    for given in ({}, {"max_displacement": 4e-5, "density": 900.0}):
        assert made(term, **given).scalar_torque(point(20.0), (2.0,), ()) == pytest.approx(expected(**given))
        assert made(term, **given).vector_columns(point(20.0), (2.0,), ())[0] == pytest.approx(0.5 * expected(**given))


# -- derivatives
@pytest.mark.parametrize("speed", [20.0, -20.0])
@pytest.mark.parametrize("terms", [(SIDED,), (CURVED, SIDED)])
def test_torque_and_gradient_in_one_are_the_torque_and_its_slopes(terms, speed):
    functions = made(*terms)
    theta, x = tuple(each.typical for each in functions.parameters), point(speed)

    def torque(change=0.0, k=None, by=0.0):
        moved = operating_point(direction=x[0], speed=speed + by, drum_torque=6e5, motor_total=11.0,
                                groups=[x[-10:-5], x[-5:]])  # fmt: skip
        values = tuple(value + change * (n == k) for n, value in enumerate(theta))
        return functions.scalar_torque(moved, values, ())

    value, by_speed, *by_parameter = functions.scalar_torque_and_gradient(x, theta, ())
    assert value == pytest.approx(torque(), rel=1e-12)
    assert by_speed == pytest.approx((torque(by=1e-4) - torque(by=-1e-4)) / 2e-4, rel=1e-6)
    slopes = [(torque(1e-5, k) - torque(-1e-5, k)) / 2e-5 for k in range(len(theta))]
    assert by_parameter == pytest.approx(slopes, rel=1e-6)
    assert np.asarray(functions.vector_gradient(x, theta, ()), float) == pytest.approx(slopes, rel=1e-6)
    assert sum(functions.scalar_contributions(x, theta, ())) == pytest.approx(value)


def test_the_columns_are_what_each_linear_parameter_multiplies():
    functions = made(CURVED, COUNTED, SIDED)
    x = point(20.0)
    (column,) = functions.vector_columns(x, (2.0, 3.0, 1.5), ())
    assert [each.name for each in functions.parameters] == ["a", "b", "n_own"]
    assert column == pytest.approx((1 + 20.0 / 3.0) ** 1.5 + 3 * 3e-5 + 8 * 1e-5 + 400.0)


# -- memory
def test_each_group_has_its_own_memory_and_a_system_one():
    functions = made(DWELLS, WARMS)
    assert functions.initial_states == (-0.5, 0.25, 0.25)
    x = point()
    assert functions.scalar_state_rates(x, (3.0, 2.0), (0.0,) * 3) == pytest.approx(
        (-20.0, 10.0, 0.8, 20.0 * 0.3, 2.0, 20.0 * 0.1)
    )
    torque = functions.scalar_torque(x, (3.0, 2.0), (0.5, 1.0, 10.0))
    assert torque == pytest.approx(11 * 3.0 * 0.5 - 2.0 * (3 * 1.0 + 8 * 10.0))
    stepped = advance_all(functions, x, (3.0, 2.0), (0.5, 1.0, 10.0), 0.1)
    expected = [
        target + (z - target) * math.exp(-decay * 0.1)
        for z, target, decay in ((0.5, -2.0, 10.0), (1.0, 0.8 / 6.0, 6.0), (10.0, 1.0, 2.0))
    ]
    assert stepped == pytest.approx(expected)
    assert made(DWELLS, WARMS, groups=1).initial_states == (-0.5, 0.25)
    assert advance_all(made(SIDED), x, (1.0,), (), 0.1) == ()


# -- what is made once and kept
def test_functions_are_shared_by_those_alone_whose_every_part_is_the_same():
    first = made(WARMS, max_displacement=3e-5)
    state = WARMS.state
    others = [
        made(WARMS, max_displacement=4e-5), made(WARMS, groups=1, max_displacement=3e-5),
        *(made(replace(WARMS, **each), max_displacement=3e-5) for each in (
            {"scope": Scope.SYSTEM, "equation": Z, "state": replace(state, gain=w, decay=w)}, {"opposing": False},
            {"state": replace(state, gain=2 * state.gain)}, {"state": replace(state, decay=2 * state.decay)},
            {"equation": 2 * WARMS.equation}, {"parameters": (GAIN, RATE)},
        )),
    ]  # fmt: skip
    keys = [each._key for each in (first, *others)]
    assert len(set(keys)) == len(keys)
    assert made(WARMS, max_displacement=3e-5)._key == first._key
    assert made(replace(WARMS, name="other", source="there"), max_displacement=3e-5)._key == first._key
    flat = replace(COUNTED, equation=GAIN.symbol * sp.Integer(1))
    apart = [made(replace(flat, scope=scope))._key for scope in Scope]
    assert len(set(apart)) == 3
