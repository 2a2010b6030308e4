"""The topic map: every column survives its message, in every convention of unit and reference."""

from types import SimpleNamespace

import pytest

from winch_friction.physics.errors import InputError
from winch_friction.records.crane_file import load_crane
from winch_friction.records.topics import ATMOSPHERE, SPEED_TOPIC, TopicMap, header, nanoseconds, seconds, stamp_of

VALUES = {
    "motor_speed": 120.0, "shaft_angle": 3.5, "speed_reference": 118.0, "active.pressure_a": 2.1e7,
    "active.pressure_b": 2.5e6, "active.displacement": 2.3e-5, "hook_load": 55e3, "oil_temperature": 42.5,
    "heave_velocity": 0.4, "wire_layer": 5.0, "wire_out": 800.0,
}  # fmt: skip


def as_message(content):
    if isinstance(content, dict):
        return SimpleNamespace(**{key: as_message(value) for key, value in content.items()})
    return content


@pytest.mark.parametrize("joint", ["winch_motor", "winch_drum"])
@pytest.mark.parametrize("reference", ["absolute", "gauge"])
@pytest.mark.parametrize("unit", ["fraction", "m^3/rad"])
def test_every_column_survives_its_message(joint, reference, unit):
    crane = load_crane("crane_150t")
    topics = TopicMap.for_crane(
        crane, ["active"], joint=joint, pressure_reference=reference, displacement_unit=unit
    ).topics()
    read = {}
    for topic in topics:
        message = as_message(topic.content(12.5, VALUES))
        assert stamp_of(message) in (12.5, None)
        read.update(topic.values(message))
    assert read == pytest.approx(VALUES, rel=1e-14)


def test_conventions_show_in_the_message():
    crane = load_crane("crane_150t")
    by_name = {t.name: t for t in TopicMap.for_crane(crane, ["active"], joint="winch_drum").topics()}
    pressure = by_name["winch/active/pressure_a"].content(0.0, VALUES)
    assert pressure["fluid_pressure"] == VALUES["active.pressure_a"] + ATMOSPHERE
    assert by_name[SPEED_TOPIC].content(0.0, VALUES)["velocity"] == [120.0 / 250]


def test_joints_are_picked_by_name_and_short_arrays_are_nan():
    topic = TopicMap(electric=True).topics()[-1]
    message = as_message(
        {"header": header(0), "name": ["other", "winch_motor"], "position": [], "velocity": [1.0, 2.0], "effort": [9.0]}
    )
    values = dict(topic.values(message))
    assert values["motor_speed"] == 2.0
    assert values["motor_torque"] != values["motor_torque"]
    assert values["shaft_angle"] != values["shaft_angle"]


def test_plain_floats_take_the_place_of_a_message():
    topic = TopicMap(plain=(SPEED_TOPIC,), joint="winch_drum", gear_ratio=250.0).topics()[-1]
    message = as_message({"data": 2.0})
    assert topic.values(message) == [("motor_speed", 500.0)]
    assert stamp_of(message) is None


def test_times_keep_their_nanoseconds():
    assert seconds(1_763_000_000, 123_456_789) == pytest.approx(1_763_000_000.123456789, abs=3e-7)
    for time in (0.0, 0.02, 17.123456789, 1_763_000_000.25):
        assert seconds(*divmod(nanoseconds(time), 10**9)) == time


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ({"pressure_reference": "sealed"}, "sealed"),
        ({"displacement_unit": "percent"}, "percent"),
        ({"groups": ("main",), "displacement_unit": "fraction"}, "max_displacement"),
        ({"remap": {"winch/joint_state": "/joint_states"}}, "winch/joint_state"),
    ],
)
def test_other_conventions_are_refused(settings, said):
    with pytest.raises(InputError, match=said):
        TopicMap(**settings)
