"""Which mistake would make these runs this crane's? All are scored alike; the least score wins.

Two mistakes at once, a unit beside a sign, ports beside a delay, are asked for where no single one makes the runs fit.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from winch_friction.commissioning.balance import EFFECTIVE, closure, static_torque, typical_friction
from winch_friction.commissioning.kinematics import (
    CONTRADICTS,
    SURE,
    Agreement,
    Fit,
    agreements,
    excesses,
    range_score,
)
from winch_friction.commissioning.mistakes import MOST_FALLS, RARELY, Mistake, delayed, fixed_mistakes, free_mistakes
from winch_friction.commissioning.view import RunView, select
from winch_friction.physics.channels import GRAVITY, RPM
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.winch.crane import Crane

# -- two mistakes at once
BOTH = 10.0  # prior cost of two mistakes beside those of each: as much as of a mistake that some of the runs hold
_WHOLE = ("hook_load", "motor_speed", "pressure", "displacement")  # channels of all groups and both ports


def both(first: Mistake, second: Mistake) -> Mistake:
    """Two mistakes as one: the first is undone, then the second."""
    return Mistake(
        "two", ", ".join(dict.fromkeys(filter(None, (first.channel, second.channel)))),
        f"two mistakes: {first.words}; and {second.words}", first.cost + second.cost + BOTH,
        lambda view: second.undo(first.undo(view)), parts=(first, second),
    )  # fmt: skip


def common_pairs(mistakes: Sequence[Mistake]) -> Iterator[Mistake]:
    """Each two of the common mistakes that do not concern the same thing: of those one alone may point elsewhere."""
    usual = [each for each in mistakes if each.cause in ("sign", "ports", "groups") or _is_usual_unit(each)]
    for first, second in combinations(usual, 2):
        if (first.cause, first.channel) != (second.cause, second.channel):
            yield both(first, second)


def _is_usual_unit(mistake: Mistake) -> bool:
    """A unit of a whole channel, not one of the rare ones."""
    rare = mistake.words.partition(" holds ")[2].startswith(RARELY)
    return mistake.cause == "unit" and mistake.channel in _WHOLE and not rare


# -- one mistake

COMPANION = 20.0  # prior cost of a wrong channel that only tells the speed again: above that of a mixed set of runs
NOTICED = 0.5  # of the score left: a mistake is worth naming only when it takes at least half away
MIXED = 10.0  # for a mistake that only some of the runs hold
ODD = 0.5  # of the worst score of a channel that tells the speed again: the runs in which it is wrong
EXACT = 0.05  # relative, by which a unit's factor is met: a layer's radius is off by 30 % at most
# what tells the speed again in another unit: (times the speed, in words)
UNITS = {
    "wire_out": ((1000.0, "mm under [m]"), (100.0, "cm under [m]"), (1.0 / 0.3048, "ft under [m]")),
    "shaft_angle": ((180.0 / np.pi, "deg under [rad]"), (0.5 / np.pi, "turns under [rad]")),
    "speed_reference": ((1.0 / RPM, "rpm under [rad/s]"), (RPM, "rad/s under [rpm]")),
}
PAID_OUT = tuple((n, f"the rope of {n} falls, where wire_out is the hook's depth") for n in range(2, MOST_FALLS + 1))
HELPED = 3.0  # a run holds a mistake when undoing it lowers the score by this
DELAYS = (0.3, 0.5, 0.7, 1.0, 1.5, 2.0, 2.8, 4.0)  # s, tried in both directions; a smaller one is for `gap` to name
PAIR_RUNS = 2  # on these every pair of mistakes is tried: there are hundreds
FIRSTS = 3  # single mistakes beside which any other is tried
FIRST_RUNS, FIRST_BLOCKS, FINALISTS = 4, 200, 8  # every mistake is tried on these, the best of them on all runs


@dataclass(frozen=True)
class Hypothesis:
    """A mistake against the data: `score` of all runs with it undone, by run, and the runs that hold it."""

    mistake: Mistake
    score: float
    scores: tuple[float, ...]
    runs: tuple[str, ...]


@dataclass(frozen=True)
class Diagnosis(Fit):
    """How the runs fit, and the hypotheses from the likeliest on."""

    hypotheses: tuple[Hypothesis, ...]

    @property
    def best(self) -> Hypothesis | None:
        """The likeliest mistake, where one takes away most of what does not fit."""
        first = self.hypotheses[0] if self.hypotheses else None
        if first is None or first.score > NOTICED * self.score:
            return None
        sure = self.score - first.score >= SURE and (_is_sure(first.mistake) or first.mistake.cause == "companion")
        return first if self.contradicting or sure else None


def _kinematics(view: RunView) -> tuple[int, int, int, float]:
    """What the agreement of a view rests on, by identity: a mistake put right makes new arrays of what it changes."""
    return id(view.speed), id(view.rates), id(view.radius), view.gear_ratio


def diagnose(
    fit: Fit, views: Sequence[RunView], crane: Crane, model: FrictionModel | None, others: Mapping[str, Crane]
) -> Diagnosis:
    """Score the runs, which `fit` as they stand, under every mistake where they contradict the crane, else under the
    sure ones."""
    scores, contradict = np.array(fit.scores), bool(fit.contradicting)
    bench = _Bench(views, scores, model)
    mistakes = [each for each in fixed_mistakes(views, crane, others) if contradict or _is_sure(each)]
    mistakes += [delayed(sign * d, crane.drive.hydraulic) for d in DELAYS for sign in (1.0, -1.0)]
    if contradict:
        mistakes += _free([v for v, s in zip(views, scores, strict=True) if s > CONTRADICTS])
    mistakes += _companions(views) if contradict or fit.score > SURE else []
    hypotheses = bench.ranked(mistakes)
    if contradict and (not hypotheses or max(hypotheses[0].scores) > CONTRADICTS):
        firsts = [each.mistake for each in hypotheses[:FIRSTS]]
        pairs = [*common_pairs(mistakes), *_beside(firsts, mistakes, views)]
        found = [each for each in bench.ranked(pairs, PAIR_RUNS) if max(each.scores) < CONTRADICTS]
        hypotheses = sorted([*found, *hypotheses], key=lambda each: each.score)
    return Diagnosis(**vars(fit), hypotheses=tuple(hypotheses))


def _beside(firsts: Sequence[Mistake], mistakes: Sequence[Mistake], views: Sequence[RunView]) -> list[Mistake]:
    """What may stand beside the likeliest mistakes: any other of the whole winch, and those whose number shows once
    these are undone; a delay, which takes whole records to try, beside the likeliest alone.
    """
    found: list[Mistake] = []
    for first in firsts:
        free = _free([first.undo(view) for view in views])
        late = [each for each in mistakes if each.cause == "delay" and first is firsts[0]]
        others = [
            each for each in mistakes if each.cause in ("sign", "ports", "groups", "unit") and "." not in each.channel
        ]
        found += [both(first, each) for each in (*others, *free, *late) if each.channel != first.channel]
    return found


def _is_sure(mistake: Mistake) -> bool:
    """Mistakes that no friction, no catalogue effect and no scale can look like; asked even where every run passes."""
    if mistake.channel == "motor_speed":
        return mistake.cause in ("unit", "sign")
    return mistake.cause in ("sign", "groups", "ports", "delay", "crane")


class _Bench:
    """Scores mistakes: all of them on the runs that fit worst, the best of these on every run."""

    def __init__(self, views: Sequence[RunView], as_is: np.ndarray, model: FrictionModel | None) -> None:
        self.views, self.as_is, self.model = views, as_is, model
        order = np.argsort(-as_is)
        self.worst = order.tolist()
        self._known: dict[tuple[int, int, int, float], tuple[RunView, list[Agreement]]] = {}
        self._know(views)

    def _know(self, views: Sequence[RunView]) -> None:
        """Keep how the channels of the views agree (with the views, whose identities are the keys): most mistakes leave
        them alone, and to compare them anew for each takes a fourth of a diagnosis."""
        self._known |= {_kinematics(view): (view, agreements(view)) for view in views}

    def _agreements(self, view: RunView) -> list[Agreement]:
        _, found = self._known.get(_kinematics(view)) or (view, agreements(view))
        return found

    def score(self, view: RunView) -> float:
        """`score_of`, with the agreements looked up where they are known."""
        agreed = sum(each.score for each in self._agreements(view))
        return closure(view, self.model).score + (agreed + range_score(view))

    def ranked(self, mistakes: Sequence[Mistake], runs: int = FIRST_RUNS) -> list[Hypothesis]:
        """The mistakes that are worth a look on every run, least score first; so many runs are tried first."""
        first = sorted(self.worst[:runs])
        whole = [self.views[k] for k in first]
        thin = [_thin(view) for view in whole]
        self._know(thin)

        def quick(mistake: Mistake) -> float:
            late = any(each.cause == "delay" for each in (mistake, *mistake.parts))
            views = whole if late else thin  # a shift of time needs the neighbours
            undone = np.array([self._undone(mistake, view) for view in views])
            some = float(np.minimum(undone, self.as_is[first]).sum()) + MIXED
            return mistake.cost + min(float(undone.sum()), some)

        kept = sorted(mistakes, key=quick)[:FINALISTS]
        return sorted((self._tried(each) for each in kept), key=lambda each: each.score)

    def _undone(self, mistake: Mistake, view: RunView) -> float:
        if mistake.parts:
            first, second = mistake.parts
            return self._undone(second, first.undo(view)) + _shrinking(first, view) + _both_shrink(first, second, view)
        if mistake.cause == "delay":  # a shift must not pass for agreement by losing the likeness to other channels
            follow = [each.channel for each in self._agreements(view)]
            shifted = mistake.undo(view)
            agreed = sum(each.score for each in agreements(shifted, follow))
            return closure(shifted, self.model).score + agreed + range_score(view)
        return self.score(mistake.undo(view)) + _shrinking(mistake, view)

    def _tried(self, mistake: Mistake) -> Hypothesis:
        undone = np.array([self._undone(mistake, view) for view in self.views])
        every, some = float(undone.sum()), float(np.minimum(undone, self.as_is).sum()) + MIXED
        held = undone < self.as_is - HELPED
        mixed = some < every and not held.all()
        scores = np.minimum(undone, self.as_is) if mixed else undone
        names = tuple(v.name for v, holds in zip(self.views, held, strict=True) if holds or not mixed)
        return Hypothesis(mistake, (some if mixed else every) + mistake.cost, tuple(scores.tolist()), names)


def _shrinking(mistake: Mistake, view: RunView) -> float:
    """What it costs to make the measured torque smaller where no load says how large it should be: with the torque the
    misfit shrinks as well, and that proves nothing (the Jacobian of the likelihood)."""
    smaller = mistake.cause in ("unit", "scale") and mistake.channel.endswith(("pressure", "displacement", "torque"))
    known = view.load_torque is not None or np.isfinite(view.load).any()
    return 2.0 * EFFECTIVE * max(0.0, -float(np.log(mistake.factor))) if smaller and not known else 0.0


def _both_shrink(first: Mistake, second: Mistake, view: RunView) -> float:
    """What it costs to make the load smaller beside the measured torque: the misfit shrinks with both, whatever it is.
    Nothing where a value as it stands is beyond any machine, which speaks for itself."""
    smaller = [each for each in (first, second) if each.cause in ("unit", "scale") and each.factor < 1.0]
    sides = {each.channel.endswith(("load", "force", "load_torque")) for each in smaller}
    if len(sides) < 2 or excesses(view):
        return 0.0
    return 2.0 * EFFECTIVE * min(-float(np.log(each.factor)) for each in smaller)


def _thin(view: RunView) -> RunView:
    step = len(view.time) // FIRST_BLOCKS
    return select(view, slice(None, None, step)) if step > 1 else view


def _free(views: Sequence[RunView]) -> list[Mistake]:
    """Mistakes whose number the contradicting runs give: by least squares of the balance without any prior."""
    parts: dict[str, list[float]] = {}
    tares = []
    for view in views:
        with np.errstate(all="ignore"):
            load, drive = static_torque(view), view.drive_torque
            rest = typical_friction(view) + view.inertia * view.acceleration
            good = view.moving & np.isfinite(load) & np.isfinite(drive) & np.isfinite(rest)
            if good.sum() < 5:
                continue
            parts.setdefault("load", []).append(_ratio(load[good], (drive - rest)[good]))
            for name, group in view.groups.items() if len(view.groups) > 1 else ():
                own = group.torque[good]
                parts.setdefault(name, []).append(_ratio(own, (load + rest - drive)[good] + own))
            lacking = (drive - rest - load)[good].mean() / (GRAVITY * np.median(view.lever))
            tares.append(float(lacking))
    factors = {name: float(np.median(values)) for name, values in parts.items()}
    return list(free_mistakes(views, factors, float(np.median(tares)) if tares else 0.0))


def _ratio(x: np.ndarray, y: np.ndarray) -> float:
    size = float(np.sum(x * x))
    return float(np.sum(x * y)) / size if size > 0.0 else float("nan")


def _factor_says(ratio: float, known: Sequence[tuple[float, str]]) -> str:
    return next((said for factor, said in known if abs(ratio / factor - 1.0) < EXACT), "")


def _companions(views: Sequence[RunView]) -> list[Mistake]:
    """Channels that merely tell the speed again may be wrong themselves: without them the rest fits."""
    found = []
    for channel in dict.fromkeys(name for view in views for name in view.rates):
        if channel == "heave_velocity":
            continue  # it moves the load as well: its sign is a mistake of its own

        def undo(view: RunView, channel: str = channel) -> RunView:
            return replace(view, rates={n: v for n, v in view.rates.items() if n != channel})

        told = [(v.name, a) for v in views for a in agreements(v) if a.channel == channel]
        worst = max((a.score for _, a in told), default=0.0)
        odd = {name: a.ratio for name, a in told if a.score >= ODD * worst}
        ratio = float(np.median(list(odd.values()))) if odd else 1.0
        where = f" in {', '.join(odd)}" if 0 < len(odd) < len(told) else ""
        unit = _factor_says(ratio, UNITS.get(channel, ()))
        likely = unit or _factor_says(ratio, PAID_OUT if channel == "wire_out" else ())
        words = f"{channel} contradicts motor_speed{where}: it tells {ratio:.3g} times the speed"
        words += f" ({likely}?)" if likely else ""
        found.append(Mistake("unit" if unit else "companion", channel, words, COMPANION, undo, ratio))
    return found
