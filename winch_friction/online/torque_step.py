"""Has the drive's torque stepped where the shaft did not answer? Then a reading shows another share of what is there.

A load reaches the drive through the shaft: it turns slower first, and the oil that drives it is compressed within a
tenth of a second. A torque that the drive really makes accelerates the shaft. A transducer's gain, or that of a
displacement's feedback, goes from one sample to the next, and the shaft turns on as before. Neither a load cell nor a
model is asked. A gain that drifts is not seen, nor one that steps where the driving motors' friction reverses.
"""

import itertools
import math
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from winch_friction.compensation.safe_output import AGAINST_SPEED
from winch_friction.physics.channels import GRAVITY
from winch_friction.physics.signals import FloatArray, Sample
from winch_friction.physics.winch.crane import Crane, driving_group, sample_drive_torque
from winch_friction.physics.winch.operating_point import ChannelRanges

# s and samples that are looked at on either side: short beside a wave and the wire's swing, which a parabola follows;
# s between two samples, of a log of 10 Hz with its jitter; samples that hold the far side at the fastest rate
SIDE, FEWEST, LONGEST, MOST_ROWS = 0.1, 5, 0.13, 1000
HOLE = 0.5  # s without a sample within which a reading may have stepped back: over it a parabola follows a wave
USUAL_TIME, USUAL_KNOWN = 10.0, 1.0  # s of the mean size of second differences, and until it is known
SUDDEN = 4.0  # times that mean: what Gaussian noise shows in one sample of 700 is looked at
AT_ONCE = 0.6  # of the step, between two samples: a pump, a valve and a swash plate take some
# standard deviations: noise that goes on from one sample to the next makes two of them one, and of a few samples the
# size is hardly known
SURE = 8.0
LEAST_STEP = 0.01  # of what the rated load asks for: the zeros of transducers
# of the step, by what accelerates the shaft with its load, two standard deviations of that included. A drive's own
# steps are answered by the whole of it
ANSWERED = 0.5
REVERSAL = 0.25  # s about a reversal in which a feedforward of friction steps the driving group, and no shaft answers
PART = 1.0 / 3.0  # of a torque's step, from which a reading is told as what stepped
BACK = 0.5  # of a reading's step, or of its share, within which one the other way takes it back
RESTED = 30.0  # s at rest: by then the load may be another one, the transducer too

CHANNELS = ("pressure_a", "pressure_b", "displacement")


class Row(NamedTuple):
    """What is kept of a sample: time, s; torque of the drive and of what only holds in it, N m; speed, rad/s; readings
    by group and channel, SI."""

    time: float
    torque: float
    held: float
    speed: float
    shown: tuple[float, ...]


class StepFit(NamedTuple):
    """A step with its standard deviation, and what was there before it."""

    step: float
    std: float
    before: float

    @property
    def sure(self) -> bool:
        """Whether noise does not make it."""
        return abs(self.step) > SURE * self.std


def _step(time: FloatArray, value: FloatArray) -> StepFit:
    """The step of a parabola at time 0."""
    columns = (time > 0.0, np.ones_like(time), time, time * time)
    found, std = _least_squares(np.column_stack(columns), value)
    return StepFit(found[0], std, found[1])


def _kink(rows: Sequence[Row], moment: float) -> StepFit:
    """The step of a cubic's slope, of the speed, rad/s^2, at `moment` s."""
    time, speed = np.array([row.time for row in rows]) - moment, np.array([row.speed for row in rows])
    columns = (np.maximum(time, 0.0), np.ones_like(time), time, time**2, time**3)
    found, std = _least_squares(np.column_stack(columns), speed)
    return StepFit(found[0], std, found[2])


def _least_squares(columns: FloatArray, value: FloatArray) -> tuple[list[float], float]:
    """Coefficients, and the standard deviation of the first."""
    inverse = np.linalg.pinv(columns.T @ columns)
    found = inverse @ (columns.T @ value)
    left = value - columns @ found
    return found.tolist(), math.sqrt(max(inverse[0, 0], 0.0) * float(left @ left) / (len(value) - len(found)))


