"""What hangs on the wire: mass, radius, and the acceleration that it takes part in.

Where the rope's force, or the load's torque at the shaft, was measured, that is the load with all it does, and the mass
behind it need not be known.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from winch_friction.discrepancy.preparation.grid import HOLE, Grid, recursive, smooth
from winch_friction.discrepancy.preparation.load_levels import level_of
from winch_friction.discrepancy.preparation.seen import Motion, Seen
from winch_friction.physics.channels import GRAVITY
from winch_friction.physics.signals import CLIMBS, FloatArray, away_from
from winch_friction.physics.winch import Crane

COURSE = "hook_load_course"  # a load cell's column whose level, another in each run, is not believed: kg
CONSTANT = 0.05  # a load cell's noise is not the load: a hanging mass that stays within 5 % is constant ...
# ... but for the wire paid out, where the cell hangs below it: of the variance that the smoothed mass has beside the
# load's acceleration, the share that a straight line over the length must explain, and what a metre may weigh, times
# what the crane file says or in kg/m
FOLLOWS_WIRE, HEAVIEST_WIRE, HEAVIEST_UNKNOWN = 0.5, 1.5, 200.0
# relative spread of a wire's stiffness over runs: by less a load is followed for a dozen periods; of it, what is less
OUT_OF_TUNE, CLEARLY_CLOSER = 0.02, 0.5
STILL, MOST_STILL = 2.0 / 3.0, 0.6  # of a wire's mass; of what hangs, of which a wire is nine tenths at most
LONGEST_CLIMB = 10.0  # s, of a drum that stands by then
SETTLED = 4.0  # decay times, down to 2 %
# times the least share that is left, by the largest damping ratio: white noise leaves 1.03, a load of ratio 0.3 five
FILTERED = 1.6
USUAL_DAMPING = 0.05  # ratio of a load on a rope, by which is told when a swing from before the record hides no other
RINGS = 2.0  # times the gap's deviation elsewhere in the run, by which its beginning, or what follows a hole, swings
MOST_SETTLING = 0.2  # of a run, left out at its beginning while the load may still swing from before
FEWEST_AFTER, FEWEST_ELSEWHERE = 20, 100  # samples: a deviation is known to a sixth, and to a fourteenth
FEWEST_MOVING = 100  # samples in which a swing can be looked for


class Mode(NamedTuple):
    """The load's mode on its wire: frequency rad/s and damping ratio (0: rigid) at the run's median length.

    `follows`: its stiffness is that of the wire paid out at every moment; None where that hardly changes. `unheard`:
    the wire gives, but what is as fast in the load's measured motion is its sensors' noise, which would ring in it.
    `share`: of what hangs, what swings; of a heavy wire the rest moves with the drum.
    """

    frequency: float
    damping: float
    follows: bool | None = None
    unheard: bool = False
    share: float = 1.0

    @property
    def settling_time(self) -> float:
        """Seconds in which a swing that began before the record dies out."""
        return SETTLED / (self.damping * self.frequency)


class Hung:
    """What hangs on an elastic wire: accelerations m/s^2 for many a mode, from the one that a rigid wire would give.

    (m s^2 + c s + k) x_load = (c s + k) x_rigid.

    With the wire's `length` m at every sample the stiffness is EA over it, and the mode that at its median; the damper
    stays what it is. Only a `share` of the mass swings so, the rest is rigid.
    """

    def __init__(self, rigid: FloatArray, dt: float, length: FloatArray | None = None, share: float = 1.0) -> None:
        self._rigid, self._share = rigid, share
        self._begin = rigid[0]  # at rest before the first sample
        moved = rigid - self._begin
        self._sums, self._differences = moved.copy(), moved.copy()
        self._sums[1:] += 2.0 * moved[:-1]
        self._sums[2:] += moved[:-2]
        self._differences[2:] -= moved[:-2]
        self._faster: FloatArray | float = 1.0 if length is None else np.sqrt(np.median(length) / length)
        self._half = 0.5 * dt * self._faster

    def acceleration(self, frequency: float, ratio: float) -> FloatArray:
        """Behind the mode of this frequency, rad/s, and damping ratio: bilinear, exact at the mode."""
        tangent = np.tan(frequency * self._half)
        square = tangent * tangent
        damped = 2.0 * ratio * tangent / self._faster
        scale = 1.0 / (1.0 + square + damped)
        driven = (square * self._sums + damped * self._differences) * scale
        before = 2.0 * (square - 1.0) * scale, (1.0 + square - damped) * scale
        swings = self._begin + recursive(before, driven)
        return swings if self._share == 1.0 else self._rigid + self._share * (swings - self._rigid)


@dataclass(frozen=True)
class SuspendedLoad:
    """Mass kg, rope radius m and upward accelerations m/s^2 of the load; `heave` is the crane's part of it."""

    mass: FloatArray
    radius: FloatArray
    lever: FloatArray  # m, radius over gear ratio
    acceleration: FloatArray
    heave: FloatArray
    tension_measured: bool = False  # then `mass` is the force over gravity, and its inertia is in it

    @property
    def drum_torque(self) -> FloatArray:
        """Of the load at rest, N m."""
        return self.mass * GRAVITY * self.radius

    @property
    def inertial_torque(self) -> FloatArray:
        """At the motor shaft, N m."""
        return self.mass * self.lever * self.acceleration

    @property
    def heave_torque(self) -> FloatArray:
        """What of it the heaving crane makes, N m at the motor shaft."""
        return self.mass * self.lever * self.heave

    def on_one_layer(self, angle: FloatArray, gear_ratio: float) -> np.ndarray:
        """Samples that are half a turn of the drum and more, by the shaft's angle in rad, away from any at which the
        layer changes: nobody logs where on the flange a rope climbs, nor how long that takes."""
        return away_from(angle, angle[1:][np.diff(self.radius) != 0.0], gear_ratio)

    def on_wire(self, dt: float, mode: Mode, length: FloatArray | None) -> "SuspendedLoad":
        """The load behind the wire's mode, whose `length` m it may follow; as it is where nothing is heard of one."""
        if mode.damping <= 0.0 or mode.unheard:
            return self
        followed = length if mode.follows else None
        hung = (Hung(each, dt, followed, mode.share) for each in (self.acceleration, self.heave))
        moved = (each.acceleration(*mode[:2]) for each in hung)
        return replace(self, acceleration=next(moved), heave=next(moved))


