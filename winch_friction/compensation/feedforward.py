"""What a compensator says at one instant."""

from typing import NamedTuple


class Feedforward(NamedTuple):
    """Friction feedforward at `time` s.

    `friction_torque`: N m, total, at the motor shaft, to be added to what the drive needs without friction;
    `pressure`: the same in Pa on the group that carries it (0 for an electric drive); `speed`: rad/s at which it
    was taken; `state`: disabled, waiting (an input was never seen), stale (an input was lost), fading (in), active,
    ending (the last ramp). `valid`: computed from complete inputs; otherwise it is a ramp to zero, to be followed but
    not held. `sequence` counts what was published.
    """

    time: float
    friction_torque: float
    pressure: float
    speed: float
    state: str
    drum_torque: float
    fade: float
    valid: bool = False
    sequence: int = 0
