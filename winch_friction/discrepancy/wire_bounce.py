"""The hanging load on an elastic wire: what a rigid wire's balance lacks while the load bounces.

It is no friction and no discovery, so it is a tolerance of the measurement wherever the crane file knows the wire's stiffness and
the run its length.
"""

from collections.abc import Mapping

import numpy as np
from scipy.signal import bilinear, lfilter

from winch_friction.physics.signals import FloatArray
from winch_friction.physics.winch import Crane

DAMPING = (0.05, 0.3)  # share of critical; the truth lies between
SHORTEST = 5.0  # m


def wire_bounce(
    columns: Mapping[str, FloatArray],
    crane: Crane,
    mass: FloatArray,
    lever: FloatArray,
    acceleration: FloatArray,
    dt: float,
) -> FloatArray:
    """Torque at the shaft in N m beyond that of a rigid wire, one column per damping; zeros where nothing is known.

    `lever` is R/i in m, `acceleration` that of the wire at the crane in m/s^2.
    """
    out = np.zeros((len(mass), len(DAMPING)))
    load = float(np.median(mass))
    if "wire_out" not in columns or not np.isfinite(crane.wire_stiffness) or load <= 0.0:
        return out
    stiffness = crane.wire_stiffness / max(float(np.median(columns["wire_out"])), SHORTEST)
    frequency = np.sqrt(stiffness / load)  # rad/s
    for k, damping in enumerate(DAMPING):
        feedthrough = 2.0 * damping * frequency
        b, a = bilinear([feedthrough, frequency**2], [1.0, feedthrough, frequency**2], 1.0 / dt)
        out[:, k] = mass * lever * (lfilter(b, a, acceleration) - acceleration)
    return out
