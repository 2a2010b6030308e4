"""How the inputs of one machine travel as messages, said once, for nodes and for every verb that reads a bag."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from winch_friction.physics.errors import InputError, check, from_mapping, option
from winch_friction.physics.winch.crane import Crane
from winch_friction.records.strict_yaml import read_yaml
from winch_friction.records.topics import DISPLACEMENT_UNITS, PRESSURE_REFERENCES, TopicMap, crane_topics

NODES = ("compensator", "estimator")  # that have inputs, by the names of their sections in a parameter file
EVERY_NODE = ("**", "*")  # what a section of all nodes ends with


@dataclass(frozen=True)
class InputMapping:
    """Groups, joints, fields and conventions of the input messages. Raises `InputError` for values out of range."""

    groups: tuple[str, ...] = option(("active", "passive"), doc="motor groups on the shaft, by their names in topics")
    speed_joint: str = option(
        "winch_motor", doc="joint whose speed winch/joint_states carries: the motor's, or drum_joint"
    )
    drum_joint: str = option("winch_drum", doc="name of the drum's joint; its speed is multiplied by the gear ratio")
    swash_joint: str = option("{group}_swash", doc="joint of winch/<group>/displacement; {group} is the group's name")
    pressure_reference: str = option("gauge", choices=PRESSURE_REFERENCES, doc="what the pressure transducers measure")
    displacement_unit: str = option(
        "fraction", choices=DISPLACEMENT_UNITS, doc="unit of the displacement joints: of the maximum, or m3/rad"
    )
    float64_inputs: tuple[str, ...] = option(
        (), doc="channels that a plain bridge sends as std_msgs/Float64, stamped on receipt, e.g. active.pressure_a"
    )

    def __post_init__(self) -> None:
        check(self)

    def topics(self, crane: Crane) -> TopicMap:
        """The input topics of this crane under these conventions."""
        return crane_topics(
            crane,
            self.groups,
            displacement_unit=self.displacement_unit,
            float64_channels=self.float64_inputs,
            **self.joints(),
        )

    def joints(self) -> dict[str, Any]:
        """What `open_bag` needs to be told: it finds groups, units and plain inputs in the bag itself."""
        motor = {} if self.speed_joint == self.drum_joint else {"motor_joint": self.speed_joint}
        return {
            "speed_joint": self.speed_joint, "drum_joint": self.drum_joint, "swash_joint": self.swash_joint,
            "pressure_reference": self.pressure_reference, **motor,
        }  # fmt: skip


def parameters_of(content: Any, node: str, where: str) -> dict[str, Any]:
    """Parameters of a node in a ROS parameter file: those of every node (`/**`, `/**/*`) and its own."""
    if not isinstance(content, Mapping):
        raise InputError(f"{where}: not a ROS parameter file: expected node names with ros__parameters")
    merged: dict[str, Any] = {}
    for name, section in content.items():
        if str(name).rsplit("/", 1)[-1] in (*EVERY_NODE, node):
            if not isinstance(section, Mapping) or "ros__parameters" not in section:
                raise InputError(f"{where}: {name} has no ros__parameters; is this a ROS parameter file?")
            own = section["ros__parameters"] or {}
            if not isinstance(own, Mapping):
                raise InputError(f"{where}: {name}: ros__parameters must hold names with values, found {own!r}")
            merged |= own
    return merged


def refuse_without_nodes(content: Any, where: str) -> None:
    """Raise `InputError` for a file none of whose sections is one of `NODES`: it would set nothing."""
    found = [str(name) for name in content] if isinstance(content, Mapping) else []
    if not {name.rsplit("/", 1)[-1] for name in found} & {*EVERY_NODE, *NODES}:
        raise InputError(
            f"{where}: no parameters of {' or '.join(NODES)}: expected one of these names (or /**) with "
            f"ros__parameters below; found {', '.join(found[:6]) or 'no names'}"
        )


def bag_options_of(params_file: Path | None) -> dict[str, Any]:
    """Options of `open_bag` from the nodes' ROS parameter file; none without one.

    What only the estimator's section says holds, too: both nodes hear the same inputs. Raises `InputError` for what
    is no such file.
    """
    if params_file is None:
        return {}
    content, parameters = read_yaml(params_file), dict[str, Any]()
    refuse_without_nodes(content, str(params_file))
    for node in reversed(NODES):
        parameters |= parameters_of(content, node, str(params_file))
    names = {each.name for each in fields(InputMapping)}
    own = {key: tuple(filter(None, v)) if isinstance(v, list) else v for key, v in parameters.items() if key in names}
    mapping = from_mapping(InputMapping, own, str(params_file))
    options = mapping.joints()
    if "motor_speed" in mapping.float64_inputs:
        options["float64_channels"] = mapping.float64_inputs
    said = "displacement_unit" in own and any(own.get("float64_inputs", ()))
    return options | ({"displacement_unit": own["displacement_unit"]} if said else {})
