"""What an estimator says: at one instant, and about one parameter."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Estimate:
    """Outcome of one step.

    `accepted`: the sample changed the filter; `innovation` rad/s, its variance and `nis`, the squared ratio (NaN when
    nothing was predicted); `state`: learning, or why not: waiting, disabled, rejected, stick, saturation, no
    excitation, restarted;
    `friction_torque`: N m at the shaft by the learned mean; `speed` rad/s; `drum_torque` N m.
    """

    time: float
    accepted: bool
    state: str
    innovation: float
    innovation_variance: float
    nis: float
    speed: float
    drum_torque: float
    friction_torque: float


@dataclass(frozen=True, slots=True)
class ParameterEstimate:
    """One parameter: SI value, standard deviation, and status seed / learning / learned / frozen / invalid."""

    name: str
    unit: str
    value: float
    std: float
    seed_value: float
    seed_std: float
    status: str
