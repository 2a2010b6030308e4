"""Runs as a model sees them, around a point, the seed or the best explanation so far; and what no run tells alone: does
the wire give, and what hangs where nobody weighed it?"""

from collections.abc import Callable, Collection, Hashable, Iterator, Mapping, MutableMapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any
from weakref import WeakValueDictionary

import numpy as np

from winch_friction.discrepancy.candidates.candidate import Candidate
from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.engine.crossfit import CrossFit, Explanation
from winch_friction.discrepancy.engine.problem import Layout
from winch_friction.discrepancy.preparation.prepare import PreparedRun, prepare
from winch_friction.discrepancy.preparation.seen import Seen
from winch_friction.discrepancy.preparation.suspended_load import COURSE, Mode
from winch_friction.discrepancy.preparation.wires import agreed_modes, swinging_along
from winch_friction.discrepancy.regressors import accounted, base_of, build_problem, correction_std, layout_of
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.channels import GRAVITY
from winch_friction.physics.corrections import corrected
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.friction.correction import Correction
from winch_friction.physics.signals import NAN, Run
from winch_friction.physics.winch import Crane

LOAD_ROUNDS = 6  # friction depends on the load that is sought: the fixed point is reached to 0.1 % by then
LOAD_CONVERGED = 1e-5  # relative; a tenth of what any load cell tells
EDGE = 0.999  # of the room around a prior: what a fit took so far would go further
WEIGHED = {"hook_load", "rope_force", "load_torque"}  # columns that say what hangs there


@dataclass(frozen=True)
class Expansion:
    """Prepared runs and the layout of their regressors around one point."""

    runs: tuple[PreparedRun, ...]
    layout: Layout
    model: FrictionModel  # the base model at the point of expansion

    def cross(self, names: Sequence[str], known: Sequence[Slot] = ()) -> CrossFit:
        """The regression over the runs of these names; what is `known` already is not taken for noise."""
        slots = [self.layout.slot_like(each) for each in known]
        return CrossFit(build_problem([run for run in self.runs if run.name in names], self.layout, known=slots))


@dataclass(frozen=True)
class Given:
    """Runs as a model sees them: its corrections taken out, the loads that nobody measured estimated, prepared.

    This is the one path by which any model, the given or the repaired, meets the measurements.
    """

    runs: tuple[Run, ...]
    crane: Crane
    model: FrictionModel
    loads: Mapping[str, float]  # kg by run, where there is no `hook_load`
    prepared: tuple[PreparedRun, ...]
    _made: dict[Hashable, Any] = field(default_factory=dict, init=False, repr=False, compare=False)
    # as long as somebody holds them: an hour of prepared runs is 90 MB
    around: MutableMapping[Hashable, Expansion] = field(
        default_factory=WeakValueDictionary, init=False, repr=False, compare=False
    )

    def once(self, key: Hashable, make: Callable[[], Any]) -> Any:
        """What `make` makes of these very runs, made once for each `key`, which holds all else that it hangs on: a
        search that asks in another way asks much of the same again."""
        if key not in self._made:
            self._made[key] = make()
        return self._made[key]

    def only(self, names: Sequence[str]) -> "Given":
        """The runs of these names, prepared as all of them agree that their wire is."""
        pairs = [(run, own) for run, own in zip(self.runs, self.prepared, strict=True) if run.name in names]
        return replace(self, runs=tuple(run for run, _ in pairs), prepared=tuple(own for _, own in pairs))


@dataclass(frozen=True)
class Split:
    """Names of the runs to learn from and of the locked ones, and all runs (divided ones renamed)."""

    runs: tuple[Run, ...]
    train: tuple[str, ...]
    holdout: tuple[str, ...]


def meet(
    runs: Sequence[Run], crane: Crane, model: FrictionModel, fitted: Collection[str] | None = None,
    known: Given | None = None,
) -> Given:  # fmt: skip
    """Measured runs as this model sees them; `InputError` for runs that lack what balance or corrections need.

    What the model's corrections would change is told of the `fitted` runs, of all unless given: each costs a
    preparation, and a gap that is only looked at needs none. What does not hang on the model is taken from the same
    runs as they are `known` already: it is half of the work, and most of the memory.
    """
    right, own_crane = _corrected(runs, crane, model)
    old = {run.name: run for run in known.prepared} if known is not None else {}
    loads = estimated_loads(right, own_crane, model, {name: run.seen for name, run in old.items()})

    def seen(run: Run, before: PreparedRun | None, **known: Any) -> PreparedRun:
        return prepare(run, own_crane, model, loads.get(run.name, NAN), before=before, **known)

    prepared = [seen(run, old.get(run.name)) for run in right]
    first = swinging_along(prepared, own_crane, lambda k, wire: seen(right[k], prepared[k], wire=wire))
    agreed = tuple(
        before if before.wire_mode == mode else seen(run, before, mode=mode, spikes=before.spikes)
        for run, before, mode in zip(right, first, agreed_modes(first), strict=True)
    )
    names = [run.name for run in runs] if fitted is None else fitted
    return Given(right, own_crane, model, loads, with_corrections(runs, crane, model, loads, agreed, names))