def swinging_mass(hanging: float, wire: float) -> float:
    """Mass in kg that swings where `wire` kg of it are its own: a third of these (Rayleigh, Theory of Sound)."""
    return hanging - STILL * wire if STILL * wire < MOST_STILL * hanging else hanging


def no_filter(left: Sequence[float]) -> bool:
    """Whether a load rings by its damping and by none larger: what a filter lets through of noise, as (1 + 4 ratio^2) /
    (4 ratio) of white noise, is least by a ratio of a half and hardly more by the largest.

    `left`: shares of what swings that are left by each damping ratio that is tried, ascending; none of an unknown.
    """
    return len(left) > 0 and left[-1] >= FILTERED * min(left)


def heavy_by_tune(frequency: FloatArray, length: FloatArray, hanging: FloatArray, wire: FloatArray) -> bool | None:
    """Whether one stiffness gives loads their frequencies in rad/s if a third of their wires' mass swings along, and
    none does if all of what hangs swings: a run's own frequency makes up for its mass, one for all of them does not.
    None where neither is clearly closer to one stiffness.

    By run: wire paid out in m, what hangs and the wire's part of it in kg.
    """
    swinging = np.array(list(map(swinging_mass, hanging, wire)))
    whole, along = (float(np.std(np.log(frequency**2 * length * mass))) for mass in (hanging, swinging))
    if max(whole, along) <= OUT_OF_TUNE or min(whole, along) >= CLEARLY_CLOSER * max(whole, along):
        return None
    return along < whole


