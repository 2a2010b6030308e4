"""Peak memory of reading and replaying a bag, beside its size."""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

from bench.measuring import Row, sea
from winch_friction.records.runs import write_run

HOUR, SHORT = 3600.0, 10.0  # s
# a process of its own, whose peak is nobody else's
PEAK = """
import resource, sys
from winch_friction.cli.main import run
arguments = sys.argv[1:]
assert run(arguments) == 0
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, file=sys.stderr)
"""


def measure(smoke: bool = False) -> list[Row]:
    """MB at the peak of `replay` on an hour at 50 Hz; the goal is 300 MB and twice the bag."""
    _, _, run, _ = sea(SHORT if smoke else HOUR)
    with tempfile.TemporaryDirectory() as folder:
        bag = write_run(run, Path(folder) / "bag")
        size = sum(each.stat().st_size for each in Path(bag).rglob("*") if each.is_file()) / 1e6
        out = str(Path(folder) / "replay.csv")
        model = ["--crane", "crane_150t", "--model", "a6vm215_crane2"]
        verb = ["replay", str(bag), *model, "--out", out, "--json"]
        done = subprocess.run(
            [sys.executable, "-c", PEAK, *verb], env=dict(os.environ), capture_output=True, text=True, check=True
        )
    peak = float(done.stderr.split()[-1]) / 1e3
    note = f"of a bag of {size:.0f} MB, {run.time[-1]:.0f} s at 50 Hz"
    return [Row("memory: peak of replay", peak, "MB", note, at_most=300.0 + 2.0 * size)]
