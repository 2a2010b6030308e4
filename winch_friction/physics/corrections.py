"""Corrections taken out of whole runs and of the crane.

What happens to a channel on its way into the log is a delay, then a gain, which may grow, then an offset, then a
filter; they are taken out in the opposite order. Loads, calculated gas pressures and the commanded speed follow, from
signals that are right by then.
"""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from winch_friction.physics.channels import GRAVITY
from winch_friction.physics.errors import InputError
from winch_friction.physics.fluid import (
    air_compressed,
    leakage_per_coefficient,
    relative_viscosity,
    relaxed_compression,
)
from winch_friction.physics.friction.correction import Correction
from winch_friction.physics.friction.declared_correction import Action
from winch_friction.physics.friction.model import FrictionModel
from winch_friction.physics.signals import GROUP_CHANNELS, FloatArray, Run
from winch_friction.physics.winch.crane import Crane, Drum, driving_group, run_rope_radius

Columns = dict[str, FloatArray]
SIGNAL_ORDER = (
    Action.FILTER, Action.OFFSET, Action.BEND, Action.S_SHAPE, Action.CURVATURE, Action.SCALE, Action.DELAY,
    Action.MASS, Action.HEAT, Action.WARMTH, Action.SLIP, Action.AIR,
)  # fmt: skip
S_HEIGHT = 6.0 * math.sqrt(3.0)  # times x (1 - x) (1 - 2 x): its extremes are -1 and 1
WEIGHED = ("hook_load", "rope_force", "load_torque")  # columns of which one tells what hangs there
LEAST_STROKE = 0.01  # of the largest displacement; the feedback's own error, 1 %, is all of what is shown below
NEWTON_STEPS = 6  # an S of a tenth of what would fold it is exact to rounding after three


def corrected(run: Run, crane: Crane, model: FrictionModel) -> tuple[Run, Crane]:
    """A run and a crane without the errors that the model knows of.

    What a signal had for a time is taken out of the runs that began then. A delay shortens the run by what it shifts.
    Raises `InputError`, one line for all of it, where a channel, group or layer that a correction needs is missing.
    """
    if not model.corrections:
        return run, crane
    there = in_turn(each for each in model.corrections if each.holds(float(run.time[0])))
    problems = [each for one in there for each in _missing(one, run)]
    if problems:
        raise InputError(f"{run.name}: {'; '.join(problems)} (model '{model.name}')")
    right = corrected_crane(crane, model.corrections, model.name)
    columns: Columns = dict(run.columns)
    for action in SIGNAL_ORDER:
        for each in there:
            if each.declared.action is action:
                columns = _ON_RUNS[action](columns, run, each, right)
    names = tuple(dict.fromkeys(each.name for each in there))
    return replace(run, columns=columns, metadata={**run.metadata, "corrections": names}), right


def corrected_crane(crane: Crane, corrections: Sequence[Correction], model: str = "") -> Crane:
    """The crane with the geometry and the inertia that corrections give it; unknown groups or layers, and what would
    leave a radius or an inertia at or below zero, raise `InputError`, which names the `model` that has them."""
    radii, inertia = list(crane.drum.layer_radii), crane.inertia
    whose = f"model '{model}': " if model else ""
    for each in corrections:
        try:
            for group in each.groups:
                crane.motor_count(group)
        except InputError as unknown:
            raise InputError(f"{whose}correction '{each.name}': {unknown}") from None
        if each.declared.action is Action.RADIUS:
            for layer in each.layers or range(1, len(radii) + 1):
                if not 1 <= layer <= len(radii):
                    raise InputError(f"{whose}correction '{each.name}': crane '{crane.name}' has no wire layer {layer}")
                radii[layer - 1] += each.value
        elif each.declared.action is Action.INERTIA:
            inertia += each.value
    if min(radii) <= 0.0 or inertia <= 0.0:
        raise InputError(
            f"{whose}crane '{crane.name}': corrections leave a rope radius or the inertia at or below zero"
        )
    same = tuple(radii) == crane.drum.layer_radii and inertia == crane.inertia
    return crane if same else replace(crane, drum=Drum(tuple(radii)), inertia=inertia)


def affected(correction: Correction, groups: Iterable[str]) -> tuple[str, ...]:
    """Run columns that a correction changes, for a run with these motor groups."""
    chosen = [group for group in groups if not correction.groups or group in correction.groups]
    columns: list[str] = []
    for channel in correction.declared.channels:
        columns += [f"{g}.{channel}" for g in chosen] if channel in GROUP_CHANNELS else [channel]
    return tuple(columns)


