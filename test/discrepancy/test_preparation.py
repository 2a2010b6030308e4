"""What of a record is used: nothing where the direction of motion, and with it that of friction, is uncertain."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from gap_rig import runs_with

from winch_friction.discrepancy.engine.crossfit import CrossFit
from winch_friction.discrepancy.expansion import meet
from winch_friction.discrepancy.preparation.balance import without_error
from winch_friction.discrepancy.preparation.grid import smooth, smooth_between_steps, uniform
from winch_friction.discrepancy.preparation.motors import GroupSignals, measured_groups
from winch_friction.discrepancy.preparation.prepare import _followed, prepare
from winch_friction.discrepancy.preparation.seen import motion_of
from winch_friction.discrepancy.preparation.suspended_load import Mode, load_of
from winch_friction.discrepancy.regressors import (
    TOLERANCES,
    base_of,
    build_problem,
    layout_of,
    least_noise_of,
    tolerance_columns,
)
from winch_friction.physics.channels import BAR
from winch_friction.physics.friction import FrictionModel, term_named
from winch_friction.physics.friction.correction import Correction
from winch_friction.physics.friction.symbols import GROUP_SIGNALS, WINCH_SIGNALS
from winch_friction.physics.signals import Run


@pytest.mark.parametrize("rate", [5.0, 9.8, 50.0, 200.0])
def test_samples_beside_a_reversal_are_left_out_even_where_none_is_at_zero(crane_150t, rate):
    """Heave compensation in a short sea, logged so slowly that no sample is near zero speed."""
    time = np.arange(0.0, 120.0, 1.0 / rate)
    speed = 120.0 * np.cos(2.0 * np.pi * (time + 0.013) / 5.1)
    motion = motion_of(uniform(Run("sea", {"time": time, "motor_speed": speed})), crane_150t, "sea", turning=False)
    crossings = np.flatnonzero(np.diff(np.sign(speed)) != 0.0)
    assert len(crossings) > 40
    for k in crossings[2:-2]:
        assert not motion.used[k : k + 2].any()
    assert motion.used.mean() > (0.2 if rate < 20.0 else 0.6)


def test_a_shaft_that_waits_for_its_start_has_not_just_reversed(crane_150t):
    """A smoothed speed swings below zero before a quick start; the shaft, under a load that has not let go, rests."""
    time = np.arange(0.0, 40.0, 0.05)
    back, start = (time > 18.0) & (time < 18.5), time > 20.0
    speed = np.where(back, -2.0 * np.sin(2.0 * np.pi * (time - 18.0)), 0.0)
    speed = np.where(start, 150.0 * np.minimum(time - 20.0, 0.5), speed)
    motion = motion_of(uniform(Run("start", {"time": time, "motor_speed": speed})), crane_150t, "start", turning=True)
    rests = (time > 18.8) & (time <= 20.0)
    assert motion.speed[rests].min() < -0.5, "the swing is there"
    assert not motion.used[rests].any()
    assert motion.used[start].any()


def _weighed(crane, added, wire_logged=True):
    """What is made of a load cell at 20 t whose reading has `added(length m, acceleration of the load m/s^2)` in kg."""
    time = np.arange(0.0, 180.0, 0.02)
    speed = 100.0 * np.clip(2.0 * np.sin(2.0 * np.pi * time / 60.0), -1.0, 1.0)
    lever = 1.136 / 250.0
    length = 100.0 - np.cumsum(speed) * 0.02 * lever
    mass = 20e3 + added(length, np.gradient(lever * speed, 0.02))
    noise = 60.0 * np.random.default_rng(3).standard_normal(len(time))
    columns = {"time": time, "motor_speed": speed, "hook_load": np.round((mass + noise) / 50.0) * 50.0}
    grid = uniform(Run("run", columns | ({"wire_out": length} if wire_logged else {})))
    return load_of(grid, motion_of(grid, crane, "run", turning=False), crane, float("nan")).mass, mass


@pytest.mark.parametrize("wire_logged", [True, False])
def test_the_weight_of_the_wire_below_the_cell_is_followed(crane_150t, wire_logged):
    """Ten metres of wire are 1 % of 20 t, far above what a balance closes to: not a cell's noise."""
    found, true = _weighed(crane_150t, lambda length, _: crane_150t.wire_mass * (length - 100.0), wire_logged)
    assert np.ptp(true) > 150.0
    assert np.abs(found - true).max() < 30.0


