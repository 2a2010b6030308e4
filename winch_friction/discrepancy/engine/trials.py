"""Candidates put beside what is taken already: of each law its best variant, of each family its best law."""

from collections.abc import Container, Sequence

from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.engine.crossfit import CrossFit, Explanation
from winch_friction.discrepancy.thresholds import LIMITS


def candidate_trials(cross: CrossFit, current: Explanation, taken: Container[str]) -> list[Explanation]:
    """Every candidate that is not taken added to the set: of each law the variant that fits the training runs best, of
    each family the law that does best on held-out runs.
    """
    slots = fitted(cross, current.slots, taken)
    return heads(cross, current.loss, [cross.explain((*current.slots, slot)) for slot in slots])


def fitted(cross: CrossFit, rest: Sequence[Slot], taken: Container[str], by_part: bool = False) -> list[Slot]:
    """Of each law of each candidate, with `by_part` of each of the things that it may speak of, the variant that fits
    the training runs best beside the rest."""
    best: dict[tuple[str, str, str], tuple[float, Slot]] = {}
    for slot in cross.problem.slots:
        if slot.name in taken:
            continue
        loss, _ = cross.train_loss((*rest, slot))
        key = (slot.name, slot.law, slot.part if by_part else "")
        if key not in best or loss < best[key][0]:
            best[key] = (loss, slot)
    return [slot for _, slot in best.values()]


def heads(cross: CrossFit, before: float, trials: Sequence[Explanation]) -> list[Explanation]:
    """The best member of each family by held-out loss; a free one only where no law does nearly as well."""
    families: dict[str, list[Explanation]] = {}
    for trial in sorted(trials, key=lambda each: charged(before, each.loss, each.slots[-1])):
        families.setdefault(trial.slots[-1].name, []).append(trial)
    return [_head(cross, members) for members in families.values()]


def _head(cross: CrossFit, members: Sequence[Explanation]) -> Explanation:
    """Of one cause's laws, the best first, that which speaks for it: the first, or the curve that leaves less than half
    of what that one leaves above the floor, if this is more than nothing.

    Between two causes flexibility costs a share of what is explained, for it imitates; within one it is how a law
    differs from the literature's, and what counts is what is left.
    """
    first = members[0]
    left = first.loss - cross.floor
    if first.slots[-1].free or left <= LIMITS.least_excess * float(cross.problem.grams.count.sum()):
        return first
    closer = min((each for each in members if each.slots[-1].free), key=lambda each: each.loss, default=first)
    return closer if closer.loss - cross.floor < LIMITS.outdone * left else first


def charged(before: float, after: float, own: Slot) -> float:
    """Held-out loss, of which a flexible member has to give back a share of what it saves, and whatever is not plain
    the least share that decides between two that do the same, for each of its parameters."""
    share = LIMITS.free_charge if own.free else 0.0 if own.plain else LIMITS.plain_first * len(own.columns)
    return after + share * max(before - after, 0.0)
