"""Rivals of what was found: effects that do as well in its place on held-out data."""

from collections.abc import Sequence

import numpy as np

from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.engine.crossfit import CrossFit, Explanation, flip_p_values
from winch_friction.discrepancy.engine.trials import charged, fitted, heads
from winch_friction.discrepancy.thresholds import LIMITS


def rivals_of(
    cross: CrossFit, current: Explanation, without: Explanation, k: int, rng: np.random.Generator, same: bool = False
) -> tuple[tuple[Slot, ...], float]:
    """Effects that do as well in the place of the k-th, the best first and laws before curves; and how often it wins
    when segments are redrawn.

    With `same` only what is the same column in these runs, such as a tare at one load and a torque offset.
    """
    rest = current.slots[:k] + current.slots[k + 1 :]
    own = current.slots[k]
    slots = fitted(cross, rest, current.names)
    every = [cross.explain((*rest, slot)) for slot in slots]
    trials = heads(cross, without.loss, every)
    if own.free:  # of each cause the law that speaks for it, and a curve of its own that leaves less
        trials += [each for each in _closest(every) if all(each is not head for head in trials)]
    equal: list[tuple[float, Slot]] = []
    for trial in trials:
        alike = abs(trial.loss - current.loss) <= LIMITS.plain_first * (without.loss - current.loss)
        rival = does_as_well(trial, current, without, rng) or _near_curve(cross, trial, current, without, k)
        taken = trial.slots[-1].name in {slot.name for _, slot in equal}
        if not taken and (alike if same else rival):
            equal.append((charged(without.loss, trial.loss, trial.slots[-1]), trial.slots[-1]))
    equal.sort(key=lambda pair: pair[0])
    frequency = 1.0 if same else _frequency(current.losses, [t.losses for t in trials], rng)
    return tuple(slot for _, slot in equal if slot is not own), frequency


def _closest(trials: Sequence[Explanation]) -> list[Explanation]:
    """Of each cause's laws the one that leaves least."""
    found: dict[str, Explanation] = {}
    for trial in sorted(trials, key=lambda each: each.loss):
        found.setdefault(trial.slots[-1].name, trial)
    return list(found.values())


def _near_curve(cross: CrossFit, trial: Explanation, current: Explanation, without: Explanation, k: int) -> bool:
    """Whether the k-th effect is a curve and a law of another cause leaves less than twice as much above the floor: a
    curve outdoes laws by its flexibility, of its own cause as well as of others.
    """
    if not current.slots[k].free or trial.slots[-1].free:
        return False
    if without.loss - trial.loss < LIMITS.rival_worth * (without.loss - current.loss):
        return False
    return LIMITS.outdone * (trial.loss - cross.floor) <= current.loss - cross.floor


def near(cross: CrossFit, current: Explanation) -> list[Slot]:
    """What stands in for one of a set's effects nearly as well: worth a closer look at its shape before it is said not
    to be a rival."""
    found: list[Slot] = []
    for k in (k for k, slot in enumerate(current.slots) if not slot.plain):  # what is plain comes first anyhow
        rest = current.slots[:k] + current.slots[k + 1 :]
        without = cross.explain(rest)
        worth = without.loss - current.loss
        trials = [cross.explain((*rest, slot)) for slot in fitted(cross, rest, current.names)]
        trials = [each for each in trials if without.loss - each.loss >= LIMITS.rival_worth * worth]
        found += [each.slots[-1] for each in sorted(trials, key=lambda one: one.loss)[: LIMITS.looked_at_closer]]
    return found


def does_as_well(trial: Explanation, current: Explanation, without: Explanation, rng: np.random.Generator) -> bool:
    """Whether another effect in the place of one, `without` neither, is no worse on held-out data."""
    worth = without.loss - current.loss
    worse = trial.losses - current.losses
    if without.loss - trial.loss < LIMITS.rival_worth * worth:
        return False
    return bool(flip_p_values(worse[None], rng)[0] > LIMITS.rival_p or worse.sum() < LIMITS.rival_share * worth)


def _frequency(own: FloatArray, others: Sequence[FloatArray], rng: np.random.Generator, draws: int = 200) -> float:
    if not others:
        return 1.0
    weights = rng.multinomial(len(own), np.full(len(own), 1.0 / len(own)), size=draws)
    rival = (weights @ np.array(others).T).min(axis=1)
    return float(np.mean(weights @ own <= rival * (1.0 + 1e-12)))
