"""Candidates that are declared friction terms: their regressors are the term's own derivatives by its parameters.

A law whose own speed lies where no run has been keeps its name and loses its shape: what it draws there is another
cause's, and the name would be given for what it does not say.
"""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from winch_friction.discrepancy.candidates.candidate import (
    OF_WINCH,
    REFERENCE_MOTORS,
    REVERSALS,
    Candidate,
    Possible,
    Shape,
    Shapes,
    Values,
    label_of,
)
from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.preparation.balance import state_history
from winch_friction.discrepancy.preparation.prepare import PreparedRun, samples_of_each
from winch_friction.physics.friction import term_named
from winch_friction.physics.friction.compiled import compiled
from winch_friction.physics.friction.table import outlined
from winch_friction.physics.friction.term import Term
from winch_friction.physics.friction.terms.laws_motor import POLE, VOGEL_46

Grid = Mapping[str, tuple[float, ...]]
COULOMB = ("coulomb", "motor_coulomb")
STRIBECK_SHARES = (0.05, 0.075, 0.11, 0.17)  # of the largest speed
BRISTLE_TRAVEL = (0.009, 0.02, 0.04, 0.09)  # rad of the shaft, 0.5 to 5 degrees
AT_ONCE = 16384  # samples: what an equation makes on the way is then 128 KB a piece, and stays in the processor's cache
ONSET = (0.15, 0.3, 0.45, 0.6)  # of the largest load: from less on it is in proportion, from more on few runs have any
SATURATED = (0.1, 0.3)  # of the largest load: less is Coulomb friction in all runs, more is in proportion to it
LOADS_APART = 1.3  # times the least load, for a law of the load to have a shape
TYPICAL_DRUM_TORQUE = 4e5  # N m, to weigh the two coefficients of a Stribeck curve


def one_load(runs: Sequence[PreparedRun]) -> tuple[str, str] | None:
    """Why these runs cannot show the shape of a law of the load; None where they can."""
    loads = [float(np.median(run.load)) for run in runs]
    if max(loads) > LOADS_APART * min(loads):
        return None
    return "runs with different loads", "at one load what depends on it is a constant"


def no_load(runs: Sequence[PreparedRun]) -> tuple[str, str] | None:
    """What is proportional to the load shows only where something hangs on the drum."""
    return None if any(np.any(run.drum_torque != 0.0) for run in runs) else ("hook_load", "no run has a load")


def shipped_friction() -> list[Candidate]:
    """The catalogue's friction effects and the base terms, each in one line."""
    return [
        _of("viscosity_temperature", needs=("oil_temperature",)),
        _of("stribeck", shapes=_stribeck_shapes, continuous=("C4",), merge=_one_stribeck, plain=True,
            reversal_rival=True),
        _of("dwell_stiction", {"g_dw": (0.4,), "d_dw": (0.5, 1.0, 2.0, 5.0)}, reversal_gain=0.1, reversal_rival=True),
        _of("gear_asymmetry", {"b_g": (0.0,)}, blind=no_load),
        _of("gear_load_loss", plain=True, blind=no_load),
        _of("sheave_bending", presumes=("gear_load_loss",), blind=no_load),
        _of("wear_drift", shapes=observed_time("t_w", "tau_w"), presumes=COULOMB),
        _of("low_displacement_loss"),
        _of("port_turbulence", {"n_t": (1.5, 2.0, 2.5)}),
        _of("notch_loss"),
        _of("churning", {"n_ch": (1.5, 1.9, 2.5)}),
        _of("high_pressure_mixed"),
        _of("line_pressure_drop"),
        _of("case_pressure"),
        _of("brake_drag", presumes=COULOMB),
        _of("coulomb", plain=True, reversal_rival=True),
        _of("viscous", plain=True, reversal_rival=True),
        _of("torque_offset", plain=True),
        # marginality: the slope of what depends on direction is never taken without its intercept
        _of("direction_asymmetry", plain=True, brings=("torque_offset",)),
        # every imperfection of timing looks like a little presliding, and a very short travel is within its blur
        _of("presliding", {"d_z": BRISTLE_TRAVEL}, regime=REVERSALS, reversal_gain=0.3, reversal_rival=True,
            shortest=("d_z", min(BRISTLE_TRAVEL))),
    ]  # fmt: skip


