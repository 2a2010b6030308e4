"""One trial: a voyage through both services with one fault after the other, watched at every published torque."""

import contextlib
import math
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np

from campaign.faults.kinds import REFERENCE, SPEED, Fault, Messages, draw
from campaign.faults.plain_kinds import NEEDED
from campaign.faults.voyages import MESSAGES, PERIOD, Voyage
from campaign.faults.watch import OutputWatch, Row
from winch_friction.compensation import CompensatorConfig, Feedforward
from winch_friction.online.compensator import CompensatorService
from winch_friction.online.estimator import EstimatorService
from winch_friction.online.inputs import ServiceOptions
from winch_friction.online.intake import parse
from winch_friction.physics.errors import InputError
from winch_friction.records.model_file import model_to_text

ORIGIN = 1.7e9  # s; a voyage's first stamp
AGE, RAMP, WATCHDOG = 0.1, 0.5, 0.1  # s
SLACK = 0.1  # s; two periods and the watchdog's own step
SHORT, LONG, LONG_SHARE = (0.05, 0.6), (0.8, 2.5), 0.2  # s: a fault lasts so long; some of them last long
HEALTHY = 0.5  # s at most until the next
DIAGNOSED = 1.0  # s after which diagnostics must say so
LOOKED_AT = 0.05  # share of messages before which the estimator is photographed
MOST_NOTES = 10  # of a trial
ACTIONS = 0.02  # chance of an action of an operator or of another node per tick
HOSTILE = (
    "[" * 20000,
    "schema: nonsense",
    "x: " * 90000,
    "",
    "\x00",
    "- &a [*a]",
    "!!python/object:os.system {}",
    "{" * 3000,
)


