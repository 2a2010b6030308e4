"""Predicted pressures against a plant that is written down here: balance, direction, wire, standstill."""

from dataclasses import replace

import numpy as np
import pytest
from cycles import cycle

from winch_friction.identification.friction_curve import FrictionCurve
from winch_friction.identification.verification import PressureCheck, inertia_torque, pressure_check
from winch_friction.identification.verification import test_errors as errors_of
from winch_friction.physics.channels import BAR, CM3_PER_REV, RPM
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import term_named
from winch_friction.physics.signals import Run
from winch_friction.physics.winch import operating_point


def ahc_run(model, crane, active=215.0, load=55e3, tare=0.0):
    """Slow heave compensation: 3 active motors, 8 passive at 70 cm^3/rev and 275 bar; rigid torque balance."""
    time = np.arange(0.0, 60.0, 0.02)
    speed = 120.0 * np.tanh(3 * np.sin(2 * np.pi * time / 30.0))
    acceleration = np.gradient(speed, time)
    count = np.ones_like(time)
    passive, displacement = 275 * BAR * count, active * CM3_PER_REV
    torque = crane.drum_torque(load)
    inertia = (crane.inertia + crane.load_inertia(load)) * acceleration
    drop = 0.0 * count
    for _ in range(20):
        x = operating_point(
            direction=np.sign(speed), speed=speed, drum_torque=torque * count, motor_total=11.0 * count,
            groups=[(3.0 * count, np.abs(drop), count, displacement * count),
                    (8.0 * count, passive, count, 70 * CM3_PER_REV * count)],
        )  # fmt: skip
        carried = torque / 250 + inertia + model.torque(x) - 8 * 70 * CM3_PER_REV * passive
        drop = carried / (3 * displacement)
    return Run(
        "ahc",
        {
            "time": time, "motor_speed": speed, "hook_load": load * count,
            "active.pressure_a": 25 * BAR + drop + tare, "active.pressure_b": 25 * BAR * count,
            "active.displacement": displacement * count, "passive.pressure_a": 300 * BAR * count,
            "passive.pressure_b": 25 * BAR * count, "passive.displacement": 70 * CM3_PER_REV * count,
        },
    )  # fmt: skip


@pytest.mark.parametrize("active", [215.0, 160.0])
def test_the_active_group_carries_all_the_friction(truth, crane, active):
    check = pressure_check(ahc_run(truth, crane, active), crane, truth)
    assert check.group == "active"
    assert check.moving_rms < 0.6 * BAR
    assert np.ptp(check.measured) > 80 * BAR


def test_a_friction_error_has_opposite_signs_and_a_tare_error_one(truth, crane):
    weak = truth.with_values({"K4": 0.8 * truth.value("K4")}).with_covariance(None)
    check = pressure_check(ahc_run(truth, crane), crane, weak)
    assert check.mean_error(+1) == pytest.approx(-check.mean_error(-1), rel=0.1)
    assert check.mean_error(+1) < -2 * BAR
    tared = pressure_check(ahc_run(truth, crane, tare=3 * BAR), crane, truth)
    assert tared.mean_error(+1) == pytest.approx(-3 * BAR, abs=0.3 * BAR)
    assert tared.mean_error(-1) == pytest.approx(-3 * BAR, abs=0.3 * BAR)


def test_a_known_displacement_error_is_taken_out(truth, crane):
    run = ahc_run(truth, crane)
    wrong = {name: values * (1.02 if "displacement" in name else 1.0) for name, values in run.columns.items()}
    biased = Run("ahc", wrong)
    assert pressure_check(biased, crane, truth).moving_rms > 2 * BAR
    assert pressure_check(biased, crane, truth, 0.02).moving_rms < 0.6 * BAR


def test_normal_mode_plateaus(truth, crane):
    run = cycle(truth, crane, "t", 215, 79, noise=0.0)
    check = pressure_check(run, crane, truth)
    still = np.abs(np.gradient(run["motor_speed"], run.time)) < 1e-6
    moving = still & (np.abs(run["motor_speed"]) > 15 * RPM)
    inner = np.convolve(moving, np.ones(25), mode="same") > 24.5  # not beside a ramp
    assert np.abs(check.predicted - check.measured)[inner].max() < 0.05 * BAR


def with_term(model, name, size=1.0):
    """The model and one more term, at its typical values times `size`."""
    term = term_named(name)
    values = (*model.values, *(size * each.typical for each in term.parameters))
    return replace(model, terms=(*model.terms, term), values=values, covariance=None)


