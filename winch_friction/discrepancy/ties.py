"""Structural ties: what the equations make one thing, whatever the noise, and what is known in spite of it.

T = D dp: a gain error of the pressure, of the displacement and of the torque are one number; load and radius come as a
product; and so on. A search names one of the two: a partner that no search looks for joins its set, as long as the runs
at hand do not tell them apart.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from winch_friction.discrepancy.answer import Combination
from winch_friction.discrepancy.candidates.candidate import (
    Candidate,
    Estimates,
    ParameterEstimate,
    Shape,
    Values,
    group_shapes,
    single_shape,
    spoken_of,
)
from winch_friction.discrepancy.candidates.geometry import hanging
from winch_friction.discrepancy.candidates.signals import scale_columns
from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.engine.chance import does_as_well
from winch_friction.discrepancy.engine.crossfit import CrossFit, Explanation
from winch_friction.discrepancy.engine.selection import Finding
from winch_friction.discrepancy.preparation.balance import model_states
from winch_friction.discrepancy.preparation.prepare import PreparedRun
from winch_friction.discrepancy.regressors import build_problem, layout_of
from winch_friction.discrepancy.search import Search
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.channels import beside, quotient_unit
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.friction.symbols import GROUP_SIGNALS, WINCH_SIGNALS
from winch_friction.physics.friction.term import Parameter

STEP = 1e-3  # relative change of the displacement for a derivative of the friction: small, but far above rounding
TIED = 0.9  # correlation of two estimates, from where on their best combination is at least twice as well known
RELATED = 0.5  # the same where a parameter is not known alone: less and the combination is hardly better
KNOWN = 3.0  # deviations that a parameter must be off zero to count as known alone
NEARLY_ONE = 0.02  # a factor within it of 1 is not written

e_D = Parameter("e_D", "1", 0.01, lower=-0.2, upper=0.2, doc="gain error of the displacement feedback")
e_m = Parameter("e_m", "1", 0.06, lower=-0.5, upper=0.5, doc="gain error of the load signal")


@dataclass(frozen=True)
class Member:
    """One side of a tie: an effect, correction or term by its name, in shapes whose label begins so."""

    name: str
    label: str = ""


@dataclass(frozen=True)
class Tie:
    """Two names for one column of the regression, why, and what would tell them apart; of several the last counts."""

    first: Member
    second: Member
    why: str
    separates: str
    last: bool = False  # takes no room from another name: it does the same on any runs, or is no effect of the winch
    likely: float = 0.0  # where not zero, the size up to which the second is found on any machine, and no further


_BOTH_PORTS = "T = D dp: a gain of either scales the drive torque; only the friction's own dependence on D differs"
TIES = (
    Tie(
        Member("pressure_scale", "all groups, both ports"), Member("displacement_scale", "all groups"), _BOTH_PORTS,
        "a reference gauge at the motor ports, or speed against pump flow at a known displacement",
    ),
    Tie(
        Member("pressure_scale", "the driving group, both ports"), Member("displacement_scale", "the driving group"),
        _BOTH_PORTS, "a reference gauge at the motor ports, or speed against pump flow at a known displacement",
    ),
    *(Tie(Member(name), Member("load_scale"), "a cell that is off by one share of the load in all runs does it too",
          "a weighed load, or a second load cell", last=True, likely=LIMITS.most_level)
      for name in ("layer_radius", "pressure_scale", "gear_asymmetry")),
    Tie(
        Member("layer_radius", "all layers"), Member("load_scale"), "load torque = m g R: only the product shows",
        "a weighed load, or drum turns against metres of wire", last=True,
    ),
    Tie(Member("gear_load_loss"), Member("sheave_bending"), "both take a constant share of the load's torque",
        "a load cell on the drum's side of the sheaves"),
    Tie(
        Member("brake_drag"), Member("coulomb"), "both are a constant torque against the motion",
        "the brake's release pressure, or a run with another number of motors on the shaft",
    ),
    Tie(
        Member("brake_drag"), Member("sheave_stiffness"), "a stiff rope takes a constant torque at a sheave as well",
        "the brake's release pressure, or a load cell on the drum's side of the sheaves",
    ),
    Tie(Member("motor_coulomb"), Member("coulomb"), "K4 and C2 are both a constant torque against the motion",
        "runs with another number of motors, or a motor on a test bench"),
    Tie(Member("motor_viscous"), Member("viscous"), "K1 and C5 both grow with the speed alone",
        "runs with another number of motors, or a motor on a test bench"),
    Tie(
        Member("tare_load", "hook"), Member("tare_load", "wire"), "at nearly equal wire_out the wire is a mass too",
        "the same load at a much smaller and a much larger wire_out",
    ),
)  # fmt: skip
UNSOUGHT = ("displacement_scale", "load_scale")  # sides of ties that no search looks for
WITH_UNSOUGHT = frozenset(
    tie.first.name for tie in TIES if tie.second.name in UNSOUGHT
)  # names that such a side belongs to


@dataclass(frozen=True)
class Partner:
    """A name that these runs do not tell from the one found, and by what size it would do the same."""

    tie: Tie
    size: ParameterEstimate
    factor: float  # size of the found one per size of this one
    parameter: str

    @property
    def name(self) -> str:
        """Its name."""
        return self.tie.second.name

    @property
    def note(self) -> str:
        """The tie in a sentence, with the equivalent size and what would decide."""
        value, std = beside(self.size.value, self.size.std), self.size.std
        size = f"{self.parameter} = {value:.3g} ± {std:.2g} {self.size.unit}".removesuffix(" 1")
        return (
            f"{self.tie.first.name} and {self.name} ({size}) are one thing in these runs ({self.tie.why}); "
            f"to tell them apart: {self.tie.separates}"
        )


def unsought(model: FrictionModel) -> tuple[Candidate, ...]:
    """The sides of ties that no search looks for."""
    return (
        Candidate(
            UNSOUGHT[0], r"e_D\,(\sum_g n_g D_g\,\Delta p_g - D\,\partial T/\partial D)", (e_D,),
            partial(_displacement_columns, model), group_shapes, kind="signal", hydraulic=True,
        ),
        Candidate(
            UNSOUGHT[1], r"e_m\,m\,(g+\ddot x)\,R/i", (e_m,), _load_columns, single_shape, kind="load", plain=True,
        ),
    )  # fmt: skip


def _load_columns(run: PreparedRun, _: Values) -> FloatArray:
    return hanging(run, run.load)[:, None]


def _displacement_columns(model: FrictionModel, run: PreparedRun, values: Values) -> FloatArray:
    """Torque read too high, less what the friction itself is predicted too high where it depends on D.

    The driving group's pressure is predicted from its torque: at a larger D a smaller one.
    """
    names = [signal.name for signal in GROUP_SIGNALS]
    point = list(run.point)
    for k, (group, own) in enumerate(zip(run.groups, spoken_of(run, values), strict=True)):
        at = len(WINCH_SIGNALS) + k * len(names)
        if own:
            point[at + names.index("displacement")] = point[at + names.index("displacement")] * (1.0 + STEP)
            if group.balances:
                point[at + names.index("pressure")] = point[at + names.index("pressure")] / (1.0 + STEP)
    states = model_states(model, run.point, len(run.groups), run.dt)
    more, before = (np.asarray(model.torque(tuple(x), states)) for x in (point, run.point))
    change = np.nan_to_num(np.broadcast_to((more - before) / STEP, run.time.shape))
    return np.asarray(scale_columns(run, {**values, "port_a": 0.0}) - change[:, None])


@dataclass(frozen=True)
class Company:
    """The other names of a finding, the best first, which of them are there by a tie, and which have no room."""

    rivals: tuple[str, ...]
    partners: tuple[Partner, ...]
    no_room: tuple[str, ...] = ()


def company(search: Search, found: Finding) -> Company:
    """The rivals of a finding, and what no search looks for but is tied to it or to one of them and does as well.

    A set of names has little room: of rivals and what is tied to the finding or to one of them the best on held-out
    runs stay; what is the same as another name on any runs takes only the room that is left.
    """
    model, slots = search.expansion.model, (found.slot, *found.rivals)
    names = tuple(slot.name for slot in found.rivals)
    runs = [run for run in search.expansion.runs if run.name in search.train]
    ours = {each.name: each for each in unsought(model)}
    pairs = {
        tie.second.name: (k, tie)
        for tie in TIES for k, slot in reversed(list(enumerate(slots)))
        if tie.second.name in ours and slot.name == tie.first.name and slot.label.startswith(tie.first.label)
    }  # fmt: skip
    if not pairs:
        return Company(names, (), found.no_room)
    others = [slot for slot in search.selection.final.slots if slot is not found.slot]
    fixed = [_fixed(*slot.origin) for slot in (*others, *slots)]
    fixed += [_fixed(ours[name], _shape_of(ours[name], tie.second, runs)) for name, (_, tie) in pairs.items()]
    layout, n, m = layout_of(search.expansion.layout.base, fixed, runs, model), len(others), len(slots)
    rest, own, new = layout.slots[:n], layout.slots[n : n + m], layout.slots[n + m :]
    cross = CrossFit(build_problem(runs, layout, known=(*rest, own[0])))
    without, first, *trials = (cross.explain(x) for x in (rest, *((*rest, slot) for slot in (*own, *new))))
    losses = {slot.name: trial.loss for slot, trial in zip(found.rivals, trials, strict=False)}
    partners = []
    for trial, (k, tie) in zip(trials[m - 1 :], pairs.values(), strict=True):
        found_as = _partner(tie, cross, (first, *trials)[k], trial)
        if _does_the_same(tie, found_as.size.value, trial, first, without):
            losses[tie.second.name] = float("inf") if tie.last else trial.loss
            partners.append(found_as)
    best = sorted(losses, key=lambda name: losses[name])[: LIMITS.most_names - 1]
    no_room = (*(name for name in losses if name not in best), *found.no_room)
    return Company(tuple(best), tuple(each for each in partners if each.name in best), no_room)


def _does_the_same(tie: Tie, size: float, trial: Explanation, first: Explanation, without: Explanation) -> bool:
    """Whether the data leave a tie: the other name does as well or, of a size that is `likely` on any machine, leaves
    no more of what the finding closes than a name may."""
    if not tie.likely:
        return does_as_well(trial, first, without, np.random.default_rng(0))
    closed = without.loss - trial.loss >= (1.0 - LIMITS.left_over) * (without.loss - first.loss)
    return closed and abs(size) <= tie.likely


def _shape_of(candidate: Candidate, member: Member, runs: Sequence[PreparedRun]) -> Shape:
    return next(each for each in candidate.shapes(runs) if each.label.startswith(member.label))


def _partner(tie: Tie, cross: CrossFit, found: Explanation, own: Explanation) -> Partner:
    """With the size that each of the two needs alone."""
    scale = [float(cross.problem.layout.scales[each.slots[-1].columns[-1]]) for each in (found, own)]
    before, after = (float(each.beta[-1]) * s for each, s in zip((found, own), scale, strict=True))
    std, parameter = float(np.sqrt(cross.covariance(own)[-1, -1])) * scale[1], own.slots[-1].origin[0].linear[0]
    return Partner(tie, ParameterEstimate(after, std, parameter.unit), before / after if after else 1.0, parameter.name)


def _fixed(candidate: Candidate, shape: Shape) -> Candidate:
    return replace(candidate, shapes=lambda _: [shape], brings=())


def known_combination(
    search: Search, found: Finding, estimates: Estimates, tied: Sequence[Partner], repaired: FrictionModel
) -> Combination | None:
    """What of an effect, and of what is tied to it, these runs determine; None where its parameters are known alone."""
    linear = [p.name for p in found.slot.origin[0].linear if p.name in estimates]
    own = [each for each in tied if each.tie.first.name == found.slot.name]
    if own and len(linear) == 1:
        estimate = estimates[linear[0]]
        parts = [linear[0], *(_times(each.factor, "1", each.parameter) for each in own)]
        return Combination(" ".join(parts), estimate.value, estimate.std, estimate.unit, own[0].tie.why)
    if len(linear) < 2:
        return None
    return _best_pair(_covariance(search, found, estimates, linear, repaired), estimates, linear)


def _covariance(
    search: Search, found: Finding, estimates: Estimates, linear: Sequence[str], repaired: FrictionModel
) -> FloatArray:
    """Of the estimates as reported: a new term's from the polished model, of others the search's correlation."""
    new = set(repaired.parameter_names) - set(search.given.model.parameter_names)
    if set(linear) <= new and repaired.covariance is not None:
        at = [repaired.parameter_names.index(name) for name in linear]
        return np.asarray(repaired.covariance[np.ix_(at, at)])
    cross, final = search.cross, search.selection.final
    declared = [p.name for p in found.slot.origin[0].linear]
    own = [found.slot.columns[declared.index(name)] for name in linear]
    at = [cross.problem.columns(final.slots).index(c) for c in own]
    covariance = cross.covariance(final)[np.ix_(at, at)]
    size = np.array([estimates[name].std for name in linear]) / np.sqrt(np.diag(covariance))
    return np.asarray(covariance * np.outer(size, size))


def _best_pair(covariance: FloatArray, estimates: Estimates, linear: Sequence[str]) -> Combination | None:
    """x + L y with the L that leaves it the least variance, for the two estimates that are tied most."""
    deviation = np.sqrt(np.diag(covariance))
    related = np.triu(covariance / np.outer(deviation, deviation), 1)
    known = all(abs(estimates[name].value) >= KNOWN * estimates[name].std for name in linear)
    if np.abs(related).max() < (TIED if known else RELATED):
        return None
    i, j = (int(k) for k in np.unravel_index(int(np.argmax(np.abs(related))), related.shape))
    because = f"{linear[i]} and {linear[j]} are tied in these runs, correlation {related[i, j]:.3f}"
    i, j = (j, i) if deviation[i] < deviation[j] else (i, j)  # a length or a torque of the runs, not its reciprocal
    factor = float(-covariance[i, j] / covariance[j, j])
    x, y = estimates[linear[i]], estimates[linear[j]]
    std = float(np.sqrt(max(covariance[i, i] - covariance[i, j] ** 2 / covariance[j, j], 0.0)))
    expression = f"{linear[i]} {_times(factor, quotient_unit('1', (y.unit, 1.0), (x.unit, -1.0)), linear[j])}"
    return Combination(expression, float(x.value + factor * y.value), std, x.unit, because)


def _times(factor: float, unit: str, name: str) -> str:
    """A summand with its sign, such as `+ 120 m * mu_w`."""
    sign, size = "-" if factor < 0.0 else "+", abs(factor)
    if unit == "1":
        return f"{sign} {name}" if abs(size - 1.0) <= NEARLY_ONE else f"{sign} {size:.3g} * {name}"
    return f"{sign} {size:.4g} {unit} * {name}"