def test_a_cell_that_feels_the_load_accelerate_does_not_weigh_the_wire(crane_150t):
    found, _ = _weighed(crane_150t, lambda _, acceleration: 20e3 / 9.81 * acceleration)
    assert np.ptp(found) == 0.0


def test_a_cell_with_noise_alone_weighs_one_mass(crane_150t):
    found, _ = _weighed(crane_150t, lambda length, _: 0.0 * length)
    assert np.ptp(found) == 0.0


def _fed_back(crane, displacement):
    """What is made of a displacement feedback with its noise and its steps, in cm^3/rev."""
    cm3 = 1e-6 / (2.0 * np.pi)
    noise = 0.15 * np.random.default_rng(5).standard_normal(len(displacement))
    size = len(displacement)
    columns = {
        "main.pressure_a": np.full(size, 150e5), "main.pressure_b": np.full(size, 25e5),
        "main.displacement": np.round((displacement + noise) / 0.05) * 0.05 * cm3,
    }  # fmt: skip
    (group,) = measured_groups(columns, Run("run", {"time": np.arange(size) * 0.02, **columns}), crane, 15)
    return group.displacement / cm3


def test_motors_that_are_swung_by_a_little_are_followed(crane_150t):
    """A droop of 3 % is 4 bar of 130: not a feedback's noise."""
    time = np.arange(0.0, 120.0, 0.02)
    set_to = 150.0 * (1.0 - 0.015 * (1.0 - np.cos(2.0 * np.pi * time / 60.0)))
    assert np.abs(_fed_back(crane_150t, set_to) - set_to).max() < 0.15


def test_the_noise_of_a_feedback_does_not_swing_the_motors(crane_150t):
    found = _fed_back(crane_150t, np.full(6000, 150.0))
    assert np.ptp(found) == 0.0
    assert found[0] == pytest.approx(150.0, abs=0.05)


@pytest.mark.parametrize(("stroke", "reckoned"), [(0.5, True), (0.15, True), (0.08, False)])
def test_motors_below_a_tenth_of_their_own_stroke_have_the_pressure_that_was_logged(crane_150t, stroke, reckoned):
    """Above it the pressure that closes the balance counts, here of 20 t and no friction, and none that was logged."""
    time = np.arange(0.0, 60.0, 0.02)
    speed = 100.0 * np.clip(2.0 * np.sin(2.0 * np.pi * time / 30.0), -1.0, 1.0)
    size, swung = len(time), stroke * crane_150t.max_displacement
    run = Run("run", {
        "time": time, "motor_speed": speed, "hook_load": np.full(size, 20e3),
        "main.pressure_a": np.full(size, 150e5), "main.pressure_b": np.full(size, 25e5),
        "main.displacement": np.full(size, swung),
    })  # fmt: skip
    (group,) = prepare(run, crane_150t, FrictionModel("bare", (), ())).groups
    wanted = crane_150t.drum_torque(20e3) / crane_150t.gear_ratio / (group.count * swung) if reckoned else 125e5
    steady = np.abs(speed) == 100.0
    assert np.median(group.pressure[steady]) == pytest.approx(wanted, rel=0.01)


def _kept(crane, quick):
    """Which of a minute and more at 10 Hz count, with this torque of inertia, N m."""
    time = 0.1 * np.arange(len(quick))
    motion = SimpleNamespace(acceleration=np.zeros_like(time), used=np.ones(len(time), bool))
    return _followed(
        SimpleNamespace(dt=0.1, time=time), motion, SimpleNamespace(inertial_torque=quick),
        SimpleNamespace(unit_torque=33.0), crane, Mode(0.0, 0.0),
    )  # fmt: skip


