"""The friction feedforward: the friction model at the coming speed, inside its limits, faded and bridged."""

import math
from dataclasses import dataclass

from winch_friction.compensation.config import CompensatorConfig, check_on_crane
from winch_friction.compensation.feedforward import Feedforward
from winch_friction.compensation.parts import CarryingPressure, DrumTorque, FrictionLaw, Needs, carried
from winch_friction.compensation.safe_output import AGAINST_SPEED, SafeOutput
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.friction.model import completed, refuse_other_crane
from winch_friction.physics.friction.seed_range import refuse_outside_seed
from winch_friction.physics.sample_corrections import SampleCorrector, past_corrections
from winch_friction.physics.signals import Sample
from winch_friction.physics.winch.crane import Crane, at_its_speeds
from winch_friction.physics.winch.operating_point import (
    ChannelRanges,
    SpeedPredictor,
    fastest_command,
    sample_operating_point,
    smooth_sign,
    time_to_reversal,
)

TOO_SLOW = 3  # samples in a row after the age limit: a sender that is slower, no gap
UNSURE = 0.3  # below this direction a target says too little about the friction's size to be turned with the motion


@dataclass(slots=True)
class _Target:
    """What the model asks for at one sample."""

    torque: float = 0.0
    speed: float = 0.0
    drum_torque: float = 0.0
    size: float = 0.0  # of the torque in full motion, N m
    envelope: float = math.inf  # N m
    reversal: float = math.inf  # s until the motion may turn


