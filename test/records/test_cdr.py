"""The fast readers against rosbags' general one, on messages of every shape, whole and broken."""

import numpy as np
import pytest
from rosbags.typesys import Stores, get_typestore

from winch_friction.records.bag_write import MESSAGES
from winch_friction.records.cdr import READERS
from winch_friction.records.topics import FLOAT64, FLUID_PRESSURE, JOINT_STATE, TEMPERATURE, joint_state, stamp_header

STORE = get_typestore(Stores.ROS2_JAZZY)
FRAMES = ("", "a", "abc", "abcd", "frame_of_the_drum")


def messages():
    yield FLOAT64, MESSAGES.make(FLOAT64, data=-1.25e-3)
    for frame in FRAMES:
        header = stamp_header(1.7e9 + 0.123456789, MESSAGES, frame)
        yield FLUID_PRESSURE, MESSAGES.make(FLUID_PRESSURE, header=header, fluid_pressure=2.5e7, variance=1.0)
        yield TEMPERATURE, MESSAGES.make(TEMPERATURE, header=header, temperature=41.5, variance=0.0)
        yield JOINT_STATE, joint_state(MESSAGES, header, "winch_motor", 1.0, -2.0, float("nan"))
        for names in ([], ["a"], ["ab", "winch_motor"], ["winch_motor", "x", "yz"]):
            for count in (0, len(names)):
                values = {key: MESSAGES.doubles([0.5 + k for k in range(count)]) for key in ("position", "effort")}
                velocity = MESSAGES.doubles([float(k) for k in range(len(names))])
                yield JOINT_STATE, MESSAGES.make(JOINT_STATE, header=header, name=names, velocity=velocity, **values)


@pytest.mark.parametrize(("kind", "message"), messages())
def test_reads_what_rosbags_reads(kind, message):
    raw = bytes(STORE.serialize_cdr(message, kind))
    expected, found = STORE.deserialize_cdr(raw, kind), READERS[kind](raw)
    if kind == FLOAT64:
        assert found.data == expected.data
        return
    stamp, own = expected.header.stamp, found.header.stamp
    assert (own.sec, own.nanosec, found.header.frame_id) == (stamp.sec, stamp.nanosec, expected.header.frame_id)
    for field in ("fluid_pressure", "temperature", "variance", "name"):
        if hasattr(expected, field):
            assert getattr(found, field) == getattr(expected, field)
    for field in ("position", "velocity", "effort"):
        if hasattr(expected, field):
            np.testing.assert_array_equal(np.array(getattr(found, field)), getattr(expected, field))


@pytest.mark.parametrize(("kind", "message"), list(messages())[:8])
def test_a_message_that_was_cut_or_lengthened_is_refused(kind, message):
    raw = bytes(STORE.serialize_cdr(message, kind))
    for broken in (raw[:-9], raw[: len(raw) // 2], raw[:5], raw + bytes(8)):
        with pytest.raises(Exception, match=r"."):
            READERS[kind](broken)


@pytest.mark.parametrize(("more", "whole"), [(0, True), (3, True), (4, False), (7, False)])
def test_three_bytes_at_most_stand_behind_a_message(more, whole):
    raw = bytes(STORE.serialize_cdr(MESSAGES.make(FLOAT64, data=7.0), FLOAT64)) + bytes(more)
    if whole:
        assert READERS[FLOAT64](raw).data == 7.0
    else:
        with pytest.raises(ValueError, match=f"{12 + more} bytes where the message has 12"):
            READERS[FLOAT64](raw)