def test_a_slow_log_keeps_no_sample_that_stands_alone_among_what_it_cannot_follow(crane_150t):
    """A torque of inertia that swings bends between samples; where it turns it does not for a sample or two, and two
    samples of a run have given a locked gap of 39 bar."""
    time = np.arange(0.0, 80.0, 0.1)
    kept = _kept(crane_150t, 12000.0 * np.sin(2.0 * np.pi * time / 4.0) * (time < 60.0))
    edges = np.flatnonzero(np.diff(np.concatenate([[0], kept.astype(int), [0]])))
    assert kept[620:].all()
    assert kept[:590].mean() < 0.05
    assert (edges[1::2] - edges[::2]).min() >= 5


@pytest.mark.parametrize(("seconds", "some"), [(78.0, False), (70.0, True)])
def test_of_a_run_that_it_can_hardly_follow_a_slow_log_keeps_nothing(crane_150t, seconds, some):
    """Half a second of a run stood for it, and a null got three names."""
    time = np.arange(0.0, 80.0, 0.1)
    assert _kept(crane_150t, 12000.0 * np.sin(2.0 * np.pi * time / 4.0) * (time < seconds)).any() == some


def test_what_weighs_more_than_a_wire_can_is_none(crane_150t):
    """A cell that creeps with the length by three times what a metre of wire weighs has another fault."""
    found, _ = _weighed(crane_150t, lambda length, _: 3.0 * crane_150t.wire_mass * (length - 100.0))
    assert np.ptp(found) == 0.0


@pytest.mark.parametrize(("period", "least"), [(0.02, 0.1), (0.1, 0.15)])
def test_a_slow_log_closes_no_better_than_it_is_followed(period, least):
    """bar: what of it is used may bend so far between two samples, and nothing smaller is anybody's effect there."""
    empty = SimpleNamespace(groups=[None], dt=period, drum_torque=np.zeros(5), gear_ratio=250.0, unit_torque=3e-4)
    assert least_noise_of(empty) == pytest.approx(least)


def test_what_a_load_cell_is_off_by_is_more_of_the_motors_that_carry_a_part():
    """150 bar in all of eleven motors are 413 bar of four of them: 0.03 % of it is 0.12 bar beside 0.1."""
    drum = np.full(5, 150e5 * 11 * 3e-5 * 250.0)
    whole, part = (
        SimpleNamespace(groups=[None], dt=0.02, drum_torque=drum, gear_ratio=250.0, unit_torque=count * 3e-5 * 1e5)
        for count in (11, 4)
    )
    assert least_noise_of(whole) == pytest.approx(np.hypot(0.1, 3e-4 * 150.0))
    assert least_noise_of(part) == pytest.approx(np.hypot(0.1, 3e-4 * 412.5))


@pytest.mark.parametrize(("rated", "least"), [(0.0, 0.1), (300.0, 0.3), (50.0, 0.1)])
def test_a_drives_torque_is_off_by_a_share_of_what_it_is_rated_for(rated, least):
    """N m: a light run of 100 N m knows its own torque no better than a heavy one."""
    run = SimpleNamespace(groups=[], drive_torque=np.full(5, 100.0), rated_torque=rated, unit_torque=1.0)
    assert least_noise_of(run) == pytest.approx(least)


def test_a_drives_torque_has_a_zero_like_a_transducer():
    """A torque that was off by 0.07 % of the rated one was a tare of 19 kg; 0.15 bar are a step and a half of it."""
    run = SimpleNamespace(
        groups=[], time=np.zeros(5), speed=np.zeros(5), load=np.zeros(5), radius=np.ones(5), gear_ratio=100.0,
        inertia=1.0, acceleration=np.zeros(5), dt=0.02, rated_torque=300.0, corrections=np.empty((5, 0)),
        predicted=np.zeros(5), from_speed=np.zeros(5), load_friction=np.zeros(5), load_acceleration=np.zeros(5),
    )  # fmt: skip
    zero = tolerance_columns(run)[:, [name for name, *_ in TOLERANCES].index("zero")]
    assert 0.15 * zero == pytest.approx(np.full(5, 1.5 * 1e-3 * 300.0))


