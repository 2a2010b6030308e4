"""A rosbag2 recording opened for reading: its topics matched to the winch's, its messages in the order of arrival."""

from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from winch_friction.physics.channels import DRIVE_SCALARS
from winch_friction.physics.errors import InputError
from winch_friction.physics.winch.crane import Crane
from winch_friction.records.bag_joints import joints_on, no_speed, told_joint
from winch_friction.records.bag_storage import readable, refused, storage_of
from winch_friction.records.bag_topics import SPEED_TOPIC, groups_of, matched
from winch_friction.records.cdr import LITTLE_ENDIAN, READERS
from winch_friction.records.topics import FLOAT64, Input, TopicMap, crane_topics, stamp_time

NANOSECOND = 1e-9
_PEEKED = 20  # messages looked at to tell a displacement's unit
_LARGEST_DISPLACEMENT = 1e-3  # m^3/rad, 6300 cm^3/rev: a number above is a fraction
_NO_TIME_YET = 1.0  # s after the stamps' zero beyond which a stamp of 0 is of a sender that knows no time yet
_CLOCKS_APART = 60.0  # s; header stamps and receipt times that differ by more are of different clocks


@dataclass(slots=True)
class Message:
    """One message of the winch: its contract topic, the message, and its receipt in s on the clock of the stamps."""

    source: Input
    message: Any
    receipt: float

    @property
    def stamp(self) -> float:
        """When it was measured, s; when it was received where it does not say."""
        return stamp_time(self.message) if self.source.stamped else self.receipt


@dataclass(frozen=True)
class Other:
    """One message of the bag that is no input of the winch: its topic in the bag, the message, its receipt in s."""

    topic: str
    message: Any
    receipt: float


@dataclass
class Bag:
    """An open recording.

    `topics` is the map of the winch's inputs in it; `warnings` say what was passed over. Made by `open_bag`.
    """

    name: str
    topics: TopicMap
    actual: Mapping[str, str]  # contract topic -> topic in the bag
    warnings: list[str]
    _reader: Any
    _typestore: Any
    _offset: float = 0.0
    _timed: bool = False  # whether the speed's stamps tell a time
    _broken: dict[str, int] = field(default_factory=dict)

    def inputs(self) -> Iterator[Message]:
        """The winch's input messages, in the order of their receipt."""
        return (each for each in self.events() if isinstance(each, Message))

    def events(self, *others: str) -> Iterator[Message | Other]:
        """The winch's input messages and those on other topics of the bag, in the order of their receipt."""
        sources = {actual: self.topics.inputs[contract] for contract, actual in self.actual.items()}
        came, timeless = Counter[str](), Counter[str]()
        for topic, receipt, message in self.messages(*sources, *others):
            time = receipt - self._offset
            if topic not in sources:
                yield Other(topic, message, time)
                continue
            came[topic] += 1
            if self._timed and sources[topic].stamped and abs(time) > _NO_TIME_YET and not stamp_time(message):
                timeless[topic] += 1
                continue
            yield Message(sources[topic], message, time)
        if timeless:
            said = ", ".join(f"topic '{t}': {n} of {came[t]} messages are left out" for t, n in timeless.items())
            self.warnings.append(f"{self.name}: stamped 0, as by a sender that knows no time yet: {said}")
        self.warnings += [f"{self.name}: topic '{t}': {n} messages cannot be read" for t, n in self._broken.items()]
        self._broken.clear()

    def messages(self, *topics: str) -> Iterator[tuple[str, float, Any]]:
        """Topic, receipt in s and message of some of the bag's topics; unreadable messages are counted and left out.

        At the end it is said when fewer came than there are by the bag's own index: a file that is damaged in its
        middle ends there without an error.
        """
        connections = [each for each in self._reader.connections if each.topic in topics]
        if not connections:
            return
        for connection, receipt, raw in readable(self._reader, connections, self.name, self.warnings):
            reader = READERS.get(connection.msgtype)
            try:
                if reader is not None and raw[:2] == LITTLE_ENDIAN:
                    message = reader(raw)
                else:
                    message = self._typestore.deserialize_cdr(raw, connection.msgtype)
            except Exception:  # whatever the bytes of a broken message lead to
                self._broken[connection.topic] = self._broken.get(connection.topic, 0) + 1
                continue
            yield connection.topic, receipt * NANOSECOND, message

    def no_speed(self) -> str:
        """What to say when no message tells the winch's speed."""
        speed = self.actual[self.topics.speed_topic]
        heard = joints_on(self._reader, self._typestore, speed)
        return no_speed(f"topic '{speed}'", self.topics.speed_joint, heard)

    def topics_ending(self, suffix: str) -> list[str]:
        """Topics by the end of their name, e.g. `/friction_torque`; those of another winch in the bag are not ours."""
        topics = {each.topic for each in self._reader.connections}
        spaces = [each.removesuffix(SPEED_TOPIC) for each in topics if each.endswith(f"/{SPEED_TOPIC}")]
        own = self.actual[self.topics.speed_topic].removesuffix(SPEED_TOPIC)
        of = lambda topic: max((each for each in spaces if topic.startswith(each)), key=len, default=own)
        return sorted(each for each in topics if each.endswith(suffix) and of(each) == own)


