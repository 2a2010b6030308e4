"""What the plant carries: the places of its states, of what drives it, and the record of each control period."""

import numpy as np

STATES = (
    "shaft_angle",  # rad
    "shaft_speed",  # rad/s
    "tip",  # m, crane tip above its mean, up positive
    "load",  # m, load above where it started
    "load_speed",  # m/s
    "pressure_a",  # Pa, driven group
    "pressure_b",  # Pa
    "drive",  # m^3/s of the pump (primary) or N m of the driven group (secondary)
    "drive_rate",  # its derivative, second-order pump
    "gas_volume",  # m^3
    "gas_temperature",  # relative to the wall
    "energy_in",  # J, from pumps, boost and make-up
    "energy_heave",  # J, from the crane tip
    "energy_friction",  # J, taken by friction
    "energy_lost",  # J, taken by leakage, valves, lines, wire damping, heat and water
)
ANGLE, SPEED, TIP, LOAD, LOAD_SPEED, P_A, P_B, DRIVE, DRIVE_RATE, GAS_V, GAS_T, E_IN, E_HEAVE, E_FRICTION, E_LOST = (
    range(len(STATES))
)

# memory that is updated exactly between the steps of the integrator
DIRECTION, DWELL = range(2)

# what each control period records, SI; one record per tick
COLUMNS = (
    "time",
    "shaft_angle",
    "motor_speed",
    "acceleration",
    "pressure_a",
    "pressure_b",
    "displacement",
    "passive_pressure_a",
    "passive_pressure_b",
    "passive_displacement",
    "friction_torque",
    "position_error",
    "heave",
    "heave_velocity",
    "speed_reference",
    "command",
    "drum_torque",
    "hook_load",
    "wire_out",
    "oil_temperature",
    "tension",
    "direction",
    "friction_feedforward",
    "energy_in",
    "energy_heave",
    "energy_friction",
    "energy_lost",
    "energy_stored",
    "passive_reported",
)
ROW = np.dtype([(name, np.float64) for name in COLUMNS])

# places in what a period is given: what the controller reads, how it reads, what is switched, what is prescribed
READ_ANGLE, READ_SPEED, READ_DROP, READ_PASSIVE = range(4)
ENCODER_STEP, PRESSURE_NOISE, PERIOD = range(3)
SET_DISPLACEMENT, COUNTED_DISPLACEMENT, SET_BOOST = range(3)
WANTED_ANGLE, WANTED_SPEED, WANTED_ACCELERATION, WANTED_LOAD = range(4)
TIP_HEIGHT, TIP_SPEED, TIP_ACCELERATION, SURFACE = range(4)
NOISE_OF_DROP, NOISE_OF_PASSIVE = range(2)
