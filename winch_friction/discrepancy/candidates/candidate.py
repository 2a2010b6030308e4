"""A candidate effect: one object that says all there is to say about it.

Its law and parameters, the regressors that it would leave in the gap, what it needs and presumes, what it brings along,
where it shows, how large it may be, and how it goes into the repaired model.
"""

import itertools
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np

from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.preparation.prepared_run import PreparedRun
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.friction.correction import Correction, declared_correction
from winch_friction.physics.friction.term import Parameter, Term
from winch_friction.physics.friction.terms.effects_motor import REFERENCE_SPEED
from winch_friction.physics.winch import Crane

Values = Mapping[str, float]
Columns = Callable[[PreparedRun, Values], FloatArray]
Blind = Callable[[Sequence[PreparedRun]], "tuple[str, str] | None"]
Merge = Callable[[Values, Values], Mapping[str, float]]
# where an effect shows: in moving samples, just after reversals, over the shaft's angle, or in the flow
SOURCE, CUT = "winch-friction gap", "cut at its bound from"
MOVING, REVERSALS, ANGLE, FLOW = "moving", "just after reversals", "angle", "flow"
# the winch for which typical sizes are stated: m^3/rad, motors, rad of the motor per m of wire, kg m^2
REFERENCE_MOTOR, REFERENCE_MOTORS, REFERENCE_LIFT, REFERENCE_INERTIA = 215e-6 / (2.0 * math.pi), 11, 220.0, 1.54
LINE, CHURNING = "line_pressure_drop", "churning"
OF_WINCH = ("torque_offset", "direction_asymmetry")
CHURNS, TOP = 1.9, 0.999  # exponent of churning at its typical value; share of the samples that are slower than the top
SLOWEST_TOP = 20.0  # rad/s; a winch that runs no faster shows no churning
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
    declared, value = declared_correction(name).parameter, factor * estimate.value
    inside = min(max(value, declared.lower), declared.upper)
    source = SOURCE if inside == value else f"{SOURCE}, {CUT} {value:g} {declared.unit}"
    return Correction(name, inside, abs(factor) * estimate.std, source=source, **ties)


def machine_sizes(runs: Sequence[PreparedRun]) -> Mapping[str, float]:
    """How an amplitude of each unit grows with the machine, relative to the winch for which typical sizes are stated: a
    motor's torque with its displacement, that of all of them (`OF_WINCH`) also with their number, masses with what the
    winch lifts at one pressure, a resistance (also one that is stated at a fixed flow, under `LINE`) with the square of
    its flow, and what is stated at a fixed speed, under `CHURNING`, as much at a slow machine's own top speed. Empty
    where no run shows motors.
    """
    run = runs[0]
    swept = dict(run.constants).get("max_displacement", 0.0)
    motors = max((sum(group.count for group in each.groups) for each in runs), default=0)
    if not swept or not motors:
        return {}
    one, whole = swept / REFERENCE_MOTOR, motors * swept / (REFERENCE_MOTORS * REFERENCE_MOTOR)
    lift = whole * (run.gear_ratio / max(float(each.radius.max()) for each in runs)) / REFERENCE_LIFT
    torques = dict.fromkeys(("N*m", "N*m*s/rad", "m^3/rad", "m^5/N"), one)
    top = max(float(np.quantile(np.abs(each.speed), TOP)) for each in runs)
    churned = one * max(REFERENCE_SPEED / max(top, SLOWEST_TOP), 1.0) ** CHURNS
    stated_at = {LINE: whole**-2, CHURNING: churned, **dict.fromkeys(OF_WINCH, whole)}
    return {**torques, **stated_at, "kg": lift, "kg/m": lift, "kg*m^2": run.inertia / REFERENCE_INERTIA}


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
    finer: "Callable[[], Candidate | None] | None" = None  # the same curve bent at more places, once it is found
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
        """Whether it opposes the motion; a wrong signal, load or radius acts one way."""
        return self.term is not None and self.term.opposing

    def scale(self, parameter: Parameter, sizes: Mapping[str, float]) -> float:
        """Typical size of one of its amplitudes on a machine of these `machine_sizes`, with its sign."""
        if self.own_size:
            return parameter.typical
        return parameter.typical * sizes.get(self.name, sizes.get(parameter.unit, 1.0))

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
            return Untestable(self.name, self.latex, "pressures", "an electric drive has none")
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
            return self.finer() or replace(self, finer=None)
        if not self.continuous:
            return self
        return replace(self, shapes=partial(_finer, self, shape), continuous=())


def _finer(candidate: Candidate, shape: Shape, runs: Sequence[PreparedRun]) -> list[Shape]:
    given = candidate.shapes(runs)
    axes = {name: _between(shape.values[name], (v.values[name] for v in given)) for name in candidate.continuous}
    # one axis at a time where there are several: neighbours of neighbours would be too many
    points = itertools.product(*axes.values()) if len(axes) < 2 else _one_by_one(axes, shape)
    finer = [{**shape.values, **dict(zip(axes, point, strict=True))} for point in points]
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
