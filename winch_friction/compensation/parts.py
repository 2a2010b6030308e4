"""The parts that the feedforward is put together from: the inputs that it needs, load, law; bounds, fades, pressure.

`compensator` asks the first three for a torque; `safe_output` leads what is published there by the last two.
"""

import math
from collections.abc import Callable, Mapping, Sequence, Set
from dataclasses import dataclass, field
from operator import mul

from winch_friction.compensation.config import CompensatorConfig
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.friction.compiled import CompiledTerms, advance_all
from winch_friction.physics.friction.term import irreplaceable
from winch_friction.physics.signals import Sample
from winch_friction.physics.winch.crane import Crane, pressure_feedforward, sample_drive_torque
from winch_friction.physics.winch.operating_point import RATED_PRESSURE, ChannelRanges


# -- what it needs to see
class Needs:
    """What a feedforward needs to see.

    `reads` are the signals of its terms, `source` its velocity, `load_known` whether its configuration says the load.
    """

    def __init__(self, ranges: ChannelRanges, reads: Set[str], source: str, load_known: bool) -> None:
        self._ranges, self._crane = ranges, ranges.crane
        speed = "speed_reference" if source == "reference" else "motor_speed"
        self._scalars = (speed, *irreplaceable(reads))
        self._balance_for_load = "drum_torque" in reads and not load_known

    def missing(self, sample: Sample) -> tuple[str, ...]:
        """Columns that the sample does not have, or not within what the crane can show."""
        plausible, drive = self._ranges.plausible, self._crane.drive
        lost = [name for name in self._scalars if not plausible(name, getattr(sample, name))]
        weight, force = sample.hook_load, sample.rope_force
        if weight == weight and not plausible("hook_load", weight):
            lost.append("hook_load")
        if force == force and not plausible("rope_force", force):
            lost.append("rope_force")
        if not self._crane.drum.has(sample.wire_layer):
            lost.append("wire_layer")
        if drive.hydraulic or (self._balance_for_load and not (math.isfinite(weight) or math.isfinite(force))):
            lost += drive.lacking(sample, plausible)
        return tuple(lost)


# -- the load
class DrumTorque:
    """T_d in N m for the compensator.

    `hook_load` comes first, then the measured `rope_force`, then a configured load. Without any of them it is
    i (drive torque - J omega' - friction), low-passed over `time_constant` s: slow against the sea, so that an error
    of the friction at reversal cannot feed back through the load.
    """

    def __init__(self, crane: Crane, load: float, time_constant: float) -> None:
        self.crane = crane
        self._load = load
        self._time_constant = time_constant
        self.reset()

    def configure(self, load: float, time_constant: float) -> None:
        """Other settings, the estimate kept."""
        self._load, self._time_constant = load, time_constant

    def reset(self) -> None:
        """Forget the estimate from the pressures."""
        self._estimate = math.nan

    def value(self, sample: Sample) -> float:
        """T_d in N m; NaN while nothing is known."""
        load = sample.hook_load
        if not math.isfinite(load):
            if math.isfinite(sample.rope_force):
                return sample.rope_force * self.crane.drum.radius(sample.wire_layer)
            load = self._load
        if math.isfinite(load):
            return self.crane.drum_torque(load, sample.wire_layer)
        if not math.isfinite(self._estimate):
            return self._from_balance(sample, 0.0, 0.0)
        return self._estimate

    def learn(self, sample: Sample, friction: float, acceleration: float, dt: float) -> None:
        """Follow the torque balance of one sample with the friction that the model says, `dt` s after the one
        before."""
        balance = self._from_balance(sample, friction, acceleration)
        if not math.isfinite(balance):
            return
        if not math.isfinite(self._estimate):
            self._estimate = balance
        self._estimate += (balance - self._estimate) * dt / (dt + self._time_constant)

    def _from_balance(self, sample: Sample, friction: float, acceleration: float) -> float:
        crane = self.crane
        torque = sample_drive_torque(sample, crane) - crane.inertia * acceleration - friction
        return max(0.0, crane.gear_ratio * torque) if math.isfinite(torque) else math.nan


