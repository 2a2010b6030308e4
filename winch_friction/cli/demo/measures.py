"""The demo's figures, measured from its bag."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from winch_friction.cli.demo.plan import DemoPlan, Phase
from winch_friction.cli.demo.recording import Recording
from winch_friction.physics.channels import RPM
from winch_friction.physics.signals import FloatArray

SETTLING = 20.0  # s: the sea grows for ten, the feedforward fades in for one
REVERSAL = (-0.2, 1.0)  # s around each change of the speed's sign
BINS = ((0.0, 50.0), (50.0, 250.0), (250.0, 1000.0), (1000.0, 4000.0))  # rpm


@dataclass(frozen=True)
class PhaseFigures:
    """One leg with one feedforward: residual heave RMS in m overall and around reversals; friction-torque error RMS in
    N m and as a share of the true friction by speed bin; NaN where the sea did not visit the bin. The error is that of
    the model behind the feedforward, which is the feedforward divided by its scale."""

    phase: Phase
    residual: float
    residual_at_reversal: float
    friction_error: tuple[float, ...]
    friction_error_share: tuple[float, ...]
    gain: float = 0.0  # share of the residual without feedforward on the same leg that is gone

    @property
    def title(self) -> str:
        """The feedforward, for people."""
        return self.phase.feedforward.title

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        labels = [bin_label(each) for each in BINS]
        return {
            "name": self.phase.name,
            "title": self.phase.title,
            "feedforward": self.phase.feedforward.name,
            "load_t": self.phase.leg.load,
            "displacement_cm3_per_rev": self.phase.leg.displacement,
            "residual_heave_rms_m": self.residual,
            "residual_heave_rms_at_reversal_m": self.residual_at_reversal,
            "less_than_without": self.gain,
            "friction_torque_error_rms_Nm": dict(zip(labels, self.friction_error, strict=True)),
            "friction_torque_error_share": dict(zip(labels, self.friction_error_share, strict=True)),
        }


def bin_label(speeds: tuple[float, float]) -> str:
    """A speed bin in rpm."""
    return f"{speeds[0]:g}-{speeds[1]:g} rpm" if speeds[1] < BINS[-1][1] else f">{speeds[0]:g} rpm"


def measure(plan: DemoPlan, recording: Recording) -> list[PhaseFigures]:
    """One row per phase."""
    parts = recording.phases(len(plan.phases))
    rows = [_figures(phase, part) for phase, part in zip(plan.phases, parts, strict=True)]
    without = {row.phase.leg.name: row.residual for row in rows if not row.phase.feedforward.enabled}
    return [replace(row, gain=1.0 - row.residual / without.get(row.phase.leg.name, row.residual)) for row in rows]


def of_leg(rows: Sequence[PhaseFigures], leg: str) -> list[PhaseFigures]:
    """The rows of one leg, one per feedforward."""
    return [row for row in rows if row.phase.leg.name == leg]


def of_feedforward(rows: Sequence[PhaseFigures], name: str) -> list[PhaseFigures]:
    """The rows with one feedforward, one per leg."""
    return [row for row in rows if row.phase.feedforward.name == name]


def _figures(phase: Phase, part: Recording) -> PhaseFigures:
    truth = part.truth[part.truth[:, 0] >= part.truth[0, 0] + SETTLING]
    time, error, speed, friction = truth[:, 0], truth[:, 1], truth[:, 2], truth[:, 3]
    model = np.interp(time, part.fed[:, 0], part.fed[:, 1]) / phase.feedforward.scale
    masks = [(np.abs(speed) >= low * RPM) & (np.abs(speed) < high * RPM) for low, high in BINS]
    errors = tuple(rms((model - friction)[mask]) for mask in masks)
    sizes = tuple(rms(friction[mask]) for mask in masks)
    shares = tuple(e / s for e, s in zip(errors, sizes, strict=True))
    return PhaseFigures(phase, rms(error), rms(error[near_reversal(time, speed)]), errors, shares)


def near_reversal(time: FloatArray, speed: FloatArray) -> Any:
    """Which times lie in the window around a reversal."""
    reversals = time[1:][np.signbit(speed[1:]) != np.signbit(speed[:-1])]
    near = np.zeros(len(time), bool)
    for each in reversals:
        near |= (time >= each + REVERSAL[0]) & (time <= each + REVERSAL[1])
    return near


def rms(values: FloatArray) -> float:
    """Root mean square; NaN of nothing."""
    return float(np.sqrt(np.mean(np.square(values)))) if len(values) else float("nan")
