"""What a finding of the commissioning check is, and those of a channel by itself that the quick check asks for.

The clock, broken cells, a pressure that is frozen, motor groups without columns; a layer that the drum has not, oil
hotter than oil is.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from winch_friction.commissioning.kinematics import ways
from winch_friction.commissioning.view import BROKEN_SHARE, broken_cells, usable
from winch_friction.physics.channels import display_unit
from winch_friction.physics.errors import counted
from winch_friction.physics.signals import FloatArray, Run, column_unit
from winch_friction.physics.winch.crane import Crane
from winch_friction.physics.winch.operating_point import DISPLACEMENT_MARGIN
from winch_friction.records.unit_names import conversion_to_si

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
UNEVEN_CLOCK = "jitter"  # its cause

FROZEN_SPEED, FROZEN_SAMPLES, FROZEN_SWIVEL = 5.0, 100, 0.02  # rad/s both ways; samples; relative span


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
        yield Finding("warning", UNEVEN_CLOCK, said, "time", (run.name,), {"scatter": scatter})
    gaps = steps[steps > GAP * usual]
    if gaps.size:
        said = f"{run.name}: {counted(gaps.size, 'gap', 'gaps')} in time, the widest {gaps.max():.3g} s"
        yield Finding("note", "gaps", said, "time", (run.name,), {"count": int(gaps.size), "widest": float(gaps.max())})


def uneven_once(findings: Sequence[Finding], total: int) -> list[Finding]:
    """Findings of the clocks of so many runs, in one line where several are uneven: the logger is."""
    uneven = [each for each in findings if each.cause == UNEVEN_CLOCK]
    if len(uneven) < 2:
        return list(findings)
    names = tuple(name for each in uneven for name in each.runs)
    least = min(each.evidence["scatter"] for each in uneven)
    who = runs_say(names, total, "have")
    said = f"{who} an uneven clock: one step in ten is {100 * least:.0f} % or more off the usual"
    once = Finding("warning", UNEVEN_CLOCK, said, "time", names, {"scatter": least})
    return [*(each for each in findings if each.cause != UNEVEN_CLOCK), once]


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
                f"{run.name}: {column} = {values[k]:.3g} {column_unit(column) or ''} {run.time[k] - run.time[0]:.6g} s "
                f"after its beginning (sample {k + 1}) is no measurement; {bad.size} such of {len(values)}: empty the "
                "cell or mend the logger"
            )
            yield Finding(
                "error", "cell", said, column, (run.name,), {"count": int(bad.size), "value": float(values[k])}
            )


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
                f"{run.name}: {held} never changes ({read_as(held, float(run[held][0]))}) though the winch hoists and "
                "lowers: a dead transducer or a frozen channel"
            )
            yield Finding("error", "stuck", said, held, (run.name,))


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


def read_as(column: str, value: float, of_size: bool = False) -> str:
    """An SI value (`of_size`: a difference) in the unit in which people read the column."""
    unit = column_unit(column) or "SI"
    display = display_unit(column) or unit
    scale, offset = conversion_to_si(display, unit, column) if display != unit else (1.0, 0.0)
    return f"{(value - (0.0 if of_size else offset)) / scale:.4g} {display}"


# -- readings that cannot be what their column says
# degC; a hydraulic oil is at the end of its viscosity above, and 40 degC are 104 degF and 313 K
OIL = (-20.0, 95.0)
FREEZING = 273.15  # K
# causes of layers counted from 0, which no drum has, and of strokes over centre, which no model knows: these come first
FIRST_READINGS = "counted", "over_centre"
NEARER = 3.0  # times: a counter of the wire is right within a per cent or two, a layer's radius is 5 to 8 % larger


def reading_findings(runs: Sequence[Run], crane: Crane) -> Iterator[Finding]:
    """What is wrong with strokes, layers and oil of runs, by the crane's motors and drum and by what oil is."""
    for run in runs:
        yield from _of_strokes(run, crane)
        yield from _of_layers(run, crane)
        yield from _one_layer_up(run, crane)
        yield from _of_oil(run)


def _of_strokes(run: Run, crane: Crane) -> Iterator[Finding]:
    lowest = -DISPLACEMENT_MARGIN * crane.max_displacement  # the nodes' own, m^3/rad
    for name in (f"{group}.displacement" for group in run.groups if crane.max_displacement):
        strokes = _sane(run, name)
        beyond = float(np.mean(strokes < lowest)) if len(strokes) and strokes.max() > 0.0 else 0.0
        if beyond > BROKEN_SHARE:
            said = (
                f"{run.name}: {name} is over centre, to {read_as(name, strokes.min())}: below {read_as(name, lowest)} "
                "the nodes take it for lost, and no model tells the friction there; log its size, with pressure_a and "
                "pressure_b exchanged meanwhile"
            )
            yield Finding("error", "over_centre", said, name, (run.name,), {"share": beyond})


def _of_layers(run: Run, crane: Crane) -> Iterator[Finding]:
    layers = _sane(run, "wire_layer")
    if not len(layers) or (crane.drum.has(layers.min()) and crane.drum.has(layers.max())):
        return
    said = (
        f"{run.name}: wire_layer is {layers.min():g} ... {layers.max():g}, the drum has layers 1 ... "
        f"{len(crane.drum.layer_radii)}"
    )
    from_zero = layers.min() == 0.0 and crane.drum.has(layers.max() + 1.0)
    if from_zero:
        said += ": 1 is the innermost; where the log counts it as 0, add 1"
    off = float(np.mean([not crane.drum.has(each) for each in layers]))
    # few cells are a counter that was not set yet
    severity, cause = "error" if off > BROKEN_SHARE else "warning", "counted" if from_zero else "range"
    yield Finding(severity, cause, said, "wire_layer", (run.name,), {"share": off})


def _one_layer_up(run: Run, crane: Crane) -> Iterator[Finding]:
    """A log that counts layers from 0 and never comes to the innermost: its wire moves as on the next layer."""
    layers = _sane(run, "wire_layer")
    if len(set(layers.tolist())) != 1 or not (crane.drum.has(layers[0]) and crane.drum.has(layers[0] + 1)):
        return
    own, radii = round(float(layers[0])), np.array(crane.drum.layer_radii)
    told = ways(run, crane).get("wire_out", 0.0) * float(np.mean(radii))
    off = np.abs(told - radii)
    if NEARER * off[own] < off[own - 1]:
        said = (
            f"{run.name}: wire_layer is {own}, whose radius is {radii[own - 1]:.4g} m, and wire_out moves as on layer "
            f"{own + 1} ({told:.4g} m by the speed, {radii[own]:.4g} m by the crane file): where the log counts the "
            "innermost as 0, add 1"
        )
        yield Finding("warning", "layer", said, "wire_layer", (run.name,), {"told_radius": told})


def _of_oil(run: Run) -> Iterator[Finding]:
    oil = _sane(run, "oil_temperature")
    if not len(oil) or (OIL[0] <= oil.min() and oil.max() <= OIL[1]):
        return
    kelvin = OIL[0] <= oil.min() - FREEZING and oil.max() - FREEZING <= OIL[1]
    unit, severity = ("kelvin", "error") if kelvin else ("degF", "warning")
    said = (
        f"{run.name}: oil of {oil.min():.3g} ... {oil.max():.3g} degC: does oil_temperature hold {unit} under [degC]?"
    )
    yield Finding(severity, "range", said, "oil_temperature", (run.name,))


def _sane(run: Run, name: str) -> FloatArray:
    values = usable(name, run.column(name))
    return values[np.isfinite(values)]
