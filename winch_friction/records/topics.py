"""The ROS interface in one place (DESIGN section 4): which topic carries which run columns, in which unit.

Pure Python, without rclpy: messages are read by their field names, so that those of rclpy and of `rosbags` both pass,
and they are built as nested mappings of plain fields. Nodes, bag reader and bag writer share this map.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from math import isfinite
from typing import Any

from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import NAN
from winch_friction.physics.winch.crane import Crane

JOINT_STATE = "sensor_msgs/msg/JointState"
FLUID_PRESSURE = "sensor_msgs/msg/FluidPressure"
TEMPERATURE = "sensor_msgs/msg/Temperature"
FLOAT64 = "std_msgs/msg/Float64"
STRING = "std_msgs/msg/String"

SPEED_TOPIC = "winch/joint_states"
REFERENCE_TOPIC = "winch/reference"
MODEL_TOPIC = "friction_model"
FRICTION_TOPIC = "friction_torque"  # of the compensator: ~/friction_torque
FEEDFORWARD_TOPIC = "pressure_feedforward"  # of the compensator: ~/pressure_feedforward

ATMOSPHERE = 101325.0  # Pa
PRESSURE_REFERENCES = ("absolute", "gauge")
DISPLACEMENT_UNITS = ("fraction", "m^3/rad")
JOINTS = ("winch_motor", "winch_drum")
# scalar column -> topic, each a std_msgs/Float64 in SI
_SCALAR_TOPICS = {name: f"winch/{name}" for name in ("hook_load", "heave_velocity", "wire_layer", "wire_out")}


@dataclass(frozen=True)
class Reading:
    """One run column in one field of a message: value in SI = scale * field + offset."""

    column: str
    field: str
    scale: float = 1.0
    offset: float = 0.0

    def to_si(self, value: float) -> float:
        """The column's value from the message's."""
        return value * self.scale + self.offset

    def from_si(self, value: float) -> float:
        """The message's value from the column's."""
        return (value - self.offset) / self.scale


@dataclass(frozen=True)
class Topic:
    """One topic: its ROS type, the joint to pick in a JointState, and the columns it carries."""

    name: str
    message_type: str
    readings: tuple[Reading, ...]
    joint: str = ""

    @property
    def columns(self) -> tuple[str, ...]:
        """Run columns of this topic."""
        return tuple(reading.column for reading in self.readings)

    def values(self, message: Any) -> list[tuple[str, float]]:
        """Column and SI value of every field; NaN for a joint or an array entry that is not there."""
        if self.message_type != JOINT_STATE:
            return [(r.column, r.to_si(float(getattr(message, r.field)))) for r in self.readings]
        names = list(message.name)
        index = names.index(self.joint) if self.joint in names else -1
        return [(r.column, r.to_si(_entry(getattr(message, r.field), index))) for r in self.readings]

    def content(self, time: float, values: Mapping[str, float]) -> dict[str, Any]:
        """The message's fields as nested mappings, for a time in s and SI values by column."""
        return _CONTENTS[self.message_type](self, time, values)


@dataclass(frozen=True)
class TopicMap:
    """The input topics of one winch.

    Parameters: `groups` of motors; `joint` is `winch_motor` or `winch_drum` (then converted by `gear_ratio`);
    `electric`: the motor torque is its effort; `pressure_reference` of FluidPressure messages (inside, pressures
    are gauge); `displacement_unit`: `fraction` of `max_displacement` or `m^3/rad`; `plain` names topics that carry a
    bare std_msgs/Float64 instead (stamped on receipt); `remap` renames topics. Raises `InputError` for others.
    """

    groups: tuple[str, ...] = ()
    joint: str = "winch_motor"
    gear_ratio: float = 1.0
    electric: bool = False
    pressure_reference: str = "absolute"
    displacement_unit: str = "m^3/rad"
    max_displacement: float = 0.0
    plain: tuple[str, ...] = ()
    remap: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        _one_of("pressure_reference", self.pressure_reference, PRESSURE_REFERENCES)
        _one_of("displacement_unit", self.displacement_unit, DISPLACEMENT_UNITS)
        if self.displacement_unit == "fraction" and not self.max_displacement > 0.0 and self.groups:
            raise InputError("displacement_unit 'fraction' needs the crane's max_displacement; give a crane file")
        for name in (*self.plain, *self.remap):
            _one_of("topic", name, [topic.name for topic in self._declared()])

    @classmethod
    def for_crane(cls, crane: Crane, groups: Sequence[str] | None = None, **settings: Any) -> "TopicMap":
        """The map of a crane; `groups` defaults to all of the crane's."""
        names = tuple(crane.groups if groups is None else groups)
        own = {"gear_ratio": crane.gear_ratio, "electric": crane.electric, "max_displacement": crane.max_displacement}
        return cls(groups=names, **{**own, **settings})

    def topics(self) -> tuple[Topic, ...]:
        """Every input topic; the speed, which drives the hold, comes last."""
        return tuple(self._plain(topic) if topic.name in self.plain else topic for topic in self._declared())

    def actual_name(self, topic: Topic) -> str:
        """The topic's name after remapping."""
        return self.remap.get(topic.name, topic.name)

    def _declared(self) -> list[Topic]:
        grouped = [topic for group in self.groups for topic in self._group_topics(group)]
        scalars = [Topic(name, FLOAT64, (Reading(column, "data"),)) for column, name in _SCALAR_TOPICS.items()]
        oil = Topic("winch/oil_temperature", TEMPERATURE, (Reading("oil_temperature", "temperature"),))
        return [*grouped, *scalars, oil, self._reference(), self._speed()]

    def _group_topics(self, group: str) -> list[Topic]:
        offset = -ATMOSPHERE if self.pressure_reference == "absolute" else 0.0
        pressures = [
            Topic(f"winch/{group}/{side}", FLUID_PRESSURE, (Reading(f"{group}.{side}", "fluid_pressure", 1.0, offset),))
            for side in ("pressure_a", "pressure_b")
        ]
        scale = self.max_displacement if self.displacement_unit == "fraction" else 1.0
        swash = Reading(f"{group}.displacement", "position", scale)
        return [*pressures, Topic(f"winch/{group}/displacement", JOINT_STATE, (swash,), f"{group}_swash")]

    def _gear(self) -> float:
        return self.gear_ratio if self.joint == "winch_drum" else 1.0

    def _reference(self) -> Topic:
        reading = Reading("speed_reference", "velocity", self._gear())
        return Topic(REFERENCE_TOPIC, JOINT_STATE, (reading,), self.joint)

    def _speed(self) -> Topic:
        gear = self._gear()
        readings = [Reading("motor_speed", "velocity", gear), Reading("shaft_angle", "position", gear)]
        if self.electric:
            readings.append(Reading("motor_torque", "effort", 1.0 / gear))
        return Topic(SPEED_TOPIC, JOINT_STATE, tuple(readings), self.joint)

    def _plain(self, topic: Topic) -> Topic:
        first = topic.readings[0]
        return Topic(topic.name, FLOAT64, (Reading(first.column, "data", first.scale, first.offset),))


