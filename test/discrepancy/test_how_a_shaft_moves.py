"""How a shaft moves, by figures: which samples count, where it turns, and what the motors' signals make of it."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy.preparation import motors as signalling
from winch_friction.discrepancy.preparation import seen as module
from winch_friction.discrepancy.preparation.grid import Grid, samples_of, uniform
from winch_friction.discrepancy.preparation.motors import GroupSignals, drive_torque, measured_groups
from winch_friction.discrepancy.preparation.seen import Motion, Seen, at_one_speed, motion_of, resolution, travel_of
from winch_friction.physics.channels import BAR
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import Run

DT, GEAR = 0.01, 200.0  # s
CRANE = SimpleNamespace(gear_ratio=GEAR, drive="hydraulic")
TIME = DT * np.arange(4000)
HALF = 0.5 * samples_of(0.3, DT) * DT  # s of the window that smooths a fine encoder's speed


def moved(speed, turning=False, name="motor_speed", dt=DT, **more):
    time = dt * np.arange(len(speed))
    return motion_of(uniform(Run("r", {"time": time, name: speed, **more})), CRANE, "r", turning)


# -- travel
def test_a_reversal_counts_once_the_shaft_has_come_back_by_so_much_from_its_farthest_point():
    angle = np.array([0.0, 0.3, 0.6, 1.0, 0.7, 0.4, 0.1, 0.2, 0.7])
    direction, travel, progress = travel_of(angle, 0.5)
    assert direction.tolist() == [0.0, 0.0, 1.0, 1.0, 1.0, -1.0, -1.0, -1.0, 1.0]
    assert travel == pytest.approx([0.0, 0.3, 0.6, 1.0, 0.7, 0.6, 0.9, 0.8, 0.6])
    # of the farthest point, and of the turn that counts late all the way back
    assert progress == pytest.approx([0.0, 0.0, 0.6, 0.4, 0.0, 0.6, 0.3, 0.0, 0.6])
    mirrored = travel_of(-angle, 0.5)
    assert mirrored[0].tolist() == (-direction).tolist()
    assert (mirrored[1], mirrored[2]) == (pytest.approx(travel), pytest.approx(progress))


def test_an_encoder_may_turn_back_by_seven_deviations_of_its_noise_in_a_sample():
    noise = 0.2 * np.random.default_rng(0).standard_normal(20_000)
    assert resolution(noise, 0.05) == pytest.approx(7.0 * 0.2 * 0.05, rel=0.05)
    assert 0.0 < resolution(np.ones(100), 0.05) < 1e-9


def test_an_angle_is_added_up_from_the_speed_where_nobody_logged_it():
    speed = 20.0 * np.cos(TIME)
    assert moved(speed).angle == pytest.approx(20.0 * np.sin(TIME), abs=1e-3)
    assert moved(speed, shaft_angle=7.0 * TIME).angle == pytest.approx(7.0 * TIME)


def test_a_drum_turns_slower_than_its_motor_by_the_gear():
    speed = 0.5 * np.sin(TIME)
    assert moved(speed, name="drum_speed").speed == pytest.approx(moved(GEAR * speed).speed)
    with pytest.raises(InputError, match="neither 'motor_speed' nor 'drum_speed'"):
        moved(speed, name="hook_load")


# -- at one speed
@pytest.mark.parametrize(
    ("mean", "sine", "samples", "steady"),
    [
        (0.45, 0.0, 400, True),  # seven deviations of a mean over 400 samples are 0.35 of one
        (0.28, 0.0, 400, False),
        (-0.45, 0.0, 400, True),
        (10.0, 1.0, 400, True),  # what varies by half more than its noise, and by twice as much
        (10.0, 2.5, 400, False),
        (10.0, 0.0, 49, False),
        (10.0, 0.0, 60, True),
    ],
)
def test_a_shaft_is_at_one_speed_where_that_varies_by_its_noise_about_a_mean_that_is_not_zero(
    mean, sine, samples, steady
):
    at = np.arange(samples)
    raw = mean + sine * np.sin(at / 20.0) + np.random.default_rng(2).standard_normal(samples)
    assert bool(at_one_speed(raw)) is steady
    raw[7] = np.nan
    assert at_one_speed(raw) is False


@pytest.mark.parametrize("turning", [False, True])
def test_at_one_speed_nothing_accelerates_and_every_sample_counts(turning):
    raw = -3.0 + 0.5 * np.random.default_rng(3).standard_normal(len(TIME))
    motion = moved(raw, turning)
    if turning:  # nothing has just reversed
        assert not motion.used.any()
        return
    mean = float(np.mean(raw))
    assert (set(motion.speed), set(motion.acceleration), set(motion.direction)) == ({mean}, {0.0}, {-1.0})
    assert motion.angle == pytest.approx(mean * TIME)
    assert motion.used.all()
    assert motion.state_speed is motion.speed


# -- moving samples
RAMP = 0.5 * (TIME - 20.0)  # rad/s, through zero at 20 s


def test_samples_count_beyond_a_share_of_the_top_speed_half_a_window_and_a_guard():
    """Of 10 rad/s a hundred and twenty-fifth; an eighth of that has no direction."""
    guard = 0.008 * np.percentile(np.abs(RAMP), 99.5)
    motion, since = moved(RAMP), np.abs(TIME - 20.0)
    still = guard / 0.5
    beyond = still + HALF + 0.08
    inside = (TIME > HALF + 0.05) & (TIME[-1] - HALF - 0.05 > TIME)
    assert motion.used[(since > beyond + 0.02) & inside].all()
    assert not motion.used[since < beyond - 0.02].any()
    assert not motion.direction[since < 0.125 * still - 1e-6].any()
    assert (motion.direction == np.sign(TIME - 20.0))[since > 0.125 * still + 1e-6].all()
    assert motion.acceleration == pytest.approx(0.5)
    assert (motion.state_speed == np.where(motion.direction != 0.0, motion.speed, 0.0)).all()
    assert motion.window == samples_of(0.3, DT)


def test_where_the_encoder_is_noisy_four_deviations_of_the_smoothed_speed_are_no_motion(monkeypatch):
    """Smoothing over n samples leaves the noise over the root of a third of them."""
    monkeypatch.setattr(module, "noise_level", lambda _: 0.9)
    motion, since = moved(RAMP), np.abs(TIME - 20.0)
    guard = 4.0 * 0.9 / np.sqrt(samples_of(0.3, DT) / 3.0)
    beyond = guard / 0.5 + HALF + 0.08
    assert not motion.used[since < beyond - 0.02].any()
    assert motion.used[(since > beyond + 0.02) & (since < 15.0)].all()


def test_a_touch_of_zero_that_hides_in_the_smoothed_speed_counts_as_one():
    raw = np.where(np.abs(TIME - 20.0) < 0.06, 0.0, 50.0 + TIME)
    motion = moved(raw)
    assert np.abs(motion.speed).min() > 10.0
    assert not motion.used[np.abs(TIME - 20.0) < HALF].any()
    assert motion.used[(np.abs(TIME - 20.0) > 0.5) & (np.abs(TIME - 20.0) < 15.0)].all()


def test_a_reversal_between_two_samples_leaves_both_out():
    still = module._near_zero(np.array([9.0, 5.0, -6.0, -9.0, -0.5, -9.0]), 0.5)
    assert still.tolist() == [False, True, True, False, True, False]
    # a sample that stands at nothing is left out itself; those beside it lie on one side of it
    still = module._near_zero(np.array([9.0, 0.0, 9.0, 0.0, -9.0]), 0.5)
    assert still.tolist() == [False, True, False, True, False]


def test_a_hole_longer_than_half_a_window_takes_as_much_on_either_side_and_a_shorter_one_none():
    valid = np.ones(60, bool)
    valid[[15, 16]] = False
    valid[30:35] = False
    kept = module._measured_around(valid, 4)
    assert np.flatnonzero(~kept).tolist() == [*range(4), *range(26, 39), *range(56, 60)]


# -- just reversed
WAVE = -100.0 * np.cos(np.pi * TIME / 10.0)  # rad/s; it turns at 5, 15, 25 and 35 s, by 31.4 rad/s^2
SINCE = np.mod(TIME - 5.0, 10.0)


def between(begin, end):
    return (begin < SINCE) & (end > SINCE) & (TIME > 5.5) & (TIME < 38.0)


def test_just_reversed_is_what_has_begun_to_slide_and_not_gone_far():
    """From a quarter of a window on to three hundredths of a second at top speed: 3 rad, after 0.44 s."""
    motion = moved(WAVE, True)
    far = np.sqrt(2.0 * 0.03 * 100.0 / 31.4)
    assert motion.used[between(0.09, far - 0.02)].all()
    assert not motion.used[between(far + 0.02, 9.9)].any()
    assert not motion.used[between(-1.0, 0.06)].any()
    there = between(0.09, 9.9)
    assert (motion.direction == np.sign(WAVE))[there].all()
    assert motion.state_speed[there] == pytest.approx(WAVE[there], abs=0.5)


def test_a_contact_slides_once_the_shaft_has_surely_come_back(monkeypatch):
    """By half more than what may be the encoder's own, here 1 rad, after 0.31 s."""
    monkeypatch.setattr(module, "resolution", lambda *_: 1.0)
    motion, gone = moved(WAVE, True), np.sqrt(2.0 * 1.5 / 31.4)
    assert not motion.used[between(0.0, gone - 0.02)].any()
    assert motion.used[between(gone + 0.03, 0.42)].all()


