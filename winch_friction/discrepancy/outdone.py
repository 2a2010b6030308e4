"""Names that do not stand, however well they fit, beside what does by itself what they do: one law of the grammar, load
cells that repeat no better, a refit, or a choice of the runs.
"""

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from winch_friction.discrepancy.answer import Side
from winch_friction.discrepancy.candidates.families import shapes_over
from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.engine.crossfit import CrossFit, Explanation, on_their_own
from winch_friction.discrepancy.engine.grammar import Factor, Scored
from winch_friction.discrepancy.engine.selection import Selection
from winch_friction.discrepancy.proof import Trial, at_the_floor, far_off
from winch_friction.discrepancy.proposals import near_laws
from winch_friction.discrepancy.run_states import EACH_RUN, SINCE, SOME_RUNS
from winch_friction.discrepancy.search import refused
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.discrepancy.vocabulary import FALLING, PICKING, RISING, UNLIKE_A_CURVE

SURE = 3.0  # standard deviations of an amount, in a file, that surely is one
WEIGHT = "weight"  # the tolerance of the load
# signals of an equation by the proposals' word for them
_SAME = {"speed_magnitude": "motor_speed", "pressure_sum": "pressure"}


def one_law(trial: Trial, train: Sequence[str], rng: np.random.Generator) -> str:
    """Why the names of a trial do not stand beside one law that is none of theirs; empty where they do.

    Of hundreds of laws one that picks the right runs always leaves a little less of those it was chosen on: where one
    name leaves the locked runs at their floor such are asked only if they leave next to nothing of what it leaves.
    """
    search = trial.search
    closed = len({slot.name for slot in on_their_own(search.explanation.slots)}) == 1 and _closed(trial, rng)
    laws = _asked(partial(near_laws, search, train, rng), search.cross, search.selection.final, closed)
    return outdone(laws, search.cross, search.selection, closed)


def _closed(trial: Trial, rng: np.random.Generator) -> bool:
    """Whether names leave the locked runs at their floor, and of the training runs no more than the verdict allows.

    A few locked runs do not vouch for what the many others refuse: a name whose company was dropped may leave in these
    a third of the gap, for which it would never have been given by itself.
    """
    return at_the_floor(trial.holdout) and not refused(trial.search, rng)


def outdone(laws: Sequence[Scored], cross: CrossFit, selection: Selection, closed: bool = False) -> str:
    """Why names do not stand beside a law of the grammar; empty where they do.

    Several names, and a curve, fall where one law does as much; one name of a given law, or one that has `closed` the
    locked gap down to its floor, only where the other takes half of what it leaves. A law that a name's own could be
    speaks for it, if the first of the `laws` does not take half of what that one leaves.
    """
    named = selection.final
    slots = on_their_own(named.slots)
    if not laws or not slots:
        return ""
    law = laws[0]
    one = len({slot.name for slot in slots}) == 1
    given = one and not any(slot.free for slot in slots)
    left, left_by_law = _above_floor(cross, named.loss), _above_floor(cross, law.loss)
    if left_by_law >= LIMITS.outdone * left if given or closed else left_by_law > left:
        return ""
    if one:
        rivals = [slot for found in selection.found for slot in (found.slot, *found.rivals)]
        many = [slot for slot in rivals if _has_laws(slot, cross)]
        own = [each.loss for each in laws if any(_could_be(each, slot, closed) for slot in many)]
        if own and left_by_law >= LIMITS.outdone * _above_floor(cross, min(own)):
            return ""
    names = " and ".join(dict.fromkeys(slot.name for slot in slots))
    together = "" if one else "together "
    return f"one law of {' and '.join(law.law.signals)} does by itself more than {names} {together}would explain"


def within_load_cells(cross: CrossFit, fitted: Sequence[Explanation], least: float) -> str:
    """Why a name is none that adds to each run's load what its cell is off by, one of these; empty where none does.

    Together with what the base grants it is within a calibrated cell's tolerance in the mean of the runs, about which
    it scatters by no more than cells repeat to (of a dozen draws the root mean square is beyond 1.5 sigma once in a
    hundred), and beside such levels it is less than no balance closes, `least`, in the gap's unit. Of a dozen runs
    whose cells are off by so much some signal of one value in each tells the order.
    """
    problem, blocks = cross.problem, cross.problem.blocks
    at, count = problem.base.names.index(WEIGHT), len(problem.base.names)
    repeats = LIMITS.at_the_floor * LIMITS.least_share_of_load
    weight = blocks.x[:, at] / problem.base.scale[at]
    weighed = [blocks.run == run for run in np.unique(blocks.run)]
    if not all((weight[own] != 0.0).any() for own in weighed):
        return ""
    for each in (one for one in fitted if one.slots):
        torque = blocks.x[:, list(problem.columns(each.slots)[count:])] @ each.beta[count:]
        shares = np.array([weight[own] @ torque[own] / (weight[own] @ weight[own]) for own in weighed])
        for own, share in zip(weighed, shares, strict=True):
            torque[own] -= share * weight[own]
        scatter = float(np.std(shares))
        level = abs(float(np.mean(shares)) + float(each.beta[at]) * problem.base.scale[at])
        most = float(problem.base.upper[at] * problem.base.scale[at])
        if scatter <= repeats and level <= most and float(np.sqrt(np.mean(torque**2))) <= least:
            return f"{100 * scatter:.2g} % of the load from run to run is what load cells repeat to, and no name"
    return ""