@contextmanager
def open_bag(
    path: Path,
    crane: Crane | None = None,
    *,
    remap: Mapping[str, str] | None = None,
    namespace: str = "",
    **conventions: Any,
) -> Iterator[Bag]:
    """Open a bag folder, .mcap or .db3 file.

    `remap` gives contract topics (`winch/joint_states`) their names in the bag; `namespace` chooses one of several
    winches; `conventions` are those of `TopicMap`, except that without `displacement_unit` it is told from the numbers.
    Raises `InputError` for what is not a bag, has no message or has no speed topic.
    """
    path = Path(path)
    with _reader(path) as reader:
        if reader.message_count == 0:
            raise InputError(f"{path}: the bag holds no message; was the recorder started before the nodes?")
        typestore = _typestore()
        found = matched(path, reader, namespace, dict(remap or {}))
        groups = groups_of(found)
        topics = _topics(path, reader, typestore, crane, groups, found, conventions)
        actual = {contract: topic for contract, topic in found.items() if contract in topics.inputs}
        bag = Bag(path.name, topics, actual, [], reader, typestore)
        _check_types(path, reader, bag)
        bag.warnings += _passed_over(path.name, reader, typestore, set(actual.values()))
        unread = replace(bag, warnings=[], _broken={})  # what is lost is said of the reading
        bag._offset, bag._timed = _clock_offset(unread)
        yield bag


@contextmanager
def open_reader(path: Path) -> Iterator[tuple[Any, Any]]:
    """Reader and types of any recording, whatever its topics; raises `InputError` for no bag and for an empty one."""
    path = Path(path)
    with _reader(path) as reader:
        if reader.message_count == 0:
            raise InputError(f"{path}: the bag holds no message; was the recorder started before the nodes?")
        yield reader, _typestore()


@contextmanager
def _reader(path: Path) -> Iterator[Any]:
    from rosbags.rosbag2 import Reader

    storage = storage_of(path)
    try:
        reader = Reader(storage)
        reader.open()
    except Exception as error:  # rosbags raises its own errors, sqlite's, struct's and assertions for broken files
        raise refused(path, error) from error
    try:
        yield reader
    finally:
        reader.close()


def _typestore() -> Any:
    from rosbags.typesys import Stores, get_typestore

    return get_typestore(Stores.ROS2_JAZZY)


