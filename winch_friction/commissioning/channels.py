"""What a finding of the commissioning check is, and those of every channel by itself: range, rate, gaps, steps,
saturation, standing still; and the clock.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from winch_friction.commissioning.view import broken_cells, usable
from winch_friction.physics.channels import LIMITS, display_unit
from winch_friction.physics.errors import counted
from winch_friction.physics.signals import FloatArray, Run, column_unit
from winch_friction.physics.winch.crane import Crane
from winch_friction.records.headers import conversion_to_si

SEVERITIES = ("error", "warning", "note")  # what contradicts the crane, what deserves a look, what is only said


@dataclass(frozen=True)
class Finding:
    """One thing that was found.

    `cause` is a stable identifier (`unit`, `sign`, `ports`, `groups`, `scale`, `crane`, `delay`, `tare`, `cell`, ...),
    `channel` the column it concerns (empty: none), `sentence` one line for a person, `runs` the runs it holds for,
    `evidence` plain numbers: residual before and after in N m at the shaft, scores, ratios.
    """

    severity: str
    cause: str
    sentence: str
    channel: str = ""
    runs: tuple[str, ...] = ()
    evidence: Mapping[str, Any] = field(default_factory=dict)

    @property
    def contradicts(self) -> bool:
        """Whether data with this finding cannot be this crane's, so that no result may be written from them."""
        return self.severity == "error"

    def content(self) -> dict[str, Any]:
        """Plain types."""
        return {
            "severity": self.severity,
            "cause": self.cause,
            "channel": self.channel,
            "sentence": self.sentence,
            "runs": list(self.runs),
            "evidence": dict(self.evidence),
        }


def first_contradiction(findings: Sequence[Finding]) -> Finding | None:
    """The most likely mistake, or None when the data may be this crane's; findings come in order of likelihood."""
    return next((each for each in findings if each.contradicts), None)


def runs_say(names: Sequence[str], total: int, verb: str) -> str:
    """`run_words` with a verb that agrees: 'run a fits', 'all 12 runs fit'."""
    return f"{run_words(names, total)} {verb}{'s' * (len(names) == 1)}"


def run_words(names: Sequence[str], total: int) -> str:
    """'all 12 runs', '3 of 12 runs (a, b, c)', or the run's name where there is one."""
    if total == 1:
        return f"run {names[0]}"
    if len(names) == total:
        return f"all {total} runs"
    shown = ", ".join(names[:3]) + (" and more" if len(names) > 3 else "")
    return f"{len(names)} of {total} runs ({shown})"


# -- every channel by itself
GAP = 5.0  # usual steps, as in records.run_checks
LONG = 1000.0  # a recording is at most this many times as long as its samples say: else the clock has jumped
SLOW_RATE = 5.0  # Hz; friction at a reversal takes place within a fifth of a second
TIME_UNITS = {"ms": 1e-3, "us": 1e-6, "ns": 1e-9}  # to s
UNIX = (6.3e8, 2.6e9)  # s since 1970, years 1990 to 2052
SLOW_STEP = 2.0  # s; in ms the step of a log with 500 Hz
THOUSANDTH = (4e-4, 2.5e-3)  # of the speed, as a channel tells it that is sampled coarsely
UNEVEN = 0.3  # of the usual step: scatter of the steps beyond which the clock is worth a word
COARSE = 200.0  # steps over a channel's range; fewer are coarse
SATURATED = 0.02  # of the samples at one extreme value of a moving channel
STUCK = 3.0  # s without any change in a channel that otherwise changes at every sample
MAY_SATURATE = ("pressure_a", "pressure_b", "motor_speed", "motor_torque", "motor_current")
MAY_STAND = ("hook_load", "wire_layer", "oil_temperature", "displacement", "wire_out", "speed_reference")

FROZEN_SPEED, FROZEN_SAMPLES, FROZEN_SWIVEL = 5.0, 100, 0.02  # rad/s both ways; samples; relative span


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


