"""The experiment that would separate rivals best: T-optimality (Atkinson and Fedorov 1975) over feasible scenarios.

Each scenario of a small family is simulated without any effect; on its operating points the effect at its found size
is the truth, and the rival is refitted, with the base inside its prior, to the runs at hand and the new one together;
then the other way round, for nobody knows which of them is there. What cannot be imitated, in standard deviations of
the measurement, is the expected separation. And what to log where the runs cannot answer at all.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from winch_friction.discrepancy.adequacy import HEAVE, SWING, TELLING, Check
from winch_friction.discrepancy.answer import INSUFFICIENT, GapResult, Side
from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.engine.blocks import Blocks, Slot
from winch_friction.discrepancy.engine.chance import Size, levels_of_runs, rms
from winch_friction.discrepancy.engine.crossfit import CrossFit, Explanation
from winch_friction.discrepancy.expansion import Expansion, Given, Split
from winch_friction.discrepancy.preparation.prepare import prepare
from winch_friction.discrepancy.proof import compare
from winch_friction.discrepancy.regressors import build_problem
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.winch import Crane
from winch_friction.records.strict_yaml import shipped

EXPERIMENTS = (
    "experiment_zero_check", "experiment_loads", "experiment_displacement_sweep", "experiment_boost_step",
    "experiment_heave_30s", "experiment_slow_ramps", "experiment_hold_times", "ahc_55t_160",
)  # fmt: skip


@dataclass(frozen=True)
class NextExperiment:
    """A scenario by shipped name and as a file's text, the rivals, and their expected separation in sigma."""

    name: str
    text: str
    separates: tuple[str, str]
    expected_z: float
    alternatives: Mapping[str, float]

    @property
    def file(self) -> str:
        """Name of the scenario file beside gap.json."""
        return f"{self.name}.yaml"

    def content(self) -> dict[str, Any]:
        """The entry of gap.json."""
        note = (
            ""
            if self.expected_z >= LIMITS.enough_separation
            else "tied in every scenario of the family: another channel must decide"
        )
        return {
            "scenario": self.file, "separates": list(self.separates), "expected_z": self.expected_z, "note": note,
            "considered": dict(self.alternatives),
        }  # fmt: skip


def plan_experiment(
    crane: Crane,
    expansion: Expansion,
    cross: CrossFit,
    fitted: Explanation,
    own: Slot,
    rivals: Sequence[Slot],
    seed: int,
) -> NextExperiment | None:
    """The scenario that takes most rivals off the set of `own`, and of several the one in which the nearest of them
    stays farthest away; None where none of them can be run."""
    others = tuple(slot for slot in fitted.slots if slot is not own)
    imitating = [cross.explain((*others, rival)) for rival in rivals]
    names = {own.name, *(rival.name for rival in rivals)}
    # of the hundreds of columns only what is there and what may imitate it
    asked = [slot for slot in cross.problem.slots if slot in fitted.slots or slot.name in names]
    separation: dict[str, tuple[float, Slot]] = {}
    count: dict[str, int] = {}
    for name in EXPERIMENTS:
        try:
            g = cross.total_g + _simulated(name, crane, expansion, seed, asked)
        except InputError:
            continue
        z = [
            (_apart(cross, g, fitted, own, other, rival), rival) for rival, other in zip(rivals, imitating, strict=True)
        ]
        parted = [pair for pair in z if pair[0] >= LIMITS.enough_separation]
        count[name], separation[name] = len(parted), min(parted or z, key=lambda pair: pair[0])
    if not separation:
        return None
    best = max(separation, key=lambda name: (count[name], separation[name][0]))
    z_best, rival = separation[best]
    text = shipped("scenarios", best).read_text(encoding="utf-8")
    return NextExperiment(
        best, text, (own.name, rival.name), z_best,
        {name: round(pair[0], 2) for name, pair in sorted(separation.items(), key=lambda item: -item[1][0])},
    )  # fmt: skip


def _simulated(name: str, crane: Crane, expansion: Expansion, seed: int, asked: Sequence[Slot]) -> FloatArray:
    """The scenario's Gram matrix in the columns of the whole layout; 0 for what is not asked for."""
    from winch_friction.simulation import load_scenario, simulate

    measured = simulate(load_scenario(name), crane, expansion.model, seed=seed).run
    prepared = prepare(measured, crane, expansion.model)
    problem = build_problem([prepared], expansion.layout.only(asked)[0])
    whole = np.zeros(2 * (len(expansion.layout.scales),))
    columns = np.asarray(problem.base_columns + tuple(c for slot in asked for c in slot.columns))
    whole[np.ix_(columns, columns)] = problem.grams.total()[0]
    return whole


