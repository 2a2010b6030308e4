"""How long a contradiction must last before it counts, and how long an agreement before it is over; whether readings
live; and whether speed and wire, load and drive torque can be of one machine.

A controller that hangs may send what it read last, with new stamps, for ever. One sensor may stand still; all that tell
of the drive cannot, to the last digit, while the winch turns: pumps pulsate, transducers and encoders have noise.
"""

import math
from dataclasses import dataclass, field

from winch_friction.compensation.safe_output import AGAINST_SPEED
from winch_friction.online.wire_way import WireWays
from winch_friction.physics.signals import Sample
from winch_friction.physics.winch.crane import Crane, sample_drive_torque, sample_load
from winch_friction.physics.winch.operating_point import ChannelRanges, has_torque, readings_of, shown_by

LONGEST_SPAN = 0.1  # s between two samples that count: a gap shows nothing
FORGOTTEN = 30.0  # s that show nothing, longer than half of any wave: what was wrong before, and did not count, is over
CALM = 1.0  # s of agreement, where something is to be seen, before a doubt ends


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
    _unseen: float = field(default=0.0, init=False)  # s that showed nothing since it was wrong
    stands: bool = field(default=False, init=False)

    @property
    def pending(self) -> bool:
        """Whether something was wrong last, though it may not count yet."""
        return self.stands or self._wrong > 0.0

    def step(self, wrong: bool | None, dt: float) -> bool:
        """Whether it counts, after `dt` s more that were wrong, right, or (None) showed nothing."""
        if wrong:
            self._wrong, self._right, self._unseen = self._wrong + dt, 0.0, 0.0
        elif wrong is None:
            self._unseen += dt
            if self._unseen > FORGOTTEN:
                self._wrong = self._wrong if self.stands else 0.0
        else:
            self._right += dt
            self._wrong = self._wrong if self._right < self.forgiven else 0.0
        self.stands = self._wrong >= self.patience or (self.stands and self._right < self.calm)
        return self.stands


def span(last: float, time: float) -> float:
    """The seconds between two stamps that count for a doubt: none after a jump back, a tenth at most of a gap."""
    return min(max(time - last, 0.0), LONGEST_SPAN) if math.isfinite(time - last) else 0.0


# -- readings that stand still
# s; what comes is at most half a second old (`compensation.config.OLDEST_INPUT`): twice that is no slow sender
PATIENCE = 1.0
SAID = "all readings of the drive stand still while it turns: a sender that hangs?"
# of the largest speed: no drive turns so evenly that its speed is the same to that for a second. Encoder counts and
# whole revolutions are coarser, and may well stand: two of their steps differ by a whole one, or by rounding. So many
# finer differences show that a speed has more digits than they
FINE, ROUNDING, FINE_SEEN = 1e-4, 1e-9, 20
SPEED_SAID = "motor_speed stands still while the winch turns: a sender that hangs?"


class StandingReadings:
    """Whether everything that was measured, or a speed of many digits alone, stands still although the winch turns, or
    is told to, faster than `moving` rad/s."""

    def __init__(self, moving: float) -> None:
        self._moving, self._last = moving, Sample(math.nan, math.nan)
        self._doubt, self._speed = Doubt(PATIENCE), Doubt(PATIENCE)
        # of the speed: the last step and the largest, rad/s; how often its steps told that it has digits
        self._step, self._largest, self._fine = math.nan, 0.0, 0

    def contradiction(self, sample: Sample, dt: float) -> str:
        """What does not fit after `dt` s more, in words, '' for nothing."""
        last, self._last = self._last, sample
        stand = sample.motor_speed == last.motor_speed and readings_of(sample) == readings_of(last)
        speed = self._speed.step(self._hangs(sample.motor_speed, sample.motor_speed - last.motor_speed), dt)
        if self._doubt.step(self._tells(sample) if stand else False, dt):
            return SAID
        return SPEED_SAID if speed else ""

    def _hangs(self, speed: float, step: float) -> bool | None:
        """Whether a speed, so many rad/s from the last, stands that never stood; None of one at rest, or of few
        digits."""
        self._largest = max(self._largest, abs(speed))  # NaN is not larger
        moves = abs(speed) > self._moving
        self._fine += moves and ROUNDING * self._largest < abs(step - self._step) < FINE * self._largest
        self._step = step
        if step != 0.0:  # NaN as well
            return False
        return True if moves and self._fine >= FINE_SEEN else None

    def _tells(self, sample: Sample) -> bool | None:
        """Whether readings that stand still are wrong; None of a winch at rest, or of one without a torque."""
        turns = max(abs(sample.motor_speed), abs(sample.speed_reference)) > self._moving
        return True if turns and has_torque(sample) else None


