"""Plots of the discrepancy report: every run before and after, the gap by speed, and where it is."""

from typing import TYPE_CHECKING

import numpy as np

from winch_friction.discrepancy.preparation.prepare import PreparedRun
from winch_friction.discrepancy.regressors import block_size
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.channels import BAR, RPM
from winch_friction.physics.signals import FloatArray
from winch_friction.report.gap_words import shown_unit
from winch_friction.report.plots import Frame, Heat, Line, Plot

if TYPE_CHECKING:
    from winch_friction.report.gap import GapResult, Side

SPEED_BINS, CELLS = 8, 9
_BREAK = 3.0  # blocks: a longer pause breaks the line


def run_plots(result: "GapResult", side: "Side", link: str = "runs") -> list[Plot]:
    """One figure per run: speed, drive measured and modelled before and after, and what is left; block means."""
    return [_run_plot(result, side, k, link) for k in range(len(side.runs)) if (side.blocks.run == k).any()]


def _run_plot(result: "GapResult", side: "Side", number: int, link: str) -> Plot:
    run, own = side.runs[number], side.blocks.run == number
    place = side.blocks.position[own] * block_size(run)
    middle = np.minimum(place + block_size(run) // 2, len(run.time) - 1)
    measured, before, after = _measured(run)[middle], side.before[own], side.after[own]
    unit = shown_unit(result)
    columns = {
        "time [s]": place * run.dt, "motor speed [rpm]": run.speed[middle] / RPM, f"measured [{unit}]": measured,
        f"model before [{unit}]": measured - before, f"model after [{unit}]": measured - after,
        f"gap before [{unit}]": before, f"gap after [{unit}]": after,
    }  # fmt: skip
    x, names = "time [s]", list(columns)
    lines = [Line("measured", x, names[1], row=0, role="measured")]
    looks = zip(("measured", "before", "after"), names[2:5], ("measured", "before", "after"), strict=True)
    lines += [Line(label, x, name, row=1, role=role) for label, name, role in looks]
    lines += [
        Line("before", x, names[5], row=2, role="before"),
        Line("after", x, names[6], row=2, role="after"),
    ]
    drive = "drive pressure" if result.unit == "bar" else "drive torque"
    return Plot(
        f"Run {run.name}", [Frame(run.name, _with_breaks(columns, x, run.dt))], lines, x,
        ["motor speed [rpm]", f"{drive} [{unit}]", f"gap [{unit}]"],
        f"{run.name}, while moving (means over {block_size(run) * run.dt:.2g} s); reversals and rest left out.",
        link, height=150,
    )  # fmt: skip


def _with_breaks(columns: dict[str, FloatArray], x: str, dt: float) -> dict[str, FloatArray]:
    """The columns with an empty row wherever the run pauses."""
    pauses = np.flatnonzero(np.diff(columns[x]) > _BREAK * LIMITS.block_time) + 1
    broken = {name: np.insert(np.asarray(values, float), pauses, np.nan) for name, values in columns.items()}
    return broken | {x: np.insert(columns[x], pauses, columns[x][pauses - 1])}


def _measured(run: PreparedRun) -> FloatArray:
    """What was measured in the gap's unit: the balancing group's pressure drop, or the drive torque."""
    others = sum((g.count * g.displacement * g.pressure for g in run.groups if not g.balances), np.zeros(len(run.time)))
    total = run.drive_torque - others
    own = next((g for g in run.groups if g.balances), None)
    return total / (BAR * own.count * own.displacement) if own else total / run.unit_torque


def speed_plot(result: "GapResult") -> Plot:
    """RMS gap of the locked runs by speed, before and after, against the noise floor."""
    side, unit = result.holdout, shown_unit(result)
    speed = side.blocks.features["motor_speed"] / RPM
    edges = np.linspace(0.0, float(speed.max()) * 1.0001 + 1e-9, SPEED_BINS + 1)
    index = np.clip(np.digitize(speed, edges) - 1, 0, SPEED_BINS - 1)
    full = [k for k in range(SPEED_BINS) if (index == k).any()]
    rms = [[float(np.sqrt(np.mean(v[index == k] ** 2))) for k in full] for v in (side.before, side.after)]
    x, names = "motor speed [rpm]", (f"before [{unit}]", f"after [{unit}]", f"noise floor [{unit}]")
    columns = {x: 0.5 * (edges[1:] + edges[:-1])[full], names[0]: np.array(rms[0]), names[1]: np.array(rms[1]),
               names[2]: np.full(len(full), side.noise_floor)}  # fmt: skip
    lines = [
        Line(role, x, name, role=role, kind="bars") for role, name in zip(("before", "after"), names, strict=False)
    ]
    lines.append(Line("noise floor", x, names[2], role="noise"))
    return Plot("Gap by speed", [Frame("locked runs", columns)], lines, x, [f"RMS gap [{unit}]"],
                "Locked runs: RMS gap by speed, before and after the repair.", height=230)  # fmt: skip


def heat_plot(result: "GapResult") -> Plot:
    """Mean gap of the training runs over speed and load (or what else varies), hoisting and lowering apart."""
    blocks, gap = result.train.blocks, result.train.before
    other = next(
        (n for n in ("hook_load", "oil_temperature", "acceleration") if _varies(blocks.features.get(n))), "time"
    )
    factor, label = {"hook_load": (1e-3, "hook load [t]"), "oil_temperature": (1.0, "oil temperature [°C]"),
                     "acceleration": (1.0, "acceleration [rad/s²]"), "time": (1.0, "time [s]")}[other]  # fmt: skip
    x, y = blocks.features["motor_speed"] / RPM, blocks.features.get(other, blocks.position * 1.0) * factor
    heats = []
    for sign, title in ((1, "hoisting"), (-1, "lowering")):
        own = (blocks.direction == sign) & np.isfinite(x) & np.isfinite(y)
        if own.any():
            unit = f"mean gap [{shown_unit(result)}]"
            heats.append(_heat(x[own], y[own], gap[own], title, label, unit))
    return Plot("Where the gap is", [], [], "", [], "Measured minus predicted on the training runs, before the repair; "
                "empty cells hold no data.", heats=heats, height=250)  # fmt: skip


def _varies(values: FloatArray | None) -> bool:
    return values is not None and bool(np.isfinite(values).any()) and float(np.nanmax(values) - np.nanmin(values)) > 0.0


def _heat(x: FloatArray, y: FloatArray, gap: FloatArray, title: str, label: str, unit: str) -> Heat:
    span = [[0.0, float(x.max()) * 1.001 + 1e-9], [float(y.min()) - 1e-9, float(y.max()) * 1.001 + 1e-9]]
    sums, x_edges, y_edges = np.histogram2d(x, y, CELLS, span, weights=gap)
    counts, _, _ = np.histogram2d(x, y, CELLS, span)
    mean = np.where(counts > 2, sums / np.maximum(counts, 1), np.nan)
    centres = [0.5 * (edges[1:] + edges[:-1]) for edges in (x_edges, y_edges)]
    return Heat(centres[0], centres[1], mean.T, title, "motor speed [rpm]", label, unit)
