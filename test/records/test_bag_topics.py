"""Which topics of a recording are the winch's, told from their names, types and numbers alone: no bag is written."""

import re
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.physics.errors import InputError
from winch_friction.records.bag_file import Bag, _clock_offset, _displacement_unit, _plain_channels
from winch_friction.records.bag_joints import joints_on, no_speed, told_joint
from winch_friction.records.bag_storage import lost_of, readable, storage_of
from winch_friction.records.bag_topics import groups_of, matched, speed_topic
from winch_friction.records.bag_write import MESSAGES, BagWriter
from winch_friction.records.topics import FLOAT64, JOINT_STATE, TopicMap, joint_state, stamp_header

PATH = "rec"
SPEED = "winch/joint_states"


def motion(stamp=0.0, names=("winch_motor",), position=0.5):
    """A JointState in its bytes."""
    values = {key: MESSAGES.doubles([position] * len(names)) for key in ("position", "velocity", "effort")}
    header = stamp_header(stamp, MESSAGES)
    return MESSAGES.make(JOINT_STATE, header=header, name=list(names), **values)


class Reader:
    """Of rosbags' reader what is asked here: connections, and messages as (topic, receipt in s, message)."""

    def __init__(self, *messages, lost=0):
        self.sent = messages
        kinds = {topic: message.__msgtype__ for topic, _, message in messages}
        count = {topic: sum(topic == each[0] for each in messages) + lost for topic in kinds}
        self.connections = [SimpleNamespace(topic=t, msgtype=kind, msgcount=count[t]) for t, kind in kinds.items()]

    def messages(self, connections):
        by_topic = {each.topic: each for each in connections}
        for topic, receipt, message in self.sent:
            if topic in by_topic:
                raw = bytes(MESSAGES.store.serialize_cdr(message, message.__msgtype__))
                yield by_topic[topic], round(receipt * 1e9), raw


def bag(*messages, **conventions):
    topics = TopicMap(groups=(), **conventions)
    actual = {name: f"/{name}" for name in topics.inputs}
    return Bag("rec", topics, actual, [], Reader(*messages), MESSAGES.store)


# -- names
@pytest.mark.parametrize(
    ("namespace", "names", "found"),
    [
        ("", ["/winch/joint_states"], "/winch/joint_states"),
        ("", ["/aft/winch/joint_states", "/aft/winch/reference"], "/aft/winch/joint_states"),
        ("fore", ["/aft/winch/joint_states", "/fore/winch/joint_states"], "/fore/winch/joint_states"),
        ("/fore/", ["/fore/aft/winch/joint_states", "/ship/fore/winch/joint_states"], "/ship/fore/winch/joint_states"),
        ("/", ["/fore/winch/joint_states", "/winch/joint_states"], "/winch/joint_states"),
        ("fore", ["/ship/fore/winch/joint_states", "/fore/winch/joint_states"], "/fore/winch/joint_states"),
    ],
)
def test_the_speed_is_on_the_topic_of_its_namespace(namespace, names, found):
    assert speed_topic(PATH, names, namespace) == found


@pytest.mark.parametrize(
    ("names", "said"),
    [(["/a/winch/joint_states", "/b/winch/joint_states"], "several winches: /a.*; choose one with --namespace: /a, /b"),
     (["/arm/joint_states"], "no message on a topic '.../winch/joint_states'; the bag has /arm/joint_states; remap")],
)  # fmt: skip
def test_a_speed_that_nobody_can_tell_is_asked_for(names, said):
    with pytest.raises(InputError, match=said):
        speed_topic(PATH, names, "")


def named(*topics, **counts):
    return SimpleNamespace(connections=[SimpleNamespace(topic=t, msgcount=counts.get(t.rpartition("/")[2], 1))
                                        for t in topics])  # fmt: skip


def test_topics_below_the_speeds_namespace_are_the_winchs_and_a_remapped_one_is_where_it_is_said():
    reader = named("/aft/winch/joint_states", "/aft/winch/hook_load", "/fore/winch/wire_out", "/load_cell",
                   "/aft/winch/silent", silent=0)  # fmt: skip
    found = matched(PATH, reader, "", {"winch/rope_force": "/load_cell"})
    assert found == {
        SPEED: "/aft/winch/joint_states", "winch/hook_load": "/aft/winch/hook_load", "winch/rope_force": "/load_cell",
    }  # fmt: skip
    # a speed of another name has no namespace: nothing else is guessed
    assert matched(PATH, reader, "", {SPEED: "/load_cell"}) == {SPEED: "/load_cell"}
    with pytest.raises(InputError, match="topic '/moon' has no message; the bag has /aft/winch/hook_load, /aft"):
        matched(PATH, reader, "", {SPEED: "/moon"})


