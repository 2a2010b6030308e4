"""The 64 data sets: what is hidden in each, which names are right, how it is logged."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any
from zlib import crc32

from campaign.second_rig import laws, readings
from campaign.second_rig.laws import Law, null, two
from campaign.second_rig.voyages import Logging, Options

NULL, EFFECT, OUTSIDE, PAIR, LOAD_CELL = "null", "effect", "outside", "pair", "load_cell"
ANY_OIL = (14.0, 56.0)  # degC
STRETCHING = {"stiff": False, "damping": 0.15}


@dataclass(frozen=True)
class Set:
    """One data set; `causes` are the sets of names of which each must be found, empty if nothing may be named."""

    key: str
    kind: str
    law: Law
    causes: tuple[frozenset[str], ...] = ()
    options: Options = field(default_factory=Options)

    def seed(self, draw: int) -> int:
        """Of the crane, the voyages and the noise; another `draw` is another winch."""
        return crc32(self.key.encode()) % 100000 + draw


def _set(
    key: str, kind: str, law: Law, causes: str, grouping: str, rate: float, *,
    celsius: tuple[float, float] = (38.0, 44.0), runs: int = 12, boost: Callable[[int], float] | None = None,
    rope: dict[str, Any] | None = None, **logging: Any,
) -> Set:  # fmt: skip
    """`causes` such as "wear_drift" or "sheave_bending|gear_load_loss tare_load"; `logging` as `Logging` names it."""
    wanted = tuple(frozenset(cause.split("|")) for cause in causes.split())
    options = Options(grouping, runs, celsius, Logging(rate=rate, **logging), rope or {}, boost)
    return Set(key, kind, law, wanted, options)


def _boost(number: int) -> float:
    """Bar: four levels in turn."""
    return (20.0, 25.0, 32.0, 45.0)[number % 4]


_NULLS = (
    _set("null_01", NULL, null, "", "main", 50),
    _set("null_02", NULL, null, "", "both", 20, units=1),
    _set("null_03", NULL, null, "", "split", 100, units=2, separator=";"),
    _set("null_04", NULL, null, "", "main", 10, units=3, gaps=2, blanks=6),
    _set("null_05", NULL, null, "", "both", 200, pressure_noise=0.4),
    _set("null_06", NULL, null, "", "split", 50, units=1, gaps=3, pressure_noise=0.5, pressure_range=400),
    _set("null_07", NULL, null, "", "main", 20, units=2, runs=10, wire=False),
    _set("null_08", NULL, null, "", "both", 100, units=3, angle=True, reference=True, separator="\t"),
    _set("null_09e", NULL, null, "", "main", 50, rope=STRETCHING),
    _set("null_10e", NULL, null, "", "split", 20, units=2, rope=STRETCHING),
    _set("null_11e0", NULL, null, "", "main", 50, rope=STRETCHING | {"above": 0.0}),
    _set("null_12e0", NULL, null, "", "split", 20, units=2, rope={"stiff": False, "damping": 0.08, "above": 0.0}),
    _set("null_13ww", NULL, null, "", "main", 50, rope={"wire_weighs": True}),
)

_EFFECTS = (
    _set("wear_step", EFFECT, laws.wear_step, "wear_drift", "main", 20),
    _set("wear_sqrt", EFFECT, laws.wear_sqrt, "wear_drift", "both", 50, units=1),
    _set("visc_andrade", EFFECT, laws.viscosity_andrade, "viscosity_temperature", "both", 50, celsius=ANY_OIL),
    _set("visc_power", EFFECT, laws.viscosity_power, "viscosity_temperature", "main", 100, celsius=ANY_OIL, units=2),
    _set("visc_gear", EFFECT, laws.viscosity_gear_oil, "viscosity_temperature", "split", 20, celsius=ANY_OIL),
    _set("feedback_s", EFFECT, readings.feedback_bent, "swivel_offset", "main", 50),
    _set("feedback_off", EFFECT, readings.feedback_offset, "swivel_offset", "both", 20, units=1),
    _set("brake_some", EFFECT, laws.brake_on_some, "brake_drag", "main", 20, units=3),
    _set("brake_all", EFFECT, laws.brake_on_all, "brake_drag|coulomb|motor_coulomb", "both", 100),
    _set("drift_temp", EFFECT, readings.zero_warm, "pressure_offset", "main", 50, celsius=ANY_OIL),
    _set("zero_const", EFFECT, readings.zero_constant, "pressure_offset", "both", 20),
    _set("zero_step", EFFECT, readings.zero_step, "pressure_offset", "main", 100, units=1),
    _set("gain", EFFECT, readings.pressure_gain, "pressure_scale", "both", 50),
    _set("sheave", EFFECT, laws.sheave_load, "sheave_bending|gear_load_loss", "main", 20),
    _set("sheave_speed", EFFECT, laws.sheave_speed, "sheave_bending|gear_load_loss", "both", 50, units=2),
    _set("case_seal", EFFECT, laws.case_seal, "case_pressure", "both", 50, boost=_boost),
    _set("filter_clog", EFFECT, readings.filter_clogged, "line_pressure_drop", "both", 50),
    _set("check_valve", EFFECT, readings.check_valve, "line_pressure_drop", "main", 20),
    _set("churn", EFFECT, laws.churning_power, "churning", "main", 50),
    _set("churn_step", EFFECT, laws.churning_onset, "churning", "both", 100),
    _set("lag_filter", EFFECT, readings.slow_transducers, "signal_delay", "main", 50),
    _set("lag_speed", EFFECT, readings.late_speed, "signal_delay", "split", 50),
    _set("tare", EFFECT, readings.tare, "tare_load", "main", 20),
    _set("tare_wire", EFFECT, readings.tare_wire, "tare_load", "both", 50),
    _set("radius_wrong", EFFECT, readings.radius_of_layer, "layer_radius", "main", 50, units=1),
    _set("radius_sink", EFFECT, readings.radius_sinks, "layer_radius", "both", 20),
    _set("stribeck_sqrt", EFFECT, laws.stribeck_root, "stribeck", "main", 50),
    _set("stribeck_slow", EFFECT, laws.stribeck_slow, "stribeck", "both", 100, units=1),
    _set("iwan", EFFECT, laws.presliding_iwan, "presliding", "main", 100),
    _set("dwell_log", EFFECT, laws.dwell_log, "dwell_stiction", "main", 50),
    _set("gear_up", EFFECT, laws.gear_hoisting, "gear_asymmetry", "both", 20),
    _set("low_d", EFFECT, laws.low_displacement, "low_displacement_loss", "both", 50),
    _set("turb", EFFECT, laws.turbulence, "port_turbulence", "both", 20),
    _set("high_p", EFFECT, laws.high_pressure, "high_pressure_mixed", "main", 50),
    _set("notch", EFFECT, laws.port_notch, "notch_loss", "both", 50),
    _set("inertia", EFFECT, laws.inertia, "inertia_error", "main", 50),
    _set("ripple", EFFECT, laws.ripple, "torque_ripple", "main", 50, angle=True),
    _set("ripple_tri", EFFECT, laws.ripple_triangle, "torque_ripple", "both", 100, angle=True),
)

# a load cell's gain cannot be told from these
_LIKE_A_LOAD_CELL = "layer_radius|pressure_scale|tare_load|swivel_offset|gear_asymmetry"

_OTHERS = (
    _set("loadcell", LOAD_CELL, readings.load_cell_gain, _LIKE_A_LOAD_CELL, "main", 20),
    _set("out_hydro", OUTSIDE, readings.water_drag, "", "main", 50),
    _set("out_levelwind", OUTSIDE, readings.level_wind, "", "both", 20),
    _set("out_warm", OUTSIDE, readings.cold_grease, "", "main", 50),
    _set("out_accel", OUTSIDE, readings.speeding_up, "", "main", 100),
    _set("out_sector", OUTSIDE, readings.worn_sector, "", "both", 50, angle=True),
    _set("out_flange", OUTSIDE, readings.flange_far_out, "", "main", 20),
)

_WEAR_TARE = two(laws.wear_step, readings.tare)
_OIL_BRAKE = two(laws.viscosity_andrade, laws.brake_on_some)
_STRIBECK_ZERO = two(laws.stribeck_slow, readings.zero_constant)
_LATE_RADIUS = two(readings.late_speed, readings.radius_of_layer)
_TURBULENCE_SHEAVE = two(laws.turbulence, laws.sheave_load)
_TURBULENCE_SHEAVE_NAMES = "port_turbulence sheave_bending|gear_load_loss"

_PAIRS = (
    _set("two_wear_tare", PAIR, _WEAR_TARE, "wear_drift tare_load", "main", 20),
    _set("two_visc_brake", PAIR, _OIL_BRAKE, "viscosity_temperature brake_drag", "both", 50, celsius=ANY_OIL),
    _set("two_strib_zero", PAIR, _STRIBECK_ZERO, "stribeck pressure_offset", "main", 50),
    _set("two_lag_radius", PAIR, _LATE_RADIUS, "signal_delay layer_radius", "main", 50),
    _set("two_turb_sheave", PAIR, _TURBULENCE_SHEAVE, _TURBULENCE_SHEAVE_NAMES, "both", 20),
    _set("two_lowd_tare", PAIR, two(laws.low_displacement, readings.tare), "low_displacement_loss tare_load",
         "both", 50),
)  # fmt: skip

SETS = {each.key: each for each in (*_NULLS, *_EFFECTS, *_OTHERS, *_PAIRS)}
