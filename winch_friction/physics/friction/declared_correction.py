"""What may be wrong with signals, geometry, load and inertia: every correction declared once, as data.

A friction term says what the machine loses; a correction says what its log or its crane file has wrong. The value is
the error itself: `pressure_offset` = +1.5 bar means that the log shows 1.5 bar too much. `physics.corrections` takes it
out of runs and cranes, `physics.sample_corrections` out of what a node reads; the simulator puts it into its sensors
from the same declarations.
"""

from dataclasses import dataclass
from enum import Enum
from typing import Any

from winch_friction.physics.channels import BAR, CM3_PER_REV
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction.term import Parameter


class Action(Enum):
    """What an error of value e does; the true value stands on the right."""

    OFFSET = "offset"  # measured = true + e (times a power of the oil's degrees above 40 degC where that is named)
    SCALE = "scale"  # measured = true (1 + e), e times the oil's degrees above 40 degC where that is named
    CURVATURE = "curvature"  # measured = true (1 + e true)
    BEND = "bend"  # measured = true + e (true - beyond) from `beyond` on, true below
    S_SHAPE = "s_shape"  # measured = true + e s(x), s = 6 sqrt(3) x (1 - x) (1 - 2 x), x = true / beyond: at most e
    DELAY = "delay"  # measured(t) = true(t - e)
    FILTER = "filter"  # true = measured + e d(measured)/dt: a first-order lag with the time constant e
    MASS = "mass"  # hook_load = true mass - e (times wire_out where it is named)
    RADIUS = "radius"  # rope radius = crane file's + e
    INERTIA = "inertia"  # inertia at the shaft = crane file's + e
    WARMTH = "warmth"  # true gas pressure = calculated (1 + e exp(-t/tau)), tau the correction's time constant
    HEAT = "heat"  # true gas pressure = calculated (1 - e <ln p>_tau), what has relaxed of ln p since the start
    SLIP = "slip"  # speed_reference = true + e f(dp, mu_40/mu)/D: what leaks away is not reached
    AIR = "air"  # speed_reference = true + e dv/dt/(n D), v what a unit of free air gives way to under the pressures


@dataclass(frozen=True)
class DeclaredCorrection:
    """One kind of error.

    `parameter`: its unit, typical size and the bounds beyond which it is not physical. `kind`: signal, geometry, load
    or inertia. `channels`: the run columns (a group's channel without the group) that are wrong; `reads`: further
    columns that the correction needs. `by_group`, `by_layer`: whether it may be tied to motor groups or wire layers;
    `has_time_constant`: whether it fades over one, or fills up within one; `live`: whether a running node can take it
    out; `grows`: whether it comes in proportion to the time within `during`, and stays.
    """

    name: str
    parameter: Parameter
    kind: str
    action: Action
    channels: tuple[str, ...] = ()
    reads: tuple[str, ...] = ()
    by_group: bool = False
    by_layer: bool = False
    has_time_constant: bool = False
    live: bool = True
    grows: bool = False
    bends_in: str = ""  # unit of `beyond`
    course: str = ""  # of a delay over a run: clock, buffer, backlog, drawn (`lateness`); empty: it stays
    by_warmth: int = 1  # power of what the oil is above 40 degC, where that is read

    @property
    def doc(self) -> str:
        """What it is, in words."""
        return self.parameter.doc

    @property
    def late(self) -> bool:
        """Whether it is when a signal was logged that is wrong, of whatever a run has of these channels."""
        return self.action in LATE


LATE = (Action.DELAY, Action.FILTER)
ONLY_LATE = ("buffer", "drawn")  # courses of a delay that make nothing early, as no filter does
_PRESSURES = ("pressure_a", "pressure_b")
_SPEED = ("motor_speed", "drum_speed", "shaft_angle")
_DRIVE = (*_PRESSURES, "motor_torque")
_OIL = ("oil_temperature",)


def _signal(
    name: str, action: Action, unit: str, typical: float, reach: float, doc: str, *channels: str, **more: Any
) -> DeclaredCorrection:
    lower = 0.0 if action is Action.FILTER or more.get("course") in ONLY_LATE else -reach
    parameter = Parameter(name, unit, typical, lower=lower, upper=reach, doc=doc)
    by_group = any(channel in (*_PRESSURES, "displacement") for channel in channels) and action not in LATE
    return DeclaredCorrection(name, parameter, "signal", action, channels, by_group=by_group, **more)