def test_gears_may_lose_with_the_ropes_true_tension():
    """A load that is accelerated upwards at a tenth of g pulls by a tenth more, and what is lost as a share of its pull
    may grow by as much, or by nothing: a tenth of 300 N m per unit is between none and all of it."""
    run = SimpleNamespace(
        groups=[], time=np.zeros(3), speed=np.zeros(3), load=np.full(3, 4e4), radius=np.ones(3), gear_ratio=100.0,
        inertia=1.0, acceleration=np.zeros(3), dt=0.02, rated_torque=300.0, corrections=np.empty((3, 0)),
        predicted=np.zeros(3), from_speed=np.zeros(3), load_friction=np.array([300.0, 300.0, -300.0]),
        load_acceleration=np.array([0.0, 0.981, 0.981]),
    )  # fmt: skip
    at = [name for name, *_ in TOLERANCES].index("tension")
    np.testing.assert_allclose(tolerance_columns(run)[:, at], [0.0, 30.0, -30.0])
    assert TOLERANCES[at][2:] == (0.0, 1.0)


def test_a_coarse_transducer_may_be_off_by_its_own_step():
    """10 bits over 400 bar step by 0.39 bar: 0.3 bar of the passive side were a zero of a winch that lacks nothing."""
    ones, step = np.ones(1000), 4e7 / 1024
    drop = np.round((2e7 + 4e6 * np.sin(0.01 * np.arange(1000)) + 5e4 * np.sin(1e5 * np.arange(1000.0))) / step) * step
    columns = {"main.pressure_a": drop, "main.pressure_b": 2e6 * ones, "main.displacement": 3e-5 * ones}
    run = Run("coarse", {"time": 0.02 * np.arange(1000), "motor_speed": ones, **columns})
    crane = SimpleNamespace(motor_count=lambda name: 11, max_displacement=3.5e-5)
    (own,) = measured_groups(columns, run, crane, 15)
    bar = 11 * own.displacement * BAR
    np.testing.assert_allclose(0.15 * own.of_zero(0.15), step / BAR * bar)
    np.testing.assert_allclose(replace(own, digit=1e3).of_zero(0.15), bar)  # a fine one's is no less than before


def test_where_port_b_is_the_higher_the_operating_point_has_its_pressure(crane_150t, crane2_model):
    prepared = meet(runs_with(917, "quiet", length=0.3), crane_150t, crane2_model).prepared
    names, seen = [signal.name for signal in GROUP_SIGNALS], 0
    for run in prepared:
        for k, group in enumerate(run.groups):
            start = len(WINCH_SIGNALS) + k * len(names)
            role = (1.0 if group.balances else -1.0) if len(run.groups) > 1 else 0.0
            assert np.all(run.point[start + names.index("role")] == role)
            at = dict(zip(names, run.point[start : start + len(names)], strict=True))
            port_b = 0.5 * (at["pressure_sum"] - at["higher_port"] * at["pressure"])
            np.testing.assert_allclose(port_b, 0.5 * (group.pressure_sum - group.pressure), rtol=1e-9)
            seen += int(np.sum(port_b > 0.5 * at["pressure_sum"] + 5e5))
    assert seen > 100


