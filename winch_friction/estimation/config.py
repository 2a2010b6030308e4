"""What an estimator can be told, with the limits of every value."""

from dataclasses import dataclass

from winch_friction.physics.channels import BAR, RPM
from winch_friction.physics.errors import check, option


@dataclass(frozen=True)
class EstimatorConfig:
    """Settings of the online friction estimator; SI. Noises are 1 sigma. Raises `InputError` for values out of
    range."""

    # noise of the inputs and of the measurement
    speed_noise: float = option(0.02, lower=0.0, upper=50.0, unit="rad/s", doc="white noise of the measured speed")
    speed_step: float = option(2.9 * RPM, lower=0.0, upper=50.0, unit="rad/s", doc="quantisation of the speed")
    pressure_noise: float = option(0.3 * BAR, lower=0.0, upper=50 * BAR, unit="Pa", doc="noise of one pressure")
    displacement_noise: float = option(0.0005, lower=0.0, upper=0.2, doc="relative noise of a displacement")
    torque_noise: float = option(0.0, lower=0.0, upper=1e5, unit="N*m", doc="noise of a measured motor torque")
    heave_noise: float = option(0.003, lower=0.0, upper=1.0, unit="m/s", doc="noise of the heave velocity")
    payload_noise: float = option(0.02, lower=0.0, upper=10.0, unit="m/s^1.5", doc="random walk of the load's speed")
    # constant errors that are considered and never estimated, where the seed's corrections do not say
    displacement_scale_std: float = option(0.01, lower=0.0, upper=0.2, doc="relative error of the displacements")
    pressure_scale_std: float = option(0.0, lower=0.0, upper=0.2, doc="relative error of the pressures")
    pressure_offset_std: float = option(
        0.0, lower=0.0, upper=50 * BAR, unit="Pa", doc="offset between the two lines of the driving group"
    )
    # what the model does not know
    disturbance_std: float = option(10.0, lower=0.0, upper=1e5, unit="N*m", doc="torque that no term explains")
    disturbance_time: float = option(0.3, lower=0.001, upper=100.0, unit="s", doc="how long such a torque lasts")
    load_std: float = option(0.05, lower=0.0, upper=1.0, doc="relative error of the load torque at the start")
    load_noise: float = option(1.0, lower=0.0, upper=1e4, unit="N*m/sqrt(s)", doc="random walk of the load torque")
    wire_length: float = option(50.0, lower=1.0, upper=1e4, unit="m", doc="hanging wire where wire_out is not measured")
    wire_damping: float = option(1.5e5, lower=0.0, upper=1e8, unit="N*s/m", doc="damping of the load on its wire")
    load_filter: float = option(2.0, lower=0.0, upper=60.0, unit="s", doc="low pass of the measured hook load")
    forgetting_time: float = option(
        2.0e4, lower=10.0, upper=1e12, unit="s", doc="time in which a covariance fades back to the seed's"
    )
    default_std: float = option(0.2, lower=0.0, upper=1.0, doc="relative sigma of a seed without covariance")
    adaptation_time: float = option(
        5.0, lower=0.1, upper=1e12, unit="s", doc="the noises' common factor follows in this"
    )
    # what is accepted
    gate: float = option(5.0, lower=1.0, upper=100.0, doc="innovations beyond this many sigma are rejected")
    max_gap: float = option(0.5, lower=0.001, upper=60.0, unit="s", doc="a longer gap restarts the speed")
    seed_range: float = option(0.5, lower=0.0, upper=0.5, doc="how far a parameter may move from its seed")
    conflict_level: float = option(
        0.01, lower=0.0, upper=0.5, doc="seeds less probable than this after learning lose their sigma; 0: never"
    )
    # when learning rests
    stick_speed: float = option(3.0, lower=0.0, upper=100.0, unit="rad/s", doc="below it nothing is learned")
    excitation_speed: float = option(
        10.0, lower=0.0, upper=1e3, unit="rad/s", doc="range that the recent speed must have had"
    )
    excitation_time: float = option(20.0, lower=0.1, upper=3600.0, unit="s", doc="how recent")
    saturation_pressure: float = option(380 * BAR, lower=1e5, upper=1e9, unit="Pa", doc="above it is saturation")
    saturation_torque: float = option(1e9, lower=0.0, upper=1e9, unit="N*m", doc="the same of a motor torque")
    # what is said
    nis_window: int = option(100, lower=10, upper=100000, doc="samples in a window of the consistency check")
    learning_below: float = option(0.9, lower=0.0, upper=1.0, doc="learning: sigma below this share of the seed's")
    learned_below: float = option(0.6, lower=0.0, upper=1.0, doc="learned: sigma below this share of the seed's")
    hysteresis: float = option(0.05, lower=0.0, upper=0.5, doc="share by which a status is left later")
    settle_time: float = option(2.0, lower=0.0, upper=600.0, unit="s", doc="frozen and invalid are said after this")

    def __post_init__(self) -> None:
        check(self)
