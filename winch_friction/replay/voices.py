"""The two services along a recording: what they say, sample by sample and in the silences."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from math import inf, isfinite

from winch_friction.compensation import Feedforward
from winch_friction.estimation import Estimate
from winch_friction.online.compensator import CompensatorService
from winch_friction.online.estimator import EstimatorService
from winch_friction.online.inputs import ServiceOptions
from winch_friction.online.intake import parse
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import Run
from winch_friction.physics.winch.crane import Crane
from winch_friction.records.bag_file import Message
from winch_friction.records.topics import TopicMap
from winch_friction.replay.compensator import FeedforwardRecord
from winch_friction.replay.estimator import EstimateRecord
from winch_friction.replay.settings import Phase, ReplaySettings

PAUSE = 1.0  # s without a sample between one phase of a recording and the next


@dataclass
class CompensatorVoice:
    """The compensator of each phase; `steps` are its answers to samples, `watchdog` what it said in silences."""

    crane: Crane
    seed: FrictionModel
    topics: TopicMap
    settings: ReplaySettings
    since: float = -inf  # s, the first stamp: what was over by then needs no correcting
    steps: FeedforwardRecord = field(default_factory=FeedforwardRecord)
    watchdog: FeedforwardRecord = field(default_factory=FeedforwardRecord)
    refused: list[str] = field(default_factory=list)
    lacked: Counter[str] = field(default_factory=Counter)  # samples without an input, or in a doubt, by its words

    def __post_init__(self) -> None:
        self._waiting = list(self.settings.phases)
        self._last_model: FrictionModel | None = None
        self._begin(self._waiting.pop(0))

    def _begin(self, phase: Phase) -> None:
        """A node configured anew: seed, settings, nothing held."""
        self._phase = phase
        options = ServiceOptions(self.settings.watchdog_timeout, self.settings.stamp_window, self.settings.model_delay)
        self.service = CompensatorService(
            self.crane, phase.seed or self.seed, self.topics, phase.config, options, since=self.since
        )
        self.service.refused_models = self.refused
        self.service.set_enabled(phase.enabled)
        if self._last_model is not None:  # latched: a node that begins afresh still gets it
            self.offer(self._last_model)

    def offer(self, model: FrictionModel) -> None:
        """A learned model has come."""
        self._last_model = model
        if self._phase.follow_models:
            self.service.offer(model)

    def offer_text(self, text: str, topic: str) -> None:
        """A text has come on the model topic; one that is no model is refused with its reason, as by the node."""
        try:
            self.offer(parse(text, topic))
        except InputError as error:
            self.refused.append(str(error))

    def take(self, each: Message, now: float) -> None:
        """One input message, at `now` s on the replay's clock."""
        for said in self.service.catch_up(now):
            self.watchdog.take(said)
        if self._waiting and self._begins(self._waiting[0], each.stamp):
            self._begin(self._waiting.pop(0))
        answer = self.service.take(each.source, each.message, each.receipt, now)
        if answer is not None:
            self._note(answer)

    def _begins(self, phase: Phase, stamp: float) -> bool:
        if phase.start == phase.start:
            return stamp >= phase.start
        last = self.service.inputs.last_stamp
        return isfinite(last) and stamp - last > PAUSE

    def take_rows(self, run: Run) -> Iterator[None]:
        """A run, one row at a step."""
        for sample in self.service.inputs.rows(run):
            self._note(self.service.answer(sample, sample.time))
            yield

    def _note(self, answer: Feedforward) -> None:
        self.steps.take(answer)
        self.lacked.update(self.service.law.lost)


@dataclass
class EstimatorVoice:
    """The estimator; its `record`, and the models that it would publish."""

    crane: Crane
    seed: FrictionModel
    topics: TopicMap
    settings: ReplaySettings
    since: float = -inf
    lacked: Counter[str] = field(default_factory=Counter)

    def __post_init__(self) -> None:
        options = ServiceOptions(self.settings.watchdog_timeout, self.settings.stamp_window)
        periods = {"model_period": self.settings.model_period, "max_age": self.settings.estimator_max_age}
        periods["since"] = self.since
        self.service = EstimatorService(self.crane, self.seed, self.topics, self.settings.estimator, options, **periods)
        self.record = EstimateRecord(self.service.law)

    def take(self, each: Message, now: float) -> FrictionModel | None:
        """One input message; the model that the node would have published after it."""
        if self.service.tick(now) is not None:
            self.record.skip()
        estimate = self.service.take(each.source, each.message, each.receipt, now)
        if estimate is None:
            return None
        self._note(estimate)
        return self.service.model_due(now)

    def take_rows(self, run: Run) -> Iterator[FrictionModel | None]:
        """A run, one row at a step; the model that the node would have published after each."""
        for sample in self.service.inputs.rows(run):
            self._note(self.service.learn(sample))
            yield self.service.model_due(sample.time)

    def _note(self, estimate: Estimate) -> None:
        self.record.take(estimate, bool(self.service.contradiction))
        self.lacked.update(filter(None, (*self.service.missing, self.service.contradiction)))