def test_an_error_of_a_stroke_leaves_the_pressure_and_takes_the_displacement():
    """Both are the same torque of the motors; only their own friction, of pressure and of displacement, differs."""
    ones = np.ones(3)
    own = GroupSignals("main", 11, 9e6 * ones, 1e7 * ones, 5e5 * ones, 3e-5 * ones, True, 9e6 * ones)
    other = replace(own, name="passive", balances=False, count=5)
    torque = 5 * 3e-5 * 9e6
    main, passive = without_error((own, other), 0.0, 0.1 * torque)
    assert main is own
    np.testing.assert_allclose(passive.displacement, 2.7e-5)
    np.testing.assert_allclose(passive.pressure, 9e6)
    np.testing.assert_allclose(without_error((own, other), 0.1 * torque)[1].pressure, 8.1e6)
    at_rest = replace(other, pressure=0.0 * ones)
    np.testing.assert_allclose(without_error((own, at_rest), 0.0, 5.0)[1].displacement, 3e-5)


@pytest.mark.parametrize("noise", [0.0, 2e-4])
@pytest.mark.parametrize("dt", [0.02, 0.2])
def test_a_displacement_that_is_set_anew_is_followed_and_a_steady_one_smoothed(noise, dt):
    time = np.arange(0.0, 240.0, dt)
    true = np.interp(time, [100.0, 102.0], [1.0, 0.7])
    values = true + noise * np.random.default_rng(0).standard_normal(len(time))
    window = max(int(0.3 / dt), 5) | 1
    found = smooth_between_steps(values, window, 5 * window)
    assert np.abs(found - true).max() < 0.01 + 5.0 * noise  # smoothed over the widest window it is 0.06 off at 5 Hz
    steady = time < 90.0
    assert np.std(found[steady] - true[steady]) <= 0.4 * noise + 1e-12


def test_a_feedback_is_nowhere_off_what_was_logged_by_more_than_four_times_its_noise():
    """Which is a fifty-hundredth of it at least, 2e-4; a step of twenty times that was rounded by half of itself."""
    values = np.where(np.arange(400) < 200, 1.0, 1.004)
    assert np.abs(smooth_between_steps(values, 15, 75) - values).max() <= 4.0 * 2e-4 * 1.004 + 1e-12


def test_a_steady_feedback_is_smoothed_over_the_widest_window_as_it_was_logged():
    values = 1.0 + 1e-3 * np.random.default_rng(1).standard_normal(600)
    np.testing.assert_allclose(smooth_between_steps(values, 15, 75)[100:500], smooth(values, 75)[100:500], rtol=1e-12)


@pytest.mark.parametrize("rated", [150e3, 0.0])
def test_a_run_knows_what_its_shaft_holds_under_the_rated_load(crane_150t, crane2_model, rated):
    """On the outermost layer, over the gear; nothing where nobody rates the crane."""
    crane = replace(crane_150t, rated_load=rated)
    own = prepare(runs_with(917, "quiet", length=0.3)[0], crane, crane2_model, mode=Mode(0.0, 0.0))
    assert own.rated_torque == pytest.approx(rated * 9.80665 * max(crane.drum.layer_radii) / crane.gear_ratio, rel=1e-3)


def test_what_was_seen_of_a_run_serves_for_another_model_and_changes_nothing(crane_150t, crane2_model):
    runs = runs_with(917, "quiet", length=0.3)
    given = meet(runs, crane_150t, crane2_model)
    softer = crane2_model.with_values([0.8 * value for value in crane2_model.values])
    for run, old in zip(given.runs, given.prepared, strict=True):
        again = prepare(run, crane_150t, softer, mode=old.wire_mode, spikes=old.spikes, seen=old.seen)
        afresh = prepare(run, crane_150t, softer, mode=old.wire_mode, spikes=old.spikes)
        assert again.seen is old.seen
        assert afresh.seen is not old.seen
        np.testing.assert_array_equal(again.gap, afresh.gap)
        np.testing.assert_array_equal(again.jacobian, afresh.jacobian)
    run, other, old = given.runs[0], given.runs[1], given.prepared[0]
    assert prepare(other, crane_150t, softer, seen=old.seen).seen is not old.seen, "another run"
    assert prepare(run, crane_150t, softer, turning=True, seen=old.seen).seen is not old.seen, "seen in another way"
    other_gear = replace(crane_150t, gear_ratio=200.0)
    assert prepare(run, other_gear, softer, seen=old.seen).seen is not old.seen, "a drum's speed is another then"


