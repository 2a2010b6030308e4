"""Recordings of ROS 2 whose topics are not the winch's own: every number of every message as a signal of a log.

A signal is named `topic:field`, of a message within it `topic:twist.angular.x`, of a JointState
`topic:velocity[joint]`; its unit is the message's. Times are the
header stamps where there are any, else the receipts; all are put on the densest signal's, held at their latest value.
"""

from collections import Counter, defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from winch_friction.importing.log import listed
from winch_friction.importing.one_clock import Signal
from winch_friction.importing.signal_logs import Found
from winch_friction.records.bag_file import open_reader
from winch_friction.records.bag_storage import readable

_UNITS = {
    "sensor_msgs/msg/JointState": {"position": "rad", "velocity": "rad/s", "effort": "N*m"},
    "sensor_msgs/msg/FluidPressure": {"fluid_pressure": "Pa"},
    "sensor_msgs/msg/Temperature": {"temperature": "degC"},
}
_WITHIN = {"angular": "rad/s", "linear": "m/s", "angular_velocity": "rad/s", "force": "N", "torque": "N*m"}
_MOTIONS = ("Twist", "Imu", "Wrench", "Odometry")  # types whose vectors have these units; those of an Accel have others
_DEEPEST = 4  # messages within messages: the twist of an Odometry is the third
_MOST_FIELDS = 64  # numbers of one message: an image or a point cloud is no signal
_CLOCKS_APART = 60.0  # s; stamps farther from the receipt are of another clock, or zero


def bag_signals(path: Path) -> Found:
    """A recording's signals, and what of it is lost; raises `InputError` for what is no bag or holds no message."""
    times: dict[str, list[float]] = defaultdict(list)
    values: dict[str, list[float]] = defaultdict(list)
    units: dict[str, str] = {}
    broken, said = Counter[str](), list[str]()
    with open_reader(path) as (reader, typestore):
        known = [each for each in reader.connections if each.msgtype in typestore.types]
        for connection, receipt, raw in readable(reader, known, path.name, said) if known else ():
            try:
                message = typestore.deserialize_cdr(raw, connection.msgtype)
            except Exception:  # whatever the bytes of a broken message lead to
                broken[connection.topic] += 1
                continue
            time = _stamp(message, receipt * 1e-9)
            for field, value in _numbers(message):
                name = f"{connection.topic}:{field}"
                times[name].append(time)
                values[name].append(value)
                units[name] = _unit(connection.msgtype, field)
    said = [each.removeprefix(f"{path.name}: ") for each in said]
    said += [f"topic '{topic}': {count} messages cannot be read" for topic, count in broken.items()]
    unset = [name for name in values if "." in name.rpartition(":")[2] and not any(values[name])]
    said += [f"zero throughout, so taken for never set and left out: {listed(unset)}"] if unset else []
    kept = [name for name in values if name not in unset]
    return Found([_ordered(name, times[name], values[name], units[name]) for name in kept], notes=tuple(said))


def _ordered(name: str, times: list[float], values: list[float], unit: str) -> Signal:
    order = np.argsort(times, kind="stable")
    return Signal(name, np.asarray(values)[order], unit, np.asarray(times)[order])


def _stamp(message: Any, receipt: float) -> float:
    header = getattr(message, "header", None)
    if header is None:
        return receipt
    stamp = float(header.stamp.sec + header.stamp.nanosec * 1e-9)
    return stamp if abs(stamp - receipt) < _CLOCKS_APART else receipt


def _unit(kind: str, field: str) -> str:
    """The unit that a type's own definition says of a field, '' for none."""
    within = field.split(".")[-2] if "." in field else ""
    if within in _WITHIN and any(word in kind for word in _MOTIONS):
        return _WITHIN[within]
    return _UNITS.get(kind, {}).get(field.partition("[")[0], "")


def _numbers(message: Any, deepest: int = _DEEPEST) -> Iterator[tuple[str, float]]:
    """The numbers of a message by field, `within.field` of a message in it; arrays by their names where they have some,
    else by index."""
    names = getattr(message, "name", None)
    for field in message.__dataclass_fields__:
        value = getattr(message, field)
        if isinstance(value, (bool, int, float, np.integer, np.floating)):
            yield field, float(value)
        elif hasattr(value, "__dataclass_fields__") and field != "header" and deepest:
            yield from ((f"{field}.{name}", each) for name, each in _numbers(value, deepest - 1))
        elif (
            isinstance(value, np.ndarray)
            and value.dtype.kind in "biuf"
            and value.ndim == 1
            and len(value) <= _MOST_FIELDS
        ):
            labels = names if isinstance(names, list) and len(names) == len(value) else range(len(value))
            yield from ((f"{field}[{label}]", float(each)) for label, each in zip(labels, value, strict=True))
