"""What would undo a mistake, in a run's view, and by how much a quantity lies beyond what its machine can do."""

import numpy as np
import pytest

from winch_friction.commissioning import diagnose, kinematics, mistakes
from winch_friction.commissioning.kinematics import LATE, agreements, excesses
from winch_friction.commissioning.repairs import (
    displacement_times,
    drop_times,
    in_falls,
    load_times,
    motor_torque_times,
    port_times,
    speeds_times,
)
from winch_friction.commissioning.view import GroupView, RunView

TIME = np.arange(60) * 0.2
SPEED = 100.0 * np.sin(0.8 * TIME)
ONE = np.ones(60)


def view(**more):
    groups = {
        "active": GroupView(3.0, 100e5 * ONE, 150e5 * ONE, 3e-5 * ONE),
        "passive": GroupView(8.0, 200e5 * ONE, 260e5 * ONE, 3.4e-5 * ONE),
    }
    known = {
        "name": "run", "time": TIME, "speed": SPEED, "acceleration": np.gradient(SPEED, TIME), "load": 5e4 * ONE,
        "layer": ONE, "radius": ONE, "gear_ratio": 250.0, "inertia": 1.5, "motors": 11.0, "max_displacement": 3.42e-5,
        "heave": None, "heave_acceleration": 0.0 * ONE, "groups": groups,
    }  # fmt: skip
    return RunView(**{**known, **more})


def test_swapped_ports_change_the_sign_of_the_drop_and_not_of_the_pressures():
    found = drop_times(-1.0, "active")(view()).groups
    assert (found["active"].drop[0], found["active"].pressure_sum[0]) == (-100e5, 150e5)
    assert found["passive"].drop[0] == 200e5
    assert drop_times(10.0)(view()).groups["passive"].pressure_sum[0] == 2600e5


@pytest.mark.parametrize(("port", "a", "b"), [("a", 1250e5, 25e5), ("b", 125e5, 250e5)])
def test_a_unit_of_one_port_leaves_the_other(port, a, b):
    found = port_times(10.0, port)(view()).groups["active"]
    assert 0.5 * (found.pressure_sum[0] + found.drop[0]) == pytest.approx(a)
    assert 0.5 * (found.pressure_sum[0] - found.drop[0]) == pytest.approx(b)


def test_a_factor_reaches_what_was_logged_in_that_unit_and_nothing_else():
    rates = {"speed_reference": SPEED, "shaft_angle": SPEED}
    found = speeds_times(2.0, "shaft_angle")(view(rates=rates))
    for values, factor in (
        (found.speed, 2.0),
        (found.rates["shaft_angle"], 2.0),
        (found.rates["speed_reference"], 1.0),
    ):
        np.testing.assert_array_equal(values, factor * SPEED)
    np.testing.assert_array_equal(found.acceleration, 2.0 * view().acceleration)
    assert load_times(3.0)(view(load_torque=7.0 * ONE)).load_torque[0] == 21.0
    assert load_times(3.0)(view()).load[0] == 15e4
    assert load_times(3.0)(view()).load_torque is None
    assert displacement_times(2.0, "active")(view()).groups["passive"].displacement[0] == 3.4e-5
    assert displacement_times(2.0, "active")(view()).groups["active"].displacement[0] == 6e-5
    assert motor_torque_times(-1.0)(view(motor_torque=5.0 * ONE)).motor_torque[0] == -5.0


@pytest.mark.parametrize("told", [1.0, 0.5])  # the rope that is paid out, the hook's depth
def test_a_hook_in_two_falls_goes_half_as_far_as_the_rope_on_ropes_twice_as_stiff_and_swings_twice_as_fast(told):
    logged = view(rates={"wire_out": told * SPEED / 250.0, "shaft_angle": SPEED}, bounce=3.0, load_torque=7.0 * ONE)
    found = in_falls(2)(logged)
    np.testing.assert_allclose(found.rates["wire_out"], found.speed * found.lever)
    assert (found.radius[0], found.load[0], found.load_torque[0], found.bounce) == (0.5, 5e4, 7.0, 6.0)
    assert found.rates["shaft_angle"] is logged.rates["shaft_angle"]


@pytest.mark.parametrize(("told", "said"), [(2.02, " (the rope of 2 falls, where wire_out is the hook's depth?)"),
                                            (2.5, "")])  # fmt: skip
def test_a_wire_that_is_paid_out_to_several_falls_is_told_as_such(told, said):
    (found,) = diagnose._companions([view(rates={"wire_out": told * SPEED / 250.0})])
    assert found.words == f"wire_out contradicts motor_speed: it tells {told:.3g} times the speed{said}"
    assert found.cause == "companion"  # the balance does not use it


def test_each_channel_is_held_against_the_speed_by_what_it_tells_itself():
    found = diagnose._companions([view(rates={"wire_out": 2.5 * SPEED / 250.0, "speed_reference": SPEED})])
    assert {each.channel: each.factor for each in found} == pytest.approx({"wire_out": 2.5, "speed_reference": 1.0})


def test_exchanged_groups_keep_their_numbers_of_motors():
    found = mistakes._exchanged("active", "passive")(view()).groups
    assert (found["active"].count, found["active"].drop[0]) == (3.0, 200e5)
    assert (found["passive"].count, found["passive"].drop[0]) == (8.0, 100e5)


