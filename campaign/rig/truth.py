"""The rig's own crane and its true friction: numbers of docs/physics.md, written down again on purpose.

Nothing here is imported from the package under test, so that a mistake there cannot cancel against itself.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

RPM = 2 * np.pi / 60  # rad/s
CM3_PER_REV = 1e-6 / (2 * np.pi)  # m^3/rad
BAR = 1e5  # Pa
GRAVITY = 9.80665  # m/s^2
GEAR = 250.0
RADII = (0.800, 0.867, 0.934, 1.002, 1.069, 1.136)  # m, innermost first
WIRE_STIFFNESS = 3.0e8  # EA, N
WIRE_MASS = 24.5  # kg/m
MAX_DISPLACEMENT = 215 * CM3_PER_REV
INERTIA = 1.54  # kg m^2 at the motor shaft, without the load
LINE_VOLUME = 0.06  # m^3 per side
PUMP_FLOW = 1500e-6 * 1780 / 60  # m^3/s


class Friction(NamedTuple):
    """MJ4 per motor (paper 2 eq 1) and the remaining system per motor (paper 2 eq 10), SI."""

    K1: float
    K2: float
    K3: float
    K4: float
    K5: float
    C1: float
    C3: float
    C4: float
    C5: float
    C6: float


CRANE2 = Friction(4.05e-3, 3.69e10, 5.0e-3, 14.0, 1.16e-14, 155e-7, 0.562, 229 * RPM, 0.00943, 162e-7)
RELATIVE_SIGMA = Friction(0.20, 0.04, 0.05, 0.05, 0.22, 0.05, 1.00, 0.10, 0.20, 0.03)


def draw_friction(
    rng: np.random.Generator, uniform: bool, limit: float = 1.5, seed: Friction = CRANE2, least: float = 0.0
) -> Friction:
    """Parameters within +-`limit` sigma of the prior around `seed`: uniform, or normal and redrawn beyond the limit.

    With `least` above 0 every parameter lies between `least` and `limit` sigma away, on either side.
    """
    if least > 0.0:
        z = rng.uniform(least, limit, len(seed)) * rng.choice([-1.0, 1.0], len(seed))
        return _moved(seed, z)
    deviates = []
    for _ in seed:
        z = rng.uniform(-limit, limit) if uniform else rng.normal()
        while abs(z) > limit:
            z = rng.normal()
        deviates.append(z)
    return _moved(seed, deviates)


def _moved(seed: Friction, deviates: Sequence[float] | np.ndarray) -> Friction:
    return Friction(*(max(v * (1 + s * z), 0.0) for v, s, z in zip(seed, RELATIVE_SIGMA, deviates, strict=True)))