@pytest.mark.parametrize(
    ("remap", "said"),
    [
        (
            {"a": "b"},
            ["'a' is no topic of the winch's: .*winch/joint_states.*winch/GROUP/pressure_a", "'b' has no mes"],
        ),
        ({"winch/joint_state": "/load_cell"}, ["'winch/joint_state' is no topic of the winch's"]),
        ({"winch/hook_load": "/moon"}, ["topic '/moon' has no message; the bag has /load_cell, /winch/joint_states"]),
        ({"winch/hook_load": ""}, ["topic '' has no message"]),
        ({"winch/main/elbow": "/load_cell"}, ["'winch/main/elbow' is no topic"]),
        ({"winch/a/b/pressure_a": "/load_cell"}, ["'winch/a/b/pressure_a' is no topic"]),
        ({"winch/a/pressure_a/b": "/load_cell"}, ["'winch/a/pressure_a/b' is no topic"]),
        ({"winch/wire_out": "/x", SPEED: "/y"}, ["topic '/x' has no message", "topic '/y' has no message"]),
    ],
)
def test_a_topic_is_remapped_of_the_winchs_to_one_of_the_bag(remap, said):
    """--remap a=b ended in a KeyError, and a name with a slip was not heeded and not said."""
    reader = named("/winch/joint_states", "/load_cell")
    with pytest.raises(InputError) as caught:
        matched(PATH, reader, "", remap)
    assert len(caught.value.problems) == len(said)
    for problem, words in zip(caught.value.problems, said, strict=True):
        assert re.search(f"^{PATH}: .*{words}", problem)
    assert matched(PATH, reader, "", {"winch/aft/pressure_b": "/load_cell"})["winch/aft/pressure_b"] == "/load_cell"


def test_a_motor_group_is_told_by_either_of_its_pressures_once_in_order():
    found = ("winch/main/pressure_b", "winch/aft/displacement", "winch/aft/pressure_a", "winch/main/pressure_a",
             "winch/pressure_a", "winch/hook_load", "winch/arm/elbow")  # fmt: skip
    assert groups_of(dict.fromkeys(found, "/x")) == ("main", "aft")


def test_what_came_plain_is_read_plain_but_a_speed_must_be_asked_for():
    plain = {SPEED, "winch/main/pressure_a", "winch/main/displacement", "winch/oil_temperature", "winch/hook_load"}
    told = _plain_channels(("main",), plain)
    assert told == ("main.pressure_a", "main.displacement", "oil_temperature")


def test_topics_of_another_winch_are_not_ours_by_their_end():
    topics = ("/aft/winch/joint_states", "/aft/compensator/friction_torque", "/friction_torque",
              "/fore/winch/joint_states", "/fore/compensator/friction_torque", "/aft/estimator/status")  # fmt: skip
    own = Bag("rec", TopicMap(groups=()), {SPEED: "/aft/winch/joint_states"}, [], named(*topics), None)
    assert own.topics_ending("/friction_torque") == ["/aft/compensator/friction_torque", "/friction_torque"]


# -- numbers
@pytest.mark.parametrize(
    ("values", "unit"),
    [
        ([3.4e-5, 2e-5], "m3_per_rad"), ([0.0, 0.9], "fraction"), ([0.0, -0.2], "fraction"), ([9e-4], "m3_per_rad"),
        ([1.1e-3], "fraction"), ([], "m3_per_rad"), ([0.0] * 20 + [0.5], "fraction"),
        ([0.0] * 40 + [0.5], "m3_per_rad"),  # of a bag that begins at rest nobody reads all
    ],
)  # fmt: skip
@pytest.mark.parametrize("plain", [False, True])
def test_a_displacement_beyond_any_motors_is_a_fraction(values, unit, plain):
    make = (lambda v: MESSAGES.make(FLOAT64, data=v)) if plain else (lambda v: motion(position=v))
    reader = Reader(*(("/d", 0.1 * k, make(value)) for k, value in enumerate(values)))
    assert _displacement_unit(reader, MESSAGES.store, ["/d"]) == unit


