"""The demo's figures on its page: a leg at a time, position error and friction torque, every feedforward."""

from typing import Any

from winch_friction.cli.demo.picture import shown
from winch_friction.cli.demo.plan import DemoPlan
from winch_friction.cli.demo.recording import Recording
from winch_friction.report.plots import Frame, Line, Plot

TIME, ERROR, TORQUE = "time since the leg began [s]", "position error [mm]", "friction torque [N·m]"


def leg_plots(plan: DemoPlan, recording: Recording) -> list[Plot]:
    """A figure per leg over its last seconds; all zoom together."""
    sailed = list(zip(plan.phases, recording.phases(len(plan.phases)), strict=True))
    return [_plot(leg.title, [(p, part) for p, part in sailed if p.leg is leg]) for leg in plan.legs]


def _plot(title: str, parts: list[tuple[Any, Recording]]) -> Plot:
    frames, lines = [], []
    time, truth = shown(parts[-1][1], parts[-1][1].truth)
    frames.append(Frame("true friction", {TIME: time, TORQUE: truth[:, 3]}))
    lines.append(Line("true friction", TIME, TORQUE, 0, 1, "truth"))
    for phase, part in parts:
        label = phase.feedforward.title
        time, truth = shown(part, part.truth)
        frames.append(Frame(f"{label}, error", {TIME: time, ERROR: truth[:, 1] * 1e3}))
        lines.append(Line(label, TIME, ERROR, len(frames) - 1, 0))
    for k, (phase, part) in enumerate(parts):
        if not phase.feedforward.enabled:
            continue
        time, fed = shown(part, part.fed)
        frames.append(Frame(f"{phase.feedforward.title}, fed", {TIME: time, TORQUE: fed[:, 1]}))
        lines.append(Line(phase.feedforward.title, TIME, TORQUE, len(frames) - 1, 1, like=k))
    said = f"{title}: position error of the load, and the feedforward beside the plant's true friction."
    return Plot(title, frames, lines, TIME, [ERROR, TORQUE], said, "legs", height=190)
