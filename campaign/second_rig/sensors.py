"""What the control system logs of a run: filtered, delayed, noisy and in steps."""

import numpy as np
from numpy.typing import NDArray

from campaign.second_rig.crane import BAR
from campaign.second_rig.hidden import Hidden, State
from campaign.second_rig.motion import STEP, Series, low_passed
from campaign.second_rig.plant import RETURN_OF_GAS

SPEED_WINDOW = 0.02  # s over which pulses are counted
HEAVE_NOISE = 0.0015  # m/s

Columns = dict[str, Series]


def logged(rng: np.random.Generator, run: State, hidden: Hidden) -> Columns:
    """SI columns under the names of docs/interfaces.md; time in Unix seconds, oil in degC."""
    style, voyage = run.voyage.logging, run.voyage
    steps = len(run.time)
    stride = int(round(1 / (style.rate * STEP)))
    first = int(rng.integers(0, stride))
    index = np.arange(first + int(0.1 / STEP), steps - 10, stride)
    angle = np.interp(run.time - hidden.speed_delay, run.time, run.angle) if hidden.speed_delay else run.angle
    counts = np.floor(angle * style.pulses / (2 * np.pi))
    window = int(round(SPEED_WINDOW / STEP))
    ahead = window // 2
    passed = counts[np.minimum(index + ahead, steps - 1)] - counts[index + ahead - window]
    columns: Columns = {"motor_speed": passed / SPEED_WINDOW * 2 * np.pi / style.pulses}
    celsius = np.round(run.celsius[index] + rng.normal(0, 0.05, len(index)), 1)
    for group in run.groups:
        columns |= _of_group(rng, run, hidden, group, index)
    weighed = run.weighed[index] * (1 + rng.normal(0, style.load_noise, len(index)))
    step = run.crane.rated / style.load_steps
    columns["hook_load"] = np.round(weighed / step) * step
    columns["oil_temperature"] = celsius
    columns["wire_layer"] = np.full(len(index), voyage.layer)
    if style.wire:
        columns["wire_out"] = np.round(run.wire_out[index], 2)
    if style.angle:
        columns["shaft_angle"] = np.floor(angle[index] * style.pulses / 2 / np.pi) / style.pulses * 2 * np.pi
    if style.reference:
        columns["speed_reference"] = run.reference[index]
    if voyage.at_sea:
        columns["heave_velocity"] = run.heave[index] + rng.normal(0, HEAVE_NOISE, len(index))
    return {"time": voyage.date + run.time[index] + rng.normal(0, style.time_noise, len(index))} | columns


def _of_group(rng: np.random.Generator, run: State, hidden: Hidden, group: str, index: NDArray[np.intp]) -> Columns:
    style = run.voyage.logging
    columns: Columns = {}
    low = run.boost if group != "passive" else np.full(len(run.time), RETURN_OF_GAS * BAR)
    drop = run.pressure[group] + run.turned_over * hidden.line_drop(run, group)
    sides = {"a": np.where(drop >= 0, low + drop, low), "b": np.where(drop >= 0, low, low - drop)}
    step = style.pressure_range * BAR / 4096
    for side, pressure in sides.items():
        read = hidden.read_pressure(run, group, side, low_passed(pressure, hidden.pressure_filter))[index]
        read = read + rng.normal(0, style.pressure_noise * BAR, len(index)) + run.voyage.zeros[group, side]
        columns[f"{group}.pressure_{side}"] = np.round(read / step) * step
    displacement = hidden.read_displacement(run, group, run.displacement[group])[index]
    step = run.crane.max_displacement / style.displacement_steps
    noise = 1 + rng.normal(0, style.displacement_noise, len(index))
    columns[f"{group}.displacement"] = np.round(displacement * noise / step) * step
    return columns
