"""The inputs of a service: messages or rows of a run in, believed samples out, and what became of every message.

Readings are obeyed inside the crane's ranges, where they do not change faster than it can.
"""

import math
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any

from winch_friction.online.agreement import Motions, Stamp, StampWatch, Voices
from winch_friction.physics.channels import GROUP_CHANNELS, SAMPLE_SCALARS
from winch_friction.physics.errors import check, option
from winch_friction.physics.signals import ASSUMED, LOST, NAN, Run, Sample
from winch_friction.physics.winch.crane import Crane
from winch_friction.physics.winch.operating_point import ChannelRanges
from winch_friction.records.sample_stream import SIMULTANEOUS, InputHold, Plausibility, SampleStream, group_columns
from winch_friction.records.topics import Input, TopicMap, stamp_time

# -- how time is judged
LONGEST_REAL_TIME = 1.0  # s; who waits longer for a speed has no real time: a simulation that pauses, or runs fast
WATCH_PERIOD = 0.02  # s between two steps of the ramp that follows a silence
WATCH_SHARE = 0.2  # ... or this share of the time-out, where that is less


@dataclass(frozen=True)
class ServiceOptions:
    """`watchdog_timeout` s of silence are a lost speed; a stamp may lie `stamp_window` s ahead of the clock; a
    learned model takes effect `model_delay` s after its last measurement."""

    watchdog_timeout: float = option(
        0.1, lower=0.01, upper=600.0, unit="s", doc="time without a speed after which the inputs count as lost"
    )
    stamp_window: float = option(
        0.5, lower=0.05, upper=60.0, unit="s", doc="how far a stamp may run ahead of the clock before it is refused"
    )
    model_delay: float = option(
        0.5, lower=0.0, upper=60.0, unit="s", doc="a learned model takes effect this long after its last measurement"
    )

    def __post_init__(self) -> None:
        check(self)

    @property
    def paced(self) -> bool:
        """Whether the stamps are bound to the clock that the service is told."""
        return self.watchdog_timeout <= LONGEST_REAL_TIME

    def hazard(self, simulated: bool) -> str:
        """What is dangerous about these settings where time is not `simulated`, in words; '' for nothing."""
        if self.paced or simulated:
            return ""
        return (
            f"watchdog_timeout {self.watchdog_timeout:g} s: above {LONGEST_REAL_TIME:g} s time is taken for simulated, "
            "and late data are obeyed; never beside a machine"
        )

    @property
    def watch_period(self) -> float:
        """s between two looks at the silence."""
        return min(WATCH_PERIOD, WATCH_SHARE * self.watchdog_timeout)


# -- all of them
# s that a stray number leaves open what is assumed in its place, as the slowest input is held; s within which several
# are one stray thing: whoever sends such a number later again is a sender, and may have died since
STRAY, AT_ONCE = 30.0, 1.0
SILENT = "motor_speed ('inputs' says why)"  # what is missing where no speed comes
TWO_VOICES = "two values under one stamp"
MOTION = "motor_speed", "speed_reference"
TWO_MOTIONS = "two motions in turn: does a recording or a simulator send beside the machine?"


@dataclass
class Arrivals:
    """What became of one topic's messages: how many came, when the last one, how many were refused and why last."""

    messages: int = 0
    refused: int = 0
    arrived: float = -math.inf  # steady s, the last message
    after: int = 0  # messages that came when the speed of their own instant had been answered
    stamp: float = math.nan  # s, of the last one; a stamp that stands still tells nothing of the order
    reason: str = ""
    reasons: Counter[str] = field(default_factory=Counter)