def meet_again(before: Given, runs: Sequence[Run], crane: Crane, model: FrictionModel) -> Given:
    """The runs of `before` as a model of hardly other values sees them: their wires are what they were there."""
    own = [run for run in runs if run.name in {each.name for each in before.runs}]
    right, own_crane = _corrected(own, crane, model)
    loads = estimated_loads(right, own_crane, model, {run.name: run.seen for run in before.prepared})
    prepared = [
        prepare(run, own_crane, model, loads.get(run.name, NAN), mode=old.wire_mode, before=old)
        for run, old in zip(right, before.prepared, strict=True)
    ]
    found = with_corrections(own, crane, model, loads, prepared, [run.name for run in own])
    return Given(right, own_crane, model, loads, found)


def misfit(given: Given, beside: Given) -> float:
    """RMS of the gap over each run's moving samples, in the units that its own drive gives it; of those samples that
    the balance of `beside` counts as well, for a model that makes spikes of jerks would seem the better for it."""
    own = []
    for run, its in zip(given.prepared, beside.prepared, strict=True):
        used = run.used & its.used_at(run.time + run.start)
        own += [float(np.mean((run.gap[used] / run.unit_torque) ** 2))] if used.any() else []
    return float(np.sqrt(np.mean(own))) if own else 0.0


def met_in_turn(given: Given, model: FrictionModel, modes: Mapping[str, Mode]) -> Iterator[PreparedRun]:
    """The runs one after the other as another model sees them, with wires of these modes: all at once fill a memory."""
    right, own_crane = _corrected(given.runs, given.crane, model)
    loads = estimated_loads(right, own_crane, model)
    for run in right:
        yield prepare(run, own_crane, model, loads.get(run.name, NAN), mode=modes[run.name])


def swings(given: Given) -> bool:
    """Whether the balance takes the wire of any run for one on which the load swings."""
    return any(run.wire_mode.damping > 0.0 for run in given.prepared)


def as_rigid(given: Given) -> Given:
    """The same runs with a wire that does not give: a late signal or an inertia that is wrong also rings."""

    def rigid(run: Run, old: PreparedRun) -> PreparedRun:
        load = given.loads.get(run.name, NAN)
        mode = Mode(old.wire_mode.frequency, 0.0)
        new = prepare(run, given.crane, given.model, load, mode=mode, spikes=old.spikes, seen=old.seen)
        return replace(new, corrections=old.corrections)

    pairs = zip(given.runs, given.prepared, strict=True)
    return replace(given, prepared=tuple(rigid(run, old) if old.wire_mode.damping > 0.0 else old for run, old in pairs))


def _corrected(runs: Sequence[Run], crane: Crane, model: FrictionModel) -> tuple[tuple[Run, ...], Crane]:
    if not model.corrections:
        return tuple(runs), crane
    pairs = [corrected(run, crane, model) for run in runs]
    return tuple(run for run, _ in pairs), pairs[0][1]


def with_corrections(
    runs: Sequence[Run], crane: Crane, model: FrictionModel, loads: Mapping[str, float],
    prepared: Sequence[PreparedRun], names: Collection[str],
) -> tuple[PreparedRun, ...]:  # fmt: skip
    """Prepared runs; those of these names with what each of the model's corrections would change in their gap, by small
    steps of it."""
    columns: list[list[FloatArray]] = [[] for _ in prepared]
    for k, one in enumerate(model.corrections if names else ()):
        step, moved = _moved(one)
        others = (*model.corrections[:k], moved, *model.corrections[k + 1 :])
        right, own_crane = _corrected(runs, crane, replace(model, corrections=others))
        for own, run, old in zip(columns, right, prepared, strict=True):
            if run.name not in names:
                continue
            load = loads.get(run.name, NAN)
            new = prepare(run, own_crane, model, load, mode=old.wire_mode, spikes=np.zeros(1, bool), seen=old.seen)
            gap = np.interp(old.time + old.start, new.time + new.start, new.gap)
            own.append((old.gap - gap) / step)
    return tuple(
        replace(run, corrections=np.column_stack([np.empty((len(run.time), 0)), *own]))
        if run.name in names
        else replace(run, seen=None)
        for run, own in zip(prepared, columns, strict=True)
    )


def _moved(one: Correction) -> tuple[float, Correction]:
    """A small step of a correction inside its bounds, and the correction after it; one less sure than these are wide
    goes to the farther."""
    step, (lower, upper) = 0.5 * correction_std(one), one.bounds
    up, down = upper - one.value, one.value - lower
    step = min(step, up) if step <= up or up >= down else -min(step, down)
    return step, replace(one, value=min(max(one.value + step, lower), upper))


