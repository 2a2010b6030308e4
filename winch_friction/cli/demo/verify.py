"""The recorded inputs through the same objects again: the replay must say what the live nodes said."""

from dataclasses import dataclass

import numpy as np

from winch_friction.cli.demo.plan import DemoPlan, Phase
from winch_friction.cli.demo.recording import Recording, matched
from winch_friction.compensation import CompensatorConfig, FeedforwardCompensator
from winch_friction.compensation.model_schedule import ModelSchedule
from winch_friction.estimation import FrictionEstimator
from winch_friction.physics.signals import FloatArray
from winch_friction.records.model_file import load_model

TOLERANCE = 1e-9


@dataclass(frozen=True)
class Agreement:
    """Largest difference between live and replayed torque relative to the largest torque, over `samples` samples."""

    what: str
    samples: int
    difference: float

    @property
    def holds(self) -> bool:
        """Whether live equals replay; a sample without an answer does not."""
        return self.difference <= TOLERANCE


def verify(plan: DemoPlan, recording: Recording) -> list[Agreement]:
    """Compensator phase by phase, the estimator over everything."""
    phases = recording.phases(len(plan.phases))
    found = [_compare(f"compensator, {p.title}", part, part.fed, _replayed(plan, p, part)) for p, part in
             zip(plan.phases, phases, strict=True)]  # fmt: skip
    return [*found, _compare("estimator", recording, recording.learned, _relearned(plan, recording))]


def _replayed(plan: DemoPlan, phase: Phase, part: Recording) -> FloatArray:
    law = FeedforwardCompensator(plan.crane, load_model(phase.model), CompensatorConfig(scale=phase.scale))
    law.set_enabled(phase.enabled)
    schedule = ModelSchedule()
    for model in part.models if phase.follow else ():
        schedule.offer(model)
    out = []
    for sample in part.samples:
        due = schedule.due(sample.time)
        if due is not None:
            law.load_model(due)
        out.append(law.step(sample).friction_torque)
    return np.array(out)


def _relearned(plan: DemoPlan, recording: Recording) -> FloatArray:
    law = FrictionEstimator(plan.crane, plan.seed)
    torque, out = 0.0, []
    for sample in recording.samples:
        estimate = law.step(sample).friction_torque
        torque = estimate if np.isfinite(estimate) else torque
        out.append(torque)
    return np.array(out)


def _compare(what: str, part: Recording, live: FloatArray, replayed: FloatArray) -> Agreement:
    said = matched([sample.time for sample in part.samples], live)[:, 1]
    largest = max(float(np.abs(replayed).max()), 1.0)
    difference = np.abs(said - replayed)
    worst = float(difference.max()) if not np.isnan(difference).any() else float("inf")
    return Agreement(what, len(replayed), worst / largest)
