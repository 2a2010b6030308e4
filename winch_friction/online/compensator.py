"""The compensator as a service: what the node and the replay share. It knows no ROS; it is told what time it is.

A model that was learned elsewhere takes effect at a sample that a replay finds again. The validity and the number of a
torque travel in `header.frame_id`, `valid 1234` or `invalid 1235`: fields of the standard message that
carry no measurement.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from winch_friction.compensation import CompensatorConfig, Feedforward, FeedforwardCompensator
from winch_friction.online.agreement import Agreement
from winch_friction.online.inputs import InputGate, ServiceOptions
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import Sample
from winch_friction.physics.winch.crane import Crane
from winch_friction.records.sample_stream import InputHold
from winch_friction.records.topics import Input, TopicMap

# -- when a learned model takes effect
LEARNED_AT = "learned_at"  # provenance key: stamp in s of the last measurement behind the model
MOST_WAITING = 100  # models; one a second and a delay of a minute leave 60, dates of a time to come would pile up


@dataclass
class ModelSchedule:
    """Holds models back until `delay` s after the measurement they were learned from.

    A model travels from estimator to compensator in its own time, and one sample earlier or later is another output.
    Within the delay the journey does not matter. A model without a date takes effect at once.
    """

    delay: float = 0.5  # s
    _waiting: list[tuple[float, FrictionModel]] = field(default_factory=list)

    def offer(self, model: FrictionModel) -> None:
        """Take a model in; `InputError` when its date is no time. Of too many, those furthest ahead go."""
        due = _learned_at(model) + self.delay
        self._waiting = sorted([*self._waiting, (due, model)], key=lambda each: each[0])[:MOST_WAITING]

    def due(self, time: float) -> FrictionModel | None:
        """The newest model that takes effect by `time` s; older ones are dropped with it."""
        ready = [model for due, model in self._waiting if due <= time]
        self._waiting = self._waiting[len(ready) :]
        return ready[-1] if ready else None

    def clear(self) -> None:
        """Forget what is waiting, after a jump of time."""
        self._waiting = []


def _learned_at(model: FrictionModel) -> float:
    """The stamp in s that a model is dated by; it comes as text of unknown origin."""
    found = model.provenance.get(LEARNED_AT, -math.inf)
    try:
        date = float(found)
    except (TypeError, ValueError, OverflowError):
        date = math.nan
    if not date < math.inf:
        raise InputError(f"model '{model.name}': {LEARNED_AT} must be a time in s, found {str(found)[:40]!r}")
    return date


def other_terms(model: FrictionModel, beside: FrictionModel) -> str:
    """Which terms and corrections of another model a model lacks, and which it has besides, in words; '' for none."""
    own, others = ({*each.term_names, *(one.name for one in each.corrections)} for each in (model, beside))
    differences = {"lacks": others - own, "has besides": own - others}
    return " and ".join(f"it {words} {', '.join(sorted(names))}" for words, names in differences.items() if names)


def refuse_other_terms(learned: FrictionModel, given: FrictionModel) -> None:
    """Raise `InputError` for a learned model that has other terms or corrections than the one that was given.

    An estimator learns values, never terms. One that was started on another model would take terms away, which is more
    than any range around the seed allows, and would undo a repaired model that was loaded meanwhile.
    """
    if said := other_terms(learned, given):
        raise InputError(
            f"model '{learned.name}' was learned of another one than '{given.name}': {said}; "
            f"start the estimator on the model_file of '{given.name}'"
        )


# -- the service
HEARTBEAT = 25  # steps of the watchdog between two zeros, once the ramp is over


@dataclass
class _Silence:
    """The watchdog's ramp: the stamp that it begins at and how many steps were published since."""

    begin: float = math.nan  # s; an age limit that is set meanwhile does not move it
    steps: int = 0