# -- the speed and the wire that is paid out
WIRE_STEP, WIRE_TIME = 1.0, 2.0  # s between readings that are compared (a counter has steps, is late); until it counts


class WireAgainstSpeed:
    """Whether the speed has the unit and the direction that the wire shows; a command of the same program has both."""

    def __init__(self, crane: Crane, ranges: ChannelRanges) -> None:
        self._moving, self.ways = AGAINST_SPEED * crane.speed_scale, WireWays(crane, ranges.speed)
        self._doubt, self._time, self._shown = Doubt(WIRE_TIME), math.nan, math.nan
        self._turned = self._passed = 0.0  # since a reading that was compared

    def contradiction(self, sample: Sample, dt: float) -> str:
        """What does not fit after `dt` s more, in words, '' for nothing."""
        passed, step, ways = sample.time - self._time, abs(sample.wire_out - self._shown), self.ways
        self._time, self._shown = sample.time, sample.wire_out
        self._passed, self._turned = self._passed + passed, self._turned + sample.motor_speed * passed
        ways.finest = min(ways.finest, step) if step > 0.0 else ways.finest
        if not 0.0 <= passed <= LONGEST_SPAN:  # over a gap nobody knows how far it turned
            ways.begin(sample.wire_out)
            self._turned = self._passed = 0.0
        elif self._passed >= WIRE_STEP and sample.wire_out != ways.last:
            ways.compare(sample.time, sample.wire_out, sample.wire_layer, self._turned, self._passed)
            self._turned = self._passed = 0.0
        wrong = ways.wrong if abs(sample.motor_speed) > self._moving else None
        return f"motor_speed contradicts wire_out: {ways.how}" if self._doubt.step(wrong, dt) else ""


# -- a command beside a slow motion
# s of a mean, of motion remembered, until it is known; share of AGAINST_SPEED below which a mean is noise; share of the
# motion against the command: of healthy winches next to nothing, of what has nothing to do with them a half
MEAN_OF, SLOW_MEMORY, SLOW_KNOWN, SLOWEST, MOST_AGAINST = 1.0, 20.0, 10.0, 0.2, 1.0 / 3.0
SLOW_SAID = "speed_reference turns against a slow motor_speed in wave after wave"


class SlowWave:
    """Whether the command, by its means over a second, turns against a speed below `moving` rad/s in each wave."""

    def __init__(self, moving: float) -> None:
        self._moving, self._doubt = moving, Doubt(2.0 * MEAN_OF)
        self._passed = self._turned = self._asked = self._known = self._against = 0.0  # s, rad, rad, s, s

    def contradiction(self, sample: Sample, dt: float) -> str:
        """What does not fit after `dt` s more, in words, '' for nothing; a command of NaN turns against nothing."""
        self._turned, self._asked = self._turned + dt * sample.motor_speed, self._asked + dt * sample.speed_reference
        self._passed += dt
        if self._passed >= MEAN_OF:
            self._doubt.step(self._turns_against(abs(self._turned) / self._passed), self._passed)
            self._passed = self._turned = self._asked = 0.0
        return SLOW_SAID if self._doubt.stands else ""

    def _turns_against(self, speed: float) -> bool | None:
        if not speed >= SLOWEST * self._moving:  # NaN as well
            return None
        kept = math.exp(-self._passed / SLOW_MEMORY) if speed < self._moving else 0.0
        self._known = self._known * kept + self._passed
        self._against = self._against * kept + self._passed * (self._turned * self._asked < 0.0)
        return self._known >= SLOW_KNOWN and self._against > MOST_AGAINST * self._known


