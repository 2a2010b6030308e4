"""The estimator as a service: what the node and the replay share. It knows no ROS; it is told what time it is."""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from winch_friction.compensation.safe_output import AGAINST_SPEED
from winch_friction.estimation import Estimate, EstimatorConfig, FrictionEstimator
from winch_friction.estimation.answers import ParameterEstimate
from winch_friction.estimation.interval import FrictionFunctions
from winch_friction.estimation.sample import absent
from winch_friction.online.agreement import Agreement, DriveByItself
from winch_friction.online.before_doubt import WIRE_UNSEEN, BeforeDoubt
from winch_friction.online.compensator import LEARNED_AT
from winch_friction.online.doubt import FORGOTTEN, LoadAgainstDrive, StandingReadings, WireAgainstSpeed, span
from winch_friction.online.inertia_balance import InertiaBalance
from winch_friction.online.inputs import InputGate, ServiceOptions
from winch_friction.online.load_balance import LoadBalance
from winch_friction.online.torque_step import TorqueStep
from winch_friction.physics.channels import SLOW_INPUTS
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.friction.term import needed
from winch_friction.physics.signals import ASSUMED, LOST, Sample
from winch_friction.physics.winch.crane import Crane, sample_load
from winch_friction.physics.winch.operating_point import sample_operating_point
from winch_friction.records.sample_stream import InputHold
from winch_friction.records.topics import Input, TopicMap

LONGEST_LEAD = 0.4  # s that a command may be ahead of the speed: a slow pump; a longer patience costs nothing
FASTEST_MODELS = 1.0  # s of the service's clock between two models, whatever the stamps say


