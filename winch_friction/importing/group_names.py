"""Names of groups in a row of their own above the names: cells that are merged over their columns, or left empty.

A spreadsheet with `Active` over three columns and `Passive` over the next three bears each name below twice; with the
group before it each is one column.
"""

from collections.abc import Sequence
from typing import Any

from winch_friction.importing.cells import is_missing

_FEWEST = 2  # groups: one word above all the columns is a title


def with_groups(names: Sequence[str], above: Sequence[Any]) -> list[str]:
    """The names with their group before those that stand more than once, where the row `above` holds groups.

    Its first cell of a group stands over the group's first column, the others are empty, as of merged cells. Names
    that the groups do not tell apart are left as they are.
    """
    groups, last = [], ""
    for cell in [*above[: len(names)], *[None] * (len(names) - len(above))]:
        last = last if is_missing(cell) else " ".join(str(cell).split())
        groups.append(last)
    plain = [" ".join(str(name).split()) for name in names]
    twice = {name for name in plain if name and plain.count(name) > 1}
    told = [f"{group} {name}".strip() if name in twice else name for group, name in zip(groups, plain, strict=True)]
    grouped = {group for group, name in zip(groups, plain, strict=True) if name in twice}
    ours = [name for name, own in zip(told, plain, strict=True) if own in twice]
    return told if len(grouped) >= _FEWEST and len(set(ours)) == len(ours) else list(names)
