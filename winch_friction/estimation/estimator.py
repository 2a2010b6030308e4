"""The online friction estimator: seeded offline, bounded around the seed, and open about what it does not know."""

import math
from collections.abc import Mapping
from typing import Any

from winch_friction.estimation.answers import (
    Estimate,
    ParameterEstimate,
    ParameterStatuses,
    learned_model,
    parameter_estimates,
)
from winch_friction.estimation.checkpoint import Kept, filter_state, restored_state
from winch_friction.estimation.compiled_filter import filter_class
from winch_friction.estimation.config import EstimatorConfig, at_its_size, in_use
from winch_friction.estimation.conflict import SeedConflict
from winch_friction.estimation.dynamics import FIRST_PARAMETER, fresh_motion
from winch_friction.estimation.interval import FrictionFunctions, Intervals
from winch_friction.estimation.parameters import ScaledParameters
from winch_friction.estimation.sample import Accepted, HangingLoad, accepted, saturated, usable
from winch_friction.estimation.sensor_errors import SensorErrors
from winch_friction.estimation.trust import Consistency, Excitation, InnovationGate
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.friction.model import completed, with_stated_std
from winch_friction.physics.friction.term import needed
from winch_friction.physics.sample_corrections import SampleCorrector, past_corrections
from winch_friction.physics.signals import Sample
from winch_friction.physics.winch.crane import Crane, sample_drive_torque
from winch_friction.physics.winch.operating_point import ChannelRanges

NAN = math.nan