def stamp_of(message: Any) -> float | None:
    """The header's stamp in s; None for a message without a header, to be stamped on receipt."""
    header = getattr(message, "header", None)
    return None if header is None else seconds(header.stamp.sec, header.stamp.nanosec)


def seconds(sec: int, nanosec: int) -> float:
    """ROS time in s; one rounding, the same for nodes and replay."""
    return (int(sec) * 1_000_000_000 + int(nanosec)) / 1_000_000_000


def nanoseconds(time: float) -> int:
    """Time in ns, rounded."""
    whole = int(time)  # apart, because a Unix time in ns does not fit a float
    return whole * 1_000_000_000 + round((time - whole) * 1e9)


def header(time: float) -> dict[str, Any]:
    """A std_msgs/Header as nested mappings."""
    sec, nanosec = divmod(nanoseconds(time), 1_000_000_000)
    return {"stamp": {"sec": sec, "nanosec": nanosec}, "frame_id": ""}


def joint_state(time: float, joint: str, position: float = NAN, velocity: float = NAN, effort: float = NAN) -> dict:
    """A JointState of one joint with all arrays as long as `name`; a plot tool hides shorter ones."""
    return {
        "header": header(time),
        "name": [joint],
        "position": [position],
        "velocity": [velocity],
        "effort": [effort],
    }


def _entry(array: Any, index: int) -> float:
    return float(array[index]) if 0 <= index < len(array) else NAN


def _joint_content(topic: Topic, time: float, values: Mapping[str, float]) -> dict[str, Any]:
    fields = {r.field: r.from_si(values.get(r.column, NAN)) for r in topic.readings}
    return joint_state(time, topic.joint, **fields)


def _pressure_content(topic: Topic, time: float, values: Mapping[str, float]) -> dict[str, Any]:
    reading = topic.readings[0]
    return {"header": header(time), "fluid_pressure": reading.from_si(values[reading.column]), "variance": 0.0}


def _temperature_content(topic: Topic, time: float, values: Mapping[str, float]) -> dict[str, Any]:
    reading = topic.readings[0]
    return {"header": header(time), "temperature": reading.from_si(values[reading.column]), "variance": 0.0}


def _float_content(topic: Topic, time: float, values: Mapping[str, float]) -> dict[str, Any]:
    reading = topic.readings[0]
    return {"data": reading.from_si(values[reading.column])}


_CONTENTS: dict[str, Callable[[Topic, float, Mapping[str, float]], dict[str, Any]]] = {
    JOINT_STATE: _joint_content,
    FLUID_PRESSURE: _pressure_content,
    TEMPERATURE: _temperature_content,
    FLOAT64: _float_content,
}


def carries(topic: Topic, values: Mapping[str, float]) -> bool:
    """Whether any of the topic's columns has a finite value."""
    return any(isfinite(values.get(column, NAN)) for column in topic.columns)


def _one_of(what: str, value: str, allowed: Sequence[str]) -> None:
    if value not in allowed:
        raise InputError(f"{what} '{value}' is not one of {', '.join(allowed)}")