class InputGate:
    """Holds what may be believed and makes a sample at each speed.

    `on_jump` hears when the senders' clock was set (after what was held is dropped). `now` is the service's clock in s.
    """

    def __init__(
        self, crane: Crane, topics: TopicMap, hold: InputHold, options: ServiceOptions, on_jump: Callable[[], None]
    ) -> None:
        self.topics, self.hold, self.options = topics, hold, options
        self.ranges = ChannelRanges(crane, topics.groups)
        self.arrivals = {topic: Arrivals() for topic in topics.inputs}
        self.last_stamp, self.last_arrival = -math.inf, math.inf
        self._plausible = Plausibility(self.ranges)
        self._voices, self._motions = Voices(self.ranges), Motions(self.ranges)
        self._on_jump = on_jump
        self._window = max(options.stamp_window, options.watchdog_timeout)  # s that a stamp may be ahead
        self._watch = StampWatch(self._window, options.paced)
        self._stream = SampleStream(topics, hold, admit=self._admit, on_held=self._note_arrival)
        self._torque = crane.drive.channels  # the speed's message may bring it
        self._refusal = ""
        self._whole: Run | None = None  # at hand, each row of which shows all there is
        self._came: dict[str, float] = {}  # steady s at which a column's last held value arrived
        self._unbelieved: dict[str, tuple[float, float]] = {}  # steady s of refused numbers, the first and the last
        matters = {"wire_layer": len(crane.drum.layer_radii) > 1, "wire_out": math.isfinite(crane.wire_stiffness)}
        self._assumed = tuple(name for name in ASSUMED if matters.get(name, True))
        self._taking: tuple[tuple[str, ...], float] = ((), -math.inf)  # columns of the message at hand, its arrival

    # -- messages
    def take(self, source: Input, message: Any, receipt: float, now: float, sent: float | None = None) -> Sample | None:
        """Hold what a message says; the sample, if it was a speed that may be believed.

        `receipt` s stamps a message without a header; `sent` orders messages of all topics.
        """
        arrivals = self.arrivals[source.topic]
        arrivals.messages += 1
        arrivals.arrived = now
        self._refusal = ""
        self._taking = source.channels, now
        if source.stamped and self._voices.contradict(source, message, now):
            self._refuse(arrivals, TWO_VOICES)
            return None
        if source.channels[0] in MOTION:
            stamp, shown = stamp_time(message) if source.stamped else receipt, source.decode(message)
            self._motions.hear(source.channels[0], stamp, shown.get(source.channels[0], NAN), now)
        if source.topic == self.topics.speed_topic:
            return self._speed(source, message, receipt, now, sent)
        if not source.stamped:
            if refusal := self._unstamped_refusal(source, message, now):
                self._refuse(arrivals, refusal)
            else:
                self._stream.put_off(source, message, receipt if sent is None else sent)
            return None
        stamp = stamp_time(message)
        if not self._near(stamp, now):
            self._refuse(arrivals, Stamp.AHEAD.value)
        elif self._stream.put(source, stamp, message):
            arrivals.after += abs(stamp - self.last_stamp) <= SIMULTANEOUS and stamp != arrivals.stamp
            arrivals.stamp = stamp
        else:
            late = Stamp.LATE.value if source.decode(message) else source.illegible(message)
            self._refuse(arrivals, self._refusal or late)
        return None

    def _unstamped_refusal(self, source: Input, message: Any, now: float) -> str:
        """Why a message without a stamp is not believed: it waits for the next speed, but is judged now."""
        stamp = self.last_stamp if math.isfinite(self.last_stamp) else 0.0
        refusals = []
        for column, value in source.decode(message).items():
            if refusal := self._plausible.refusal(column, stamp, value):
                refusals.append(f"{column}: {refusal}")
                if value == value:
                    self._unbelieved[column] = self._unbelieved.get(column, (now, now))[0], now
            else:
                self._came[column] = now
        return "; ".join(refusals)

    def _near(self, stamp: float, now: float) -> bool:
        """Whether a held input's stamp is not ahead of the speed's clock: it would lock the input out until then."""
        if math.isinf(self.last_stamp):
            return math.isfinite(stamp)
        return stamp <= self.last_stamp + max(now - self.last_arrival, 0.0) + self._window

    def _speed(self, source: Input, message: Any, receipt: float, now: float, sent: float | None) -> Sample | None:
        arrivals = self.arrivals[source.topic]
        stamp = stamp_time(message) if source.stamped else receipt
        worth = self._watch.judge(stamp, now) if math.isfinite(stamp) else Stamp.BACK
        if worth is Stamp.JUMP:
            self._start_over()
            self._on_jump()
        elif worth is not Stamp.GOOD:
            self._motions.note(now)
        if (two := self._motions.two(now)) or worth not in (Stamp.GOOD, Stamp.JUMP):
            self._refuse(arrivals, TWO_MOTIONS if two else worth.value)
            return None
        if math.isinf(self.last_stamp):  # until now nothing told what is ahead
            self.hold.drop_after(stamp + self._window)
        sample = self._stream.take_speed(source, message, stamp, receipt if sent is None else sent)
        if sample is None:
            self._refuse(arrivals, self._refusal or source.illegible(message))
            return None
        if self._refusal.startswith(self._torque):
            self._refuse(arrivals, self._refusal)
        self.last_stamp, self.last_arrival = stamp, now
        self._without_stale(sample, now)
        return self._with_lost(sample, now)

    def _without_stale(self, sample: Sample, now: float) -> None:
        """What arrived too long ago is lost: stamps alone do not tell an input's age where the speed comes late."""
        limit = self.hold.limit
        for column, came in self._came.items() if self.options.paced else ():
            if now - came > limit(column):
                group, _, channel = column.rpartition(".")
                owner = sample.groups.get(group) if group else sample
                if owner is not None:
                    setattr(owner, channel, NAN)

    def _with_lost(self, sample: Sample, now: float) -> Sample:
        """The sample; what something is assumed for where it is absent, and that came, is lost in it, not absent."""
        for name in self._assumed:
            first, last = self._unbelieved.get(name, (NAN, NAN))
            sent = last - first > AT_ONCE or abs(now - last) <= STRAY  # false for NaN
            if math.isnan(getattr(sample, name)) and (sent or math.isfinite(self.hold.stamp(name, sample.time))):
                setattr(sample, name, LOST)
        return sample

    def _admit(self, column: str, stamp: float, value: float) -> bool:
        refusal = self._plausible.refusal(column, stamp, value)
        if refusal:
            if value == value or not self._refusal:
                self._refusal = f"{column}: {refusal}"
            return False
        return True

    def _note_arrival(self, column: str) -> None:
        """What is admitted and not held, because its stamp is older, does not make what is held any younger."""
        columns, arrived = self._taking
        if column in columns:
            self._came[column] = arrived

    def _refuse(self, arrivals: Arrivals, reason: str) -> None:
        arrivals.refused, arrivals.reason = arrivals.refused + 1, reason
        arrivals.reasons[reason.split(": ")[0]] += 1

    # -- rows of a run
    def fill(self, sample: Sample, now: float | None = None) -> Sample:
        """A run's row as the messages of one instant: implausible values out, holes filled by what is held."""
        self._strip(sample, zip(SAMPLE_SCALARS, SAMPLE_SCALARS, strict=True), sample.time)
        for group, member in sample.groups.items():
            self._strip(member, zip(group_columns(group), GROUP_CHANNELS, strict=True), sample.time)
        self.last_stamp, self.last_arrival = sample.time, sample.time if now is None else now
        return self._with_lost(self.hold.fill(sample), self.last_arrival)

    def rows(self, run: Run) -> Iterator[Sample]:
        """What `fill` makes of a run's rows, one by one; nothing is held where the run is the first thing that comes
        and all its values are believed."""
        fresh = run.groups == self.hold.groups and not self.hold.ages(0.0)
        if not (fresh and self._plausible.believes_whole(run)):
            yield from map(self.fill, run.samples())
            return
        self._whole = run
        for sample in run.samples():
            self.last_stamp = self.last_arrival = sample.time
            yield sample
        self._whole = None

    def _strip(self, shown: Any, names: Iterable[tuple[str, str]], stamp: float) -> None:
        """Make what is not believed missing; `names`: the columns, and their fields."""
        refusal = self._plausible.refusal
        for column, name in names:
            value = getattr(shown, name)
            if value == value and refusal(column, stamp, value):
                setattr(shown, name, NAN)

    # -- time
    def silence(self, now: float) -> float:
        """Seconds since the last believed speed; 0 before the first. A clock that was set back counts from there: it
        would else have to come back to where it was before anything is silent."""
        if now < self.last_arrival < math.inf:
            self.last_arrival = now
        return max(0.0, now - self.last_arrival)

    def without_speed(self, now: float) -> str:
        """What is missing where no speed is believed, with the reason where some still come."""
        speed = self.arrivals[self.topics.speed_topic]
        comes = now - speed.arrived <= self.options.watchdog_timeout
        return f"motor_speed, refused: {speed.reason}" if comes and speed.reason else SILENT

    def forget(self) -> None:
        """Drop what is held and believe the next stamp, after a jump of the clock or on request."""
        self._watch.forget()
        self._start_over()

    def _start_over(self) -> None:
        self._stream.forget()
        self._plausible.forget()
        self._voices.forget()
        self._came.clear()
        self._unbelieved.clear()
        self.last_stamp = -math.inf

    # -- what is known of the inputs
    def stamp(self, column: str, time: float) -> float:
        """Stamp in s of what the sample at `time` s shows of a column; NaN for nothing."""
        if self._whole is not None:
            return time if column in self._whole else NAN
        return self.hold.stamp(column, time)

    def ages(self) -> dict[str, float]:
        """Age of every held input at the last speed, s."""
        return self.hold.ages(self.last_stamp)