class FrictionEstimator:
    """Learns the friction parameters from speed and drive torque, one sample at a time; its time is the samples' time.

    An extended Kalman filter over [omega, wire stretch, load speed, load torque beyond the hook load, disturbance,
    encoder rounding (2), scaled parameters]; the drive torque of the measured pressures (or of an electric motor) is
    the input, the shaft speed the measurement. The direction of a step is the mean sign between its two speeds. The
    disturbance is a first-order Gauss-Markov torque: what no term explains is correlated in time (wire, sensor skew),
    and taken as white it would make the filter far too sure.

    The seed's sigmas are a claim: when what is learned refutes them they are taken back (`estimation.conflict`).

    Learning rests in stick, in saturation and without excitation; the parameters are then considered, not updated
    (Schmidt), and so is the load in stick, where the brake may carry it.
    A sample that is not finite, late, or beyond the innovation gate leaves the estimator exactly as it was.

    >>> import winch_friction as wf
    >>> crane, model = wf.load_crane("crane_150t"), wf.load_model("a6vm215_crane2")
    >>> estimator = wf.FrictionEstimator(crane, model)
    >>> for sample in wf.simulate("ahc_55t_215", crane, model, duration=10.0).run.samples():
    ...     estimate = estimator.step(sample)
    >>> [(each.name, each.std > 0.0) for each in estimator.parameters()][:2]
    [('K1', True), ('K2', True)]
    >>> estimator.model().covariance.shape, estimator.size, estimator.drum_torque > 5e5  # N m
    ((10, 10), 17, True)
    >>> abs(estimator.load_apart) < 0.1  # the load cell and the balance of torques agree
    True
    >>> estimator.uncorrectable(sample)  # what of the seed's corrections a live estimator cannot take out
    ()
    >>> kept = estimator.snapshot()  # what a checkpoint holds
    >>> estimator.reset()  # back to the seed
    >>> estimator.restore(kept)
    >>> estimator.take_back(kept)  # of the parameters, and no more
    >>> estimator.set_enabled(False)
    >>> estimator.status()["enabled"]
    False
    """

    def __init__(
        self, crane: Crane, seed_model: FrictionModel, config: EstimatorConfig | None = None, since: float = -math.inf
    ) -> None:
        # refuses by name what only a whole run can be rid of, unless it was over at `since` s
        self._correct = SampleCorrector(crane, seed_model, since=since)
        self.crane = self._correct.crane
        self.config = at_its_size(config or EstimatorConfig(), self.crane)
        self.seed, self.assumed = with_stated_std(completed(seed_model, crane), self.config.default_std)
        self._ranges, self._needed = ChannelRanges(self.crane), needed(self.seed.terms)
        self._enabled = True
        self.reset()

    def reset(self) -> None:
        """Back to the seed."""
        self._parameters = ScaledParameters(self.seed, self.config)
        errors = SensorErrors(self.crane, self.seed, self.config)
        self._filter = filter_class()(self.config, self._parameters, errors.std)
        self._friction = FrictionFunctions(self.seed)
        self._load = HangingLoad(self.crane, self.config.load_filter)
        self._intervals = Intervals(self.crane, self.config, self._load, self._friction, errors)
        self._excitation = Excitation(self.config.excitation_time)
        self.consistency = Consistency(self.config.nis_window)
        self._statuses = ParameterStatuses(self.config, self._parameters)
        self._conflict = SeedConflict(self.config, self._parameters)
        self._gate, self._begun = InnovationGate(self.config), False
        self._last: Accepted | None = None
        self.counts = {"accepted": 0, "rejected": 0, "restarted": 0, "learned_from": 0}
        self._state = "waiting"

    def set_enabled(self, enabled: bool) -> None:
        """Learn, or keep the parameters as they are."""
        self._enabled = bool(enabled)

    # -- one sample
    def step(self, sample: Sample) -> Estimate:
        """Take one sample as it was measured; what the seed knows to be wrong with it is taken out first."""
        sample = self._correct(sample)
        if self.uncorrectable(sample) or not usable(sample, self._ranges, self._needed):
            return self._rejected(sample, NAN, NAN)
        if self._last is None:
            return self._restart(sample) if self._begun else self._begin(sample)
        dt = sample.time - self._last.time
        if abs(dt) > self.config.max_gap or self._gate.exhausted:
            return self._restart(sample)
        if dt <= 0.0:
            return self._rejected(sample, NAN, NAN)
        return self._advance(self._last, sample, dt)

    def uncorrectable(self, sample: Sample) -> tuple[str, ...]:
        """In words, the seed's corrections that the latest sample is not rid of, for want of a channel or of a past."""
        return self._correct.left(sample.time)

    def _advance(self, last: Accepted, sample: Sample, dt: float) -> Estimate:
        """Look one step ahead; the sample is taken in only if the gate admits what it says."""
        mass, self._load.mass = self._load.mass, self._load.following(sample, dt)
        theta, now = self._parameters.theta(self._filter.phi), accepted(sample, self.crane)
        step, point = self._intervals.between(last, now, sample, theta, self._filter.load_torque)
        reason = self._resting(sample, step.stick)
        self._filter.predict_step(step, not reason, self._load_is_known)
        innovation, variance = self._filter.innovation(sample.motor_speed)
        if not self._gate.admits(sample.time, innovation, variance):
            self._load.mass = mass
            return self._rejected(sample, innovation, variance, step.friction)
        self._filter.correct(innovation, variance, not reason, step.stick)
        self._friction.advance(point, theta, len(sample.groups), dt)
        if not reason:
            self._conflict.step(self._filter, dt)
        self._accept(now.after(last), dt, reason)
        if not step.stick:
            self._judge(innovation * innovation / variance, dt)
        return self._estimate(sample, True, innovation, variance, step.friction)

    def _judge(self, nis: float, dt: float) -> None:
        self.consistency.step(nis)
        self._filter.adapt(nis, dt)

    def _resting(self, sample: Sample, stick: bool) -> str:
        """Why learning rests at this step; empty when it does not."""
        if not self._enabled:
            return "disabled"
        if saturated(sample, self.crane, self.config):
            return "saturation"
        if stick:
            return "stick"
        if self._load.is_another(self._filter.load_torque, sample):
            return "another load"
        return "no excitation" if self._excitation.range < self.config.excitation_speed else ""

    def _accept(self, now: Accepted, dt: float, reason: str) -> None:
        self._last = now
        self._excitation.step(now.speed, dt)
        self._gate.accepted()
        self.counts["accepted"] += 1
        self.counts["learned_from"] += not reason
        self._state = reason or "learning"
        self._statuses.step(self._filter, bool(reason), dt)

    def _rejected(self, sample: Sample, innovation: float, variance: float, friction: float = NAN) -> Estimate:
        self._gate.rejected(innovation)
        self.counts["rejected"] += 1
        return self._estimate(sample, False, innovation, variance, friction)._replace(state="rejected")

    # -- beginning and gaps
    def _begin(self, sample: Sample) -> Estimate:
        """Take the load from the first sample: from the hook load, else from the balance with the seed's friction."""
        self._begun = True
        self._load.mass = self._load.following(sample, 0.0)
        if self._load.measured:
            self._filter.begin_load((self.config.load_std * self._load.shaft_torque(sample.wire_layer)) ** 2)
        elif not self._load_is_known:
            self._begin_load(sample)
        return self._restart(sample)

    def _begin_load(self, sample: Sample) -> None:
        """Take the load, beyond a measured one, from the balance of one sample, inertia apart."""
        drive, speed = sample_drive_torque(sample, self.crane), sample.motor_speed
        measured = self._load.shaft_torque(sample.wire_layer)
        point = self._intervals.point(sample, speed, speed, measured, self._filter.load_torque)
        friction = point, self._parameters.theta(self._filter.phi), len(sample.groups)
        torque, magnitude = self._friction.at(*friction)[0], self._friction.magnitude(*friction)
        variance = (self.config.load_std * drive) ** 2 + magnitude**2
        self._filter.begin_load(variance, drive - torque - measured)

    def _restart(self, sample: Sample) -> Estimate:
        """Take the speed as measured and keep everything else, after a gap, a jump of time or a run of rejections; but
        where that did not help, another load hangs there, whatever a load cell shows."""
        if self._gate.exhausted_again and not self._load_is_known:
            self._begin_load(sample)
            self._load.doubted = True
        self._filter.take_anew(fresh_motion(sample, self.crane, self.config, self._filter.speed_variance))
        self._friction.memory = None
        self._gate.restarted(sample.time)
        self._last = accepted(sample, self.crane)
        self.counts["restarted"] += 1
        self._state = "restarted"
        return self._estimate(sample, True, NAN, NAN, NAN)

    @property
    def _load_is_known(self) -> bool:
        """An electric drive without a hook load lifts nothing; its load torque is 0 and stays so."""
        return not self.crane.drive.hydraulic and not self._load.measured

    def _estimate(
        self, sample: Sample, accepted: bool, innovation: float, variance: float, friction: float
    ) -> Estimate:
        nis = innovation * innovation / variance if variance > 0.0 else NAN
        return Estimate(
            sample.time, accepted, self._state, innovation, variance, nis, self._filter.speed, self.drum_torque,
            friction,
        )  # fmt: skip

    # -- what is known
    @property
    def size(self) -> int:
        """Number of states of the filter."""
        return self._filter.size

    @property
    def drum_torque(self) -> float:
        """Estimated T_d in N m: the hook load's and what the balance adds to it."""
        measured = self._load.shaft_torque(self._last.layer if self._last else NAN)
        return self.crane.gear_ratio * (measured + self._filter.load_torque)

    @property
    def load_apart(self) -> float:
        """What the balance of torques adds to the measured load, as a share of it (`HangingLoad.share`)."""
        return self._load.share(self._filter.load_torque, self._last.layer if self._last else NAN)

    def model(self) -> FrictionModel:
        """The seed's terms with the learned values and covariance."""
        origin = {"crane": self.crane.name, "samples": self.counts["learned_from"]}
        return learned_model(self._parameters, self._filter.phi, self._filter.considered_covariance, **origin)

    def parameters(self) -> list[ParameterEstimate]:
        """Value, standard deviation and status of every parameter."""
        return parameter_estimates(self._parameters, self.model(), self._statuses.texts)

    def status(self) -> dict[str, float | str]:
        """State, counts and consistency for diagnostics."""
        return {
            "state": self._state,
            "enabled": self._enabled,
            "past_corrections": past_corrections(self._correct),
            "prior": self.assumed or "as the seed states it",
            "drum_torque": self.drum_torque,
            **in_use(self.config),
            "noise_factor": math.sqrt(self._filter.noise_factor),
            "nis_mean": self.consistency.last_mean,
            "nis_windows": self.consistency.windows,
            "nis_share_inside": self.consistency.share_inside,
            **self._conflict.status(),
            **self._filter.considered.status(),
            **self.counts,
        }

    def snapshot(self) -> dict[str, Any]:
        """What a checkpoint needs, in plain types; keyed by crane and seed."""
        x, covariance = self._filter.state
        widened = self._parameters.widened_names
        kept = Kept(x, covariance, self._filter.sensitivity, self._load.mass, self._statuses.levels, widened)
        return filter_state(self.crane, self.seed, kept)

    def restore(self, content: Mapping[str, Any]) -> None:
        """Go on from a `snapshot` of the same crane and seed; `InputError`, and nothing changed, for any other."""
        kept, counts = self._kept(content), self.counts
        self.reset()
        self.counts = counts
        self._parameters.widen_named(kept.widened)
        self._filter.state = (
            self._parameters.projected(kept.x[:, 0], kept.covariance, FIRST_PARAMETER)[:, None], kept.covariance,
        )  # fmt: skip
        self._filter.sensitivity[:] = kept.sensitivity
        self._load.mass = kept.mass
        self._statuses.levels = kept.levels
        self._begun = True

    def take_back(self, content: Mapping[str, Any]) -> None:
        """Know of the parameters what a `snapshot` says, and no more; the motion goes on. Raises as `restore`."""
        kept = self._kept(content)
        self._parameters.widen_only(kept.widened)
        self._filter.take_parameters(kept.x[:, 0], kept.covariance, kept.sensitivity)
        if not self._load_is_known:  # what it was found to be, with friction that is not believed any more
            load = self.drum_torque / self.crane.gear_ratio
            self._filter.begin_load((self.config.load_std * load) ** 2, self._filter.load_torque)
        self._conflict = SeedConflict(self.config, self._parameters)
        self._statuses.levels = kept.levels

    def _kept(self, content: Mapping[str, Any]) -> Kept:
        return restored_state(content, self.crane, self.seed, self._filter.size, len(self._filter.sensitivity))
