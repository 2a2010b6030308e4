"""Effects that no catalogue has: nothing may be named for them; N m at the shaft at size 1."""

import numpy as np

from campaign.third_rig.hidden import Effect, State
from campaign.third_rig.motion import Series, smooth
from campaign.third_rig.plan import AHC, MAIN

WORK = 1500.0  # rad of the shaft that warm the seals


def _acceleration(s: State) -> Series:
    return s.torque * np.abs(s.run.acceleration) / 60


def _reversal(s: State) -> Series:
    return s.torque * np.exp(-s.run.since_reversal / 9)


def _heave(s: State) -> Series:
    return s.torque * (np.tanh(s.run.heave_acceleration / 0.15) > 0.3)


def _pressure_rate(s: State) -> Series:
    """Of the passive motors, in MPa/s."""
    rate = np.abs(np.gradient(s.groups["passive"].drop, s.step))
    return s.torque * smooth(rate, max(3, int(0.5 / s.step))) / 1e6


def _flat_sheave(s: State) -> Series:
    return s.torque * s.full * np.clip(np.sin(2 * np.pi * s.run.wire_out / 2.3), 0, None)


def _guide(s: State) -> Series:
    return s.torque * (s.run.wire_out / 200) ** 1.6


def _warming_seals(s: State) -> Series:
    return s.torque * np.exp(-np.cumsum(s.speed) * s.step / WORK)


def _hump(s: State) -> Series:
    return s.torque * np.exp(-(((s.speed - 110) / 15) ** 2))


OUTSIDE_LAWS = {
    "x_accel": Effect(
        (), "friction grows with |acceleration|", _acceleration,
        options={"modes": (MAIN, AHC), "rate": 100, "pulses": 0},
    ),
    "x_trev": Effect(
        (), "friction after a reversal decays slowly in time, exp(-t/9 s)", _reversal, options={"modes": (MAIN,)}
    ),
    "x_heave": Effect(
        (), "torque with the sign of the tip's acceleration (upward only)", one_way=_heave, options={"modes": (AHC,)}
    ),
    "x_prate": Effect(
        (), "friction with |dp/dt| of the passive motors, filtered over 0.5 s", _pressure_rate,
        options={"modes": (AHC,), "rate": 50},
    ),
    "x_sheave": Effect(
        (), "sheave flat: friction periodic in wire out, 2.3 m, half wave", _flat_sheave, options={"modes": (MAIN,)}
    ),
    "x_wire": Effect(
        (), "friction in a guide with wire out, (L/200)^1.6", _guide, options={"wire_out": (30, 400)}
    ),
    "x_heat": Effect(
        (), "friction falls as the run heats its seals: exp(-work since start)", _warming_seals,
        options={"modes": (MAIN,)},
    ),
    "x_hump": Effect((), "hump of friction at 110 rad/s, width 15 (a guide resonates)", _hump),
}  # fmt: skip
