"""What a fit is given, where it looks and what it knows beforehand, in numbers by hand."""

from dataclasses import replace

import numpy as np
import pytest

from winch_friction.identification import least_squares as module
from winch_friction.identification.complex_method import complex_method
from winch_friction.identification.fit import (
    METHODS,
    clustered_covariance,
    condition_number,
    exchangeable,
    fit,
    search_box,
)
from winch_friction.identification.fit_data import CountedModel, FitData, contributions, modelled
from winch_friction.identification.friction_curve import FrictionCurve, curve_data, winch_points
from winch_friction.identification.joint_fit import (
    SENSOR_ERRORS,
    Observations,
    _Problem,
    joint_fit,
    observations,
    winch_prior,
)
from winch_friction.identification.least_squares import bounded_linear, least_squares
from winch_friction.identification.motor_models import initial_model, motor_model_named, room
from winch_friction.identification.plateaus import Plateau
from winch_friction.identification.prior import UnitSpread
from winch_friction.identification.supplier_table import FitRange, SupplierTable
from winch_friction.identification.verification import _even, _through_standstill, inertia_torque
from winch_friction.physics.channels import BAR, CM3_PER_REV, RPM
from winch_friction.physics.errors import InputError
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
    np.testing.assert_allclose(counting.columns()[:, 0], 0.5 * data().torque)  # linear: torque per unit
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


# -- what a fit says of itself
BENT = FrictionModel("bent", (term_named("stribeck"), term_named("viscous")), (1e-3, 10.0, 20.0, 0.5))


def bent_data(weight=None):
    """Eight speeds of a friction that falls and rises again, with errors of a tenth of it."""
    speed = np.array([2.0, 5.0, 9.0, 15.0, 25.0, 40.0, 70.0, 120.0])
    n = len(speed)
    points = winch_points(speed, np.full(n, 1e7), np.full(n, 3e-5), np.where(np.arange(n) % 2, 2e4, 5e3), 1)
    clusters = np.arange(n) // 2
    found = FitData("bent", points, np.zeros(n), np.ones(n) if weight is None else weight, clusters, clusters)
    torque = modelled(BENT, found)
    return replace(found, torque=torque * (1.0 + 0.1 * np.sin(3.0 * np.arange(n))))


@pytest.mark.parametrize("method", METHODS)
def test_a_fit_says_its_errors_and_its_jacobian_where_it_ends(method):
    """Not where it began: a Stribeck curve's columns move with its speed."""
    data = bent_data(np.linspace(0.5, 2.0, 8))
    options = {"restarts": 1, "max_evaluations": 300} if method == "complex" else {}
    found = fit(BENT.with_values((5e-4, 3.0, 60.0, 0.1)), data, method, seed=1, **options)
    errors = data.torque - modelled(found.model, data)
    values = np.array(found.model.values)
    columns = np.empty((8, 4))
    for k, step in enumerate(1e-5 * values):
        ends = (found.model.with_values(values + sign * step * (np.arange(4) == k)) for sign in (1.0, -1.0))
        one, other = (modelled(each, data) for each in ends)
        columns[:, k] = (one - other) / (2.0 * step)
    weighted = columns * np.sqrt(data.weight)[:, None]
    assert found.cost == pytest.approx(float(data.weight @ errors**2))
    assert found.rms == pytest.approx(float(np.sqrt(np.mean(errors**2))))
    assert found.condition == pytest.approx(np.linalg.cond(weighted / np.linalg.norm(weighted, axis=0)), rel=1e-4)
    sizes = np.maximum(np.abs(values), [abs(each.typical) for each in found.model.parameters])
    expected = clustered_covariance(columns, errors, data, sizes)
    np.testing.assert_allclose(found.model.covariance, expected, rtol=1e-3)
    assert (found.observations, found.parameter_count, found.method) == (8, 4, method)


def test_a_population_is_drawn_anew_by_another_seed():
    ends = [fit(BENT, bent_data(), "complex", seed=s, restarts=1, max_evaluations=40).model.values for s in (1, 1, 2)]
    assert ends[0] == ends[1] != ends[2]


def test_as_many_observations_as_parameters_are_enough_and_one_less_is_not():
    bent = bent_data()
    assert fit(VISCOUS, bent.where(np.arange(8) == 3)).observations == 1
    assert fit(VISCOUS, data()).observations == 3  # one of both ways
    with pytest.raises(InputError, match="bent: 2 observations cannot determine the 4 parameters of 'bent'"):
        fit(BENT, bent.where(np.arange(8) < 2))


def spread_of(design, target, labels, weight=None):
    n = len(target)
    data = FitData("clusters", (), target, np.ones(n) if weight is None else weight, labels, labels)
    return clustered_covariance(np.asarray(design, float), np.asarray(target, float), data, np.ones(len(design[0])))


