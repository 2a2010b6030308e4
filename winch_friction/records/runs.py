"""Run files in and out by their kind: .csv, .parquet, or a rosbag2 folder (.mcap and .db3 files as well).

How the inputs of one machine travel is said once, for nodes and for every verb that reads a bag.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from winch_friction.physics.errors import InputError, Problems, check, from_mapping, option
from winch_friction.physics.signals import Run
from winch_friction.physics.winch.crane import Crane
from winch_friction.records.strict_yaml import read_yaml
from winch_friction.records.topics import DISPLACEMENT_UNITS, PRESSURE_REFERENCES, TopicMap, crane_topics

NODES = ("compensator", "estimator")  # that have inputs, by the names of their sections in a parameter file
BAG_SUFFIXES = (".mcap", ".db3")
KINDS = ".csv, .parquet, a rosbag2 folder, .mcap or .db3"


def is_bag(path: Path) -> bool:
    """Whether a recording is one of ROS 2; a logger under Windows writes RUN.MCAP."""
    return path.is_dir() or path.suffix.lower() in BAG_SUFFIXES


def read_run(path: Path | str, crane: Crane | None = None, *, complete: bool = True, **bag_options: Any) -> Run:
    """A run in SI from a CSV, a Parquet file or a bag.

    The crane is needed where the file speaks of the drum or of displacement fractions; `complete=False` asks for `time`
    alone (truth files); `bag_options` go to `records.bags.read_bag`. What was noticed is in the run's `warnings`.
    Raises `InputError` in one line for whatever cannot be used.
    """
    path = Path(path)
    if not path.exists():
        raise InputError(f"{path}: no such file or folder")
    suffix = path.suffix.lower()  # a logger under Windows writes LOG.CSV
    if is_bag(path):
        from winch_friction.records.bags import read_bag

        return read_bag(path, crane, complete=complete, **bag_options)
    if suffix == ".csv":
        from winch_friction.records.csv_file import read_csv_run

        return read_csv_run(path, crane, complete)
    if suffix in (".parquet", ".pq"):
        from winch_friction.records.parquet_file import read_parquet_run

        return read_parquet_run(path, crane, complete)
    raise InputError(f"{path}: not a kind of run file that is known; use {KINDS} (winch-friction import reads others)")


def read_runs(paths: Iterable[Path | str], crane: Crane | None = None, **options: Any) -> list[Run]:
    """Several runs; two of the same name raise `InputError`, since the name is a run's identity."""
    runs, problems = [], Problems()
    for path in paths:
        with problems:
            runs.append(read_run(path, crane, **options))
    problems.say()
    refuse_same_names(runs)
    return runs


def refuse_same_names(runs: Sequence[Run]) -> None:
    """Raise `InputError` where two runs have the same name."""
    names = [run.name for run in runs]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"{name}: two runs have this name; a run's identity is its file name, so rename one")


def write_run(run: Run, path: Path | str, **bag_options: Any) -> Path:
    """Write a run by suffix: .csv, .parquet, or a rosbag2 folder (.mcap or .db3 in the name choose the storage)."""
    path = refuse_unknown_kind(Path(path))
    if path.suffix == ".csv":
        from winch_friction.records.csv_file import write_csv_run

        return write_csv_run(run, path)
    if path.suffix in (".parquet", ".pq"):
        from winch_friction.records.parquet_file import write_parquet_run

        return write_parquet_run(run, path)
    from winch_friction.records.bag_write import write_bag

    return write_bag(run, path, **bag_options)


def refuse_unknown_kind(path: Path) -> Path:
    """The path, when a run can be written under its name; else `InputError`."""
    if path.suffix not in (".csv", ".parquet", ".pq", "", ".bag", *BAG_SUFFIXES):
        raise InputError(f"{path}: cannot write this kind of file; use {KINDS}")
    return path


# -- how inputs travel
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
    """Parameters of a node in a ROS parameter file: those of every node (`/**`) and its own."""
    if not isinstance(content, Mapping):
        raise InputError(f"{where}: not a ROS parameter file: expected node names with ros__parameters")
    merged: dict[str, Any] = {}
    for name, section in content.items():
        if str(name).rsplit("/", 1)[-1] in ("**", node):
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
    if not {name.rsplit("/", 1)[-1] for name in found} & {"**", *NODES}:
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
