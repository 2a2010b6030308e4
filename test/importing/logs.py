"""Logs as other people write them, made from the shipped runs: what the import tests read."""

import datetime as dt
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from winch_friction.physics.channels import CM3_PER_REV, RPM
from winch_friction.physics.signals import Run
from winch_friction.records.runs import read_run

EXAMPLES = Path(__file__).parents[2] / "config" / "examples" / "practice_150t"
START = dt.datetime(2026, 3, 1, 10, 0, 0)
# channel -> header, factor from SI, digits: a crane maker's own language
GERMAN = {
    "motor_speed": ("Windendrehzahl [1/min]", 1 / RPM, 1),
    "main.pressure_a": ("Druck A [bar]", 1e-5, 2),
    "main.pressure_b": ("Druck B [bar]", 1e-5, 2),
    "main.displacement": ("Schluckvolumen [ccm]", 1 / CM3_PER_REV, 2),
    "active.pressure_a": ("Druck A Aktiv [bar]", 1e-5, 2),
    "active.pressure_b": ("Druck B Aktiv [bar]", 1e-5, 2),
    "active.displacement": ("Schluckvolumen Aktiv [ccm]", 1 / CM3_PER_REV, 2),
    "passive.pressure_a": ("Druck A Passiv [bar]", 1e-5, 2),
    "passive.pressure_b": ("Druck B Passiv [bar]", 1e-5, 2),
    "passive.displacement": ("Schluckvolumen Passiv [ccm]", 1 / CM3_PER_REV, 2),
    "hook_load": ("Hakenlast [t]", 1e-3, 3),
    "wire_out": ("Seillänge [m]", 1.0, 3),
    "wire_layer": ("Lage", 1.0, 0),
    "oil_temperature": ("Öltemperatur [°C]", 1.0, 1),
}


def example(name: str) -> Run:
    """A shipped run."""
    return read_run(EXAMPLES / f"{name}.parquet")


def rows_of(run: Run, words: dict = GERMAN, decimal: str = ",", time: str = "Zeit") -> list[list[str]]:
    """Header and rows as texts: ISO times, numbers with a decimal mark."""
    channels = [channel for channel in words if channel in run]
    rows = [[time, *(words[channel][0] for channel in channels)]]
    for k, seconds in enumerate(run.time):
        stamp = (START + dt.timedelta(seconds=float(seconds))).isoformat(timespec="milliseconds")
        values = [f"{run[c][k] * words[c][1]:.{words[c][2]}f}".replace(".", decimal) for c in channels]
        rows.append([stamp, *values])
    return rows


def write_workbook(path: Path, rows: Sequence[Sequence[object]]) -> Path:
    """Rows as the only sheet of a spreadsheet."""
    from openpyxl import Workbook

    book = Workbook()
    for row in rows:
        book.active.append(list(row))
    book.save(path)
    return path


def write_text(
    path: Path, rows: Sequence[Sequence[str]], delimiter: str = ";", encoding: str = "utf-8", head: str = ""
) -> Path:
    """Rows as text with a preamble."""
    path.write_bytes((head + "\n".join(delimiter.join(row) for row in rows) + "\n").encode(encoding))
    return path


def same(one: Run, other: Run, channels: Sequence[str] = (), rounding: float = 2e-3) -> bool:
    """Whether two runs agree in these channels (all of the second) to what the log's digits leave."""
    return all(
        np.nanmax(np.abs(one[c] - other[c])) <= rounding * max(np.nanmax(np.abs(other[c])), 1e-12)
        for c in channels or [c for c in other.columns if c in one and c != "time"]
    )