def test_a_loss_with_the_pressure_in_the_case_is_predicted_with_the_pressures_there(truth, crane):
    """Both ports' pressures belong to it; the lower one had been taken for zero."""
    run = ahc_run(truth, crane)
    plain, more = (pressure_check(run, crane, model) for model in (truth, with_term(truth, "case_pressure")))
    sums = {group: run[f"{group}.pressure_a"] + run[f"{group}.pressure_b"] for group in run.groups}
    loss = 5.0e-7 * sum(crane.motor_count(group) * sums[group] for group in run.groups)
    fast = np.abs(run["motor_speed"]) > 50.0
    expected = np.sign(run["motor_speed"]) * loss / (3 * 215 * CM3_PER_REV)
    np.testing.assert_allclose((more.predicted - plain.predicted)[fast], expected[fast], rtol=0.03)


def test_a_loss_with_the_oil_is_predicted_at_the_oil_there(truth, crane):
    """It had been predicted at 40 degC throughout."""
    run, model = ahc_run(truth, crane), with_term(truth, "viscosity_temperature", 10.0)

    def sizes(temperature):
        columns = {**run.columns, "oil_temperature": np.full(len(run), temperature)}
        return np.ptp(pressure_check(Run("oil", columns), crane, model).predicted)

    assert sizes(10.0) > sizes(40.0) + 1 * BAR
    assert sizes(70.0) < sizes(40.0) - 0.2 * BAR
    with pytest.raises(InputError, match="oil_temperature"):
        pressure_check(run, crane, model)


def test_the_load_swings_on_its_wire(crane):
    """Far below the wire's resonance the load follows; at half of it, it overshoots by 1 / (1 - 1/4)."""
    load, length = 55e3, 50.0
    natural = np.sqrt(crane.wire_stiffness / length / load)
    gains = []
    for frequency in (0.05 * natural, 0.5 * natural):
        time = np.arange(0.0, 200.0, 0.02)
        speed = 10.0 * np.sin(frequency * time)
        columns = {"time": time, "motor_speed": speed, "hook_load": np.full_like(time, load),
                   "wire_out": np.full_like(time, length), "main.displacement": np.full_like(time, 3e-5)}  # fmt: skip
        torque, acceleration = inertia_torque(Run("swing", columns), crane)
        of_load = torque - crane.inertia * acceleration
        gains.append(np.abs(of_load[5000:]).max() / (crane.load_inertia(load) * 10.0 * frequency))
    assert gains[0] == pytest.approx(1.0, rel=0.02)
    assert gains[1] == pytest.approx(4 / 3, rel=0.05)


@pytest.mark.parametrize("begin", [3.0, 8.0, 20.0])
def test_a_record_that_is_cut_out_of_the_motion_begins_without_a_swing(truth, crane, begin):
    """The load moves with its wire when the record begins: it does not start from rest."""
    run = ahc_run(truth, crane)
    kept = run.time >= begin
    cut = {name: values[kept] for name, values in run.columns.items()}
    cut["wire_out"] = np.full(kept.sum(), 400.0)
    assert pressure_check(Run("cut", cut), crane, truth).moving_rms < 0.8 * BAR


def test_a_record_with_a_hole_has_no_inertia_there(truth, crane):
    """The speed jumps over a hole of 2 s: no acceleration, and no kick to the load on its wire."""
    run = ahc_run(truth, crane)
    kept = (run.time < 14.0) | (run.time >= 16.0)
    cut = {name: values[kept] for name, values in run.columns.items()}
    check = pressure_check(Run("hole", cut | {"wire_out": np.full(kept.sum(), 50.0)}), crane, truth)
    assert check.moving_rms < 0.8 * BAR
    assert len(check.time) == kept.sum()


def test_what_lies_between_long_holes_is_predicted_by_itself(truth, crane):
    run = ahc_run(truth, crane)
    columns = {**run.columns, "wire_out": np.full(len(run), 50.0)}
    halves = [
        Run("half", {name: values[part] for name, values in columns.items()})
        for part in (slice(700), slice(1800, None))
    ]
    both = Run("both", {name: np.concatenate([half[name] for half in halves]) for name in columns})
    found = pressure_check(both, crane, truth).predicted
    assert np.array_equal(found, np.concatenate([pressure_check(half, crane, truth).predicted for half in halves]))


def test_rows_that_are_lost_now_and_then_are_no_faster_motion(truth, crane):
    run = ahc_run(truth, crane)
    columns = {**run.columns, "wire_out": np.full(len(run), 50.0), "wire_layer": np.full(len(run), 6.0)}
    kept = np.random.default_rng(2).random(len(run)) > 0.2
    check = pressure_check(Run("lost", {name: values[kept] for name, values in columns.items()}), crane, truth)
    assert check.moving_rms < 0.8 * BAR
    assert np.array_equal(check.time, run.time[kept])
    assert np.array_equal(check.speed, run["motor_speed"][kept])