def _gains(name: str, action: Action, *size: Any, per: str = "", **more: Any) -> tuple[DeclaredCorrection, ...]:
    """Of both transducers of a group, and of that at port A alone; `size`: unit, typical and largest value."""
    both, one = f"gain error of the transducers at both ports{per}", f"gain error of the transducer at port A{per}"
    own = _signal(name, action, *size, both, *_PRESSURES, **more)
    return own, _signal(f"{name}_a", action, *size, one, "pressure_a", **more)


def _late(
    name: str, unit: str, typical: float, reach: float, doc: str, action: Action = Action.DELAY, **more: Any
) -> tuple[DeclaredCorrection, ...]:
    """Of the speed, and of the pressures or what else tells the drive's torque."""
    size, more = (action, unit, typical, reach), {"live": False, **more}
    return (
        _signal(f"signal_{name}", *size, doc.format("the speed is"), *_SPEED, **more),
        _signal(f"pressure_{name}", *size, doc.format("the pressures (or the motor torque) are"), *_DRIVE, **more),
    )


def _gas(name: str, action: Action, typical: float, reach: float, doc: str) -> DeclaredCorrection:
    # a running node does not know when the gas was last at rest
    return DeclaredCorrection(
        name, Parameter(name, "1", typical, lower=-reach, upper=reach, doc=doc), "signal", action, ("pressure_a",),
        reads=("pressure_b",), by_group=True, has_time_constant=True, live=False,
    )  # fmt: skip


def _leakage(name: str, doc: str) -> DeclaredCorrection:
    return DeclaredCorrection(
        name, Parameter(name, "m^3/s/Pa", 1.4e-11, 0.0, 1e-9, doc=doc), "signal", Action.SLIP, ("speed_reference",),
        reads=("pressure_a", "pressure_b", "displacement"), by_group=True, live=False,
    )  # fmt: skip