@pytest.mark.parametrize("unit", [1.0, 1e-6, 1e9])
def test_the_spread_of_a_mean_is_that_of_the_means_that_leave_a_cluster_out(unit):
    """One parameter, the mean: three clusters of two; the jackknife is (n - 1)/n times the sum of squared shifts."""
    values = np.array([1.0, 3.0, 5.0, 4.0, 9.0, 8.0])
    labels = np.array([0, 0, 1, 1, 2, 2])
    left_out = np.array([values[labels != k].mean() for k in range(3)])
    (found,) = spread_of(np.full((6, 1), unit), values - values.mean(), labels)
    assert found[0] * unit**2 == pytest.approx(2.0 / 3.0 * ((left_out - values.mean()) ** 2).sum())
    both = spread_of(np.full((6, 1), unit), values - values.mean(), np.column_stack([labels, labels]))
    assert both[0, 0] == pytest.approx(2.0 * found[0])  # the spreads over both ways of clustering are added


def test_of_one_cluster_alone_the_spread_is_that_of_its_errors():
    errors = np.array([1.0, -1.0, 3.0, -3.0])
    found = spread_of(np.ones((4, 1)), errors, np.zeros(4, int))
    assert found[0, 0] == pytest.approx(np.var(errors) / 4.0)


@pytest.mark.parametrize("unit", [1.0, 1e-6])
def test_what_no_observation_saw_is_as_unsure_as_its_size(unit):
    design = np.column_stack([np.full(4, unit), np.zeros(4)])
    data = FitData("blind", (), np.zeros(4), np.ones(4), np.arange(4), np.arange(4))
    found = clustered_covariance(design, np.array([1.0, -1.0, 2.0, -2.0]), data, np.array([7.0, 30.0]))
    assert found[1, 1] == pytest.approx(900.0)
    assert found[0, 1] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("unit", [1.0, 1e-6, 1e6])
def test_what_two_columns_leave_open_is_as_unsure_as_both_sizes_whatever_their_unit(unit):
    """Sizes of 6 and 8 of two that do the same: of what one gains and the other loses nothing is known."""
    where = np.arange(4)
    blind = FitData("blind", (), np.zeros(4), np.ones(4), where, where)
    found = clustered_covariance(np.full((4, 2), unit), np.zeros(4), blind, np.array([6.0, 8.0]))
    np.testing.assert_allclose(found, [[25.0, -25.0], [-25.0, 25.0]], rtol=1e-6)


def test_a_parameter_that_was_fitted_to_nothing_is_as_unsure_as_it_typically_is():
    """At rest there is no viscous torque, and its parameter comes to zero."""
    still = winch_points(np.zeros(6), np.full(6, 1e7), np.full(6, 3e-5), np.full(6, 1e4), 5)
    found = fit(VISCOUS, replace(data(), points=still, torque=np.zeros(3))).model
    assert found.values == (0.0,)
    assert found.std[0] == pytest.approx(VISCOUS.parameters[0].typical)


def test_what_one_cluster_alone_saw_has_an_error_that_all_its_observations_share():
    """The second column is seen in the last two rows alone: their common error has the size of all errors."""
    errors = np.array([1.0, -1.0, 2.0, -2.0, 1.0, 1.0])
    design = np.column_stack([[1.0, 1.0, 1.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0, 1.0, 1.0]])
    found = spread_of(design, errors, np.array([0, 0, 1, 1, 2, 2]))
    assert found[1, 1] == pytest.approx(np.mean(errors**2))


@pytest.mark.parametrize(("slant", "expected"), [(1e-3, True), (3e-15, False)])
def test_two_columns_that_are_one_but_for_rounding_have_no_condition(slant, expected):
    columns = np.array([[1.0, 1.0], [0.0, slant]])
    assert np.isfinite(condition_number(columns)) == expected
    assert condition_number(columns * [1e6, 1e-6]) == pytest.approx(condition_number(columns), rel=1e-6)


def test_what_can_be_exchanged_is_named_by_every_parameter_that_takes_part():
    """The third column is made of the first two, to unlike parts; the fourth stands alone, the fifth is nothing."""
    a, b, c = np.eye(5)[:3]
    jacobian = np.column_stack([a, b, 0.1 * a + 0.9 * b, c, 0.0 * a])
    assert exchangeable(jacobian, ["A", "B", "C", "D", "E"]) == ("A", "B", "C")
    assert exchangeable(jacobian[:, [0, 1, 3, 4]], ["A", "B", "D", "E"]) == ()


