"""Steps 3 and 4, the second loop and the joint fit on logs of known truth."""

from dataclasses import replace

import numpy as np
import pytest
from cycles import TABLE_2, TABLE_5, cycle, cycles

from winch_friction.identification.bootstrap import bootstrap
from winch_friction.identification.collinearity import identifiable, ties, unseen_directions
from winch_friction.identification.fit_data import modelled
from winch_friction.identification.friction_curve import curve_data, friction_curve
from winch_friction.identification.joint_fit import SENSOR_ERRORS, _Problem, joint_fit, observations, winch_prior
from winch_friction.identification.plateaus import find_plateaus
from winch_friction.identification.prior import supplier_prior
from winch_friction.identification.system_fit import EQUATION_8, combined, fit_system, second_loop
from winch_friction.identification.system_identification import identify_system, winch_seed
from winch_friction.identification.verification import test_errors as errors_of
from winch_friction.physics.channels import BAR, CM3_PER_REV, RPM
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction.correction import Correction
from winch_friction.records.model_file import load_model, save_model


@pytest.fixture(scope="module")
def runs(truth, crane):
    return cycles(truth, crane, TABLE_2)


@pytest.fixture(scope="module")
def curves(runs, crane):
    return [friction_curve(find_plateaus(run, crane), crane) for run in runs]


@pytest.fixture(scope="module")
def data(curves):
    return curve_data(curves)


@pytest.fixture(scope="module")
def plateaus(runs, crane):
    return [find_plateaus(run, crane) for run in runs]


@pytest.fixture(scope="module")
def motor(truth):
    return truth.only("motor").with_covariance(None)


@pytest.fixture(scope="module")
def joint(plateaus, data, crane, motor, spread):
    prior = winch_prior(supplier_prior(motor, spread), fit_system(data, motor).model, "joint")
    return joint_fit(observations(plateaus, crane), prior, spread)


def test_system_parameters_are_recovered(data, motor, truth):
    fitted = fit_system(data, motor).model
    for name, tolerance in (("C1", 0.02), ("C4", 0.04), ("C6", 0.01)):
        assert fitted.value(name) == pytest.approx(truth.value(name), rel=tolerance), name
    assert fitted.value("C5") == pytest.approx(truth.value("C5"), abs=0.003)
    assert fitted.value("C3") == pytest.approx(truth.value("C3"), abs=0.3)


def test_equation_8_finds_no_coulomb_friction(data, motor):
    assert fit_system(data, motor, EQUATION_8).model.value("C2") < 0.15


@pytest.mark.parametrize("terms", [EQUATION_8, ("stribeck", "viscous", "gear_load_loss")])
def test_both_fitters_on_measured_tests(data, motor, terms):
    exact = fit_system(data, motor, terms)
    searched = fit_system(data, motor, terms, "complex", seed=5, restarts=2)
    assert exact.cost <= searched.cost * (1 + 1e-9)
    assert searched.evaluations >= 100 * exact.evaluations


def test_the_cost_is_equation_9(data, motor):
    result = fit_system(data, motor)
    whole = combined(motor, result.model.with_covariance(None), "whole")
    error = data.torque - modelled(whole, data)
    assert np.sum(error**2) == pytest.approx(result.cost, rel=1e-9)


def test_second_loop_lowers_the_cost_and_stops(data, motor):
    wrong = motor.with_values({"K2": 1.25 * motor.value("K2"), "K5": 0.0})
    loops = second_loop(data, wrong)
    costs = [loop.cost for loop in loops]
    assert costs == sorted(costs, reverse=True)
    assert costs[-1] < 0.5 * costs[0]
    assert costs[-1] > 0.99 * costs[-2] or len(loops) == 10
    assert all(after <= 0.99 * before for before, after in zip(costs[:-2], costs[1:-1], strict=True))
    assert abs(loops[-1].motor.value("K2") / motor.value("K2") - 1) < 0.05  # the tests correct the supplier's K2
    assert loops[0].motor.values == wrong.values


def test_a_loop_that_gains_nothing_is_the_last(data, motor):
    assert len(second_loop(data, motor)) == 2


def test_joint_fit_recovers_what_the_tests_determine(joint, truth, crane):
    model = joint.model
    difference = np.array(model.values) - truth.values
    for name, row in identifiable(model, crane.gear_ratio, 11).items():
        assert abs(row @ difference) < 3.5 * np.sqrt(row @ model.covariance @ row), name
    assert 0.7 < joint.noise_scale < 1.5


def test_joint_fit_finds_the_sensors_errors(truth, crane, motor, spread, data):
    """Displacement feedback 1.5 % high, one transducer 0.8 bar high."""
    from dataclasses import replace

    biased = []
    for run in cycles(truth, crane, TABLE_2):
        columns = dict(run.columns)
        columns["main.displacement"] = columns["main.displacement"] * 1.015
        columns["main.pressure_a"] = columns["main.pressure_a"] + 0.8e5
        biased.append(find_plateaus(replace(run, columns=columns), crane))
    prior = winch_prior(supplier_prior(motor, spread), fit_system(data, motor).model, "joint")
    found = joint_fit(observations(biased, crane), prior, spread).sensor_errors
    for name, expected in (("displacement_scale", 0.015), ("pressure_offset", 0.8e5)):
        value, std = found[name]
        assert abs(value - expected) < 3 * std
        assert std < abs(expected) / 2


