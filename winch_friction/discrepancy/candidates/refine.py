"""A finer grid around the shape that was found: what a coarse one leaves over must not pass for a second effect."""

import itertools
from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import partial

from winch_friction.discrepancy.candidates.candidate import Candidate, Variant
from winch_friction.discrepancy.preparation.prepared_run import PreparedRun

STEPS = (1.0 / 6.0, 2.0 / 6.0, 3.0 / 6.0, 4.0 / 6.0, 5.0 / 6.0)  # of the way to the neighbour, in the logarithm


def refined(candidate: Candidate, variant: Variant) -> Candidate:
    """The candidate with more shapes around one of its own; itself where it has no grid to refine."""
    if not candidate.continuous:
        return candidate
    return replace(candidate, shapes=partial(_finer, candidate, variant), continuous=())


def _finer(candidate: Candidate, variant: Variant, runs: Sequence[PreparedRun]) -> list[Variant]:
    given = candidate.shapes(runs)
    axes = {name: _between(variant.shape[name], (v.shape[name] for v in given)) for name in candidate.continuous}
    points = itertools.product(*axes.values())
    shapes = [{**variant.shape, **dict(zip(axes, point, strict=True))} for point in points]
    return given + [replace(variant, label=_label(shape), shape=shape) for shape in shapes if shape != variant.shape]


def _between(value: float, grid: Iterable[float]) -> list[float]:
    """The value and what lies between it and its neighbours; past the end, as far as on the other side."""
    values = sorted(set(grid))
    if len(values) < 2:
        return [value]
    k = values.index(value)
    up = values[k + 1] / value if k + 1 < len(values) else value / values[k - 1]
    down = values[k - 1] / value if k > 0 else value / values[k + 1]
    return [value, *(value * ratio**step for ratio in (down, up) for step in STEPS)]


def _label(shape: dict[str, float]) -> str:
    return ", ".join(f"{name} = {value:g}" for name, value in shape.items())
