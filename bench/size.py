"""How cost grows: the exponent of time over samples, runs and candidates, by verb's own work."""

import math

from bench.measuring import Row, sea, seconds
from winch_friction.compensation import CompensatorConfig, FeedforwardCompensator
from winch_friction.discrepancy.answer import GapOptions
from winch_friction.discrepancy.candidates.candidate import MOVING, Candidate
from winch_friction.discrepancy.catalogue import all_candidates
from winch_friction.discrepancy.workflow import find_gap
from winch_friction.estimation import EstimatorConfig, FrictionEstimator
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model
from winch_friction.replay.compensator import replay_compensator
from winch_friction.replay.estimator import replay_estimator
from winch_friction.simulation.scenario import load_scenario
from winch_friction.simulation.simulator import simulate

LENGTHS = (15.0, 60.0, 240.0, 960.0)  # s: 1, 4, 16 and 64 times
RUNS, RUN = (4, 16, 64), 60.0  # 1, 4 and 16 times; s
HIDDEN = (("low_displacement_loss", 1.0),)  # with nothing to be found the search ends early


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
    return [*rows, *_gap_rows(smoke)]


def _gap_rows(smoke: bool) -> list[Row]:
    """The same of `gap` over runs of one length, and over the candidates that it has to choose from."""
    crane, model = load_crane("crane_150t"), load_model("a6vm215_crane2")
    counts = (1,) if smoke else RUNS
    scenario = load_scenario("ahc_irregular").override({"duration": RUN / 2 if smoke else RUN})
    runs = [simulate(scenario, crane, model, seed=k, hidden=HIDDEN).run for k in range(counts[-1])]
    every = tuple(each for each in all_candidates() if each.regime == MOVING)
    half = tuple(each for k, each in enumerate(every) if k % 2 == 0 or each.name == HIDDEN[0][0])

    def cost(count: int, candidates: tuple[Candidate, ...]) -> float:
        options = GapOptions(plan=False, proposals=False, candidates=candidates)
        return min(seconds(lambda: find_gap(runs[:count], crane, model, options)) for _ in range(1 if smoke else 2))

    by_runs = {count: cost(count, every) for count in counts}
    first, twice = cost(counts[0], half), by_runs[counts[0]]
    over_candidates = math.log(twice / first) / math.log(len(every) / len(half))
    rows = [
        Row(
            "size: exponent of gap over candidates", max(over_candidates, 1e-9), "1",
            f"{len(half)} and {len(every)} candidates", at_most=1.1,
        )
    ]  # fmt: skip
    if not smoke:
        exponent = _slope([math.log(count) for count in counts], [math.log(by_runs[count]) for count in counts])
        note = f"{counts[0]} to {counts[-1]} runs of {RUN:g} s, {by_runs[counts[0]]:.2g} to {by_runs[counts[-1]]:.2g} s"
        rows.insert(0, Row("size: exponent of gap over runs", exponent, "1", note, at_most=1.1))
    return rows


def _slope(x: list[float], y: list[float]) -> float:
    mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
    above = sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y, strict=True))
    return above / sum((a - mean_x) ** 2 for a in x)
