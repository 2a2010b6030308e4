"""What a fit is given, where it looks and what it knows beforehand, in numbers by hand."""

from dataclasses import replace

import numpy as np
import pytest

from winch_friction.identification.complex_method import complex_method
from winch_friction.identification.fit import search_box
from winch_friction.identification.fit_data import CountedModel, FitData, contributions, modelled
from winch_friction.identification.friction_curve import FrictionCurve, curve_data, winch_points
from winch_friction.identification.joint_fit import observations
from winch_friction.identification.motor_models import initial_model, motor_model_named, room
from winch_friction.identification.plateaus import Plateau
from winch_friction.identification.prior import UnitSpread
from winch_friction.identification.supplier_table import FitRange, SupplierTable
from winch_friction.identification.verification import _even, _through_standstill, inertia_torque
from winch_friction.physics.channels import BAR, CM3_PER_REV, RPM
from winch_friction.physics.friction import FrictionModel, term_named
from winch_friction.physics.signals import Run

VISCOUS = FrictionModel("viscous", (term_named("viscous"),), (2.0,))


def data(model=VISCOUS):
    """Three speeds on the way up, and twice as fast on the way down, with five motors on the shaft."""
    speed = np.array([10.0, 20.0, 30.0, 20.0, 40.0, 60.0])
    points = winch_points(speed, np.full(6, 1e7), np.full(6, 3e-5), np.full(6, 1e4), 5)
    tests = np.array(["one", "one", "two"])
    found = FitData("by hand", points, np.zeros(3), np.array([1.0, 2.0, 3.0]), tests, tests, copies=2, motors=5.0)
    return replace(found, torque=modelled(model, found))


# -- observations
def test_an_observation_is_the_mean_of_both_ways_per_motor():
    whole = np.asarray(VISCOUS.torque(data().points))
    np.testing.assert_allclose(data().torque, 0.5 * (whole[:3] + whole[3:]) / 5.0)
    np.testing.assert_allclose(data().torque / data().torque[0], [1.0, 2.0, 3.0])
    np.testing.assert_allclose(data().per_observation(10.0), [2.0, 2.0, 2.0])  # what does not depend on the point
    np.testing.assert_allclose(data().per_observation(np.arange(6.0)), np.array([1.5, 2.5, 3.5]) / 5.0)
    parts = contributions(VISCOUS, data())
    np.testing.assert_allclose(sum(parts.values()), data().torque)


def test_a_mask_takes_both_ways_of_an_observation():
    found = data().where(np.array([False, True, True]))
    assert (len(found), found.weight.tolist(), found.group.tolist()) == (2, [2.0, 3.0], ["one", "two"])
    np.testing.assert_allclose(modelled(VISCOUS, found), data().torque[1:])
    np.testing.assert_allclose(found.torque, data().torque[1:])


def test_what_is_locked_is_taken_out_and_the_cost_is_weighted():
    half = VISCOUS.with_values((1.0,))
    np.testing.assert_allclose(data().without(half).torque, 0.5 * data().torque)
    assert data().without(None).torque is not None
    counting = CountedModel(VISCOUS, data())
    assert counting.cost((2.0,)) == pytest.approx(0.0)
    error = 0.5 * data().torque
    assert counting.cost((1.0,)) == pytest.approx(float(np.array([1.0, 2.0, 3.0]) @ error**2))
    np.testing.assert_allclose(counting.columns((7.0,))[:, 0], 0.5 * data().torque)  # linear: torque per unit
    assert counting.evaluations == 3


def test_curves_give_each_speed_both_pressures_and_its_own_test():
    def curve(name, speeds):
        return FrictionCurve(name, speeds, 1e7 + 1e5 * speeds, 8e6 - 1e5 * speeds, 3e-5, 9e3, 11, 9e3 / 250.0 / 11)

    first, second = curve("a", np.array([10.0, 20.0])), curve("b", np.array([30.0]))
    found = curve_data([first, second])
    np.testing.assert_allclose(found.torque, 0.5 * (2e6 + 2e5 * np.array([10.0, 20.0, 30.0])) * 3e-5)
    assert found.group.tolist() == found.cluster.tolist() == ["a", "a", "b"]
    assert (found.copies, found.motors, found.weight.tolist()) == (2, 11, [1.0, 1.0, 1.0])
    np.testing.assert_allclose(found.per_observation(found.points[1]) * 11, [10.0, 20.0, 30.0])
    pressures = [p for p in found.points if np.ndim(p) and np.isclose(p, 8e6 - 3e6).any()]
    assert any(np.allclose(p, [11e6, 12e6, 13e6, 7e6, 6e6, 5e6]) for p in pressures)


