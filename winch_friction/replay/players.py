"""The two nodes without ROS: their holds, their schedule of models, their restarts."""

from collections.abc import Iterator
from dataclasses import replace
from math import isfinite

from winch_friction.compensation import Feedforward, FeedforwardCompensator
from winch_friction.compensation.model_schedule import LEARNED_AT, ModelSchedule
from winch_friction.estimation import FrictionEstimator
from winch_friction.physics.channels import SLOW_INPUTS
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.hold import InputHold
from winch_friction.physics.signals import Run, Sample
from winch_friction.physics.winch.crane import Crane
from winch_friction.records.bag_file import Message
from winch_friction.records.sample_stream import SampleStream
from winch_friction.records.topics import TopicMap
from winch_friction.replay.estimator import EstimateRecord
from winch_friction.replay.settings import Phase, ReplaySettings

PAUSE = 1.0  # s without a sample between one phase of a recording and the next


class CompensatorPlayer:
    """The compensator node: messages or samples in, `steps` out."""

    def __init__(self, crane: Crane, seed: FrictionModel, topics: TopicMap, settings: ReplaySettings) -> None:
        self._crane, self._seed, self._topics = crane, seed, topics
        self._waiting = list(settings.phases)
        self._schedule = ModelSchedule(settings.model_delay)
        self._last_model: FrictionModel | None = None
        self.steps: list[Feedforward] = []
        self.refused: list[str] = []
        self._begin(self._waiting.pop(0))

    def _begin(self, phase: Phase) -> None:
        """A node configured anew: seed, settings, nothing held."""
        self._phase = phase
        self.law = FeedforwardCompensator(self._crane, phase.seed or self._seed, phase.config)
        self.law.set_enabled(phase.enabled)
        self.hold = InputHold(self._topics.groups, phase.config.max_age, dict(phase.config.max_ages))
        self._stream = SampleStream(self._topics, self.hold, self._restart)
        self._schedule.clear()
        if self._last_model is not None:  # latched: a node that begins afresh still gets it
            self.offer(self._last_model)

    def _restart(self) -> None:
        self._schedule.clear()
        self.law.reset()

    def offer(self, model: FrictionModel) -> None:
        """A learned model has come."""
        self._last_model = model
        if self._phase.follow_models:
            self._schedule.offer(model)

    def take(self, each: Message) -> None:
        """One input message."""
        if self._waiting and self._begins(self._waiting[0], each.stamp):
            self._begin(self._waiting.pop(0))
        sample = self._stream.take(each.source, each.message, each.receipt)
        if sample is not None:
            self.step(sample)

    def _begins(self, phase: Phase, stamp: float) -> bool:
        if phase.start == phase.start:
            return stamp >= phase.start
        last = self._stream.last_stamp
        return isfinite(last) and stamp - last > PAUSE

    def step(self, sample: Sample) -> None:
        """One sample."""
        self._take_over(self._schedule.due(sample.time))
        self.steps.append(self.law.step(sample))

    def _take_over(self, model: FrictionModel | None) -> None:
        try:
            if model is not None:
                self.law.load_model(model)
        except InputError as error:
            self.refused.append(str(error))


class EstimatorPlayer:
    """The estimator node: messages or samples in, its `record` and the models it would publish out."""

    def __init__(self, crane: Crane, seed: FrictionModel, topics: TopicMap, settings: ReplaySettings) -> None:
        self.law = FrictionEstimator(crane, seed, settings.estimator)
        self.hold = InputHold(topics.groups, settings.estimator_max_age, dict(SLOW_INPUTS))
        self._stream = SampleStream(topics, self.hold, self._restart)
        self._period = settings.model_period
        self._published_at = float("-inf")
        self.record = EstimateRecord(self.law)

    def _restart(self) -> None:
        self._published_at = float("-inf")

    def take(self, each: Message) -> FrictionModel | None:
        """One input message; the model that the node would have published after it."""
        sample = self._stream.take(each.source, each.message, each.receipt)
        return None if sample is None else self.step(sample)

    def step(self, sample: Sample) -> FrictionModel | None:
        """One sample; the model that the node would have published after it."""
        self.record.take(self.law.step(sample))
        if sample.time < self._published_at + self._period:
            return None
        self._published_at = sample.time
        learned = self.law.model()
        return replace(learned, provenance={**learned.provenance, LEARNED_AT: sample.time})


def held_samples(
    run: Run, compensator: CompensatorPlayer, estimator: EstimatorPlayer
) -> Iterator[tuple[Sample, Sample]]:
    """A run's samples as each of the two nodes would hold them."""
    return zip(compensator.hold.samples(run), estimator.hold.samples(run), strict=True)
