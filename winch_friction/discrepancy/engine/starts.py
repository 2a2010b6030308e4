"""Where else a search may begin, when adding one effect after the other has led where more than noise is left."""

from winch_friction.discrepancy.engine.crossfit import CrossFit, Explanation
from winch_friction.discrepancy.thresholds import LIMITS


def other_start(cross: CrossFit, current: Explanation) -> Explanation | None:
    """The set to begin from once more, the own law of the catalogue for its first cause alone, where this has another
    law and more than noise is left: a bent law takes what belongs to a second effect, and no exchange of one for one
    finds back."""
    if not current.slots or not current.slots[0].law or cross.excess(current) <= LIMITS.least_excess:
        return None
    own = [slot for slot in cross.problem.slots if slot.name == current.slots[0].name]
    trials = [cross.explain((slot,)) for slot in own if not slot.law and not slot.plain]
    return min(trials, key=lambda each: each.loss, default=None)


def far_less(cross: CrossFit, anew: Explanation, current: Explanation) -> bool:
    """Whether a set of no more laws leaves half of what another does at most, or one of more leaves noise.

    Laws and not causes: around two laws of one cause that leave more than noise the next preparation is no better.
    """
    few = len(anew.slots) <= len(current.slots) or cross.excess(anew) <= LIMITS.least_excess
    return few and anew.loss - cross.floor <= LIMITS.outdone * (current.loss - cross.floor)
