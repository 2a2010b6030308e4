"""Friction of the winch that the seed model lacks, each effect under laws of its own; N m at the shaft at size 1."""

import numpy as np

from campaign.third_rig.hidden import Effect, State
from campaign.third_rig.motion import Series, stuck
from campaign.third_rig.plan import AHC, MAIN

MAXWELL = ((0.3, 0.4), (1.2, 0.35), (4.0, 0.25))  # rad to break away, share of the force


def _when_loaded(s: State) -> Series:
    """Torque with a part that does not need the load."""
    return s.torque * (0.3 + s.full)


def _viscosity_power(s: State) -> Series:
    return s.torque * s.fast * ((40 / s.run.celsius) ** 1.6 - 1)


def _viscosity_cold(s: State) -> Series:
    return s.torque * s.fast**0.9 * np.clip((36 - s.run.celsius) / 15, 0, None) ** 1.4


def _stribeck_sech(s: State) -> Series:
    return s.torque * s.full / np.cosh(np.minimum(s.speed / 22, 50))


def _maxwell(s: State) -> Series:
    sign = np.where(s.run.speed < 0, -1.0, 1.0)
    missing = np.zeros_like(s.run.speed)
    for breakaway, share in MAXWELL:
        missing += share * (stuck(s.run.speed, s.step, breakaway) * sign - 1)
    return _when_loaded(s) * missing


def _dwell(s: State) -> Series:
    return _when_loaded(s) * np.log1p(s.run.dwell / 2) * np.exp(-((s.run.travel / 15) ** 0.7))


def _wear_late(s: State) -> Series:
    return s.torque / (1 + np.exp(-(s.days - 40) / 4))


def _churning_cold(s: State) -> Series:
    return s.torque * s.fast**1.65 * np.exp(-(s.run.celsius - 40) / 60)


COLD_TO_WARM = {"celsius": (15, 55), "warming": 8}
STROKES = {"displacement_changes": 0.6}  # the displacement changes in more than half of the runs
STARTS = {"modes": (AHC, MAIN)}
SIXTY_DAYS = {"days": 60}

WINCH = {
    "visc_pow": Effect(
        ("viscosity_temperature",), "viscous torque x ((40/T)^1.6-1), T in degC", _viscosity_power, options=COLD_TO_WARM
    ),
    "visc_cold": Effect(
        ("viscosity_temperature",), "extra viscous torque only below 36 degC, ((36-T)/15)^1.4 x w^0.9", _viscosity_cold,
        options={"celsius": (14, 52), "warming": 8},
    ),
    "strib_hyp": Effect(
        ("stribeck",), "extra load-proportional rise 1/(1+w/9), T_d^0.8",
        lambda s: s.torque * s.full**0.8 / (1 + s.speed / 9),
    ),
    "strib_sech": Effect(
        ("stribeck",), "seed has no Stribeck term; truth sech(w/22) x T_d", _stribeck_sech, options={"stribeck": False}
    ),
    "presl_maxwell": Effect(
        ("presliding",), "three Maxwell slip elements, breaking away at 0.3, 1.2 and 4 rad of shaft travel", _maxwell,
        rare=True, options=STARTS | {"rate": 100},
    ),
    "presl_pow": Effect(
        ("presliding",), "hysteresis 1-(1+x/0.8)^-2 of the travel x since reversal, missing part of Coulomb",
        lambda s: -_when_loaded(s) * (1 + s.run.travel / 0.8) ** -2.0,
        rare=True, options=STARTS | {"rate": 50, "pulses": 0},
    ),
    "dwell_log": Effect(
        ("dwell_stiction",), "ln(1+dwell/2 s) x exp(-(x/15 rad)^0.7) of the travel since start", _dwell,
        rare=True, options={"modes": (MAIN,), "rate": 100},
    ),
    "gearasy_hoist": Effect(
        ("gear_asymmetry",), "T_d^1.3, hoisting only",
        one_way=lambda s: s.torque * s.full**1.3 * (s.run.speed > 0),
    ),
    "gearasy_lower": Effect(
        ("gear_asymmetry",), "tanh(T_d/0.4), lowering only",
        one_way=lambda s: -s.torque * np.tanh(s.full / 0.4) * (s.run.speed < 0),
    ),
    "gearload_tanh": Effect(
        ("gear_load_loss", "sheave_bending"), "saturating: tanh(T_d/0.35)", lambda s: s.torque * np.tanh(s.full / 0.35),
        options=STROKES,
    ),
    "gearload_thr": Effect(
        ("gear_load_loss", "sheave_bending"), "only above 45 % load: (T_d-0.45)+",
        lambda s: s.torque * np.clip(s.full - 0.45, 0, None), options=STROKES,
    ),
    "sheave_capst": Effect(
        ("sheave_bending", "gear_load_loss"), "capstan: T^0.85 with a bearing part a/(1+w/150)",
        lambda s: s.torque * s.full**0.85 * (0.7 + 0.3 / (1 + s.speed / 150)), options=STROKES,
    ),
    "wear_runin": Effect(
        ("wear_drift",), "run-in, -(t/t1)^0.35 over 60 days",
        lambda s: -s.torque * ((s.days + 0.01) / 60) ** 0.35, options=SIXTY_DAYS,
    ),
    "wear_late": Effect(
        ("wear_drift",), "sigmoid wear-out centred on day 40, width 4 d", _wear_late, options=SIXTY_DAYS
    ),
    "churn_thr": Effect(
        ("churning",), "((w-40)+)^1.5, any stroke",
        lambda s: s.torque * (np.clip(s.speed - 40, 0, None) / 160) ** 1.5, options=STROKES,
    ),
    "churn_cold": Effect(
        ("churning",), "w^1.65 exp(-(T-40)/60)", _churning_cold, options=STROKES | {"celsius": (18, 52)}
    ),
    "brake_some": Effect(
        ("brake_drag", "coulomb"), "brake hangs in some runs only",
        lambda s: s.torque * s.run.marked * np.ones_like(s.run.speed),
    ),
    "brake_speed": Effect(
        ("brake_drag", "coulomb"), "brake drags in some runs, less at speed: 1/(1+w/400)",
        lambda s: s.torque * s.run.marked / (1 + s.speed / 400),
    ),
}  # fmt: skip
