"""Where else a search may begin, when adding one effect after the other has led where more than noise is left."""

import itertools

from winch_friction.discrepancy.engine.crossfit import CrossFit, Explanation
from winch_friction.discrepancy.engine.trials import fitted
from winch_friction.discrepancy.thresholds import LIMITS


def other_starts(cross: CrossFit, current: Explanation) -> list[Explanation]:
    """Sets to begin from once more; none where the current one leaves no more than noise."""
    if not current.slots or cross.excess(current) <= LIMITS.least_excess:
        return []
    return [*_part_by_part(cross, current), *_by_own_law(cross, current)]


def _by_own_law(cross: CrossFit, current: Explanation) -> list[Explanation]:
    """Where its first cause has another law than the catalogue's own: that one alone. A bent law takes what belongs to
    a second effect, and no exchange of one for one finds back."""
    if not current.slots[0].law:
        return []
    first = current.slots[0]
    own = [slot for slot in cross.problem.slots if slot.name == first.name and not slot.law and not slot.plain]
    trials = [cross.explain((slot,)) for slot in own]
    return [min(trials, key=lambda each: each.loss)] if trials else []


def _part_by_part(cross: CrossFit, current: Explanation) -> list[Explanation]:
    """Each of its causes that speaks of a part of the machine, with a law for that part and a law for another: two
    feedbacks that are off seldom follow one law, and what is best for one alone need not be its law beside the other.
    """
    starts = []
    for name in current.names:
        own = fitted(cross, (), {slot.name for slot in cross.problem.slots} - {name}, by_part=True)
        parts = [slot for slot in own if slot.part]
        pairs = [pair for pair in itertools.combinations(parts, 2) if pair[0].part != pair[1].part]
        if pairs:
            starts.append(min((cross.explain(pair) for pair in pairs), key=lambda each: each.loss))
    return starts


def far_less(cross: CrossFit, anew: Explanation, current: Explanation) -> bool:
    """Whether a set of no more laws leaves half of what another does at most, or one of more leaves noise; of fewer
    causes it need only leave less.

    Laws and not causes: around two laws of one cause that leave more than noise the next preparation is no better.
    """
    if len(anew.names) < len(current.names) and anew.loss <= current.loss:
        return True
    few = len(anew.slots) <= len(current.slots) or cross.excess(anew) <= LIMITS.least_excess
    return few and anew.loss - cross.floor <= LIMITS.outdone * (current.loss - cross.floor)
