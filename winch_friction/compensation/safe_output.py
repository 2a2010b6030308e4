"""The one authority over what is published: it owns the last published torque, and every path asks it for the next.

Samples, silence, reset, a jump of time, another model, disabling and the end all come here. Whatever is asked for, the
torque stays inside its limits, moves no faster than the slew limit, and goes to zero by a ramp when nothing carries it.
"""

import math
from dataclasses import dataclass, field

from winch_friction.compensation.parts import RATED_PRESSURE, Bridge, CarryingPressure, Fade, TorqueLimits
from winch_friction.physics.errors import InputError

ROUNDING = 1e-6  # s; a sample that is as old as it may be is no silence (a Unix time has 2e-7 s)
LONGEST_STEP = 0.5  # s; a gap in the samples does not count as more than this for fades and slew
# stamps may gain this on the steady clock: a sender's clock, or a simulation, that runs faster than ours
FASTEST_STAMPS = 1.5
LONGEST_ANEW = 0.05  # s that count for a sample that begins anew: after a pause it is no step
LONGEST_AGAINST = 0.2  # s; what is left of before and pushes against what is right now is let go within this
LONGEST_BLIND = 0.3  # s; ... and what nobody can steer within this, for the motion may turn meanwhile
AGAINST_SPEED = 5.0  # rad/s; a slower motion has no direction worth speaking of
# s beside the look-ahead: so long may a torque push against the measured motion. Over 60 s of each shipped scenario
# the longest that a winch turned against its command was 0.06 s, at reversals; what lasts longer is no lag
LONGEST_LAG = 0.1