# -- the model's torque

# what a sensor shows but the shaft does not feel must not be compensated unless the gains ask for it
NOT_FELT = "sensor"


class FrictionLaw:
    """The friction torque of a model at an operating point, with a gain for every term."""

    def __init__(self, model: FrictionModel, gains: Mapping[str, float]) -> None:
        self.model = model
        self.gains = tuple(gains.get(t.name, 0.0 if t.place == NOT_FELT else 1.0) for t in model.terms)
        self._all_used = min(self.gains, default=0.0) > 0.0
        self.reads = frozenset(name for term in model.terms for name in term.reads)
        self._values = model.values
        self._compiled: CompiledTerms
        self._contributions: Callable[..., tuple[float, ...]]
        self._states: tuple[float, ...]
        self.reset()

    def torque(self, x: Sequence[float], groups: int) -> float:
        """Sum of gain times contribution, N m at the motor shaft; overflow comes out as NaN."""
        return sum(map(mul, self.gains, self._parts(x, groups)))

    def magnitude(self, x: Sequence[float], groups: int, fastest: float = math.inf) -> float:
        """Sum of the terms' magnitudes at direction 1, N m: the largest torque that the signs could make of them; no
        more than at `fastest` rad/s where the speed is above it: a command in rpm is obeyed until it is doubted."""
        if x[1] > fastest:
            slower = (x[0], fastest, math.copysign(fastest, x[2]), *x[3:])
            return min(self.magnitude(x, groups), self.magnitude(slower, groups))
        parts = self._parts((1.0, *x[1:]), groups)
        if self._all_used:
            return sum(map(abs, parts))
        return sum(abs(part) for gain, part in zip(self.gains, parts, strict=True) if gain > 0.0)

    def advance(self, x: Sequence[float], groups: int, dt: float) -> None:
        """Step the terms with memory by `dt` s."""
        functions = self._functions(groups)
        if functions.initial_states:
            self._states = advance_all(functions, x, self.model.values, self._states, dt)

    def reset(self) -> None:
        """Forget the memory of the terms."""
        self._groups = -1  # of what is at hand: nothing
        self._states = ()

    def _parts(self, x: Sequence[float], groups: int) -> Sequence[float]:
        if groups != self._groups:
            self._functions(groups)
        try:
            return self._contributions(x, self._values, self._states)
        except (OverflowError, ValueError, ZeroDivisionError):
            return [float("nan")] * len(self.gains)

    def _functions(self, groups: int) -> CompiledTerms:
        """The model's functions for so many motor groups, at hand until there are others."""
        if groups != self._groups:
            self._groups, self._compiled = groups, self.model.compile(groups)
            self._contributions = self._compiled.scalar_contributions
            if len(self._states) != len(self._compiled.initial_states):
                self._states = self._compiled.initial_states
        return self._compiled


# -- its bounds
@dataclass
class TorqueLimits:
    """Absolute, envelope and slew limit of a torque; N m and N m/s."""

    absolute: float
    slew: float
    counts: dict[str, int] = field(default_factory=lambda: {"absolute": 0, "envelope": 0, "slew": 0})

    def bound(self, torque: float, envelope: float) -> float:
        """The torque inside the absolute limit and +- `envelope`."""
        if abs(torque) <= envelope and abs(torque) <= self.absolute:
            return torque
        torque = self._clamped("envelope", torque, envelope)
        return self._clamped("absolute", torque, self.absolute)

    def slewed(self, torque: float, previous: float, dt: float, slew: float = 0.0) -> float:
        """The torque no further from the previous one than the slew limit, or `slew` where more, allows in `dt` s."""
        return previous + self._clamped("slew", torque - previous, max(self.slew, slew) * dt)

    def withheld(self, granted: float, slew: float) -> str:
        """What a slew limit, N m/s, takes of a torque that was granted, N m, where less is left, in words."""
        if not self.absolute < granted < math.inf:
            return ""
        return (
            f"slew_limit {slew:g} N*m/s leaves {self.absolute:g} of {granted:g} N*m: "
            f"what cannot be let go within {self.absolute / slew:g} s is not published"
        )

    def _clamped(self, name: str, value: float, bound: float) -> float:
        if abs(value) <= bound:
            return value
        self.counts[name] += 1
        return bound if value > 0.0 else -bound


