"""What the control system logs of a run: late, noisy and in steps, under the names of docs/interfaces.md."""

import numpy as np
from numpy.typing import NDArray

from campaign.third_rig.crane import BAR, CM3_PER_REV
from campaign.third_rig.hidden import Channels
from campaign.third_rig.motion import Series
from campaign.third_rig.plan import AHC, Plan
from campaign.third_rig.runs import Run
from campaign.third_rig.sizing import PRESSURE_STEP

JITTER = 0.03  # of a period
RPM = np.pi / 30  # rad/s
LOAD_NOISE = 2e-4  # of the load
HEAVE_NOISE = 0.002  # m/s
OIL_NOISE = 0.05  # K
DISPLACEMENT_NOISE = 0.02  # cm^3/rev

Columns = dict[str, NDArray[np.float64] | NDArray[np.int64]]


def logged(plan: Plan, run: Run, channels: Channels, rng: np.random.Generator) -> Columns:
    """Columns by their header with unit."""
    options = plan.options
    ticks = np.arange(1, int(run.time[-1] * options.rate)) / options.rate
    ticks = ticks + rng.uniform(-1, 1, len(ticks)) * JITTER / options.rate
    ticks = np.clip(ticks, 0, run.time[-1])
    columns: Columns = {"time [s]": np.round(ticks + run.started, 5)} | _speed(plan, run, channels, ticks, rng)
    for group in run.groups:
        columns |= _of_group(plan, run, channels, group, ticks, rng)
    if run.mode == AHC:
        heave = _at(run, channels["heave_velocity"], ticks) + rng.normal(0, HEAVE_NOISE, len(ticks))
        columns["heave_velocity [m/s]"] = np.round(heave, 4)
    load = _at(run, channels["hook_load"], ticks) * (1 + rng.normal(0, LOAD_NOISE, len(ticks)))
    columns["hook_load [t]"] = np.round(load / 1e3, 3)
    oil = _at(run, channels["oil_temperature"], ticks) + rng.normal(0, OIL_NOISE, len(ticks))
    columns["oil_temperature [degC]"] = np.round(oil, 1)
    columns["wire_layer"] = np.full(len(ticks), run.layer)
    columns["wire_out [m]"] = np.round(_at(run, channels["wire_out"], ticks), 2)
    columns["shaft_angle [rad]"] = np.round(_at(run, channels["shaft_angle"], ticks), 4)
    if options.reference:
        columns["speed_reference [rpm]"] = np.round(_at(run, channels["speed_reference"], ticks) / RPM, 2)
    return columns


def _at(run: Run, signal: Series, times: Series, lag: float = 0.0) -> Series:
    return np.interp(times - lag, run.time, signal)


def _speed(plan: Plan, run: Run, channels: Channels, ticks: Series, rng: np.random.Generator) -> Columns:
    options = plan.options
    if options.pulses:
        speed = _counted(run, np.cumsum(channels["motor_speed"]) * plan.step, ticks, options.pulses, options.rate)
    else:
        speed = _at(run, channels["motor_speed"], ticks) + rng.normal(0, options.speed_noise, len(ticks))
    if options.rpm:
        return {"motor_speed [rpm]": np.round(speed / RPM, 3)}
    return {"motor_speed [rad/s]": np.round(speed, 4)}


def _counted(run: Run, angle: Series, ticks: Series, pulses: int, rate: float) -> Series:
    """Speed that an encoder's counts give over the last period, rad/s."""
    pulse = 2 * np.pi / pulses
    periods = np.diff(np.r_[ticks[0] - 1 / rate, ticks])
    now, before = (np.floor(_at(run, angle, times) / pulse) * pulse for times in (ticks, ticks - periods))
    return (now - before) / periods


def _of_group(plan: Plan, run: Run, channels: Channels, group: str, ticks: Series, rng: np.random.Generator) -> Columns:
    options = plan.options
    columns: Columns = {}
    for side in "ab":
        pressure = _at(run, channels[f"{group}.pressure_{side}"], ticks, options.pressure_lag)
        if not (options.calculated and group == "passive"):
            step = PRESSURE_STEP * BAR
            pressure = pressure + rng.normal(0, options.pressure_noise * BAR, len(ticks))
            pressure = np.round(pressure / step) * step
        columns[f"{group}.pressure_{side} [bar]"] = np.round(pressure / BAR, 4)
    displacement = _at(run, channels[f"{group}.displacement"], ticks) / CM3_PER_REV
    noise = rng.normal(0, DISPLACEMENT_NOISE, len(ticks))
    columns[f"{group}.displacement [cm^3/rev]"] = np.round(displacement + noise, 3)
    return columns