def _missing(correction: Correction, run: Run) -> list[str]:
    """What a run lacks for one correction, in words; a motor group that does not run needs none."""
    own = correction.declared
    wanted = [*own.channels, *own.reads]
    if own.late:  # whatever of these a run has is late by the same
        return []
    whole = [channel for channel in wanted if channel not in GROUP_CHANNELS]
    if own.action is Action.MASS and any(name in run for name in WEIGHED):
        whole.remove("hook_load")
    groups = [g for g in run.groups if not correction.groups or g in correction.groups]
    needed = whole + [f"{g}.{channel}" for g in groups for channel in wanted if channel in GROUP_CHANNELS]
    return [f"column '{name}' is missing; correction {correction.name} needs it" for name in needed if name not in run]


# -- whole runs
def _shown(columns: Columns, run: Run, c: Correction, crane: Crane) -> Columns:
    error = c.error(columns["time"], columns.get("oil_temperature"))
    return columns | {name: true_value(columns[name], c, error) for name in affected(c, run.groups) if name in columns}


def true_value(logged: Any, c: Correction, error: Any) -> Any:
    """The true value of what a channel shows; `error` is the correction's at that time."""
    action = c.declared.action
    if action is Action.OFFSET:
        return logged - error
    if action is Action.BEND:
        return unbent(logged, c)
    if action is Action.S_SHAPE:
        return unswung(logged, c)
    return straight(logged, error) if action is Action.CURVATURE else logged / (1.0 + error)


def unbent(logged: Any, c: Correction) -> Any:
    """The true x of logged = x + e (x - beyond) for what lies beyond, and of logged = x below."""
    assert c.beyond is not None
    return logged - c.value / (1.0 + c.value) * np.maximum(logged - c.beyond, 0.0)


def s_shape(x: Any) -> Any:
    """An S of height 1 that is nothing at 0, 0.5 and 1, and goes on straight outside; compiled into the simulated
    sensors as well."""
    inside = np.minimum(np.maximum(x, 0.0), 1.0)
    return S_HEIGHT * (inside * (1.0 - inside) * (1.0 - 2.0 * inside) + x - inside)


def unswung(logged: Any, c: Correction) -> Any:
    """The true x of logged = x + e s(x / beyond), by Newton's steps from the logged value; where the S would fold the
    shown value back the step is what a slope of a tenth gives."""
    assert c.beyond is not None
    x = logged / c.beyond
    for _ in range(NEWTON_STEPS):
        inside = np.clip(x, 0.0, 1.0)
        slope = 1.0 + c.value / c.beyond * S_HEIGHT * (1.0 - 6.0 * inside * (1.0 - inside))
        x = x - (x + c.value / c.beyond * s_shape(x) - logged / c.beyond) / np.maximum(slope, 0.1)
    return x * c.beyond


def in_turn(corrections: Iterable[Correction]) -> list[Correction]:
    """Corrections in their order; of several bends the furthest first, for each was put on what is nearer to zero."""
    return sorted(corrections, key=lambda c: -(c.beyond or 0.0))


def straight(logged: Any, per_unit: float) -> Any:
    """The true x of logged = x (1 + e x): the root near the logged value, without a division by a small e. Far below
    zero, where no pressure is, the root would end; there it is held."""
    return 2.0 * logged / (1.0 + np.sqrt(np.maximum(1.0 + 4.0 * per_unit * logged, 0.0)))


def _late(columns: Columns, run: Run, c: Correction) -> list[str]:
    """Columns that came late by the same."""
    late = [name for name in affected(c, run.groups) if name in columns]
    if "motor_speed" in late and "heave_velocity" not in columns:  # a simulation that the log drove is late as well
        late += [name for name in columns if name.endswith("_simulated")]
    return late


def _filter(columns: Columns, run: Run, c: Correction, crane: Crane) -> Columns:
    """What went into a first-order lag is what came out and its change within the time constant."""
    time = columns["time"]
    if len(time) < 2:
        return columns
    late = {name: columns[name] + c.value * np.gradient(columns[name], time) for name in _late(columns, run, c)}
    return columns | late