def _apart(cross: CrossFit, g: FloatArray, one: Explanation, own: Slot, other: Explanation, rival: Slot) -> float:
    """Sigma between two causes whichever of them is there, each imitated by the best law that the other's cause has:
    with new runs that may be another one."""
    others = tuple(slot for slot in one.slots if slot is not own)
    found = []
    for truth, imitator in ((one, rival), (other, own)):
        family = [slot for slot in cross.problem.slots if slot.name == imitator.name]
        found += [_separation(cross, g, truth, others, slot) for slot in family]
    return min(found)


def _separation(cross: CrossFit, g: FloatArray, truth: Explanation, others: Sequence[Slot], rival: Slot) -> float:
    """Sigma by which the rival's best fit to old and new runs, of Gram matrix `g`, misses what the truth predicts.

    Less where it misses so little of what the truth explains that the answer would still call it a rival.
    """
    missed = _missed(cross, g, truth, (*others, rival))
    share = missed / max(LIMITS.rival_share * _missed(cross, g, truth, others), 1e-300)
    sigma = float(np.sqrt(missed / LIMITS.prior_weight))
    return sigma if share >= 1.0 else min(sigma, LIMITS.enough_separation * share)


def _missed(cross: CrossFit, g: FloatArray, truth: Explanation, slots: Sequence[Slot]) -> float:
    """Squared error of the best fit of these effects to what the truth predicts."""
    true_columns, columns = (np.asarray(cross.problem.columns(each)) for each in (truth.slots, slots))
    b = g[:, true_columns] @ truth.beta
    y2 = float(truth.beta @ g[np.ix_(true_columns, true_columns)] @ truth.beta)
    beta = cross.problem.fit(g, b, columns.tolist())
    return max(float(y2 - 2.0 * b[columns] @ beta + beta @ g[np.ix_(columns, columns)] @ beta), 0.0)


def of_wire(given: Given) -> list[str]:
    """What is said of a gap that nothing explains where runs on a wire that gives do not say how long it is."""
    silent = [run.name for run in given.prepared if "wire_out" not in run.channels]
    if not silent or not np.isfinite(given.crane.wire_stiffness):
        return []
    which = "no run says" if len(silent) == len(given.prepared) else f"{', '.join(silent)} do not say"
    return [
        f"{which} wire_out, so that how the load swings on its wire is a guess, and its swing may be the gap: log it"
    ]


NO_LOAD = 1.0  # N m at the shaft: an empty hook, of which no share is told by less
MOST_BESIDE = 0.5  # of what is more than noise, squared: a gap that is mostly something else is no matter of levels
APART = 2.0  # times what any other run keeps, from where on it is a matter of the runs


