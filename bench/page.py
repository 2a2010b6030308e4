"""The table of benchmarks as a page: figures, goals, and on what they were measured."""

import os
import platform
from importlib.metadata import version
from pathlib import Path

from bench.measuring import Row
from winch_friction.records.atomic import write_text

LIBRARIES = ("numpy", "scipy", "numba", "sympy", "filterpy", "rosbags")


def write_page(path: Path, rows: list[Row], command: str, commit: str) -> Path:
    """Write the page as Markdown, atomically."""
    head = ["figure", "value", "against", "ratio", "smallest ... largest", "goal", "met"]
    lines = [f"| {' | '.join(each)} |" for each in (head, ["---"] * len(head), *map(_cells, rows))]
    return write_text(path, "\n".join(["# Benchmarks", "", _where(command, commit), "", *lines, "", *_notes(rows)]))


def _cells(row: Row) -> list[str]:
    against = f"{row.against}, {row.other:.3g} {row.unit}" if row.other is not None else row.against
    ratio = f"{row.ratio:.3g}" if row.ratio is not None else ""
    spread = f"{row.spread[0]:.3g} ... {row.spread[1]:.3g}" if row.spread else ""
    return [row.name, f"{row.value:.4g} {row.unit}", against, ratio, spread, row.goal, _met(row)]


def _met(row: Row) -> str:
    return {True: "yes", False: "**no**", None: ""}[row.met]


def _where(command: str, commit: str) -> str:
    libraries = ", ".join(f"{name} {version(name)}" for name in LIBRARIES)
    load = os.getloadavg()
    return (
        f"`{command}`, commit {commit}. {_processor()}, {os.cpu_count()} cores, {platform.system()} "
        f"{platform.release()}, Python {platform.python_version()}, {libraries}. Load average {load[0]:.1f} (1 min), "
        f"{load[2]:.1f} (15 min). Processor time of one process; pairs measured in turn, medians; ratios survive a "
        "busy machine, single times do not."
    )


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor()
    return next(
        (each.partition(":")[2].strip() for each in lines if each.startswith("model name")), "unknown processor"
    )


def _notes(rows: list[Row]) -> list[str]:
    return [f"* {row.name}: {row.note}." for row in rows if row.note]
