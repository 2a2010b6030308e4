"""The state at the start: the load hangs still, the drive carries what the passive side does not."""

from typing import Any

import numpy as np

from winch_friction.physics.channels import GRAVITY
from winch_friction.simulation.plant.loop import record_row
from winch_friction.simulation.plant.state import (
    DRIVE,
    E_IN,
    GAS_T,
    GAS_V,
    P_A,
    P_B,
    ROW,
    STATES,
)


def equilibrium(plant: np.ndarray, control: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """States and friction memory at rest, without friction."""
    p = plant[0]
    state, memory = np.zeros(len(STATES)), np.zeros(2)
    state[GAS_T] = p["gas_start"]
    state[GAS_V] = p["gas_volume"]
    passive = p["passive_count"] * p["passive_displacement"] * (p["gas_pressure"] * p["gas_start"] - p["passive_low"])
    torque = p["mass"] * GRAVITY * p["metres_per_radian"] - passive
    difference = torque / (p["count"] * p["displacement"])
    state[P_A] = p["boost_pressure"] + max(difference, 0.0)
    state[P_B] = p["boost_pressure"] + max(-difference, 0.0)
    state[DRIVE] = torque if p["secondary"] else 0.0
    memory[1] = 1.0
    state[E_IN] = 0.0
    return state, memory


def first_row(plant: np.ndarray, state: np.ndarray, motion: Any, history: np.ndarray) -> None:
    """Row 0 of the history (periods + 1, len(COLUMNS))."""
    p = plant[0]
    drum = p["mass"] * GRAVITY * p["radius"]
    memory = np.zeros(2)
    first = history.view(ROW)[0, 0]
    record_row(p, first, state, memory, motion.tip[0], motion.reference[0], 0.0, p["mass"] * GRAVITY, drum)
    first["oil_temperature"] = motion.oil[0]
