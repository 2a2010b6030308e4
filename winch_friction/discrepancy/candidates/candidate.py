"""A candidate effect: one object that says all there is to say about it.

Its law and parameters, the regressors that it would leave in the gap, what it needs and presumes, what it brings along,
where it shows, how large it may be, and how it goes into the repaired model.
"""

import itertools
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np

from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.preparation.motors import GroupSignals
from winch_friction.discrepancy.preparation.prepare import PreparedRun
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.friction import FrictionModel, Scope, symbols
from winch_friction.physics.friction.correction import Correction
from winch_friction.physics.friction.declared_correction import DECLARED
from winch_friction.physics.friction.term import Parameter, Term
from winch_friction.physics.winch import Crane

Values = Mapping[str, float]
Columns = Callable[[PreparedRun, Values], FloatArray]
Blind = Callable[[Sequence[PreparedRun]], "tuple[str, str] | None"]
Merge = Callable[[Values, Values], Mapping[str, float]]
# the winch for which typical sizes are stated: m^3/rad, motors, rad of the motor per m of wire, kg m^2
REFERENCE_MOTOR, REFERENCE_MOTORS, REFERENCE_LIFT, REFERENCE_INERTIA = 215e-6 / (2.0 * np.pi), 11, 220.0, 1.54
REFERENCE_PRESSURE, REFERENCE_GEAR = 300e5, 250.0  # Pa that its motors work at, and their turns per one of the drum
OF_DRUM = "drum_torque"  # of which each motor loses a share: a larger one where fewer share it, or turn slower
OF_WINCH = ("torque_offset", "direction_asymmetry")  # torques that grow with the number of motors as well
SOURCE, CUT = "winch-friction gap", "cut at its bound from"  # what a correction's source says
# where an effect shows: in moving samples, just after reversals, over the shaft's angle, or in the flow
MOVING, REVERSALS, ANGLE, FLOW = "moving", "just after reversals", "angle", "flow"
REFINEMENT = (1.0 / 6.0, 2.0 / 6.0, 3.0 / 6.0, 4.0 / 6.0, 5.0 / 6.0)  # of the way to the neighbour, in the logarithm


@dataclass(frozen=True)
class Shape:
    """One shape of an effect: fixed values of its shape parameters.

    `bounds` of the amplitude in typical sizes, where the shape holds only there; `carried`: an error of the passive
    side's signals, so that the driving motors carry other than they seem to.
    """

    label: str
    values: Values = field(default_factory=dict)
    bounds: tuple[float, float] | None = None
    carried: bool = False

    @property
    def part(self) -> str:
        """Which of the motor groups it speaks of; empty where it speaks of all."""
        return f"{self.values['groups']:g}" if self.values.get("groups") else ""


Shapes = Callable[[Sequence[PreparedRun]], list[Shape]]
Possible = Callable[[Values, Sequence[PreparedRun]], bool]


@dataclass(frozen=True)
class ParameterEstimate:
    """A parameter of an effect with its standard deviation, SI."""

    value: float
    std: float
    unit: str


Estimates = Mapping[str, ParameterEstimate]


@dataclass(frozen=True)
class Sides:
    """Whose transducers an effect may concern: the crane, and the motor groups that close the balance or do not; those
    `alone` close it without a passive one."""

    crane: Crane
    balancing: tuple[str, ...]
    passive: tuple[str, ...]
    alone: tuple[str, ...] = ()


Corrects = Callable[[Estimates, "Shape", Sides], list[Correction]]


@dataclass(frozen=True)
class Untestable:
    """An effect that the given channels cannot show, and the channel it would need."""

    name: str
    law: str
    needs: str
    because: str


def correction(name: str, estimate: ParameterEstimate, factor: float = 1.0, **ties: Any) -> Correction:
    """A correction of `factor` times an estimate, inside the declared bounds; `source` says where they cut it."""
    declared, value = DECLARED[name].parameter, factor * estimate.value
    inside = min(max(value, declared.lower), declared.upper)
    source = SOURCE if inside == value else f"{SOURCE}, {CUT} {value:g} {declared.unit}"
    return Correction(name, inside, abs(factor) * estimate.std, source=source, **ties)


def single_shape(_: Sequence[PreparedRun]) -> list[Shape]:
    """For effects without shape parameters."""
    return [Shape("")]


def no_columns(run: PreparedRun, _: Values) -> FloatArray:
    """For effects that leave the torque balance closed; a detector of their own looks for them."""
    raise NotImplementedError(run.name)


