"""From the selection and what it leaves to one of four verdicts."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from winch_friction.discrepancy.crossfit import CrossFit, Explanation
from winch_friction.discrepancy.omnibus import SIGNIFICANCE, Dependence, remainder
from winch_friction.discrepancy.problem import UNBOUNDED
from winch_friction.discrepancy.selection import Found, Selection

NOTHING, MISSING, AMBIGUOUS, UNEXPLAINED = "nothing_missing", "missing_effect", "ambiguous", "unexplained"
LEAST_UNEXPLAINED = 0.08  # share of the remainder that one signal must predict when no effect was found
LEFT_OVER = 0.15  # share of the excess over the noise floor that a named effect may leave
LEAST_EXCESS = 0.35  # of the noise variance: less than that above the floor is nobody's effect
OBVIOUS_EXCESS = 1.5
NEVER_NOISE = 3.0  # twice the noise is something, whether a signal predicts it or not
LARGE_EXCESS, SMALL_LEFT_OVER = 2.0, 0.04  # a smaller share counts where it is far above the noise
STEADY, FEWEST_STEADY = 0.03, 300  # share of the largest acceleration; blocks
MOST_NAMED = 2  # besides base terms that the model simply lacks


@dataclass(frozen=True)
class Verdict:
    """The verdict, and in words why an explanation was refused."""

    kind: str
    refused: str = ""


def decide(cross: CrossFit, selection: Selection, left: Sequence[Dependence], rippled: bool = False) -> Verdict:
    """`left`: what signals predict of the final explanation's remainder; `rippled`: a ripple may be part of it."""
    before, excess = _steady_excess(cross, selection.base), _steady_excess(cross, selection.final)
    before = max(before, 1e-9)
    depends = [d for d in left if d.p_value <= SIGNIFICANCE]
    if not selection.found:
        strong = any(d.share >= LEAST_UNEXPLAINED for d in depends) or (before > NEVER_NOISE and not rippled)
        return Verdict(UNEXPLAINED, "no named effect explains it") if strong else Verdict(NOTHING)
    implausible = [f.slot.candidate.name for f in selection.found if _at_bound(cross, selection, f)]
    if implausible:
        return Verdict(UNEXPLAINED, f"{implausible[0]} would need an implausible size")
    if len([f for f in selection.found if not _plain_term(cross, f)]) > MOST_NAMED:
        return Verdict(UNEXPLAINED, f"it would take {len(selection.found)} effects at once to imitate it")
    remains = excess > LEAST_EXCESS and excess / before > LEFT_OVER
    remains |= excess > LARGE_EXCESS and excess / before > SMALL_LEFT_OVER
    obvious = excess > OBVIOUS_EXCESS or any(d.share >= 0.5 * LEAST_UNEXPLAINED for d in depends)
    count = float(cross.problem.grams.count.sum())
    floor = count + cross.unresolved
    whole = (selection.final.loss - floor) / count
    whole_before = max((selection.base.loss - floor) / count, 1e-9)
    elsewhere = whole > LEAST_EXCESS and whole / whole_before > LEFT_OVER
    elsewhere &= any(d.share >= LEAST_UNEXPLAINED for d in depends)
    if (remains and obvious) or elsewhere:
        excess, before = max((excess, before), (whole, whole_before), key=lambda pair: pair[0] / pair[1])
        names = ", ".join(f.slot.candidate.name for f in selection.found)
        return Verdict(UNEXPLAINED, f"{names} leaves {100 * excess / before:.0f} % of the gap above the noise floor")
    return Verdict(AMBIGUOUS if any(f.rivals for f in selection.found) else MISSING)


def _steady_excess(cross: CrossFit, explanation: Explanation) -> float:
    """Excess of the remainder over the noise variance where the shaft hardly accelerates.

    There the balance holds whatever swings on the wire or rings in the oil, which no friction model is to answer for.
    """
    left = remainder(cross, explanation)
    acceleration = np.abs(cross.problem.blocks.features["acceleration"])
    steady = acceleration <= STEADY * np.percentile(acceleration, 99)
    chosen = steady if steady.sum() >= FEWEST_STEADY else np.ones_like(steady)
    return float(np.mean(left[chosen] ** 2 - 1.0 - cross.problem.unresolved[chosen]))


def _at_bound(cross: CrossFit, selection: Selection, found: Found) -> bool:
    columns = list(cross.problem.columns(selection.final.slots))
    most = found.slot.candidate.plausible
    if _plain_term(cross, found):
        return False
    return any(abs(selection.final.beta[columns.index(c)]) >= 0.999 * most for c in found.slot.columns)


def _plain_term(cross: CrossFit, found: Found) -> bool:
    """A plain term that the model lacked from the start: several of them may be missing without being an imitation."""
    return all(cross.problem.upper[column] >= UNBOUNDED for column in found.slot.columns)
