"""Balance, gear and usual sizes by hand, of a drum with 1 m on the outer layer, 0.5 m on the inner and a gear of 50."""

from dataclasses import replace

import numpy as np
import pytest

from winch_friction.importing import balance, expectations
from winch_friction.importing.contradiction import contradictions, run_contradictions
from winch_friction.importing.kinematics import along_speed, rope_over_motor
from winch_friction.physics.channels import GRAVITY
from winch_friction.physics.signals import Run
from winch_friction.physics.winch.crane import ELECTRIC, POWER, Drive, Drum
from winch_friction.records.crane_file import load_crane

TIME = np.arange(2000) * 0.05
SPEED = 100.0 * np.sin(0.4 * TIME)
ONE = np.ones(len(TIME))


@pytest.fixture
def crane(crane_150t):
    """Ten motors of 2e-5 m^3/rad in one group, four and six of them in two others."""
    return replace(
        crane_150t,
        gear_ratio=50.0,
        drum=Drum(layer_radii=(0.5, 1.0)),
        groups={"main": 10, "active": 4, "passive": 6},
        max_displacement=2e-5,
        absolute_torque_limit=1000.0,
        rated_load=None,
    )


def logged(drop=100e5, **more):
    """Ten motors at 2e-5 m^3/rad, so that a bar is 20 N m; the load is what they hold on the outer layer."""
    columns = {
        "time": TIME,
        "motor_speed": SPEED,
        "main.pressure_a": 25e5 + drop * ONE,
        "main.pressure_b": 25e5 * ONE,
        "main.displacement": 2e-5 * ONE,
        "hook_load": 2000.0 * 50.0 / GRAVITY * ONE,
    }
    return {**columns, **more}


# -- the load's torque and the motors'
@pytest.mark.parametrize(
    ("columns", "torque"),
    [
        ({"hook_load": 1000.0}, 1000.0 * GRAVITY / 50.0),  # nobody says the layer: the outer one
        ({"hook_load": 1000.0, "wire_layer": 1.0}, 500.0 * GRAVITY / 50.0),
        ({"hook_load": 1000.0, "wire_layer": 1.9}, 1000.0 * GRAVITY / 50.0),
        ({"hook_load": 1000.0, "wire_layer": 0.0}, 500.0 * GRAVITY / 50.0),  # of no layer: the nearest
        ({"hook_load": 1000.0, "wire_layer": 7.0}, 1000.0 * GRAVITY / 50.0),
        ({"hook_load": 1000.0, "wire_layer": np.nan}, 1000.0 * GRAVITY / 50.0),
        ({"rope_force": 1000.0}, 20.0),
        ({"rope_force": 1000.0, "wire_layer": 1.0}, 10.0),
        ({"rope_force": 1000.0, "hook_load": 1000.0}, 1000.0 * GRAVITY / 50.0),
        ({"load_torque": 30.0, "hook_load": 1000.0}, 30.0),  # what is measured at the shaft goes before
    ],
)
def test_the_torque_of_a_load_is_that_of_its_layer(columns, torque, crane):
    found = balance.load_torque({name: np.full(3, value) for name, value in columns.items()}, crane)
    np.testing.assert_allclose(np.broadcast_to(found, 3), torque)


def test_without_a_load_there_is_no_torque_of_it(crane):
    assert balance.load_torque({"motor_speed": SPEED}, crane) is None


@pytest.mark.parametrize("lacking", ["main.pressure_a", "main.displacement"])
def test_of_a_group_that_is_logged_in_part_there_is_no_torque_of_the_motors(lacking, crane):
    """And no balance: a map's other columns are proposed all the same."""
    columns = {name: values for name, values in logged().items() if name != lacking}
    assert balance.drive_torque(logged(), crane) is not None
    assert balance.drive_torque(columns, crane) is None
    assert balance.closure(columns, crane) is None


