"""The demo's picture: the same stretch of sea on every leg, with every feedforward."""

from typing import Any

import numpy as np

from winch_friction.cli.demo.measures import PhaseFigures, of_leg
from winch_friction.cli.demo.plan import DemoPlan
from winch_friction.cli.demo.recording import Recording
from winch_friction.report.figures import COLOURS, look, new_figure

WINDOW = 20.0  # s shown, at the end of each leg
GREY = "#777777"


def draw(plan: DemoPlan, recording: Recording, rows: list[PhaseFigures]) -> Any:
    """Per leg: residual heave, friction torque against feedforward, and what each feedforward leaves."""
    sailed = list(zip(plan.phases, recording.phases(len(plan.phases)), strict=True))
    with look():
        figure, axes = new_figure(3, len(plan.legs), height=2.6, width=10.2, sharey="row", squeeze=False)
        for k, leg in enumerate(plan.legs):
            here = [part for phase, part in sailed if phase.leg is leg]
            titles = [each.title for each in plan.feedforwards]
            tuned = " (tuned here)" if k == 0 else ""
            axes[0, k].set_title(leg.title)
            _draw_residual(axes[0, k], titles, here)
            _draw_torque(axes[1, k], titles, here)
            _draw_left(axes[2, k], of_leg(rows, leg.name), tuned)
        axes[0, 0].set_ylabel("position error [mm]")
        axes[1, 0].set_ylabel("friction torque [N m]")
        axes[2, 0].set_ylabel("left of the heave, RMS [mm]")
        handles, labels = axes[1, 0].get_legend_handles_labels()
        first, name = axes[0, 0].get_legend_handles_labels()
        figure.legend(
            [first[0], *handles[1:], handles[0]],
            [name[0], *labels[1:], labels[0]],
            loc="outside upper center",
            ncols=len(labels) + 1,
        )
    return figure


def shown(part: Recording, rows: Any) -> tuple[Any, Any]:
    """Time since the leg's start and the rows inside the window."""
    time = rows[:, 0] - part.truth[0, 0]
    end = part.truth[-1, 0] - part.truth[0, 0]  # after it the compensator is switched off
    inside = (time >= end - WINDOW) & (time <= end)
    return time[inside], rows[inside]


def _draw_residual(axes: Any, titles: list[str], parts: list[Recording]) -> None:
    for colour, title, part in zip(COLOURS, titles, parts, strict=False):
        time, truth = shown(part, part.truth)
        axes.plot(time, truth[:, 1] * 1e3, color=colour, label=title)


def _draw_torque(axes: Any, titles: list[str], parts: list[Recording]) -> None:
    time, truth = shown(parts[-1], parts[-1].truth)
    axes.plot(time, truth[:, 3], color=GREY, linewidth=3.5, alpha=0.6, label="true friction")
    for colour, title, part in list(zip(COLOURS, titles, parts, strict=False))[1:]:
        time, fed = shown(part, part.fed)
        axes.plot(time, fed[:, 1], color=colour, label=title)
    axes.set_xlabel("time since the leg began [s]")


def _draw_left(axes: Any, rows: list[PhaseFigures], note: str) -> None:
    places = np.arange(len(rows))
    heights = [row.residual * 1e3 for row in rows]
    bars = axes.bar(places, heights, 0.7, color=COLOURS[: len(rows)])
    texts = [f"{h:.1f}" + (f"\n−{row.gain:.0%}" if row.gain else "") for h, row in zip(heights, rows, strict=True)]
    axes.bar_label(bars, texts, fontsize=9, padding=2)
    axes.margins(y=0.25)
    axes.set_xticks(places, [_short(row, note) for row in rows], fontsize=8.5)
    axes.grid(visible=False, axis="x")


def _short(row: PhaseFigures, note: str) -> str:
    own = row.phase.feedforward
    return f"{own.name}\n{note.strip()}" if own.name == "efficiency" and note else own.name
