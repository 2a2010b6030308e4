"""Which topics of a bag are which of the winch's, told from their names."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from winch_friction.physics.errors import InputError
from winch_friction.records.topics import TopicMap

SPEED_TOPIC = "winch/joint_states"  # below a winch's namespace
GROUP = "GROUP"  # stands for any motor group's name


def matched(path: Path, reader: Any, namespace: str, remap: dict[str, str]) -> dict[str, str]:
    """Contract topic -> topic in the bag, for all topics that end like one of the winch's, and as `remap` says.

    Raises `InputError` without a topic of the winch's speed, and for what is remapped of no topic of a winch's or to
    none of the bag.
    """
    names = sorted({each.topic for each in reader.connections if each.msgcount})
    known = TopicMap(groups=(GROUP,)).inputs
    problems = [
        f"{path}: '{own}' is no topic of the winch's: {', '.join(known)}"
        for own in remap
        if _of_any_group(own) not in known
    ]
    problems += [
        f"{path}: topic '{other}' has no message; the bag has {', '.join(names)}"
        for other in remap.values()
        if other not in names
    ]
    if problems:
        raise InputError(*problems)
    speed = remap.get(SPEED_TOPIC) or speed_topic(path, names, namespace)
    prefix = speed.removesuffix(SPEED_TOPIC)
    own = {name[len(prefix) :]: name for name in names if prefix != speed and name.startswith(f"{prefix}winch/")}
    return {**own, **remap, SPEED_TOPIC: speed}


def _of_any_group(topic: str) -> str:
    parts = topic.split("/")
    return "/".join([parts[0], GROUP, parts[2]]) if len(parts) == 3 else topic


def speed_topic(path: Path, names: list[str], namespace: str) -> str:
    """The topic of the winch's speed, of the one winch in the bag or of that in `namespace`; `InputError` else."""
    ending = f"/{namespace.strip('/')}/{SPEED_TOPIC}".replace("//", "/")
    found = [name for name in names if name.endswith(ending)]
    if namespace and ending in found:  # '/': the one without; a namespace within another is another winch's
        return ending
    if len(found) == 1:
        return found[0]
    if found:
        spaces = ", ".join(each.removesuffix(SPEED_TOPIC).rstrip("/") or "/" for each in found)
        way = f"choose one with --namespace: {spaces}; where a verb has none, 'convert run' makes a run file of one"
        raise InputError(f"{path}: several winches: {', '.join(found)}; {way}")
    raise InputError(
        f"{path}: no message on a topic '...{ending}'; the bag has {', '.join(names)}; remap winch/joint_states to the "
        "topic of the winch's speed"
    )


def groups_of(found: Mapping[str, str]) -> tuple[str, ...]:
    """The motor groups, of which a pressure is there."""
    parts = [contract.split("/") for contract in found]
    return tuple(dict.fromkeys(p[1] for p in parts if len(p) == 3 and p[2] in ("pressure_a", "pressure_b")))
