"""Peak memory of the verbs on an hour's bag, beside its size."""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

from bench.measuring import Row, sea
from winch_friction.records.runs import write_run

HOUR, SHORT = 3600.0, 10.0  # s
# a verb may find something and say so by its status; the peak is /proc's, which is this program's alone: getrusage's
# begins with that of the process which started it, and that one holds the whole hour
PEAK = """
import sys
from winch_friction.cli.main import run
assert run(sys.argv[1:]) in (0, 1)
peak = next(line.split()[1] for line in open("/proc/self/status") if line.startswith("VmHWM"))
print(peak, file=sys.stderr)
"""
KNOWN = ("--crane", "crane_150t", "--model", "a6vm215_crane2")


def measure(smoke: bool = False) -> list[Row]:
    """MB at the peak of each verb on an hour at 50 Hz; the goal is 300 MB and twice the bag."""
    _, _, run, _ = sea(SHORT if smoke else HOUR)
    with tempfile.TemporaryDirectory() as folder:
        bag = Path(write_run(run, Path(folder) / "bag"))
        size = sum(each.stat().st_size for each in bag.rglob("*") if each.is_file()) / 1e6
        note = f"of a bag of {size:.0f} MB, {run.time[-1]:.0f} s at 50 Hz"
        verbs = {
            "replay": ("replay", str(bag), *KNOWN, "--out", f"{folder}/replay.csv", "--json"),
            "check": ("check", str(bag), *KNOWN),
            "convert": ("convert", "run", str(bag), f"{folder}/run.parquet"),
            "plot": ("plot", str(bag), *KNOWN, "--out", f"{folder}/run.html"),
            "gap": ("gap", str(bag), *KNOWN, "--force", "--out", f"{folder}/gap"),
        }
        if smoke:
            del verbs["gap"]  # a few seconds of sea are too short for it
        return [
            Row(f"memory: peak of {name}", _peak(verb), "MB", note, at_most=300.0 + 2.0 * size)
            for name, verb in verbs.items()
        ]


def _peak(verb: tuple[str, ...]) -> float:
    done = subprocess.run(
        [sys.executable, "-c", PEAK, *verb], env=dict(os.environ), capture_output=True, text=True, check=True
    )
    return float(done.stderr.split()[-1]) / 1e3
