"""The load that is shown and the drive's torque: can they be of one machine?"""

import math
from dataclasses import dataclass

from winch_friction.compensation.safe_output import AGAINST_SPEED
from winch_friction.online.doubt import Doubt
from winch_friction.physics.signals import Sample
from winch_friction.physics.winch.crane import Crane, sample_drive_torque, sample_load
from winch_friction.physics.winch.operating_point import ChannelRanges

# the load and the drive: inertia, friction and waves are a third of it at most
TORQUE_SHARE, TORQUE_TIME = 0.8, 1.0  # of the larger one, s
SMALLEST_TORQUE = 0.1  # of what the rated load asks for; below it nothing is compared
# the same of what friction may add hoisting, and take lowering: an empty hook is moved by friction alone (30 % of the
# nominal torque of hydraulic manipulators, Lischinsky et al. 1999)
MOST_FRICTION = 0.3
# the same in the middle between hoisting and lowering: a cell and a feedback of some per cent each, a tare and wire
# that are not weighed, of up to a tenth of the rated load. A load that is taken for 1.4 times what it is makes the
# compensated share, 0.9, one of 1.26: from 1.3 on a winch may cycle
MIDDLE_SHARE = 0.4  # of the larger one
MEMORY, LEAST_KNOWN = 20.0, 5.0  # s of motion each way: some waves, and half of one of 10 s
# s from one moving sample to the next, a reversal between them; of motion each way before a jump begins the means anew
AT_ONCE, COMPARED = 1.0, 2.0 * LEAST_KNOWN


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

    A load cell that is dead, or stands still while another load hangs there. The load is the hook load, else that of
    the rope's force, else `assumed` kg, which somebody has set. A winch that stands still shows nothing: its brake may
    carry the load.

    A cell that is off by less than a dead one is seen in the middle between hoisting and lowering: there friction,
    which opposes both, cancels, and so does what accelerates the shaft from one reversal to the next. A jump of one
    that the other does not follow begins the means anew: with what was before in them
    a load cell that shows double was told after 25 to 38 s. A load that is picked up moves both.
    """

    def __init__(self, crane: Crane, ranges: ChannelRanges, assumed: float = math.nan) -> None:
        self._crane, self.assumed = crane, assumed
        self._rated, self._moving = 0.5 * ranges.load, AGAINST_SPEED * crane.speed_scale  # kg, rad/s
        self._largest = ranges.load + MOST_FRICTION * self._rated  # kg
        self._at_once, self._both_ways = Doubt(TORQUE_TIME), Doubt(TORQUE_TIME)
        self._hoisting, self._lowering = Way(), Way()
        self._last = (math.nan, math.nan, False)  # s; what the drive's torque was beyond the load's, N m; hoisting?
        self._by = ""  # what showed the load last

    def contradiction(self, sample: Sample, dt: float) -> str:
        """What does not fit after `dt` s more, in words, '' for nothing."""
        at_once = both_ways = None
        if math.isnan(self._load(sample)):  # nothing is shown that could be wrong, whatever was before
            at_once = both_ways = False
            self._hoisting, self._lowering = Way(), Way()
        else:
            self._by = shown_by(sample)
            if self._tells(sample):
                at_once, both_ways = self._compared(sample, dt)
        # both look at every sample
        stand = self._at_once.step(at_once, dt), self._both_ways.step(both_ways, dt)
        if not any(stand):
            return ""
        how = "" if stand[0] else ", hoisting and lowering"
        return f"{self._by} contradicts the drive torque{how}"

    @property
    def pending(self) -> bool:
        """Whether they differ, though it may not be said yet."""
        return self._at_once.pending or self._both_ways.pending

    def _compared(self, sample: Sample, dt: float) -> tuple[bool | None, bool | None]:
        """Whether load and drive differ in this sample, and in the middle between both ways."""
        lever = self._crane.drum_torque(1.0, sample.wire_layer) / self._crane.gear_ratio  # N m per kg
        load, drive = lever * self._load(sample), sample_drive_torque(sample, self._crane)
        if not math.isfinite(drive - load):
            return None, None
        by_friction = (drive - load) * sample.motor_speed > 0.0
        # a worm that holds its load by itself leaves an electric motor nothing of it lowering; its middle is the load
        at_once = self._differ(load, drive, lever, by_friction) if self._crane.drive.hydraulic else None
        if abs(drive) > lever * self._largest:  # no load asks for it: a wrong unit, which a mean keeps for minutes
            return at_once, True
        if self._jump(sample, load, drive, lever):
            self._hoisting, self._lowering = Way(), Way()
        (self._hoisting if sample.motor_speed > 0.0 else self._lowering).step(load, drive, dt)
        return at_once, self._middles_differ(sample, lever)

    def _jump(self, sample: Sample, load: float, drive: float, lever: float) -> bool:
        """Whether the two went apart, or together, at once; at a reversal by more than friction turns by.

        Only after they were compared for a while: spikes that follow each other must not keep them from that.
        """
        (time, beyond, hoisted), hoists = self._last, sample.motor_speed > 0.0
        self._last = (sample.time, drive - load, hoists)
        if not 0.0 < sample.time - time < AT_ONCE or min(self._hoisting.known, self._lowering.known) < COMPARED:
            return False
        friction = 0.0 if hoists is hoisted else MOST_FRICTION * lever * self._rated
        return abs(drive - load - beyond) > max(self._most(max(abs(load), abs(drive)), lever), friction)

    def _most(self, larger: float, lever: float) -> float:
        """How far the means may be apart, N m."""
        return max(MIDDLE_SHARE * larger, SMALLEST_TORQUE * lever * self._rated)

    def _tells(self, sample: Sample) -> bool:
        moves = abs(sample.motor_speed) > self._moving
        return moves and self._crane.drum.has(sample.wire_layer)

    def _load(self, sample: Sample) -> float:
        shown = sample_load(sample)
        return shown if shown == shown else self.assumed

    def _differ(self, load: float, drive: float, lever: float, by_friction: bool) -> bool | None:
        large, apart = max(abs(load), abs(drive)), abs(drive - load)
        if not large > SMALLEST_TORQUE * lever * self._rated:
            return None
        if by_friction and TORQUE_SHARE * large < apart < MOST_FRICTION * lever * self._rated:
            return None
        return apart > TORQUE_SHARE * large

    def _middles_differ(self, sample: Sample, lever: float) -> bool | None:
        one, other = self._hoisting, self._lowering
        if min(one.known, other.known) < LEAST_KNOWN:
            return None
        load, drive = 0.5 * (one.load + other.load), 0.5 * (one.drive + other.drive)
        wire = self._crane.wire_mass * sample.wire_out if math.isfinite(sample.wire_out) else 0.0  # kg
        apart = max(drive - load - lever * max(wire, 0.0), load - drive)  # a cell at the hook does not weigh the wire
        return apart > self._most(max(load, drive), lever)


def shown_by(sample: Sample) -> str:
    """What says the load of this sample, in words."""
    if sample.hook_load == sample.hook_load:
        return "hook_load"
    return "rope_force" if sample.rope_force == sample.rope_force else "load (the parameter)"