def _of(name: str, grid: Grid | None = None, **more: Any) -> Candidate:
    term = term_named(name)
    if name in OF_WINCH:  # a torque of the whole winch, of which the term states what is typical of one motor
        more = {"linear": tuple(replace(p, typical=REFERENCE_MOTORS * p.typical) for p in term.parameters), **more}
    return friction_candidate(term, grid or {}, **more)


def friction_candidate(term: Term, grid: Grid | None = None, **more: Any) -> Candidate:
    """A candidate from a declared term, a user's own included.

    `grid` gives the values over which shape parameters are profiled; others take their typical value times 0.5, 1, 2.
    `more` are fields of `Candidate`.
    """
    values = _grid(term, grid or {})
    declared, tried = {p.name: p for p in term.parameters}, () if "shapes" in more else values.items()
    fields: dict[str, Any] = {
        "continuous": tuple(name for name, v in tried if len(v) > 1 and declared[name].lower > 0.0),
        "shapes": _shapes_over(values, [p.name for p in term.parameters if p.unit == "rad/s"]),
        "hydraulic": any(name in term.reads for name in ("pressure", "pressure_sum", "displacement")),
    }
    linear = tuple(p for p in term.parameters if not p.shape)
    return Candidate(term.name, columns=partial(term_columns, term), term=term, **({"linear": linear} | fields | more))


def _grid(term: Term, given: Grid) -> Grid:
    usual = {
        p.name: tuple(v for v in (p.typical * factor for factor in (0.5, 1.0, 2.0)) if p.lower <= v <= p.upper)
        for p in term.parameters
        if p.shape
    }
    return usual | dict(given)


def _shapes_over(grid: Grid, speeds: Sequence[str] = ()) -> Shapes:
    """Every point of a grid; its `speeds` follow a machine that turns slowly, in octaves."""

    def shapes(runs: Sequence[PreparedRun]) -> list[Shape]:
        top = max(_top(runs), 1e-3) if speeds else FULL_SPEED
        # down, never up: a curve as wide as half of what was run is a constant there, and that is Coulomb friction
        slow = 2.0 ** np.floor(np.log2(top / FULL_SPEED)) if top < 0.5 * FULL_SPEED else 1.0
        own = {name: tuple(slow * v if name in speeds else v for v in tried) for name, tried in grid.items()}
        points = (dict(zip(own, point, strict=True)) for point in itertools.product(*own.values()))
        return [Shape(label_of(values), values) for values in points]

    return shapes


def _stribeck_shapes(runs: Sequence[PreparedRun]) -> list[Shape]:
    """Widths of the curve as shares of the speeds that were run."""
    top = max(run.top_speed for run in runs)
    return [Shape(label_of({"C4": top * share}), {"C4": top * share}) for share in STRIBECK_SHARES]


def _one_stribeck(at: Values, own: Values) -> Mapping[str, float]:
    """The one exponential nearest to the sum of two over speed (rad/s), for the two load coefficients."""
    from scipy.optimize import least_squares  # a fifth of a second, for few models come here

    speed = np.linspace(0.5, 4.0 * max(at["C4"], own["C4"]), 60)
    first, second = np.exp(-speed / at["C4"]), np.exp(-speed / own["C4"])
    load = [at["C1"] * first + own["C1"] * second, at["C3"] * first + own["C3"] * second]

    def misfit(q: FloatArray) -> FloatArray:
        shape = np.exp(-speed / q[2])
        return np.concatenate([(q[0] * shape - load[0]) * TYPICAL_DRUM_TORQUE, q[1] * shape - load[1]])

    start = [at["C1"] + own["C1"], at["C3"] + own["C3"], 0.5 * (at["C4"] + own["C4"])]
    best = least_squares(misfit, start, x_scale=[1e-5, 1.0, 10.0]).x
    return {"C1": float(max(best[0], 0.0)), "C3": float(max(best[1], 0.0)), "C4": float(best[2])}


