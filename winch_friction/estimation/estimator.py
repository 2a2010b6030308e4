"""The online friction estimator: seeded offline, bounded around the seed, and open about what it does not know."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from winch_friction.estimation import prediction
from winch_friction.estimation.checkpoint import filter_state, restored_state
from winch_friction.estimation.config import EstimatorConfig
from winch_friction.estimation.consistency import Consistency, VarianceFactor
from winch_friction.estimation.drive import saturated, torque_variance, usable
from winch_friction.estimation.estimate import Estimate, ParameterEstimate
from winch_friction.estimation.excitation import Excitation
from winch_friction.estimation.friction import FrictionFunctions, mean_direction
from winch_friction.estimation.kalman import SpeedFilter
from winch_friction.estimation.load import HangingLoad
from winch_friction.estimation.parameters import ScaledParameters
from winch_friction.estimation.prediction import (
    DISTURBANCE,
    ENCODER,
    ENCODER_CHANGE,
    FIRST_PARAMETER,
    LOAD,
    LOAD_SPEED,
    SPEED,
    STRETCH,
    Step,
)
from winch_friction.estimation.status import ParameterStatus
from winch_friction.estimation.wire import wire_step
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import Sample
from winch_friction.physics.winch.crane import Crane
from winch_friction.physics.winch.operating_point import sample_operating_point
from winch_friction.physics.winch.torque_balance import sample_drive_torque

UNKNOWN_STRETCH = 1e-3  # m, of a wire whose past was not seen
UNKNOWN_LOAD_SPEED = 0.02  # m/s, of the load on it
RESTART_AFTER = 10  # rejections in a row that mean the filter was wrong, not the sensor
WIDE_GATE, WIDE_FOR = 3.0, 2.0  # the gate is so many times wider for so long, s, after it shut out a run of samples
NAN = math.nan


@dataclass(frozen=True, slots=True)
class _Accepted:
    """What is kept of the last accepted sample: time s, drive torque N m, measured speed rad/s, heave velocity m/s."""

    time: float
    drive: float
    speed: float
    heave: float


class FrictionEstimator:
    """Learns the friction parameters from speed and drive torque, one sample at a time; its time is the samples' time.

    An extended Kalman filter over [omega, wire stretch, load speed, load torque beyond the hook load, disturbance,
    encoder rounding (2), scaled parameters]; the drive torque of the measured pressures (or of an electric motor) is
    the input, the shaft speed the measurement. The direction of a step is the mean sign between its two speeds. The
    disturbance is a first-order Gauss-Markov torque: what no term explains is correlated in time (wire, sensor skew),
    and taken as white it would make the filter far too sure.

    Learning rests in stick, in saturation and without excitation; the parameters are then considered, not updated
    (Schmidt).
    A sample that is not finite, late, or beyond the innovation gate leaves the estimator exactly as it was.
    """

    def __init__(self, crane: Crane, seed_model: FrictionModel, config: EstimatorConfig | None = None) -> None:
        self.crane, self.seed = crane, seed_model
        self.config = config or EstimatorConfig()
        self._parameters = ScaledParameters(seed_model, self.config)
        self._enabled = True
        self.reset()

    def reset(self) -> None:
        """Back to the seed."""
        self._filter = SpeedFilter(prediction.measurement(FIRST_PARAMETER + self._parameters.size))
        self._filter.P = np.zeros_like(self._filter.P)
        self._filter.P[FIRST_PARAMETER:, FIRST_PARAMETER:] = self._parameters.prior
        self._friction = FrictionFunctions(self.seed)
        self._load = HangingLoad(self.crane, self.config.load_filter)
        self._excitation = Excitation(self.config.excitation_time)
        self.consistency = Consistency(self.config.nis_window)
        self._factor = VarianceFactor(self.config.adaptation_time)
        self._statuses = [ParameterStatus(self.config) for _ in self.seed.values]
        self._previous: _Accepted | None = None
        self._begun = False
        self._layer = NAN
        self._rejected_in_a_row = 0
        self._wide_until = -math.inf
        self.counts = {"accepted": 0, "rejected": 0, "restarted": 0, "learned_from": 0}
        self._state = "waiting"

    def set_enabled(self, enabled: bool) -> None:
        """Learn, or keep the parameters as they are."""
        self._enabled = bool(enabled)

    # -- one sample
    def step(self, sample: Sample) -> Estimate:
        """Take one sample."""
        if not usable(sample, self.crane):
            return self._rejected(sample, NAN, NAN)
        if self._previous is None:
            return self._restart(sample) if self._begun else self._begin(sample)
        dt = sample.time - self._previous.time
        if dt > self.config.max_gap or dt < -self.config.max_gap or self._rejected_in_a_row >= RESTART_AFTER:
            return self._restart(sample)
        if dt <= 0.0:
            return self._rejected(sample, NAN, NAN)
        return self._advance(sample, dt)

    def _advance(self, sample: Sample, dt: float) -> Estimate:
        kept = self._filter.x, self._filter.P, self._load.mass
        self._load.mass = self._load.following(sample, dt)
        step, point = self._step_to(sample, dt)
        reason = self._resting(sample, step)
        self._predict(step, learning=not reason)
        measured, noise = sample.motor_speed, self._speed_variance
        innovation, variance = self._filter.innovation(measured, noise)
        if not (variance > 0.0 and abs(innovation) <= self._gate(sample.time) * math.sqrt(variance)):
            self._filter.x, self._filter.P, self._load.mass = kept
            return self._rejected(sample, innovation, variance)
        self._correct(measured, noise, learning=not reason)
        self._friction.memory = self._friction.advanced(point, self._theta(), len(sample.groups), dt)
        self._accept(sample, dt, reason)
        nis = innovation * innovation / variance
        if not step.stick:
            self.consistency.step(nis)
            self._factor.step(nis, dt)
        return self._estimate(sample, True, innovation, variance, step.friction.torque)

    def _gate(self, time: float) -> float:
        """How many sigma an innovation may have.

        A seed far outside its own sigma is first blamed on the load and then, at the first reversal, contradicted by
        every
        sample of that direction. A gate that goes on rejecting them would learn one direction for good.
        """
        wide = self._wide_until - WIDE_FOR <= time <= self._wide_until
        return self.config.gate * (WIDE_GATE if wide else 1.0)

    def _step_to(self, sample: Sample, dt: float) -> tuple[Step, tuple[float, ...]]:
        """The step from the last accepted sample to this one, and its mean operating point."""
        last = self._previous
        assert last is not None
        layer = sample.wire_layer
        mean_speed = 0.5 * (last.speed + sample.motor_speed)
        point = self._operating_point(sample, mean_speed, last.speed)
        friction = self._friction.at(point, self._theta(), len(sample.groups))
        drive = 0.5 * (last.drive + sample_drive_torque(sample, self.crane))
        heave = 0.5 * (last.heave + _heave(sample))
        stick = min(abs(last.speed), abs(sample.motor_speed)) < self.config.stick_speed
        variance = torque_variance(sample, self.crane, self.config)
        length = sample.wire_out if math.isfinite(sample.wire_out) else self.config.wire_length
        wire = wire_step(self.crane, self._mass(layer), layer, max(1.0, length), self.config.wire_damping, dt)
        torque = drive - self._load.shaft_torque(layer)
        return Step(torque, variance, heave, dt, wire, friction, stick), point

    def _operating_point(self, sample: Sample, speed: float, before: float) -> tuple[float, ...]:
        drum_torque = self.crane.gear_ratio * self._load.shaft_torque(sample.wire_layer)
        if not self._load.measured:
            drum_torque = self.drum_torque
        point = sample_operating_point(sample, self.crane, drum_torque=drum_torque, speed=speed)
        magnitude = 0.5 * (abs(before) + abs(sample.motor_speed))
        return (mean_direction(before, sample.motor_speed), magnitude, *point[2:])

    def _predict(self, step: Step, learning: bool) -> None:
        x, covariance = self._filter.x, self._filter.P
        noise = prediction.process_noise(len(x), step, self.config, self._factor.value, self._load_is_known)
        if learning:
            forgotten = prediction.forgotten(covariance, step.duration, self.config, self._parameters.prior)
            noise[FIRST_PARAMETER:, FIRST_PARAMETER:] = forgotten
        transition = prediction.jacobian(len(x), step, self.config, self._parameters)
        self._filter.predict_with(prediction.propagate(x, step, self.config), transition, noise)

    def _correct(self, measured: float, noise: float, learning: bool) -> None:
        self._filter.correct(measured, noise, considered=0 if learning else self._parameters.size)
        self._filter.P = 0.5 * (self._filter.P + self._filter.P.T)
        if learning:
            self._filter.x = self._parameters.projected(self._filter.x, self._filter.P)

    def _resting(self, sample: Sample, step: Step) -> str:
        """Why learning rests at this step; empty when it does not."""
        if not self._enabled:
            return "disabled"
        if saturated(sample, self.crane, self.config):
            return "saturation"
        if step.stick:
            return "stick"
        return "no excitation" if self._excitation.range < self.config.excitation_speed else ""

    def _accept(self, sample: Sample, dt: float, reason: str) -> None:
        self._previous = self._kept(sample)
        self._excitation.step(sample.motor_speed, dt)
        self._rejected_in_a_row = 0
        self.counts["accepted"] += 1
        self.counts["learned_from"] += not reason
        self._state = reason or "learning"
        self._judge(dt, frozen=bool(reason))

    def _judge(self, dt: float, frozen: bool) -> None:
        shares = np.sqrt(np.diag(self._filter.P)[FIRST_PARAMETER:] / np.diag(self._parameters.prior))
        limits = self._parameters.at_limit(self._filter.x[FIRST_PARAMETER:, 0])
        for index, share, limit in zip(self._parameters.free, shares, limits, strict=True):
            self._statuses[index].step(float(share), frozen, bool(limit), dt)

    # -- beginning, gaps and rejections
    def _begin(self, sample: Sample) -> Estimate:
        """Take the load from the first sample: from the hook load, else from the balance with the seed's friction."""
        self._begun = True
        self._load.mass = self._load.following(sample, 0.0)
        drive = sample_drive_torque(sample, self.crane)
        point = self._operating_point(sample, sample.motor_speed, sample.motor_speed)
        friction = self._friction.at(point, self._theta(), len(sample.groups))
        covariance = self._filter.P
        if self._load.measured:
            covariance[LOAD, LOAD] = (self.config.load_std * self._load.shaft_torque(sample.wire_layer)) ** 2
        elif not self._load_is_known:
            self._filter.x[LOAD, 0] = drive - friction.torque
            covariance[LOAD, LOAD] = (self.config.load_std * drive) ** 2 + friction.magnitude**2
        return self._restart(sample)

    def _restart(self, sample: Sample) -> Estimate:
        """Take the speed as measured and keep everything else, after a gap, a jump of time or a run of rejections."""
        x, covariance = self._filter.x.copy(), self._filter.P.copy()
        for state, value, variance in self._fresh_motion(sample):
            covariance[state, :] = covariance[:, state] = 0.0
            covariance[state, state] = variance
            x[state, 0] = value
        self._filter.x, self._filter.P = x, covariance
        self._friction.memory = None
        if self._rejected_in_a_row >= RESTART_AFTER:
            self._wide_until = sample.time + WIDE_FOR
        self._previous = self._kept(sample)
        self._rejected_in_a_row = 0
        self.counts["restarted"] += 1
        self._state = "restarted"
        return self._estimate(sample, True, NAN, NAN, NAN)

    def _fresh_motion(self, sample: Sample) -> list[tuple[int, float, float]]:
        """State, value and variance of everything that moves, with the load following the wire."""
        r = self.crane.drum.radius(sample.wire_layer) / self.crane.gear_ratio
        speed = sample.motor_speed
        variance = self._speed_variance + 2.0 * prediction.rounding_variance(self.config)
        return [
            (SPEED, speed, variance),
            (STRETCH, 0.0, UNKNOWN_STRETCH**2),
            (LOAD_SPEED, _heave(sample) + r * speed, r * r * variance + UNKNOWN_LOAD_SPEED**2),
            (DISTURBANCE, 0.0, self.config.disturbance_std**2),
            (ENCODER, 0.0, prediction.rounding_variance(self.config)),
            (ENCODER_CHANGE, 0.0, 0.0),
        ]

    def _rejected(self, sample: Sample, innovation: float, variance: float) -> Estimate:
        self._rejected_in_a_row += math.isfinite(innovation)
        self.counts["rejected"] += 1
        return replace(self._estimate(sample, False, innovation, variance, NAN), state="rejected")

    def _kept(self, sample: Sample) -> _Accepted:
        self._layer = sample.wire_layer
        drive = sample_drive_torque(sample, self.crane)
        return _Accepted(sample.time, drive, sample.motor_speed, _heave(sample))

    # -- small quantities
    @property
    def _load_is_known(self) -> bool:
        """An electric drive without a hook load lifts nothing; its load torque is 0 and stays so."""
        return self.crane.electric and not self._load.measured

    def _mass(self, layer: float) -> float:
        return self._load.mass_by(float(self._filter.x[LOAD, 0]), layer)

    @property
    def _speed_variance(self) -> float:
        return self._factor.value * self.config.speed_noise**2

    def _theta(self) -> list[float]:
        return self._parameters.values(self._filter.x[FIRST_PARAMETER:, 0]).tolist()

    def _estimate(
        self, sample: Sample, accepted: bool, innovation: float, variance: float, friction: float
    ) -> Estimate:
        return Estimate(
            time=sample.time,
            accepted=accepted,
            state=self._state,
            innovation=innovation,
            innovation_variance=variance,
            nis=innovation * innovation / variance if variance > 0.0 else NAN,
            speed=float(self._filter.x[SPEED, 0]),
            drum_torque=self.drum_torque,
            friction_torque=friction,
        )

    # -- what is known
    @property
    def drum_torque(self) -> float:
        """Estimated T_d in N m: the hook load's and what the balance adds to it."""
        measured = self._load.shaft_torque(self._layer)
        return self.crane.gear_ratio * (measured + float(self._filter.x[LOAD, 0]))

    def model(self) -> FrictionModel:
        """The seed's terms with the learned values and covariance."""
        covariance = self._parameters.covariance(self._filter.P[FIRST_PARAMETER:, FIRST_PARAMETER:])
        provenance = {
            "method": "online estimate (extended Kalman filter)",
            "seed": self.seed.name,
            "crane": self.crane.name,
            "samples": self.counts["learned_from"],
        }
        return replace(self.seed, values=tuple(self._theta()), covariance=covariance, provenance=provenance)

    def parameters(self) -> list[ParameterEstimate]:
        """Value, standard deviation and status of every parameter."""
        model = self.model()
        seed_std = np.sqrt(np.diag(self._parameters.covariance(self._parameters.prior)))
        return [
            ParameterEstimate(
                p.name, p.unit, model.values[k], float(model.std[k]), self.seed.values[k], float(seed_std[k]), s.text
            )
            for k, (p, s) in enumerate(zip(self.seed.parameters, self._statuses, strict=True))
        ]

    def status(self) -> dict[str, float | str]:
        """State, counts and consistency for diagnostics."""
        return {
            "state": self._state,
            "enabled": self._enabled,
            "drum_torque": self.drum_torque,
            "noise_factor": math.sqrt(self._factor.value),
            "nis_mean": self.consistency.last_mean,
            "nis_windows": self.consistency.windows,
            "nis_share_inside": self.consistency.share_inside,
            **self.counts,
        }

    def snapshot(self) -> dict[str, Any]:
        """What a checkpoint needs, in plain types; keyed by crane and seed."""
        levels = [status.level for status in self._statuses]
        return filter_state(self.crane, self.seed, self._filter.x, self._filter.P, self._load.mass, levels)

    def restore(self, content: Mapping[str, Any]) -> None:
        """Go on from a `snapshot` of the same crane and seed; raises `InputError`, and changes nothing, for any
        other."""
        x, covariance, mass, levels = restored_state(content, self.crane, self.seed, self._filter.dim_x)
        counts = self.counts
        self.reset()
        self.counts = counts
        self._filter.x = self._parameters.projected(x, covariance)
        self._filter.P = covariance
        self._load.mass = mass
        for status, level in zip(self._statuses, levels, strict=True):
            status.level = level
        self._begun = True


def _heave(sample: Sample) -> float:
    """Velocity of the crane tip, m/s; a crane that does not say stands still."""
    return sample.heave_velocity if math.isfinite(sample.heave_velocity) else 0.0
