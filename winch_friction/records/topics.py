"""Which topic carries which channel (docs/interfaces.md): shared by the nodes and by bags: one conversion, one place.

Messages are read by their field names alone, so those of rclpy and those of rosbags are decoded by the same lines.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

from winch_friction.physics.channels import DRIVE_SCALARS, PLAIN_SCALARS
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import NAN, Sample
from winch_friction.physics.winch.crane import Crane

ATMOSPHERE = 101_325.0  # Pa, what an absolute pressure has more than a gauge pressure
JOINT_STATE = "sensor_msgs/msg/JointState"
FLUID_PRESSURE = "sensor_msgs/msg/FluidPressure"
TEMPERATURE = "sensor_msgs/msg/Temperature"
FLOAT64 = "std_msgs/msg/Float64"
PRESSURE_REFERENCES = ("gauge", "absolute")
DISPLACEMENT_UNITS = ("fraction", "m3_per_rad")
Readings = dict[str, float]  # channel -> value, SI


@dataclass(frozen=True)
class Input:
    """One input topic: its message type, its channels and how a message becomes readings."""

    topic: str
    type_name: str
    channels: tuple[str, ...]
    decode: Callable[[Any], Readings]
    joints: tuple[str, ...] = ()  # of which a message must name one
    stamped: bool = field(init=False, compare=False)  # whether its messages say when they were measured

    def __post_init__(self) -> None:
        object.__setattr__(self, "stamped", self.type_name != FLOAT64)

    def illegible(self, message: Any) -> str:
        """Why a message of joints shows nothing, in a few words."""
        if twice := [joint for joint in self.joints if message.name.count(joint) > 1]:
            return f"joint '{twice[0]}' stands in it twice; nobody knows which of the two is meant"
        return f"without the joint '{self.joints[0]}' that it should show" if self.joints else ""


class MessageFactory(Protocol):
    """Builds messages of one library from the same fields."""

    def make(self, type_name: str, **fields: Any) -> Any:
        """A message (or part of one) of a type such as `std_msgs/msg/Header`."""

    def doubles(self, values: Sequence[float]) -> Any:
        """A `float64[]` field."""


@dataclass(frozen=True)
class TopicMap:
    """The inputs of one winch as topics.

    `pressure_reference`: 'gauge' or 'absolute', what the transducers' messages mean; `displacement_unit`: 'fraction' of
    `max_displacement` (m^3/rad) or 'm3_per_rad'; `speed_joint` is `motor_joint` or `drum_joint` (times `gear_ratio`);
    `swash_joint` names the joint of a group's displacement;
    `float64_channels` come from a simple bridge as std_msgs/Float64; `drive_scalars` are the channels,
    besides the motor torque, that the crane's drive is known by. Raises `InputError` for unknown choices.
    """

    groups: tuple[str, ...] = ("active", "passive")
    gear_ratio: float = 1.0
    max_displacement: float = 0.0
    pressure_reference: str = "gauge"
    displacement_unit: str = "fraction"
    motor_joint: str = "winch_motor"
    drum_joint: str = "winch_drum"
    speed_joint: str = "winch_motor"
    swash_joint: str = "{group}_swash"
    float64_channels: tuple[str, ...] = ()
    prefix: str = "winch"
    drive_scalars: tuple[str, ...] = DRIVE_SCALARS
    inputs: Mapping[str, Input] = field(init=False, compare=False, repr=False)
    speed_topic: str = field(init=False, compare=False, repr=False)  # the topic that drives the sampling

    def __post_init__(self) -> None:
        object.__setattr__(self, "speed_topic", f"{self.prefix}/joint_states")
        _one_of("pressure_reference", self.pressure_reference, PRESSURE_REFERENCES)
        _one_of("displacement_unit", self.displacement_unit, DISPLACEMENT_UNITS)
        _one_of("speed_joint", self.speed_joint, (self.motor_joint, self.drum_joint))
        inputs = [self._motion(), self._reference(), *self._group_inputs(), self._temperature(), *self._scalars()]
        known = [channel for each in inputs for channel in each.channels]
        for channel in self.float64_channels:
            _one_of("float64_channels", channel, known)
        plain = [self._plain(each) for each in inputs]
        object.__setattr__(self, "inputs", {each.topic: each for each in plain})

    def swash_of(self, group: str) -> str:
        """Name of the joint that carries a group's displacement."""
        return self.swash_joint.replace("{group}", group)

    def _motion(self) -> Input:
        ratio = self.gear_ratio if self.speed_joint == self.drum_joint else 1.0

        def decode(message: Any) -> Readings:
            if (index := _joint_index(message, self.speed_joint)) < 0:
                return {}
            speed = _entry(message.velocity, index) * ratio
            return {
                "motor_speed": speed,
                "shaft_angle": _entry(message.position, index) * ratio,
                "motor_torque": _entry(message.effort, index) / ratio,
            }

        channels = "motor_speed", "shaft_angle", "motor_torque"
        return Input(self.speed_topic, JOINT_STATE, channels, decode, (self.speed_joint,))

    def _reference(self) -> Input:
        names = {self.motor_joint: 1.0, self.drum_joint: self.gear_ratio}

        def decode(message: Any) -> Readings:
            for joint, ratio in names.items():
                if (index := _joint_index(message, joint)) >= 0:
                    return {"speed_reference": _entry(message.velocity, index) * ratio}
            return {}

        return Input(f"{self.prefix}/reference", JOINT_STATE, ("speed_reference",), decode, tuple(names))

    def _group_inputs(self) -> list[Input]:
        return [each for group in self.groups for each in (*self._pressures(group), self._displacement(group))]

    def _pressures(self, group: str) -> list[Input]:
        offset = ATMOSPHERE if self.pressure_reference == "absolute" else 0.0

        def reader(channel: str) -> Callable[[Any], Readings]:
            return lambda message: {channel: message.fluid_pressure - offset}

        ports = ("pressure_a", "pressure_b")
        return [
            Input(f"{self.prefix}/{group}/{p}", FLUID_PRESSURE, (f"{group}.{p}",), reader(f"{group}.{p}"))
            for p in ports
        ]

    def _displacement(self, group: str) -> Input:
        channel, joint, factor = f"{group}.displacement", self.swash_of(group), self._displacement_factor

        def decode(message: Any) -> Readings:
            index = _joint_index(message, joint)
            return {channel: _entry(message.position, index) * factor} if index >= 0 else {}

        return Input(f"{self.prefix}/{group}/displacement", JOINT_STATE, (channel,), decode, (joint,))

    @property
    def _plain_scalars(self) -> tuple[str, ...]:
        """Channels that travel as plain Float64, without a stamp."""
        return PLAIN_SCALARS + self.drive_scalars

    @property
    def _displacement_factor(self) -> float:
        return self.max_displacement if self.displacement_unit == "fraction" else 1.0

    def _temperature(self) -> Input:
        return Input(
            f"{self.prefix}/oil_temperature",
            TEMPERATURE,
            ("oil_temperature",),
            lambda message: {"oil_temperature": message.temperature},
        )

    def _scalars(self) -> list[Input]:
        def reader(channel: str) -> Callable[[Any], Readings]:
            return lambda message: {channel: message.data}

        return [Input(f"{self.prefix}/{name}", FLOAT64, (name,), reader(name)) for name in self._plain_scalars]

    def _plain(self, given: Input) -> Input:
        channel = given.channels[0]
        if given.type_name == FLOAT64 or channel not in self.float64_channels:
            return given
        scale, offset = self._plain_conversion(channel)
        return Input(given.topic, FLOAT64, (channel,), lambda message: {channel: message.data * scale - offset})

    def _plain_conversion(self, channel: str) -> tuple[float, float]:
        if channel.endswith(".displacement"):
            return self._displacement_factor, 0.0
        if channel.rpartition(".")[2] in ("pressure_a", "pressure_b"):
            return 1.0, ATMOSPHERE if self.pressure_reference == "absolute" else 0.0
        return (self.gear_ratio if channel == "motor_speed" and self.speed_joint == self.drum_joint else 1.0), 0.0

    # -- the way out
    def encode(self, sample: Sample, factory: MessageFactory) -> list[tuple[str, Any]]:
        """The messages of one sample as (topic, message), the speed last, so that it closes the set; NaN stays out."""
        header = stamp_header(sample.time, factory)
        out = [
            (f"{self.prefix}/{name}", factory.make(FLOAT64, data=float(value)))
            for name in self._plain_scalars
            if (value := getattr(sample, name)) == value
        ]
        if sample.oil_temperature == sample.oil_temperature:
            fields = {"temperature": float(sample.oil_temperature), "variance": 0.0}
            out.append((f"{self.prefix}/oil_temperature", factory.make(TEMPERATURE, header=header, **fields)))
        for group in sample.groups:
            out.extend(self._encode_group(sample, group, header, factory))
        if sample.speed_reference == sample.speed_reference:
            joint = joint_state(factory, header, self.motor_joint, velocity=sample.speed_reference)
            out.append((f"{self.prefix}/reference", joint))
        out.append((self.speed_topic, self._encode_motion(sample, header, factory)))
        return out

    def _encode_group(self, sample: Sample, group: str, header: Any, factory: MessageFactory) -> list[tuple[str, Any]]:
        offset = ATMOSPHERE if self.pressure_reference == "absolute" else 0.0
        values, base = sample.groups[group], f"{self.prefix}/{group}"
        pressures = {"pressure_a": values.pressure_a, "pressure_b": values.pressure_b}
        out = [
            (
                f"{base}/{port}",
                factory.make(FLUID_PRESSURE, header=header, fluid_pressure=float(value + offset), variance=0.0),
            )
            for port, value in pressures.items()
            if value == value
        ]
        if values.displacement == values.displacement:
            setting = values.displacement / self._displacement_factor
            out.append((f"{base}/displacement", joint_state(factory, header, self.swash_of(group), position=setting)))
        return out

    def _encode_motion(self, sample: Sample, header: Any, factory: MessageFactory) -> Any:
        ratio = self.gear_ratio if self.speed_joint == self.drum_joint else 1.0
        return joint_state(
            factory,
            header,
            self.speed_joint,
            position=sample.shaft_angle / ratio,
            velocity=sample.motor_speed / ratio,
            effort=sample.motor_torque * ratio,
        )