def test_only_runs_that_a_model_is_fitted_to_tell_what_its_corrections_change(crane_150t, crane2_model):
    runs = runs_with(917, "quiet", length=0.3)
    model = replace(crane2_model, corrections=(Correction("inertia", 0.02, std=0.02),))
    names = [run.name for run in runs[:2]]
    every, some, none = (meet(runs, crane_150t, model, fitted).prepared for fitted in (None, names, ()))
    assert [run.corrections.shape[1] for run in every] == [1] * len(runs)
    assert [run.corrections.shape[1] for run in some[:2]] == [1, 1]
    np.testing.assert_array_equal(some[0].corrections, every[0].corrections)
    assert not any(run.corrections.shape[1] or run.seen for run in (*some[2:], *none))
    for own, alone in zip(every, none, strict=True):
        np.testing.assert_array_equal(own.gap, alone.gap)


@pytest.mark.parametrize("samples", [7, 59, 61, 63, 121, 301])
def test_a_wide_window_smooths_as_a_narrow_one_does(samples):
    """A parabola stays as it is, and elsewhere each value is the parabola's through the samples around it."""
    time = np.linspace(-1.0, 1.0, 400)
    np.testing.assert_allclose(smooth(3.0 + time - 2.0 * time**2, samples), 3.0 + time - 2.0 * time**2, atol=1e-12)
    rough = np.random.default_rng(1).standard_normal(400)
    own = np.polynomial.Polynomial.fit(range(samples), rough[200 - samples // 2 :][:samples], 2)
    assert smooth(rough, samples)[200] == pytest.approx(own(samples // 2), abs=1e-12)


def test_a_zero_within_a_transducers_step_is_nobodys_effect_and_a_larger_one_is(crane_150t, crane2_model):
    """Pressures that are off by less than a 12-bit transducer tells are taken out with the base's own errors."""
    runs = runs_with(917, "quiet", length=0.3)

    def left(off, group):
        """The square of what the base leaves of the gap, in noises."""
        moved = [
            replace(
                run, columns={n: v + off * BAR if n == f"{group}.pressure_a" else v for n, v in run.columns.items()}
            )
            for run in runs
        ]
        prepared = meet(moved, crane_150t, crane2_model).prepared
        base = base_of(crane2_model, crane2_model)
        problem = build_problem(prepared, layout_of(base, (), prepared, crane2_model))
        return CrossFit(problem).explain(()).train_loss / float(problem.grams.count.sum())

    asis = left(0.0, "main")
    for group in ("main", "passive"):
        whole, tolerated = left(1.5, group) - asis, left(0.12, group) - asis
        assert whole > 1.0
        assert tolerated < 0.1 + 0.001 * whole


def test_a_friction_that_drifts_is_taken_at_the_records_own_date(crane_150t, crane2_model):
    """Wear goes over months: a record of a minute shows its level by when it was made, and hardly a slope."""
    terms = (*crane2_model.terms, term_named("wear_drift"))
    began, months = 1.7e9, 1.0e7  # s: Unix time, e-fold
    values = (*crane2_model.values, 4.0, began, months)  # N m of each motor
    worn = FrictionModel(terms=terms, values=values, name="worn")
    run = runs_with(917, "quiet", length=0.3)[0]
    predicted = {}
    for date in (began, began + months):
        dated = replace(run, columns=run.columns | {"time": run.time - run.time[0] + date})
        prepared = prepare(dated, crane_150t, worn)
        predicted[date] = prepared.predicted[prepared.used]
        direction = prepared.direction[prepared.used]
    motors = crane_150t.motor_total(run.groups)
    added = (predicted[began + months] - predicted[began]) * direction
    assert np.median(added) == pytest.approx(motors * 4.0, rel=0.02)
