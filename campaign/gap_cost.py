"""What a diagnosis costs: cold start of the command on twelve CSV files, memory, and how time grows with the samples.

    python -m campaign.gap_cost [--results FILE]

Each measurement is a process of its own, and nothing else should run; the figures go to out/campaign_gap/cost.json,
from where the table takes them. Of the campaign's results the longest searches are run again, alone and cold, for
beside each other they wait for the machine.
"""

import argparse
import json
import os
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

from campaign.gap import RESULTS, finished
from campaign.gap_cases import FAR, NEAR, Case
from campaign.rig import DRAWN, make_dataset, world_of, write_csv, write_world

OUT = Path("out/campaign_gap")
COST = OUT / "cost.json"
LENGTHS = (0.25, 0.5, 1.0, 2.0, 4.0)  # of runs of 170-240 s: a factor of 16 in samples
EFFECT = (("low_displacement_loss", 1.0),)
SEED = 100_999
AGAIN = 5  # of the campaign's searches, the longest
IN_PROCESS = """
import json, sys, time, numpy as np
from campaign.rig import make_dataset
from winch_friction.discrepancy.answer import GapOptions
from winch_friction.discrepancy.workflow import find_gap
from winch_friction.physics.signals import Run
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model
length, seed = float(sys.argv[1]), int(sys.argv[2])
data = make_dataset(seed, "quiet", [("low_displacement_loss", 1.0)], length=length)
runs = [Run(f"run_{k}", columns) for k, columns in enumerate(data)]
crane, model = load_crane("crane_150t"), load_model("a6vm215_crane2")
started = time.process_time()
find_gap(runs, crane, model, GapOptions(plan=False))
print(json.dumps([sum(len(run) for run in runs), time.process_time() - started]))
"""


def cold_start(folder: Path, case: Case) -> dict[str, Any]:
    """Seconds and peak memory of `winch-friction gap` on a case's CSV files, interpreter start and page included."""
    paths = write_csv(folder, make_dataset(case.seed, case.flavour, case.effects, sigma=case.sigma))
    crane, model = "crane_150t", "a6vm215_crane2"
    if case.flavour == DRAWN:
        crane, model = map(str, write_world(folder, world_of(case.seed, case.flavour)))
    command = [str(Path(sys.executable).parent / "winch-friction"), "gap", *map(str, paths), "--crane", crane]
    command += ["--model", model, "--out", str(folder / "result")]
    started = time.perf_counter()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    seconds = time.perf_counter() - started
    if status:
        raise SystemExit(f"winch-friction gap ended with status {os.waitstatus_to_exitcode(status)}")
    return {
        "key": case.key,
        "seconds": seconds,
        "megabytes": usage.ru_maxrss / 1024,
        "cpu_seconds": usage.ru_utime + usage.ru_stime,
        "load": os.getloadavg()[0],
    }


def longest(results: Path) -> list[Case]:
    """The cases of a campaign that took longest, longest first."""
    rows = sorted((row for row in finished(results).values() if "error" not in row), key=lambda row: -row["seconds"])
    return [_case(row) for row in rows[:AGAIN]]


def _case(row: dict[str, Any]) -> Case:
    effects = tuple((name, size) for name, size in row["effects"])
    sigma = FAR if row["kind"] == "far_seed" else NEAR
    return Case(row["kind"], effects, row["flavour"], row["seed"], sigma)


def growth() -> list[tuple[int, float]]:
    """(samples, processor seconds of the workflow alone) for growing records: a busy machine does not count."""
    rows = []
    for length in LENGTHS:
        out = subprocess.run(
            [sys.executable, "-c", IN_PROCESS, str(length), str(SEED)], capture_output=True, text=True, check=True
        )
        samples, seconds = json.loads(out.stdout.strip().splitlines()[-1])
        rows.append((int(samples), float(seconds)))
    return rows


def measure(results: Path) -> dict[str, Any]:
    """Everything, with the exponent of time over samples (least squares in logarithms)."""
    rows = growth()
    samples, seconds = np.array(rows, dtype=float).T
    exponent = float(np.polyfit(np.log(samples), np.log(seconds), 1)[0])
    cases = [Case("single", EFFECT, "quiet", SEED), *longest(results)]
    cold = [cold_start(OUT / "cost" / str(k), case) for k, case in enumerate(cases)]
    return {"cold": cold[0], "longest": cold[1:], "growth": rows, "exponent": exponent, "cores": os.cpu_count()}


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--results", type=Path, default=RESULTS, help="of the campaign whose longest are run again")
    chosen = parser.parse_args()
    OUT.mkdir(parents=True, exist_ok=True)
    found = measure(chosen.results)
    COST.write_text(json.dumps(found, indent=1) + "\n")
    print(json.dumps(found, indent=1))
