"""Latest-sample hold with an age limit per input."""

import math
from types import SimpleNamespace

import numpy as np

from winch_friction.physics.signals import GroupSample, Run, Sample
from winch_friction.records.sample_stream import DEPTH, OTHER_CLOCK, InputHold, SampleStream


def test_holds_until_the_age_limit_of_the_input():
    hold = InputHold(groups=("main",), max_age=0.1, max_ages={"hook_load": 2.0, "pressure_b": 0.5})
    for column in ("motor_speed", "hook_load", "main.pressure_a", "main.pressure_b"):
        hold.put(column, 0.0, 7.0)
    at = hold.sample(0.3)
    assert math.isnan(at.motor_speed)
    assert at.hook_load == 7.0
    assert math.isnan(at.groups["main"].pressure_a)
    assert at.groups["main"].pressure_b == 7.0
    assert math.isnan(at.groups["main"].displacement)
    assert hold.ages(0.3)["motor_speed"] == 0.3


def test_an_input_may_have_an_age_limit_of_its_own_beside_its_channel():
    hold = InputHold(groups=("main",), max_ages={"pressure_a": 0.5, "main.pressure_a": 2.0, "hook_load": 5.0})
    assert hold.limit("main.pressure_a") == 2.0
    assert hold.limit("other.pressure_a") == 0.5
    assert hold.limit("hook_load") == 5.0
    assert hold.limit("motor_speed") == hold.max_age


def test_ignores_what_is_not_finite_or_late():
    hold = InputHold()
    assert hold.put("motor_speed", 1.0, 5.0)
    assert not hold.put("motor_speed", 0.9, 6.0)
    assert not hold.put("motor_speed", 1.1, math.nan)
    assert hold.sample(1.05).motor_speed == 5.0


def test_fills_the_holes_of_a_run_and_never_replaces_what_it_says():
    nan = math.nan
    columns = {
        "time": [0.0, 0.02, 0.04, 0.02],
        "motor_speed": [1.0, 2.0, 3.0, 4.0],
        "main.pressure_a": [5.0, nan, 6.0, nan],
        "main.pressure_b": [1.0] * 4,
        "main.displacement": [1.0] * 4,
    }
    run = Run("holes", {name: np.array(values) for name, values in columns.items()})
    samples = list(InputHold().samples(run))
    assert [s.motor_speed for s in samples] == [1.0, 2.0, 3.0, 4.0]
    assert [s.groups["main"].pressure_a for s in samples] == [5.0, 5.0, 6.0, 5.0]


def test_the_order_of_arrival_between_inputs_does_not_matter():
    early, late = InputHold(), InputHold()
    for stamp in (0.0, 0.02):
        early.put("motor_torque", stamp, 10.0 + stamp)
    early.put("motor_speed", 0.0, 1.0)
    late.put("motor_torque", 0.0, 10.0)
    late.put("motor_speed", 0.0, 1.0)
    assert early.sample(0.0).motor_torque == late.sample(0.0).motor_torque
    assert early.sample(0.0).motor_torque == 10.0


def test_stamps_that_differ_by_their_rounding_are_one_time():
    """Unix times have steps of 2e-7 s: the pressure that was stamped with the speed is not a later one."""
    hold = InputHold()
    hold.put("hook_load", 1.7e9 + 4e-7, 5e4)
    assert hold.sample(1.7e9).hook_load == 5e4
    assert math.isnan(hold.sample(1.7e9 - 1e-3).hook_load)


def test_other_age_limits_hold_from_the_next_sample_on():
    hold = InputHold(max_age=0.1, max_ages={"hook_load": 2.0})
    hold.put("hook_load", 0.0, 5e4)
    assert hold.sample(1.0).hook_load == 5e4
    hold.max_ages = {"hook_load": 0.5}
    assert math.isnan(hold.sample(1.0).hook_load)
    hold.max_ages, hold.max_age = {}, 3.0
    assert hold.sample(1.0).hook_load == 5e4