def observed_time(at: str, over: str, most: int = 4) -> Shapes:
    """Straight lines over the dates, by where they are zero, in lengths of the observed time; the first `most`, for
    of those that began long before the first run little is a drift and most a constant."""
    zeros = {
        "since the first run": 0.0, "around the middle of the dates": 0.5, "since well before the first run": -0.5,
        "since long before the first run": -1.0,
    }  # fmt: skip

    def shapes(runs: Sequence[PreparedRun]) -> list[Shape]:
        begin, end = min(run.start for run in runs), max(run.start + run.time[-1] for run in runs)
        span = max(end - begin, 1.0)
        return [Shape(label, {at: begin + share * span, over: span}) for label, share in [*zeros.items()][:most]]

    return shapes


def lags(start: str, lag: str, shares: tuple[float, ...]) -> Shapes:
    """Drifts from the first run on whose time is a share of the observed time."""

    def shapes(runs: Sequence[PreparedRun]) -> list[Shape]:
        begin, end = min(run.start for run in runs), max(run.start + run.time[-1] for run in runs)
        found = [{start: begin, lag: max((end - begin) * share, 1.0)} for share in shares]
        return [Shape(label_of(values), values) for values in found]

    return shapes


def loads(name: str, shares: Sequence[float]) -> Shapes:
    """Drum torques N m as shares of the largest that was run."""

    def shapes(runs: Sequence[PreparedRun]) -> list[Shape]:
        top = max(max(float(np.max(run.drum_torque)) for run in runs), 1.0)
        return [Shape(label_of({name: top * share}), {name: top * share}) for share in shares]

    return shapes


def between_runs(name: str) -> Shapes:
    """Every instant between two runs, with at least two on either side: one run alone is no change of the machine."""

    def shapes(runs: Sequence[PreparedRun]) -> list[Shape]:
        ends = sorted((run.start, run.start + float(run.time[-1])) for run in runs)
        between = [0.5 * (a[1] + b[0]) for a, b in itertools.pairwise(ends)]
        return [Shape(label_of({name: at}), {name: at}) for at in between[1:-1]]

    return shapes


def term_columns(term: Term, run: PreparedRun, values: Values) -> FloatArray:
    """Torque at the shaft per unit of each linear parameter, N m, shape (samples, parameters)."""
    if term.table is not None:
        term, knots = outlined(term.table)
        values = {**values, **knots}
    functions = compiled((term,), len(run.groups), run.constants)
    theta = tuple(values.get(p.name, 1.0) for p in functions.parameters)
    z = state_history(functions, run.point, theta, run.dt)
    columns = np.empty((sum(not p.shape for p in functions.parameters), len(run.time))).T  # each by itself in memory
    with np.errstate(all="ignore"):
        for at in range(0, len(columns), AT_ONCE):
            some = slice(at, at + AT_ONCE)
            parts = functions.vector_columns(samples_of_each(run.point, some), theta, samples_of_each(z, some))
            for k, part in enumerate(parts):
                columns[some, k] = part
        whole = np.isfinite(columns.sum())
    return columns if whole else np.nan_to_num(columns, copy=False)


def without_memory(candidate: Candidate) -> bool:
    """Whether its columns are a term's, which hang on what is at the same instant alone."""
    own = candidate.columns
    return isinstance(own, partial) and own.func is term_columns and own.args[0].state is None