def of_runs(sides: Sequence[Side]) -> list[str]:
    """Which runs keep a gap that nothing explains, where they are less than half of all and keep plainly more than any
    other: a setting or a date that nobody logged depends on no signal."""
    left = sorted((pair for side in sides for pair in side.most_left_first.items()), key=lambda pair: -pair[1])
    names, size = [name for name, _ in left], [kept for _, kept in left]
    most = range(1, (len(size) + 1) // 2)
    k = max(most, key=lambda k: size[k - 1] / max(size[k], 1.0), default=0)
    if not k or size[k - 1] <= LIMITS.far_off_the_floor or size[k - 1] < APART * size[k]:
        return []
    keep = "keeps" if k == 1 else "keep"
    return [
        f"{', '.join(sorted(names[:k]))} {keep} {size[k - 1]:.2g} times the noise and more, no other run more than "
        f"{size[k]:.2g} times: look for what was another there, such as a setting, a sensor or the date"
    ]


@dataclass(frozen=True)
class Levels:
    """A level of its own in each run that acts one way whatever the motion: a load or a zero that is off by another
    amount each time, no friction; where all have one sign, beside one that is off in all runs."""

    shares: tuple[float, ...]  # % of the run's load
    beside: float  # of what the runs keep above the noise, squared, how much is something else

    @property
    def said(self) -> str:
        """In words, with what to do about it."""
        beside = (
            "and no more than noise beside it: that is no friction"
            if not self.beside
            else f"which is no friction, and {100.0 * (1.0 - self.beside):.0f} % of what they keep above the noise "
            "(squared): what else is missing shows once it is gone"
        )
        mean = float(np.mean(self.shares))
        common = "" if min(self.shares) < 0.0 < max(self.shares) else (
            f" (all of one sign, {mean:+.2g} % in the mean: such as a zero, scale or weight that is off in all runs, "
            "beside levels too large to tell which)"
        )  # fmt: skip
        return (
            f"each run keeps a level of its own that acts the same way hoisting and lowering, {min(self.shares):+.2g} "
            f"to {max(self.shares):+.2g} % of its load{common}, {beside}. Weigh each load (or log hook_load from a "
            "load cell) and read the zeros before each run, then ask again"
        )


def levels_of(sides: Sequence[Side]) -> Levels | None:
    """The levels that runs keep where nothing explains the gap, and either no more than noise is beside them, or less
    than they are."""
    shares: list[float] = []
    kept, beside = (np.zeros(len(sides)) for _ in range(2))  # above the noise, squared
    for j, side in enumerate(sides):
        left = side.after.copy()
        for k, level in levels_of_runs(side.after, side.blocks).items():
            left[side.blocks.run == k] -= level
            run = side.runs[k]
            weight = float(np.median(np.abs(run.drum_torque))) / run.gear_ratio  # N m at the shaft
            shares.append(100.0 * level * run.unit_torque / max(weight, NO_LOAD))
        noise = LIMITS.at_the_floor * side.floor
        kept[j], beside[j] = (max(rms(each) ** 2 - noise**2, 0.0) for each in (side.after, left))
    if not kept.any() or len(shares) < LIMITS.fewest_levels or beside.sum() > MOST_BESIDE * kept.sum():
        return None
    return Levels(tuple(shares), float(beside.sum() / kept.sum()))


def of_unexplained(result: GapResult, given: Given, said: bool) -> tuple[GapResult, list[str]]:
    """A result that no name explains, and what is noted of it, unless an equation has `said` it. Where each run keeps a
    level of its own alone it depends on no signal: what is steady in a run, load or oil, tells levels by chance."""
    sides = (result.train, result.holdout)
    levels = None if said else levels_of(sides)
    if levels is not None and not levels.beside:
        result = replace(result, depends=())
    return result, of_wire(given) + ([] if said else of_runs(sides)) + ([] if levels is None else [levels.said])


def of_own_terms(named: Collection[str], given: FrictionModel, written: FrictionModel) -> list[str]:
    """What becomes of a named law's term that the given model has already: it is not missing, but too small or too
    large."""
    found, before, after = [], given.as_dict(), written.as_dict()
    for term in given.terms:
        sizes = [each.name for each in term.parameters if not each.shape]
        if term.name not in named or not sizes or not set(sizes) <= set(after):
            continue
        told = ", ".join(f"{name} {before[name]:.3g} becomes {after[name]:.3g}" for name in sizes)
        less = all(abs(after[name]) <= abs(before[name]) for name in sizes)
        which = "says too much of it" if less else "says something else of it"
        found.append(f"{term.name}: the given model has this term already and {which}: {told}")
    return found


# -- where the runs cannot answer
def insufficient(
    checks: Sequence[Check], notes: Sequence[str], crane: Crane, model: FrictionModel,
    looked_at: tuple[Given, Split] | None = None,
) -> GapResult:  # fmt: skip
    """The result of runs that cannot answer: what they lack in numbers, and a scenario that supplies it."""
    sides = [nothing_compared(), nothing_compared()]
    if looked_at is not None:
        given, split = looked_at
        rng = np.random.default_rng(0)
        sides = [compare(given, given, names, rng) for names in (split.train, split.holdout)]
    name = supplying(checks) if crane.drive.hydraulic else ""
    lacking = "; ".join(check.sentence for check in checks if not check.met)
    plan = {
        "scenario": f"{name}.yaml", "separates": [], "expected_z": 0.0, "considered": {},
        "note": f"supplies what the runs lack ({lacking})",
    }  # fmt: skip
    return GapResult(
        verdict=INSUFFICIENT, refused=lacking, effects=(), unit=crane.drive.unit, train=sides[0],
        holdout=sides[1], depends=(), unexplained_share=0.0, considered=(), untestable=(), model=model,
        seed_model=model, next_experiment=plan if name else None,
        next_scenario=shipped("scenarios", name).read_text(encoding="utf-8") if name else "", notes=tuple(notes),
        adequacy=tuple(checks),
    )  # fmt: skip


def with_what_was_seen(lacking: GapResult, result: GapResult) -> GapResult:
    """The answer of runs that lack something, with what their search showed all the same."""
    left = f"{result.holdout.size_after.value:.3g} {result.unit}"
    said = [] if result.effects else [f"the model's own parameters, fitted anew, leave {left} of the locked runs"]
    return replace(lacking, considered=result.considered, untestable=result.untestable, notes=(*lacking.notes, *said))


def nothing_compared() -> Side:
    """Of runs that could not even be prepared."""
    none, number, size = np.zeros(0), np.zeros(0, int), Size(0.0, (0.0, 0.0))
    blocks = Blocks(none, np.zeros((0, 1)), number, number, none, {}, none, number)
    return Side((), blocks, none, none, size, size, 0.0, 0.0, (0.0, 0.0))


def supplying(checks: Sequence[Check]) -> str:
    """The shipped scenario that supplies what is lacking: both directions, nine speeds, three minutes at 50 Hz."""
    lacking = {check.what for check in checks if not check.met}
    if SWING in lacking or HEAVE in lacking:
        return "ahc_55t_215"
    many = "loads" in lacking or any(what.startswith(TELLING) for what in lacking)
    return "experiment_loads" if many else "test_02"