def clock_findings(run: Run) -> Iterator[Finding]:
    """What is wrong with the time of a run."""
    steps = np.diff(run.time)
    usual = float(np.median(steps))
    span = float(run.time[-1] - run.time[0])
    if unit := _unix_unit(run.time):
        yield time_in(unit, run, f"{run.time[0]:.13g} s since 1970 is in no year of ours, in {unit} it is")
        return
    if not np.isfinite(span) or span > LONG * usual * len(run):
        said = f"{run.name}: the clock jumps: {span:.3g} s long with {len(run)} samples of {usual:.3g} s; cut it there"
        yield Finding("error", "clock", said, "time", (run.name,), {"span": span, "usual_step": usual})
        return
    if 1.0 / usual < SLOW_RATE:
        said = f"{run.name}: {1.0 / usual:.3g} Hz is slow: log at 10 Hz or more to see reversals"
        yield Finding("warning", "rate", said, "time", (run.name,), {"rate": 1.0 / usual})
    scatter = float(np.percentile(np.abs(steps - usual), 90)) / usual
    if scatter > UNEVEN:
        said = f"{run.name}: uneven clock: one step in ten is {100 * scatter:.0f} % or more off the usual {usual:.3g} s"
        yield Finding("warning", "jitter", said, "time", (run.name,), {"scatter": scatter})
    gaps = steps[steps > GAP * usual]
    if gaps.size:
        said = f"{run.name}: {counted(gaps.size, 'gap', 'gaps')} in time, the widest {gaps.max():.3g} s"
        yield Finding("note", "gaps", said, "time", (run.name,), {"count": int(gaps.size), "widest": float(gaps.max())})


def _unix_unit(time: FloatArray) -> str:
    """The unit in which a time under s dates the run, where in s it dates it beyond any year; else nothing."""
    ends = np.array([time[0], time[-1]])
    return next((u for u, f in TIME_UNITS.items() if np.all((UNIX[0] < ends * f) & (ends * f < UNIX[1]))), "")


def time_in(unit: str, run: Run, why: str) -> Finding:
    """The finding that a run's time is in another unit than s."""
    usual = float(np.median(np.diff(run.time)))
    said = (
        f"{run.name}: time holds {unit} under [s]: {why}, and the usual step of {usual:.4g} s then is "
        f"{usual * TIME_UNITS[unit]:.4g} s; write 'time [{unit}]'"
    )
    return Finding("error", "unit", said, "time", (run.name,), {"factor": TIME_UNITS[unit], "usual_step": usual})


def told_slow_clock(run: Run, ratios: Mapping[str, float]) -> Iterator[Finding]:
    """Time in ms from another origin than 1970: a rate that a channel tells (`ratios` to the speed) is a thousandth.

    Asked only of steps that no log has; at others the channel itself may be in thousands.
    """
    slow = {name: ratio for name, ratio in ratios.items() if THOUSANDTH[0] < ratio < THOUSANDTH[1]}
    if slow and float(np.median(np.diff(run.time))) > SLOW_STEP:
        told = ", ".join(f"{name} tells {ratio:.3g} times the speed" for name, ratio in slow.items())
        yield time_in("ms", run, told)


def cell_findings(run: Run) -> Iterator[Finding]:
    """Few cells beyond what any sensor can say: not a unit, but broken."""
    for column, values in run.columns.items():
        bad = broken_cells(column, values) if column != "time" else np.empty(0, int)
        if bad.size:
            k = int(bad[0])
            said = (
                f"{run.name}: {column} = {values[k]:.3g} {column_unit(column) or ''} at {run.time[k]:.6g} s (sample "
                f"{k + 1}) is no measurement; {bad.size} such of {len(values)}: empty the cell or mend the logger"
            )
            yield Finding(
                "error", "cell", said, column, (run.name,), {"count": int(bad.size), "value": float(values[k])}
            )


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


def frozen_findings(run: Run) -> Iterator[Finding]:
    """The pressure that holds the load and does not change by a bit while the winch moves both ways at one
    displacement: friction and acceleration must move it, so nobody measured it.
    """
    speed = run["motor_speed"] if "motor_speed" in run else np.zeros(1)
    moving = np.isfinite(speed).any() and np.nanmin(speed) < -FROZEN_SPEED and np.nanmax(speed) > FROZEN_SPEED
    for group in run.groups if moving and len(run) >= FROZEN_SAMPLES else ():
        swept = run[f"{group}.displacement"]
        ports = [f"{group}.pressure_a", f"{group}.pressure_b"]
        if np.ptp(swept) > FROZEN_SWIVEL * np.abs(np.median(swept)):
            continue  # torque may be controlled by the displacement at a pressure that stands
        held = max(ports, key=lambda name: float(np.nanmean(run[name])))
        if np.nanmax(run[held]) == np.nanmin(run[held]):
            said = (
                f"{run.name}: {held} never changes ({_read(held, float(run[held][0]))}) though the winch hoists and "
                "lowers: a dead transducer or a frozen channel"
            )
            yield Finding("error", "stuck", said, held, (run.name,))


