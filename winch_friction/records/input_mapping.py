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


def parameters_of(content: Any, node: str, where: str, namespace: str = "") -> dict[str, Any]:
    """Parameters of a node in a ROS parameter file: those of every node (`/**`, `/**/*`) and its own.

    `namespace` is the winch's, '/' for the one without. What a file says of nodes in several namespaces needs it: each
    is a winch of its own. Raises `InputError` without it, and for what is no such file.
    """
    if not isinstance(content, Mapping):
        raise InputError(f"{where}: not a ROS parameter file: expected node names with ros__parameters")
    sections = _sections(content)
    winches = {space for name in sections if (space := _winch_of(name)) is not None}
    if len(winches) > 1 and not namespace:
        said = ", ".join(f"/{each}" for each in sorted(winches))
        raise InputError(f"{where}: parameters of several winches: {said}; choose one with --namespace")
    own_names = [name for name in sections if name.rsplit("/", 1)[-1] in (*EVERY_NODE, node)]
    merged: dict[str, Any] = {}
    for name in own_names:
        section = sections[name]
        if not isinstance(section, Mapping) or "ros__parameters" not in section:
            raise InputError(f"{where}: {name} has no ros__parameters; is this a ROS parameter file?")
        own = section["ros__parameters"] or {}
        if not isinstance(own, Mapping):
            raise InputError(f"{where}: {name}: ros__parameters must hold names with values, found {own!r}")
        merged |= own if len(winches) < 2 or _is_in(_winch_of(name), namespace.strip("/")) else {}
    return merged


def _sections(content: Mapping[Any, Any], above: str = "") -> dict[str, Any]:
    """Node name -> its section; ROS also takes a namespace with the nodes below it."""
    found = dict[str, Any]()
    for name, section in content.items():
        nodes = isinstance(section, Mapping) and "ros__parameters" not in section
        if nodes and section and all(isinstance(each, Mapping) for each in section.values()):
            found |= _sections(section, f"{above}{name}/")
        else:
            found[f"{above}{name}"] = section
    return found


def _winch_of(name: str) -> str | None:
    """The namespace that a section of the nodes with inputs names; None of whoever's."""
    space, _, node = f"/{name.lstrip('/')}".rpartition("/")
    if node not in (*EVERY_NODE, *NODES) or (node == "**" and not space):
        return None
    begin, wild, _ = space.partition("*")
    return None if wild and begin == "/" else begin.strip("/")


def _is_in(winch: str | None, namespace: str) -> bool:
    """Whether a section is of the winch in this namespace, which may be told by its end alone, or of one above it."""
    return winch is None or winch == namespace or f"/{winch}".endswith(f"/{namespace or '/'}")


def refuse_without_nodes(content: Any, where: str) -> None:
    """Raise `InputError` for a file none of whose sections is one of `NODES`: it would set nothing."""
    found = list(_sections(content)) if isinstance(content, Mapping) else []
    if not {name.rsplit("/", 1)[-1] for name in found} & {*EVERY_NODE, *NODES}:
        raise InputError(
            f"{where}: no parameters of {' or '.join(NODES)}: expected one of these names (or /**) with "
            f"ros__parameters below; found {', '.join(found[:6]) or 'no names'}"
        )


def bag_options_of(params_file: Path | None, namespace: str = "") -> dict[str, Any]:
    """Options of `open_bag` for the winch in `namespace`, from the nodes' ROS parameter file where there is one.

    What only the estimator's section says holds, too: both nodes hear the same inputs. Raises `InputError` for what
    is no such file.
    """
    chosen = {"namespace": namespace} if namespace else {}
    if params_file is None:
        return chosen
    content, parameters = read_yaml(params_file), dict[str, Any]()
    refuse_without_nodes(content, str(params_file))
    for node in reversed(NODES):
        parameters |= parameters_of(content, node, str(params_file), namespace)
    names = {each.name for each in fields(InputMapping)}
    own = {key: tuple(filter(None, v)) if isinstance(v, list) else v for key, v in parameters.items() if key in names}
    mapping = from_mapping(InputMapping, own, str(params_file))
    options = mapping.joints() | chosen
    if "motor_speed" in mapping.float64_inputs:
        options["float64_channels"] = mapping.float64_inputs
    said = "displacement_unit" in own and any(own.get("float64_inputs", ()))
    return options | ({"displacement_unit": own["displacement_unit"]} if said else {})
