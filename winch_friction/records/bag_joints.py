"""Which joint of a recording turns with the winch: told by the names on the topic of its speed."""

from collections.abc import Mapping
from itertools import islice
from typing import Any

from winch_friction.records.bag_storage import readable
from winch_friction.records.topics import JOINT_STATE

_PEEKED = 20  # messages: a sender names its joints in every one, several senders take turns


def joints_on(reader: Any, typestore: Any, topic: str) -> tuple[str, ...]:
    """The names of the joints on a topic, in the order in which they come; none for another type of message."""
    connections = [each for each in reader.connections if each.topic == topic and each.msgtype == JOINT_STATE]
    names: dict[str, None] = {}
    for connection, _, raw in islice(readable(reader, connections, "", []), _PEEKED) if connections else ():
        try:
            names |= dict.fromkeys(map(str, typestore.deserialize_cdr(raw, connection.msgtype).name))
        except Exception:  # whoever reads the topic counts what is broken
            continue
    return tuple(names)


def told_joint(names: tuple[str, ...], conventions: Mapping[str, Any]) -> dict[str, str]:
    """The joint of the speed where nobody says it and the recording has the drum's by its name, not the motor's."""
    drum, motor = conventions.get("drum_joint", "winch_drum"), conventions.get("motor_joint", "winch_motor")
    return {"speed_joint": drum} if "speed_joint" not in conventions and drum in names and motor not in names else {}


def no_speed(where: str, joint: str, names: tuple[str, ...]) -> str:
    """What to say of a recording that has no speed of the winch's joint."""
    said = f"{where} has no finite speed of joint '{joint}'"
    if joint in names or not names:
        return said
    return f"{said}; found {', '.join(names)}: name the winch's, replay --joint NAME or speed_joint in a --params-file"
