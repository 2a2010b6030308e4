"""Crane and runs as the practice looks at them: a crane whose only motor group has a name of its own has a main one,
and slower columns have values in every row.
"""

from dataclasses import replace

from winch_friction.physics.signals import GROUP_CHANNELS, Run
from winch_friction.physics.winch import Crane
from winch_friction.records.runs import filled

MAIN = "main"


def as_main(crane: Crane) -> Crane:
    """The crane with its motor group called main, where it has one alone; else as it is."""
    if len(crane.groups) != 1:
        return crane
    return replace(crane, groups=dict.fromkeys((MAIN,), *crane.groups.values()))


def run_as_main(run: Run, crane: Crane) -> Run:
    """A run of `crane`, which still has the group's own name, with the columns of that group under main.

    Columns that are written in every n-th row only have values in every one.
    """
    run, _ = filled(run)  # the reader has said which columns are slow
    if len(crane.groups) != 1:
        return run
    (own,) = crane.groups
    renamed = {f"{own}.{channel}": f"{MAIN}.{channel}" for channel in GROUP_CHANNELS}
    return replace(run, columns={renamed.get(name, name): values for name, values in run.columns.items()})