# -- the load that is shown and the drive's torque
# the load and the drive: inertia, friction and waves are a third of it at most
TORQUE_SHARE, TORQUE_TIME = 0.8, 1.0  # of the larger one, s
MOST_MOTION = 1.0 / 3.0  # of the larger one, where friction would have to push
SMALLEST_TORQUE = 0.1  # of what the rated load asks for; below it nothing is compared
# the same of what friction may add hoisting, and take lowering: an empty hook is moved by friction alone
MOST_FRICTION = 0.3  # of the nominal torque of hydraulic manipulators, Lischinsky et al. 1999
# the same in the middle between hoisting and lowering: a cell and a feedback of some per cent each, a tare and wire
# that are not weighed, of up to a tenth of the rated load. A load that is taken for 1.4 times what it is makes the
# compensated share, 0.9, one of 1.26: from 1.3 on a winch may cycle
MIDDLE_SHARE = 0.4  # of the smaller one; of the larger one where an unsaid layer may be why
MEMORY, LEAST_KNOWN = 20.0, 5.0  # s of motion each way: some waves, and half of one of 10 s
COMPARED = 2.0 * LEAST_KNOWN  # s of motion each way before a jump begins the means anew
# of what the rated load asks for: less hoisting than lowering is no friction. Pressures 0.1 s late in a wave of 4 s
# leave nine tenths of it, a wave cut off adds 40 N m; two fifths of a load's change may be the cell's, and a layer's
LEAST_PUSH = 0.05
PUSH_SAID = "the drive torque pushes with the motion, hoisting and lowering: has motor_speed the wrong sign?"


@dataclass
class Way:
    """Means over the motion one way, of the shown load's torque and of the drive's, N m; `known` s of it."""

    load: float = 0.0
    drive: float = 0.0
    known: float = 0.0

    def step(self, load: float, drive: float, dt: float) -> None:
        """`dt` s more."""
        self.known = self.known * math.exp(-dt / MEMORY) + dt
        share = dt / self.known if self.known else 0.0
        self.load += share * (load - self.load)
        self.drive += share * (drive - self.drive)


