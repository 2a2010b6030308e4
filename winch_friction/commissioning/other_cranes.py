"""Which other cranes there are, and whether runs may be one's, as far as the motors that the log shows allow it.

Asked of runs that are doubted, or that say another crane's name; nobody else reads another crane's file.
"""

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from winch_friction.commissioning.view import RunView
from winch_friction.physics.errors import InputError
from winch_friction.physics.winch.crane import Crane
from winch_friction.records.crane_file import load_crane
from winch_friction.records.strict_yaml import config_directory, read_yaml

MOST_FILES = 40  # of a folder that are looked at: a folder of crane files holds fewer, one of logs is no such folder
STOP = 0.03  # relative: motors of different size differ by more, a swivel angle's sensor by less


def known_cranes(*folders: Path) -> dict[str, Crane]:
    """The shipped cranes and those of crane files in these folders, by name.

    A file that is no crane's, or that cannot be read, is passed over: there is nothing to compare with.
    """
    places = dict.fromkeys((config_directory() / "cranes", *folders))
    return {crane.name: crane for folder in places for crane in _cranes_in(folder)}


def cranes_near(files: Sequence[Path]) -> dict[str, Crane]:
    """The same with the user's own: those that lie here, and beside these files."""
    return known_cranes(Path.cwd(), *(Path(each).resolve().parent for each in files))


def _cranes_in(folder: Path) -> Iterator[Crane]:
    for path in sorted(folder.glob("*.yaml"))[:MOST_FILES] if folder.is_dir() else ():
        try:
            content = read_yaml(path)
            if isinstance(content, dict) and str(content.get("schema", "")).startswith("winch_friction.crane/"):
                yield load_crane(path)
        except InputError:
            continue


def same_machine(first: Crane, second: Crane) -> bool:
    """Whether two cranes are one to the torque balance, whatever their names."""
    own = lambda c: (c.gear_ratio, c.drum.layer_radii, dict(c.groups), c.max_displacement, c.drive)
    return own(first) == own(second)


def claim(views: Sequence[RunView], crane: Crane, name: str, other: Crane) -> str:
    """What is said where the figures of another crane make these runs fit; empty: they cannot be its runs."""
    if other == crane or other.drive.kind != crane.drive.kind or any(_lacks(view, other) for view in views):
        return ""
    if name == crane.name:
        return f"the crane file differs from the shipped '{name}', whose figures fit: gear, drum or motor is wrong"
    swivelled = _largest_swivel(views)
    if not crane.drive.hydraulic or _at_stop(swivelled, other):
        return f"these are runs of crane '{name}', not of '{crane.name}'"
    if _at_stop(swivelled, crane) or swivelled > other.max_displacement:
        return ""  # the motors are those of the crane file, or no motors of the other's
    return (
        f"gear, drum and number of motors of crane '{name}' fit, those of '{crane.name}' do not; whose motors these "
        "are the log does not say: another crane's runs, or a wrong number in the crane file"
    )


def _largest_swivel(views: Sequence[RunView]) -> float:
    """The largest displacement per motor that any of the runs shows, m^3/rad; 0 where none has motor groups."""
    groups = [group for view in views for group in view.groups.values()]
    return max((float(np.nanmax(np.abs(group.displacement), initial=0.0)) for group in groups), default=0.0)


def _at_stop(swivelled: float, crane: Crane) -> bool:
    """Whether motors that go so far are this crane's, fully swivelled."""
    return abs(swivelled - crane.max_displacement) <= STOP * crane.max_displacement > 0.0


def _lacks(view: RunView, crane: Crane) -> bool:
    try:
        view.on(crane)
    except InputError:
        return True
    return False