@pytest.mark.parametrize(
    ("messages", "offset", "timed"),
    [
        ([(100.0, 10.0)], 90.0, True),
        ([(65.0, 10.0)], 0.0, True),  # a minute at most is a slow way to the recorder
        ([(10.0, 100.0)], -90.0, True),
        ([(100.0, 0.0), (101.0, 11.0)], 90.0, True),
        ([(100.0, 0.0), (101.0, 0.0)], 100.0, False),
        ([(3.0, 0.0)], 0.0, False),
    ],
)
def test_the_recorders_clock_is_another_by_more_than_a_minute(messages, offset, timed):
    sent = [(f"/{SPEED}", receipt, motion(stamp)) for receipt, stamp in messages]
    assert _clock_offset(bag(*sent)) == (pytest.approx(offset), timed)


def test_a_speed_without_a_stamp_tells_no_time():
    plain = bag((f"/{SPEED}", 1e9, MESSAGES.make(FLOAT64, data=1.0)), float64_channels=("motor_speed",))
    assert _clock_offset(plain) == (0.0, False)


def test_a_message_is_dated_by_its_stamp_else_by_its_receipt_on_the_clock_of_the_stamps():
    load = MESSAGES.make(FLOAT64, data=5e4)
    own = bag((f"/{SPEED}", 1000.5, motion(10.0)), ("/winch/hook_load", 1000.75, load), ("/note", 1001.0, load))
    own._offset, own._timed = 990.0, True
    first, second, other = own.events("/note")
    assert (first.stamp, first.receipt) == pytest.approx((10.0, 10.5))
    assert (second.stamp, second.receipt) == pytest.approx((10.75, 10.75))
    assert second.source.channels == ("hook_load",)
    assert (other.topic, other.receipt) == ("/note", pytest.approx(11.0))


def test_a_stamp_of_nothing_is_left_out_once_a_time_is_known_and_said():
    sent = [(f"/{SPEED}", time, motion(stamp)) for time, stamp in ((0.5, 0.0), (2.0, 0.0), (3.0, 3.0), (4.0, 0.0))]
    own = bag(*sent)
    own._timed = True
    assert [each.stamp for each in own.inputs()] == [0.0, 3.0]
    (said,) = own.warnings
    assert said.endswith("knows no time yet: topic '/winch/joint_states': 2 of 4 messages are left out")


# -- what is lost
def test_what_a_file_has_lost_is_said_once_with_what_came():
    reader, said = Reader(*((f"/{SPEED}", 0.1 * k, motion()) for k in range(3)), lost=4), ["other"]
    assert len(list(readable(reader, reader.connections, "rec", said))) == 3
    assert said[1:] == ["rec: the file is damaged: of 7 messages 3 can be read, the rest is lost; copy it anew"]
    list(readable(reader, reader.connections, "rec", said))
    assert lost_of(said) == said[1:]
    assert len(said) == 2


def test_a_message_that_is_none_is_counted_on_its_topic():
    own = bag((f"/{SPEED}", 1.0, motion(1.0)), (f"/{SPEED}", 2.0, motion(2.0)))
    whole = own._reader.messages
    own._reader.messages = lambda chosen: ((c, t, raw if k else raw[:9]) for k, (c, t, raw) in enumerate(whole(chosen)))
    assert [each.stamp for each in own.inputs()] == [2.0]
    assert own.warnings == ["rec: topic '/winch/joint_states': 1 messages cannot be read"]
    assert own._broken == {}


# -- joints
def test_joints_are_all_that_stand_in_the_first_messages():
    sent = [("/j", 0.1 * k, motion(names=names)) for k, names in enumerate((("a", "b"), ("c",), ("a",)))]
    late = [("/j", 9.0, motion(names=("late",)))]
    reader = Reader(*sent, *(("/j", 1.0, motion(names=("c",))) for _ in range(17)), *late)
    assert joints_on(reader, MESSAGES.store, "/j") == ("a", "b", "c")
    assert joints_on(reader, MESSAGES.store, "/k") == ()
    assert joints_on(Reader(("/j", 0.0, MESSAGES.make(FLOAT64, data=1.0))), MESSAGES.store, "/j") == ()


