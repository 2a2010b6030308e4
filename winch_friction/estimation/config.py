"""What an estimator can be told, with the limits of every value, and what its defaults are on a crane of another size.

The defaults are those of the reference crane (`crane_150t`). Three of them have the size of a crane in their unit: a
torque at the shaft that no term explains, what the load's torque walks in a second, and the damping of a load on its
wire. `at_its_size` takes the first two in proportion to the torque that holds the rated load, and the third so that
the damping ratio c / (2 sqrt(k m)) is the same (docs/physics.md, section 5).
"""

import math
from dataclasses import dataclass, replace

from winch_friction.physics.channels import BAR, CM3_PER_REV, GRAVITY, RPM
from winch_friction.physics.errors import check, option
from winch_friction.physics.winch.crane import Crane, at_its_speeds
from winch_friction.physics.winch.operating_point import RATED_PRESSURE


@dataclass(frozen=True)
class EstimatorConfig:
    """Settings of the online friction estimator; SI. Noises are 1 sigma. Raises `InputError` for values out of
    range."""

    # noise of the inputs and of the measurement
    speed_noise: float = option(0.02, lower=0.0, upper=50.0, unit="rad/s", doc="white noise of the measured speed")
    speed_delay: float = option(
        0.0, lower=0.0, upper=0.5, unit="s",
        doc="how late the measured speed is: half a scan where a PLC takes the difference of two encoder angles",
    )  # fmt: skip
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
    speed_delay_std: float = option(
        0.15, lower=0.0, upper=2.0, doc="what speed_delay may be off by, as a share of the time between two samples"
    )
    wire_damping_std: float = option(0.3, lower=0.0, upper=2.0, doc="relative error of wire_damping, considered")
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


# -- the defaults on another crane
# of the reference crane: N m at the shaft that hold its rated load (150 t on the outer layer) and that its motors make,
# kg, N of its wire (EA), and the bound of its feedforward, N m
RATED_LOAD, WIRE_STIFFNESS, TORQUE_LIMIT = 150e3, 3.0e8, 2000.0
RATED_TORQUE = RATED_LOAD * GRAVITY * 1.136 / 250.0
MOTOR_TORQUE = 11 * (215.0 * CM3_PER_REV) * RATED_PRESSURE


def at_its_size(config: EstimatorConfig, crane: Crane) -> EstimatorConfig:
    """The settings with those that were left at their defaults in proportion to this crane's speeds, torques and
    wire."""
    usual = EstimatorConfig()
    config = at_its_speeds(config, crane, "stick_speed", "excitation_speed")
    factors = {
        "disturbance_std": torque_ratio(crane),
        "load_noise": torque_ratio(crane),
        "wire_damping": damping_ratio(crane),
    }
    changes = {n: getattr(usual, n) * f for n, f in factors.items() if getattr(config, n) == getattr(usual, n)}
    return replace(config, **changes)


def in_use(config: EstimatorConfig) -> dict[str, float]:
    """What a status tells of the settings that go with the crane: a parameter shows the reference crane's."""
    return {name: getattr(config, name) for name in ("disturbance_std", "load_noise", "wire_damping")}


def torque_ratio(crane: Crane) -> float:
    """How many times the torques of the reference crane's shaft this crane's are: by the rated load, else by what the
    motors make, else by the bound of the feedforward; 1 where nothing is said."""
    if crane.rated_load:
        return crane.drum_torque(crane.rated_load) / crane.gear_ratio / RATED_TORQUE
    if motors := max(crane.groups.values(), default=0) * crane.max_displacement:
        return motors * (crane.rated_pressure or RATED_PRESSURE) / MOTOR_TORQUE
    return crane.absolute_torque_limit / TORQUE_LIMIT if 0.0 < crane.absolute_torque_limit < math.inf else 1.0


def damping_ratio(crane: Crane) -> float:
    """How many times the reference crane's damping, N s/m, gives the same damping ratio: sqrt(k m) goes with the wire's
    EA and the rated load; a wire of which nothing is said is taken as that of the reference for its load."""
    lever = crane.drum.radius(math.nan) / crane.gear_ratio
    load = crane.rated_load or torque_ratio(crane) * RATED_TORQUE / (GRAVITY * lever)  # kg
    mass = load / RATED_LOAD
    wire = crane.wire_stiffness / WIRE_STIFFNESS if 0.0 < crane.wire_stiffness < math.inf else mass
    return math.sqrt(wire * mass)
