"""What replaying a bag costs, beside reading it.

python bench/replay.py
"""

import tempfile
from pathlib import Path
from typing import Any

from pairs import figure, paired
from seas import sea

from winch_friction.compensation import CompensatorConfig, FeedforwardCompensator
from winch_friction.estimation import EstimatorConfig, FrictionEstimator
from winch_friction.records.runs import read_run, write_run
from winch_friction.replay.compensator import replay_compensator
from winch_friction.replay.estimator import replay_estimator

REPEATS = 3


def measure() -> dict[str, Any]:
    """Samples per second through each object from a bag, and the ratio to reading the bag into a run."""
    crane, model, run, samples = sea()
    with tempfile.TemporaryDirectory() as folder:
        path = write_run(run, Path(folder) / "bag")

        def read() -> Any:
            return read_run(path, crane)

        def compensated() -> None:
            replay_compensator(read(), FeedforwardCompensator(crane, model, CompensatorConfig()))

        def estimated() -> None:
            replay_estimator(read(), FrictionEstimator(crane, model, EstimatorConfig()))

        rows = {}
        for name, work in (("compensator", compensated), ("estimator", estimated)):
            ours, theirs, ratio = paired(work, read, REPEATS)
            against = f"reading the bag, {1e6 * theirs / len(samples):.0f} us"
            value = 1e6 * ours / len(samples)
            rows[f"replay: bag through the {name}, per sample"] = figure(value, "us", against, ratio, "ratio <= 1.5")
    return rows


if __name__ == "__main__":
    print(measure())