@pytest.mark.parametrize(
    ("names", "conventions", "told"),
    [
        (("winch_drum",), {}, "winch_drum"), (("winch_drum", "winch_motor"), {}, None), (("boom",), {}, None),
        (("winch_drum",), {"speed_joint": "winch_motor"}, None), (("trommel",), {"drum_joint": "trommel"}, "trommel"),
        (("winch_drum", "M1"), {"motor_joint": "M1"}, None),
    ],
)  # fmt: skip
def test_the_drums_joint_is_taken_where_nobody_says_and_the_motors_is_not_there(names, conventions, told):
    assert told_joint(names, conventions).get("speed_joint") == told


def test_a_speed_that_is_not_there_is_told_with_the_joints_that_are():
    assert no_speed("x", "a", ("a", "b")) == no_speed("x", "a", ()) == "x has no finite speed of joint 'a'"
    assert no_speed("x", "a", ("b", "c")).startswith("x has no finite speed of joint 'a'; found b, c: name the winch's")


# -- files
@pytest.mark.parametrize(("name", "storage", "kind"), [
    ("a.mcap", "", "mcap"), ("a.db3", "", "sqlite3"), ("a", "", "mcap"), ("a", "sqlite3", "sqlite3"),
    ("a.mcap", "mcap", "mcap"),
])  # fmt: skip
def test_a_recordings_ending_tells_its_storage_and_a_folder_is_mcap(tmp_path, name, storage, kind):
    assert BagWriter(tmp_path / name, storage)._storage == kind


@pytest.mark.parametrize(("name", "storage"), [("a.mcap", "sqlite3"), ("a.db3", "mcap"), ("a", "rosbag1")])
def test_a_storage_that_does_not_fit_is_refused(tmp_path, name, storage):
    with pytest.raises(InputError, match=f"storage '{storage}' does not fit; use mcap or sqlite3"):
        BagWriter(tmp_path / name, storage)


def test_a_recording_without_metadata_is_its_only_file_whatever_its_endings_case(tmp_path):
    (tmp_path / "RUN.MCAP").write_bytes(b"")
    (tmp_path / "notes.txt").write_bytes(b"")
    assert storage_of(tmp_path).name == "RUN.MCAP"
    assert storage_of(tmp_path).suffix == ".mcap"
    assert storage_of(tmp_path / "RUN.MCAP").suffix == ".mcap"
    (tmp_path / "b.db3").write_bytes(b"")
    with pytest.raises(InputError, match="no metadata.yaml and 2 storage files"):
        storage_of(tmp_path)
    (tmp_path / "metadata.yaml").write_text("")
    assert storage_of(tmp_path) == tmp_path


@pytest.mark.parametrize(("time", "kept"), [(0.0, True), (2.0**31 - 1.0, True), (2.0**31, False), (-1e-9, False)])
def test_a_bag_holds_the_times_that_its_stamps_can_say(tmp_path, time, kept):
    writer, sent = BagWriter(tmp_path / "a"), []
    writer.write_raw = lambda *each: sent.append(each)
    message = joint_state(MESSAGES, stamp_header(0.0, MESSAGES), "winch_motor", velocity=1.0)
    if kept:
        writer.write("/t", message, time)
        assert sent[0][:2] == ("/t", JOINT_STATE)
        assert sent[0][3] == int(time) * 10**9
    else:
        with pytest.raises(InputError, match="the year 2038"):
            writer.write("/t", message, time)


def test_a_receipt_is_the_nearest_nanosecond(tmp_path):
    writer, sent = BagWriter(tmp_path / "a"), []
    writer.write_raw = lambda *each: sent.append(each)
    writer.write("/t", MESSAGES.make(FLOAT64, data=1.0), 0.29)  # 289 999 999.99999994 ns
    assert sent[0][3] == 290_000_000
    assert np.frombuffer(sent[0][2], np.float64, offset=4).tolist() == [1.0]


def test_a_recording_is_made_beside_its_place(tmp_path):
    """On the same disk: a move from another one would be a copy, of which a reader sees half."""
    with BagWriter(tmp_path / "new" / "log.mcap") as writer:
        (folder,) = (tmp_path / "new").iterdir()
        assert folder.name.startswith(".log.")
        writer.write_raw("/a", "std_msgs/msg/String", b"\x00\x01\x00\x00\x01\x00\x00\x00\x00", 5)
    assert [each.name for each in (tmp_path / "new").iterdir()] == ["log.mcap"]