def load_seen(seen: Seen, crane: Crane, known: float) -> SuspendedLoad:
    """`load_of` a run that was seen on this crane or one of its gear: as it was made last, where nothing of it has
    changed. A search asks for the same load for two of three models."""
    asked = crane.drum, crane.wire_mass, None if np.isnan(known) else known
    if seen.load.get("asked") != asked:
        seen.load.update(asked=asked, told=load_of(seen.grid, seen.motion, crane, known))
    told: SuspendedLoad = seen.load["told"]
    return told


def load_of(grid: Grid, motion: Motion, crane: Crane, known: float) -> SuspendedLoad:
    """The load on a rigid wire; `known` kg where the run has neither `hook_load` nor a measured force (NaN: none): the
    median of it, where the run tells its `COURSE`."""
    columns, size = grid.columns, len(grid.time)
    radius, heave = _radius(grid, crane), np.zeros(size)
    tension = _tension(grid, radius, crane)
    if tension is not None:
        mass = smooth(tension, motion.window) / GRAVITY
        return SuspendedLoad(mass, radius, radius / crane.gear_ratio, np.zeros(size), heave, tension_measured=True)
    if "heave_velocity" in columns:
        heave = np.gradient(smooth(columns["heave_velocity"], motion.window), grid.dt)
    lever = radius / crane.gear_ratio
    acceleration = lever * motion.acceleration + _climbing(lever, motion, crane, grid.dt) + heave
    cell = columns.get("hook_load", columns.get(COURSE))
    if cell is not None:
        length = columns.get("wire_out", -motion.angle * lever)
        mass = _weighed(cell, length, acceleration, 5 * motion.window, crane, grid.dt)
        mass = mass if "hook_load" in columns or np.isnan(known) else mass + (known - np.median(mass))
    else:
        mass = np.full(size, 0.0 if np.isnan(known) else known)
    return SuspendedLoad(mass, radius, lever, acceleration, heave)


def _climbing(lever: FloatArray, motion: Motion, crane: Crane, dt: float) -> FloatArray:
    """Acceleration m/s^2 of a rope that climbs onto another layer: by as much as the lever is longer it is faster then,
    and what swings on a soft wire is kicked."""
    found, longer = np.zeros(len(lever)), np.diff(lever, prepend=lever[:1])
    for k in np.flatnonzero(longer):
        half = round(min(CLIMBS * crane.gear_ratio / max(abs(motion.speed[k]), 1e-9), LONGEST_CLIMB) / (2.0 * dt))
        found[max(k - half, 0) : k + half + 1] += longer[k] * motion.speed[k] / ((2 * half + 1) * dt)
    return found


def _weighed(
    cell: FloatArray, wire_out: FloatArray, acceleration: FloatArray, window: int, crane: Crane, dt: float
) -> FloatArray:
    """The hanging mass in kg behind what a load cell says: constant but for what is set down or picked up, with the
    wire's weight where the cell has it."""
    slow = smooth(cell, window)
    if np.std(cell) > CONSTANT * abs(np.median(cell)):
        return slow
    wire = _wire_weight(slow, wire_out - np.mean(wire_out), smooth(acceleration, window), crane)
    return level_of(cell - wire, slow - wire, dt) + wire


def _wire_weight(mass: FloatArray, paid_out: FloatArray, acceleration: FloatArray, crane: Crane) -> FloatArray:
    """What the wire paid out (m, about its mean) adds to a mass, kg; zeros where the mass does not follow it.

    A cell that feels the load accelerate goes with the length as well, for in a cycle the one follows the other.
    """
    left = [_left(acceleration, each) for each in (mass, paid_out)]
    spread = float(left[1] @ left[1])
    slope = float(left[1] @ left[0]) / spread if spread > 1e-12 * float(paid_out @ paid_out) else 0.0
    heaviest = HEAVIEST_WIRE * crane.wire_mass if crane.wire_mass > 0.0 else HEAVIEST_UNKNOWN
    follows = slope**2 * spread >= FOLLOWS_WIRE * float(left[0] @ left[0])
    return slope * paid_out if follows and 0.0 < slope <= heaviest else np.zeros(len(mass))


