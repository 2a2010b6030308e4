"""What starting costs: the command line's help beside importing numpy and scipy; a verb's peak memory on a long bag."""

import os
import resource
import subprocess
import sys
from statistics import median
from typing import Any

from bench.measuring import Row

HELP = "from winch_friction.cli.main import run; run(['--help'])"
LIBRARIES = "import numpy, scipy.optimize, scipy.linalg"


def measure(smoke: bool = False) -> list[Row]:
    """Processor time of whole processes, in turn, and the ratio of neighbours."""
    repeats = 1 if smoke else 7
    pairs = [(processor_time(HELP), processor_time(LIBRARIES)) for _ in range(repeats)]
    ratios = [ours / theirs for ours, theirs in pairs]
    return [
        Row(
            "start: --help", median(a for a, _ in pairs), "s", "importing numpy and scipy", median(b for _, b in pairs),
            median(ratios), (min(ratios), max(ratios)), at_most=1.2,
        )
    ]  # fmt: skip


def processor_time(code: str) -> float:
    """Seconds that a Python process takes for some code."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    _run(code)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def as_installed() -> dict[str, str]:
    """The environment of a process that keeps its bytecode, whatever this one does: without, each of the package's
    modules is compiled again at every start, a fifth of a second in `gap`."""
    return {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}


def _run(code: str) -> Any:
    return subprocess.run([sys.executable, "-c", code], env=as_installed(), capture_output=True, check=True)
