"""What replaying a bag costs, beside reading it."""

import tempfile
from pathlib import Path
from typing import Any

from bench.measuring import Row, paired, sea, sea_seconds
from winch_friction.compensation import CompensatorConfig, FeedforwardCompensator
from winch_friction.estimation import EstimatorConfig, FrictionEstimator
from winch_friction.records.runs import read_run, write_run
from winch_friction.replay.compensator import replay_compensator
from winch_friction.replay.estimator import replay_estimator

GOALS = {"compensator": 1.2, "estimator": 1.5}


def measure(smoke: bool = False) -> list[Row]:
    """Time per sample through each object from a bag, and the ratio to reading the bag into a run."""
    crane, model, run, samples = sea(sea_seconds(smoke))
    with tempfile.TemporaryDirectory() as folder:
        path = write_run(run, Path(folder) / "bag")

        def read() -> Any:
            return read_run(path, crane)

        def compensated() -> None:
            replay_compensator(read(), FeedforwardCompensator(crane, model, CompensatorConfig()))

        def estimated() -> None:
            replay_estimator(read(), FrictionEstimator(crane, model, EstimatorConfig()))

        rows, each = [], 1e6 / len(samples)
        for name, work in (("compensator", compensated), ("estimator", estimated)):
            found = paired(work, read, smoke)
            rows.append(
                Row(
                    f"replay: bag through the {name}, per sample", found.ours * each, "us", "reading the bag",
                    found.theirs * each, found.ratio, found.spread, at_most=GOALS[name],
                )
            )  # fmt: skip
    return rows
