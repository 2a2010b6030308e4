"""Pictures of the discrepancy report: where the gap is, before and after on the locked runs, the equation."""

from typing import Any

import numpy as np

from winch_friction.discrepancy.answer import GapResult, Side
from winch_friction.discrepancy.preparation.prepared_run import PreparedRun
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.signals import FloatArray
from winch_friction.physics.units import BAR, RPM
from winch_friction.report.figures import figure_html, new_figure

SPEED_BINS = 8
CELLS = 9
TRACES = 2
TRACE_TIME = 90.0  # s


def heat_maps(result: GapResult) -> str:
    """Mean gap of the training runs over speed and load, hoisting and lowering apart, before the repair."""
    blocks, gap = result.train.blocks, result.train.before
    other = next((n for n in ("hook_load", "acceleration") if _varies(blocks.features.get(n))), "time")
    x, y = blocks.features["motor_speed"], blocks.features[other]
    limit = float(np.percentile(np.abs(gap), 98)) or 1.0
    figure, axes = new_figure(1, 2, 3.2, sharey=True)
    for axis, sign, title in zip(axes, (1, -1), ("hoisting", "lowering"), strict=True):
        own = (blocks.direction == sign) & np.isfinite(x) & np.isfinite(y)
        if own.any():
            picture = _cells(axis, x[own], y[own] * (1e-3 if other == "hook_load" else 1.0), gap[own], limit)
            figure.colorbar(picture, ax=axis, label=f"mean gap, {result.unit}")
        axis.set(title=title, xlabel="motor speed, rad/s")
    axes[0].set_ylabel("hook load, t" if other == "hook_load" else other)
    return figure_html(
        figure, "Measured minus predicted on the training runs, before the repair; empty cells hold no data."
    )


def _varies(values: FloatArray | None) -> bool:
    return values is not None and bool(np.isfinite(values).any()) and float(np.nanmax(values) - np.nanmin(values)) > 0.0


def _cells(axis: Any, x: FloatArray, y: FloatArray, gap: FloatArray, limit: float) -> Any:
    span = [[0.0, float(x.max()) * 1.001 + 1e-9], [float(y.min()) - 1e-9, float(y.max()) * 1.001 + 1e-9]]
    sums, x_edges, y_edges = np.histogram2d(x, y, CELLS, span, weights=gap)
    counts, _, _ = np.histogram2d(x, y, CELLS, span)
    mean = np.where(counts > 2, sums / np.maximum(counts, 1), np.nan)
    axis.grid(False)
    return axis.pcolormesh(x_edges, y_edges, mean.T, cmap="RdBu_r", vmin=-limit, vmax=limit)


def speed_bars(result: GapResult) -> str:
    """RMS gap of the locked runs by speed, before and after, against the noise floor."""
    side = result.holdout
    speed = side.blocks.features["motor_speed"]
    edges = np.linspace(0.0, float(speed.max()) * 1.0001 + 1e-9, SPEED_BINS + 1)
    index = np.clip(np.digitize(speed, edges) - 1, 0, SPEED_BINS - 1)
    hydraulic = result.unit == "bar"
    centre = 0.5 * (edges[1:] + edges[:-1]) / (RPM if hydraulic else 1.0)
    width = (centre[1] - centre[0]) * 0.38
    figure, axis = new_figure(1, 1, 2.8)
    for shift, values, label in ((-0.5, side.before, "before"), (0.5, side.after, "after")):
        rms = [
            float(np.sqrt(np.mean(values[index == k] ** 2))) if (index == k).any() else 0.0 for k in range(SPEED_BINS)
        ]
        axis.bar(centre + shift * width, rms, width, label=label)
    axis.axhline(side.noise_floor, color="#555", linestyle="--", linewidth=1, label="noise floor")
    axis.set(xlabel="motor speed, rpm" if hydraulic else "speed, rad/s", ylabel=f"RMS gap, {result.unit}")
    axis.legend()
    return figure_html(figure, "Locked runs: the gap by speed, before and after the repair.")


def traces(result: GapResult) -> str:
    """Measured pressure of locked runs with the model's, before and after, and what is left."""
    side = result.holdout
    chosen = _kinds(side)[:TRACES]
    figure, axes = new_figure(2, len(chosen), 2.5, squeeze=False, sharex="col")
    for k, number in enumerate(chosen):
        run, own = side.runs[number], side.blocks.run == number
        own &= side.blocks.position * LIMITS.block_samples * run.dt < TRACE_TIME
        time = side.blocks.position[own] * LIMITS.block_samples * run.dt
        measured = _measured(run)[
            np.minimum(side.blocks.position[own] * LIMITS.block_samples + LIMITS.block_samples // 2, len(run.time) - 1)
        ]
        lines = (
            (measured, "measured"),
            (measured - side.before[own], "model before"),
            (measured - side.after[own], "model after"),
        )
        for values, label in lines:
            axes[0][k].plot(*_with_breaks(time, values, run.dt), label=label, linewidth=1.1)
        for values, label in ((side.before[own], "before"), (side.after[own], "after")):
            axes[1][k].plot(*_with_breaks(time, values, run.dt), label=label, linewidth=1.1)
        axes[0][k].set_title(run.name)
        axes[1][k].set_xlabel("time, s")
    axes[0][0].set_ylabel(f"drive, {result.unit}")
    axes[1][0].set_ylabel(f"gap, {result.unit}")
    axes[0][0].legend()
    axes[1][0].legend()
    return figure_html(figure, "Locked runs while moving (block means); reversals and rest are left out.")


def _kinds(side: Side) -> list[int]:
    """One run of each kind first."""
    present = [k for k in range(len(side.runs)) if (side.blocks.run == k).any()]
    seen: dict[tuple[str, ...], int] = {}
    for k in present:
        seen.setdefault(side.runs[k].mode, k)
    return list(seen.values()) + [k for k in present if k not in seen.values()]


def _measured(run: PreparedRun) -> FloatArray:
    others = sum((g.count * g.displacement * g.pressure for g in run.groups if not g.balances), np.zeros(len(run.time)))
    total = run.gap + run.predicted - others
    own = next((g for g in run.groups if g.balances), None)
    return total / (BAR * own.count * own.displacement) if own else total / run.unit_torque


def _with_breaks(time: FloatArray, values: FloatArray, dt: float) -> tuple[FloatArray, FloatArray]:
    gaps = np.flatnonzero(np.diff(time) > 3.0 * LIMITS.block_samples * dt) + 1
    return np.insert(time, gaps, np.nan), np.insert(values, gaps, np.nan)


def equation(latex: str) -> str:
    """A formula as a picture, with matplotlib's own typesetting; its source where that cannot set it."""
    figure, axis = new_figure(1, 1, 0.6)
    axis.set_axis_off()
    text = axis.text(0.0, 0.5, f"${latex}$", fontsize=14, va="center")
    try:
        return figure_html(figure, "", latex)
    except ValueError:
        text.set_text(latex)
        return figure_html(figure, "", latex)