class FeedforwardCompensator:
    """Friction feedforward of a winch, one sample at a time; its time is the samples' time.

    The friction is taken at the reference (or measured) speed `lead` s ahead; the direction is tanh(omega/omega_s) with
    omega_s = max(reversal_speed, |acceleration| reversal_time), which spreads the sign change over time.

    Pressures: the motor terms read the *measured* |p_A - p_B|, also when the speed is looked at ahead of time. At
    reversal the friction itself moves it by about 58 bar on the active group, but the pressure-dependent losses are
    half a percent of the pressure torque: 3 N m of 600. The expected pressure would gain that little and add a loop
    through the load estimate. The feedback gain of measured pressure to feedforward to pressure is K3 + 2 K5 p / D,
    below 0.02, so it cannot build up.

    `since` s is the samples' clock now: what a model's corrections say of the time before needs no correcting.
    Raises `InputError` when built with gains for unknown terms.

    >>> import winch_friction as wf
    >>> crane, model = wf.load_crane("crane_150t"), wf.load_model("a6vm215_crane2")
    >>> compensator = wf.FeedforwardCompensator(crane, model)
    >>> run = wf.simulate("ahc_55t_215", crane, model, duration=10.0).run
    >>> outputs = [compensator.step(sample) for sample in run.samples()]
    >>> outputs[-1].state, max(abs(each.friction_torque) for each in outputs) > 100.0  # N m
    ('active', True)
    >>> compensator.load_model(model.with_values({"C6": 1.1 * model.value("C6")}))  # while it runs, without a bump
    >>> compensator.model.value("C6") > model.value("C6"), compensator.status()["accepted_models"]
    (True, 1)
    >>> compensator.configure(type(compensator.config)(scale=0.5))
    >>> end = outputs[-1].time
    >>> silent = compensator.decay(end + 5.0)  # what a watchdog publishes where no sample comes
    >>> silent.state, silent.valid, silent.friction_torque
    ('stale', False, 0.0)
    >>> compensator.set_enabled(False)
    >>> compensator.reset()
    """

    def __init__(
        self, crane: Crane, seed_model: FrictionModel, config: CompensatorConfig | None = None,
        since: float = -math.inf,
    ) -> None:  # fmt: skip
        self._correct = SampleCorrector(crane, seed_model, since=since)
        config = at_its_speeds(config or CompensatorConfig(), crane, "reversal_speed")
        self.ranges = ChannelRanges(crane)
        check_on_crane(config, self.ranges.load)
        self.crane, self.seed, self.config = crane, completed(seed_model, crane), config
        self._seed_law = FrictionLaw(self.seed, config.gains)
        self._law = self._seed_law
        self._since = since  # s, the latest sample's stamp
        self._predictor = SpeedPredictor(config.lead, config.acceleration_filter, config.jerk_filter)
        self._load = DrumTorque(self._correct.crane, config.load, config.load_filter)
        self._needs = self._needed()
        self.output = SafeOutput(
            self._absolute(config), config.slew_limit, config.ramp_time, config.max_age, config.lead,
            AGAINST_SPEED * crane.speed_scale, CarryingPressure.on(crane, config),
        )  # fmt: skip
        self._enabled = True
        self._counts = {"steps": 0, "stale": 0, "refused_models": 0, "accepted_models": 0}
        self._forget()

    @property
    def model(self) -> FrictionModel:
        """The model in use."""
        return self._law.model

    def reset(self) -> None:
        """Begin anew with the model in use: no memory of past samples. What is published goes on from where it is."""
        self.output.restart()
        self._forget()

    def _forget(self) -> None:
        self._predictor.reset()
        self._load.reset()
        self._law.reset()
        self._replaced: FrictionLaw | None = None  # the law that was published last, until the next sample
        self._last: Feedforward | None = None
        self._target, self._pressure_per_torque, self._pressure_share = _Target(), 0.0, 1.0
        self.lost: tuple[str, ...] = ()  # what the latest sample lacks, or is doubted for, in words

    def _absolute(self, config: CompensatorConfig) -> float:
        return min(config.absolute_limit, self.crane.absolute_torque_limit)

    def set_enabled(self, enabled: bool) -> None:
        """Fade in or out from the next step on."""
        self._enabled = bool(enabled)

    def configure(self, config: CompensatorConfig) -> None:
        """Other settings from the next step on, without a bump; the model and the load estimate stay.

        Raises `InputError`, and changes nothing, for gains for unknown terms, a load that the crane cannot have, and a
        slew limit that could not let go in time of what is published.
        """
        config = at_its_speeds(config, self.crane, "reversal_speed")
        check_on_crane(config, self.ranges.load)
        self.output.configure(self._absolute(config), config.slew_limit, config.ramp_time, config.max_age, config.lead)
        self.config = config
        self._seed_law, self._law = FrictionLaw(self.seed, config.gains), FrictionLaw(self.model, config.gains)
        self._predictor = SpeedPredictor(config.lead, config.acceleration_filter, config.jerk_filter)
        self._load.configure(config.load, config.load_filter)
        self._needs = self._needed()

    def load_model(self, model: FrictionModel) -> None:
        """Use another model from the next step on, without a bump.

        Raises `InputError`, and keeps the model in use, when a parameter is outside the range around the seed's, the
        model reads a motor group's pressure on an electric drive, or a correction cannot be taken out while running.
        """
        try:
            correct = SampleCorrector(self.crane, model, since=self._since)
            law = FrictionLaw(completed(model, self.crane), self.config.gains)
            refuse_other_crane(model, self.crane)
            refuse_outside_seed(model, self.seed, self.config.seed_range)
        except InputError:
            self._counts["refused_models"] += 1
            raise
        self._counts["accepted_models"] += 1
        if model.corrections != self.model.corrections:
            self.output.bump()  # the two do not look at the same sample
        elif self._replaced is None:
            self._replaced = self._law
        self._law, self._correct = law, correct
        self._needs = self._needed()
        self._load.crane = correct.crane

    # -- one sample
    def step(
        self, sample: Sample, now: float | None = None, distrusted: tuple[str, ...] = (), asked: float = math.nan
    ) -> Feedforward:  # fmt: skip
        """The feedforward for one sample; a value that is NaN counts as lost (`InputHold` holds between samples).

        `now` s is the steady time of its arrival; without it the stamps alone say how much time has passed.
        `distrusted` says in words which inputs cannot be right together: like a lost input. `asked` s is the stamp of
        the command, where the sample holds an earlier one: it does not stand still between two of its messages.
        """
        self._counts["steps"] += 1
        if not math.isfinite(sample.time):
            return self._without_time()
        dt = self.output.arrive(sample.time, now)
        if dt == 0.0:
            self._predictor.reset()
        self._since = sample.time
        if not self._correct.idle:
            sample = self._correct(sample)
            distrusted += self._correct.left(sample.time)
        self.lost = self._needs.missing(sample) + distrusted
        usable = not self.lost and self._aim(sample, dt, asked)
        if not usable:
            self._predictor.reset()
            self._turn(sample)
        self._counts["stale"] += not usable
        target = self._target
        self.output.follow(
            target.torque, target.envelope, usable, self._enabled, target.reversal, sample.motor_speed,
            sample.speed_reference,
        )  # fmt: skip
        self._last = self._feedforward(sample.time, self._state(usable), usable and self._enabled)
        return self._last

    def decay(self, time: float, state: str = "stale") -> Feedforward:
        """Publish what remains at `time` s: for a watchdog, and for the end."""
        self.output.decay(time)
        return self._feedforward(time, state, False)

    def status(self) -> dict[str, float | str]:
        """State, counts and the model's name: numbers as numbers, for diagnostics."""
        last, slow, pressure = self._last, self._too_slow(), {"pressure": self.output.carrying.clamps}
        return {
            "state": "stale" if slow else last.state if last else "waiting",
            "enabled": self._enabled,
            "model": self.model.name,
            "past_corrections": past_corrections(self._correct),
            "missing": ", ".join(self.lost) or slow,
            "fade": self.output.fade.value,
            "friction_torque": self.output.torque,
            "drum_torque": self._target.drum_torque,
            "slew_limit": self.output.limits.slew,
            "torque_limit": self.output.limits.absolute,
            "withheld": self.output.limits.withheld(self.output.absolute, self.output.slew),
            **{f"{name}_clamps": count for name, count in (self.output.limits.counts | pressure).items()},
            **self._counts,
            "pressure_share": self._pressure_share,
            "time_steps_back": self.output.steps_back,
        }

    def _too_slow(self) -> str:
        """What to say where no sample comes before the one before is too old: each begins anew, at no torque."""
        output = self.output
        if output.late < TOO_SLOW:
            return ""
        return f"speeds within max_age {output.hold:g} s: they come {output.apart:.2g} s apart"

    # -- parts of a step
    def _needed(self) -> Needs:
        return Needs(self.ranges, self._law.reads, self.config.velocity_source, math.isfinite(self.config.load))

    def _speed(self, sample: Sample) -> float:
        return sample.speed_reference if self.config.velocity_source == "reference" else sample.motor_speed

    def _aim(self, sample: Sample, dt: float, asked: float) -> bool:
        """Set the target from a complete sample; False, and the old target kept, where the model gives no number."""
        held = self.config.velocity_source == "reference" and math.isfinite(asked)
        ahead = self._predictor.step(asked if held else sample.time, self._speed(sample))
        drum_torque = self._load.value(sample) if "drum_torque" in self._law.reads else 0.0
        width = max(self.config.reversal_speed, abs(ahead.acceleration) * self.config.reversal_time)
        x = sample_operating_point(
            sample, self._correct.crane, drum_torque=drum_torque, speed=ahead.speed, width=width,
            acceleration=ahead.acceleration,
        )  # fmt: skip
        groups = len(sample.groups)
        torque = self.config.scale * self._law.torque(x, groups)
        magnitude = self._seed_law.magnitude(x, groups, fastest_command(sample.motor_speed, self.ranges.speed))
        envelope = self.config.envelope * magnitude
        if not (math.isfinite(torque) and math.isfinite(envelope)):
            self.lost = ("finite model",)
            return False
        bounded = self.output.limits.bound(torque, envelope)
        if self._replaced is not None:
            before = self.output.limits.bound(self.config.scale * self._replaced.torque(x, groups), envelope)
            self.output.carry(before - bounded)
            self._replaced = None
        size = abs(bounded) / max(abs(x[0]), UNSURE)
        self._target = _Target(bounded, ahead.speed, drum_torque, size, envelope, time_to_reversal(ahead))
        self._steepest(x, groups, magnitude)
        self._pressure_per_torque, self._pressure_share = carried(sample, self.crane, self.config)
        self._law.advance(x, groups, dt)
        self._load.learn(sample, torque / self.config.scale if self.config.scale else 0.0, ahead.acceleration, dt)
        return True

    def _steepest(self, x: tuple[float, ...], groups: int, magnitude: float) -> None:
        """Slew no faster than a reversal at this load needs: nothing of friction changes faster than its sign."""
        slow = (x[0], self.config.reversal_speed, self.config.reversal_speed, *x[3:])
        size = max(self._seed_law.magnitude(slow, groups), magnitude)
        if self.config.reversal_time > 0.0 and math.isfinite(size):
            self.output.restrict(max(self.config.envelope, 1.0) * size / self.config.reversal_time)

    def _turn(self, sample: Sample) -> None:
        """A target without its inputs still turns with the motion, as long as the speed is there."""
        target, speed = self._target, self._speed(sample)
        if self.ranges.plausible("motor_speed", speed):
            target.torque = min(target.size, target.envelope) * smooth_sign(speed, self.config.reversal_speed)
            target.reversal = math.inf

    def _without_time(self) -> Feedforward:
        """A sample that cannot be placed in time changes nothing but the counts."""
        self._counts["stale"] += 1
        self.lost = ("time",)
        return self._last or Feedforward(0.0, 0.0, 0.0, 0.0, "waiting", 0.0, 0.0)

    def _feedforward(self, time: float, state: str, valid: bool) -> Feedforward:
        target, torque = self._target, self.output.torque
        return Feedforward(
            time, torque, self.output.as_pressure(self._pressure_per_torque), target.speed, state, target.drum_torque,
            self.output.fade.value, valid, self.output.sequence,
        )  # fmt: skip

    def _state(self, usable: bool) -> str:
        if not self._enabled:
            return "disabled"
        if not usable:
            return "stale" if self._last is not None and self._last.state != "waiting" else "waiting"
        return "active" if self.output.fade.value >= 1.0 else "fading"