def test_ties_and_unseen_directions_are_found(joint, plateaus, crane):
    found = {frozenset((tie.first, tie.second)): tie.cosine for tie in ties(joint.model, observations(plateaus, crane))}
    assert found[frozenset(("K1", "C5"))] == pytest.approx(1.0, abs=1e-9)
    assert found[frozenset(("K3", "C6"))] > 0.99
    directions = unseen_directions(joint)
    assert {"K1", "C5"} <= set(str(directions[0]).replace("-", " ").split())
    assert directions[0].seen < 1e-3
    assert any("K3" in str(direction) for direction in directions)


def test_coulomb_of_motor_and_system_are_reported_as_tied(truth, crane, plateaus):
    from winch_friction.identification.system_fit import system_start

    whole = combined(truth.only("motor").with_covariance(None), system_start(EQUATION_8), "eq 8")
    pairs = {frozenset((tie.first, tie.second)) for tie in ties(whole, observations(plateaus, crane))}
    assert frozenset(("K4", "C2")) in pairs


def test_along_a_tie_the_estimate_stays_at_the_prior(joint, motor):
    names = joint.model.parameter_names
    assert joint.model.value("K1") == pytest.approx(motor.value("K1"), rel=1e-3)
    assert joint.model.std[names.index("K1")] == pytest.approx(joint.prior.std[names.index("K1")], rel=1e-3)
    correlation = joint.model.covariance / np.outer(joint.model.std, joint.model.std)
    assert correlation[names.index("K1"), names.index("C5")] < -0.2


def test_bootstrap_and_linearised_covariance_agree(joint, plateaus, crane, spread):
    result = bootstrap(plateaus, crane, joint, spread, resamples=25, seed=3)
    again = bootstrap(plateaus, crane, joint, spread, resamples=25, seed=3)
    np.testing.assert_array_equal(result.estimates, again.estimates)
    ratio = dict(zip(result.names, result.std / result.linearised_std, strict=True))
    for name in ("K2", "K4", "C1", "C4", "C6"):
        assert 0.3 < ratio[name] < 3.0, name


def test_held_out_tests_and_the_seed_file(runs, truth, crane, motor, spread, tmp_path):
    held = cycles(truth, crane, TABLE_5)
    found = identify_system(
        runs, crane, supplier_prior(motor, spread), spread, held_out=held, complex_options={"restarts": 1}
    )
    for model in (found.first_loop, found.last_loop, found.joint.model):
        for error in errors_of(model, [test.curve for test in found.held_out]):
            assert error.worst(above=True) < 1.0
            assert np.isnan(error.worst(above=False)) or error.worst(above=False) < 2.0
    assert len(found.held_out_costs) == len(found.loops)
    seed = winch_seed(found, crane, "my_crane", {"note": "test"})
    again = load_model(save_model(seed, tmp_path / "seed.yaml"))
    assert again.values == pytest.approx(seed.values)
    np.testing.assert_allclose(again.covariance, seed.covariance, rtol=1e-9)
    assert again.constants["gear_ratio"] == 250
    assert any("K3" in text for text in again.provenance["not_determined_by_these_tests"])


def test_hook_only_tests_are_scored_against_the_heaviest(truth, curves):
    errors = errors_of(truth, curves)
    heaviest = max(curve.load_torque for curve in curves)
    assert errors[0].nominal == heaviest
    assert errors[1].nominal == curves[1].load_torque
    assert errors[1].speed[0] < 250 * RPM


def test_what_cannot_be_identified_says_so(crane, truth, motor, spread):
    with pytest.raises(InputError, match="no logged test was given"):
        identify_system([], crane, motor, spread)
    still = cycle(truth, crane, "still.csv", 215, 79, speeds=(1,))
    with pytest.raises(InputError, match=r"still.csv: no stretch of constant speed was found; too few plateaus"):
        identify_system([still], crane, motor, spread)


def test_what_the_motor_model_knows_to_be_wrong_is_taken_out_of_the_tests(runs, crane, truth, spread):
    """Logs with an offset and a tare on a crane file with a wrong radius: identified as from right ones."""
    motor = truth.only("motor")
    known = (
        Correction("pressure_offset", 3 * BAR), Correction("tare_load", -1.5e3), Correction("layer_radius", 0.04),
    )  # fmt: skip
    radii = tuple(radius - 0.04 for radius in crane.drum.layer_radii)
    declared = replace(crane, drum=replace(crane.drum, layer_radii=radii))
    logs = [
        replace(run, columns={
            **run.columns, "main.pressure_a": run["main.pressure_a"] + 3 * BAR, "hook_load": run["hook_load"] + 1.5e3,
        })
        for run in runs
    ]  # fmt: skip
    options = {"restarts": 1, "max_evaluations": 200}
    right = identify_system(runs, crane, motor, spread, complex_options=options)
    found = identify_system(logs, declared, replace(motor, corrections=known), spread, complex_options=options)
    assert found.joint.model.values == pytest.approx(right.joint.model.values, rel=1e-4)
    seed = winch_seed(found, declared, "my_crane", {})
    assert seed.corrections == known
    assert seed.crane == crane.name


