"""What a fit says of a cause, in the cause's own parameters and units."""

from collections.abc import Sequence

import numpy as np

from winch_friction.discrepancy.candidates.candidate import Estimates, ParameterEstimate
from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.engine.crossfit import CrossFit
from winch_friction.discrepancy.thresholds import LIMITS


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


def of_part(slot: Slot, slots: Sequence[Slot], found: Estimates) -> Estimates:
    """The estimates under names of their own where the same cause has others for another part of the machine: a zero
    of one feedback and a zero of another are two numbers."""
    if len({each.part for each in slots if each.name == slot.name}) < 2:
        return found
    return {f"{name} of {slot.label.partition(',')[0]}": each for name, each in found.items()}


def together(first: Estimates, second: Estimates) -> dict[str, ParameterEstimate]:
    """The estimates of a cause whose law is a mixture of two: what both of them have adds."""
    both = {
        name: ParameterEstimate(first[name].value + each.value, float(np.hypot(first[name].std, each.std)), each.unit)
        for name, each in second.items()
        if name in first
    }
    return {**first, **second, **both}
