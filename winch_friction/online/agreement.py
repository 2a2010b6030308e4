"""Whether the inputs fit each other: the command and the speed, the load and the drive's torque, at once and slowly."""

import math
from dataclasses import dataclass, field

from winch_friction.compensation.safe_output import AGAINST_SPEED, LONGEST_LAG
from winch_friction.physics.signals import Sample
from winch_friction.physics.winch.crane import Crane
from winch_friction.physics.winch.ranges import ChannelRanges
from winch_friction.physics.winch.torque_balance import sample_drive_torque

# the command and the speed: a winch follows within its lag (0.1 s at 130 rad/s^2 is 13 rad/s)
SPEED_SHARE, SPEED_APART = 0.3, 0.1  # of the larger one, of the largest speed
SPEED_TIME = 0.5  # s
# the load and the drive: inertia, friction and waves are a third of it at most
TORQUE_SHARE, TORQUE_TIME = 0.8, 1.0  # of the larger one, s
SMALLEST_TORQUE = 0.1  # of what the rated load asks for; below it nothing is compared
# to and fro: jumps of this share of the largest speed, so many, within this time
CHATTER_STEP, CHATTER_COUNT, CHATTER_TIME = 0.1, 4, 0.5
CALM = 1.0  # s of agreement, where something is to be seen, before a doubt ends
# the load cell's load and the one that the balance of torques gives while it is learned from: a load cell, a
# displacement feedback and a tare of a few per cent each; a sea passes once in this time, a picked-up load settles
BALANCE_SHARE, BALANCE_TIME = 0.1, 10.0


@dataclass
class Doubt:
    """A contradiction that counts after `patience` s and is over after `calm` s of agreement.

    What was wrong before counts on until it was right for `forgiven` s.
    """

    patience: float
    calm: float = CALM
    forgiven: float = 0.0
    _wrong: float = field(default=0.0, init=False)
    _right: float = field(default=0.0, init=False)
    stands: bool = field(default=False, init=False)

    def step(self, wrong: bool | None, dt: float) -> bool:
        """Whether it counts, after `dt` s more that were wrong, right, or (None) showed nothing."""
        if wrong:
            self._wrong, self._right = self._wrong + dt, 0.0
        elif wrong is not None:
            self._right += dt
            self._wrong = self._wrong if self._right < self.forgiven else 0.0
        self.stands = self._wrong >= self.patience or (self.stands and self._right < self.calm)
        return self.stands


class LoadBalance:
    """Whether the load that the estimator finds is the one that the load cell shows.

    A load cell that drifts and a displacement (or both pressures) that drift look the same here: T = D dp is compared
    with m g r. It is not said which one is wrong, but that nothing may be learned from them.
    """

    def __init__(self) -> None:
        self._doubt, self._time = Doubt(BALANCE_TIME, BALANCE_TIME), math.nan

    def contradiction(self, apart: float, time: float) -> str:
        """What does not fit, in words; `apart`: the share of the measured load that the balance adds, NaN unknown."""
        dt = min(max(time - self._time, 0.0), 0.1) if self._time == self._time else 0.0
        self._time = time
        wrong = abs(apart) > BALANCE_SHARE if apart == apart else None
        if not self._doubt.step(wrong, dt):
            return ""
        return f"hook_load contradicts the balance of torques by {abs(apart):.0%}: load cell, displacement or pressures"


class Agreement:
    """Cross-checks one sample after the other; says which inputs contradict each other.

    `lead` s: how far the command may be ahead of the speed.
    """

    def __init__(self, crane: Crane, ranges: ChannelRanges, lead: float = 0.0) -> None:
        self._crane, self._ranges, self.lead = crane, ranges, lead
        self.forget()

    def forget(self) -> None:
        """Another time begins."""
        self._time = self._now = math.nan
        self._command = self._step = math.nan
        self._jumps: list[float] = []
        self._speeds, self._torques = Doubt(SPEED_TIME), Doubt(TORQUE_TIME)
        # messages in batches: a command that is right in one sample of each is none
        self._turns = Doubt(LONGEST_LAG, forgiven=LONGEST_LAG)

    def contradictions(self, sample: Sample, now: float = math.nan) -> tuple[str, ...]:
        """What does not fit, in a few words each.

        `now` s: when it came, by the steady clock; stamps that advance slowly must not stretch the patience.
        """
        passed = (sample.time - self._time, now - self._now)
        dt = min(max(0.0, *(each for each in passed if each == each)), 0.1) if self._time == self._time else 0.0
        self._time, self._now = sample.time, now
        self._turns.patience = self.lead + LONGEST_LAG
        found = {
            "speed_reference turns against motor_speed": self._turns.step(_turns_against(sample), dt),
            "speed_reference contradicts motor_speed": self._speeds.step(self._speeds_differ(sample), dt),
            "hook_load contradicts the drive torque": self._torques.step(self._torques_differ(sample), dt),
            "speed_reference jumps to and fro: two publishers?": self._chatters(sample),
        }
        return tuple(name for name, stands in found.items() if stands)

    def _speeds_differ(self, sample: Sample) -> bool | None:
        command, speed = sample.speed_reference, sample.motor_speed
        large = max(abs(command), abs(speed))
        if not large > SPEED_APART * self._ranges.speed:  # true for NaN
            return None
        return abs(command - speed) > SPEED_SHARE * large + SPEED_APART * self._ranges.speed

    def _torques_differ(self, sample: Sample) -> bool | None:
        if not self._crane.drive.hydraulic or not self._crane.drum.has(sample.wire_layer):
            return None
        load = self._crane.drum_torque(sample.hook_load, sample.wire_layer) / self._crane.gear_ratio
        drive = sample_drive_torque(sample, self._crane)
        large = max(abs(load), abs(drive))
        rated = self._crane.drum_torque(0.5 * self._ranges.load, sample.wire_layer) / self._crane.gear_ratio
        if not (large > SMALLEST_TORQUE * rated and math.isfinite(drive - load)):
            return None
        return abs(drive - load) > TORQUE_SHARE * large

    def _chatters(self, sample: Sample) -> bool:
        step = sample.speed_reference - self._command
        if step * self._step < 0.0 and min(abs(step), abs(self._step)) > CHATTER_STEP * self._ranges.speed:
            self._jumps.append(sample.time)
        self._command, self._step = sample.speed_reference, step
        self._jumps = [each for each in self._jumps if 0.0 <= sample.time - each < CHATTER_TIME]
        return len(self._jumps) >= CHATTER_COUNT


def _turns_against(sample: Sample) -> bool | None:
    if not (abs(sample.motor_speed) > AGAINST_SPEED and abs(sample.speed_reference) > 0.0):  # NaN as well
        return None
    return sample.motor_speed * sample.speed_reference < 0.0