def test_a_shape_is_looked_for_in_all_of_its_bounds():
    """What a term alone could need says nothing of a speed at which a curve bends."""
    sharp = BENT.with_values({"C4": 2.0})  # a torque that bends away at once changes much with its bend
    lower, upper = search_box(sharp, replace(bent_data(), torque=modelled(sharp, bent_data())))
    assert [each.shape for each in sharp.parameters] == [False, False, True, False]
    assert (lower[2], upper[2]) == BENT.bounds_of("C4")
    assert upper[1] < 1e3 < BENT.bounds_of("C5")[1]
    held = replace(VISCOUS, values=(60.0,), bounds={VISCOUS.parameter_names[0]: (50.0, 90.0)})  # beyond what is needed
    assert [each.tolist() for each in search_box(held, data())] == [[50.0], [50.0]]


def test_every_column_of_a_jacobian_is_counted_and_every_observation_has_all_its_columns():
    counting = CountedModel(BENT, bent_data())
    counting.columns()
    assert counting.evaluations == 4
    counting.torque(BENT.values)
    counting.cost(BENT.values)
    assert counting.evaluations == 6
    for name in ("torque", "weight", "group", "cluster"):
        with pytest.raises(InputError, match="bent: torque, weight, group and cluster must have one entry per"):
            replace(bent_data(), **{name: np.ones(7)})


# -- least squares
def test_every_square_counts_by_its_weight():
    noisy = replace(data(), torque=data().torque * np.array([1.0, 1.3, 0.8]))
    column, weight = data().torque / 2.0, noisy.weight
    found = least_squares(VISCOUS, noisy)
    assert found.values[0] == pytest.approx((weight * column) @ noisy.torque / ((weight * column) @ column))


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e9])
def test_what_would_fit_best_beyond_a_bound_ends_on_it_whatever_the_size_of_its_column(size):
    """Two columns at right angles of which each is wanted five times, one that is in the way of none, and nothing."""
    columns = np.column_stack([[size, 0.0, 0.0], [0.0, size, 0.0], [0.0, 0.0, size], np.zeros(3)])
    lower, upper = np.array([0.0, 0.0, -1.0, 0.0]) / size, np.array([2.0, 9.0, 1.0, 1.0]) / size
    found = bounded_linear(columns, np.array([5.0, 5.0, -5.0]), lower, upper)
    np.testing.assert_allclose(found[:3] * size, [2.0, 5.0, -1.0], rtol=1e-9)
    assert ((found >= lower) & (found <= upper)).all()


@pytest.mark.parametrize("bend", [1.5, 3.0, 8.0, 20.0, 60.0, 180.0])
def test_a_bend_is_found_wherever_it_is_and_the_columns_that_are_used_are_counted(monkeypatch, bend):
    """A viscous column once, and for each bend that is tried the two of the Stribeck term, not the bend's own."""
    solved = []
    real = module.bounded_linear
    monkeypatch.setattr(module, "bounded_linear", lambda *given: solved.append(1) or real(*given))
    truth = BENT.with_values({"C4": bend})
    found = least_squares(BENT, replace(bent_data(), torque=modelled(truth, bent_data())))
    assert found.values == pytest.approx(truth.values, rel=1e-3)
    assert found.evaluations == 1 + 2 * len(solved)


def test_two_bends_are_looked_for_together():
    both = (term_named("stribeck"), term_named("churning_viscous"))
    start = FrictionModel("two", both, tuple(p.typical for term in both for p in term.parameters))
    assert sum(each.shape for each in start.parameters) == 2
    found = least_squares(start, bent_data())
    one = least_squares(start.subset(["stribeck"]), bent_data())
    assert found.cost < one.cost


# -- the joint fit
MOTORS, GEAR = 11, 250.0
PRIOR = FrictionModel(
    "prior",
    (term_named("coulomb"), term_named("viscous")),
    (20.0, 0.5),
    covariance=np.array([[16.0, 0.3], [0.3, 0.01]]),
)
SPREAD = UnitSpread({"C2": 0.2, "C5": 0.2}, 0.01, 0.002, 5e4, 0.03)


def joint_data(errors=0.0, error=2e4, model=PRIOR):
    """Two tests of other loads, both ways, whose drops carry load and friction, and so much more, Pa."""
    speed = np.array([20.0, 60.0, 120.0, -20.0, -60.0, -120.0] * 2)
    test, displacement = np.repeat([0, 1], 6), np.full(12, 3e-5)
    drum = np.where(test == 0, 2e5, 6e5)
    friction = np.array([model.value("C2") + model.value("C5") * abs(each) for each in speed])
    drop = (drum / (GEAR * MOTORS) + np.sign(speed) * friction) / displacement + errors  # friction is per motor
    return Observations(speed, drop, np.full(12, error), displacement, drum, test, MOTORS, GEAR)


def unknowns(problem, theta):
    return np.concatenate([np.array(theta) / problem.scale, np.zeros(5)])