# -- from one to the next without a bump
@dataclass
class Fade:
    """A factor between 0 and 1 that moves at 1/`duration` per second."""

    duration: float  # s
    value: float = 0.0

    def step(self, up: bool, dt: float, down: float | None = None) -> float:
        """Move for `dt` s; on the way down within `down` s where that is less than the duration."""
        if up:
            self.value = min(1.0, self.value + dt / self.duration)
        else:
            self.value = max(0.0, self.value - dt / min(self.duration, down or self.duration))
        return self.value


@dataclass
class Bridge:
    """A difference that is carried along and let go over `duration` s, so that the sum starts where the old value
    ended."""

    duration: float  # s
    _height: float = 0.0
    _left: float = 0.0

    def start(self, difference: float) -> None:
        """Carry `difference` (old minus new) from now on, on top of nothing else."""
        self._height, self._left = difference, self.duration

    def drop(self) -> None:
        """Carry nothing any more."""
        self._height = self._left = 0.0

    def start_again(self, difference: float) -> None:
        """Carry `difference` from now on, for as long as was left."""
        self._height = difference * self.duration / self._left if self._left else 0.0

    def stretch(self, duration: float) -> None:
        """Let go over another duration, from what is still carried."""
        self._left *= duration / self.duration
        self.duration = duration

    def value(self) -> float:
        """What is still carried."""
        return self._height * self._left / self.duration

    def step(self, dt: float) -> float:
        """Let go for `dt` s."""
        self._left = max(0.0, self._left - dt)
        return self.value()


# -- as a pressure: p = T / (n D) goes with a displacement that somebody else moves, and that a broken feedback shows,
# so that it has a bound and a rate of its own
def carried(sample: Sample, crane: Crane, config: CompensatorConfig) -> tuple[float, float]:
    """Pa on the carrying group per N m at the shaft, and its share that is fed forward; none of a group that is away.

    Below the floor of the displacement it falls to nothing with it: a group that is swung out cannot carry friction,
    whose pressure would be without bound, and one that reads past centre would push the other way.
    """
    name = config.pressure_group if len(sample.groups) != 1 else next(iter(sample.groups))
    if not crane.drive.hydraulic or name not in sample.groups:
        return 0.0, 1.0
    displacement, floor = sample.groups[name].displacement, config.min_displacement * crane.max_displacement
    if not displacement > 0.0:
        return 0.0, 0.0
    share = min(1.0, displacement / floor) if floor else 1.0
    return share * pressure_feedforward(1.0, crane.motor_count(name), max(displacement, floor)), share


@dataclass
class CarryingPressure:
    """The last published pressure, Pa, and the way from it to the next.

    It never means more torque than is published, and grows no faster than a slew limit of torque lets it at the
    present displacement; so it is over when the torque is, and falls as fast.
    """

    absolute: float
    value: float = field(default=0.0, init=False)
    clamps: int = field(default=0, init=False)
    _time: float = field(default=math.nan, init=False)

    @classmethod
    def on(cls, crane: Crane, config: CompensatorConfig) -> "CarryingPressure":
        """Bounded by what was set, and never by more than the motors are rated for, however far they are swung out."""
        return cls(min(config.pressure_limit, crane.rated_pressure or RATED_PRESSURE))

    def of(self, torque: float, per_torque: float, time: float, slew: float) -> float:
        """The pressure for a published torque in N m, at `per_torque` Pa per N m and stamp `time` s; `slew` N m/s."""
        wanted, grown = torque * per_torque, slew * per_torque * max(0.0, time - self._time)
        before = max(0.0, math.copysign(1.0, wanted) * self.value)  # of what has the same sign
        most = min(self.absolute, before + (grown if grown == grown else 0.0))
        self._time = time
        if abs(wanted) > most:
            self.clamps += 1
            wanted = math.copysign(most, wanted)
        self.value = wanted
        return wanted
