"""What a winch's sensor can say at all: a number beyond these limits is a broken sensor, not a measurement.

The limits are wide, several times what any winch does: they keep out what a bus fault, an overflow, a wrong unit make.
"""

# channel -> smallest and largest value, SI; shaft_angle and time have none
LIMITS = {
    "motor_speed": (-3.0e3, 3.0e3),  # rad/s, 29 000 rpm
    "speed_reference": (-3.0e3, 3.0e3),
    "motor_torque": (-1.0e6, 1.0e6),
    "hook_load": (-1.0e5, 1.0e7),  # an empty hook's load cell may read a little below zero
    "heave_velocity": (-50.0, 50.0),
    "oil_temperature": (-60.0, 250.0),
    "wire_layer": (0.0, 100.0),
    "wire_out": (-1.0e3, 3.0e4),
    "pressure_a": (-1.0e7, 2.0e8),  # 2000 bar; gauges drift below zero
    "pressure_b": (-1.0e7, 2.0e8),
    "displacement": (-1.0e-3, 1.0e-3),  # m^3/rad, 6300 cm^3/rev
}
_UNBOUNDED = (-1.0e300, 1.0e300)


def plausible(channel: str, value: float) -> bool:
    """Whether a value of this channel (a run's column or its short name) is a number that a sensor can mean."""
    lower, upper = LIMITS.get(channel.rpartition(".")[2], _UNBOUNDED)
    return lower <= value <= upper  # false for NaN too
