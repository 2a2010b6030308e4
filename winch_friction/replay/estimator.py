"""The friction estimator over a recorded run: the same `step`, the same samples."""

import math

import numpy as np

from winch_friction.estimation import Estimate, FrictionEstimator, ParameterEstimate
from winch_friction.physics.channels import SLOW_INPUTS
from winch_friction.physics.hold import InputHold
from winch_friction.physics.signals import Run

COLUMNS = ("friction_torque", "speed", "drum_torque", "innovation", "innovation_variance", "nis")
PARAMETER_PERIOD = 1.0  # s between two looks at the parameters: reading them costs more than a step


def replay_estimator(
    run: Run, estimator: FrictionEstimator, *, max_age: float = 0.1, period: float = PARAMETER_PERIOD
) -> Run:
    """What the estimator learns along a run, one row per sample.

    Columns: `time` s, `friction_torque` N m (NaN where nothing was learned), `speed` rad/s, `drum_torque` N m,
    `innovation` rad/s, `innovation_variance`, `nis`, and per parameter its value and, as `<name>_std`, its standard
    deviation in SI, looked at every `period` s and held between; `aside['state']` in words.
    """
    record = EstimateRecord(estimator, period)
    for sample in InputHold(run.groups, max_age, dict(SLOW_INPUTS)).samples(run):
        record.take(estimator.step(sample))
    return record.run(run.name)


class EstimateRecord:
    """Collects an estimator's answers and, now and then, its parameters."""

    def __init__(self, estimator: FrictionEstimator, period: float = PARAMETER_PERIOD) -> None:
        self._estimator, self._period = estimator, period
        self._estimates: list[Estimate] = []
        self._looks: list[list[ParameterEstimate]] = []
        self._look_of_row: list[int] = []
        self._looked_at = -math.inf

    def take(self, estimate: Estimate) -> None:
        """Add one answer."""
        if not self._looked_at <= estimate.time < self._looked_at + self._period:
            self._looks.append(self._estimator.parameters())
            self._looked_at = estimate.time
        self._estimates.append(estimate)
        self._look_of_row.append(len(self._looks) - 1)

    def run(self, name: str) -> Run:
        """All answers as columns over time; the last row shows the parameters at the end."""
        columns = {"time": np.array([each.time for each in self._estimates])}
        columns |= {column: np.array([getattr(each, column) for each in self._estimates]) for column in COLUMNS}
        columns |= self._parameter_columns()
        states = np.array([each.state for each in self._estimates], dtype=object)
        return Run(name=name, columns=columns, aside={"state": states})

    def _parameter_columns(self) -> dict[str, np.ndarray]:
        looks = [*self._looks, self._estimator.parameters()]
        rows = [*self._look_of_row[:-1], len(looks) - 1] if self._look_of_row else []
        columns = {}
        for k, each in enumerate(looks[-1]):
            columns[each.name] = np.array([looks[row][k].value for row in rows])
            columns[f"{each.name}_std"] = np.array([looks[row][k].std for row in rows])
        return columns
