"""What comes late: the clock of a signal, the network it is sent over, the filter that it stands behind.

A delay of the speed behind the pressures, or of the pressures behind the speed, that stays, grows, comes and goes or
takes a course of its own within a run.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from winch_friction.discrepancy.candidates.candidate import Candidate, Estimates, Shape, Sides, Values, correction
from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.preparation.prepare import PreparedRun
from winch_friction.physics.friction.correction import Correction
from winch_friction.physics.friction.declared_correction import DECLARED
from winch_friction.physics.friction.term import Parameter

DELAY = "signal_delay"
DELAYS = (0.05, 0.07, 0.1, 0.14, 0.2, 0.28)  # s, each as far from its neighbours as a difference over it bears
SMALL = 0.8  # of the typical delay: the largest that the columns of a small one can be
NEXT = 1.25  # times a delay, beyond which the next one on the grid says it better
SLOWEST_FOR_DELAY = 0.055  # s between samples: half a delay of 0.1 s
PRESSURES, SPEED = 1.0, 0.0  # what is late, and shifted with it: all that is predicted, or what the speed tells of it
CLOCKED = 100.0  # s from a run's beginning, by when a clock that drifts is late by what is said of it
# how a delay changes within a run, by its time constant: it grows and starts again, is worked off, or comes to stay; or
# as the data draw it, by the time between two points
FILLS_IN, DRAINS_IN, SETTLES_IN, DRAWN_IN = "fills_in", "drains_in", "settles_in", "drawn_in"
CHANGES = {
    FILLS_IN: {"buffer": 1.0}, DRAINS_IN: {"backlog": 1.0}, SETTLES_IN: {"delay": 1.0, "backlog": -1.0},
    DRAWN_IN: {"course": 1.0},
}  # fmt: skip
POINT = "point_"  # before the number of a drawn course's point, whose value is its share of the delay
SMALL_DELAY = {"ahead": 0.03, "behind": 0.03, "late": SPEED}  # s

tau = Parameter("tau", "s", 0.05, lower=-0.5, upper=0.5, doc="delay of the speed behind the pressures")


def late_signal() -> Candidate:
    """A delay; what it is where it changes within a run, a detector tells (`detectors.delay`)."""
    return Candidate(
        DELAY, r"\tau\,\dot M", (tau,), delay_columns, _delay_shapes, kind="signal", reversal_rival=True,
        blind=_too_slow, corrects=_to_delay,
    )  # fmt: skip


def delay_columns(run: PreparedRun, values: Values) -> FloatArray:
    """Change of the predicted drive torque per second of delay, N m/s: a speed that comes late makes pressures come
    early.

    A difference over the delay itself, since friction turns over faster than a derivative could follow. A late speed
    leaves the heave as it is logged.
    """
    shifted = run.predicted if values["late"] == PRESSURES else run.from_speed
    ahead = np.interp(run.time + values["ahead"], run.time, shifted)
    behind = np.interp(run.time - values["behind"], run.time, shifted)
    return ((ahead - behind) / (values["ahead"] + values["behind"]))[:, None]


def _delay_shapes(runs: Sequence[PreparedRun]) -> list[Shape]:
    shapes = []
    # one that is less than a sample is how the log was made: nulls at 20 Hz "had" 26 ms of the pressures
    if max(run.dt for run in runs) < SMALL * tau.typical:
        shapes.append(Shape("small, of the speed", SMALL_DELAY, (-SMALL, SMALL)))
        if any("heave_velocity" in run.channels for run in runs):
            shapes.append(Shape("small, of the pressures", {**SMALL_DELAY, "late": PRESSURES}, (-SMALL, SMALL)))
    for step in _of_a_sample(runs):
        near, far = step / NEXT / tau.typical, NEXT * step / tau.typical
        late = {"ahead": step, "behind": 0.0, "late": SPEED}
        shapes.append(Shape(f"speed late, about {1e3 * step:g} ms", late, (near, far)))
        early = {"ahead": 0.0, "behind": step, "late": PRESSURES}
        shapes.append(Shape(f"pressures late, about {1e3 * step:g} ms", early, (-far, -near)))
    return shapes


def _of_a_sample(runs: Sequence[PreparedRun]) -> tuple[float, ...]:
    """Those of the delays in s that a log does not make by itself: of a slow one none that is less than a sample."""
    return tuple(each for each in DELAYS if max(run.dt for run in runs) <= max(each, SLOWEST_FOR_DELAY))


def _too_slow(runs: Sequence[PreparedRun]) -> tuple[str, str] | None:
    if _of_a_sample(runs):
        return None
    return "a faster log", f"a delay of {1e3 * DELAYS[-1]:g} ms is less than one sample; log at 20 Hz or more"


def late_by(values: Values) -> dict[str, float]:
    """The corrections that a shape of lateness is, and what each has of it: of a speed that comes late, or of pressures
    that do, which is a speed that comes early."""
    side, sign = ("pressure", -1.0) if values["late"] == PRESSURES else ("signal", 1.0)
    if "by_time" in values:
        return {f"{side}_clock": sign / CLOCKED}
    if (how := changes(values)) is not None:
        return {f"{side}_{name}": sign * share for name, share in CHANGES[how].items()}
    filtered = values.get("filtered", 0.0)
    parts = {f"{side}_delay": sign * (1.0 - filtered), f"{side}_filter": sign * filtered}
    return {name: share for name, share in parts.items() if share}


def changes(values: Values) -> str | None:
    """How a shape of lateness changes within a run, one of `CHANGES`; None where it does not."""
    return next((each for each in CHANGES if each in values), None)


def late_over(name: str, values: Values) -> dict[str, Any]:
    """The time constant in s of a correction of a shape of lateness, or the points of its course, if it has one."""
    if DRAWN_IN in values:
        shares = [share for each, share in values.items() if each.startswith(POINT)]
        return {"course": tuple((k * values[DRAWN_IN], share) for k, share in enumerate(shares))}
    return {"time_constant": values[changes(values) or ""]} if DECLARED[name].has_time_constant else {}


def _to_delay(found: Estimates, shape: Shape, _: Sides) -> list[Correction]:
    late = late_by(shape.values)
    return [correction(name, found[tau.name], late[name], **late_over(name, shape.values)) for name in late]
