"""The friction estimator over a recorded run: the same `step`, the same samples."""

import math
from array import array
from operator import attrgetter

import numpy as np

from winch_friction.estimation import Estimate, FrictionEstimator
from winch_friction.physics.channels import SLOW_INPUTS
from winch_friction.physics.signals import FloatArray, Run
from winch_friction.records.sample_stream import InputHold

COLUMNS = ("friction_torque", "speed", "drum_torque", "innovation", "innovation_variance", "nis")
_numbers = attrgetter("time", *COLUMNS)
PARAMETER_PERIOD = 1.0  # s between two looks at the parameters: reading them costs more than a step


def replay_estimator(
    run: Run, estimator: FrictionEstimator, *, max_age: float = 0.1, period: float = PARAMETER_PERIOD
) -> Run:
    """What the estimator learns along a run, one row per sample.

    Columns: `time` s, `friction_torque` N m (NaN where an input was lost), `speed` rad/s, `drum_torque` N m,
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
        self._rows, self._states = array("d"), list[str]()
        self._valid, self._numbers, self._number = bytearray(), array("q"), 0
        self._looks: list[tuple[FloatArray, FloatArray]] = []  # values and sigmas
        self._look_of_row = array("q")
        self._looked_at = -math.inf

    def take(self, estimate: Estimate, doubted: bool = False) -> None:
        """Add one answer; `doubted`: its inputs contradict each other."""
        if not self._looked_at <= estimate.time < self._looked_at + self._period:
            self._looks.append(self._look())
            self._looked_at = estimate.time
        self._rows.extend(_numbers(estimate))
        self._states.append(estimate.state)
        self._valid.append(estimate.valid and not doubted)
        self.skip()
        self._numbers.append(self._number)
        self._look_of_row.append(len(self._looks) - 1)

    def skip(self) -> None:
        """Count a word of the node's that answers no sample: that a silence began."""
        self._number += 1

    def _look(self) -> tuple[FloatArray, FloatArray]:
        model = self._estimator.model()
        return np.array(model.values), model.std

    def run(self, name: str) -> Run:
        """All answers as columns over time; the last row shows the parameters at the end."""
        table = np.array(self._rows).reshape(-1, 1 + len(COLUMNS))
        columns = {column: table[:, k].copy() for k, column in enumerate(("time", *COLUMNS))}
        columns |= self._parameter_columns()
        said = {"state": np.array(self._states, dtype=object), "valid": np.array(self._valid, dtype=bool)}
        said["number"] = np.array(self._numbers)
        return Run(name=name, columns=columns, aside=said)

    def _parameter_columns(self) -> dict[str, FloatArray]:
        values, sigmas = (np.array(each) for each in zip(*self._looks, self._look(), strict=True))
        rows = np.array(self._look_of_row)
        rows[-1:] = len(values) - 1
        columns = {}
        for k, name in enumerate(self._estimator.seed.parameter_names):
            columns[name], columns[f"{name}_std"] = values[rows, k], sigmas[rows, k]
        return columns
