"""What a fit says of a cause, in the cause's own parameters and units."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from winch_friction.discrepancy.candidates.candidate import Estimates, ParameterEstimate, Sides
from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.engine.crossfit import CrossFit
from winch_friction.discrepancy.regressors import key_of
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.friction.correction import Correction

_Known = TypeVar("_Known")
STEP = 1e-3  # of an estimate: what of the corrections moves with it


def estimates_of(slot: Slot, value: FloatArray, std: FloatArray, cross: CrossFit) -> dict[str, ParameterEstimate]:
    """The amplitudes of an effect, and the shape parameters of its term."""
    candidate, shape = slot.origin
    found = {
        p.name: ParameterEstimate(float(v), float(s), p.unit)
        for p, v, s, c in zip(candidate.linear, value, std, slot.columns, strict=True)
        if candidate.term is not None or cross.total_g[c, c] > 0.0
    }
    if candidate.term is not None:
        units = {p.name: p.unit for p in candidate.term.parameters}
        for name, at in shape.values.items():
            found[name] = ParameterEstimate(float(at), LIMITS.shape_std * abs(float(at)), units[name])
    return found


def of_part(slot: Slot, slots: Sequence[Slot], found: Mapping[str, _Known]) -> Mapping[str, _Known]:
    """What is known of each parameter, under names of their own where the same cause has others for another part of the
    machine: a zero of one feedback and a zero of another are two numbers, and one of all of them is a third."""
    parts = {each.part for each in slots if each.name == slot.name}
    if len(parts) < 2:
        return found
    beside = ", beside that of all" if slot.part and "" in parts else ""
    return {f"{name} of {slot.label.partition(',')[0]}{beside}": each for name, each in found.items()}


def together(first: Estimates, second: Estimates) -> dict[str, ParameterEstimate]:
    """The estimates of a cause whose law is a mixture of two: what both of them have adds."""
    both = {
        name: ParameterEstimate(first[name].value + each.value, float(np.hypot(first[name].std, each.std)), each.unit)
        for name, each in second.items()
        if name in first
    }
    return {**first, **second, **both}


@dataclass(frozen=True)
class InFile:
    """The correction of a model that says an estimate: `factor` times it, more than the model had before."""

    key: str
    factor: float
    before: float

    def read(self, own: Correction, unit: str) -> ParameterEstimate:
        """The estimate as the correction has it now."""
        value, std = float(own.value - self.before) / self.factor, float(own.std or 0.0) / abs(self.factor)
        return ParameterEstimate(value, std, unit)


def in_file(slot: Slot, found: Estimates, sides: Sides, had: Mapping[str, Correction]) -> dict[str, InFile | None]:
    """Where a model says the estimates of an error of signals, geometry or load, of which it `had` some by key; None
    for those that go into several corrections, or share one."""
    candidate, shape = slot.origin
    if candidate.corrects is None:
        return dict.fromkeys(found)
    # as small as nothing: what is near a bound would be cut there, and only half of the step be seen
    small = {name: replace(each, value=STEP * each.value) for name, each in found.items()}
    made = candidate.corrects(small, shape, sides)
    slopes: dict[str, dict[str, float]] = {}
    for name, each in small.items():
        step = STEP * each.value or STEP * each.std
        moved = candidate.corrects({**small, name: replace(each, value=each.value + step)}, shape, sides)
        slopes[name] = {
            key_of(old): (new.value - old.value) / step
            for old, new in zip(made, moved, strict=True)
            if new.value != old.value
        }
    places: dict[str, InFile | None] = {}
    for name, own in slopes.items():
        key, factor = next(iter(own.items()), ("", 0.0))
        alone = len(own) == 1 and sum(key in other for other in slopes.values()) == 1
        places[name] = InFile(key, factor, had[key].value if key in had else 0.0) if alone else None
    return places


def agreed(first: Mapping[str, InFile | None], second: Mapping[str, InFile | None]) -> dict[str, InFile | None]:
    """Where the estimates of a cause with two laws stand: what both of them have is one estimate, in one correction;
    None, which leaves it as the search had it, where they are in two."""
    both = {name: place if first[name] == place else None for name, place in second.items() if name in first}
    return {**first, **second, **both}
