"""Has the gain of the drive's torque changed? The inertia that it shows tells, which no friction can imitate.

T = n D dp: a displacement (or both pressures) that drifts by a share scales the measured friction by it, as other
friction would. It scales what accelerates the shaft as well, and that does not change while the winch sails: a change
of both by the same share is one of the measurement. An error that was there from the beginning is no change; but both
less than half, or more than twice, of what crane file and seed say, is one unit for another.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from winch_friction.online.doubt import Doubt
from winch_friction.physics.signals import Sample
from winch_friction.physics.winch.crane import Crane, sample_drive_torque, sample_load

SMOOTHING = 0.1  # s, twice: of all signals alike, so that noise and the encoder's steps do not pass for acceleration
MEMORY = 40.0  # s: some waves
FIRST = 60.0  # s of motion after which what is seen is what the rest is compared with
EVERY = 1.0  # s between looks
LONGEST_STEP = 0.3  # s, a log of 5 Hz with its jitter; a longer gap begins the smoothing anew
# what accelerates the shaft and is like nothing else, over what the regression leaves (friction's true shape at
# reversals, the wire): 0.06 in a swell and 0.2 with a joystick tell too little; in the shipped seas it is 0.6 to 3.9
TELLING = 0.6
CHANGED = 0.10  # of the inertia: a displacement that is off by more spoils the friction by more than 40 N m at 55 t
ALIKE = (0.6, 1.6)  # change of the friction over the inertia's: a gain moves both alike, a changing sea does not
# of what the crane file and the seed say, inertia and friction alike: a displacement in cm3/rad for cm3/rev shows a
# sixth of both. The shipped seas show 0.65 to 0.95 of the inertia, and no unit has half of its bench test's friction
# (`seed_range`) and half of its inertia as well
LEAST_GAIN, MOST_GAIN = 0.5, 2.0
ANOTHER_LOAD = 0.05  # relative: a load that is picked up or set down is another balance
LIGHT_LOAD = 0.1  # of the rated one: below it the same share is of this, for a load cell's noise is one of its range
PATIENCE = 5.0  # s


@dataclass
class _Smooth:
    """A first-order low-pass twice, with its rate of change."""

    first: float = math.nan
    second: float = math.nan

    def step(self, value: float, share: float) -> tuple[float, float]:
        """The smoothed value and its change per smoothing time."""
        if self.first != self.first:
            self.first = self.second = value
        self.first += share * (value - self.first)
        rate = self.first - self.second
        self.second += share * rate
        return self.second, rate


@dataclass
class InertiaBalance:
    """Follows [1, direction, speed, inertial torque] -> torque beyond the load's, with `MEMORY` s of memory.

    `expected`: the seed's friction of a sample at another speed, rad/s, in N m; NaN where it is not known.
    """

    crane: Crane
    expected: Callable[[Sample, float], float] = lambda _sample, _speed: math.nan
    change: float = field(
        default=math.nan, init=False
    )  # of the drive's gain since the beginning, relative; NaN unknown

    def __post_init__(self) -> None:
        self.forget()

    def forget(self) -> None:
        """Another machine or load begins."""
        self._mass = math.nan
        self._groups: frozenset[str] = frozenset()
        self.set_clock()
        self._products, self._squares, self._known = np.zeros((4, 5)), 0.0, 0.0
        self._first: tuple[float, float, float] | None = None
        self._doubt = Doubt(PATIENCE, PATIENCE)
        self._shown: tuple[float, float] | None = None  # inertia and friction over what is expected, where no gain is
        self.change = math.nan

    def set_clock(self) -> None:
        """Another time begins with the same machine and load: a gain that was doubted is not believed for that."""
        self._time = self._looked = math.nan
        self._signals = {name: _Smooth() for name in ("torque", "direction", "speed", "heave")}

    def contradiction(self, sample: Sample) -> str:
        """What does not fit, in words, '' for nothing."""
        if not self.crane.drum.has(sample.wire_layer):
            return ""
        lever = self.crane.drum.radius(sample.wire_layer) / self.crane.gear_ratio
        load, torque = sample_load(sample), sample_drive_torque(sample, self.crane)
        torque -= self.crane.drum_torque(load, sample.wire_layer) / self.crane.gear_ratio
        if not math.isfinite(torque) or not math.isfinite(sample.motor_speed):
            return self._words()
        if self._is_other(load, sample):
            self.forget()
            self._mass, self._groups = load, frozenset(sample.groups)
        dt = sample.time - self._time if self._time == self._time else 0.0
        self._time = sample.time
        if not 0.0 < dt < LONGEST_STEP:
            self._signals = {name: _Smooth() for name in self._signals}
            dt = 0.0
        self._take(sample, torque, lever, dt)
        if not self._looked + EVERY > sample.time:  # true for NaN
            passed = min(sample.time - self._looked, EVERY) if self._looked == self._looked else 0.0
            self._looked = sample.time
            if not self._doubt.step(self._look(sample), passed):
                self._shown = None
        return self._words()

    @property
    def pending(self) -> bool:
        """Whether the gain seems changed, though it may not be said yet."""
        return self._doubt.pending

    def _is_other(self, load: float, sample: Sample) -> bool:
        if self._mass != self._mass or frozenset(sample.groups) != self._groups:
            return True
        return abs(load - self._mass) > ANOTHER_LOAD * max(abs(self._mass), LIGHT_LOAD * self.crane.rated_load)

    def _take(self, sample: Sample, torque: float, lever: float, dt: float) -> None:
        heave = sample.heave_velocity if sample.heave_velocity == sample.heave_velocity else 0.0
        now = {"torque": torque, "direction": math.copysign(1.0, sample.motor_speed), "speed": sample.motor_speed,
               "heave": heave}  # fmt: skip
        smooth = {name: each.step(now[name], dt / (SMOOTHING + dt)) for name, each in self._signals.items()}
        if dt == 0.0:
            return
        acceleration, vertical = smooth["speed"][1] / SMOOTHING, smooth["heave"][1] / SMOOTHING
        inertial = self.crane.inertia * acceleration + self._mass * lever * (lever * acceleration + vertical)
        row = np.array([1.0, smooth["direction"][0], smooth["speed"][0], inertial, smooth["torque"][0]])
        keep = math.exp(-dt / MEMORY)
        self._products = keep * self._products + dt * np.outer(row[:4], row)
        self._squares = keep * self._squares + dt * row[4] ** 2
        self._known += dt

    def _look(self, sample: Sample) -> bool | None:
        """Whether the gain has changed, or never was one; None while that cannot be told."""
        if self._known < FIRST:
            return None
        matrix, right = self._products[:, :4], self._products[:, 4]
        scale = np.sqrt(np.maximum(np.diag(matrix), 1e-300))
        try:
            inverse = np.linalg.inv(matrix / np.outer(scale, scale))
        except np.linalg.LinAlgError:
            return None
        found = inverse @ (right / scale) / scale
        left = max(self._squares - float(found @ right), 0.0) / matrix[0, 0]
        own = scale[3] ** 2 / max(float(inverse[3, 3]), 1e-300) / matrix[0, 0]  # of the inertial torque, (N m)^2
        typical = math.sqrt(matrix[2, 2] / matrix[0, 0]) if self._first is None else self._first[2]
        inertia, friction = float(found[3]), float(found[1] + found[2] * typical)
        known = inertia if self._first is None else self._first[0]
        if not known**2 * own > TELLING**2 * left:
            return None
        if self._first is None:
            if not (inertia > 0.0 and friction > 0.0):
                return None  # no gain to begin with: another matter
            expected = self.expected(sample, typical)
            if self._is_none(inertia, friction / expected if expected else math.nan):
                return True
            self._first = inertia, friction, typical
        self.change = inertia / self._first[0] - 1.0
        return abs(self.change) > CHANGED and ALIKE[0] < (friction / self._first[1] - 1.0) / self.change < ALIKE[1]

    def _is_none(self, *shown: float) -> bool:
        """Whether inertia and friction, over what is expected, agree on a gain that no spread explains."""
        wrong = all(each < LEAST_GAIN for each in shown) or all(each > MOST_GAIN for each in shown)  # NaN is neither
        if wrong and self.crane.drive.hydraulic:  # an electric crane's inertia may be a token
            self._shown = shown[0], shown[1]
            return True
        return False

    @property
    def from_the_beginning(self) -> bool:
        """Whether what stands was so since this load hangs there: nothing that was learned meanwhile is worth it."""
        return self._doubt.stands and self._shown is not None

    def _words(self) -> str:
        if not self._doubt.stands:
            return ""
        if self._shown is not None:
            return (
                "the drive's torque shows {:.2g} times the crane's inertia and {:.2g} times the seed's friction: "
                "displacement or pressures in another unit?".format(*self._shown)
            )
        return (
            f"the drive's torque has changed its gain by {self.change:+.0%}, inertia and friction alike: "
            f"{' or '.join(self.crane.drive.channels) or 'displacement or pressures'}"
        )