def crane_topics(crane: Crane, groups: Sequence[str] = ("active", "passive"), **conventions: Any) -> TopicMap:
    """The topics of a crane; `conventions` are the other fields of `TopicMap`."""
    groups = tuple(groups) if crane.drive.hydraulic else ()
    for group in groups:
        crane.motor_count(group)
        if groups.count(group) > 1:
            raise InputError(f"motor group '{group}' is named twice in groups: {', '.join(groups)}")
    conventions.setdefault("drive_scalars", tuple(name for name in crane.drive.channels if name in DRIVE_SCALARS))
    return TopicMap(groups=groups, gear_ratio=crane.gear_ratio, max_displacement=crane.max_displacement, **conventions)


def joint_state(
    factory: MessageFactory,
    header: Any,
    joint: str,
    position: float = NAN,
    velocity: float = NAN,
    effort: float = NAN,
) -> Any:
    """A JointState of one joint with arrays as long as `name`: shorter ones are hidden by plot tools."""
    arrays = {"position": position, "velocity": velocity, "effort": effort}
    fields = {key: factory.doubles([float(value)]) for key, value in arrays.items()}
    return factory.make(JOINT_STATE, header=header, name=[joint], **fields)


def stamp_header(time: float, factory: MessageFactory, frame_id: str = "") -> Any:
    """A header whose stamp is `time` in s, to the nanosecond."""
    seconds, nanoseconds = split_time(time)
    stamp = factory.make("builtin_interfaces/msg/Time", sec=seconds, nanosec=nanoseconds)
    return factory.make("std_msgs/msg/Header", stamp=stamp, frame_id=frame_id)


def split_time(time: float) -> tuple[int, int]:
    """Whole seconds and nanoseconds of a time in s."""
    seconds = math.floor(time)
    nanoseconds = round((time - seconds) * 1e9)
    return (seconds + 1, 0) if nanoseconds == 1_000_000_000 else (seconds, nanoseconds)


def whole_nanoseconds(time: float) -> float:
    """A time in s as it comes back from a stamp."""
    seconds, nanoseconds = split_time(time)
    return float(seconds + nanoseconds * 1e-9)


def stamp_time(message: Any) -> float:
    """The header's stamp in s."""
    stamp = message.header.stamp
    return float(stamp.sec + stamp.nanosec * 1e-9)


def _joint_index(message: Any, joint: str) -> int:
    """Position of a joint by name; -1 without it, and where it is named more than once: either entry may be meant."""
    names = message.name
    return names.index(joint) if names.count(joint) == 1 else -1


def _entry(values: Any, index: int) -> float:
    """An entry of an array that may be shorter than `name`; NaN when it is not there."""
    return float(values[index]) if 0 <= index < len(values) else NAN


def _one_of(name: str, value: str, known: Sequence[str]) -> None:
    if value not in known:
        raise InputError(f"{name} must be one of {', '.join(known)}; found '{value}'")
