"""What a compensator can be told, with the limits of every value."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from winch_friction.physics.channels import SLOW_INPUTS
from winch_friction.physics.errors import InputError, check, limits_of, option
from winch_friction.physics.friction import registered_terms
from winch_friction.physics.winch.operating_point import TELLING_STROKE

# below this the friction feedforward drives a torque-commanded winch into a limit cycle on measured speed
SAFE_MEASURED_SPEED_WIDTH = 75.0  # rad/s
# s. A torque that is late by tau has the wrong sign for 2 tau of every wave's period T, and is wrong by 2 F then, not
# by F as without it: (2 F)^2 2 tau / T = F^2 at tau = T / 8. The shortest waves that heave compensation meets have 4 s
OLDEST_INPUT = 0.5
OLDEST_IN_A_LOG = 10.0  # s; nothing is at stake in a replay, and logs are slow


@dataclass(frozen=True)
class CompensatorConfig:
    """Settings of the friction feedforward; SI. Raises `InputError` for values out of range."""

    velocity_source: str = option(
        "reference", choices=("reference", "measured"), doc="speed that the friction is taken at"
    )
    drive: str = option(
        "pump", choices=("pump", "torque"), doc="what the controller commands: a pump's flow, or torque"
    )
    scale: float = option(0.9, lower=0.0, upper=1.3, doc="share of the friction that is compensated; 0.8-0.9 is robust")
    gains: Mapping[str, float] = option(
        {}, lower=0.0, upper=1.5, doc="gain by term name on top of the scale, 1 unless given"
    )
    lead: float = option(0.0, lower=0.0, upper=0.5, unit="s", doc="how far ahead the speed is extrapolated")
    reversal_time: float = option(0.05, lower=0.0, upper=1.0, unit="s", doc="the sign change is spread over this time")
    reversal_speed: float = option(3.0, lower=1e-4, upper=200.0, unit="rad/s", doc="... and over at least this speed")
    jerk_filter: float = option(0.1, lower=0.0, upper=2.0, unit="s", doc="time constant of the extrapolation's jerk")
    acceleration_filter: float = option(
        0.0, lower=0.0, upper=2.0, unit="s", doc="time constant of the acceleration; above 0 for measured speed"
    )
    load: float = option(
        math.nan, lower=0.0, upper=1e7, unit="kg", may_be_nan=True,
        doc="hanging mass where hook_load is not measured; NaN: from the pressures",
    )  # fmt: skip
    load_filter: float = option(
        5.0, lower=0.1, upper=120.0, unit="s", doc="time constant of the load from the pressures"
    )
    pressure_group: str = option(
        "active", doc="motor group that carries the friction; the only group where there is one"
    )
    absolute_limit: float = option(
        math.inf, lower=0.0, upper=math.inf, unit="N*m", doc="bound of the torque; never above the crane's own"
    )
    envelope: float = option(1.3, lower=0.0, upper=1.3, doc="bound of the torque as a multiple of the seed's friction")
    slew_limit: float = option(
        1.5e4, lower=1.0, upper=1e7, unit="N*m/s",
        doc="bound of the torque's rate; never more than a reversal at the present load needs. The torque stays within "
        "what this lets go in 0.2 s",
    )  # fmt: skip
    ramp_time: float = option(
        1.0, lower=0.02, upper=60.0, unit="s", doc="time to fade in, out, and over to another model"
    )
    max_age: float = option(
        0.1, lower=0.001, upper=OLDEST_INPUT, unit="s",
        doc="age beyond which an input counts as lost; later than 0.5 s friction is better not compensated",
    )  # fmt: skip
    max_ages: Mapping[str, float] = option(
        SLOW_INPUTS,
        lower=0.001, upper=3600.0, unit="s",
        doc="the same by input where it differs; above 0.5 s for load, oil and wire alone",
    )  # fmt: skip
    seed_range: float = option(0.5, lower=0.0, upper=0.5, doc="how far a model's parameters may lie from the seed's")
    pressure_limit: float = option(
        math.inf, lower=0.0, upper=math.inf, unit="Pa", doc="bound of the pressure; never above the crane's rated one"
    )
    min_displacement: float = option(
        TELLING_STROKE, lower=0.01, upper=1.0, doc="D/D_max below which the pressure feedforward falls to zero"
    )

    def __post_init__(self) -> None:
        check(self)
        self._check_ages()
        if (
            self.drive == "torque"
            and self.velocity_source == "measured"
            and self.reversal_speed < SAFE_MEASURED_SPEED_WIDTH
        ):
            raise InputError(
                "velocity_source 'measured' makes a torque-commanded drive cycle at reversal: use the reference speed, "
                f"or set reversal_speed to at least {SAFE_MEASURED_SPEED_WIDTH:g} rad/s (found {self.reversal_speed:g})"
            )

    def _check_ages(self) -> None:
        """Speeds, pressures and displacements turn with every wave, whatever their age limit is called."""
        oldest = limits_of(self.__dataclass_fields__["max_age"]).upper
        for name, age in self.max_ages.items():
            if name.rpartition(".")[2] not in SLOW_INPUTS and age > oldest:
                raise InputError(
                    f"max_ages.{name} must be at most {oldest:g} s, found {age:g}: only "
                    f"{', '.join(sorted(SLOW_INPUTS))} may be older"
                )


@dataclass(frozen=True)
class ReplayConfig(CompensatorConfig):
    """The same for a recorded run: its inputs may be older than those that a torque is published from."""

    max_age: float = option(
        0.1, lower=0.001, upper=OLDEST_IN_A_LOG, unit="s", doc="age beyond which an input counts as lost"
    )


def check_on_crane(config: CompensatorConfig, heaviest: float) -> None:
    """Raise `InputError` for a gain whose name is no term at all, and for a load above `heaviest` kg, which a load cell
    of this crane could not show either."""
    for name in config.gains:
        if name not in registered_terms():
            raise InputError(f"gains: there is no term '{name}'; terms are {', '.join(sorted(registered_terms()))}")
    if config.load > heaviest:  # false for NaN
        raise InputError(f"load {config.load:g} kg is more than this crane can have ({heaviest:g} kg); is it in kg?")