def test_a_slow_contact_slides_once_half_more_is_gone_than_may_be_the_encoders_own(monkeypatch):
    """At 2 rad/s a turn back by 1 rad counts after half a second, and has begun to slide a quarter later."""
    monkeypatch.setattr(module, "resolution", lambda *_: 1.0)
    motion, since = moved(np.where(TIME < 20.0, 100.0 * np.minimum(20.0 - TIME, 1.0), -2.0), True), TIME - 20.0
    assert not motion.used[(since > 0.0) & (since < 0.7)].any()
    assert motion.used[(since > 0.85) & (since < 1.4)].all()
    assert not motion.used[since > 1.7].any()


@pytest.mark.parametrize(("creeps", "used"), [(0.4, True), (0.05, False)])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_what_creeps_after_a_reversal_counts_for_three_seconds_and_no_slower_than_it_has_a_direction(
    creeps, used, sign
):
    """A tenth of 100 rad/s over 125 is 0.1; at 0.4 rad/s it has not gone far after ten seconds."""
    speed = sign * np.where(TIME < 20.0, 100.0 * np.minimum(20.0 - TIME, 1.0), -creeps)
    motion = moved(speed, True)
    assert (motion.used[(TIME > 20.5) & (TIME < 22.9)].all(), motion.used[TIME > 23.1].any()) == (used, False)
    assert motion.used[(TIME > 20.5) & (TIME < 22.9)].any() is np.bool_(used)


