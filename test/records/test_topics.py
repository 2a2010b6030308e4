"""The topic map: every channel survives its message, in every convention of unit and reference."""

import math
from dataclasses import replace
from types import SimpleNamespace

import pytest

from winch_friction.physics.channels import DRIVE_SCALARS
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import GroupSample, Sample
from winch_friction.physics.winch import Drive
from winch_friction.records.crane_file import load_crane
from winch_friction.records.topics import ATMOSPHERE, FLOAT64, TopicMap, crane_topics, split_time, stamp_time

SAMPLE = Sample(
    time=12.5,
    motor_speed=120.0,
    shaft_angle=3.5,
    speed_reference=118.0,
    motor_torque=7.0,
    groups={"active": GroupSample(2.1e7, 2.5e6, 2.3e-5)},
    hook_load=55e3,
    oil_temperature=42.5,
    heave_velocity=0.4,
    wire_layer=5.0,
    wire_out=800.0,
    load_torque=-30.0,
    rope_force=5.4e5,
    mechanical_power=2.5e5,
    motor_current=-120.0,
)


class Fields:
    """Messages as bare namespaces: the fields are what counts."""

    def make(self, type_name, **fields):
        return SimpleNamespace(type_name=type_name, **fields)

    def doubles(self, values):
        return list(values)


def channels(sample):
    flat = {name: getattr(sample, name) for name in Sample.__slots__ if name not in ("time", "groups")}
    for group, values in sample.groups.items():
        flat |= {f"{group}.{name}": getattr(values, name) for name in GroupSample.__slots__}
    return flat


@pytest.mark.parametrize("joint", ["winch_motor", "winch_drum"])
@pytest.mark.parametrize("reference", ["absolute", "gauge"])
@pytest.mark.parametrize("unit", ["fraction", "m3_per_rad"])
def test_every_channel_survives_its_message(joint, reference, unit):
    crane = load_crane("crane_150t")
    topics = crane_topics(
        crane, ["active"], speed_joint=joint, pressure_reference=reference, displacement_unit=unit,
        drive_scalars=DRIVE_SCALARS,
    )  # fmt: skip
    read = {}
    for topic, message in topics.encode(SAMPLE, Fields()):
        each = topics.inputs[topic]
        assert message.type_name == each.type_name
        assert not each.stamped or stamp_time(message) == 12.5
        read |= each.decode(message)
    assert read == pytest.approx(channels(SAMPLE), rel=1e-14)


def test_a_node_asks_only_for_what_its_drive_is_known_by():
    crane = load_crane("crane_150t")
    assert not {f"winch/{name}" for name in DRIVE_SCALARS} & set(crane_topics(crane).inputs)
    by_current = crane_topics(replace(crane, drive=Drive("current", 2.0))).inputs
    assert {f"winch/{name}" for name in DRIVE_SCALARS} & set(by_current) == {"winch/motor_current"}


def test_the_speed_closes_the_set_and_absent_channels_stay_out():
    topics = TopicMap(groups=("active",), max_displacement=3.4e-5)
    bare = Sample(time=0.0, motor_speed=1.0, groups={"active": GroupSample()})
    assert [topic for topic, _ in topics.encode(bare, Fields())] == ["winch/joint_states"]
    assert topics.encode(SAMPLE, Fields())[-1][0] == topics.speed_topic


def test_conventions_show_in_the_message():
    topics = crane_topics(load_crane("crane_150t"), ["active"], speed_joint="winch_drum", pressure_reference="absolute")
    sent = dict(topics.encode(SAMPLE, Fields()))
    assert sent["winch/active/pressure_a"].fluid_pressure == 2.1e7 + ATMOSPHERE
    assert sent["winch/joint_states"].velocity == [120.0 / 250]


def test_joints_are_picked_by_name_and_short_arrays_are_nan():
    message = SimpleNamespace(name=["other", "winch_motor"], position=[], velocity=[1.0, 2.0], effort=[9.0])
    values = TopicMap(groups=()).inputs["winch/joint_states"].decode(message)
    assert values["motor_speed"] == 2.0
    assert math.isnan(values["motor_torque"])
    assert math.isnan(values["shaft_angle"])


@pytest.mark.parametrize("topic", ["winch/joint_states", "winch/reference", "winch/active/displacement"])
def test_a_joint_that_a_message_names_twice_is_not_guessed(topic):
    """The first entry was obeyed: of two speeds of opposite signs one would turn the torque against the motion."""
    source = TopicMap(groups=("active",), max_displacement=3.4e-5).inputs[topic]
    joint = source.joints[0]
    values = {"position": [0.3, 0.9, 0.1], "velocity": [5.0, -5.0, 1.0], "effort": [1.0, 2.0, 3.0]}
    message = SimpleNamespace(name=[joint, joint, "other"], **values)
    assert source.decode(message) == {}
    assert source.illegible(message).startswith(f"joint '{joint}' stands in it twice")
    message.name = ["other", joint, "another"]
    assert set(source.decode(message)) == set(source.channels)
    message.name = ["other", "a", "b"]
    assert source.illegible(message) == f"without the joint '{joint}' that it should show"


