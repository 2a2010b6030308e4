"""What a diagnosis costs: cold start of the command on twelve CSV files, memory, and how time grows with the samples.

    python -m campaign.gap_cost

Each measurement is a process of its own; the figures go to out/campaign_gap/cost.json, from where the table takes them.
"""

import json
import os
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

from campaign.rig import make_dataset, write_csv

OUT = Path("out/campaign_gap")
COST = OUT / "cost.json"
LENGTHS = (0.25, 0.5, 1.0, 2.0, 4.0)  # of runs of 170-240 s: a factor of 16 in samples
EFFECT = (("low_displacement_loss", 1.0),)
SEED = 100_999
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


def cold_start(folder: Path) -> dict[str, float]:
    """Seconds and peak memory of `winch-friction gap` on twelve CSV files, interpreter start included."""
    paths = write_csv(folder, make_dataset(SEED, "quiet", EFFECT))
    command = [str(Path(sys.executable).parent / "winch-friction"), "gap", *map(str, paths), "--crane", "crane_150t"]
    command += ["--model", "a6vm215_crane2", "--out", str(folder / "result")]
    started = time.perf_counter()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    seconds = time.perf_counter() - started
    if status:
        raise SystemExit(f"winch-friction gap ended with status {os.waitstatus_to_exitcode(status)}")
    return {
        "seconds": seconds,
        "megabytes": usage.ru_maxrss / 1024,
        "cpu_seconds": usage.ru_utime + usage.ru_stime,
        "load": os.getloadavg()[0],
    }


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


def measure() -> dict[str, Any]:
    """Everything, with the exponent of time over samples (least squares in logarithms)."""
    rows = growth()
    samples, seconds = np.array(rows, dtype=float).T
    exponent = float(np.polyfit(np.log(samples), np.log(seconds), 1)[0])
    return {"cold": cold_start(OUT / "cost"), "growth": rows, "exponent": exponent, "cores": os.cpu_count()}


if __name__ == "__main__":
    OUT.mkdir(parents=True, exist_ok=True)
    found = measure()
    COST.write_text(json.dumps(found, indent=1) + "\n")
    print(json.dumps(found, indent=1))
