"""Torques on the motor shaft of the effects that are friction, in one compiled function."""

import math

import numpy as np

from winch_friction.simulation.compiling import compiled

_DENSITY = 870.0  # kg/m^3
_NOTCH_SPEED = 42.0  # rad/s, edge of the suppliers' data (400 rpm)
_RATED_SPEED = 209.0  # rad/s, 2000 rpm
_RATED_DISPLACEMENT = 3.42e-5  # m^3/rad, 215 cm^3/rev

# name -> unit; zero means absent
HIDDEN_FIELDS = {
    "present": "1, any of the below",
    "stribeck_share": "1, of the drum torque, per motor",
    "stribeck_torque": "N m per motor",
    "stribeck_speed": "rad/s",
    "dwell_share": "1, of the friction at full dwell",
    "dwell_rate": "1/s",
    "dwell_angle": "rad of slip that breaks the bond",
    "gear_asymmetry": "1, of T_d/i, hoisting less lowering",
    "gear_loss": "1, of T_d/i",
    "sheave_loss": "1, of the wire's tension",
    "wear_rate": "N m/s per motor since wear_epoch",
    "wear_epoch": "s, Unix",
    "low_displacement": "m^3 per motor",
    "turbulence": "N m per motor at 2000 rpm and 215 cm^3/rev",
    "turbulence_exponent": "1",
    "notch": "N m per (Pa^1.5 m^1.5/kg^0.5 s/rad) per motor",
    "churning": "N m per motor at 2000 rpm",
    "churning_exponent": "1",
    "mixed": "m^5/N per motor",
    "case": "m^3 per motor",
    "ripple_share": "1, of T_d/i",
    "ripple_order": "1, per motor revolution",
    "brake": "N m per motor",
}
HIDDEN = np.dtype([(name, np.float64) for name in HIDDEN_FIELDS])


@compiled
def group_loss(hidden, count, pressure, pressure_sum, displacement, max_displacement, w):
    """Losses of one motor group against its motion, N m."""
    per_motor = hidden.low_displacement * pressure * (1.0 - displacement / max_displacement)
    per_motor += hidden.mixed * pressure * pressure + hidden.case * pressure_sum
    if hidden.turbulence != 0.0:
        speed = (w / _RATED_SPEED) ** hidden.turbulence_exponent
        per_motor += (
            hidden.turbulence * speed * (displacement / _RATED_DISPLACEMENT) ** (hidden.turbulence_exponent + 1.0)
        )
    if hidden.churning != 0.0:
        per_motor += hidden.churning * (w / _RATED_SPEED) ** hidden.churning_exponent
    if hidden.notch != 0.0:
        flow = pressure * math.sqrt(pressure / _DENSITY) * w / (w * w + _NOTCH_SPEED * _NOTCH_SPEED)
        per_motor += hidden.notch * displacement / max_displacement * flow
    return count * per_motor


@compiled
def shaft_loss(hidden, motors, w, drum_torque, gear_ratio, tension_torque, time):
    """Losses of the shaft, gear and rope against the motion, N m."""
    stribeck = 0.0
    if hidden.stribeck_speed > 0.0:
        level = hidden.stribeck_share * drum_torque + hidden.stribeck_torque
        stribeck = motors * level * math.exp(-w / hidden.stribeck_speed)
    wear = motors * hidden.wear_rate * max(time - hidden.wear_epoch, 0.0)
    gear = hidden.gear_loss * drum_torque / gear_ratio + hidden.sheave_loss * tension_torque
    return stribeck + wear + gear + motors * hidden.brake


@compiled
def fixed_torque(hidden, direction, angle, drum_torque, gear_ratio):
    """Torque that does not simply oppose the motion, N m against hoisting."""
    half = 0.5 * hidden.gear_asymmetry * direction * direction
    ripple = hidden.ripple_share * math.sin(hidden.ripple_order * angle)
    return (half + ripple) * drum_torque / gear_ratio
