"""Names of groups in a row of their own above the names: cells that are merged over their columns, or left empty.

A spreadsheet with `Active` over three columns and `Passive` over the next three bears each name below twice; with the
group before it each is one column.
"""

import re
from collections.abc import Sequence
from typing import Any

from winch_friction.importing.cells import is_missing

_UNIT = re.compile(r"\s*[\[(][^\])]*[\])]$")  # behind a name
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
    bare = [_UNIT.sub("", name) for name in plain]
    twice = [bool(name) and bare.count(name) > 1 for name in bare]
    told = [f"{group} {name}".strip() if ours else name for group, name, ours in zip(groups, plain, twice, strict=True)]
    grouped = {group for group, ours in zip(groups, twice, strict=True) if ours}
    ours = [name for name, own in zip(told, twice, strict=True) if own]
    return told if len(grouped) >= _FEWEST and len(set(ours)) == len(ours) else list(names)