def test_what_cannot_be_is_not_preferred_to_what_is_held():
    """A sensor that gives 1e9 Pa for one sample."""
    hold = InputHold(groups=("main",))
    good = Sample(0.0, 50.0, groups={"main": GroupSample(150e5, 25e5, 3e-5)})
    assert hold.fill(good).groups["main"].pressure_a == 150e5
    bad = Sample(0.02, 50.0, groups={"main": GroupSample(1e12, 26e5, 3e-5)})
    filled = hold.fill(bad).groups["main"]
    assert (filled.pressure_a, filled.pressure_b) == (150e5, 26e5)


def test_no_input_is_younger_than_now():
    hold = InputHold()
    hold.put("hook_load", 1.0, 5e4)
    assert hold.ages(0.5) == {"hook_load": 0.0}


def says(topic, channel):
    return SimpleNamespace(topic=topic, stamped=True, decode=lambda message: {channel: message})


def test_a_speed_that_cannot_be_makes_no_sample():
    stream = SampleStream(SimpleNamespace(speed_topic="speed", max_displacement=0.0), InputHold())
    assert stream.take_speed(says("speed", "motor_speed"), 1e9, 1.0, 1.0) is None
    assert stream.last_stamp == -math.inf
    assert stream.take_speed(says("speed", "motor_speed"), 10.0, 1.0, 1.0).motor_speed == 10.0
    assert (stream.counts["speed"], stream.rejected["speed"]) == (2, 1)


def test_what_waits_for_a_speed_is_forgotten_when_the_clock_jumps():
    stream = SampleStream(SimpleNamespace(speed_topic="speed", max_displacement=0.0), InputHold())
    stream.put_off(says("load", "hook_load"), 5e4, 5.0)
    stream.forget()
    assert math.isnan(stream.take_speed(says("speed", "motor_speed"), 10.0, 6.0, 6.0).hook_load)
    stream.put_off(says("load", "hook_load"), 5e4, 6.01)
    assert stream.take_speed(says("speed", "motor_speed"), 10.0, 6.02, 6.02).hook_load == 5e4


# -- what waits for a speed
class Topic(SimpleNamespace):
    """An input without a stamp."""

    def decode(self, message):
        return {"hook_load": message}


def waiting_stream():
    hold = InputHold()
    stream = SampleStream(SimpleNamespace(speed_topic="speed", max_displacement=0.0), hold)
    speed = SimpleNamespace(topic="speed", stamped=True, decode=lambda message: {"motor_speed": message})
    return stream, Topic(topic="load", stamped=False), speed


def test_what_waits_while_no_speed_comes_is_bounded():
    """A thousand a second for a night had been kept."""
    stream, load, speed = waiting_stream()
    for k in range(3 * DEPTH):
        stream.put_off(load, float(k), 1e-3 * k)
    assert sum(map(len, stream._unstamped.values())) == DEPTH
    assert stream.take_speed(speed, 1.0, 10.0, 10.0).hook_load == 3 * DEPTH - 1


def test_the_load_of_a_sender_whose_clock_is_ahead_is_the_load_all_the_same():
    """It waited for a speed sent after it, an hour long, while the diagnostics saw it come."""
    stream, load, speed = waiting_stream()
    stream.put_off(load, 55e3, 100.0 + 3600.0)
    assert stream.take_speed(speed, 1.0, 100.0, 100.0).hook_load == 55e3
    stream.put_off(load, 60e3, 100.0 + 0.5 * OTHER_CLOCK)
    assert stream.take_speed(speed, 1.0, 100.1, 100.1).hook_load == 55e3, "sent after this speed"


def test_what_a_sample_shows_has_a_stamp():
    hold = InputHold()
    for k in range(3):
        hold.put("speed_reference", 1.0 + 0.1 * k, float(k))
    assert [hold.stamp("speed_reference", at) for at in (1.05, 1.15, 9.0)] == [1.0, 1.1, 1.2]
    assert math.isnan(hold.stamp("speed_reference", 0.5))
    assert math.isnan(hold.stamp("hook_load", 1.0))
    hold.drop_after(1.15)
    assert math.isnan(hold.stamp("speed_reference", 1.05))