class Trial:
    """Runs `seconds` of a voyage; `rows` by kind of fault."""

    def __init__(self, voyage: Voyage, seed: int, rows: dict[str, Row] | None = None, learn: bool = False) -> None:
        self.voyage, self.rng = voyage, np.random.default_rng(seed)
        self.rows = defaultdict(Row) if rows is None else rows
        self.config = CompensatorConfig(ramp_time=RAMP, scale=1.0)
        options = ServiceOptions(watchdog_timeout=WATCHDOG)
        self.service = CompensatorService(voyage.crane, voyage.model, voyage.topics, self.config, options)
        self.estimator = EstimatorService(voyage.crane, voyage.model, voyage.topics, options=options) if learn else None
        self.watch = OutputWatch(voyage.largest, self.config.slew_limit)
        self.now, self.fault, self.fault_ends, self.fault_began = 100.0, None, 0.0, 0.0
        self.next_fault = HEALTHY
        self.waiting: list[Messages] = []
        self.speed = 0.0
        self.draws = 0
        self.notes: list[str] = []
        self.latest = ""  # fault, in words

    @property
    def row(self) -> Row:
        """Where what happens now is counted."""
        return self.rows[self.fault.kind if self.fault else "healthy, after a fault"]

    def run(self, seconds: float) -> None:
        """The voyage, repeated as often as it takes."""
        samples = self.voyage.samples
        for tick in range(int(seconds / PERIOD)):
            sample = samples[tick % len(samples)]
            self._step(replace(sample, time=ORIGIN + tick * PERIOD, groups=dict(sample.groups)), tick)
        self._end()

    def _step(self, sample: Any, tick: int) -> None:
        self.now += PERIOD * float(self.rng.uniform(0.7, 1.3))
        self.speed = sample.motor_speed
        self._change_fault()
        messages = [(topic, message) for topic, message in self.voyage.topics.encode(sample, MESSAGES)]
        if self.fault is not None:
            messages = self.fault.spoil(messages, tick, self.rng)
            if self.fault.paused:
                self.waiting.append(messages)
                return
        for each in (*self.waiting, messages):
            self._deliver(each)
        self.waiting.clear()
        self._tick()
        if self.rng.random() < ACTIONS:
            self._act()

    def _deliver(self, messages: Messages) -> None:
        inputs = self.voyage.topics.inputs
        for topic, message in messages:
            if topic not in inputs:
                continue
            self._say(self.service.take(inputs[topic], message, self.now, self.now))
            if self.estimator is not None:
                self._learn(self.estimator, inputs[topic], message)

    def _learn(self, estimator: EstimatorService, source: Any, message: Any) -> None:
        """A sample that is refused leaves the filter as it was, to the bit, unless it is where a doubt begins, by which
        what the doubted input told is taken back; its covariance stays one."""
        law, doubted = estimator.law, bool(estimator.contradiction)
        before = law.snapshot() if self.rng.random() < LOOKED_AT else None
        estimate = estimator.take(source, message, self.now, self.now)
        if estimate is None:
            return
        begins = bool(estimator.contradiction) and not doubted
        if not estimate.accepted and not begins and before is not None and law.snapshot() != before:
            self.row.violations["a refused sample changed the estimator"] += 1
        if self.rng.random() < 0.01:
            covariance = np.asarray(law.model().covariance)
            scale = np.sqrt(np.clip(np.diag(covariance), 1e-300, None))
            if np.linalg.eigvalsh(covariance / np.outer(scale, scale)).min() < -1e-9:
                self.row.violations["covariance not positive"] += 1
        learned = estimator.model_due(self.now)
        if learned is not None:
            self.service.offer(learned)

    def _tick(self) -> None:
        self._say(self.service.tick(self.now))
        fault = self.fault
        if fault is None or not fault.silences:
            return
        lasted = self.now - self.fault_began
        zero = self.watch.torque == 0.0
        if zero and math.isnan(self.zero_at):
            self.zero_at = lasted
            self.row.to_zero = max(self.row.to_zero, lasted)
        if not zero and lasted > AGE + RAMP + fault.detection + SLACK and not self.judged:
            self.judged = True
            self.row.unsafe += 1
            self.row.violations["obeyed although an input is gone"] += 1
            self.notes.append(
                f"{fault.kind} ({fault.detail}) at {self.now:.2f}: {self.watch.torque:.0f} N m after {lasted:.2f} s"
            )
        if lasted > DIAGNOSED and not self.said:
            self.said = True
            if self.service.status(self.now)["state"] == "active":
                self.row.said_active += 1
                self.row.violations["diagnostics say active"] += 1

    def _say(self, said: Feedforward | None) -> None:
        if said is not None:
            self.watch.blind = self.fault is not None and self.fault.blind
            self.watch.lead = max(self.watch.lead, self.service.law.config.lead)
            before = self.row.violations.total()
            self.watch.published(said, self.now, self.speed, self.row)
            if self.row.violations.total() > before and len(self.notes) < MOST_NOTES:
                self.notes.append(f"at {self.now:.2f}: {said.friction_torque:.0f} N m; the latest: {self.latest}")

    # -- faults come and go
    def _change_fault(self) -> None:
        if self.fault is not None and self.now >= self.fault_ends:
            self.fault = None
            self.next_fault = self.now + float(self.rng.uniform(0.05, HEALTHY))
        elif self.fault is None and self.now >= self.next_fault:
            self.fault = self._drawn()
            self.latest = f"{self.fault.kind} ({self.fault.detail})"
            self.fault_began = self.now
            lasts = LONG if self.rng.random() < LONG_SHARE else SHORT
            self.fault_ends = self.now + float(self.rng.uniform(*lasts))
            self.zero_at, self.judged, self.said = math.nan, False, False
            self.draws += 1
            self.row.draws += 1

    def _drawn(self) -> Fault:
        """One fault, or now and then two at once."""
        first = draw(self.rng)
        if self.rng.random() > 0.25 or first.paused:
            return first
        second = draw(self.rng)
        if second.paused:
            return first
        return Fault(
            "two at once", f"{first.kind}: {first.detail} + {second.kind}: {second.detail}",
            lambda m, k, r: second.spoil(first.spoil(m, k, r), k, r),
            first.silences and first.detection == 0.0 and not second.blind and not _mends(first, second),
            blind=first.blind or second.blind or _hides_the_motion(first, second),
        )  # fmt: skip

    # -- what people and other nodes do
    def _act(self) -> None:
        action = self.rng.integers(7)
        self.fault_began = self.now  # whoever resets or changes models bridges anew, within the same ramp time
        if action == 0:
            self.service.set_enabled(bool(self.rng.random() < 0.7))
        elif action == 1:
            self.service.reset()
        elif action == 2:
            changed = CompensatorConfig(
                ramp_time=RAMP, scale=float(self.rng.uniform(0.0, 1.3)), lead=float(self.rng.uniform(0.0, 0.1)),
                absolute_limit=float(self.rng.uniform(100.0, 2000.0)),
                reversal_time=float(self.rng.choice((0.0, 0.05, 0.3, 1.0))),
                reversal_speed=float(self.rng.choice((1.0, 3.0, 20.0))),
                slew_limit=float(self.rng.choice((5e3, 1e4, self.config.slew_limit))),
            )  # fmt: skip
            with contextlib.suppress(InputError):  # too slow for what is published
                self.service.configure(changed)
        elif action == 3:
            self._offer(model_to_text(self._model(0.3)))
        elif action == 4:
            self._offer(model_to_text(self._model(3.0)))
        elif action == 5:
            self._offer(HOSTILE[int(self.rng.integers(len(HOSTILE)))])
        elif self.rng.random() < 0.2:
            self._end()
            self.service.reset()

    def _model(self, spread: float) -> Any:
        """The seed with other values: some of them inside what is taken over, some far outside."""
        seed = self.voyage.model
        values = {}
        for name, value in seed.as_dict().items():
            lower, upper = seed.bounds_of(name)
            values[name] = float(np.clip(value * (1.0 + self.rng.uniform(-spread, spread)), lower, upper))
        return seed.with_values(values)

    def _offer(self, text: str) -> None:
        with contextlib.suppress(InputError):
            self.service.load_model(parse(text, "topic"))

    def _end(self) -> None:
        """Deactivation: the ramp is published to its end."""
        for after, said in self.service.ending(self.now):
            self.watch.published(said, self.now + after, self.speed, self.row)
        self.now = max(self.now, self.watch.time if math.isfinite(self.watch.time) else self.now)
        if self.watch.torque != 0.0:
            self.row.violations["the last torque is not zero"] += 1


def _mends(first: Fault, second: Fault) -> bool:
    """Whether both spoil one topic: what the second makes of the first's value may be possible again."""
    crossed = "speed and command crossed" in (first.kind, second.kind)
    return crossed or any(topic in first.detail and topic in second.detail for topic in NEEDED)


def _hides_the_motion(first: Fault, second: Fault) -> bool:
    """Whether neither speed nor command tell the motion: both are spoilt, or one stands for both and is spoilt too."""
    spoilt = [{topic for topic in (SPEED, REFERENCE) if topic in each.detail} for each in (first, second)]
    crossed = "speed and command crossed" in (first.kind, second.kind)
    return spoilt[0] | spoilt[1] == {SPEED, REFERENCE} or (crossed and any(spoilt))


def violations(rows: Iterable[Row]) -> int:
    """All of them."""
    return sum(sum(row.violations.values()) for row in rows)
