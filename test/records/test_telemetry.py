"""Frames for watch and dashboard: what comes in, in which unit, and what is said of it."""

from types import SimpleNamespace as Message

import pytest

from winch_friction.records.telemetry import Telemetry, estimates, faults, inputs, state


def joint(time, **values):
    header = Message(stamp=Message(sec=int(time), nanosec=int(1e9 * (time % 1))))
    return Message(header=header, name=values.pop("name", ["winch_motor"]), **{"position": [], "effort": [], **values})


def diagnostics(name, level, **values):
    pairs = [Message(key=key.replace("_", " "), value=value) for key, value in values.items()]
    return Message(status=[Message(name=name, level=level, message="said", hardware_id="c", values=pairs)])


def test_points_are_spaced_and_in_the_units_that_people_read():
    telemetry = Telemetry()
    for k in range(100):
        telemetry.take("winch/joint_states", joint(0.01 * k, velocity=[104.7198]))
    points = telemetry.frame()["points"]["speed"]
    assert len(points) == pytest.approx(20, abs=1)
    assert points[0][1] == pytest.approx(1000.0, rel=1e-4)
    assert telemetry.frame()["points"] == {}


def test_estimates_and_rates_are_those_of_the_winch_that_is_watched():
    """/diagnostics is all winches': the first that was heard was shown as whichever one was asked for."""
    telemetry = Telemetry(namespace="/south/")
    for name, value in (("north", "1"), ("south", "2"), ("southern", "3")):
        telemetry.take("/diagnostics", diagnostics(f"{name}/estimator: parameters", 2, **{"C6": value, "C6_std": "1"}))
    status = telemetry.frame()["status"]
    assert [each["value"] for each in estimates(status)] == [2.0]
    assert len(faults(status)) == 1


def test_a_clock_that_is_set_back_silences_no_signal():
    telemetry = Telemetry()
    for time in (100.0, 10.0, 10.01, 10.06):
        telemetry.take("winch/joint_states", joint(time, velocity=[1.0]))
    assert [time for time, _ in telemetry.frame()["points"]["speed"]] == [100.0, 10.0, 10.06]


def test_a_plain_number_of_a_bridge_is_dated_by_its_receipt():
    telemetry = Telemetry()
    telemetry.take("winch/joint_states", Message(data=104.7198), 7.0)
    telemetry.take("winch/reference", Message(data=-104.7198), 7.0)
    points = telemetry.frame()["points"]
    assert points["speed"] == [[7.0, pytest.approx(1000.0, rel=1e-4)]]
    assert points["reference"] == [[7.0, pytest.approx(-1000.0, rel=1e-4)]]


def test_what_was_said_of_a_joint_is_over_once_the_motors_is_there():
    telemetry = Telemetry()
    telemetry.take("winch/joint_states", joint(0.0, name=["boom"], velocity=[1.0]))
    assert telemetry.frame()["notes"] != []
    telemetry.take("winch/joint_states", joint(1.0, name=["boom", "winch_motor"], velocity=[1.0, 2.0]))
    assert telemetry.frame()["notes"] == []


@pytest.mark.parametrize("topic", ["winch/joint_states", "compensator/friction_torque", "simulator/truth"])
def test_a_joint_without_a_value_is_a_gap_in_its_curve(topic):
    """Arrays of a JointState may be shorter than its names: drivers leave out what they do not know."""
    telemetry = Telemetry()
    telemetry.take(topic, joint(0.0, velocity=[]))
    assert telemetry.frame()["points"].get("speed", []) == []
    assert all(value is None for points in telemetry.frame()["points"].values() for _, value in points)


def test_the_speed_is_the_joints_that_is_asked_for():
    """A JointState of the whole crane: the first joint was shown as the motor's speed."""
    crane = {"name": ["boom", "winch_motor", "winch_7"], "velocity": [1.0, 2.0, 3.0]}
    for wanted, shown in (("", 2.0), ("winch_7", 3.0), ("boom", 1.0), ("moon", None)):
        telemetry = Telemetry(wanted)
        for topic in ("winch/joint_states", "winch/reference"):
            telemetry.take(topic, joint(1.0, **crane))
        frame = telemetry.frame()
        rpm = [[1.0, pytest.approx(60.0 * shown / 6.2831853, rel=1e-4)]] if shown else None
        assert frame["points"] == ({"speed": rpm, "reference": rpm} if shown else {})
        assert [said for _, said in frame["notes"]] == (
            [] if shown else ["no joint 'moon', and no speed of it, among 'boom', 'winch_motor', 'winch_7'"] * 2
        )
    telemetry = Telemetry()
    telemetry.take("winch/joint_states", joint(1.0, name=["boom", "winch_7"], velocity=[1.0, 3.0]))
    ((topic, said),) = telemetry.frame()["notes"]
    assert (topic, said[:55]) == ("winch/joint_states", "the speed is of joint 'boom' of 'boom', 'winch_7': name")


def test_the_truth_carries_friction_and_tracking_error():
    telemetry = Telemetry()
    message = joint(1.0, name=["winch_motor", "load"], position=[0.0, 0.004], velocity=[0.0, 0.0], effort=[350.0, 1.0])
    telemetry.take("simulator/truth", message)
    points = telemetry.frame()["points"]
    assert points["truth"][0][1] == 350.0
    assert points["error"][0][1] == pytest.approx(4.0)


@pytest.mark.parametrize("level", [2, b"\x02"])
def test_diagnostics_become_state_estimates_inputs_and_faults(level):
    telemetry = Telemetry()
    telemetry.take("/diagnostics", diagnostics("estimator: parameters", 0, C1="2", C1_std="0.5", C1_status="learned"))
    telemetry.take("/diagnostics", diagnostics("compensator: inputs", level, speed_rate="50", speed_age="0.01"))
    telemetry.take("/diagnostics", diagnostics("compensator: feedforward", 0, state="active"))
    status = telemetry.frame()["status"]
    assert estimates(status) == [{"parameter": "C1", "value": 2.0, "std": 0.5, "status": "learned"}]
    assert inputs(status) == [{"input": "speed", "rate": 50.0, "age": 0.01}]
    assert faults(status) == ["error: compensator: inputs: said"]
    assert state(status) == [("compensator: feedforward", "said")]
