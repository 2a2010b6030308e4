"""The friction feedforward: the friction model at the coming speed, inside its limits, faded and bridged."""

import math
from dataclasses import dataclass

from winch_friction.compensation.config import CompensatorConfig
from winch_friction.compensation.feedforward import Feedforward
from winch_friction.compensation.friction_law import FrictionLaw, check_gains
from winch_friction.compensation.inputs import missing_inputs, pressure_per_torque
from winch_friction.compensation.limits import TorqueLimits
from winch_friction.compensation.load import DrumTorque
from winch_friction.compensation.speed_predictor import SpeedPredictor
from winch_friction.compensation.transition import Bridge, Fade
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.friction.seed_range import refuse_outside_seed
from winch_friction.physics.identity import refuse_other_crane
from winch_friction.physics.signals import Sample
from winch_friction.physics.winch.crane import Crane
from winch_friction.physics.winch.operating_point import sample_operating_point

LONGEST_STEP = 0.5  # s; a gap in the samples does not count as more than this for fades and slew


@dataclass(slots=True)
class _Target:
    """What the model asks for at one sample."""

    torque: float = 0.0
    speed: float = 0.0
    drum_torque: float = 0.0


class FeedforwardCompensator:
    """Friction feedforward of a winch, one sample at a time; its time is the samples' time.

    The friction is taken at the reference (or measured) speed `lead` s ahead; the direction is tanh(omega/omega_s) with
    omega_s = max(reversal_speed, |acceleration| reversal_time), which spreads the sign change over time.

    Pressures: the motor terms read the *measured* |p_A - p_B|, also when the speed is looked at ahead of time. At
    reversal the friction itself moves it by about 58 bar on the active group, but the pressure-dependent losses are
    half a percent of the pressure torque: 3 N m of 600. The expected pressure would gain that little and add a loop
    through the load estimate. The feedback gain of measured pressure to feedforward to pressure is K3 + 2 K5 p / D,
    below 0.02, so it cannot build up.

    Raises `InputError` when built with gains for unknown terms.
    """

    def __init__(self, crane: Crane, seed_model: FrictionModel, config: CompensatorConfig | None = None) -> None:
        config = config or CompensatorConfig()
        check_gains(config.gains)
        self.crane, self.seed, self.config = crane, seed_model, config
        self._seed_law = FrictionLaw(seed_model, config.gains)
        self._law = self._seed_law
        self._predictor = SpeedPredictor(config.lead, config.acceleration_filter, config.jerk_filter)
        self._load = DrumTorque(crane, config.load, config.load_filter)
        self._limits = TorqueLimits(min(config.absolute_limit, crane.absolute_torque_limit), config.slew_limit)
        self._fade = Fade(config.ramp_time)
        self._bridge = Bridge(config.ramp_time)
        self._enabled = True
        self._counts = {"steps": 0, "stale": 0, "refused_models": 0, "accepted_models": 0, "time_steps_back": 0}
        self.reset()

    @property
    def model(self) -> FrictionModel:
        """The model in use."""
        return self._law.model

    def reset(self) -> None:
        """Back to the start with the model in use: no output, no memory of past samples."""
        self._predictor.reset()
        self._load.reset()
        self._law.reset()
        self._fade.value = 0.0
        self._bridge.start(0.0)
        self._last: Feedforward | None = None
        self._target = _Target()
        self._pressure_per_torque = 0.0
        self._lost: tuple[str, ...] = ()
        self._bump = False
        self._usable = False

    def set_enabled(self, enabled: bool) -> None:
        """Fade in or out from the next step on."""
        self._enabled = bool(enabled)

    def configure(self, config: CompensatorConfig) -> None:
        """Other settings from the next step on, without a bump; the model and the load estimate stay.

        Raises `InputError`, and changes nothing, for gains for unknown terms.
        """
        check_gains(config.gains)
        self.config = config
        self._seed_law, self._law = FrictionLaw(self.seed, config.gains), FrictionLaw(self.model, config.gains)
        self._predictor = SpeedPredictor(config.lead, config.acceleration_filter, config.jerk_filter)
        self._load.configure(config.load, config.load_filter)
        self._limits.absolute = min(config.absolute_limit, self.crane.absolute_torque_limit)
        self._limits.slew = config.slew_limit
        self._fade.duration = self._bridge.duration = config.ramp_time
        self._bump = True

    def load_model(self, model: FrictionModel) -> None:
        """Use another model from the next step on, without a bump.

        Raises `InputError`, and keeps the model in use, when a parameter is outside the range around the seed's or
        the model reads a motor group's pressure on an electric drive.
        """
        try:
            law = FrictionLaw(model, self.config.gains)
            refuse_other_crane(model, self.crane)
            refuse_outside_seed(model, self.seed, self.config.seed_range)
        except InputError:
            self._counts["refused_models"] += 1
            raise
        self._counts["accepted_models"] += 1
        self._law = law
        self._bump = True

    # -- one sample
    def step(self, sample: Sample) -> Feedforward:
        """The feedforward for one sample; a value that is NaN counts as lost (`physics.hold` holds between samples)."""
        if not math.isfinite(sample.time):
            return self._without_time()
        dt = self._elapsed(sample.time)
        self._lost = self._missing(sample)
        usable = not self._lost and self._aim(sample, dt)
        if not usable:
            self._predictor.reset()
        self._counts["steps"] += 1
        self._counts["stale"] += not usable
        previous = self._last.friction_torque if self._last else 0.0
        torque = self._blended(usable, previous, dt)
        self._last = self._feedforward(sample.time, torque, usable)
        return self._last

    def expire(self, time: float) -> Feedforward | None:
        """What remains at `time` s when no sample came since: for a watchdog. Changes nothing; None before the first
        sample."""
        if self._last is None:
            return None
        silent = time - self._last.time - self.config.max_age
        if silent <= 0.0:
            return self._last
        factor = max(0.0, 1.0 - silent / self.config.ramp_time)
        return Feedforward(
            time, self._last.friction_torque * factor, self._last.pressure * factor, self._last.speed, "stale",
            self._last.drum_torque, self._last.fade * factor,
        )  # fmt: skip

    def status(self) -> dict[str, float | str]:
        """State, counts and the model's name: numbers as numbers, for diagnostics."""
        last = self._last
        return {
            "state": last.state if last else "waiting",
            "enabled": self._enabled,
            "model": self.model.name,
            "missing": ", ".join(self._lost),
            "fade": self._fade.value,
            "friction_torque": last.friction_torque if last else 0.0,
            "drum_torque": self._target.drum_torque,
            **{f"{name}_clamps": count for name, count in self._limits.counts.items()},
            **self._counts,
        }

    # -- parts of a step
    def _elapsed(self, time: float) -> float:
        """Seconds since the last sample, with what a silent spell in between did to the output taken over."""
        if self._last is None:
            return 0.0
        dt = time - self._last.time
        if not dt >= 0.0:
            self._counts["time_steps_back"] += 1
            self._predictor.reset()
            self._bump = True
            return 0.0
        expired = self.expire(time)
        if expired is not None and expired.state == "stale" and expired is not self._last:
            self._last, self._fade.value, self._bump = expired, expired.fade, True
            self._predictor.reset()
            return 0.0
        return min(dt, LONGEST_STEP)

    def _missing(self, sample: Sample) -> tuple[str, ...]:
        return missing_inputs(
            sample, self.crane, self._law.reads, self.config.velocity_source, math.isfinite(self.config.load)
        )

    def _aim(self, sample: Sample, dt: float) -> bool:
        """Set the target from a complete sample; False, and the old target kept, when the model does not give a
        number."""
        reference = self.config.velocity_source == "reference"
        ahead = self._predictor.step(sample.time, sample.speed_reference if reference else sample.motor_speed)
        drum_torque = self._load.value(sample) if "drum_torque" in self._law.reads else 0.0
        width = max(self.config.reversal_speed, abs(ahead.acceleration) * self.config.reversal_time)
        x = sample_operating_point(
            sample, self.crane, drum_torque=drum_torque, speed=ahead.speed, width=width, acceleration=ahead.acceleration
        )
        groups = len(sample.groups)
        torque = self.config.scale * self._law.torque(x, groups)
        envelope = self.config.envelope * self._seed_law.magnitude(x, groups)
        if not (math.isfinite(torque) and math.isfinite(envelope)):
            self._lost = ("finite model",)
            return False
        self._target = _Target(self._limits.bound(torque, envelope), ahead.speed, drum_torque)
        self._pressure_per_torque = pressure_per_torque(sample, self.crane, self.config)
        self._law.advance(x, groups, dt)
        self._load.learn(sample, torque / self.config.scale if self.config.scale else 0.0, ahead.acceleration, dt)
        return True

    def _blended(self, usable: bool, previous: float, dt: float) -> float:
        """The target, faded and bridged; a lost input leaves the old target to fade out."""
        up = usable and self._enabled
        if usable and not self._usable:
            self._bump = True
        self._usable = usable
        faded = self._fade.step(up, dt) * self._target.torque
        if self._bump and usable:
            self._bridge.start(previous - faded)
            self._bump = False
        torque = faded + self._bridge.step(dt)
        return self._limits.slewed(torque, previous, dt) if self._last else 0.0

    def _without_time(self) -> Feedforward:
        """A sample that cannot be placed in time changes nothing but the counts."""
        self._counts["steps"] += 1
        self._counts["stale"] += 1
        self._lost = ("time",)
        return self._last or Feedforward(0.0, 0.0, 0.0, 0.0, "waiting", 0.0, 0.0)

    def _feedforward(self, time: float, torque: float, usable: bool) -> Feedforward:
        pressure = torque * self._pressure_per_torque
        target = self._target
        return Feedforward(
            time, torque, pressure, target.speed, self._state(usable), target.drum_torque, self._fade.value
        )

    def _state(self, usable: bool) -> str:
        if not self._enabled:
            return "disabled"
        if not usable:
            return "stale" if self._last is not None and self._last.state != "waiting" else "waiting"
        return "active" if self._fade.value >= 1.0 else "fading"
