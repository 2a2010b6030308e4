"""What a crane's log can hold: the usual size of each channel, so that a unit can be told from numbers."""

import numpy as np

from winch_friction.commissioning.channels import OIL
from winch_friction.physics.channels import FASTEST_ROPE, GRAVITY, limits_of
from winch_friction.physics.signals import FloatArray
from winch_friction.physics.winch.crane import Crane

_PRESSURE = (5.0e5, 6.0e7)  # Pa: above the boost of an idle line, below a burst hose
_HYDRAULIC_SPEED = (1.0, 500.0)  # rad/s: a winch hardly moving, an axial piston motor at 4800 rpm
_LIGHTEST = 1e-3  # of what a drive's torque limit holds: less is no load that a person would log
_HIGHEST_PRESSURE = 4.5e7  # Pa, of the largest motors; what a crane's load is bounded by


def usual_size(channel: str, crane: Crane | None) -> tuple[float, float]:
    """Between what the 95th percentile of a channel's magnitude lies, SI."""
    top = limits_of(channel)[1]
    table = {
        "pressure_a": _PRESSURE,
        "pressure_b": _PRESSURE,
        "hook_load": (100.0, 2.0e6),
        "heave_velocity": (0.005, 8.0),
        "rope_speed": (0.01, 40.0),
        "wire_out": (0.0, 1.5e4),
        "wire_layer": (1.0, 40.0),
        "oil_temperature": (0.0, OIL[1]),
        "motor_speed": (0.0, top),
        "speed_reference": (0.0, top),
        "rope_force": (10.0, 2.0e7),
        "mechanical_power": (0.0, 5.0e6),
        "motor_torque": (0.0, 1.0e6),
    }
    if crane is None:
        return table.get(channel, (0.0, top))
    if channel in ("motor_speed", "speed_reference") and crane.drive.hydraulic:
        fastest = FASTEST_ROPE * crane.gear_ratio / crane.drum.layer_radii[0]
        return _HYDRAULIC_SPEED[0], min(_HYDRAULIC_SPEED[1], fastest)
    if channel == "displacement":
        return 0.02 * crane.max_displacement, 1.15 * crane.max_displacement
    if channel == "drum_speed":
        return 0.0, FASTEST_ROPE / crane.drum.layer_radii[0]
    if channel == "wire_layer":
        return 1.0, float(len(crane.drum.layer_radii))
    if channel == "hook_load" and crane.drive.hydraulic:
        return 100.0, 1.2 * largest_load(crane)
    if channel == "hook_load" and np.isfinite(most := most_held(crane)):
        return _LIGHTEST * most, 1.2 * most
    return table.get(channel, (0.0, top))


def largest_load(crane: Crane) -> float:
    """The load in kg that the largest set of motors holds at full displacement and the highest pressure."""
    motors = max((*crane.groups.values(), sum(crane.groups.values()) / 2.0))
    torque = motors * crane.max_displacement * _HIGHEST_PRESSURE
    return torque * crane.gear_ratio / (crane.drum.layer_radii[0] * GRAVITY)


def most_held(crane: Crane) -> float:
    """The load in kg that the crane's file allows: by its motors where it is hydraulic, else the rated one. Without one
    by the torque limit, which bounds the feedforward and may be far less than the drive gives."""
    if crane.drive.hydraulic and crane.groups:
        return largest_load(crane)
    if crane.rated_load:
        return float(crane.rated_load)
    return float(crane.absolute_torque_limit) * crane.gear_ratio / (crane.drum.layer_radii[0] * GRAVITY)


def fits(channel: str, values: FloatArray, crane: Crane | None) -> bool:
    """Whether the values of a channel in SI have a size that a log of this crane can have."""
    finite = np.abs(values[np.isfinite(values)])
    if not finite.size:
        return False
    lower, upper = usual_size(channel, crane)
    size = float(np.percentile(finite, 95.0))
    return lower <= size <= upper or (size == 0.0 and lower == 0.0)