def channel_findings(run: Run) -> Iterator[Finding]:
    """What deserves a look in the channels of one run; nothing of it contradicts the crane."""
    for each in summaries(run):
        kind = each.channel.rpartition(".")[2]
        yield from _span_findings(run, each, kind)
        if each.missing > 0.0:
            said = f"{run.name}: {each.channel} has no value in {100 * each.missing:.2g} % of the samples"
            yield Finding("note", "missing", said, each.channel, (run.name,), {"share": each.missing})


def _span_findings(run: Run, each: ChannelSummary, kind: str) -> Iterator[Finding]:
    values = run[each.channel]
    span = each.largest - each.smallest
    if span <= 0.0 and kind not in MAY_STAND:
        said = (
            f"{run.name}: {each.channel} never changes ({_read(each.channel, each.smallest)}): is the sensor connected?"
        )
        yield Finding("warning", "stuck", said, each.channel, (run.name,))
        return
    if kind in MAY_STAND or span <= 0.0:
        return
    if each.longest_still > STUCK and _changes_always(values) and not _rests(run, each):
        said = f"{run.name}: {each.channel} stands still for {each.longest_still:.2g} s: stuck?"
        yield Finding("warning", "stuck", said, each.channel, (run.name,), {"seconds": each.longest_still})
    if each.step > 0.0 and span / each.step < COARSE and kind in LIMITS:
        steps = f"steps of {_read(each.channel, each.step, of_size=True)}, {span / each.step:.0f} over its range"
        said = f"{run.name}: {each.channel} has {steps}"
        yield Finding("note", "quantisation", said, each.channel, (run.name,), {"step": each.step})
    for extreme in (each.smallest, each.largest):
        share = float(np.mean(values == extreme))
        if share > SATURATED and kind in MAY_SATURATE and extreme != 0.0:
            often = f"in {100 * share:.1f} % of the samples: saturated?"
            said = f"{run.name}: {each.channel} is at {_read(each.channel, extreme)} {often}"
            yield Finding("warning", "saturation", said, each.channel, (run.name,), {"share": share})


def group_findings(runs: Sequence[Run], crane: Crane, contradicting: Sequence[str]) -> Iterator[Finding]:
    """Runs of some of the motors alone, where the crane file says that others share the shaft with them: one group has
    as many motors as all others together. What these hold nobody logged; in error where the run contradicts the crane.
    """
    sizes = dict(crane.groups)
    wholes = [name for name, size in sizes.items() if len(sizes) > 2 and 2 * size == sum(sizes.values())]
    for run in runs if wholes else ():
        forgotten = [name for name in sizes if name not in (*run.groups, *wholes)]
        if set(run.groups) & set(wholes) or not forgotten or not run.groups:
            continue
        there = sum(sizes.get(name, 0) for name in run.groups)
        said = (
            f"{run.name}: {there} of {sizes[wholes[0]]} motors; no columns of {', '.join(forgotten)}: "
            "forgotten when the log was written or imported?"
        )
        severity = "error" if run.name in contradicting else "warning"
        yield Finding(severity, "groups", said, f"{forgotten[0]}.pressure_a", (run.name,), {"motors": there})


def _read(column: str, value: float, of_size: bool = False) -> str:
    """An SI value (`of_size`: a difference) in the unit in which people read the column."""
    unit = column_unit(column) or "SI"
    display = display_unit(column) or unit
    scale, offset = conversion_to_si(display, unit, column) if display != unit else (1.0, 0.0)
    return f"{(value - (0.0 if of_size else offset)) / scale:.4g} {display}"


def _rests(run: Run, each: ChannelSummary) -> bool:
    """Whether the winch rests: its speed is zero, or turned the angle by two steps (`dead_findings` asks on)."""
    places = np.concatenate(([0], np.flatnonzero(np.diff(run[each.channel]) != 0.0) + 1, [len(run) - 1]))
    k = int(np.diff(run.time[places]).argmax())
    turned = abs(float(np.mean(run["motor_speed"][places[k] : places[k + 1]]))) * each.longest_still
    return turned <= {"motor_speed": 0.0, "shaft_angle": 2.0 * each.step}.get(each.channel, -1.0)


def _changes_always(values: FloatArray) -> bool:
    return float(np.mean(np.diff(values) != 0.0)) > 0.8