def test_plain_floats_take_the_place_of_a_message():
    topics = TopicMap(groups=(), float64_channels=("motor_speed",), speed_joint="winch_drum", gear_ratio=250.0)
    speed = topics.inputs["winch/joint_states"]
    assert speed.type_name == FLOAT64
    assert speed.decode(SimpleNamespace(data=2.0)) == {"motor_speed": 500.0}


@pytest.mark.parametrize("time", [0.0, 0.02, 17.123456789, 0.9999999999, 1_763_000_000.25])
def test_times_keep_their_nanoseconds(time):
    seconds, nanoseconds = split_time(time)
    assert 0 <= nanoseconds < 10**9
    assert seconds + nanoseconds * 1e-9 == pytest.approx(time, abs=1e-9)


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ({"pressure_reference": "sealed"}, "sealed"),
        ({"displacement_unit": "percent"}, "percent"),
        ({"speed_joint": "boom"}, "boom"),
        ({"float64_channels": ("active.pressure_c",)}, "pressure_c"),
    ],
)
def test_other_conventions_are_refused(settings, said):
    with pytest.raises(InputError, match=said):
        TopicMap(**settings)


def test_a_group_that_is_named_twice_is_refused():
    with pytest.raises(InputError, match="'active' is named twice in groups: active, active"):
        crane_topics(load_crane("crane_150t"), ("active", "active"))


# -- numbers by hand
def joints(**values):
    base = {"position": [], "velocity": [], "effort": []}
    return SimpleNamespace(**base | {"name": list(values)} | {key: list(each) for key, each in zip(
        ("position", "velocity", "effort"), zip(*values.values(), strict=True), strict=True)})  # fmt: skip


BY_DRUM = {"speed_joint": "winch_drum", "gear_ratio": 50.0}


@pytest.mark.parametrize(
    ("conventions", "names", "reference"),
    [
        ({"gear_ratio": 50.0}, {"winch_motor": 3.0}, 3.0), ({"gear_ratio": 50.0}, {"winch_drum": 3.0}, 150.0),
        (BY_DRUM, {"winch_motor": 3.0}, 3.0), (BY_DRUM, {"winch_drum": 3.0, "winch_motor": 4.0}, 4.0),
        (BY_DRUM, {"boom": 3.0}, None),
    ],
)  # fmt: skip
def test_a_command_is_one_of_the_motor_whichever_joint_it_names(conventions, names, reference):
    message = joints(**{name: (0.0, value, 0.0) for name, value in names.items()})
    read = TopicMap(groups=(), **conventions).inputs["winch/reference"].decode(message)
    assert read.get("speed_reference") == reference


def test_a_drum_that_turns_slower_pulls_harder_by_the_gear():
    message = joints(winch_drum=(2.0, 3.0, 1000.0))
    read = TopicMap(groups=(), **BY_DRUM).inputs["winch/joint_states"].decode(message)
    assert read == {"motor_speed": 150.0, "shaft_angle": 100.0, "motor_torque": 20.0}


@pytest.mark.parametrize(
    ("conventions", "channel", "sent", "read"),
    [
        ({"pressure_reference": "absolute"}, "aft.pressure_a", 1e7, 1e7 - 101325.0),
        ({"pressure_reference": "absolute"}, "aft.pressure_b", 1e7, 1e7 - 101325.0),
        ({}, "aft.pressure_a", 1e7, 1e7),
        ({"max_displacement": 4e-5}, "aft.displacement", 0.5, 2e-5),
        ({"displacement_unit": "m3_per_rad", "max_displacement": 4e-5}, "aft.displacement", 2e-5, 2e-5),
        ({}, "oil_temperature", 41.0, 41.0),
        ({"gear_ratio": 50.0}, "motor_speed", 3.0, 3.0),
        (BY_DRUM, "motor_speed", 3.0, 150.0),
        (BY_DRUM, "speed_reference", 3.0, 3.0),
        (BY_DRUM, "hook_load", 3.0, 3.0),
    ],
)
def test_a_plain_number_means_what_its_message_would(conventions, channel, sent, read):
    topics = TopicMap(groups=("fore", "aft"), float64_channels=(channel,), **conventions)
    (source,) = [each for each in topics.inputs.values() if channel in each.channels]
    assert (source.type_name, source.stamped, source.channels) == (FLOAT64, False, (channel,))
    assert source.decode(SimpleNamespace(data=sent)) == {channel: pytest.approx(read)}


def test_each_group_has_a_joint_of_its_own():
    topics = TopicMap(groups=("fore", "aft"), max_displacement=4e-5)
    assert [topics.swash_of(group) for group in topics.groups] == ["fore_swash", "aft_swash"]
    message = joints(fore_swash=(0.25, 0.0, 0.0), aft_swash=(0.75, 0.0, 0.0))
    assert topics.inputs["winch/aft/displacement"].decode(message) == {"aft.displacement": pytest.approx(3e-5)}
    assert TopicMap(swash_joint="swash").swash_of("aft") == "swash"


def test_a_group_that_the_crane_has_not_has_no_topics():
    with pytest.raises(InputError, match="has no motor group 'port'"):
        crane_topics(load_crane("crane_150t"), ("port",))
    assert crane_topics(load_crane("emps"), ("port",)).groups == ()
