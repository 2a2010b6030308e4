"""What a fit says of a cause, in the cause's own parameters and units; and of the seed that it began with.

The seed's uncertainty is a claim, and claims are tested: do the data want the base model further off than it says? The
base is fitted once more with room for several stated deviations. If that alone explains the gap as well as named
effects do, and the shift is too large for the stated covariance, it is the seed that is refuted, and no effect named.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np
from scipy.special import chdtrc, ndtri

from winch_friction.discrepancy.answer import Side, keeps_something, steady_excess, telling
from winch_friction.discrepancy.candidates.candidate import Estimates, ParameterEstimate, Sides
from winch_friction.discrepancy.candidates.lateness import DELAY
from winch_friction.discrepancy.candidates.signals import ZEROS
from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.engine.chance import dependences
from winch_friction.discrepancy.engine.crossfit import CrossFit, Explanation
from winch_friction.discrepancy.expansion import Given
from winch_friction.discrepancy.regressors import key_of
from winch_friction.discrepancy.search import Search
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.friction.correction import Correction

_Known = TypeVar("_Known")
STEP = 1e-3  # of an estimate: what of the corrections moves with it


def estimates_of(slot: Slot, value: FloatArray, std: FloatArray, cross: CrossFit) -> dict[str, ParameterEstimate]:
    """The amplitudes of an effect, and the shape parameters of its term."""
    candidate, shape = slot.origin
    found = {
        p.name: ParameterEstimate(float(v), float(s), p.unit)
        for p, v, s, c in zip(candidate.linear, value, std, slot.columns, strict=True)
        if candidate.term is not None or cross.total_g[c, c] > 0.0
    }
    if candidate.term is not None:
        units = {p.name: p.unit for p in candidate.term.parameters}
        for name, at in shape.values.items():
            found[name] = ParameterEstimate(float(at), _shape_std(slot, name, float(at), cross), units[name])
    return found


def _shape_std(slot: Slot, name: str, at: float, cross: CrossFit) -> float:
    """Of one chosen from a grid: relative, or half the way to the next where the grid is narrower, as of dates."""
    own = [each for each in cross.problem.slots if (each.name, each.law) == (slot.name, slot.law)]
    away = [abs(step) for each in own if (step := each.origin[1].values.get(name, at) - at)]
    relative = LIMITS.shape_std * abs(at)
    return 0.5 * min(away) if away and max(away) < relative else relative


def of_part(slot: Slot, slots: Sequence[Slot], found: Mapping[str, _Known]) -> Mapping[str, _Known]:
    """What is known of each parameter, under names of their own where the same cause has others for another part of the
    machine: a zero of one feedback and a zero of another are two numbers, and one of all of them is a third."""
    parts = {each.part for each in slots if each.name == slot.name}
    if len(parts) < 2:
        return found
    beside = ", beside that of all" if slot.part and "" in parts else ""
    return {f"{name} of {slot.label.partition(',')[0]}{beside}": each for name, each in found.items()}


def together(first: Estimates, second: Estimates) -> dict[str, ParameterEstimate]:
    """The estimates of a cause whose law is a mixture of two: what both of them have adds."""
    both = {
        name: ParameterEstimate(first[name].value + each.value, float(np.hypot(first[name].std, each.std)), each.unit)
        for name, each in second.items()
        if name in first
    }
    return {**first, **second, **both}


@dataclass(frozen=True)
class InFile:
    """The correction of a model that says an estimate: `factor` times it, more than the model had before."""

    key: str
    factor: float
    before: float

    def read(self, own: Correction, unit: str) -> ParameterEstimate:
        """The estimate as the correction has it now."""
        value, std = float(own.value - self.before) / self.factor, float(own.std or 0.0) / abs(self.factor)
        return ParameterEstimate(value, std, unit)


def in_file(slot: Slot, found: Estimates, sides: Sides, had: Mapping[str, Correction]) -> dict[str, InFile | None]:
    """Where a model says the estimates of an error of signals, geometry or load, of which it `had` some by key; None
    for those that go into several corrections, or share one."""
    candidate, shape = slot.origin
    if candidate.corrects is None:
        return dict.fromkeys(found)
    # as small as nothing: what is near a bound would be cut there, and only half of the step be seen
    small = {name: replace(each, value=STEP * each.value) for name, each in found.items()}
    made = candidate.corrects(small, shape, sides)
    slopes: dict[str, dict[str, float]] = {}
    for name, each in small.items():
        step = STEP * each.value or STEP * each.std
        moved = candidate.corrects({**small, name: replace(each, value=each.value + step)}, shape, sides)
        slopes[name] = {
            key_of(old): (new.value - old.value) / step
            for old, new in zip(made, moved, strict=True)
            if new.value != old.value
        }
    places: dict[str, InFile | None] = {}
    for name, own in slopes.items():
        key, factor = next(iter(own.items()), ("", 0.0))
        alone = len(own) == 1 and sum(key in other for other in slopes.values()) == 1
        places[name] = InFile(key, factor, had[key].value if key in had else 0.0) if alone else None
    return places


def agreed(first: Mapping[str, InFile | None], second: Mapping[str, InFile | None]) -> dict[str, InFile | None]:
    """Where the estimates of a cause with two laws stand: what both of them have is one estimate, in one correction;
    None, which leaves it as the search had it, where they are in two."""
    both = {name: place if first[name] == place else None for name, place in second.items() if name in first}
    return {**first, **second, **both}


# -- the seed's uncertainty

# exact ties of the equations (docs/physics.md): what a parameter's shift would pass for
MIMICS: Mapping[str, tuple[str, ...]] = {
    "K1": ("viscous", "viscosity_temperature"), "C5": ("viscous", "viscosity_temperature"),
    "K2": ("port_turbulence", "line_pressure_drop"), "K3": ("gear_load_loss", "sheave_bending", "pressure_scale"),
    "K4": ("brake_drag", "coulomb", "wear_drift"), "C2": ("brake_drag", "coulomb", "wear_drift"),
    "K5": ("high_pressure_mixed",), "C1": ("stribeck",), "C3": ("stribeck",), "C4": ("stribeck",),
    "C6": ("gear_load_loss", "sheave_bending"),
}  # fmt: skip


@dataclass(frozen=True)
class SeedRefuted:
    """Which parameters want to leave their prior, by how many stated deviations each, and how sure that is.

    `sigma` is the joint shift as deviations of a normal variable of the same probability.
    """

    shifts: Mapping[str, float]
    sigma: float
    mimics: tuple[str, ...]

    def content(self) -> dict[str, Any]:
        """The entry of `seed_refuted` in gap.json."""
        return {
            "parameters": list(self.shifts), "sigma": self.sigma, "shifts": dict(self.shifts),
            "mimics": list(self.mimics),
        }  # fmt: skip


@dataclass(frozen=True)
class SeedTrial:
    """The base with its prior on trial: whether it explains the gap as well as the names do, and what that refutes."""

    enough: bool = False
    refuted: SeedRefuted | None = None


def try_seed(search: Search, rng: np.random.Generator) -> SeedTrial:
    """Whether the training runs want the base beyond its prior's box, and nothing but that.

    A shift that the stated covariance does not make surprising refutes nothing; an effect that only does what the box
    forbids is no effect all the same.
    """
    model = search.given.model
    if model.covariance is None:
        return SeedTrial()
    wide = _wide(search)
    loss, beta = wide.train_loss(())
    base = wide.problem.base
    count = base.parameters
    shift = beta[:count] + base.shift[:count]
    sigma, marginal = _surprise(wide, shift, count)
    surprising = sigma >= LIMITS.seed_sigma or np.abs(marginal).max(initial=0.0) >= LIMITS.seed_marginal
    if not surprising and not search.selection.final.slots:
        return SeedTrial()
    explanation = Explanation((), np.zeros(0), beta, loss, np.zeros((0, len(beta))))
    if _something_else(wide, explanation, search, rng):
        return SeedTrial()  # it comes first
    named = _cost(search.cross, search.selection.final, count)
    # a careless seed is off in several parameters, and in none by much; one alone is what an effect does
    careless = (np.abs(shift) > LIMITS.prior_bound).sum() > 1 and np.abs(shift).max() <= LIMITS.ordinary_shift
    allowed = LIMITS.effect_price if careless else 0.0
    if search.selection.final.slots and _inflated(loss, shift) > named + allowed:
        return SeedTrial()
    if not surprising:
        return SeedTrial(enough=True)
    order = np.argsort(-np.abs(shift))
    names = [model.parameter_names[k] for k in order if abs(shift[k]) > LIMITS.prior_bound] or [
        model.parameter_names[order[0]]
    ]
    shifts = {name: float(shift[model.parameter_names.index(name)]) for name in names}
    found = [n for f in search.selection.found for n in (f.slot.name, *(r.name for r in f.rivals))]
    mimics = tuple(dict.fromkeys([*found, *(m for name in names for m in MIMICS.get(name, ()))]))
    return SeedTrial(True, SeedRefuted(shifts, max(sigma, float(np.abs(marginal).max())), mimics))


def widened(given: Given) -> Given:
    """The same, with a seed whose stated deviations are as large as its refutation allows."""
    model = given.model
    assert model.covariance is not None
    factor = LIMITS.seed_reach / LIMITS.prior_bound
    return replace(given, model=model.with_covariance(model.covariance * factor**2))


def _wide(search: Search) -> CrossFit:
    """The regression with room for the base."""
    cross, seed, at = search.cross, search.given.model, np.array(search.expansion.model.values)
    problem = cross.problem
    base, k = problem.base, problem.base.parameters
    bounds = np.array([seed.bounds_of(name) for name in seed.parameter_names]).reshape(-1, 2)
    lower, upper = problem.layout.lower.copy(), problem.layout.upper.copy()
    lower[:k] = np.minimum(np.maximum(-LIMITS.seed_reach - base.shift[:k], (bounds[:, 0] - at) / base.scale[:k]), 0.0)
    upper[:k] = np.maximum(np.minimum(LIMITS.seed_reach - base.shift[:k], (bounds[:, 1] - at) / base.scale[:k]), 0.0)
    return CrossFit(replace(problem, layout=replace(problem.layout, lower=lower, upper=upper)))


def _surprise(wide: CrossFit, shift: FloatArray, count: int) -> tuple[float, FloatArray]:
    """The shift against what the prior lets one expect of it: joint, in deviations of a normal variable, and each.

    A posterior mean scatters about the prior's by the identity less the posterior covariance (both in units of the
    prior); directions of which the data say little do not count.
    """
    spread = np.eye(count) - wide.problem.covariance(wide.total_g, wide.problem.columns(()))[:count, :count]
    values, vectors = np.linalg.eigh(0.5 * (spread + spread.T))
    told = values > LIMITS.told
    z = (vectors.T @ shift)[told] / np.sqrt(values[told])
    p = float(chdtrc(int(told.sum()), float(z @ z))) if told.any() else 1.0
    marginal = np.where(np.diag(spread) > LIMITS.told, shift / np.sqrt(np.maximum(np.diag(spread), 1e-9)), 0.0)
    return float(-ndtri(max(p, 1e-300) / 2.0)), marginal


def _inflated(loss: float, shift: FloatArray) -> float:
    """Cost of a seed whose deviations are all too small by one factor: data, shift, and the factor itself."""
    total, count = float(shift @ shift), len(shift)
    factor = max(total / count, 1.0)
    return loss / LIMITS.prior_weight + total / factor + count * float(np.log(factor)) + LIMITS.effect_price / 2.0


def _cost(cross: CrossFit, explanation: Explanation, count: int) -> float:
    """Cost of named effects: data, the base's shift inside its prior, and a price per name."""
    shift = explanation.beta[:count] + cross.problem.base.shift[:count]
    price = LIMITS.effect_price * len(explanation.slots)
    return explanation.train_loss / LIMITS.prior_weight + float(shift @ shift) + price