@pytest.mark.parametrize("name", ["emps", "worm_drive"])
def test_of_an_electric_drive_whose_torque_is_not_logged_there_is_none(name):
    columns = {"time": TIME, "motor_speed": SPEED, "load_torque": 10.0 * ONE}
    assert balance.drive_torque(columns, load_crane(name)) is None
    assert balance.closure(columns, load_crane(name)) is None


def test_a_balance_closes_within_a_fifth_of_the_load_and_a_fortieth_of_the_capacity(crane):
    """2000 N m of load, 6000 N m of capacity at 300 bar: 400 and 150 N m may be unexplained."""
    found = balance.closure(logged(), crane)
    assert (found.motors, found.load) == (pytest.approx(2000.0), pytest.approx(2000.0))
    assert found.mismatch == pytest.approx(0.0, abs=1e-9)
    assert found.closes
    for drop, mismatch in ((105e5, 100.0 / 550.0), (95e5, 100.0 / 550.0), (130e5, 600.0 / 550.0)):
        other = balance.closure(logged(drop), crane)
        assert other.mismatch == pytest.approx(mismatch)
        assert other.closes == (mismatch < 1.0)


def test_a_load_that_is_negative_leaves_as_much_unexplained(crane):
    found = balance.closure(logged(hook_load=-logged()["hook_load"]), crane)
    assert found.mismatch == pytest.approx(4000.0 / 550.0)


def test_friction_drops_out_of_the_mean_of_both_ways_however_long_each_took(crane):
    """Hoisted for three times as long as lowered, with 100 N m of friction."""
    speed = np.where(np.arange(len(TIME)) % 4 == 0, -50.0, 50.0)
    drop = 100e5 + 5e5 * np.sign(speed)
    both = balance.closure(logged(drop, motor_speed=speed), crane)
    assert both.motors == pytest.approx(2000.0)
    one_way = balance.closure(logged(drop, motor_speed=np.abs(speed)), crane)
    assert one_way.motors == pytest.approx(2000.0 + 50.0)  # the plain mean
    rarely = np.where(np.arange(len(TIME)) < 4, -50.0, 50.0)
    few = balance.closure(logged(100e5 + 5e5 * np.sign(rarely), motor_speed=rarely), crane)
    assert few.motors == pytest.approx(2100.0, abs=1.0)


def test_what_is_known_by_its_power_or_has_ten_rows_at_most_closes_nothing(crane):
    by_power = replace(crane, drive=Drive(POWER), groups={"motor": 1})
    assert balance.closure(logged(mechanical_power=2000.0 * SPEED), by_power) is None
    few = {name: values[:9] for name, values in logged().items()}
    assert balance.closure(few, crane) is None
    assert balance.closure({n: v for n, v in logged().items() if n != "motor_speed"}, crane) is None


def test_groups_of_another_crane_hold_nothing(crane):
    columns = logged()
    renamed = {name.replace("main.", "other."): values for name, values in columns.items()}
    assert balance.groups_of({**columns, "half.pressure_a": ONE, "half.pressure_b": ONE}) == ["main"]
    assert balance.drive_torque(renamed, crane) is None
    both = balance.drive_torque({**renamed, **columns}, crane)
    np.testing.assert_allclose(both, 2000.0)


@pytest.mark.parametrize("gain", [1.0, -1.0, 0.5, 3.6])
def test_power_is_held_against_load_times_speed(gain, crane):
    columns = logged(mechanical_power=gain * 2000.0 * SPEED)
    assert balance.power_ratio(columns, crane) == pytest.approx(gain)
    holes = {**columns, "mechanical_power": np.where(TIME < 3.0, np.nan, columns["mechanical_power"])}
    assert balance.power_ratio(holes, crane) == pytest.approx(gain)
    assert balance.power_ratio({**columns, "motor_speed": 0.0 * SPEED}, crane) is None


