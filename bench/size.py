"""How cost grows with the length of a recording: the exponent of time over samples, by verb's own work."""

import math

from bench.measuring import Row, sea, seconds
from winch_friction.compensation import CompensatorConfig, FeedforwardCompensator
from winch_friction.estimation import EstimatorConfig, FrictionEstimator
from winch_friction.replay.compensator import replay_compensator
from winch_friction.replay.estimator import replay_estimator

LENGTHS = (15.0, 60.0, 240.0, 960.0)  # s: 1, 4, 16 and 64 times


def measure(smoke: bool = False) -> list[Row]:
    """Slope of log time over log samples from the shortest run to the longest, by least squares."""
    lengths = (1.0, 4.0) if smoke else LENGTHS
    crane, model = sea(lengths[0])[:2]
    runs = [sea(length)[2] for length in lengths]
    work = {
        "compensator": lambda run: replay_compensator(run, FeedforwardCompensator(crane, model, CompensatorConfig())),
        "estimator": lambda run: replay_estimator(run, FrictionEstimator(crane, model, EstimatorConfig())),
    }
    rows = []
    for name, replay in work.items():
        replay(runs[0])
        times = [
            min(seconds(lambda run=run, replay=replay: replay(run)) for _ in range(1 if smoke else 3)) for run in runs
        ]
        exponent = _slope([math.log(len(run)) for run in runs], [math.log(time) for time in times])
        note = f"{len(runs[0])} to {len(runs[-1])} samples"
        rows.append(Row(f"size: exponent of the {name}'s replay over samples", exponent, "1", note, at_most=1.1))
    return rows


def _slope(x: list[float], y: list[float]) -> float:
    mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
    above = sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y, strict=True))
    return above / sum((a - mean_x) ** 2 for a in x)
