"""The winch's topics as Foxglove channels, with schemas: ROS messages as they are, and what they say in plain JSON.

Every ROS message goes out under its own topic as CDR with its ROS 2 definition, so that the same layout works with this
package, with foxglove_bridge and with a bag. Beside them `/winch_friction/...` carries what `watch` and `dashboard`
show: each signal in the unit that people read, the estimates with their sigma, and the health. The SDK behind it is
`foxglove-sdk`, an extra.
"""

import json
from collections.abc import Iterable, Mapping
from typing import Any

from winch_friction.physics.errors import InputError
from winch_friction.records.bag_write import MESSAGES
from winch_friction.records.cdr import LITTLE_ENDIAN, READERS
from winch_friction.records.plain import finite
from winch_friction.records.raw import RawMessage
from winch_friction.records.telemetry import SIGNALS, TOPICS, Telemetry, estimates, faults, inputs, state
from winch_friction.records.topics import split_time, stamp_time

OWN = "/winch_friction"  # above the topics that this package computes from the nodes' own
BAND = 2.0  # standard deviations either side of an estimate: 95 % of a normal one
_NUMBER = {"type": ["number", "null"]}
_TEXT = {"type": "string"}
_STAMP = {"type": "object", "properties": {"sec": {"type": "integer"}, "nsec": {"type": "integer"}}}
_HEADER = {"type": "object", "properties": {"stamp": _STAMP}}


def _rows(**fields: Any) -> dict[str, Any]:
    return {"type": "array", "items": {"type": "object", "properties": fields}}


def json_schema(title: str, description: str, **fields: Any) -> dict[str, Any]:
    """A JSON Schema of a message with a header, whose stamp is that of the measurement."""
    properties = {"header": _HEADER, **fields}
    return {"title": title, "description": description, "type": "object", "properties": properties,
            "required": sorted(properties)}  # fmt: skip


OWN_CHANNELS: dict[str, dict[str, Any]] = {
    f"{OWN}/{name}": json_schema(f"winch_friction.{name}", text, value=_NUMBER) for name, text in SIGNALS.items()
}
OWN_CHANNELS[f"{OWN}/estimates"] = json_schema(
    "winch_friction.estimates",
    "parameters of the learned model in SI: value, standard deviation, value -/+ 2 of them, status",
    parameters=_rows(parameter=_TEXT, value=_NUMBER, std=_NUMBER, lower=_NUMBER, upper=_NUMBER, status=_TEXT),
)
OWN_CHANNELS[f"{OWN}/health"] = json_schema(
    "winch_friction.health",
    "what is wrong, what state each part is in, rate [Hz] and age [s] of every input",
    healthy={"type": "boolean"},
    faults={"type": "array", "items": _TEXT},
    state=_rows(part=_TEXT, says=_TEXT),
    inputs=_rows(input=_TEXT, rate=_NUMBER, age=_NUMBER),
)


def foxglove_sdk() -> Any:
    """The SDK; raises `InputError` where it is not installed."""
    try:
        import foxglove
    except ImportError as error:
        raise InputError("this needs foxglove-sdk: pip install 'winch_friction[foxglove]'") from error
    return foxglove


class Relay:
    """Logs ROS messages, and what they say, to the sinks (server, MCAP file) of a Foxglove context.

    `namespace` is that of the winch's nodes. Topics whose types ROS 2 Jazzy's definitions lack are read past, and said
    in `passed`.
    """

    def __init__(self, context: Any, namespace: str = "") -> None:
        self._foxglove, self._context = foxglove_sdk(), context
        self._prefix = f"/{namespace.strip('/')}/" if namespace.strip("/") else "/"
        self._contract = {t if t.startswith("/") else self._prefix + t: t for t in TOPICS}
        self._telemetry = Telemetry(namespace=namespace)
        self.passed: dict[str, str] = {}  # topic -> why it is not shown
        self._channels: dict[str, Any] = {}
        for topic, schema in OWN_CHANNELS.items():
            content = self._foxglove.Schema(
                name=schema["title"], encoding="jsonschema", data=json.dumps(schema).encode()
            )
            self._channels[topic] = self._foxglove.Channel(
                topic, schema=content, message_encoding="json", context=context
            )

    def advertise(self, topics: Mapping[str, str] | Iterable[tuple[str, str]]) -> None:
        """Channels for topics by their types; those that are there already stay."""
        for topic, type_name in dict(topics).items():
            if topic not in self._channels and topic not in self.passed:
                try:
                    text = definition(type_name)
                except InputError as error:
                    self.passed[topic] = f"topic '{topic}': {error}"
                    continue
                schema = self._foxglove.Schema(name=type_name, encoding="ros2msg", data=text.encode())
                self._channels[topic] = self._foxglove.Channel(
                    topic, schema=schema, message_encoding="cdr", context=self._context
                )

    def take(self, message: RawMessage) -> None:
        """One message: out as it is, and what it says of the winch."""
        self.advertise({message.topic: message.type_name})
        if message.topic in self.passed:
            return
        self._channels[message.topic].log(message.data, log_time=message.receipt)
        if message.topic not in self._contract:
            return
        contract = self._contract[message.topic]
        try:
            content = _read(message)
            self._telemetry.take(contract, content, message.receipt * 1e-9)
        except Exception:  # whatever the bytes of a broken message lead to; it went out as it is
            return
        frame = self._telemetry.frame()
        for signal, points in frame["points"].items():
            for time, value in points:
                self._say(signal, message.receipt, time, value=value)
        if contract == "/diagnostics":
            self._say_status(frame["status"], message.receipt, stamp_time(content))

    def _say_status(self, status: dict[str, Any], receipt: int, time: float) -> None:
        known = [{**each, "lower": each["value"] - BAND * each["std"], "upper": each["value"] + BAND * each["std"]}
                 for each in estimates(status)]  # fmt: skip
        if known:
            self._say("estimates", receipt, time, parameters=known)
        wrong, parts = faults(status), [{"part": part, "says": says} for part, says in state(status)]
        self._say("health", receipt, time, healthy=not wrong, faults=wrong, state=parts, inputs=inputs(status))

    def _say(self, name: str, receipt: int, time: float, **content: Any) -> None:
        seconds, nanoseconds = split_time(time)
        message = {"header": {"stamp": {"sec": seconds, "nsec": nanoseconds}}, **content}
        self._channels[f"{OWN}/{name}"].log(json.dumps(finite(message)).encode(), log_time=receipt)


def definition(type_name: str) -> str:
    """The ROS 2 definition of a type with all that it is made of; raises `InputError` for an unknown one."""
    try:
        return str(MESSAGES.store.generate_msgdef(type_name, ros_version=2)[0])
    except Exception as error:  # rosbags raises its own kinds
        raise InputError(f"{type_name}: no message of ROS 2 Jazzy; its topic cannot be shown") from error


def _read(message: RawMessage) -> Any:
    reader = READERS.get(message.type_name)
    if reader is not None and message.data[:2] == LITTLE_ENDIAN:
        return reader(message.data)
    return MESSAGES.store.deserialize_cdr(message.data, message.type_name)
