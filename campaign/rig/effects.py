"""The 27 effects of docs/discrepancy.md at their typical sizes, and fifteen of the rig's own that no catalogue knows.

Each is a function (size, random, truth) -> strengths inside the plant; size 1 is the catalogue's typical size.
"""

from collections.abc import Callable

import numpy as np

from campaign.rig.truth import BAR, CM3_PER_REV, MAX_DISPLACEMENT, RPM, Friction

Strengths = dict[str, float]
Effect = Callable[[float, np.random.Generator, Friction], Strengths]


def _stribeck(s: float, rng: np.random.Generator, f: Friction) -> Strengths:
    return {"stribeck": s, "stribeck_speed": f.C4 * rng.uniform(0.6, 1.5)}


def _dwell(s: float, rng: np.random.Generator, f: Friction) -> Strengths:
    return {"dwell_gain": 0.2 * s, "dwell_angle": rng.uniform(0.5, 2.0), "dwell_rate": rng.uniform(0.2, 0.8)}


def _ripple(s: float, rng: np.random.Generator, f: Friction) -> Strengths:
    return {"ripple": 0.015 * s, "ripple_order": float(rng.choice([1.0, 0.2, 2.0, 1 / 6]))}


def _turbulence(s: float, rng: np.random.Generator, f: Friction) -> Strengths:
    return {"turbulence": 0.22 * s, "turbulence_exponent": rng.uniform(1.7, 2.3)}


def _churning(s: float, rng: np.random.Generator, f: Friction) -> Strengths:
    return {"churning": 4.0 * s, "churning_exponent": rng.uniform(1.8, 2.0)}


CATALOGUE: dict[str, Effect] = {
    "viscosity_temperature": lambda s, rng, f: {"viscosity": s},
    "stribeck": _stribeck,
    "presliding": lambda s, rng, f: {"presliding_angle": np.radians(5.0 * s)},
    "dwell_stiction": _dwell,
    "gear_asymmetry": lambda s, rng, f: {"asymmetry": 0.01 * s},
    "gear_load_loss": lambda s, rng, f: {"load_loss": 0.045 * s},
    "layer_radius": lambda s, rng, f: {"radius_step": -0.06 * s},
    "sheave_bending": lambda s, rng, f: {"sheave": 0.03 * s},
    "wear_drift": lambda s, rng, f: {"coulomb_drift": 0.3 * s},
    "low_displacement_loss": lambda s, rng, f: {"low_displacement": 100 / 11 / (135 * BAR * (1 - 145 / 215)) * s},
    "port_turbulence": _turbulence,
    "notch_loss": lambda s, rng, f: {"notch": 5.0 * s},
    "churning": _churning,
    "high_pressure_mixed": lambda s, rng, f: {"mixed": 14.0 / (350 * BAR) ** 2 * s},
    "slip_leakage": lambda s, rng, f: {"leakage": 50 * RPM * 11 * MAX_DISPLACEMENT / (150 * BAR) * s},
    "line_pressure_drop": lambda s, rng, f: {"line_drop": 4 * BAR / (1.29 / 60) ** 2 * s},
    "case_pressure": lambda s, rng, f: {"case": 5 * BAR * MAX_DISPLACEMENT / (150 * BAR) * s},
    "accumulator_thermal": lambda s, rng, f: {"gas_time": rng.uniform(40, 120), "gas_warm": 0.022 * s},
    "inertia_error": lambda s, rng, f: {"inertia": 0.27 * s},
    "pressure_offset": lambda s, rng, f: {"pressure_offset": 1.5 * BAR * s},
    "pressure_scale": lambda s, rng, f: {"pressure_scale": 0.005 * s},
    "signal_delay": lambda s, rng, f: {"delay": 0.05 * s},
    "swivel_offset": lambda s, rng, f: {"swivel": 1.0 * CM3_PER_REV * s},
    "entrained_air": lambda s, rng, f: {"air": 0.01 * s},
    "torque_ripple": _ripple,
    "brake_drag": lambda s, rng, f: {"brake": 4.0 * s},
    "tare_load": lambda s, rng, f: {"tare": 2000.0 * s},
}

OUTSIDE: dict[str, Effect] = {
    "wire_out_drag": lambda s, rng, f: {"wire_drag": 12.0 * s},
    "seal_grip_temperature": lambda s, rng, f: {"seal_grip": 50.0 * s},
    "drum_sector_drag": lambda s, rng, f: {"sector": 80.0 * s},
    "warm_in_during_run": lambda s, rng, f: {"run_drift": 90.0 * s},
    "pressure_memory": lambda s, rng, f: {"pressure_memory": 45.0 * s},
    "root_speed": lambda s, rng, f: {"root_speed": 80.0 * s},
    "speed_bump": lambda s, rng, f: {"speed_bump": 80.0 * s},
    "acceleration_loss": lambda s, rng, f: {"jerkiness": 20.0 * s},
    "layer_scrub": lambda s, rng, f: {"layer_scrub": 50.0 * s},
    "power_loss": lambda s, rng, f: {"power_loss": 130.0 * s},
    "cold_load_grip": lambda s, rng, f: {"cold_load": 90.0 * s},
    "groove_drag": lambda s, rng, f: {"groove": 90.0 * s},
    "fast_step": lambda s, rng, f: {"fast_step": 70.0 * s},
    "swash_step": lambda s, rng, f: {"swash_step": 80.0 * s},
    "speed_memory": lambda s, rng, f: {"speed_memory": 90.0 * s},
}

_LOAD = ("main.pressure", "active.pressure", "passive.pressure", "hook_load", "drum_torque")
# the channel that a right answer puts first, or any of these
OUTSIDE_SIGNAL: dict[str, tuple[str, ...]] = {
    "wire_out_drag": ("wire_out",),
    "seal_grip_temperature": ("oil_temperature",),
    "drum_sector_drag": ("shaft_angle", "wire_out"),
    "warm_in_during_run": ("time", "run_time"),
    "pressure_memory": _LOAD,
    "root_speed": ("motor_speed", "speed"),
    "speed_bump": ("motor_speed", "speed"),
    "acceleration_loss": ("acceleration",),
    "layer_scrub": ("wire_layer",),
    "power_loss": (*_LOAD, "motor_speed", "speed"),
    "cold_load_grip": (*_LOAD, "oil_temperature"),
    "groove_drag": ("wire_out", "shaft_angle"),
    "fast_step": ("motor_speed", "speed"),
    "swash_step": ("main.displacement", "active.displacement"),
    "speed_memory": ("motor_speed", "speed"),
}

# what a data set must have for the effect to leave any trace in it
NEEDS_CHANNEL: dict[str, str] = {
    "slip_leakage": "speed_reference",
    "entrained_air": "speed_reference",
    "layer_radius": "several_layers",
    "layer_scrub": "several_layers",
    "accumulator_thermal": "gas_is_calculated",
    "wear_drift": "weeks",
}