@pytest.mark.parametrize(("gain", "said"), [(1.0, False), (0.6, False), (1.9, False), (0.3, True), (3.0, True),
                                            (-1.0, True), (-3.0, True)])  # fmt: skip
def test_a_power_of_half_or_twice_the_load_s_is_another_unit_or_sign(gain, said, crane):
    by_power = replace(crane, drive=Drive(POWER), groups={"motor": 1})
    found = run_contradictions([Run("log", logged(mechanical_power=gain * 2000.0 * SPEED))], by_power)
    assert [each.startswith(f"log: mechanical_power is {gain:.3g} times load times speed") for each in found] == (
        [True] if said else []
    )


@pytest.mark.parametrize(("sign", "noise"), [(1.0, 10.0), (-1.0, 10.0), (1.0, 0.0), (-1.0, 0.0)])
def test_friction_that_opposes_the_motion_is_told_with_its_sign(sign, noise, crane):
    rough = noise / 20.0 * 1e5 * np.random.default_rng(2).standard_normal(len(TIME))
    found = balance.opposes_motion(logged(100e5 + sign * 5e5 * np.sign(SPEED) + rough), crane)
    assert np.sign(found) == sign
    assert balance.told(found)


def test_what_says_nothing_of_friction_tells_no_sign(crane):
    """Noise alone, one direction alone, no speed."""
    noise = 100e5 + 1e5 * np.random.default_rng(1).standard_normal(len(TIME))
    assert not balance.told(balance.opposes_motion(logged(noise), crane))
    for one_way in (np.abs(SPEED) + 10.0, -np.abs(SPEED) - 10.0):
        assert balance.opposes_motion(logged(105e5, motor_speed=one_way), crane) == 0.0
    assert balance.opposes_motion({n: v for n, v in logged().items() if n != "motor_speed"}, crane) == 0.0


@pytest.mark.parametrize(("t_value", "sure"), [(6.0, True), (-6.0, True), (5.9, False), (-5.9, False)])
def test_a_sign_is_told_by_six_standard_errors(t_value, sure):
    assert balance.told(t_value) == sure


# -- rope over motor
WIRE = 400.0 - np.concatenate([[0.0], np.cumsum(SPEED[1:] * np.diff(TIME))]) / 50.0  # m paid out, on the outer layer


@pytest.mark.parametrize(
    ("columns", "value", "by"),
    [
        ({"wire_out": WIRE}, 1.0, "wire_out"),
        ({"wire_out": -WIRE}, -1.0, "wire_out"),
        ({"wire_out": 1e3 * WIRE}, 1e3, "wire_out"),
        ({"heave_velocity": -SPEED / 50.0}, 1.0, "heave_velocity"),
        ({"heave_velocity": SPEED / 50.0}, -1.0, "heave_velocity"),
        ({"heave_velocity": -SPEED / 50.0, "wire_out": 0.0 * WIRE}, 1.0, "heave_velocity"),  # a wire that stands still
        ({"heave_velocity": SPEED, "wire_out": WIRE}, 1.0, "wire_out"),
    ],
)
def test_the_rope_over_the_motor_is_one_where_unit_sign_and_gear_are_right(columns, value, by, crane):
    found = rope_over_motor({"time": TIME, "motor_speed": SPEED, **columns}, crane)
    assert (found.value, found.by) == (pytest.approx(value, rel=1e-6), by)


def test_what_does_not_move_with_the_motor_tells_no_gear(crane):
    columns = {"time": TIME, "motor_speed": SPEED, "heave_velocity": np.cos(0.4 * TIME)}
    assert rope_over_motor(columns, crane) is None
    assert rope_over_motor({"time": TIME, "wire_out": WIRE}, crane) is None