class Sudden:
    """Tells a second difference that is many times the usual one."""

    def __init__(self, least: float) -> None:
        self._least, self._usual, self._known = AT_ONCE * least, 0.0, 0.0

    def step(self, bend: float, dt: float) -> bool:
        """One more, `dt` s after the last."""
        known, most = self._known >= USUAL_KNOWN, SUDDEN * self._usual
        self._known += dt
        self._usual += ((min(bend, most) if known else bend) - self._usual) * dt / min(self._known, USUAL_TIME)
        return known and bend > max(most, self._least)


class TorqueStep:
    """Whether a reading of the drive has stepped, and not stepped back since."""

    def __init__(self, crane: Crane, ranges: ChannelRanges) -> None:
        self._crane, self._moving = crane, AGAINST_SPEED * crane.speed_scale
        self._least = crane.drum_torque(LEAST_STEP * 0.5 * ranges.load) / crane.gear_ratio  # N m
        self._off: dict[str, StepFit] = {}  # what stepped
        self._rested = 0.0  # s
        self._begin(())

    def _begin(self, names: tuple[str, ...]) -> None:
        self._names, self._rows, self._looks = names, deque[Row](maxlen=MOST_ROWS), deque[float]()
        self._sudden = Sudden(self._least), Sudden(self._least)

    def contradiction(self, sample: Sample, dt: float) -> str:
        """What stepped by how much, in words, '' for nothing; `dt` s after the last sample."""
        self._rested = 0.0 if abs(sample.motor_speed) > self._moving else self._rested + dt
        if self._rested > RESTED:
            self._off = {}
        names = tuple(f"{group}.{name}" for group in sample.groups for name in CHANNELS) or ("motor_torque",)
        torque, held = self._torques(sample)
        if not math.isfinite(torque) or not math.isfinite(sample.motor_speed):
            self._begin(names)
            return self._words()
        passed = sample.time - self._rows[-1].time if self._rows else 0.0
        longest = HOLE if self._off else LONGEST  # what stepped may step back meanwhile
        if names != self._names or (self._rows and not 0.0 < passed < longest):
            self._begin(names)
            self._off = self._off if all(name in names for name in self._off) else {}  # other motors
        shown = tuple(getattr(each, name) for each in sample.groups.values() for name in CHANNELS)
        self._rows.append(Row(sample.time, torque, held, sample.motor_speed, shown or (sample.motor_torque,)))
        self._look(sample, dt)
        return self._words()

    def _torques(self, sample: Sample) -> tuple[float, float]:
        """Of the whole drive, and of the motors that only hold the load, N m."""
        torque = sample_drive_torque(sample, self._crane)
        if len(sample.groups) < 2:
            return torque, 0.0
        name = driving_group(tuple(sample.groups))
        driving = sample.groups[name]
        drop = driving.pressure_a - driving.pressure_b
        return torque, torque - self._crane.motor_count(name) * driving.displacement * drop

    def _look(self, sample: Sample, dt: float) -> None:
        """Keep the moment of something sudden, and judge it once enough of what follows was seen."""
        rows = self._rows
        if len(rows) < 3:
            return
        sudden = [each.step(bend, dt) for each, bend in zip(self._sudden, self._bends(), strict=True)]
        if any(sudden):
            self._looks.append(rows[-1].time)
        if self._looks and rows[-1].time >= self._looks[0] + REVERSAL:
            at = next(k for k, row in enumerate(rows) if row.time >= self._looks[0])
            if len(rows) - at >= FEWEST:
                self._looks.popleft()
                self._judge(at, sample)

    def _bends(self) -> Iterator[float]:
        """How far the torques are from where they went, N m."""
        first, last, now = self._rows[-3], self._rows[-2], self._rows[-1]
        on = (now.time - last.time) / (last.time - first.time)
        yield abs(now.torque - last.torque - on * (last.torque - first.torque))
        yield abs(now.held - last.held - on * (last.held - first.held))

    def _judge(self, at: int, sample: Sample) -> None:
        """Whether something stepped between the row `at` and the one before, or stepped back."""
        seen = list(self._rows)
        fewer = max(FEWEST, sum(row.time < seen[at].time + SIDE for row in seen[at:]))
        rows = seen[max(at - fewer, 0) : at + fewer]
        if at < FEWEST:
            return
        moment = 0.5 * (seen[at - 1].time + seen[at].time)
        time = np.array([row.time for row in rows]) - moment
        shown = {n: _step(time, np.array([r.shown[k] for r in rows])) for k, n in enumerate(self._names)}
        about = [row for row in seen if abs(row.time - seen[at].time) <= max(REVERSAL, time[-1])]
        turns_on = all(row.speed * seen[at].speed > 0.0 for row in about)
        whole = all(after.time - before.time < LONGEST for before, after in itertools.pairwise(rows))
        reverses = any(row.speed * seen[at].speed <= 0.0 for row in (*about, *rows))
        if not whole and reverses:  # friction steps readings as well, and nobody has seen which it was
            return
        exchanged = {name for pair in self._exchanged(self._off) & self._exchanged(shown) for name in pair}
        back = {name for name, step in self._off.items() if name in exchanged or _is_back(step, shown[name])}
        self._off = {name: step for name, step in self._off.items() if name not in back}
        if not whole:
            return
        kink = min((_kink(near, moment) for near in (rows, about)), key=lambda each: each.std)
        if back or max(abs(row.speed) for row in rows) <= self._moving:  # a brake takes the load over
            return
        for column in ("torque", "held") if turns_on else ("held",):
            if step := self._unanswered(time, rows, column, kink, sample):
                whose = {name: each for name, each in shown.items() if self._part(name, each, sample) > PART * step}
                self._off |= {name: each for name, each in whose.items() if name not in self._off}

    def _exchanged(self, steps: Mapping[str, StepFit]) -> set[tuple[str, str]]:
        """The ports that show each other's pressure from then on, by the steps of their readings: once more, and they
        are right again, whatever they show by then."""
        pairs = [(f"{group}.pressure_a", f"{group}.pressure_b") for group in {n.partition(".")[0] for n in self._names}]
        return {
            pair for pair in pairs if all(each in steps for each in pair) and _exchange(*(steps[each] for each in pair))
        }

    def _part(self, name: str, each: StepFit, sample: Sample) -> float:
        """What a reading's step makes of the torque's, N m."""
        group, _, channel = name.partition(".")
        if not each.sure:
            return 0.0
        if not channel:
            return math.inf
        member = sample.groups[group]
        factor = member.pressure_a - member.pressure_b if channel == "displacement" else member.displacement
        return abs(self._crane.motor_count(group) * factor * each.step)

    def _unanswered(self, time: FloatArray, rows: list[Row], column: str, kink: StepFit, sample: Sample) -> float:
        """By how much, N m, a torque stepped between two rows where the shaft turned on as before, else 0."""
        found = _step(time, np.array([getattr(row, column) for row in rows]))
        first = int(np.argmax(time > 0.0))
        at_once = getattr(rows[first], column) - getattr(rows[first - 1], column)
        if not (found.sure and abs(found.step) > self._least and at_once / found.step > AT_ONCE):
            return 0.0
        lever = self._crane.drum.radius(sample.wire_layer) / self._crane.gear_ratio
        hanging = abs(rows[0].torque) * lever / GRAVITY  # kg m^2
        inertia = self._crane.inertia + hanging
        answer = inertia * (kink.step * math.copysign(1.0, found.step) + 2.0 * kink.std)
        return abs(found.step) if answer < ANSWERED * abs(found.step) else 0.0

    def _words(self) -> str:
        if not self._off:
            return ""
        steps = ", ".join(f"{name} by {each.step / abs(each.before):+.0%}" for name, each in self._off.items())
        return f"the shaft did not answer a step of {steps}: a transducer or a feedback?"


def _exchange(one: StepFit, two: StepFit) -> bool:
    """Whether each of two readings steps to where the other one was."""
    apart = two.before - one.before
    return one.sure and two.sure and max(abs(one.step - apart), abs(two.step + apart)) < BACK * abs(apart)


def _is_back(step: StepFit, other: StepFit) -> bool:
    """Whether another step takes one back, as what is added to a reading or as a share of it."""
    if not other.sure:
        return False
    if abs(step.step + other.step) < BACK * abs(step.step):
        return True
    one, two = (1.0 + each.step / each.before if each.before else 0.0 for each in (step, other))
    return min(one, two) > 0.0 and abs(math.log(one * two)) < BACK * abs(math.log(one))