def test_what_load_and_friction_do_not_explain_is_an_error_per_motor_either_way():
    shift = np.linspace(-3e5, 4e5, 12)
    problem = _Problem(joint_data(shift), PRIOR, SPREAD)
    left = problem.torque_error(unknowns(problem, PRIOR.values))
    np.testing.assert_allclose(left, shift * 3e-5, rtol=1e-9)
    loads = unknowns(problem, PRIOR.values)
    loads[-1] = 1.0  # the second test's load is larger by its tolerance
    more = np.where(np.repeat([0, 1], 6) == 1, 0.03 * 6e5 / (GEAR * MOTORS), 0.0)
    np.testing.assert_allclose(problem.torque_error(loads), shift * 3e-5 - more, rtol=1e-9)


@pytest.mark.parametrize(("error", "sigma"), [(2e4, 2e4), (10.0, 1e3)])
def test_the_noise_is_that_of_the_plateaus_beside_what_their_errors_say(error, sigma):
    """Twelve plateaus, of which two parameters, three sensors and two loads take seven; 0.01 bar at least."""
    shift = np.linspace(-3e5, 4e5, 12)
    problem = _Problem(joint_data(shift, error), PRIOR, SPREAD)
    expected = np.sqrt(np.sum((shift / sigma) ** 2) / 5.0)
    assert problem.noise(unknowns(problem, PRIOR.values)) == pytest.approx(expected)


def test_a_prior_pulls_by_its_covariance_and_not_at_what_it_does_not_know():
    problem = _Problem(joint_data(), PRIOR, SPREAD)
    off = np.array([3.0, -0.2])
    pulled = problem.residuals(unknowns(problem, PRIOR.values + off), 1.0)[12:14]
    assert pulled @ pulled == pytest.approx(off @ np.linalg.solve(PRIOR.covariance, off))
    free = _Problem(joint_data(), PRIOR.with_covariance(np.diag([16.0, 0.0])), SPREAD)
    pulled = free.residuals(unknowns(free, PRIOR.values + off), 1.0)[12:14]
    assert pulled @ pulled == pytest.approx(9.0 / 16.0)


def test_data_that_say_nothing_leave_prior_and_tolerances_as_they_are():
    found = joint_fit(joint_data(error=1e18), PRIOR, SPREAD)
    np.testing.assert_allclose(found.model.values, PRIOR.values, rtol=1e-6)
    np.testing.assert_allclose(found.model.covariance, PRIOR.covariance, rtol=1e-5)
    for name in SENSOR_ERRORS:
        assert found.sensor_errors[name] == (pytest.approx(0.0, abs=1e-12), pytest.approx(getattr(SPREAD, name)))
    assert np.abs(found.information).max() < 1e-9


def test_plateaus_that_scatter_more_than_they_say_are_believed_less():
    """What the data alone say is the information of a fit in which sensors and loads may have their errors too."""
    wild = 6e4 * np.where(np.arange(12) % 3 == 1, 1.0, -0.5)
    data = joint_data(wild)
    found = joint_fit(data, PRIOR, SPREAD)
    problem = _Problem(data, PRIOR, SPREAD)
    assert found.noise_scale == pytest.approx(problem.noise(problem.solve(1.0).x), rel=1e-6)
    assert found.noise_scale > 2.0
    solution = problem.solve(found.noise_scale)
    errors = np.zeros((12, 7))
    for k in range(7):
        step = 1e-4 * (np.arange(7) == k)
        ends = (problem.torque_error(solution.x + sign * step) for sign in (1.0, -1.0))
        one, other = ends
        errors[:, k] = (one - other) / 2e-4 / (problem.sigma * found.noise_scale)
    whole = errors.T @ errors + np.diag([0.0] * 2 + [1.0] * 5)
    alone = np.linalg.inv(np.linalg.inv(whole)[:2, :2])
    np.testing.assert_allclose(found.information, alone, rtol=1e-3)
    root = np.linalg.inv(PRIOR.covariance / np.outer(problem.scale, problem.scale))
    posterior = np.linalg.inv(alone + root) * np.outer(problem.scale, problem.scale)
    np.testing.assert_allclose(found.model.covariance, posterior, rtol=1e-3)
    np.testing.assert_allclose(found.residuals, problem.torque_error(solution.x), atol=1e-4)


def test_the_prior_of_a_winch_knows_the_motor_and_leaves_the_system_free():
    motor = FrictionModel("motor", (term_named("motor_coulomb"),), (5.0,), covariance=np.array([[4.0]]))
    found = winch_prior(motor, PRIOR, "both")
    assert (found.name, found.parameter_names, found.values) == ("both", ("K4", "C2", "C5"), (5.0, 20.0, 0.5))
    assert found.covariance.tolist() == [[4.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]