def expand_around(
    given: Given, before: Expansion, explanation: Explanation, candidates: Sequence[Candidate], turning: bool = False
) -> Expansion:
    """Runs prepared around a fitted explanation: its base parameters, and the torque its effects put on the motors."""
    seed = given.model
    from_seed = before.runs is given.prepared and not turning
    key = _point(before, explanation) if from_seed else None
    known = given.around.get(key)
    runs, model = (known.runs, known.model) if known else _prepared_around(given, before, explanation, turning)
    found = Expansion(runs, layout_of(base_of(seed, model), candidates, runs, seed), model)
    if from_seed:
        given.around.setdefault(key, found)
    return found


def _point(before: Expansion, explanation: Explanation) -> Hashable:
    """All that tells an explanation of the runs as the seed sees them from another: effects, their sizes, the base."""
    effects = tuple((slot.origin[0], tuple(slot.origin[1].values.items())) for slot in explanation.slots)
    scales = before.layout.scales[[column for slot in explanation.slots for column in slot.columns]]
    return effects, scales.tobytes(), explanation.beta.tobytes()


def _prepared_around(
    given: Given, before: Expansion, explanation: Explanation, turning: bool
) -> tuple[tuple[PreparedRun, ...], FrictionModel]:
    base, seed, count = before.layout.base, given.model, before.layout.base.parameters
    values = np.array(before.model.values) + explanation.beta[:count] * base.scale[:count]
    bounds = np.array([seed.bounds_of(name) for name in seed.parameter_names]).reshape(-1, 2)
    model = seed.with_values(list(np.clip(values, bounds[:, 0], bounds[:, 1])))
    prepared = []
    for run, old in zip(given.runs, before.runs, strict=True):
        known = accounted(old, before.layout, explanation)
        spikes = np.zeros_like(old.spikes) if turning else old.spikes
        load = given.loads.get(run.name, NAN)
        new = prepare(run, given.crane, model, load, known, turning, old.wire_mode, spikes, old.seen)
        own = new if not turning else replace(new, seen=None)  # nobody prepares again what was turned
        prepared.append(replace(own, corrections=old.corrections).sharing(old))
    return tuple(prepared), model


def with_room(
    prior: FrictionModel, fitted: FrictionModel, loose: Mapping[str, float], seed: FrictionModel
) -> FrictionModel:
    """The prior of a fit with the room of what is free (looser than the seed has it) laid around where the fit brought
    it, if that is where the room ends.

    How far the draft was off it does not know: a shape from a grid moves its neighbours by many of their deviations.
    """
    known, at = dict(zip(seed.parameter_names, seed.std, strict=True)), fitted.as_dict()
    values = prior.as_dict()
    for name, value in values.items():
        ended = abs(at[name] - value) >= EDGE * LIMITS.prior_bound * loose[name]
        if ended and loose[name] > known.get(name, 0.0):
            values[name] = at[name]
    return prior.with_values(values)


def loads_by_balance(runs: Sequence[Run], crane: Crane, model: FrictionModel) -> dict[str, float]:
    """Mass in kg per run without `hook_load`, as this model with its corrections closes the balance."""
    right, own_crane = _corrected(runs, crane, model)
    return estimated_loads(right, own_crane, model)


def estimated_loads(
    runs: Sequence[Run], crane: Crane, model: FrictionModel, before: Mapping[str, Seen | None] | None = None
) -> dict[str, float]:
    """Mass in kg per run without `hook_load`: what balances the torque once friction has its say. `before`: runs by
    name as they were seen already.

    Hoisting and lowering weigh alike, so that friction cancels in the mean.
    """
    unknown = [run for run in runs if not WEIGHED & set(run.columns)]
    told = [run for run in unknown if crane.drive.hydraulic or COURSE in run]
    return {run.name: _estimated_load(run, crane, model, (before or {}).get(run.name)) for run in told}


def _estimated_load(run: Run, crane: Crane, model: FrictionModel, seen: Seen | None) -> float:
    load = 0.0
    for _ in range(LOAD_ROUNDS):
        # a swinging load weighs the same in the mean, so its wire is not looked into
        prepared = prepare(run, crane, model, load, mode=Mode(0.0, 0.0), spikes=np.zeros(1, bool), seen=seen)
        seen = prepared.seen
        gap = prepared.gap[prepared.used] / (prepared.radius[prepared.used] / crane.gear_ratio * GRAVITY)
        direction = prepared.direction[prepared.used]
        sides = [np.median(gap[direction == s]) for s in (-1.0, 1.0) if (direction == s).any()]
        change = float(np.mean(sides)) if sides else 0.0
        load = max(load + change, 0.0)
        if abs(change) < LOAD_CONVERGED * load:
            break
    return load