def _left(beside: FloatArray, values: FloatArray) -> FloatArray:
    """Values without their mean and without what a multiple of the other signal makes of them."""
    along, own = beside - np.mean(beside), values - np.mean(values)
    square = float(along @ along)
    return np.asarray(own - along * (float(along @ own) / square) if square > 0.0 else own)


def _tension(grid: Grid, radius: FloatArray, crane: Crane) -> FloatArray | None:
    """The rope's force in N as it was measured, directly or as a torque at the motor shaft; None where it was not."""
    if "load_torque" in grid.columns:
        return grid.columns["load_torque"] * crane.gear_ratio / radius
    return None if "hook_load" in grid.columns else grid.columns.get("rope_force")


def _radius(grid: Grid, crane: Crane) -> FloatArray:
    radius = np.full(len(grid.time), crane.drum.radius(float("nan")))
    if "wire_layer" in grid.columns:
        layers = np.rint(grid.columns["wire_layer"])
        for layer in np.unique(layers):
            radius[layers == layer] = crane.drum.radius(float(layer))
    return radius


# -- a swing that is not that of the motion that was logged: it began before the record, or in a hole of it
def settled(grid: Grid, mode: Mode) -> np.ndarray:
    if min(mode.frequency, mode.damping) <= 0.0:
        return np.ones(len(grid.time), bool)
    return np.asarray(grid.time > min(mode.settling_time, MOST_SETTLING * grid.time[-1]))


def rung_out(grid: Grid, mode: Mode, gap: FloatArray, moving: np.ndarray) -> np.ndarray:
    """Samples without a swing from before the record, on a wire that is taken for rigid though its stiffness is known:
    what moves it so little later may have moved it much."""
    everywhere = np.ones(len(gap), bool)
    if mode.damping > 0.0:
        return everywhere
    later = settled(grid, Mode(mode.frequency, USUAL_DAMPING))
    begin, rest = gap[moving & ~later], gap[moving & later]
    if min(len(begin), len(rest)) < FEWEST_MOVING:
        return everywhere
    return later if np.std(begin) > RINGS * np.std(rest) else everywhere


def beside_holes(grid: Grid, mode: Mode, gap: FloatArray, moving: np.ndarray) -> np.ndarray:
    """Samples without a swing from a hole of the record: nobody knows how the shaft moved there, and a load rings with
    it for four decay times. Only after holes after which the gap deviates so much more than elsewhere: where the speed
    went on as a line between its ends, nothing is unknown.

    `gap` in N m; the wire's `mode` has its frequency in rad/s, and no damping where it is taken for rigid. (samples,)
    """
    found = np.ones(len(gap), bool)
    if mode.frequency <= 0.0:
        return found
    mode = mode if mode.damping > 0.0 else Mode(mode.frequency, USUAL_DAMPING)
    lasts = max(round(min(mode.settling_time, MOST_SETTLING * grid.time[-1]) / grid.dt), 1)
    edges = np.diff(np.pad(grid.valid.astype(int), 1, constant_values=1))
    begins, ends = np.flatnonzero(edges < 0), np.flatnonzero(edges > 0)
    after = [slice(end, end + lasts) for begin, end in zip(begins, ends, strict=True) if end - begin >= HOLE - 1]
    elsewhere = moving.copy()
    for own in after:
        elsewhere[own] = False
    if not after or elsewhere.sum() < FEWEST_ELSEWHERE:
        return found
    usual = float(np.std(gap[elsewhere]))
    for own in after:
        tells = gap[own][moving[own]]
        found[own] &= not (len(tells) >= FEWEST_AFTER and np.std(tells) > RINGS * usual)
    return found
