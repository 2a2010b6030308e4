"""Runs as a page: every channel in the unit that people read, each run a figure, all zoomed together."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from winch_friction.physics.corrections import corrected
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import Run
from winch_friction.physics.winch import Crane
from winch_friction.physics.winch.crane import run_drum_torque
from winch_friction.physics.winch.operating_point import run_operating_points
from winch_friction.report.base import TextSection, write_report
from winch_friction.report.plots import Frame, Line, Plot, plot_html
from winch_friction.report.tables import estimate_for_people, for_people, table_html, value_for_people

ROUNDING = 1e-12  # of a channel's range: a mean of less is what is left of its sum


# a broken sensor's 1e300 is shown as it stands; what is made of it may leave the range of numbers, in silence
@np.errstate(over="ignore", invalid="ignore")
def write_run_page(path: Path, runs: Sequence[Run], crane: Crane | None, model: FrictionModel | None) -> Path:
    """Write the page; with crane and model also the model's friction, where the load is known."""
    rows = [list(row.values()) for run in runs for row in channel_rows(run)]
    head = list(channel_rows(runs[0])[0])
    sections = [TextSection("Channels", table_html(head, rows))]
    for run in runs:
        friction = _friction(run, crane, model) if crane and model else None
        sections.append(TextSection(run.name, plot_html(run_plot(run, friction))))
    return write_report(path, "Runs", sections, f"{len(runs)} run{'s' * (len(runs) > 1)}")


def channel_rows(run: Run) -> list[dict[str, Any]]:
    """Range, mean and missing samples of every channel, in the units people read; a Unix time from its date on."""
    rows = []
    for name, values in run.columns.items():
        good = np.asarray(values, float)
        good = good[np.isfinite(good)].astype(np.longdouble)  # whose sum has room
        unit = run.units[name]
        said, begin = for_people(unit), 0.0
        if name == "time" and good.size:
            dated = estimate_for_people(float(good[0]), 0.0, unit)[0]
            said, begin = (f"{said} from {dated}", good[0]) if isinstance(dated, str) else (said, begin)
        least, most, mean = (
            value_for_people(float(f(good - begin)), unit) if good.size else float("nan")
            for f in (np.min, np.max, np.mean)
        )
        rows.append(
            {
                "run": run.name,
                "channel": name,
                "unit": said,
                "least": least,
                "largest": most,
                "mean": float("nan") if name == "time" else 0.0 if abs(mean) < ROUNDING * (most - least) else mean,
                "missing [samples]": len(run) - len(good),
            }
        )
    return rows


def run_plot(run: Run, friction: np.ndarray | None = None) -> Plot:
    """Channels of one unit and kind share a panel; the model's friction has its own."""
    columns: dict[str, Any] = {"time [s]": run.time - run.time[0]}
    panels: list[str] = []
    lines = []
    for name, values in run.columns.items():
        if name == "time" or not np.isfinite(values).any():
            continue
        unit = for_people(run.units[name])
        label = f"{name} [{unit}]"
        columns[label] = value_for_people(1.0, run.units[name]) * np.asarray(values, float)
        panel = f"{_panel(name)} [{unit}]"
        panels += [] if panel in panels else [panel]
        lines.append(Line(name.replace("_", " "), "time [s]", label, row=panels.index(panel)))
    if friction is not None:
        columns["model's friction [N·m]"] = friction
        panels.append("friction [N·m]")
        lines.append(Line("model's friction", "time [s]", "model's friction [N·m]", row=len(panels) - 1, role="after"))
    return Plot(
        run.name,
        [Frame(run.name, columns)],
        lines,
        "time [s]",
        panels,
        f"{run.name}, {len(run)} samples",
        "runs",
        height=140,
    )


def _panel(name: str) -> str:
    kind = name.rpartition(".")[2]
    return {
        "pressure_a": "pressure",
        "pressure_b": "pressure",
        "motor_speed": "speed",
        "speed_reference": "speed",
        "drum_speed": "speed",
    }.get(kind, kind.replace("_", " "))


def _friction(run: Run, crane: Crane, model: FrictionModel) -> np.ndarray | None:
    if "hook_load" not in run:
        return None
    right, machine = corrected(run, crane, model)
    at = run_operating_points(right, machine, drum_torque=run_drum_torque(right, machine))
    torque = np.broadcast_to(model.torque(at), (len(right),))
    return np.interp(run.time, right.time, torque)