@dataclass(frozen=True)
class Candidate:
    """One effect that the model may lack.

    `columns(run, values)` gives the torque in N m at the shaft that each linear parameter, at one unit, adds to
    measured minus predicted, shape (samples, parameters), for given shape parameters. `linear` declares those
    parameters with typical size and bounds. `kind`: 'friction' is repaired by a `term`, 'signal', 'geometry', 'load'
    and 'inertia' by a correction.
    """

    name: str  # of the cause
    law: str = ""  # LaTeX; empty: the term's
    linear: tuple[Parameter, ...] = ()
    columns: Columns = no_columns
    shapes: Shapes = single_shape
    kind: str = "friction"
    regime: str = MOVING
    term: Term | None = None  # the friction term to put into the repaired model
    # -- which member of the cause's family it is
    law_name: str = ""  # empty: the catalogue's own law
    free: bool = False  # a monotone curve through the data instead of a law of the literature
    # -- when it is looked for
    needs: tuple[str, ...] = ()  # run columns
    varies_with: tuple[str, ...] = ()  # of what is no term: the signals that alone may show its torque
    presumes: tuple[str, ...] = ()  # terms of which the model must have one
    hydraulic: bool = False  # speaks of pressures or displacement
    blind: Blind | None = None  # (need, reason) where the runs cannot show it for a reason of its own
    # -- what is believed of it
    plausible: float = 6.0  # typical sizes
    own_size: bool = False  # its typical sizes are stated for this very machine
    of_stroke: bool = False  # an error of the displacement's feedback, not of a pressure
    plain: bool = False  # a base term that a bare model simply lacks, of any size
    brings: tuple[str, ...] = ()  # lower-order effects that belong to it
    possible: Possible | None = None  # whether over these runs a shape is still that of its cause; None: any is
    continuous: tuple[str, ...] = ()  # shape parameters on a grid over a positive quantity, refined once found
    finer: "Callable[[Shape], Candidate | None] | None" = None  # bent at more places, once one of its shapes is found
    reversal_gain: float | None = None  # share of the error just after reversals that names it there; None: never
    reversal_rival: bool = False  # may explain what happens there
    shortest: tuple[str, float] | None = None  # shape parameter and value that is within the timing's own blur
    corrects: Corrects | None = None  # how its estimates become corrections of the repaired model
    merge: Merge | None = None  # how its term melts with the same term of another shape; None: values add

    @property
    def signals(self) -> tuple[str, ...]:
        """Signals whose present values its torque depends on."""
        return self.varies_with if self.term is None else tuple(self.term.reads)

    @property
    def opposing(self) -> bool:
        """Whether it opposes the motion, alike either way; a wrong signal, load or radius acts one way."""
        return self.term is not None and self.term.opposing and symbols.s not in self.term.equation.free_symbols

    def scale(self, parameter: Parameter, sizes: Mapping[str, float]) -> float:
        """Typical size of one of its amplitudes on a machine of these `machine_sizes`, with its sign."""
        own = self.term and parameter.unit == "1" and self.term.scope is not Scope.SHAFT and OF_DRUM in self.term.reads
        unit = OF_DRUM if own else parameter.unit
        return parameter.typical * (1.0 if self.own_size else sizes.get(self.name, sizes.get(unit, 1.0)))

    @property
    def latex(self) -> str:
        """Its law in LaTeX. Rendering costs, and few of those that are tried are ever shown."""
        return self.law or (self.term.latex if self.term else "")

    def most_in(self, model: FrictionModel) -> float:
        """Largest amplitude that is believed, in typical sizes: of a bare model nothing is known yet."""
        return LIMITS.unbounded if self.plain_in(model) else self.plausible

    def plain_in(self, model: FrictionModel) -> bool:
        """Whether this is what a bare model simply lacks."""
        present = self.term is not None and self.term.name in model.term_names
        return len(model.parameters) <= LIMITS.bare and self.plain and not present

    def untestable(self, runs: Sequence[PreparedRun]) -> Untestable | None:
        """Why these runs cannot show it; None where they can."""
        present = frozenset.intersection(*(run.present for run in runs))
        if self.hydraulic and not any(run.groups for run in runs):
            return Untestable(self.name, self.latex, "pressures", "only a hydraulic drive has them")
        if self.blind is not None and (reason := self.blind(runs)) is not None:
            return Untestable(self.name, self.latex, *reason)
        missing = [name for name in self.needs if name not in present]
        if missing:
            return Untestable(self.name, self.latex, missing[0], f"no run has '{missing[0]}' throughout")
        return None

    def refined(self, shape: Shape) -> "Candidate":
        """The candidate with more shapes around one of its own: what a coarse grid leaves over must not pass for a
        second effect. Itself where it has no grid to refine; of a curve the same one with more places to bend.
        """
        if self.finer is not None:
            return self.finer(shape) or replace(self, finer=None)
        if not self.continuous:
            return self
        return replace(self, shapes=partial(_finer, self, shape), continuous=())