# -- what the motors' signals make
def signals(count=3, digit=0.0, **more):
    own = {"pressure": 2e7, "pressure_sum": 2.4e7, "low_pressure": 2e6, "displacement": 2e-5, "logged": 2e7}
    arrays = {name: np.full(4, value) for name, value in {**own, **more}.items()}
    return GroupSignals("main", count, balances=True, digit=digit, **arrays)


@pytest.mark.parametrize(("digit", "bar"), [(0.0, 1.0), (0.1 * BAR, 1.0), (0.3 * BAR, 2.0)])
def test_a_zero_of_both_transducers_is_one_bar_or_as_much_more_as_their_digit_is_coarser(digit, bar):
    assert signals(digit=digit).of_zero(0.15) == pytest.approx(3 * 2e-5 * bar * BAR)


def test_what_was_seen_is_of_that_very_run_seen_in_the_same_way_on_the_same_gear_and_drive():
    run = Run("r", {"time": TIME, "motor_speed": WAVE})
    own = Seen(run, CRANE, False, None, None)
    assert own.is_of(run, SimpleNamespace(gear_ratio=GEAR, drive="hydraulic"), False)
    assert not own.is_of(Run("r", {"time": TIME, "motor_speed": WAVE}), CRANE, False)
    assert not own.is_of(run, CRANE, True)
    assert not own.is_of(run, SimpleNamespace(gear_ratio=100.0, drive="hydraulic"), False)
    assert not own.is_of(run, SimpleNamespace(gear_ratio=GEAR, drive="electric"), False)


@pytest.mark.parametrize(("dt", "more"), [(0.02, 0.0), (0.03, 0.03**2 / 3.0), (0.1, 0.1**2 / 3.0)])
def test_a_sparse_logs_torque_is_the_mean_over_the_two_periods_of_its_acceleration(dt, more):
    """Of a parabola that is a third of the period's square more, which smoothing leaves as it is."""
    time = dt * np.arange(200)
    motion = Motion(9, *[np.zeros(200)] * 6)
    seen = Seen(None, CRANE, False, Grid({"time": time}, dt, np.ones(200, bool)), motion)
    inside = slice(10, -10)
    assert seen.smoothed((time - 5.0) ** 2)[inside] == pytest.approx((time - 5.0)[inside] ** 2 + more)