@pytest.mark.parametrize("factor", [1.0, -1.0, 9.55])
def test_another_channel_of_the_shaft_counts_so_much_per_speed(factor):
    angle = np.concatenate([[0.0], np.cumsum(SPEED[1:] * np.diff(TIME))])
    columns = {"time": TIME, "motor_speed": SPEED, "speed_reference": factor * SPEED, "shaft_angle": factor * angle}
    assert along_speed(columns, "speed_reference") == pytest.approx(factor)
    assert along_speed(columns, "shaft_angle") == pytest.approx(factor)
    assert along_speed({"time": TIME, "motor_speed": SPEED}, "shaft_angle") is None
    assert along_speed({**columns, "speed_reference": 5.0 * ONE}, "speed_reference") is None


# -- usual sizes
HELD = 10 * 2e-5 * 450e5 * 50.0 / (0.5 * GRAVITY)  # kg, by all motors at 450 bar on the inner layer


def test_the_size_of_a_channel_is_what_the_crane_can_do(crane):
    assert expectations.largest_load(crane) == pytest.approx(HELD)
    assert expectations.most_held(crane) == pytest.approx(HELD)
    for channel, size in {
        "displacement": (0.02 * 2e-5, 1.15 * 2e-5),
        "drum_speed": (0.0, 24.0),
        "wire_layer": (1.0, 2.0),
        "hook_load": (100.0, 1.2 * HELD),
        "motor_speed": (1.0, 500.0),
        "pressure_a": (5e5, 6e7),
    }.items():
        assert expectations.usual_size(channel, crane) == pytest.approx(size), channel


def test_a_slow_winch_of_any_drive_has_loads_by_its_own_limits(crane):
    electric = replace(crane, drive=Drive(ELECTRIC), groups={"motor": 1})
    by_torque = 1000.0 * 50.0 / (0.5 * GRAVITY)
    assert expectations.most_held(electric) == pytest.approx(by_torque)
    assert expectations.usual_size("hook_load", electric) == pytest.approx((1e-3 * by_torque, 1.2 * by_torque))
    assert expectations.most_held(replace(electric, rated_load=3000.0)) == 3000.0


@pytest.mark.parametrize(
    ("channel", "values", "fit"),
    [
        ("pressure_a", [5e5, 5e5], True),
        ("pressure_a", [-6e7, -6e7], True),  # by its magnitude
        ("pressure_a", [6.1e7] * 3, False),
        ("pressure_a", [4.9e5] * 3, False),
        ("pressure_a", [0.0, 0.0], False),  # a pressure that is never there is no pressure
        ("wire_out", [0.0, 0.0], True),
        ("pressure_a", [np.nan, np.nan], False),
        ("pressure_a", [np.nan, 1e7], True),
        ("pressure_a", [1e7] * 99 + [1e9], True),  # a spike
    ],
)
def test_a_channel_fits_by_its_95th_percentile(channel, values, fit, crane):
    assert expectations.fits(channel, np.array(values), crane) == fit
    assert expectations.fits(channel, np.array(values), None) == fit


# -- a clock that goes back
@pytest.mark.parametrize(("back", "then"), [(40.0, 135.5), (96.0, 20.0)])
def test_a_clock_that_goes_back_says_how_often_and_where_first(back, then, crane):
    """Whether the first time or the second is the farther back; a time that stands twice goes nowhere."""
    time = np.concatenate([np.arange(100.0), [99.0], back + np.arange(100.0), [then, then + 0.5]])
    assert contradictions({"log": {"time": time}}, crane) == [
        f"log: time goes back 2 times, first after sample 101 by {99.0 - back:.4g} s: several recordings in one file? "
        "cut it there"
    ]


def test_what_an_electric_drive_can_is_what_it_gives_but_for_one_sample_in_twenty(crane):
    """Its log names no motors: of 0 to 400 N m evenly, either way, 380; a spike is no capacity."""
    electric = replace(crane, drive=Drive(ELECTRIC))
    given = np.linspace(-400.0, 400.0, 801)
    given[400] = np.nan
    assert balance._capacity({}, electric, given) == pytest.approx(380.0, abs=1.0)