def _delay(columns: Columns, run: Run, c: Correction, crane: Crane) -> Columns:
    """What is logged at t happened at t - delay; rows at the end (or the start) that nothing is known of fall away.
    What went by while a full buffer was emptied is nowhere: there a line is drawn."""
    time, late = columns["time"], _late(columns, run, c)
    if not late or len(time) < 2:
        return columns
    happened = time - c.value * lateness(c.declared.course, time - time[0], c.time_constant, c.course)
    inside = (happened[0] <= time) & (time <= happened[-1])
    if inside.sum() < 2:
        raise InputError(f"{run.name}: too short for a {c.name} of {c.value:g} s")
    shifted = {name: np.interp(time, happened, columns[name]) for name in late}
    return {name: values[inside] for name, values in (columns | shifted).items()}


def lateness(
    course: str, since: FloatArray, time_constant: float | None, drawn: Sequence[tuple[float, float]] = ()
) -> FloatArray:
    """How much of a delay there is, `since` s from a run's beginning: all of it; of a `clock` that drifts so much per
    second; of a `buffer` what has come in since it was emptied; of a `backlog` what is not worked off; of one that is
    `drawn` what its points say."""
    if drawn:
        return np.interp(since, *np.transpose(drawn))
    if time_constant is None:
        return since if course == "clock" else np.ones_like(since)
    return np.mod(since / time_constant, 1.0) if course == "buffer" else np.exp(-since / time_constant)


def _mass(columns: Columns, run: Run, c: Correction, crane: Crane) -> Columns:
    """A mass more, in whatever tells the load: itself, the rope's force or the torque that it makes at the shaft."""
    mass = c.error(columns["time"], None) * (columns["wire_out"] if "wire_out" in c.declared.reads else 1.0)
    shown: Columns = {"hook_load": mass} if "hook_load" in columns else {"rope_force": GRAVITY * mass}
    if "load_torque" in columns:
        shown["load_torque"] = mass * GRAVITY * run_rope_radius(replace(run, columns=columns), crane) / crane.gear_ratio
    return columns | {name: columns[name] + more for name, more in shown.items() if name in columns}


def _warmth(columns: Columns, run: Run, c: Correction, crane: Crane) -> Columns:
    fading = np.exp(-(columns["time"] - run.time[0]) / c.time_constant)
    return columns | {name: columns[name] * (1.0 + c.value * fading) for name in affected(c, run.groups)}


def _heat(columns: Columns, run: Run, c: Correction, crane: Crane) -> Columns:
    assert c.time_constant is not None
    return columns | {
        name: columns[name] * (1.0 - c.value * relaxed_compression(columns["time"], columns[name], c.time_constant))
        for name in affected(c, run.groups)
    }


def _slip(columns: Columns, run: Run, c: Correction, crane: Crane) -> Columns:
    groups = [g for g in run.groups if not c.groups or g in c.groups]
    if not groups:
        return columns
    driving = driving_group(groups)
    drop = columns[f"{driving}.pressure_a"] - columns[f"{driving}.pressure_b"]
    thinness = 1.0 / relative_viscosity(columns["oil_temperature"]) if "oil_temperature" in columns else 1.0
    lost = c.value * leakage_per_coefficient(c.name, drop, thinness) / _stroke(columns, driving, crane)
    return columns | {"speed_reference": columns["speed_reference"] - lost}


def _air(columns: Columns, run: Run, c: Correction, crane: Crane) -> Columns:
    groups = [g for g in run.groups if not c.groups or g in c.groups]
    if not groups or len(run.time) < 2:
        return columns
    driving = driving_group(groups)
    taken = air_compressed(columns[f"{driving}.pressure_a"], columns[f"{driving}.pressure_b"])
    swept = crane.motor_count(driving) * _stroke(columns, driving, crane)
    lost = c.value * np.gradient(taken, columns["time"]) / swept
    return columns | {"speed_reference": columns["speed_reference"] - lost}


def _stroke(columns: Columns, group: str, crane: Crane) -> FloatArray:
    """The displacement, m^3/rad, by which lost oil becomes lost speed; NaN, and the speed with it, of motors that are
    swung out: what little oil they swallow is no measure of how fast they turn."""
    shown = columns[f"{group}.displacement"]
    return np.where(np.abs(shown) > LEAST_STROKE * crane.max_displacement, shown, np.nan)


_ON_RUNS: dict[Action, Callable[[Columns, Run, Correction, Crane], Columns]] = {
    **dict.fromkeys((Action.OFFSET, Action.SCALE, Action.CURVATURE, Action.BEND, Action.S_SHAPE), _shown),
    Action.FILTER: _filter,
    Action.DELAY: _delay,
    Action.MASS: _mass,
    Action.WARMTH: _warmth,
    Action.HEAT: _heat,
    Action.SLIP: _slip,
    Action.AIR: _air,
}