def test_what_neither_tests_nor_a_prior_see_is_not_certain(truth, crane, spread):
    """With nothing on the hook: what goes with the load has no column, and the system of a new crane no prior."""
    motor = truth.only("motor")
    found = [find_plateaus(run, crane) for run in cycles(truth, crane, {"a": (215, 0), "b": (164, 0)})]
    system = fit_system(curve_data([friction_curve(each, crane) for each in found]), motor).model
    prior = winch_prior(supplier_prior(motor, spread), system, "empty")
    fitted = joint_fit(observations(found, crane), prior, spread).model
    std = dict(zip(fitted.parameter_names, fitted.std, strict=True))
    for name in ("C1", "C6"):
        assert std[name] >= spread.relative_std[name] * fitted.value(name)
    assert std["K4"] < 0.1 * fitted.value("K4")  # what is seen is as sure as ever


@pytest.mark.parametrize("tonnes", [0.0, -0.2])  # as a load cell says it of an empty hook
def test_nothing_on_the_hook_is_one_load_too(truth, crane, motor, spread, tonnes):
    def shown(run, share):
        return replace(run, columns={**run.columns, "hook_load": np.full(len(run), share * tonnes * 1e3)})

    one, two = cycles(truth, crane, {"a": (215, 0), "b": (164, 0)})
    empty = [shown(one, 1.0), shown(two, 2.0)]
    with pytest.raises(InputError, match="of one load"):
        identify_system(empty, crane, motor, spread)


@pytest.mark.parametrize("gear", [25.0, 5.0])
def test_what_goes_with_the_load_is_found_on_a_winch_of_few_turns(gear, truth, crane, spread):
    """One motor and a small gear: of the drum's torque its shaft loses hundreds of times what one of eleven does."""
    share = 2750.0 / gear  # the same part of the load
    small = replace(
        crane, gear_ratio=gear, groups={"main": 1}, max_displacement=28 * CM3_PER_REV,
        drum=replace(crane.drum, layer_radii=(0.006 * gear,)),
    )  # fmt: skip
    sizes = {"K1": 0.13, "K4": 0.13, "K5": 0.13, "C1": share, "C3": 0.13, "C5": 0.13, "C6": share}
    values = [value * sizes.get(name, 1.0) for name, value in truth.as_dict().items()]
    own = replace(truth, values=tuple(values), covariance=None, bounds={"C1": (0.0, 1.0), "C6": (0.0, 1.0)},
                  constants={"max_displacement": 28 * CM3_PER_REV, "gear_ratio": gear})  # fmt: skip
    tests = {"a": (28, 1.0), "b": (28, 0.5), "c": (20, 0.7), "d": (14, 0.3), "e": (28, 0.1)}
    found = identify_system(
        cycles(own, small, tests), small, replace(own.only("motor"), bounds={}), spread, resamples=4,
        complex_options={"restarts": 1, "max_evaluations": 200},
    )  # fmt: skip
    for fitted in (found.first_loop, found.joint.model):
        for name in ("C1", "C6"):
            assert fitted.value(name) == pytest.approx(own.value(name), rel=0.15), name


def test_sensor_and_load_errors_are_taken_out_as_they_are_stated(plateaus, crane, motor, data, spread):
    """A gain of the feedback, gain and zero of the pressures, a heavier load, each with the sign that is reported."""
    prior = winch_prior(supplier_prior(motor, spread), fit_system(data, motor).model, "joint")
    right = observations(plateaus, crane)
    d_scale, p_scale, p_offset, heavier = 0.02, -0.01, 2.0 * BAR, 0.03
    logged = replace(
        right, displacement=right.displacement * (1.0 + d_scale), drop=right.drop * (1.0 + p_scale) + p_offset
    )
    u = np.zeros(len(prior.values) + 3 + right.tests)
    u[: len(prior.values)] = prior.values / np.maximum(spread.std(prior), 1e-30)
    left = _Problem(right, prior, spread).torque_error(u)
    u[len(prior.values) : len(prior.values) + 3] = np.array([d_scale, p_scale, p_offset]) / [
        getattr(spread, name) for name in SENSOR_ERRORS
    ]
    assert _Problem(logged, prior, spread).torque_error(u) == pytest.approx(left, abs=1e-6)
    u[len(prior.values) + 3] = heavier / spread.load_scale
    more = np.where(right.test == 0, heavier * right.drum_torque / (right.gear_ratio * right.motors), 0.0)
    assert _Problem(logged, prior, spread).torque_error(u) == pytest.approx(left - more, abs=1e-6)
