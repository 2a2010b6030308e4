"""A candidate effect: its law, its parameters, what it needs, and the regressors it would leave in the gap."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from winch_friction.discrepancy.preparation.prepared_run import PreparedRun
from winch_friction.physics.friction.term import Parameter, Term
from winch_friction.physics.signals import FloatArray

Shape = Mapping[str, float]
Columns = Callable[[PreparedRun, Shape], FloatArray]
Shapes = Callable[[Sequence[PreparedRun]], "list[Variant]"]


@dataclass(frozen=True)
class Variant:
    """One shape of an effect: fixed values of its shape parameters, and which of its linear parameters it uses.

    `carried`: an error of the passive side's signals, so that the driving motors carry other than they seem to.
    """

    label: str
    shape: Shape = field(default_factory=dict)
    bounds: tuple[float, float] | None = None  # of the amplitude in typical sizes, where the shape holds only there
    carried: bool = False


@dataclass(frozen=True)
class Candidate:
    """One effect that the model may lack.

    `columns(run, shape)` gives the torque in N m at the shaft that each linear parameter, at one unit, adds to
    measured minus
    predicted, shape (samples, parameters). `linear` declares those parameters with typical size and bounds;
    `plausible` times the
    typical size is the largest amplitude that is believed. `needs` names run columns; `presumes` names terms of which
    the model must have one; `term` is the friction term to put into the repaired model, None for what is corrected
    in a signal.
    `continuous` names the shape parameters whose values are a grid over a positive quantity, to be refined once found.
    `brings` names lower-order effects that belong to it. `regime`: 'moving' samples, or 'turning' for what shows
    only around reversals.
    """

    name: str
    law: str
    linear: tuple[Parameter, ...]
    columns: Columns
    shapes: Shapes
    kind: str = "friction"
    needs: tuple[str, ...] = ()
    presumes: tuple[str, ...] = ()
    term: Term | None = None
    regime: str = "moving"
    plausible: float = 6.0
    hydraulic: bool = False
    brings: tuple[str, ...] = ()
    continuous: tuple[str, ...] = ()


@dataclass(frozen=True)
class Untestable:
    """An effect that the given channels cannot show, and the channel it would need."""

    name: str
    law: str
    needs: str
    because: str


def single_shape(_: Sequence[PreparedRun]) -> list[Variant]:
    """For effects without shape parameters."""
    return [Variant("")]
