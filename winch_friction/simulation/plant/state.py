"""What the plant carries: the places of its states, of what drives it, and the record of each control period."""

from typing import NamedTuple

import numpy as np


class State(NamedTuple):
    """The plant's state, or its time derivative; its energies are integrals that drive nothing."""

    shaft_angle: float  # rad
    shaft_speed: float  # rad/s
    tip: float  # m, crane tip above its mean, up positive
    load: float  # m, load above where it started
    load_speed: float  # m/s
    pressure_a: float  # Pa, driven group
    pressure_b: float  # Pa
    drive: float  # m^3/s of the pump (primary) or N m of the driven group (secondary)
    drive_rate: float  # its derivative, second-order pump
    gas_volume: float  # m^3
    gas_temperature: float  # relative to the wall
    energy_in: float  # J, from pumps, boost and make-up
    energy_heave: float  # J, from the crane tip
    energy_friction: float  # J, taken by friction
    energy_lost: float  # J, taken by leakage, valves, lines, wire damping, heat and water


STATES = State._fields
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