class CompensatorService:
    """Messages, or rows of a run, in; what is to be published out.

    Every method that may publish returns a `Feedforward` or None. `now` is a clock in s that only goes forward: the
    steady one live, that of the recording in a replay. `since` s is the stamps' clock at the beginning, if known.
    """

    def __init__(
        self, crane: Crane, seed: FrictionModel, topics: TopicMap, config: CompensatorConfig | None = None,
        options: ServiceOptions | None = None, *, since: float = -math.inf,
    ) -> None:  # fmt: skip
        self.options = options or ServiceOptions()
        self.law = FeedforwardCompensator(crane, seed, config, since)
        self.schedule = ModelSchedule(self.options.model_delay)
        hold = InputHold(topics.groups, self.law.config.max_age, dict(self.law.config.max_ages))
        self.inputs = InputGate(crane, topics, hold, self.options, self._jumped)
        self._agreement = Agreement(crane, self.inputs.ranges, self.law.config.lead, self.law.config.load)
        self._silence, self._last_stamp = _Silence(), math.nan
        self.contradictions: tuple[str, ...] = ()
        self._given = seed  # by whoever runs the node: what is learned is learned of its terms
        self.refused_models: list[str] = []
        self.refusal = ""  # of the last learned model; empty once one is taken over

    # -- what comes in
    def take(
        self, source: Input, message: Any, receipt: float, now: float, sent: float | None = None
    ) -> Feedforward | None:
        """One message; an answer to each speed that may be believed."""
        sample = self.inputs.take(source, message, receipt, now, sent)
        return None if sample is None else self.answer(sample, now)

    def take_row(self, sample: Sample, now: float | None = None) -> Feedforward:
        """One row of a run, as if all its values had come at once."""
        return self.answer(self.inputs.fill(sample, now), sample.time if now is None else now)

    def answer(self, sample: Sample, now: float) -> Feedforward:
        """The answer to a sample of `inputs`."""
        self._take_over(self.schedule.due(sample.time))
        self.contradictions = self._agreement.contradictions(sample, now if self.options.paced else math.nan)
        self._silence = _Silence(sample.time + self.law.config.max_age)
        self._last_stamp = sample.time
        asked = self.inputs.stamp("speed_reference", sample.time)
        return self.law.step(sample, now if self.options.paced else None, self.contradictions, asked)

    # -- silence
    def tick(self, now: float) -> Feedforward | None:
        """What the watchdog publishes at `now`: the ramp to zero, on a grid of stamps that a replay finds again."""
        steps = self._due_steps(now)
        return self._watch(steps) if steps > self._silence.steps else None

    def catch_up(self, now: float) -> Iterator[Feedforward]:
        """Everything that a watchdog that never slept would have published until `now`."""
        due = self._due_steps(now)
        while self._silence.steps < due and not (self.law.output.at_rest and self._silence.steps > 0):
            published = self._watch(self._silence.steps + 1)
            if published is not None:
                yield published

    def _due_steps(self, now: float) -> int:
        if not math.isfinite(self._last_stamp):
            return 0
        over = self.inputs.silence(now) - self.options.watchdog_timeout
        return math.floor(over / self.options.watch_period) if over > 0.0 else 0

    def _watch(self, steps: int) -> Feedforward | None:
        rested = self.law.output.at_rest and self._silence.steps > 0
        if rested and steps // HEARTBEAT == self._silence.steps // HEARTBEAT:
            return None
        self._silence.steps = steps
        stamp = self._silence.begin + (steps - 0.5) * self.options.watch_period
        return self.law.decay(stamp) if stamp > self.law.output.time else None

    # -- models and settings
    def offer(self, model: FrictionModel) -> None:
        """A learned model, to be taken over at its time; one that is dated by no time is refused."""
        try:
            self.schedule.offer(model)
        except InputError as error:
            self.refuse(str(error))

    def load_model(self, model: FrictionModel) -> str:
        """Use a model from the next sample on, without a bump; `InputError` keeps the one in use. Returns in words in
        which terms it differs from that one: the motors' model alone takes a third of the torque away."""
        before = self.law.model
        self.law.load_model(model)
        self._given, self.refusal = model, ""
        return (apart := other_terms(model, before)) and f"beside '{before.name}' {apart}"

    def refuse(self, reason: str) -> None:
        """A learned model was refused, here or by whoever read it."""
        self.refused_models.append(reason)
        self.refusal = reason

    def _take_over(self, model: FrictionModel | None) -> None:
        if model is None:
            return
        try:
            refuse_other_terms(model, self._given)
            self.law.load_model(model)
            self.refusal = ""
        except InputError as error:
            self.refuse(str(error))

    def set_enabled(self, enabled: bool) -> None:
        """Fade in or out from the next sample on."""
        self.law.set_enabled(enabled)

    def configure(self, config: CompensatorConfig, options: ServiceOptions | None = None) -> None:
        """Other settings from the next sample on, without a bump. Raises `InputError`, and changes nothing, for gains
        for unknown terms."""
        self.law.configure(config)
        self.options = options or self.options
        self.schedule.delay = self.options.model_delay
        self._agreement.lead, self._agreement.load = config.lead, config.load
        hold = self.inputs.hold
        hold.max_age, hold.max_ages = config.max_age, dict(config.max_ages)

    # -- beginnings and ends
    def reset(self) -> None:
        """Begin anew: nothing held, nothing remembered, the model kept; what is published goes on from where it is."""
        self.inputs.forget()
        self._jumped()

    def _jumped(self) -> None:
        self.schedule.clear()
        self._agreement.forget()
        self.law.reset()

    def ending(self, now: float) -> Iterator[tuple[float, Feedforward]]:
        """The last ramp as (seconds after `now`, what is to be published then); empty when nothing is published."""
        output, period = self.law.output, self.options.watch_period
        if output.at_rest or not math.isfinite(output.time):
            return
        begin = max(output.time, self._last_stamp + min(self.inputs.silence(now), self.law.config.max_age))
        output.end(begin)
        steps = 0
        while not output.at_rest:
            steps += 1
            yield steps * period, self.law.decay(begin + steps * period, "ending")

    # -- health
    def status(self, now: float) -> dict[str, Any]:
        """The law's state and counts, told true: a silence is stale, whatever the law last said."""
        status = dict(self.law.status())
        if not math.isfinite(self._last_stamp):
            status["missing"] = self.inputs.without_speed(now)
        elif self.inputs.silence(now) > self.options.watchdog_timeout:
            status["state"], status["missing"] = "stale", self.inputs.without_speed(now)
        return status | {"contradictions": "; ".join(self.contradictions), "learned_model_refused": self.refusal}

    def warnings(self, now: float) -> list[str]:
        """What is as it was asked for, and may not be meant: of a torque that goes out less than its pressure, and more
        than a model says."""
        status, config, said = self.status(now), self.law.config, []
        if (share := float(status["pressure_share"])) < 1.0 and status["state"] in ("active", "fading"):
            group = config.pressure_group if len(self.inputs.topics.groups) > 1 else "the motors"
            said.append(
                f"{share:.0%} of the pressure is fed forward: the displacement of {group} is below min_displacement "
                f"({config.min_displacement:g})"
            )
        gains = [config.gains.get(name, 1.0) for name in self.law.model.term_names]
        if (share := config.scale * max(gains, default=1.0)) > 1.0:
            said.append(
                f"scale and gains compensate {share:.0%} of the model: above 100 % a winch may cycle at reversals"
            )
        return said


VALID, INVALID = "valid", "invalid"
MOST_DIGITS = 18  # of a number of messages: of more than 4300 Python makes none


def mark(valid: bool, sequence: int) -> str:
    """Validity and number as text."""
    return f"{VALID if valid else INVALID} {sequence}"


def read_mark(text: str) -> tuple[bool, int]:
    """Validity and number from `header.frame_id`; text of another origin is valid, without a number (-1)."""
    word, _, number = text.partition(" ")
    if word not in (VALID, INVALID) or not (number.isascii() and number.isdigit() and len(number) <= MOST_DIGITS):
        return True, -1
    return word == VALID, int(number)