_DECLARED = (
    _signal("pressure_offset", Action.OFFSET, "Pa", 1.5 * BAR, 50 * BAR, "zero error of the transducers at port A",
            "pressure_a"),
    _signal("pressure_thermal_zero", Action.OFFSET, "Pa/K", 0.1 * BAR, 5.0 * BAR,
            "zero error of the transducers at port A per degree of the oil above 40 degC", "pressure_a", reads=_OIL),
    _signal("pressure_thermal_bow", Action.OFFSET, "Pa/K^2", 5e-3 * BAR, 0.2 * BAR,
            "the same per square degree", "pressure_a", reads=_OIL, by_warmth=2),
    *_gains("pressure_scale", Action.SCALE, "1", 0.01, 0.2),
    *_gains("pressure_thermal_span", Action.SCALE, "1/K", 5e-4, 0.01, per=" per degree of the oil above 40 degC",
            reads=_OIL),
    *_gains("pressure_curvature", Action.CURVATURE, "1/Pa", 0.01 / (200 * BAR), 0.1 / (200 * BAR), per=" per pressure"),
    _signal("pressure_bend", Action.BEND, "1", 0.02, 0.5,
            "gain error of the transducers at both ports beyond a pressure", *_PRESSURES, bends_in="Pa"),
    _signal("displacement_offset", Action.OFFSET, "m^3/rad", CM3_PER_REV, 20 * CM3_PER_REV,
            "zero error of the displacement feedback", "displacement"),
    _signal("displacement_thermal_zero", Action.OFFSET, "m^3/rad/K", 0.1 * CM3_PER_REV, 2.0 * CM3_PER_REV,
            "zero error of the displacement feedback per degree of the oil above 40 degC", "displacement", reads=_OIL),
    _signal("pressure_creep", Action.OFFSET, "Pa", 3.0 * BAR, 50 * BAR,
            "zero error of the transducers at port A that has come within the given time, and stays", "pressure_a",
            grows=True),
    _signal("displacement_scale", Action.SCALE, "1", 0.01, 0.2, "gain error of the displacement feedback",
            "displacement"),
    _signal("displacement_curvature", Action.CURVATURE, "rad/m^3", 100.0, 1e4,
            "gain error of the displacement feedback per displacement", "displacement"),
    _signal("displacement_bend", Action.BEND, "1", 0.02, 0.5, "gain error of the feedback beyond a displacement",
            "displacement", bends_in="m^3/rad"),
    _signal("displacement_s_shape", Action.S_SHAPE, "m^3/rad", CM3_PER_REV, 20 * CM3_PER_REV,
            "error of the feedback at a fifth of a stroke, the opposite at four fifths, none at half and at its ends",
            "displacement", bends_in="m^3/rad"),
    *_late("delay", "s", 0.05, 0.5, "how late {} logged"),
    *_late("clock", "1", 1e-3, 5e-3, "how late {} logged, per second since the run began", course="clock"),
    *_late("buffer", "s", 0.1, 0.5, "how late {} logged when a buffer is full, which is emptied when a run begins and "
           "every time constant from then on", course="buffer", has_time_constant=True),
    *_late("backlog", "s", 0.1, 0.5, "how late {} logged when a run begins, by what is worked off over a time constant",
           course="backlog", has_time_constant=True),
    *_late("course", "s", 0.1, 0.5, "how late {} logged, by another share of it at each time since the run began",
           course="drawn"),
    *_late("filter", "s", 0.05, 0.5, "time constant of the first-order filter behind which {} logged", Action.FILTER),
    DeclaredCorrection(
        "layer_radius", Parameter("layer_radius", "m", 0.06, -0.5, 0.5, doc="what the crane file's rope radius lacks"),
        "geometry", Action.RADIUS, by_layer=True,
    ),
    *(DeclaredCorrection(
        name, Parameter(name, "kg", 2000.0, -2e4, 2e4, doc=f"mass that hook_load does not contain{grown}"),
        "load", Action.MASS, ("hook_load",), grows=bool(grown),
    ) for name, grown in (("tare_load", ""), ("tare_creep", ", that has come within the given time, and stays"))),
    DeclaredCorrection(
        "wire_weight",
        Parameter("wire_weight", "kg/m", 12.0, 0.0, 200.0, doc="weight of the wire paid out, not in hook_load"),
        "load", Action.MASS, ("hook_load",), reads=("wire_out",),
    ),
    DeclaredCorrection(
        "inertia", Parameter("inertia", "kg*m^2", 0.2, -1e5, 1e5, doc="inertia that the crane file lacks"),
        "inertia", Action.INERTIA,
    ),
    _gas(
        "accumulator_warmth", Action.WARMTH, 0.02, 0.2,
        "relative excess temperature of the gas at the start, of a pressure that is calculated",
    ),
    _gas("accumulator_slow_warmth", Action.WARMTH, 0.02, 0.2, "a part of it that fades more slowly"),
    _gas(
        "accumulator_heat", Action.HEAT, 1.0, 10.0,
        "share of the compression's heat that the wall takes, of a pressure that is calculated",
    ),
    _leakage("slip_leakage", "leakage per motor at 40 degC that slows it"),
    _leakage("orifice_leakage", "leakage per motor through an orifice, at 150 bar, that slows it"),
    _leakage("opening_gap_leakage", "leakage per motor through gaps that pressure opens, at 150 bar and 40 degC"),
    _leakage("isoviscous_leakage", "leakage per motor through gaps whose oil is as thick whatever the tank's"),
    DeclaredCorrection(
        "entrained_air",
        Parameter("entrained_air", "m^3", 6e-4, 0.0, 0.1, doc="free air of one line, at 1 bar"),
        "signal", Action.AIR, ("speed_reference",), reads=("pressure_a", "pressure_b", "displacement"),
        by_group=True, live=False,
    ),
)  # fmt: skip
DECLARED: dict[str, DeclaredCorrection] = {each.name: each for each in _DECLARED}


def declared_correction(name: str) -> DeclaredCorrection:
    """The declaration of that name; an unknown one raises `InputError` with the names there are."""
    if name not in DECLARED:
        raise InputError(f"correction '{name}' is not known; known corrections are {', '.join(DECLARED)}")
    return DECLARED[name]