def motors(monkeypatch, swept=2e-5, names=("main",), **more):
    """Groups of two motors each with port A at 200 bar and port B at 10, and the windows that smoothed them."""
    windows, ones = [], np.ones(100)
    monkeypatch.setattr(signalling, "smooth", lambda values, window: windows.append(window) or values)
    monkeypatch.setattr(
        signalling, "smooth_between_steps", lambda values, *window: windows.append(window) or np.asarray(values, float)
    )
    columns = {}
    for name in names:
        columns |= {f"{name}.pressure_a": 200 * BAR * ones, f"{name}.pressure_b": 10 * BAR * ones}
        columns |= {f"{name}.displacement": swept * ones}
    columns |= more
    run = Run("r", {"time": DT * np.arange(100.0), "motor_speed": ones, **columns})
    crane = SimpleNamespace(
        motor_count=lambda name: {"main": 2, "active": 2, "passive": 4}[name], max_displacement=3e-5
    )
    return measured_groups(columns, run, crane, 15), windows


def test_a_group_has_its_ports_difference_sum_and_lower_one_over_twice_the_speeds_window(monkeypatch):
    (own,), windows = motors(monkeypatch)
    assert (own.name, own.count, own.balances) == ("main", 2, True)
    figures = (own.pressure, own.pressure_sum, own.low_pressure, own.displacement)
    assert [each[0] for each in figures] == pytest.approx([190 * BAR, 210 * BAR, 10 * BAR, 2e-5])
    assert own.logged is own.pressure
    assert windows == [(15, 75), 30, 30, 30]


def test_the_coarser_digit_of_two_transducers_is_the_groups(monkeypatch):
    fine, coarse = (np.round(150 * BAR * np.sin(np.arange(3000.0) / 70.0) / step) * step for step in (1e4, 5e4))
    for a, b in ((fine, coarse), (coarse, fine)):
        columns = {"main.pressure_a": a, "main.pressure_b": b, "main.displacement": np.full(3000, 2e-5)}
        run = Run("r", {"time": DT * np.arange(3000.0), "motor_speed": np.ones(3000), **columns})
        crane = SimpleNamespace(motor_count=lambda _: 1, max_displacement=3e-5)
        assert measured_groups(columns, run, crane, 15)[0].digit == pytest.approx(5e4)


def test_a_set_point_whose_feedback_is_noise_alone_is_steady_and_one_that_moves_is_followed(monkeypatch):
    noise = 2e-5 + 1e-8 * np.random.default_rng(4).standard_normal(100)
    swings = 2e-5 + 1e-6 * np.sin(np.arange(100) / 9.0)
    for fed_back, steady in ((noise, True), (swings, False)):
        (own,), _ = motors(monkeypatch, **{"main.displacement": fed_back})
        wanted = np.full(100, np.median(fed_back)) if steady else fed_back
        assert own.displacement == pytest.approx(wanted, rel=1e-12)


def test_motors_that_close_the_balance_are_swung_out_by_a_twentieth_at_least(monkeypatch):
    motors(monkeypatch, swept=1.6e-6)
    with pytest.raises(InputError, match="displacement' is nearly zero"):
        motors(monkeypatch, swept=1.4e-6)
    both, _ = motors(monkeypatch, names=("active", "passive"), **{"passive.displacement": np.full(100, 1e-7)})
    assert [(own.name, own.count, own.balances) for own in both] == [("active", 2, True), ("passive", 4, False)]


def test_the_drives_torque_is_that_of_all_motors_by_their_pressures_as_logged():
    one, two = signals(3), replace(signals(4), name="passive", displacement=np.full(4, 1e-5), balances=False)
    columns = {"main.pressure_a": 5e6 * np.ones(4), "main.pressure_b": 1e6 * np.ones(4)}
    columns |= {"passive.pressure_a": 1e6 * np.ones(4), "passive.pressure_b": 3e6 * np.ones(4)}
    assert drive_torque(columns, (one, two)) == pytest.approx(3 * 2e-5 * 4e6 - 4 * 1e-5 * 2e6)
