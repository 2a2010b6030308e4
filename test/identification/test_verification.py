"""Predicted pressures against a plant that is written down here: balance, direction, wire, standstill."""

from dataclasses import replace

import numpy as np
import pytest
from cycles import cycle

from winch_friction.identification.friction_curve import FrictionCurve
from winch_friction.identification.verification import (
    PressureCheck,
    TestError,
    _even,
    _load_acceleration,
    _pieces,
    _points,
    _smooth,
    _step,
    _through_standstill,
    _turns,
    inertia_torque,
    pressure_check,
)
from winch_friction.identification.verification import test_errors as errors_of
from winch_friction.physics.channels import BAR, CM3_PER_REV, RPM
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import term_named
from winch_friction.physics.friction.compiled import ORDER
from winch_friction.physics.friction.symbols import GROUP_SIGNALS
from winch_friction.physics.signals import Run
from winch_friction.physics.winch import operating_point

ROLE = [signal.name for signal in GROUP_SIGNALS].index("role")


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


@pytest.mark.parametrize("shown", [0.0, 0.09, -0.3])
def test_nothing_is_predicted_for_motors_that_are_swung_out(truth, crane, shown):
    """The pressure that a torque takes there has no bound: a second of it was an error of as much, or none at all."""
    run = ahc_run(truth, crane)
    strokes, pressures = run["active.displacement"].copy(), run["active.pressure_a"].copy()
    strokes[1000:1050], pressures[1000:1050] = shown * crane.max_displacement, 25 * BAR
    found = pressure_check(
        replace(run, columns={**run.columns, "active.displacement": strokes, "active.pressure_a": pressures}),
        crane, truth,
    )  # fmt: skip
    assert len(found.time) == len(run) - 50
    assert found.moving_rms == pytest.approx(pressure_check(run, crane, truth).moving_rms, abs=0.1 * BAR)
    with pytest.raises(InputError, match="ahc: active.displacement is below a tenth throughout"):
        pressure_check(replace(run, columns={**run.columns, "active.displacement": 0.0 * strokes}), crane, truth)


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
    none = replace(check, speed=np.abs(speed) * np.array([1.0, 1.0, 0.0, 0.0]))  # what turned showed no stroke
    assert np.isnan([none.moving_rms, none.mean_error(-1)]).all()


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


# -- the parts of a prediction, by figures
def test_two_hundred_and_fifty_rpm_is_above_the_border_and_no_point_has_no_error():
    speed, error = np.array([100.0, 249.0, 250.0, 300.0]) * RPM, np.array([1.0, -4.0, -3.0, 2.0])
    each = TestError("t", speed, 7.0 * np.ones(4), 7.0 + error, 50.0)
    assert (each.worst(True), each.worst(False)) == (pytest.approx(6.0), pytest.approx(8.0))
    assert each.percent.tolist() == pytest.approx([2.0, -8.0, -6.0, 4.0])
    slow = replace(each, speed=0.5 * speed)
    assert np.isnan(slow.worst(True))
    assert slow.worst(False) == pytest.approx(8.0)


@pytest.mark.parametrize(("share", "own"), [(0.09, False), (0.11, True)])
def test_a_tenth_of_the_heaviest_load_is_a_load(truth, share, own):
    def curve(load):
        level = np.full(2, load)
        return FrictionCurve("t", np.array([10.0, 20.0]), level, 0.9 * level, 3e-5, 11 * 250 * load, 11, load)

    assert errors_of(truth, [curve(share * 600.0), curve(600.0)])[0].nominal == pytest.approx(
        share * 600.0 if own else 600.0
    )


@pytest.mark.parametrize("scale", [1.0, 0.25])
def test_what_turns_and_what_hoists_begins_at_a_speed_in_proportion_to_the_motors(scale):
    speed = np.array([0.95, 1.02, 1.1, -1.02, -1.1]) * scale  # rad/s; of 10 rpm, 1.047, the latter are beyond
    error = np.array([100.0, 2.0, 8.0, -6.0, 5.0]) * BAR
    check = PressureCheck("r", "main", np.arange(5.0), speed, np.zeros(5), error, scale)
    assert check.moving_rms == pytest.approx(np.sqrt((4.0 + 64.0 + 36.0 + 25.0) / 4.0) * BAR)
    assert check.mean_error(+1) == pytest.approx(8.0 * BAR)
    assert check.mean_error(-1) == pytest.approx(5.0 * BAR)