class EstimatorService:
    """Messages, or rows of a run, in; estimates and, now and then, a learned model out.

    While the measured load contradicts the balance of torques, or the drive's torque has changed its gain, nothing is
    learned, the seed is published in the place of what was, and every parameter that was learned is invalid. What was
    learned while that came to light is taken back, and neither published nor kept meanwhile (`BeforeDoubt`).
    """

    def __init__(
        self, crane: Crane, seed: FrictionModel, topics: TopicMap, config: EstimatorConfig | None = None,
        options: ServiceOptions | None = None, *, model_period: float = 5.0, max_age: float = 0.1,
        since: float = -math.inf,
    ) -> None:  # fmt: skip
        self.options, self.model_period = options or ServiceOptions(), model_period
        self.law, self._needed = FrictionEstimator(crane, seed, config, since), needed(seed.terms)
        hold = InputHold(topics.groups, max_age, dict(SLOW_INPUTS))
        self.inputs = InputGate(crane, topics, hold, self.options, self._jumped)
        self.last: Estimate | None = None
        self.missing: tuple[str, ...] = ()
        self.contradiction = self._slow = ""  # what is said, and what of it only time shows
        self._watch_loads()
        self._enabled, self._seen = True, math.nan
        self._stands = False  # a torque was said, and nothing after it
        self._seed_friction = FrictionFunctions(self.law.seed)
        self._gain = InertiaBalance(self.law.crane, self._expected)
        self._before = BeforeDoubt(self.law)
        self._published, self._published_at = -math.inf, -math.inf

    def _watch_loads(self) -> None:
        crane = self.law.crane
        self._balance = LoadBalance(AGAINST_SPEED * crane.speed_scale)
        self._load = LoadAgainstDrive(crane, self.inputs.ranges)
        self._still = StandingReadings(AGAINST_SPEED * crane.speed_scale)
        self._wire = WireAgainstSpeed(crane, self.inputs.ranges)
        self._drive = DriveByItself(crane, self.inputs.ranges)
        self._steps = TorqueStep(crane, self.inputs.ranges)
        self._command = Agreement(crane, self.inputs.ranges, LONGEST_LEAD, calm=FORGOTTEN)
        self._taken_back = -math.inf  # s, of the doubt that stands

    def take(
        self, source: Input, message: Any, receipt: float, now: float, sent: float | None = None
    ) -> Estimate | None:
        """One message; an estimate to each speed that may be believed."""
        sample = self.inputs.take(source, message, receipt, now, sent)
        return None if sample is None else self.learn(sample)

    def take_row(self, sample: Sample, now: float | None = None) -> Estimate:
        """One row of a run, as if all its values had come at once."""
        return self.learn(self.inputs.fill(sample, now))

    def learn(self, sample: Sample) -> Estimate:
        """What a sample of `inputs` tells."""
        self.last = self.law.step(sample)
        self.missing = (
            *self.law.crane.drive.lacking(sample),
            *absent(sample, self.inputs.ranges, self._needed),
            *(name for name in ASSUMED if getattr(sample, name) == LOST),
            *self.law.uncorrectable(sample),
        )
        self._stands = math.isfinite(self.last.friction_torque)
        self._doubt(sample, self.last)
        return self.last

    def valid(self, estimate: Estimate) -> bool:
        """Whether the torque of what was said last may be believed: it shows friction, its sample was taken in, and
        no inputs contradict each other. One of pressures in bar, or of what a wrong load cell taught, may not."""
        return estimate.valid and not self.contradiction

    def tick(self, now: float) -> Estimate | None:
        """What is said once in every silence: that no friction is known. The torque before it would stand, whoever
        plots it or feeds it forward, of one direction through every wave."""
        return self.ending() if self.inputs.silence(now) > self.options.watchdog_timeout else None

    def ending(self) -> Estimate | None:
        """The same at the end, without a silence; None where no torque stands."""
        if self.last is None or not self._stands:
            return None
        self._stands = False
        return Estimate(self.last.time, False, "waiting", *[math.nan] * 6)

    def _doubt(self, sample: Sample, learned: Estimate) -> None:
        """A load that is far off is seen without the filter, which would take in none of its samples; and so is a gain
        that changed, which makes the filter reject what tells it."""
        passed = span(self._seen, sample.time)
        watches = self._load, self._still, self._wire, self._drive, self._steps
        watched = [each.contradiction(sample, passed) for each in watches]
        beside = self._command.beside(sample, passed)
        lost = next(filter(None, (*watched, *beside)), "")
        self._seen = sample.time
        gain = ""
        if learned.accepted or math.isfinite(learned.innovation):
            gain = self._gain.contradiction(sample)
        if learned.accepted:
            self._slow = self._balance.contradiction(self.law.load_apart, sample) or gain
        self.contradiction = lost or self._slow
        self._take_back(
            math.inf if self._gain.from_the_beginning else WIRE_UNSEEN if watched[2] or watched[4] or beside else 0.0
        )
        self._before.step(sample.time, self._pending)
        self.law.set_enabled(self._enabled and not self.contradiction)

    def _take_back(self, seconds: float) -> None:
        """Forget what a doubt that stands has taught: of the last `seconds` s besides what was doubted already. Once a
        doubt, and once more where another joins it that takes longer to show."""
        if not self.contradiction:
            if self._taken_back >= 0.0:  # the load that was found meanwhile is of what was wrong
                self.law.take_back(self._before.believed.content)
            self._taken_back = -math.inf
        elif seconds > self._taken_back:
            self._taken_back = seconds
            self._before.go_back(seconds)
            self.law.take_back(self._before.believed.content)

    def _expected(self, sample: Sample, speed: float) -> float:
        """The seed's friction of a sample at a speed, rad/s, in N m."""
        load = self.law.crane.drum_torque(sample_load(sample), sample.wire_layer)
        point = sample_operating_point(sample, self.law.crane, drum_torque=load, speed=speed)
        return self._seed_friction.torque(point, self.law.seed.values, len(sample.groups))

    @property
    def _pending(self) -> bool:
        """Whether a doubt stands, or may come to."""
        return bool(self.contradiction) or any(
            each.pending for each in (self._load, self._drive, self._balance, self._gain)
        )

    def model_due(self, now: float) -> FrictionModel | None:
        """The learned model when it is time to publish it: every `model_period` s of the samples, and no faster than
        every `FASTEST_MODELS` s of `now`."""
        if self.last is None or self.last.time < self._published + self.model_period:
            return None
        if self.options.paced and now < self._published_at + FASTEST_MODELS:
            return None
        self._published, self._published_at = self.last.time, now
        if self.contradiction:
            learned = self.law.seed
        else:
            learned = self._before.believed.model if self._pending else self.law.model()
        return replace(learned, provenance={**learned.provenance, LEARNED_AT: self.last.time})

    def set_enabled(self, enabled: bool) -> None:
        """Learn or rest."""
        self._enabled = bool(enabled)
        self.law.set_enabled(self._enabled and not self.contradiction)

    def reset(self) -> None:
        """Back to the seed: everything learned is forgotten."""
        self.law.reset()
        self.contradiction = self._slow = ""
        self._watch_loads()
        self._gain.forget()
        self.law.set_enabled(self._enabled)
        self._before.begin()
        self.forget()

    def snapshot(self) -> Mapping[str, Any]:
        """What a checkpoint needs: what is known, or was before a doubt that stands or may come to."""
        return self._before.believed.content if self._pending else self.law.snapshot()

    def restore(self, content: Mapping[str, Any]) -> None:
        """Go on from a `snapshot` of the same crane and seed; raises `InputError`, and changes nothing, for any
        other."""
        self.law.restore(content)
        self._before.begin()

    def forget(self) -> None:
        """After a jump of time: nothing held; the filter restarts its speed by itself and keeps what it learned."""
        self.inputs.forget()
        self._jumped()

    def _jumped(self) -> None:
        self._published = -math.inf
        self._gain.set_clock()

    def status(self, now: float) -> dict[str, Any]:
        """The filter's state and counts, told true: without an input nothing is learned, whatever was said last."""
        status = dict(self.law.status()) | {"rejection": ""}
        silent = self.last is None or self.inputs.silence(now) > self.options.watchdog_timeout
        if silent or self.missing:
            status["state"] = "waiting"
        elif self.contradiction:
            status["state"] = "contradicted"
        elif self.last is not None and not self.last.accepted:
            status["state"], status["rejection"] = "rejected", self._rejection(self.last)
        status["missing"] = self.inputs.without_speed(now) if silent else ", ".join(self.missing)
        status["contradictions"] = self.contradiction
        status["enabled"], status["load_apart"] = self._enabled, self.law.load_apart
        status["suspicion"] = "; ".join(filter(None, (self._balance.suspicion, str(status["lateness"]))))
        return status

    def _rejection(self, last: Estimate) -> str:
        """Why a sample with all its inputs was not taken in, in words."""
        if not math.isfinite(last.innovation):
            return "stamp not after that of the last sample"
        return f"motor_speed is more than {self.law.config.gate:g} sigma from what the drive torque makes of it"

    @property
    def gain_change(self) -> float:
        """By how much the gain of the drive's torque has changed since the beginning, relative; NaN unknown."""
        return self._gain.change

    def parameters(self) -> list[ParameterEstimate]:
        """What is known of every parameter; what was learned from inputs that contradict each other is invalid."""
        known = self.law.parameters()
        return [replace(p, status="invalid") if self.contradiction and p.status != "seed" else p for p in known]