def plateau(run, error, **more):
    known = {"start": 0.0, "end": 1.0, "samples": 9, "speed": 50.0, "speed_std": 0.0, "pressure_drop": 1e7,
             "displacement": 3e-5, "drum_torque": 1e4}  # fmt: skip
    return Plateau(run=run, pressure_error=error, **{**known, **more})


def test_a_plateaus_error_is_the_median_of_its_own_test(crane):
    first = [plateau("a", error, speed=speed) for error, speed in ((1.0, 5.0), (9.0, -5.0), (2.0, 7.0))]
    found = observations([first, [plateau("b", 50.0)]], crane)
    assert found.error.tolist() == [2.0, 2.0, 2.0, 50.0]
    assert found.test.tolist() == [0, 0, 0, 1]
    assert found.speed.tolist() == [5.0, -5.0, 7.0, 50.0]
    assert (found.tests, found.motors, found.gear_ratio) == (2, 11, 250.0)
    assert observations([first, []], crane).error.tolist() == [2.0, 2.0, 2.0]


# -- where is looked
def test_a_population_is_drawn_within_three_times_what_a_term_alone_would_need():
    """A torque of 2 N m s/rad is explained by 2: the box ends at 6."""
    lower, upper = search_box(VISCOUS, data())
    assert (lower.tolist(), upper.tolist()) == ([VISCOUS.parameters[0].lower], [pytest.approx(6.0)])
    free = replace(VISCOUS, bounds={VISCOUS.parameter_names[0]: (-1e9, 1e9)})
    lower, upper = search_box(free, data())
    assert (lower.tolist(), upper.tolist()) == ([pytest.approx(-6.0)], [pytest.approx(6.0)])
    tight = replace(VISCOUS, bounds={VISCOUS.parameter_names[0]: (-0.5, 2.5)})
    assert [each.tolist() for each in search_box(tight, data())] == [[-0.5], [2.5]]


@pytest.mark.parametrize("seed", range(4))
def test_the_best_of_all_restarts_is_kept(seed):
    """A population loses its worst alone: no restart ever saw anything better than the result."""
    seen = []

    def cost(x):
        seen.append(float((x[0] ** 2 - 4.0) ** 2 + x[0] + x[1] ** 2))
        return seen[-1]

    box = np.array([5.0, 5.0])
    found = complex_method(cost, -box, box, seed=seed, restarts=3, max_evaluations=45)
    assert found.cost == min(seen)
    assert found.cost == cost(found.x)
    assert (found.restarts, found.converged) == (3, 0)


@pytest.mark.parametrize("cm3", [107.5, 215.0, 430.0])
@pytest.mark.parametrize(("name", "power"), [("K1", 1.0), ("K2", -4.0 / 3.0), ("K3", 0.0), ("K4", 1.0), ("K5", 1.0)])
def test_bounds_grow_with_a_parameter_and_never_shrink(name, power, cm3):
    motor = initial_model(motor_model_named("mj4"), cm3 * CM3_PER_REV)
    own = {each.name: each for each in motor.parameters}[name]
    wider = max((cm3 / 215.0) ** power, 1.0)
    assert room(own, cm3 * CM3_PER_REV) == (own.lower, pytest.approx(own.upper * wider))
    assert motor.bounds_of(name) == (own.lower, pytest.approx(own.upper * wider))


def test_what_is_interpolated_may_have_either_sign():
    signed = initial_model(motor_model_named("ortwig"), 215.0 * CM3_PER_REV)
    assert all(lower == -upper < 0.0 for lower, upper in map(signed.bounds_of, signed.parameter_names))


# -- what is known beforehand
def test_a_spread_is_of_the_value_or_a_tenth_of_the_typical_one():
    (parameter,) = VISCOUS.parameters
    spread = UnitSpread({parameter.name: 0.2}, 0.01, 0.01, 1e5, 0.01)
    for value, size in ((5.0 * parameter.typical, 5.0), (-5.0 * parameter.typical, 5.0), (0.0, 0.1)):
        std = spread.std(replace(VISCOUS, values=(value,), bounds={parameter.name: (-1e9, 1e9)}))
        np.testing.assert_allclose(std, 0.2 * size * abs(parameter.typical))
    other = UnitSpread({}, 0.01, 0.01, 1e5, 0.01)  # of what nobody says the spread is all of it
    np.testing.assert_allclose(other.std(VISCOUS.with_values((parameter.typical,))), abs(parameter.typical))