# -- the speeds that were seen
CLEAR = 3.0  # times the travel in which the instant of a reversal is uncertain, from where on travel is no timing
BEYOND, MOVING_SPEED = 0.25, 1.0  # s and rad/s: a reversal is real where the shaft turns either way so long about it
FULL_SPEED = 100.0  # rad/s, of motors for which speeds of laws are stated; one of large stroke turns at a tenth
STEEPEST = 2.0  # exponent of a port's D beyond that of w: 1 of the torque, 1 of a passage that narrows with the stroke
TURBULENT = 2.5  # exponent of a flow: 2, and what a valve adds that its own flow draws shut
SIDES = {"n_ld": {True}, "n_la": {True, False}, "n_lp": {True}}  # runs with a passive side, and without
WIDEST = 0.5  # of the largest speed, for a curve that falls with it: a wider one is a constant


def _top(runs: Sequence[PreparedRun]) -> float:
    """Largest speed of the runs but for outliers, rad/s."""
    return max((run.top_speed for run in runs), default=np.inf)


def stribeck(values: Values, runs: Sequence[PreparedRun]) -> bool:
    """A Stribeck speed that the runs go well beyond: a wider curve is a constant, and that is Coulomb friction."""
    return all(v < WIDEST * _top(runs) for name, v in values.items() if name.startswith("v_"))


def hersey(values: Values, runs: Sequence[PreparedRun]) -> bool:
    """The same of the curve whose speed follows the oil, at the oil temperature of the runs: its speed is stated at a
    reference where no oil may have been, and beyond all that was driven it is a loss of the load, not of the oil."""
    if "C4_h" not in values or not runs or not all("oil_temperature" in run.channels for run in runs):
        return True
    oil = float(np.median([np.median(run.channels["oil_temperature"]) for run in runs]))
    thick = float(np.exp(VOGEL_46 / (oil + POLE) - VOGEL_46 / (values["T_vh"] + POLE)))
    return bool(values["C4_h"] / thick < WIDEST * _top(runs))


def notch(values: Values, runs: Sequence[PreparedRun]) -> bool:
    """A maximum over the speed that the runs have reached: below it a notch's loss only rises, as a flow's does."""
    return all(v < _top(runs) for name, v in values.items() if name.startswith("w_"))


def blurred_travel(runs: Sequence[PreparedRun]) -> float:
    """Median travel of the shaft, rad, within three samples of a reversal: of less nothing is told; 0 without one."""
    travels = []
    for run in runs:
        speed, look = run.speed, max(round(BEYOND / run.dt), 2)
        at = np.flatnonzero(speed[:-1] * speed[1:] < 0.0)
        at = at[(at >= look) & (at < len(speed) - look)]
        real = at[(np.abs(speed[at - look]) > MOVING_SPEED) & (np.abs(speed[at + look]) > MOVING_SPEED)]
        travels += [float(np.abs(speed[k + 1 : k + 4]).sum() * run.dt) for k in real]
    return float(np.median(travels)) if travels else 0.0


def presliding(values: Values, runs: Sequence[PreparedRun]) -> bool:
    """A travel well beyond that in which nobody knows when the shaft turned; for others: `search.after_reversals`."""
    return values["d_z"] > CLEAR * blurred_travel(runs)


def line(values: Values, runs: Sequence[PreparedRun]) -> bool:
    """A line loses by the square of its flow, a valve by a little more; what grows faster still is a motor's port. One
    side has a line of its own where another stands beside it, and is told apart as such where it also runs alone."""
    beside = {len(run.groups) > 1 for run in runs}
    return all(v <= TURBULENT and beside >= SIDES.get(n, set()) for n, v in values.items() if n.startswith("n_"))


def port(values: Values, _: Sequence[PreparedRun] = ()) -> bool:
    """Oil through a port loses D (D w)^n; what is far steeper in D follows the flow of one group alone."""
    return all(values[f"m_{law}"] <= values[f"n_{law}"] + STEEPEST for law in ("pp", "po") if f"m_{law}" in values)


POSSIBLE: Mapping[str, Possible] = {
    "stribeck": stribeck, "viscosity_temperature": hersey, "notch_loss": notch, "presliding": presliding,
    "line_pressure_drop": line, "port_turbulence": port,
}  # fmt: skip
