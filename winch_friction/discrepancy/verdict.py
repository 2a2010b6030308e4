"""From the selection and what it leaves to a verdict; a fifth, `insufficient`, is given before any search."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from winch_friction.discrepancy.engine.crossfit import CrossFit, Explanation
from winch_friction.discrepancy.engine.omnibus import Dependence
from winch_friction.discrepancy.engine.selection import Selection
from winch_friction.discrepancy.thresholds import LIMITS

NOTHING, MISSING, AMBIGUOUS, UNEXPLAINED = "nothing_missing", "missing_effect", "ambiguous", "unexplained"
INSUFFICIENT = "insufficient"


@dataclass(frozen=True)
class Verdict:
    """The verdict, and in words why an explanation was refused."""

    kind: str
    refused: str = ""
    leaves: bool = False  # refused for nothing but what the names leave of the training runs


def decide(cross: CrossFit, selection: Selection, left: Sequence[Dependence], rippled: bool = False) -> Verdict:
    """`left`: what signals predict of the final explanation's remainder; `rippled`: a ripple may be part of it."""
    before, after = steady_excess(cross, selection.base), steady_excess(cross, selection.final)
    before = max(before, 1e-9)
    depends = telling(cross, left)
    if not selection.found:
        strong = any(d.share >= LIMITS.least_unexplained for d in depends) or (
            before > LIMITS.never_noise and not rippled
        )
        return Verdict(UNEXPLAINED, "no named effect explains it") if strong else Verdict(NOTHING)
    implausible = [f.slot for f in selection.found if cross.at_bound(selection.final, f.slot)]
    if implausible:
        times = "" if implausible[0].plain else f", {implausible[0].most:g} times what is typical or more"
        return Verdict(UNEXPLAINED, f"{implausible[0].name} would need an implausible size{times}")
    # plain terms that a bare model lacked from the start: several of them may be missing without being an imitation
    if len({f.slot.name for f in selection.found if not f.slot.plain}) > LIMITS.most_named:
        return Verdict(UNEXPLAINED, f"it would take {len(selection.final.names)} effects at once to imitate it")
    whole, whole_before = cross.excess(selection.final), max(cross.excess(selection.base), 1e-9)
    elsewhere = whole > LIMITS.least_excess and whole / whole_before > LIMITS.left_over
    elsewhere &= any(d.share >= LIMITS.least_unexplained for d in depends)
    if keeps_something(after, before, depends) or elsewhere:
        after, before = max((after, before), (whole, whole_before), key=lambda pair: pair[0] / pair[1])
        names = ", ".join(selection.final.names)
        why = f"{names} leaves {100 * after / before:.0f} % of the gap above the noise floor"
        return Verdict(UNEXPLAINED, why, leaves=True)
    return Verdict(AMBIGUOUS if any(f.rivals for f in selection.found) else MISSING)


def telling(cross: CrossFit, left: Sequence[Dependence]) -> list[Dependence]:
    """Of what signals predict of a remainder that which is sure and large enough to matter to anybody."""
    return [d for d in left if d.p_value <= LIMITS.remainder_p and d.size >= cross.problem.matters]


def keeps_something(excess: float, before: float, depends: Sequence[Dependence]) -> bool:
    """Whether what an explanation leaves above the noise is more than it may: a share of the excess `before` that is
    large in itself or hangs on a signal."""
    remains = excess > LIMITS.least_excess and excess / before > LIMITS.left_over
    remains |= excess > LIMITS.large_excess and excess / before > LIMITS.small_left_over
    return remains and (
        excess > LIMITS.obvious_excess or any(d.share >= 0.5 * LIMITS.least_unexplained for d in depends)
    )


def steady_excess(cross: CrossFit, explanation: Explanation) -> float:
    """Excess of the remainder over the noise variance where the shaft hardly accelerates.

    There the balance holds whatever swings on the wire or rings in the oil, which no friction model is to answer for.
    """
    left = cross.remainder(explanation)
    acceleration = np.abs(cross.problem.blocks.features["acceleration"])
    steady = acceleration <= LIMITS.steady * np.percentile(acceleration, 99)
    chosen = steady if steady.sum() >= LIMITS.fewest_steady else np.ones_like(steady)
    return float(np.mean(left[chosen] ** 2 - 1.0 - cross.problem.unresolved[chosen]))