def test_the_active_group_drives_whatever_the_order_of_the_columns(truth, crane):
    run = ahc_run(truth, crane)
    turned = Run("ahc", {name: run[name] for name in sorted(run.columns, reverse=True)})
    assert turned.groups == ("passive", "active")
    check = pressure_check(turned, crane, truth)
    assert check.group == "active"
    assert check.predicted == pytest.approx(pressure_check(run, crane, truth).predicted)


def test_the_predicted_pressure_knows_nothing_of_the_one_that_is_held_against_it(truth, crane):
    """Neither by the friction, which depends on the driving group's own pressure, nor by anything else."""
    run = ahc_run(truth, crane)
    tared = Run("tared", {**run.columns, "active.pressure_a": run["active.pressure_a"] + 40 * BAR})
    plain, other = (pressure_check(each, crane, truth) for each in (run, tared))
    np.testing.assert_allclose(other.predicted, plain.predicted, atol=1.0)
    np.testing.assert_allclose(other.measured - plain.measured, 40 * BAR)


def test_a_tip_whose_motion_has_gaps_is_refused(truth, crane):
    run = ahc_run(truth, crane)
    heave = np.zeros(len(run))
    heave[3] = np.nan
    with pytest.raises(InputError, match="row 5: column 'heave_velocity'"):
        pressure_check(Run("tip", {**run.columns, "heave_velocity": heave}), crane, truth)


def plain_run(time, **columns):
    return Run("r", {"time": np.asarray(time, float), **{k: np.asarray(v, float) for k, v in columns.items()}})


def test_three_seconds_are_a_hole_and_ten_samples_are_a_piece():
    steps = [0.1] * 9 + [2.9] + [0.1] * 4 + [3.1] + [0.1] * 8 + [5.0] + [0.1] * 9
    time = np.cumsum([0.0, *steps])
    pieces = _pieces(plain_run(time, motor_speed=np.arange(len(time))))
    assert [len(piece) for piece in pieces] == [15, 10]  # and the nine between are none
    assert [piece["motor_speed"][0] for piece in pieces] == [0.0, 24.0]


def test_lost_rows_are_lines_and_the_layer_is_that_of_the_nearer_row():
    time = np.array([0.0, 1.0, 2.0, 5.0, 6.0, 8.0])
    layer = [2.0, 2.0, 2.0, 3.0, 3.0, 4.0]
    found = _even(plain_run(time, motor_speed=10.0 * time, wire_layer=layer))
    assert found.time.tolist() == np.arange(9.0).tolist()
    assert found["motor_speed"] == pytest.approx(10.0 * np.arange(9.0))
    assert found["wire_layer"].tolist() == [2.0, 2.0, 2.0, 2.0, 3.0, 3.0, 3.0, 3.0, 4.0]
    even = plain_run([0.0, 1.0, 2.4, 3.0, 4.0])
    assert _even(even) is even


@pytest.mark.parametrize(
    ("moving", "said"),
    [
        ([0, 0, 1, 1, 0, 0, 1], [0.0, 15.0, 30.0, 40.0, 30.0, 20.0, 10.0]),  # begins at rest: from none
        ([1, 0, 0, 1, 0, 0, 0], [10.0, 20.0, 30.0, 40.0, 40.0, 40.0, 40.0]),  # ends at rest: stays
    ],
)
def test_friction_turns_over_evenly_through_standstill(moving, said):
    friction = np.where(moving, [10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 10.0], -999.0)
    assert _through_standstill(np.arange(7.0), friction, np.array(moving, bool)) == pytest.approx(said)


@pytest.mark.parametrize("slow", [False, True])
def test_a_winch_sticks_below_half_a_radian_per_second_or_as_much_less_as_its_motors_are_slower(crane, slow):
    own = replace(crane, rated_speed=5.0) if slow else crane
    assert (own.speed_scale < 1.0) == slow
    for speed, turns in ((0.48, False), (-0.52, True)):
        run = plain_run(0.02 * np.arange(50), motor_speed=np.full(50, speed * own.speed_scale))
        assert _turns(run, own).tolist() == [turns] * 50


