"""Messages of rclpy from plain values."""

from array import array
from collections.abc import Mapping, Sequence
from typing import Any

from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import FluidPressure, JointState, Temperature
from std_msgs.msg import Float64, Header, String

from winch_friction.records.topics import split_time

_TYPES = {
    "builtin_interfaces/msg/Time": Time,
    "diagnostic_msgs/msg/DiagnosticArray": DiagnosticArray,
    "sensor_msgs/msg/FluidPressure": FluidPressure,
    "sensor_msgs/msg/JointState": JointState,
    "sensor_msgs/msg/Temperature": Temperature,
    "std_msgs/msg/Float64": Float64,
    "std_msgs/msg/Header": Header,
    "std_msgs/msg/String": String,
}


class RosFactory:
    """Builds the messages of `records.topics` with rclpy's types."""

    def make(self, type_name: str, **fields: Any) -> Any:
        """A message of this type."""
        return _TYPES[type_name](**fields)

    def doubles(self, values: Sequence[float]) -> Any:
        """A `float64[]` field."""
        return array("d", values)


ROS = RosFactory()


def message_type(type_name: str) -> Any:
    """The class of an input's message type."""
    return _TYPES[type_name]


def ros_time(time: float) -> Time:
    """A stamp from s."""
    seconds, nanoseconds = split_time(time)
    return Time(sec=seconds, nanosec=nanoseconds)


def clock_message(time: float) -> Clock:
    """What `/clock` says at `time` s."""
    return Clock(clock=ros_time(time))


def pressure_message(time: float, pressure: float, frame_id: str = "") -> FluidPressure:
    """A pressure difference in Pa at `time` s; the variance is not known."""
    header = Header(stamp=ros_time(time), frame_id=frame_id)
    return FluidPressure(header=header, fluid_pressure=float(pressure), variance=0.0)


def diagnostic_status(name: str, hardware: str, level: int, summary: str, values: Mapping[str, Any]) -> Any:
    """One status with plain numbers as values, so that plot tools can draw them."""
    pairs = [KeyValue(key=key, value=plain_value(value)) for key, value in values.items()]
    return DiagnosticStatus(name=name, hardware_id=hardware, level=bytes([level]), message=summary, values=pairs)


def diagnostic_array(stamp: Any, statuses: Sequence[Any]) -> DiagnosticArray:
    """What goes out on `/diagnostics`."""
    return DiagnosticArray(header=Header(stamp=stamp), status=list(statuses))


def plain_value(value: Any) -> str:
    """A number as digits, a truth value as 0 or 1, everything else as it prints."""
    if isinstance(value, bool):
        return str(int(value))
    return f"{value:.9g}" if isinstance(value, float) else str(value)