@pytest.mark.parametrize("column", ["motor_speed", "hook_load", "passive.pressure_a"])
def test_a_sample_that_is_no_number_is_said(truth, crane, column):
    run = ahc_run(truth, crane)
    values = run[column].copy()
    values[70] = np.nan
    with pytest.raises(InputError, match=f"gap row 72: column '{column}' is not a finite number"):
        pressure_check(Run("gap", {**run.columns, column: values}), crane, truth)


@pytest.mark.parametrize("shown", [0.0, -20.0])
def test_an_empty_hook_may_weigh_nothing(truth, crane, shown):
    run = ahc_run(truth, crane, load=1.0)
    count = np.ones(len(run))
    columns = {**run.columns, "hook_load": shown * count, "wire_out": 50.0 * count}
    assert pressure_check(Run("empty", columns), crane, truth).moving_rms < 1.0 * BAR


@pytest.mark.parametrize("shown", [0.0, -3.0, 2.0])
def test_a_wire_that_is_short_or_counted_from_elsewhere_does_not_ring(truth, crane, shown):
    """A tenth of a rad/s of noise; a wire of 2 m swings eight times a second, one of -3 m would run away."""
    run = ahc_run(truth, crane)
    noise = np.random.default_rng(3).normal(0.0, 0.1, len(run))
    noisy = {**run.columns, "motor_speed": run["motor_speed"] + noise, "wire_out": np.full(len(run), shown)}
    assert pressure_check(Run("short", noisy), crane, truth).moving_rms < 1.0 * BAR


def test_a_winch_that_never_turns(truth, crane):
    run = ahc_run(truth, crane)
    still = Run("still", {**run.columns, "motor_speed": np.zeros(len(run))})
    with pytest.raises(InputError, match="still: the winch never turns"):
        pressure_check(still, crane, truth)


def test_a_slow_motor_turns_where_a_fast_one_creeps(truth, crane):
    run, slow = ahc_run(truth, crane), replace(crane, rated_speed=5.0)
    creeping = Run("slow", {**run.columns, "motor_speed": run["motor_speed"] / 300.0})
    assert np.isfinite(pressure_check(creeping, slow, truth).moving_rms)
    with pytest.raises(InputError, match="never turns"):
        pressure_check(creeping, crane, truth)


def test_the_error_while_turning_leaves_standstill_out():
    speed, error = np.array([0.0, 0.5, -20.0, 30.0]), np.array([9.0, 9.0, 3.0, -4.0]) * BAR
    check = PressureCheck("r", "main", np.arange(4.0), speed, np.zeros(4), error)
    assert check.moving_rms == pytest.approx(np.sqrt((9.0 + 16.0) / 2.0) * BAR)
    assert check.rms == pytest.approx(np.sqrt((81.0 + 81.0 + 9.0 + 16.0) / 4.0) * BAR)


def test_an_error_with_the_hook_alone_is_in_per_cent_of_the_heaviest_test(truth):
    def curve(test, load):
        speed = np.array([10.0, 20.0, 60.0, 90.0])
        up, down = np.full(4, load + 10 * BAR), np.full(4, load - 10 * BAR)
        return FrictionCurve(test, speed, up, down, 215 * CM3_PER_REV, 11 * 250 * load * 3e-5, 11, load * 3e-5)

    hook, light, heavy = errors_of(truth, [curve("a", 5 * BAR), curve("b", 60 * BAR), curve("c", 200 * BAR)])
    assert hook.nominal == heavy.nominal == pytest.approx(200 * BAR * 3e-5)
    assert light.nominal == pytest.approx(60 * BAR * 3e-5)
    assert light.percent == pytest.approx(100.0 * (light.modelled - light.measured) / light.nominal)
    assert light.worst(True) == pytest.approx(np.abs(light.percent[2:]).max())
    assert light.worst(False) == pytest.approx(np.abs(light.percent[:2]).max())


def test_a_displacement_feedback_that_shows_too_much_is_taken_out(truth, crane):
    run = ahc_run(truth, crane)
    shown = {name: run[name] * (1.03 if name.endswith("displacement") else 1.0) for name in run.columns}
    wrong = Run("ahc", shown)
    assert pressure_check(wrong, crane, truth, 0.03).moving_rms < 0.6 * BAR
    assert pressure_check(wrong, crane, truth).moving_rms > 2.0 * BAR
