"""Names that do not stand however well they fit: beside one law of the grammar that does by itself what they do, and
where their own law in the file has become another cause's."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial

import numpy as np
from scipy.special import fdtrc

from winch_friction.discrepancy.candidates.candidate import Estimates
from winch_friction.discrepancy.candidates.families import shapes_over
from winch_friction.discrepancy.candidates.friction import port
from winch_friction.discrepancy.candidates.signals import WEIGHT
from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.engine.chance import levels_of_runs
from winch_friction.discrepancy.engine.crossfit import CrossFit, Explanation, on_their_own
from winch_friction.discrepancy.engine.grammar import Factor, Scored
from winch_friction.discrepancy.engine.problem import of_base, shares_by_run
from winch_friction.discrepancy.engine.selection import Selection
from winch_friction.discrepancy.proof import Trial, at_the_floor
from winch_friction.discrepancy.proposals import near_laws
from winch_friction.discrepancy.regressors import PORT
from winch_friction.discrepancy.search import refused
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.discrepancy.vocabulary import FALLING, PICKING, RISING, UNLIKE_A_CURVE

ABOUT_NOTHING = 0.5  # widths of a hump, up to which its middle may be away from zero: there it is nine tenths as high
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


def no_port(parameters: Mapping[str, Estimates]) -> str:
    """Why a port's loss, of its law among the `parameters` of the written file, is none; empty where it is one.

    The search asks the same of the shapes that it tries, but the file is fitted to the end.
    """
    found = {name: each.value for name, each in parameters.get(PORT, {}).items()}
    if port(found):
        return ""
    n, m = (next(v for name, v in found.items() if name.startswith(of)) for of in ("n_", "m_"))
    return f"{PORT}: a loss with speed^{n:.3g} and displacement^{m:.3g} is no port's, but of one group's flow"


def told_by_chance(trial: Trial) -> str:
    """Why a name does not stand that adds to each run a share of its load and nothing besides; empty where none does.

    A load cell that is off by another amount in each run makes the run what is independent, however many segments
    show it: by an F test over the runs, for as many laws as may add to a load, the name has to take surely more of
    the runs' levels than it would of levels drawn anew. The one tolerance that the base grants takes a degree of
    freedom, as every amount of such a name does. More than cells are off by is no cell's, and with few runs nobody
    can tell.
    """
    search, least = trial.search, trial.holdout.least_noise
    if WEIGHT not in search.cross.problem.base.names:
        return ""
    names = [run.name for side in (trial.train, trial.holdout) for run in side.runs]
    cross = search.expansion.cross(names, search.explanation.slots)
    problem = cross.problem
    slots = [search.expansion.layout.slot_like(each) for each in search.explanation.slots]
    laws = len({(each.name, each.law) for each in problem.slots if not each.origin[0].opposing})
    full = cross.explain(slots)
    adding = [each for each in slots if not each.origin[0].opposing and _adds_levels(cross, full, each, least)]
    for slot in adding:
        rest = cross.explain([each for each in slots if each is not slot])
        without, left = (levels_of_runs(cross.remainder(each), problem.blocks) for each in (rest, full))
        degrees, free = len(slot.columns), len(left) - sum(len(each.columns) for each in adding) - 1
        if len(left) < LIMITS.fewest_levels or free < 1:
            continue
        before, after = (float(np.sum(np.square([*each.values()]))) for each in (without, left))
        chance = fdtrc(degrees, free, max(before - after, 0.0) / degrees / max(after / free, 1e-12))
        if laws * chance > LIMITS.level_p:
            kept = f"{100 * after / before:.0f} % of what the levels of {len(left)} runs are without it"
            return f"{slot.name}: adds to each run's load alone and keeps {kept}, which load cells off by chance do"
    return ""


def _adds_levels(cross: CrossFit, full: Explanation, slot: Slot, least: float) -> bool:
    """Whether a name adds to each run a share of its load that load cells may be off by, and beside these less than no
    balance closes, `least`, in the gap's unit."""
    problem, blocks = cross.problem, cross.problem.blocks
    if (weight := of_base(problem, WEIGHT)) is None:
        return False
    amounts = dict(zip(problem.columns(full.slots), full.beta, strict=True))
    torque = sum(blocks.x[:, c] * amounts[c] for c in problem.columns([slot])[len(problem.base.names) :])
    shares, rest = shares_by_run(np.asarray(torque), weight, blocks.run)
    of_cells = np.sqrt(np.mean(shares**2)) <= LIMITS.most_level  # a gain that is the same in all runs is no chance
    return bool(of_cells and np.sqrt(np.mean(rest**2)) <= least)


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
    alike = law.opposing == (candidate.term is not None and candidate.term.opposing)
    own = {_SAME.get(name, name) for name in candidate.signals} if alike else set()
    unlike = {*map(_kind, law.factors)} & set(UNLIKE_A_CURVE)
    bent = all(_bends_as(factor, scored, slot.name) for factor in law.factors)
    return set(law.signals) <= own and unlike <= ({"lag"} if closed else set()) and bent


def _kind(factor: Factor) -> str:
    """The kind of a factor; a hump about nearly nothing only falls, as Stribeck's curve does in its Gaussian form."""
    at = dict(factor.constants)
    return "fade" if factor.kind == "hump" and at["c"] < ABOUT_NOTHING * at["h"] else factor.kind


def _bends_as(factor: Factor, scored: Scored, cause: str) -> bool:
    """Whether a factor rises or falls as a cause's curves over its signal may; of what the catalogue draws no curve of
    there is nothing to say, nor of two factors that a negative amount belongs to.
    """
    names = (name for name, word in _SAME.items() if word == factor.signal)
    shapes = set().union(*(shapes_over(cause, name) for name in (factor.signal, *names)))
    turned = scored.amount < 0.0 and (len(scored.law.factors) == 1 or factor.kind == "about")
    kind = _kind(factor)
    rises = (kind in RISING) != turned
    if not shapes or kind not in (*RISING, *FALLING):
        return True
    if shapes == {"convex_rising"} and kind == "root" and rises:
        return False
    return shapes != {"falling"} if rises else "falling" in shapes


def _has_laws(slot: Slot, cross: CrossFit) -> bool:
    """Whether its cause is known under more laws than one: viscous friction of another power is no viscous friction; an
    error of signals or load has any."""
    laws = {each.law for each in cross.problem.slots if each.name == slot.name}
    return slot.free or slot.origin[0].term is None or len(laws) > 1
