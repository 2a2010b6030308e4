"""The winch's own message types read straight from their bytes (CDR, little-endian), for speed.

A recording at 50 Hz holds thirteen small messages per sample of four types, whose layout is fixed. The objects made
here have the fields that `records.topics` reads; whatever else a recording holds goes through rosbags.
"""

from collections.abc import Callable
from struct import Struct
from typing import Any

from winch_friction.records.topics import FLOAT64, FLUID_PRESSURE, JOINT_STATE, TEMPERATURE

LITTLE_ENDIAN = b"\x00\x01"  # of the encapsulation, whose four bytes do not count for alignment
_START = 4
_COUNT, _DOUBLE, _TWO, _STAMP = Struct("<I"), Struct("<d"), Struct("<dd"), Struct("<iII")
_PADDING = 3  # bytes at most that a writer may leave behind the last field


class Plain:
    """A std_msgs/Float64."""

    __slots__ = ("data",)
    data: float


class Stamped:
    """A message that is its own header and stamp."""

    __slots__ = (
        "sec", "nanosec", "frame_id", "fluid_pressure", "temperature", "variance", "name", "position", "velocity",
        "effort",
    )  # fmt: skip

    sec: int
    nanosec: int
    frame_id: str
    fluid_pressure: float
    temperature: float
    variance: float
    name: list[str]
    position: tuple[float, ...]
    velocity: tuple[float, ...]
    effort: tuple[float, ...]

    @property
    def header(self) -> "Stamped":
        """Where `stamp` is."""
        return self

    @property
    def stamp(self) -> "Stamped":
        """Where `sec` and `nanosec` are."""
        return self


def float64(raw: bytes) -> Plain:
    """A std_msgs/Float64."""
    message = Plain()
    (message.data,) = _DOUBLE.unpack_from(raw, _START)
    _ended(raw, _START + 8)
    return message


def fluid_pressure(raw: bytes) -> Stamped:
    """A sensor_msgs/FluidPressure."""
    message, at = _stamped(raw)
    at = _aligned(at, 8)
    message.fluid_pressure, message.variance = _TWO.unpack_from(raw, at)
    _ended(raw, at + 16)
    return message


def temperature(raw: bytes) -> Stamped:
    """A sensor_msgs/Temperature."""
    message, at = _stamped(raw)
    at = _aligned(at, 8)
    message.temperature, message.variance = _TWO.unpack_from(raw, at)
    _ended(raw, at + 16)
    return message


def joint_state(raw: bytes) -> Stamped:
    """A sensor_msgs/JointState."""
    message, at = _stamped(raw)
    at = _aligned(at, 4)
    (count,) = _COUNT.unpack_from(raw, at)
    at += 4
    names = []
    for _ in range(count):
        name, at = _text(raw, _aligned(at, 4))
        names.append(name)
    message.name = names
    message.position, at = _doubles(raw, at)
    message.velocity, at = _doubles(raw, at)
    message.effort, at = _doubles(raw, at)
    _ended(raw, at)
    return message


READERS: dict[str, Callable[[bytes], Any]] = {
    FLOAT64: float64,
    FLUID_PRESSURE: fluid_pressure,
    TEMPERATURE: temperature,
    JOINT_STATE: joint_state,
}


def _stamped(raw: bytes) -> tuple[Stamped, int]:
    message = Stamped()
    message.sec, message.nanosec, length = _STAMP.unpack_from(raw, _START)
    at = _START + 12
    if at + length > len(raw):
        raise ValueError("the frame's name is longer than the message")
    message.frame_id = str(raw[at : at + length - 1], "utf-8") if length > 1 else ""
    return message, at + length


def _text(raw: bytes, at: int) -> tuple[str, int]:
    (length,) = _COUNT.unpack_from(raw, at)
    end = at + 4 + length
    if end > len(raw):
        raise ValueError("a name is longer than the message")
    return str(raw[at + 4 : end - 1], "utf-8"), end


def _doubles(raw: bytes, at: int) -> tuple[tuple[float, ...], int]:
    at = _aligned(at, 4)
    (count,) = _COUNT.unpack_from(raw, at)
    at += 4
    if not count:
        return (), at
    at = _aligned(at, 8)
    if at + 8 * count > len(raw):
        raise ValueError("an array is longer than the message")
    if count == 1:
        return _DOUBLE.unpack_from(raw, at), at + 8
    return Struct(f"<{count}d").unpack_from(raw, at), at + 8 * count


def _aligned(at: int, size: int) -> int:
    return at + (_START - at) % size


def _ended(raw: bytes, at: int) -> None:
    if not at <= len(raw) <= at + _PADDING:
        raise ValueError(f"{len(raw)} bytes where the message has {at}")