@dataclass
class SafeOutput:
    """The last published torque, N m, and the way from it to the next.

    `absolute` N m and `slew` N m/s bound it (and what `slew` lets go of within `LONGEST_AGAINST`); `ramp_time` s is how
    long it takes to fade in, out and over; a sample older than `hold` s carries nothing any more; `lead` s is how far
    ahead of the motion it is asked for; a motion below `against_speed` rad/s has no direction. A sample goes `arrive`
    (how much time counts), then `follow` (what is published). Between samples `decay` publishes the ramp to zero, which
    `remaining` foretells. `restart` forgets the samples but not what is published; `end` makes the ramp begin at once.

    One rule holds on every one of these ways: once nothing carries the torque any more (silence, an input lost or
    doubted, disabled, the end), what pushes against the last known motion, measured or commanded, or against what was
    asked for last, goes to zero as fast as the slew limit allows. And another, whatever carries it: what has pushed
    against the measured motion for longer than `lead` and `LONGEST_LAG` is let go within `LONGEST_AGAINST`.
    """

    absolute: float
    slew: float
    ramp_time: float
    hold: float
    lead: float = 0.0
    against_speed: float = AGAINST_SPEED
    carrying: CarryingPressure = field(default_factory=lambda: CarryingPressure(RATED_PRESSURE))
    torque: float = field(default=0.0, init=False)
    time: float = field(default=math.nan, init=False)  # stamp of what was published last, s
    sequence: int = field(default=0, init=False)
    steps_back: int = field(default=0, init=False)
    late: int = field(default=0, init=False)  # samples in a row that came after `hold`
    apart: float = field(default=0.0, init=False)  # s between the last two samples

    def __post_init__(self) -> None:
        self.limits = TorqueLimits(min(self.absolute, self.slew * LONGEST_AGAINST), self.slew)
        self.fade = Fade(self.ramp_time)
        self._bridge = Bridge(self.ramp_time)
        self._fed = math.nan  # stamp of the last sample that was followed; what was published, faded, bridged by then
        self._held, self._faded, self._bridged = 0.0, 0.0, 0.0
        self._asked, self._motion, self._command = 0.0, math.nan, math.nan  # by the last sample, N m and rad/s
        self._size = 0.0  # N m, what was published last while something carried it: the ramp is as steep as from there
        self._ramp_from, self._turns_at = math.nan, math.inf  # stamps: the ramp begins, the motion may turn; s
        self._steady, self._credit = math.nan, self.hold
        self._dt = self._gap = self._against = self._pushing = self._carried = 0.0
        self._passed = self._contrary = 0.0  # s since the last step, by stamp or clock; s against the measured motion
        self._behind = self._overdue = 0.0  # s that the stamps are behind the steady clock, and beyond `hold`
        self._bump = self._usable = self._new_time = self._anew = False  # anew: the latest sample began anew

    def configure(self, absolute: float, slew: float, ramp_time: float, hold: float, lead: float = 0.0) -> None:
        """Other limits from the next step on, without a bump; a ramp goes on from where it is. Raises as `check_slew`,
        and changes nothing."""
        self.check_slew(slew)
        self.absolute, self.slew, self.ramp_time, self.hold, self.lead = absolute, slew, ramp_time, hold, lead
        self.limits.absolute, self.limits.slew = min(absolute, slew * LONGEST_AGAINST), slew
        self.fade.duration = ramp_time
        self._bridge.stretch(ramp_time)
        if self.time > self._fed:
            self._held, self._faded, self._bridged = self.torque, self.fade.value, self._bridge.value()
            self._ramp_from = max(self._ramp_from, self.time)
        self._behind, self._credit = min(self._behind, hold), min(self._credit, hold)
        self._bump = True

    def check_slew(self, slew: float) -> None:
        """Raise `InputError` for a slew limit that lets go of what is published too late; changes nothing."""
        left = abs(self.torque)
        if slew < min(self.slew, left / LONGEST_AGAINST):
            raise InputError(
                f"slew_limit {slew:g} N*m/s cannot let go of the {left:.0f} N*m that are published within "
                f"{LONGEST_AGAINST:g} s: at least {left / LONGEST_AGAINST:.0f} N*m/s, or ~/enable false first"
            )

    def restrict(self, slew: float) -> None:
        """Slew no faster than `slew` N m/s, nor than the limit that was set."""
        self.limits.slew = min(self.slew, slew)

    def bump(self) -> None:
        """What is asked for is about to jump: carry the difference over."""
        self._bump = True

    def carry(self, difference: float) -> None:
        """Let a difference of what is asked for at the next sample, N m (before minus now), go by and by. Unlike a
        `bump` it leaves out what the motion itself changes meanwhile, which at a reversal is half the torque."""
        self._carried += difference

    # -- a sample
    def arrive(self, time: float, now: float | None = None) -> float:
        """Seconds that count for a sample stamped `time`, arriving at steady `now` s (None: the stamps are trusted).

        After a silence the ramp that nobody may have published is taken as done. Stamps that run ahead of the steady
        clock by more than `hold` gain nothing: a backlog that is worked off in a burst moves the output as little as
        the moment that it takes. Stamps that fall behind it by more than `hold` hold up no way out: a fade to zero is
        then as quick as the steady clock.
        """
        self.apart = time - self._fed
        self.late = self.late + 1 if self.apart > self.hold + ROUNDING else 0
        anew, ramped = self._new_time, self.time > self._fed  # what has passed since the last sample is used up already
        self._gap = abs(time - self.time) if self.time == self.time else 0.0
        self._dt, self._overdue, self._passed = self._elapsed(time), 0.0, self._gap
        if now is not None:
            self._passed = max(self._gap, now - self._steady) if self._steady == self._steady else self._gap
            # a clock that is set once makes no step; whoever resets at every sample does not hold the output
            if anew and self._anew and now > self._steady:
                self._dt = min(self._gap, now - self._steady, LONGEST_ANEW)
            self._dt = self._paced(self._dt, now)
        if ramped:
            self._overdue = 0.0
        self._anew = anew
        self._fed = self.time = time
        return self._dt

    def _elapsed(self, time: float) -> float:
        if math.isnan(self._fed) or self._new_time:
            self._new_time, self._bump = False, True
            return 0.0
        ramping = self.time > self._fed
        if time < self._fed or (ramping and time < self.time):
            self.steps_back += time < self._fed
            self._bump = True
            return 0.0
        if ramping or time - self._fed > self.hold + ROUNDING:
            torque = self.remaining(time)
            self._let_go(torque)
            self._bump = True
            return 0.0
        return min(time - self._fed, LONGEST_STEP)

    def _paced(self, dt: float, now: float) -> float:
        passed = now - self._steady if self._steady == self._steady else 0.0
        self._steady = now
        self._behind = max(0.0, self._behind + passed - dt)
        self._overdue = max(0.0, self._behind - self.hold)
        self._behind -= self._overdue
        self._credit = min(self.hold, self._credit + FASTEST_STAMPS * max(0.0, passed))
        counted = min(dt, self._credit)
        self._credit -= counted
        return counted

    def follow(
        self, target: float, envelope: float, usable: bool, enabled: bool, reversal: float = math.inf,
        motion: float = math.nan, command: float = math.nan,
    ) -> float:  # fmt: skip
        """What is published for the sample that arrived: the way to `target` N m.

        A sample that is not `usable` leaves `target` to fade out. `reversal` s is when the motion may turn: a ramp
        that nobody can steer is over by then. `motion` rad/s is the measured speed, `command` the one that was asked of
        the winch, NaN if unknown.
        """
        carried = usable and enabled
        if not carried:
            self._dt = min(self._dt + self._overdue, LONGEST_STEP)
        if usable and not self._usable:
            self._bump = True
        self._usable, self._asked, self._motion, self._command = usable, target, motion, command
        hurry = max(min(self.ramp_time, reversal), 1e-6)
        before = self.fade.value * target  # what fades in within this very step is no part of what is carried over
        faded = self.fade.step(carried, self._dt, hurry) * target
        if self._bump and usable:
            self._bridge.start(self.torque - before)
            self._bump, self._carried = False, 0.0
        elif self._carried:
            self._bridge.start(self._bridge.value() + self.fade.value * self._carried)
            self._carried = 0.0
        # what is carried goes as quickly as what fades
        wanted = faded + self._bridge.step(self._dt if usable else self._dt * self.ramp_time / hurry)
        wanted = self._not_for_long(self._not_against(wanted, carried))
        bound = min(self.limits.absolute, envelope)
        wanted = min(max(wanted, -bound), bound)
        wrong = self._opposed(self.torque) or abs(self.torque) > bound  # the wrong way, or more than may be
        self._pushing = max(self._pushing, abs(self.torque)) if wrong else 0.0
        passed = min(self._dt, self._gap)  # by the stamps as well: they go out with the torque
        let_go = self._pushing if carried else max(self._pushing, self._size)
        if passed > 0.0:  # in time by the clock, however slowly the stamps go
            let_go *= max(1.0, self._passed / passed)
        self.torque = self.limits.slewed(wanted, self.torque, passed, self._fast(let_go)) + 0.0  # never -0.0
        self.sequence += 1
        self._held, self._faded, self._bridged = self.torque, self.fade.value, self._bridge.value()
        self._size = abs(self.torque) if carried else max(self._size, abs(self.torque))
        # what is not carried any more does not wait for the age limit either
        self._ramp_from, self._turns_at = self._fed + (self.hold if carried else 0.0), self._fed + reversal
        return self.torque

    def _not_against(self, wanted: float, carried: bool) -> float:
        """What is left of before does not push against what is right now for long; at once when nothing carries it."""
        if not carried and self._opposed(wanted):
            self.fade.value = 0.0
            self._bridge.drop()
            return 0.0
        if wanted * self._asked >= 0.0:
            self._against = 0.0
            return wanted
        self._against = max(self._against, abs(self.torque))
        most = max(0.0, abs(self.torque) - self._against * self._dt / min(LONGEST_AGAINST, self.ramp_time))
        return math.copysign(min(abs(wanted), most), wanted)

    def _not_for_long(self, wanted: float) -> float:
        """Nothing pushes against the measured motion for much longer than a healthy winch turns against its command,
        whatever asks for it: a command that is wrong now and then, a limit that holds it up, what is left of before."""
        if not (self._against_motion(self.torque) or self._against_motion(wanted)):
            if abs(self._motion) > self.against_speed:  # a motion that has no direction shows nothing
                self._contrary = 0.0
            return wanted
        self._contrary += self._passed
        left = self.lead + LONGEST_LAG + LONGEST_AGAINST - self._contrary
        most = max(self._pushing, abs(self.torque)) * max(0.0, left) / LONGEST_AGAINST
        if left >= LONGEST_AGAINST or not self._against_motion(wanted):
            return wanted
        return math.copysign(min(abs(wanted), most), wanted)

    def _against_motion(self, torque: float) -> bool:
        return torque * self._motion < 0.0 and abs(self._motion) > self.against_speed

    def _opposed(self, torque: float) -> bool:
        """Whether it pushes against the last known motion, measured or commanded (nobody knows which of the two is
        wrong), or against the one that the last target was for."""
        against_command = torque * self._command < 0.0 and abs(self._command) > self.against_speed
        return against_command or self._against_motion(torque) or torque * self._asked < 0.0

    def _fast(self, torque: float) -> float:
        """N m/s to let go of N m that push against the motion, or that nothing carries, however slow a reversal is."""
        return min(self.slew, max(self.limits.slew, torque / LONGEST_AGAINST))

    # -- no sample
    def remaining(self, time: float) -> float:
        """What the ramp to zero leaves at stamp `time` when nothing was followed since; changes nothing."""
        silent = time - self._ramp_from
        if not silent > 0.0:
            return self._held
        left = abs(self._held) - self._ramp_rate() * silent
        return math.copysign(left, self._held) if left > 0.0 else 0.0

    def _ramp_rate(self) -> float:
        """N m/s: over within the ramp's time, and before the motion may have turned where the slew limit allows it."""
        duration = min(self.ramp_time, LONGEST_BLIND, max(self._turns_at - self._ramp_from, 0.0))
        if self._opposed(self._held) or duration == 0.0:
            return self._fast(max(self._pushing, abs(self._held)))
        size = max(self._size, abs(self._held))
        return min(self._fast(size), size / duration)

    def decay(self, time: float) -> float:
        """Publish the ramp to zero at stamp `time`."""
        if time > self.time:
            self._let_go(self.remaining(time))
            self.time = time
            self.sequence += 1
        return self.torque

    def _let_go(self, torque: float) -> None:
        if torque == self.torque:
            return
        share = torque / self._held if self._held else 0.0
        self.fade.value = self._faded * share
        self._bridge.start_again(self._bridged * share)
        self.torque = torque

    def restart(self) -> None:
        """Forget the samples: the next one comes from another time. What is published goes on from where it is."""
        self.fade.value = 0.0
        self._bridge.start(self.torque)
        self._new_time, self._usable, self._bump = True, False, True

    def end(self, time: float) -> None:
        """Let the ramp to zero begin at stamp `time`, and no sample stop it before the next `restart`."""
        self._held, self._faded, self._bridged = self.torque, self.fade.value, self._bridge.value()
        self._fed, self._ramp_from, self.time = time - self.hold, time, time

    def as_pressure(self, per_torque: float) -> float:
        """What was published last in Pa on the group that carries it, at `per_torque` Pa per N m, in its own bounds."""
        return self.carrying.of(self.torque, per_torque, self.time, self.slew)

    @property
    def at_rest(self) -> bool:
        """Whether nothing is published any more."""
        return self.torque == 0.0
