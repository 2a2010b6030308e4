"""Every channel of a run in numbers, and what in them deserves a look: steps, saturation, standing still, holes.

Nothing of it contradicts the crane: the page of `check` shows it, no other verb asks.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from winch_friction.commissioning.channels import Finding, read_as
from winch_friction.commissioning.view import usable
from winch_friction.physics.channels import LIMITS
from winch_friction.physics.signals import FloatArray, Run, column_unit

COARSE = 200.0  # steps over a channel's range; fewer are coarse
# of the changes, those that are the smallest one, of a digit: a twentieth and more, for so it is found; of noise a
# twenty-fifth of that is as near. Relative: what a file rounds a digit to
IN_STEPS, ROUNDED = 0.03, 0.02
SATURATED = 0.02  # of the samples at one extreme value of a moving channel
STUCK = 3.0  # s without any change in a channel that otherwise changes at every sample
MAY_SATURATE = ("pressure_a", "pressure_b", "motor_speed", "motor_torque", "motor_current")
MAY_STAND = ("hook_load", "wire_layer", "oil_temperature", "displacement", "wire_out", "speed_reference")


@dataclass(frozen=True)
class ChannelSummary:
    """One channel of one run in numbers: SI values, `step` its smallest change, `longest_still` s without a change."""

    channel: str
    unit: str
    smallest: float
    largest: float
    missing: float
    step: float
    longest_still: float


def summaries(run: Run) -> list[ChannelSummary]:
    """Every channel in numbers."""
    return [_summary(run, name, usable(name, values)) for name, values in run.columns.items() if name != "time"]


def _summary(run: Run, name: str, values: FloatArray) -> ChannelSummary:
    good = values[np.isfinite(values)]
    changes = np.abs(np.diff(good))
    moved = changes[changes > 0.0]
    return ChannelSummary(
        name,
        column_unit(name) or "",
        float(good.min()) if good.size else float("nan"),
        float(good.max()) if good.size else float("nan"),
        1.0 - good.size / len(values),
        float(np.percentile(moved, 5)) if moved.size else 0.0,
        _longest_still(run.time, values),
    )


def _longest_still(time: FloatArray, values: FloatArray) -> float:
    places = np.concatenate(([0], np.flatnonzero(np.diff(values) != 0.0) + 1, [len(values) - 1]))
    return float(np.diff(time[places]).max(initial=0.0))


def channel_findings(run: Run) -> Iterator[Finding]:
    """What deserves a look in the channels of one run; nothing of it contradicts the crane."""
    for each in summaries(run):
        kind = each.channel.rpartition(".")[2]
        yield from _span_findings(run, each, kind)
        if each.missing > 0.0:
            said = f"{run.name}: {each.channel} has no value in {100 * each.missing:.3g} % of the samples"
            yield Finding("note", "missing", said, each.channel, (run.name,), {"share": each.missing})


def _span_findings(run: Run, each: ChannelSummary, kind: str) -> Iterator[Finding]:
    values = run[each.channel]
    span = each.largest - each.smallest
    if kind in MAY_STAND:
        return
    if span <= 0.0:
        at = read_as(each.channel, each.smallest)
        said = f"{run.name}: {each.channel} never changes ({at}): is the sensor connected?"
        yield Finding("warning", "stuck", said, each.channel, (run.name,))
        return
    if each.longest_still > STUCK and _changes_always(values) and not _rests(run, each):
        said = f"{run.name}: {each.channel} stands still for {each.longest_still:.2g} s: stuck?"
        yield Finding("warning", "stuck", said, each.channel, (run.name,), {"seconds": each.longest_still})
    if each.step > 0.0 and span / each.step < COARSE and kind in LIMITS and _in_steps(values, each.step):
        steps = f"steps of {read_as(each.channel, each.step, of_size=True)}, {span / each.step:.0f} over its range"
        said = f"{run.name}: {each.channel} has {steps}"
        yield Finding("note", "quantisation", said, each.channel, (run.name,), {"step": each.step})
    for extreme in (each.smallest, each.largest):
        share = float(np.mean(values == extreme))
        if share > SATURATED and kind in MAY_SATURATE and extreme != 0.0:
            often = f"in {100 * share:.1f} % of the samples: saturated?"
            said = f"{run.name}: {each.channel} is at {read_as(each.channel, extreme)} {often}"
            yield Finding("warning", "saturation", said, each.channel, (run.name,), {"share": share})


def _in_steps(values: FloatArray, step: float) -> bool:
    """Whether this smallest change is a digit, which many changes are, and not one of noise, of which no two are."""
    changes = np.abs(np.diff(values[np.isfinite(values)]))
    return float(np.mean(np.abs(changes[changes > 0.0] - step) <= ROUNDED * step)) > IN_STEPS


def _rests(run: Run, each: ChannelSummary) -> bool:
    """Whether the winch rests: its speed is zero, or turned the angle by two steps (`dead_findings` asks on)."""
    places = np.concatenate(([0], np.flatnonzero(np.diff(run[each.channel]) != 0.0) + 1, [len(run) - 1]))
    k = int(np.diff(run.time[places]).argmax())
    turned = abs(float(np.mean(run["motor_speed"][places[k] : places[k + 1]]))) * each.longest_still
    return turned <= {"motor_speed": 0.0, "shaft_angle": 2.0 * each.step}.get(each.channel, -1.0)


def _changes_always(values: FloatArray) -> bool:
    return float(np.mean(np.diff(values) != 0.0)) > 0.8
