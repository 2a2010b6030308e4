"""Peak memory of the verbs on an hour's log, beside its size: a bag, for `import` text, for `identify` test cycles."""

import json
import math
import os
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np

from bench.measuring import Row, sea
from winch_friction.physics.signals import Run
from winch_friction.records.runs import read_run, write_run
from winch_friction.records.strict_yaml import config_directory

HOUR, SHORT = 3600.0, 10.0  # s
# a verb may find something and say so by its status; the peak is /proc's, which is this program's alone: getrusage's
# begins with that of the process which started it, and that one holds the whole hour
PEAK = """
import json, sys
from winch_friction.cli.main import run
for verb in json.loads(sys.argv[1]):
    assert run(verb) in (0, 1), verb
    peak = next(line.split()[1] for line in open("/proc/self/status") if line.startswith("VmHWM"))
    print("peak", peak, file=sys.stderr)
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
        log, importing = _import(run, Path(folder))
        tests, identify = _identify(Path(folder), SHORT if smoke else HOUR)
        peaks = iter(_peaks([*verbs.values(), *importing, identify], smoke))
        rows = [_row(name, next(peaks), size, note) for name in verbs]
        note = f"of a text of {log:.0f} MB, {run.time[-1]:.0f} s at 50 Hz; its map was proposed at {next(peaks):.0f} MB"
        return [*rows, _row("import", next(peaks), log, note), _row("identify system", next(peaks), *tests)]


def _row(name: str, peak: float, size: float, note: str) -> Row:
    return Row(f"memory: peak of {name}", peak, "MB", note, at_most=300.0 + 2.0 * size)


def _import(run: Run, folder: Path) -> tuple[float, list[tuple[str, ...]]]:
    """MB of the hour as somebody's text file, and the verbs that propose a map of its columns and import it."""
    log, table = write_run(run, folder / "log.csv"), str(folder / "map.yaml")
    proposal = ("import", str(log), "--propose", "--crane", "crane_150t", "--map", table)
    verb = ("import", str(log), "--map", table, "--out", str(folder / "runs"), "--crane", "crane_150t")
    return log.stat().st_size / 1e6, [proposal, verb]


def _identify(folder: Path, duration: float) -> tuple[tuple[float, str], tuple[str, ...]]:
    """MB of the shipped example's tests, again and again until they last so many s together, what to say of them, and
    the verb that fits them."""
    tests = [
        read_run(path) for path in sorted((config_directory() / "examples" / "practice_150t").glob("test_*.parquet"))
    ]
    again = max(math.ceil(duration / sum(float(test.time[-1]) for test in tests)), 1)
    files = [write_run(_repeated(test, again), folder / f"{test.name}.parquet") for test in tests]
    size = sum(each.stat().st_size for each in files) / 1e6
    seconds = again * sum(float(test.time[-1]) for test in tests)
    search = ("--resamples", "2", "--restarts", "1", "--evaluations", "500")  # again and again in the same memory
    verb = ("identify", "system", *map(str, files), "--motor", "a6vm215", "--out", f"{folder}/model.yaml", *search)
    return (size, f"of {len(files)} tests, {seconds:.0f} s in {size:.1f} MB"), verb


def _repeated(run: Run, times: int) -> Run:
    """A run one time after the other."""
    step = float(run.time[-1] - run.time[0] + np.median(np.diff(run.time)))
    columns = {name: np.tile(values, times) for name, values in run.columns.items()}
    columns["time"] = np.concatenate([run.time + k * step for k in range(times)])
    return replace(run, columns=columns, aside={})


def _peaks(verbs: list[tuple[str, ...]], together: bool) -> list[float]:
    """MB at the peak of each verb in a process of its own; `together` in one after the other, for a smoke run."""
    each = [verbs] if together else [[verb] for verb in verbs]
    said = [
        subprocess.run(
            [sys.executable, "-c", PEAK, json.dumps(some)],
            env=dict(os.environ), capture_output=True, text=True, check=True,
        ).stderr
        for some in each
    ]  # fmt: skip
    return [float(line.split()[1]) / 1e3 for one in said for line in one.splitlines() if line.startswith("peak ")]