@pytest.mark.parametrize(("step", "rows", "wide"), [(0.018, 200, 11), (0.013, 200, 15), (0.1, 200, 5), (0.02, 8, 7)])
def test_a_speed_is_smoothed_by_parabolas_over_a_fifth_of_a_second_but_five_samples(step, rows, wide):
    time = step * np.arange(rows)
    run = plain_run(time)
    assert _smooth(run, 3.0 * time**2 - time, 0) == pytest.approx(3.0 * time**2 - time, abs=1e-9)
    assert _smooth(run, 3.0 * time**2 - time, 1) == pytest.approx(6.0 * time - 1.0, abs=1e-9)
    if rows > 2 * wide:
        struck = np.flatnonzero(np.abs(_smooth(run, 1.0 * (np.arange(rows) == 100), 0)) > 1e-12)
        assert (struck[0], struck[-1]) == (100 - wide // 2, 100 + wide // 2)


def test_a_step_is_the_usual_one_beside_a_hole():
    assert _step(plain_run([0.0, 0.1, 0.2, 0.3, 2.8, 2.9])) == pytest.approx(0.1)


def swinging(crane, speed, step, length, load=55e3, **more):
    time = step * np.arange(len(speed))
    return plain_run(time, motor_speed=speed, hook_load=np.full_like(time, load), wire_out=length, **more)


def test_a_load_swings_at_its_wires_frequency_as_far_as_the_damping_lets_it(crane):
    """m v' = k x + c x' with x' = u - v: at the natural frequency v' is sqrt(k^2 + c^2 w^2) / (c w) times u'. A counter
    is taken in its mean, without what it does not say."""
    mass, step, damped = 30e3, 0.004, 1.5e5
    length = np.where(np.arange(15000) % 2, 95.0, 105.0)
    length[::10] = np.nan
    stiffness = crane.wire_stiffness / np.nanmean(length)
    natural = np.sqrt(stiffness / mass)
    wire_speed = np.sin(natural * step * np.arange(15000))
    run = swinging(crane, np.zeros(15000), step, length, mass)
    found = np.abs(_load_acceleration(run, crane, wire_speed)[10000:]).max() / natural
    assert found == pytest.approx(np.hypot(stiffness, damped * natural) / (damped * natural), rel=0.01)


def test_a_load_that_is_held_still_in_a_heaving_sea_takes_no_torque(crane):
    """The motor pays out what the tip rises by; without the motor the load rises with the tip."""
    time = 0.02 * np.arange(1000)
    tip = np.sin(time)
    radius = crane.drum.radius(6) / crane.gear_ratio
    for paid_out, taken in ((1.0, 0.0), (0.0, 1.0)):
        run = swinging(crane, -paid_out * tip / radius, 0.02, np.full(1000, np.nan), heave_velocity=tip)
        torque, acceleration = inertia_torque(run, crane)
        wanted = taken * 55e3 * radius * np.cos(time)
        np.testing.assert_allclose((torque - crane.inertia * acceleration)[50:-50], wanted[50:-50], atol=0.4)


OUTER = [6.0] * 8


@pytest.mark.parametrize(
    ("said", "layers"), [([], OUTER), ([np.nan, 3.0, np.nan, 2.0], [3, 3, 3, 2, 2, 3, 3, 2]), ([np.nan] * 4, OUTER)]
)
def test_a_prediction_is_made_at_the_layer_that_was_said_last_or_at_the_outer_one(truth, crane, said, layers):
    columns = {name: values[:8] for name, values in ahc_run(truth, crane).columns.items()}
    run = Run("r", {**columns, **({"wire_layer": np.tile(said, 2)} if said else {})})
    drop = {group: run[f"{group}.pressure_a"] - run[f"{group}.pressure_b"] for group in run.groups}
    point = dict(zip(ORDER, _points(run, crane, drop, np.full(8, 5.0), np.full(8, 7.0)), strict=False))
    assert point["wire_layer"].tolist() == layers
    assert (point["drum_torque"][0], point["acceleration"][0]) == (5.0, 7.0)


def test_a_prediction_knows_which_of_the_groups_drives(crane_150t, crane2_model):
    run = Run("r", {name: values[:8] for name, values in ahc_run(crane2_model, crane_150t).columns.items()})
    for names, roles in (
        (("active", "passive"), [1.0, -1.0]),
        (("passive", "active"), [-1.0, 1.0]),
        (("active",), [0.0]),
    ):
        drop = {name: run[f"{name}.pressure_a"] - run[f"{name}.pressure_b"] for name in names}
        point = _points(run, crane_150t, drop, np.ones(8), np.zeros(8))
        at = [len(ORDER) + len(GROUP_SIGNALS) * k + ROLE for k in range(len(names))]
        assert [float(point[k][0]) for k in at] == roles
