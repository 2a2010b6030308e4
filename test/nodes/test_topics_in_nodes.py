"""rclpy's messages carry samples out and in without a loss."""

import math

import pytest

from winch_friction.nodes.inputs import (
    ROS,
    clock_message,
    diagnostic_array,
    diagnostic_status,
    plain_value,
    pressure_message,
    ros_time,
)
from winch_friction.physics.signals import GroupSample, Sample
from winch_friction.records.sample_stream import InputHold, SampleStream
from winch_friction.records.topics import crane_topics


@pytest.mark.parametrize("pressure_reference", ["gauge", "absolute"])
@pytest.mark.parametrize("displacement_unit", ["fraction", "m3_per_rad"])
@pytest.mark.parametrize("speed_joint", ["winch_motor", "winch_drum"])
def test_a_sample_goes_out_and_comes_back(crane_150t, pressure_reference, displacement_unit, speed_joint) -> None:
    topics = crane_topics(
        crane_150t,
        pressure_reference=pressure_reference,
        displacement_unit=displacement_unit,
        speed_joint=speed_joint,
    )
    groups = {"active": GroupSample(1.2e7, 2.5e6, 3.4e-5), "passive": GroupSample(3e7, 2.4e6, 1.1e-5)}
    sent = Sample(
        time=1000.25, motor_speed=-12.5, speed_reference=-12.0, hook_load=55e3, oil_temperature=41.0, groups=groups
    )
    stream = SampleStream(topics, InputHold(topics.groups))
    out = [stream.take(topics.inputs[topic], message, 1000.25) for topic, message in topics.encode(sent, ROS)]
    back = out[-1]
    assert out[:-1] == [None] * (len(out) - 1)
    for name in ("time", "motor_speed", "speed_reference", "hook_load", "oil_temperature"):
        assert getattr(back, name) == pytest.approx(getattr(sent, name), rel=1e-12)
    assert math.isnan(back.heave_velocity)
    for name, group in groups.items():
        assert back.groups[name].pressure_a == pytest.approx(group.pressure_a, rel=1e-12)
        assert back.groups[name].displacement == pytest.approx(group.displacement, rel=1e-12)


def test_diagnostics_are_plain_numbers() -> None:
    status = diagnostic_status("compensator: feedforward", "crane", 1, "fading", {"torque": 1.5, "enabled": True})
    assert [(pair.key, pair.value) for pair in status.values] == [("torque", "1.5"), ("enabled", "1")]
    assert status.level == b"\x01"
    assert plain_value(1.0e-14) == "1e-14"


def test_a_status_says_whose_it_is_of_what_and_in_how_many_digits() -> None:
    status = diagnostic_status(
        "compensator: inputs", "crane 7", 2, "silent", {"age": 1234.56789, "reason": "no", "n": 7}
    )
    assert (status.name, status.hardware_id, status.message) == ("compensator: inputs", "crane 7", "silent")
    assert [pair.value for pair in status.values] == ["1234.56789", "no", "7"]
    made = diagnostic_array(ros_time(12.5), [status])
    assert (made.header.stamp.sec, made.header.stamp.nanosec, list(made.status)) == (12, 500_000_000, [status])


def test_a_pressure_and_a_clock_say_when_and_how_much() -> None:
    message = pressure_message(1000.75, 2.5e6, "valid 7")
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == (1000, 750_000_000)
    assert (message.header.frame_id, message.fluid_pressure, message.variance) == ("valid 7", 2.5e6, 0.0)
    assert (clock_message(3.25).clock.sec, clock_message(3.25).clock.nanosec) == (3, 250_000_000)
