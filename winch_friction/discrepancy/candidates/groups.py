"""Whose transducers and feedbacks are off: all motor groups, those of one side, or one driving group alone."""

from collections.abc import Callable, Sequence

import numpy as np

from winch_friction.discrepancy.candidates.candidate import Shape, Sides, Values
from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.preparation.prepared_run import PreparedRun
from winch_friction.discrepancy.preparation.seen import GroupSignals

# the driving group of runs without a passive one (ALONE) and with one (BESIDE) may be two, each with transducers
ALL, BALANCING, OTHER, ALONE, BESIDE = 0.0, 1.0, 2.0, 3.0, 4.0

GroupLaw = Callable[[GroupSignals], FloatArray]


def affected_groups(run: PreparedRun, values: Values) -> list[GroupSignals]:
    """The motor groups whose transducers a shape speaks of."""
    return [g for g, spoken in zip(run.groups, spoken_of(run, values), strict=True) if spoken]


def spoken_of(run: PreparedRun, values: Values) -> list[bool]:
    """Whether a shape speaks of each motor group of a run."""
    which, driving = values["groups"], BESIDE if len(run.groups) > 1 else ALONE
    return [which == ALL or which in ((BALANCING, driving) if g.balances else (OTHER,)) for g in run.groups]


def group_columns(law: GroupLaw, run: PreparedRun, values: Values) -> FloatArray:
    """Sum of a law over the affected motor groups, N m at the shaft, shape (samples, 1)."""
    return sum((law(g) for g in affected_groups(run, values)), np.zeros(len(run.time)))[:, None]


def group_shapes(runs: Sequence[PreparedRun]) -> list[Shape]:
    """Which transducers are off: all alike, or, with several groups about, those of one side alone."""
    shapes = [Shape("all groups", {"groups": ALL})]
    if any(len(run.groups) > 1 for run in runs):
        shapes.append(Shape("the driving group", {"groups": BALANCING}))
        shapes.append(Shape("the passive group", {"groups": OTHER}, carried=True))
    return shapes


def driving_alone(runs: Sequence[PreparedRun]) -> tuple[str, ...]:
    """Names of the groups that close the balance of runs without a passive one."""
    return tuple(sorted({run.groups[0].name for run in runs if len(run.groups) == 1}))


def own_group_shapes(runs: Sequence[PreparedRun]) -> list[Shape]:
    """Where heave compensation drives by another group than hoisting, either of the two alone; else none."""
    alone = driving_alone(runs)
    beside = sorted({g.name for run in runs if len(run.groups) > 1 for g in run.groups if g.balances})
    if not alone or not beside or set(alone) & set(beside):
        return []
    return [
        Shape(f"the {' and '.join(names)} group alone", {"groups": which})
        for names, which in ((alone, ALONE), (beside, BESIDE))
    ]


def groups_of(shape: Shape, sides: Sides) -> tuple[str, ...]:
    """Names of the motor groups that a shape speaks of; none stands for all."""
    beside = tuple(name for name in sides.balancing if name not in sides.alone)
    named = {ALL: (), BALANCING: sides.balancing, OTHER: sides.passive, ALONE: sides.alone, BESIDE: beside}
    return named[shape.values["groups"]]