def supplier(speed, pressure, displacement, **more):
    n = len(speed)
    columns = {"torque_loss": np.arange(1.0, n + 1.0), "weight": np.arange(1.0, n + 1.0), "max_displacement": 3.42e-5}
    return SupplierTable("t", np.array(speed), np.array(pressure), np.array(displacement), **{**columns, **more})


def test_weights_are_equal_the_tables_own_or_of_a_rounded_efficiency():
    table = supplier([100.0, 100.0], [1e7, 2e7], [3e-5, 3e-5])
    assert table.fit_data("equal").weight.tolist() == [1.0, 1.0]
    assert table.fit_data("column").weight.tolist() == [1.0, 2.0]
    np.testing.assert_allclose(table.fit_data().weight, [1.6, 0.4])  # 1 / torque^2, one on average
    np.testing.assert_allclose(table.nominal_torque, [300.0, 600.0])
    np.testing.assert_allclose(table.fit_data().group, np.round(3e-5 / CM3_PER_REV, 1))
    assert table.fit_data().cluster.shape == (2, 2)


def test_the_rows_that_count_are_said_by_their_columns():
    speed, pressure, displacement = [390, 400, 2500, 2600, 1000], [100, 50, 350, 100, 400], [100, 50, 215, 100, 100]
    table = supplier(np.array(speed) * RPM, np.array(pressure) * BAR, np.array(displacement) * CM3_PER_REV)
    assert FitRange().select(table).torque_loss.tolist() == [2.0, 3.0]
    assert FitRange().left_out(table) == (
        "t: 3 of 5 rows are left out: 2 by speed (400 ... 2500 rpm count), 1 by pressure (50 ... 350 bar count)"
    )
    assert FitRange().left_out(FitRange().select(table)) == ""


# -- pressures over time
def test_friction_at_standstill_lies_on_a_line_and_begins_from_none():
    time, friction = np.arange(6.0), np.array([9.0, 9.0, 4.0, 9.0, 9.0, 10.0])
    moving = np.array([False, False, True, False, False, True])
    np.testing.assert_allclose(_through_standstill(time, friction, moving), [0.0, 2.0, 4.0, 6.0, 8.0, 10.0])
    moving[0] = True
    np.testing.assert_allclose(_through_standstill(time, friction, moving), [9.0, 6.5, 4.0, 6.0, 8.0, 10.0])


def test_lost_rows_are_drawn_as_lines_and_layers_as_they_were():
    time = np.delete(np.arange(20) * 0.1, [9, 10])
    run = Run("run", {"time": time, "motor_speed": 5.0 * time, "wire_layer": np.where(time < 1.05, 2.0, 3.0)})
    found = _even(run)
    np.testing.assert_allclose(found.time, np.arange(20) * 0.1)
    np.testing.assert_allclose(found["motor_speed"], 0.5 * np.arange(20))
    assert set(found["wire_layer"]) == {2.0, 3.0}
    assert _even(found) is found


@pytest.mark.parametrize(("winch", "tip"), [(3.0, 0.0), (-3.0, 0.0), (3.0, 0.4), (0.0, 0.4)])
def test_what_accelerates_is_the_winch_and_the_load_on_its_wire(winch, tip, crane):
    """A short wire: the load goes with it. At the shaft J a + m r (r a + heave), r metres per radian."""
    time = np.arange(0.0, 6.0, 0.02)
    one = np.ones(len(time))
    run = Run("run", {"time": time, "motor_speed": winch * time, "heave_velocity": tip * time, "hook_load": 3e4 * one,
                      "wire_layer": 2.0 * one, "wire_out": 1.0 * one})  # fmt: skip
    torque, acceleration = inertia_torque(run, crane)
    lever = 0.867 / 250.0
    np.testing.assert_allclose(acceleration, winch, atol=1e-9)
    np.testing.assert_allclose(torque, 1.54 * winch + 3e4 * lever * (lever * winch + tip), rtol=1e-6)
