"""How long the offline verbs take from a cold start: a process each, with its imports."""

import tempfile
from pathlib import Path

from bench.measuring import Row
from bench.startup import processor_time
from campaign.rig import make_dataset
from winch_friction.physics.signals import Run
from winch_friction.records.runs import write_run

SEED, HIDDEN = 700, [("low_displacement_loss", 1.0)]  # the first data set of the benchmark `naming`, at full length
VERB = "from winch_friction.cli.main import run; assert run({!r}) == 0"
KNOWN = ["--crane", "crane_150t", "--model", "a6vm215_crane2"]
GAP_GOAL, PRACTICE_GOAL = 8.0, 30.0  # s


def measure(smoke: bool = False) -> list[Row]:
    """Processor time of `gap` on twelve runs and of `identify practice` on the shipped example."""
    with tempfile.TemporaryDirectory() as folder:
        columns = make_dataset(SEED, "quiet", HIDDEN, length=0.11 if smoke else 1.0)
        runs = [Run(f"run_{k:02d}", each) for k, each in enumerate(columns[: 1 if smoke else None])]
        files = [str(write_run(run, Path(folder) / f"{run.name}.parquet")) for run in runs]
        # the first may have to fill the caches of equations and compiled code, as after an installation
        verb = VERB.format(["gap", *files, *KNOWN, "--out", f"{folder}/gap", "--overwrite"])
        cold = [processor_time(verb) for _ in range(1 if smoke else 2)]
        practice = ["identify", "practice", "practice_150t", "--out", f"{folder}/practice", "--overwrite"]
        few = ["--resamples", "2", "--restarts", "1", "--evaluations", "500"] if smoke else []
        identify = processor_time(VERB.format([*practice, *few]))
    hours = sum(float(run.time[-1] - run.time[0]) for run in runs) / 60.0
    return [
        Row(
            "verbs: gap, cold", cold[-1], "s", f"{len(runs)} runs, {hours:.0f} min at 50 Hz", at_most=GAP_GOAL,
            note=f"a process of its own with its caches on disk; the one before it took {cold[0]:.1f} s",
        ),
        Row("verbs: identify practice, cold", identify, "s", "the shipped example", at_most=PRACTICE_GOAL),
    ]  # fmt: skip