def test_a_speed_that_is_late_is_what_it_was_before():
    """By 0.4 s: what is logged now was two blocks ago."""
    found = mistakes.delayed(0.4).undo(view())
    np.testing.assert_allclose(found.speed[:-2], SPEED[2:], atol=1e-9)
    np.testing.assert_allclose(found.acceleration[:-2], view().acceleration[2:], atol=1e-9)


def test_a_size_without_a_sign_takes_it_from_a_channel_that_has_one():
    found = mistakes._signed(view(speed=np.abs(SPEED), rates={"heave_velocity": -SPEED, "shaft_angle": SPEED}))
    np.testing.assert_array_equal(found.speed, SPEED)
    untold = view(speed=np.abs(SPEED), rates={"heave_velocity": -SPEED})
    assert mistakes._signed(untold) is untold
    # nor of channels that go one way as well: a reference that is logged without its sign, a wire that is paid out only
    for one_way in (np.abs(SPEED), -np.abs(SPEED)):
        alike = view(speed=np.abs(SPEED), rates={"speed_reference": one_way})
        assert mistakes._signed(alike) is alike


def test_the_sign_of_a_heave_is_that_of_all_that_it_tells():
    found = mistakes._heave_turned(
        view(heave=ONE, heave_acceleration=2.0 * ONE, rates={"heave_velocity": ONE, "shaft_angle": ONE})
    )
    assert (found.heave[0], found.heave_acceleration[0]) == (-1.0, -2.0)
    assert (found.rates["heave_velocity"][0], found.rates["shaft_angle"][0]) == (-1.0, 1.0)


def test_a_load_that_is_wrong_by_a_factor_is_a_gear_or_a_displacement_by_the_other():
    found = {each.channel: each for each in mistakes.free_mistakes([view()], {"load": 2.0, "active": 0.5}, 2e3)}
    assert found["gear_ratio"].factor == found["displacement"].factor == 0.5
    assert found["gear_ratio"].undo(view()).gear_ratio == 125.0
    assert "(125 would close)" in found["gear_ratio"].words
    assert found["hook_load"].undo(view()).load[0] == 5e4 + 2e3  # the tare, which comes last
    assert found["active.displacement"].undo(view()).groups["active"].displacement[0] == 1.5e-5


def swung(share):
    return GroupView(3.0, 1e7 * ONE, 2e7 * ONE, share * 3.42e-5 * ONE)


@pytest.mark.parametrize(
    ("changed", "beyond"),
    [
        ({}, {}),
        ({"speed": 1300.0 * ONE}, {"motor_speed": 2.0}),
        ({"heave": 30.0 * ONE}, {"heave_velocity": 2.0}),
        ({"groups": {"main": GroupView(11.0, 0.0 * ONE, 4e5 * ONE, 3e-5 * ONE)}}, {"main.pressure": 2.0}),
        ({"groups": {"main": GroupView(11.0, 0.0 * ONE, 10e5 * ONE, 3e-5 * ONE)}}, {}),  # 5 bar of boost at each port
        ({"groups": {"main": GroupView(11.0, 1200e5 * ONE, 1300e5 * ONE, 3e-5 * ONE)}}, {"main.pressure": 2.0}),
        (
            {"groups": {"main": GroupView(11.0, 1e7 * ONE, 2e7 * ONE, 2.12 * 3.42e-5 * ONE)}},
            {"main.displacement": 2.0},
        ),
        (
            {"groups": {"main": GroupView(11.0, 1e7 * ONE, 2e7 * ONE, 0.015 * 3.42e-5 * ONE)}},
            {"main.displacement": 2.0},
        ),
        # one of two groups is swung out, as far as its feedback tells; both are not, while the winch turns
        ({"groups": {"active": swung(0.0), "passive": swung(0.5)}}, {}),
        ({"groups": {"active": swung(-0.02), "passive": swung(0.5)}}, {}),
        (
            {"groups": {"active": swung(0.0), "passive": swung(0.015)}},
            {"active.displacement": 2.0, "passive.displacement": 2.0},
        ),
        # a feedback of motors that are swung out reads what its zero is off by; another unit the balance shows
        ({"groups": {"active": swung(0.003), "passive": swung(0.5)}}, {}),
        ({"groups": {"active": swung(0.028), "passive": swung(0.5)}}, {}),
    ],
)
def test_what_no_machine_of_this_kind_does_counts_by_how_far_it_is_beyond(changed, beyond):
    assert excesses(view(**changed)) == pytest.approx(beyond)


def test_a_channel_that_a_filter_rounds_is_not_late():
    """Shifted it agrees a little better; one that is late agrees four times as well."""
    time = np.arange(300) * 0.2
    speed = 100.0 * np.sin(0.8 * time) + 40.0 * np.sin(2.1 * time + 1.0)
    noisy = np.roll(speed, 2) + 30.0 * np.random.default_rng(0).standard_normal(300)
    (rounded,) = agreements(view(time=time, speed=speed, rates={"speed_reference": noisy}))
    (late,) = agreements(view(time=time, speed=speed, rates={"speed_reference": np.roll(speed, 2)}))
    assert rounded.score < LATE <= late.score


def test_a_few_blocks_tell_no_speed():
    few = kinematics.FEWEST - 1
    some = np.where(np.arange(60) < few, -SPEED, np.nan)
    assert agreements(view(rates={"shaft_angle": some})) == []