def may_be_none(slots: Sequence[Slot], full: Trial, refit: Trial) -> str:
    """Why a name is refused whose amounts are none of them sure, where a refit without it leaves the locked runs at
    their floor: what it takes of the others is chance."""
    if not at_the_floor(refit.holdout):
        return ""
    for slot in on_their_own(slots):
        found = full.repaired.parameters.get(slot.name, {})
        amounts = [found[p.name] for p in slot.origin[0].linear if p.name in found]
        if amounts and all(abs(each.value) < SURE * each.std for each in amounts):
            return f"{slot.name}: a refit without it leaves no more than noise, and its size may be none"
    return ""


def chosen_not_whole(slots: Sequence[Slot], locked: Side) -> str:
    """Why a name is refused that is there in chosen runs alone, where it leaves plainly more than noise: whatever is
    there in some runs, any law that may choose its runs takes a part of.

    Of such laws that were true, over four draws of drawn cranes, none left more than one and a half of the noise.
    """
    chosen = [slot.name for slot in on_their_own(slots) if slot.law in (SOME_RUNS, SINCE, EACH_RUN)]
    if not chosen or not far_off(locked):
        return ""
    left = f"{locked.size_after.value:.3g} where the noise is {locked.floor:.3g}"
    return f"{', '.join(chosen)}: a law that chooses its runs has to say all of it, and leaves {left}"


def _above_floor(cross: CrossFit, loss: float) -> float:
    """What a loss leaves above the noise; of nothing, nobody takes half."""
    return max(loss - cross.floor, 0.0)


def _asked(
    near: Callable[[Sequence[str]], list[Scored]], cross: CrossFit, named: Explanation, closed: bool
) -> list[Scored]:
    """The laws that a set of names is held against, `near` gives them without some kinds of factors."""
    laws = near(())
    left = LIMITS.surely_outdone * _above_floor(cross, named.loss)
    surely = laws and _above_floor(cross, laws[0].loss) < left
    return near(PICKING) if closed and laws and not surely else laws


def _could_be(scored: Scored, slot: Slot, closed: bool) -> bool:
    """Whether a law may be what a name's own term or correction draws: of signals that it reads, of their present
    value, acting as it acts and bent the way in which its cause's curves may bend.

    Where the name has closed the locked gap, a memory of the same signals says no more than how its law is inexact.
    """
    law, candidate = scored.law, slot.origin[0]
    own = {_SAME.get(name, name) for name in candidate.signals} if law.opposing == candidate.opposing else set()
    unlike = {factor.kind for factor in law.factors} & set(UNLIKE_A_CURVE)
    bent = all(_bends_as(factor, scored, slot.name) for factor in law.factors)
    return set(law.signals) <= own and unlike <= ({"lag"} if closed else set()) and bent


def _bends_as(factor: Factor, scored: Scored, cause: str) -> bool:
    """Whether a factor rises or falls as a cause's curves over its signal may; of what the catalogue draws no curve of
    there is nothing to say, nor of two factors that a negative amount belongs to.
    """
    names = (name for name, word in _SAME.items() if word == factor.signal)
    shapes = set().union(*(shapes_over(cause, name) for name in (factor.signal, *names)))
    turned = scored.amount < 0.0 and (len(scored.law.factors) == 1 or factor.kind == "about")
    rises = (factor.kind in RISING) != turned
    if not shapes or factor.kind not in (*RISING, *FALLING):
        return True
    if shapes == {"convex_rising"} and factor.kind == "root" and rises:
        return False
    return shapes != {"falling"} if rises else "falling" in shapes


def _has_laws(slot: Slot, cross: CrossFit) -> bool:
    """Whether its cause is known under more laws than one: viscous friction of another power is no viscous friction; an
    error of signals or load has any."""
    laws = {each.law for each in cross.problem.slots if each.name == slot.name}
    return slot.free or slot.origin[0].term is None or len(laws) > 1