def _topics(
    path: Path, reader: Any, typestore: Any, crane: Crane | None, groups: tuple[str, ...],
    found: Mapping[str, str], conventions: dict[str, Any],
) -> TopicMap:  # fmt: skip
    types = {each.topic: each.msgtype for each in reader.connections}
    if "float64_channels" not in conventions:  # what comes plain in the bag came plain from the bridge
        conventions["float64_channels"] = _plain_channels(groups, {c for c, t in found.items() if types[t] == FLOAT64})
    if "displacement_unit" not in conventions:
        plain = [found[f"winch/{g}/displacement"] for g in groups if f"winch/{g}/displacement" in found]
        conventions["displacement_unit"] = _displacement_unit(reader, typestore, plain)
    if crane is not None:
        conventions |= told_joint(joints_on(reader, typestore, found["winch/joint_states"]), conventions)
        return crane_topics(crane, groups, drive_scalars=DRIVE_SCALARS, **conventions)
    if conventions["displacement_unit"] == "fraction" and groups:
        raise InputError(f"{path}: displacements are fractions; give the crane, whose max_displacement they refer to")
    return TopicMap(groups=groups, **conventions)


def _plain_channels(groups: tuple[str, ...], plain: set[str]) -> tuple[str, ...]:
    """First channels of the held inputs whose topics are std_msgs/Float64 in the bag; a speed without a stamp must be
    asked for."""
    topics = TopicMap(groups=groups)
    held = {topic: s for topic, s in topics.inputs.items() if topic != topics.speed_topic and s.stamped}
    return tuple(source.channels[0] for topic, source in held.items() if topic in plain)


def _displacement_unit(reader: Any, typestore: Any, topics: list[str]) -> str:
    """Settings up to 1 and m^3/rad of about 1e-5 lie five decades apart: the numbers tell."""
    connections = [c for c in reader.connections if c.topic in topics]
    if not connections:
        return "m3_per_rad"
    for count, (connection, _, raw) in enumerate(readable(reader, connections, "", [])):
        message = typestore.deserialize_cdr(raw, connection.msgtype)
        positions = [message.data] if connection.msgtype == FLOAT64 else getattr(message, "position", ())
        if any(abs(value) > _LARGEST_DISPLACEMENT for value in positions):
            return "fraction"
        if count >= _PEEKED:
            break
    return "m3_per_rad"


def _check_types(path: Path, reader: Any, bag: Bag) -> None:
    types = {each.topic: each.msgtype for each in reader.connections}
    for contract, actual in bag.actual.items():
        expected = bag.topics.inputs[contract].type_name
        if types[actual] != expected:
            raise InputError(
                f"{path}: topic '{actual}' is {types[actual]}, expected {expected}; std_msgs/msg/Float64 is accepted "
                "for channels named in float64_channels"
            )


def _passed_over(name: str, reader: Any, typestore: Any, used: set[str]) -> list[str]:
    rest = {each.topic: each.msgtype for each in reader.connections if each.msgcount and each.topic not in used}
    unknown = {topic: kind for topic, kind in rest.items() if kind not in typestore.types}
    said = [
        f"{name}: topic '{topic}' is of a type that is not installed, {kind}: read past"
        for topic, kind in unknown.items()
    ]
    known = [topic for topic in rest if topic not in unknown]
    return said + (
        [f"{name}: topics that are no inputs of the winch's, read past: {', '.join(known)}"] if known else []
    )


def _clock_offset(bag: Bag) -> tuple[float, bool]:
    """Receipt minus stamp in s when the recorder's clock and the stamps' are different ones, else zero; and whether
    the stamps tell a time at all. Told from the first that is not 0: before a simulation's clock runs, all are."""
    speed, first = bag.topics.inputs[bag.topics.speed_topic], 0.0
    if not speed.stamped:
        return 0.0, False
    for _, receipt, message in bag.messages(bag.actual[speed.topic]):
        stamp, first = stamp_time(message), first or receipt
        if stamp:
            offset = receipt - stamp
            return (offset if abs(offset) > _CLOCKS_APART else 0.0), True
    return (first if abs(first) > _CLOCKS_APART else 0.0), False