class LoadAgainstDrive:
    """Whether the load that is shown and the drive's torque can be of one machine; it needs no model.

    The load is the hook load, else that of the rope's force, else `assumed` kg, which somebody has set. At rest nothing
    shows: the brake may carry the load. A cell that is off by less than a dead one is seen in the middle between
    hoisting and lowering: there friction cancels, and what accelerates the shaft from one reversal to the next. From
    one way to the other friction takes sides: a speed that turns the wrong way makes it push. A jump of one that the
    other does not follow, at rest too, begins the means anew; a load that is picked up moves both.
    """

    def __init__(self, crane: Crane, ranges: ChannelRanges, assumed: float = math.nan) -> None:
        self._crane, self.assumed = crane, assumed
        self._rated, self._moving = 0.5 * ranges.load, AGAINST_SPEED * crane.speed_scale  # kg, rad/s
        self._largest = ranges.load + MOST_FRICTION * self._rated  # kg
        self._at_once, self._both_ways, self._pushes = (Doubt(TORQUE_TIME) for _ in range(3))
        self._hoisting, self._lowering = Way(), Way()
        self._by = ""  # what showed the load last

    def contradiction(self, sample: Sample, dt: float) -> str:
        """What does not fit after `dt` s more, in words, '' for nothing."""
        at_once = both_ways = pushes = None
        if math.isnan(self._load(sample)):  # nothing is shown that could be wrong, whatever was before
            at_once = both_ways = pushes = False
            self._hoisting, self._lowering = Way(), Way()
        else:
            self._by = shown_by(sample)
            if self._tells(sample):
                at_once, both_ways, pushes = self._compared(sample, dt)
        stand = self._at_once.step(at_once, dt), self._both_ways.step(both_ways, dt), self._pushes.step(pushes, dt)
        if not any(stand[:2]):
            return PUSH_SAID if stand[2] else ""
        return f"{self._by} contradicts the drive torque" + (", hoisting and lowering" if stand[1] else "")

    @property
    def pending(self) -> bool:
        """Whether they differ, though it may not be said yet."""
        return self._at_once.pending or self._both_ways.pending or self._pushes.pending

    def _compared(self, sample: Sample, dt: float) -> tuple[bool | None, ...]:
        """Whether load and drive differ in this sample, in the middle of both ways, and whether friction pushes."""
        lever = self._crane.drum_torque(1.0, sample.wire_layer) / self._crane.gear_ratio  # N m per kg
        load, drive = lever * self._load(sample), sample_drive_torque(sample, self._crane)
        if not math.isfinite(drive - load):
            return None, None, None
        # a worm that holds its load by itself leaves an electric motor nothing of it lowering; its middle is the load
        at_once = self._differ(load, drive, lever, sample) if self._crane.drive.hydraulic else None
        if abs(drive) > lever * self._largest:  # no load asks for it: a wrong unit, which a mean keeps for minutes
            return at_once, True, None
        if self._jump(load, drive, lever, sample):
            self._hoisting, self._lowering = Way(), Way()
        (self._hoisting if sample.motor_speed > 0.0 else self._lowering).step(load, drive, dt)
        return at_once, *self._both(sample, lever)

    def _jump(self, load: float, drive: float, lever: float, sample: Sample) -> bool:
        """Whether one went from the other, or to it, beside their means of this way. Only after they were compared for
        a while: spikes that follow each other must not keep them from that."""
        way = self._hoisting if sample.motor_speed > 0.0 else self._lowering
        apart = abs(drive - load - (way.drive - way.load))
        known = min(self._hoisting.known, self._lowering.known) >= COMPARED
        return known and apart > self._most(load, drive, lever, sample)

    def _most(self, load: float, drive: float, lever: float, sample: Sample) -> float:
        """How far the means may be apart, N m; a layer that nobody says may be an inner one, of 0.7 of the load."""
        inner = load > drive and sample.wire_layer != sample.wire_layer
        share = MIDDLE_SHARE * (max if inner else min)(load, drive)
        return max(share, SMALLEST_TORQUE * lever * self._rated)

    def _tells(self, sample: Sample) -> bool:
        return abs(sample.motor_speed) > self._moving and self._crane.drum.has(sample.wire_layer)

    def _load(self, sample: Sample) -> float:
        shown = sample_load(sample)
        return shown if shown == shown else self.assumed

    def _differ(self, load: float, drive: float, lever: float, sample: Sample) -> bool | None:
        large, apart = max(abs(load), abs(drive)), abs(drive - load)
        if not large > SMALLEST_TORQUE * lever * self._rated:
            return None
        by_friction = (drive - load) * sample.motor_speed > 0.0
        if apart > TORQUE_SHARE * large:
            return None if by_friction and apart < MOST_FRICTION * lever * self._rated else True
        apart, most = self._beyond(load, drive, lever, sample), self._most(load, drive, lever, sample)
        return apart > most + MOST_MOTION * large if not by_friction else None if apart > most else False

    def _beyond(self, load: float, drive: float, lever: float, sample: Sample) -> float:
        """By how much more they are apart, N m, than wire makes that a cell at the hook does not weigh."""
        wire = self._crane.wire_mass * sample.wire_out if math.isfinite(sample.wire_out) else 0.0  # kg
        return max(drive - load - lever * max(wire, 0.0), load - drive)

    def _both(self, sample: Sample, lever: float) -> tuple[bool | None, bool | None]:
        one, other = self._hoisting, self._lowering
        if min(one.known, other.known) < LEAST_KNOWN:
            return None, None
        load, drive, changed = 0.5 * (one.load + other.load), 0.5 * (one.drive + other.drive), one.load - other.load
        push = other.drive - one.drive + changed - MIDDLE_SHARE * abs(changed) > LEAST_PUSH * lever * self._rated
        return self._beyond(load, drive, lever, sample) > self._most(load, drive, lever, sample), push