def _finer(candidate: Candidate, shape: Shape, runs: Sequence[PreparedRun]) -> list[Shape]:
    given = candidate.shapes(runs)
    axes = {name: _between(shape.values[name], (v.values[name] for v in given)) for name in candidate.continuous}
    # one axis at a time where there are several: neighbours of neighbours would be too many
    points = itertools.product(*axes.values()) if len(axes) < 2 else _one_by_one(axes, shape)
    finer = [{**shape.values, **dict(zip(axes, point, strict=True))} for point in points]
    # beyond its bounds a law is another cause's, and its file would be cut there
    own = [p for p in (candidate.term.parameters if candidate.term is not None else ()) if p.name in axes]
    finer = [values for values in finer if all(p.lower <= values[p.name] <= p.upper for p in own)]
    if candidate.possible is not None:
        finer = [values for values in finer if candidate.possible(values, runs)]
    return given + [replace(shape, label=label_of(values), values=values) for values in finer if values != shape.values]


def _one_by_one(axes: Mapping[str, Sequence[float]], shape: Shape) -> list[tuple[float, ...]]:
    own = [shape.values[name] for name in axes]
    return [(*own[:k], value, *own[k + 1 :]) for k, axis in enumerate(axes.values()) for value in axis]


def _between(value: float, grid: Iterable[float]) -> list[float]:
    """The value and what lies between it and its neighbours; past the end, as far as on the other side."""
    values = sorted(set(grid))
    if len(values) < 2:
        return [value]
    k = values.index(value)
    up = values[k + 1] / value if k + 1 < len(values) else value / values[k - 1]
    down = values[k - 1] / value if k > 0 else value / values[k + 1]
    return [value, *(value * ratio**step for ratio in (down, up) for step in REFINEMENT)]


def label_of(values: Values) -> str:
    """A shape in words."""
    return ", ".join(f"{name} = {value:g}" for name, value in values.items())


# -- whose transducers and feedbacks are off: all motor groups, those of one side, or one driving group alone
# the driving group of runs without a passive one (ALONE) and with one (BESIDE) may be two, each with transducers
ALL, BALANCING, OTHER, ALONE, BESIDE = 0.0, 1.0, 2.0, 3.0, 4.0

GroupLaw = Callable[[GroupSignals], FloatArray]


def affected_groups(run: PreparedRun, values: Values) -> list[GroupSignals]:
    """The motor groups whose transducers a shape speaks of."""
    return [g for g, spoken in zip(run.groups, spoken_of(run, values), strict=True) if spoken]


def spoken_of(run: PreparedRun, values: Values) -> list[bool]:
    """Whether a shape speaks of each motor group of a run."""
    which, driving = values["groups"], BESIDE if len(run.groups) > 1 else ALONE
    return [which == ALL or which in ((BALANCING, driving) if g.balances else (OTHER,)) for g in run.groups]


def group_columns(law: GroupLaw, run: PreparedRun, values: Values) -> FloatArray:
    """Sum of a law over the affected motor groups, N m at the shaft, shape (samples, 1)."""
    return sum((law(g) for g in affected_groups(run, values)), np.zeros(len(run.time)))[:, None]


def group_shapes(runs: Sequence[PreparedRun]) -> list[Shape]:
    """Which transducers are off: all alike, or, with several groups about, those of one side alone."""
    shapes = [Shape("all groups", {"groups": ALL})]
    if any(len(run.groups) > 1 for run in runs):
        shapes.append(Shape("the driving group", {"groups": BALANCING}))
        shapes.append(Shape("the passive group", {"groups": OTHER}, carried=True))
    return shapes


def driving_alone(runs: Sequence[PreparedRun]) -> tuple[str, ...]:
    """Names of the groups that close the balance of runs without a passive one."""
    return tuple(sorted({run.groups[0].name for run in runs if len(run.groups) == 1}))


def own_group_shapes(runs: Sequence[PreparedRun]) -> list[Shape]:
    """Where heave compensation drives by another group than hoisting, either of the two alone; else none."""
    alone = driving_alone(runs)
    beside = sorted({g.name for run in runs if len(run.groups) > 1 for g in run.groups if g.balances})
    if not alone or not beside or set(alone) & set(beside):
        return []
    return [
        Shape(f"the {' and '.join(names)} group alone", {"groups": which})
        for names, which in ((alone, ALONE), (beside, BESIDE))
    ]


def groups_of(shape: Shape, sides: Sides) -> tuple[str, ...]:
    """Names of the motor groups that a shape speaks of; none stands for all."""
    beside = tuple(name for name in sides.balancing if name not in sides.alone)
    named = {ALL: (), BALANCING: sides.balancing, OTHER: sides.passive, ALONE: sides.alone, BESIDE: beside}
    return named[shape.values["groups"]]
