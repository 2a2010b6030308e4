"""Losses of the motors and lines that the seed model lacks, each under laws of its own; N m at the shaft at size 1."""

from typing import Any

import numpy as np

from campaign.third_rig.crane import BAR
from campaign.third_rig.hidden import USUAL_PRESSURE, USUAL_SPEED, Channels, Effect, Pressed, State
from campaign.third_rig.motion import Series
from campaign.third_rig.plan import AHC, MAIN

LINE_DROP = 1e6  # Pa at size 1
USUAL_FLOW = 0.02  # m^3/s
LINE_AIR = 0.06  # m^3 of line, of motors of 2365 cm^3/rev
ATMOSPHERE = 1e5  # Pa
POLYTROPIC = 1.25

STROKES: dict[str, Any] = {"displacement_changes": 0.6}


def _low_displacement_power(s: State) -> Series:
    return s.of_motors(lambda g: g.pressure**0.7 * np.clip(1 - g.stroke, 0, 1) ** 2.3)


def _low_displacement_inverse(s: State) -> Series:
    return s.of_motors(lambda g: g.pressure * np.clip(1 / g.stroke - 1, 0, 1.5))


def _port(s: State) -> Series:
    return s.of_motors(lambda g: s.fast**2.7 * g.stroke**3.4)


def _port_lowering(s: State) -> Series:
    return s.of_motors(lambda g: s.fast**2 * g.stroke**3) * (s.run.speed < 0)


def _notch(s: State) -> Series:
    return s.of_motors(lambda g: g.pressure**1.3 * s.speed / 30 * np.exp(1 - s.speed / 30) * g.stroke)


def _case_port_b(s: State) -> Series:
    return s.of_motors(lambda g: np.clip(g.port_b / BAR - 10, 0, None) / 20)


def _case_root(s: State) -> Series:
    return s.of_motors(lambda g: np.sqrt((g.port_a + g.port_b) / USUAL_PRESSURE))


def _line_flow(s: State) -> Series:
    def of_group(g: Pressed) -> Series:
        swept = g.motors * g.displacement
        return np.sign(s.run.speed) * swept * (swept * s.speed / USUAL_FLOW) ** 1.6

    return LINE_DROP * sum((of_group(g) for g in s.groups.values()), np.zeros_like(s.run.speed))


def _line_check(s: State) -> Series:
    def of_group(g: Pressed) -> Series:
        beyond = np.clip(g.stroke * s.speed / USUAL_SPEED - 0.2, 0, None)
        return (s.run.speed > 0) * g.motors * g.displacement * beyond

    return LINE_DROP * sum((of_group(g) for g in s.groups.values()), np.zeros_like(s.run.speed))


def _slip(channels: Channels, s: State, size: float) -> None:
    """`size` in rad/s at 150 bar and full stroke."""
    lost = np.sign(s.lead.drop) * (np.abs(s.lead.drop) / (150 * BAR)) ** 1.4 / s.lead.stroke
    channels["speed_reference"] = channels["speed_reference"] + size * lost


def _air(channels: Channels, s: State, size: float) -> None:
    """`size` is the share of the line that is air at rest; half of the line at each port."""
    volume = LINE_AIR * s.crane.motors * s.crane.cm3_per_rev / 2365
    swept = s.lead.motors * s.lead.displacement
    given: Series | float = 0.0
    for sign, port in ((1, s.lead.port_a), (-1, s.lead.port_b)):
        bubble = (ATMOSPHERE / np.maximum(port + ATMOSPHERE, 2e4)) ** (1 / POLYTROPIC)
        given = given + sign * np.gradient(-size * volume * bubble, s.step) / 2
    channels["speed_reference"] = channels["speed_reference"] + given * 2 / swept


MOTORS = {
    "lowdisp_pow": Effect(
        ("low_displacement_loss",), "p^0.7 (1-D/X)^2.3", _low_displacement_power, options=STROKES
    ),
    "lowdisp_inv": Effect(
        ("low_displacement_loss",), "p (X/D-1), capped at 1.5", _low_displacement_inverse, options=STROKES
    ),
    "port_26": Effect(("port_turbulence",), "w^2.7 D^3.4", _port),
    "port_lower": Effect(
        ("port_turbulence", "line_pressure_drop"), "w^2 D^3, lowering only (one port)", _port_lowering
    ),
    "notch_ricker": Effect(("notch_loss",), "p^1.3 (w/30) exp(1-w/30) D", _notch),
    "hp_thr": Effect(
        ("high_pressure_mixed",), "((p-150 bar)+)^1.5",
        lambda s: s.of_motors(lambda g: np.clip(g.pressure - 0.75, 0, None) ** 1.5),
        options={"loads": (0.3, 0.5, 0.75, 0.95), "displacements": (0.5, 0.6, 0.8, 1.0)},
    ),
    "hp_32": Effect(
        ("high_pressure_mixed",), "p^3.3", lambda s: s.of_motors(lambda g: g.pressure**3.3),
        options={"displacements": (0.45, 0.6, 0.8, 1.0)},
    ),
    "case_b": Effect(
        ("case_pressure",), "with port B pressure alone, (pB-10 bar), boost stepped", _case_port_b,
        options={"boost_steps": 25, "boost": (12, 30)},
    ),
    "case_sqrt": Effect(
        ("case_pressure",), "square root of the sum of port pressures", _case_root,
        options={"boost_steps": 40, "boost": (12, 30)},
    ),
    "line_16": Effect(
        ("line_pressure_drop", "port_turbulence"), "flow^1.6 between transducer and motor", one_way=_line_flow,
        options={"modes": (MAIN, AHC)},
    ),
    "line_check": Effect(
        ("line_pressure_drop",), "hoisting only, beyond a cracking flow: (Q-0.2Qmax)+", one_way=_line_check
    ),
    "slip_pow": Effect(
        ("slip_leakage",), "speed lost ~ p^1.4, 9 rad/s at 150 bar and full stroke", sensed=_slip, first_size=9.0,
        fixed=True, options={"reference": True, "modes": (MAIN,)},
    ),
    "air_poly": Effect(
        ("entrained_air",), "free air 2.5 % of the line, polytropic 1.25", sensed=_air, first_size=0.025, fixed=True,
        options={"reference": True, "modes": (AHC,), "rate": 50, "pulses": 0, "boost": (14, 20)},
    ),
}  # fmt: skip