def _something_else(wide: CrossFit, freed: Explanation, search: Search, rng: np.random.Generator) -> bool:
    """Whether the freed base keeps something that the names, if there are any, do not keep."""
    base, final = search.selection.base, search.selection.final
    if final.slots and wide.inside_excess(freed) <= LIMITS.as_much * search.cross.inside_excess(final):
        return False
    depends = telling(wide, dependences(wide, wide.remainder(freed), rng))
    excess = max(wide.inside_excess(freed), steady_excess(wide, freed))
    return keeps_something(excess, max(wide.inside_excess(base), 1e-9), depends)


# -- what the making of a log explains, or a mere refit, and is no name
def within_a_sample(parameters: Mapping[str, Estimates], side: Side) -> str:
    """Why a delay, in s among the parameters by name, is none; empty where it is one, or there is none.

    Signals of one log are in step to half a sample: a counting encoder's mean is as old, and an analogue input waits
    for the next one.
    """
    found = parameters.get(DELAY, {})
    if not found:
        return ""
    step, most = max(run.dt for run in side.runs), max(abs(each.value) for each in found.values())
    if most > LIMITS.in_step * step:
        return ""
    return f"a delay of {1e3 * most:.2g} ms is how a log of a sample every {1e3 * step:.3g} ms is made"


def within_a_step(cross: CrossFit, fitted: Sequence[Explanation], least: float) -> str:
    """Why a zero of a transducer, of a drive's torque or of a load cell, one of these, is none; else empty.

    The step up to which it is off without being wrong is the same whether it stays, creeps or moves with the oil. Its
    size is the root mean square over the blocks of `cross`, in the gap's unit, like what no balance closes, `least`.
    """
    most = LIMITS.step * least
    for each in fitted:
        columns = [column for slot in each.slots if slot.name in ZEROS for column in slot.columns]
        at = [cross.problem.columns(each.slots).index(column) for column in columns]
        torque = cross.problem.blocks.x[:, columns] @ each.beta[at] if columns else np.inf
        if (size := float(np.sqrt(np.mean(np.square(torque))))) <= most:
            return f"a zero of {size:.2g} is within the {most:.2g} by which a transducer steps"
    return ""


def takes_little(cross: CrossFit, base: Explanation, explanation: Explanation) -> bool:
    """Whether names take less than half of what a refit leaves of the training runs beyond the noise and what no
    balance closes, or nothing is left of these: then they are no more its cause than what the refit has wrong."""
    whole = cross.excess(base)
    return whole <= 0.0 or cross.excess(explanation) > LIMITS.outdone * whole
