"""The demo's picture: the same stretch of sea in every phase."""

from typing import Any

import numpy as np

from winch_friction.cli.demo.measures import BINS, PhaseFigures, bin_label
from winch_friction.cli.demo.plan import DemoPlan
from winch_friction.cli.demo.recording import Recording
from winch_friction.report.figures import COLOURS, look, new_figure

WINDOW = 30.0  # s shown, at the end of each phase
GREY = "#777777"


def draw(plan: DemoPlan, recording: Recording, rows: list[PhaseFigures]) -> Any:
    """Residual heave, friction torque against feedforward, and the error by speed bin."""
    parts = recording.phases(len(plan.phases))
    with look():
        figure, axes = new_figure(3, 1, height=2.8, width=9.6)
        _draw_residual(axes[0], plan, parts)
        _draw_torque(axes[1], plan, parts)
        _draw_errors(axes[2], rows)
    return figure


def _shown(part: Recording, rows: Any) -> tuple[Any, Any]:
    """Time since the phase's start and the rows inside the window."""
    time = rows[:, 0] - part.truth[0, 0]
    inside = time >= part.truth[-1, 0] - part.truth[0, 0] - WINDOW
    return time[inside], rows[inside]


def _draw_residual(axes: Any, plan: DemoPlan, parts: list[Recording]) -> None:
    for colour, phase, part in zip(COLOURS, plan.phases, parts, strict=False):
        time, truth = _shown(part, part.truth)
        axes.plot(time, truth[:, 1] * 1e3, color=colour, label=phase.title)
    axes.set(ylabel="residual heave [mm]", title="The load's position error on the same sea, by feedforward")
    _legend_above(axes)


def _draw_torque(axes: Any, plan: DemoPlan, parts: list[Recording]) -> None:
    time, truth = _shown(parts[-1], parts[-1].truth)
    axes.plot(time, truth[:, 3], color=GREY, linewidth=3.0, alpha=0.6, label="true friction")
    for colour, phase, part in list(zip(COLOURS, plan.phases, parts, strict=False))[1:]:
        time, fed = _shown(part, part.fed)
        axes.plot(time, fed[:, 1], color=colour, label=phase.title)
    axes.set(xlabel="time since the phase began [s]", ylabel="torque [N m]", title="Friction and what was fed forward")
    _legend_above(axes)


def _draw_errors(axes: Any, rows: list[PhaseFigures]) -> None:
    visited = [k for k in range(len(BINS)) if np.isfinite(rows[0].friction_error[k])]
    places, width = np.arange(len(visited)), 0.8 / len(rows)
    for k, (colour, row) in enumerate(zip(COLOURS, rows, strict=False)):
        heights = [100.0 * row.friction_error_share[each] for each in visited]
        axes.bar(places + (k - 0.5 * (len(rows) - 1)) * width, heights, width, color=colour, label=row.title)
    axes.set_xticks(places, [bin_label(BINS[each]) for each in visited])
    axes.set(ylabel="error [% of friction]", title="Error of the friction torque by motor speed")
    _legend_above(axes)


def _legend_above(axes: Any) -> None:
    """Beside the title, where no curve passes."""
    axes.legend(ncols=5, loc="lower right", bbox_to_anchor=(1.0, 0.98), borderaxespad=0.0, columnspacing=1.0)
