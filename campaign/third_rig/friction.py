"""The friction that the winch really has without any hidden effect, after the two papers; SI."""

import numpy as np

from campaign.third_rig.crane import Friction
from campaign.third_rig.motion import Series


def winch_friction(true: Friction, speed: Series, drum_torque: Series) -> Series:
    """N m per motor's shaft, against the motion: Stribeck, viscous, and with the load."""
    falling = (true["C1"] * drum_torque + true["C3"]) * np.exp(-speed / true["C4"])
    return falling + true["C5"] * speed + true["C6"] * drum_torque


def motor_friction(true: Friction, speed: Series, displacement: Series, pressure: Series) -> Series:
    """N m per motor, against the motion; `displacement` in m^3/rad, `pressure` is the drop without its sign, Pa."""
    turbulence = true["K2"] * displacement**3 * speed**2
    with_pressure = true["K3"] * pressure * displacement
    return true["K1"] * speed + turbulence + with_pressure + true["K4"] + true["K5"] * pressure**2
