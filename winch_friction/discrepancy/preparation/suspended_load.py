"""What hangs on the wire, mass, radius, and the acceleration that it takes part in; and what damps the wire.

Where the rope's force, or the load's torque at the shaft, was measured, that is the load with all it does, and the mass
behind it need not be known. One damper or one damping ratio is taken for all runs, if they agree on it.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from winch_friction.discrepancy.preparation.grid import Grid, smooth
from winch_friction.discrepancy.preparation.seen import Motion
from winch_friction.discrepancy.preparation.wire_mode import DAMPING_RATIOS, LEAST_GAIN, MOST_DAMPED, Mode, on_the_wire
from winch_friction.physics.channels import GRAVITY
from winch_friction.physics.signals import FloatArray
from winch_friction.physics.winch import Crane

CONSTANT = 0.05  # a load cell's noise is not the load: a hanging mass that stays within 5 % is constant ...
# ... but for the wire paid out, where the cell hangs below it: of the variance that the smoothed mass has beside the
# load's acceleration, the share that a straight line over the length must explain, and what a metre may weigh, times
# what the crane file says or in kg/m
FOLLOWS_WIRE, HEAVIEST_WIRE, HEAVIEST_UNKNOWN = 0.5, 1.5, 200.0


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

    def on_wire(self, dt: float, mode: Mode, length: FloatArray | None) -> "SuspendedLoad":
        """The load behind the wire's mode, whose `length` m it may follow; as it is where nothing is heard of one."""
        if mode.damping <= 0.0 or mode.unheard:
            return self
        own = (dt, mode.frequency, mode.damping, length if mode.follows else None)
        moved = on_the_wire(self.acceleration, *own), on_the_wire(self.heave, *own)
        return replace(self, acceleration=moved[0], heave=moved[1])


def load_of(grid: Grid, motion: Motion, crane: Crane, known: float) -> SuspendedLoad:
    """The load on a rigid wire; `known` kg where the run has neither `hook_load` nor a measured force (NaN: none)."""
    columns, size = grid.columns, len(grid.time)
    radius, heave = _radius(grid, crane), np.zeros(size)
    tension = _tension(grid, radius, crane)
    if tension is not None:
        mass = smooth(tension, motion.window) / GRAVITY
        return SuspendedLoad(mass, radius, radius / crane.gear_ratio, np.zeros(size), heave, tension_measured=True)
    if "heave_velocity" in columns:
        heave = np.gradient(smooth(columns["heave_velocity"], motion.window), grid.dt)
    lever = radius / crane.gear_ratio
    acceleration = lever * motion.acceleration + heave
    if "hook_load" in columns:
        length = columns.get("wire_out", -motion.angle * lever)
        mass = _weighed(columns["hook_load"], length, acceleration, 5 * motion.window, crane)
    else:
        mass = np.full(size, 0.0 if np.isnan(known) else known)
    return SuspendedLoad(mass, radius, lever, acceleration, heave)


def _weighed(cell: FloatArray, wire_out: FloatArray, acceleration: FloatArray, window: int, crane: Crane) -> FloatArray:
    """The hanging mass in kg behind what a load cell says: constant, with the wire's weight where the cell has it."""
    slow = smooth(cell, window)
    if np.std(cell) > CONSTANT * abs(np.median(cell)):
        return slow
    wire = _wire_weight(slow, wire_out - np.mean(wire_out), smooth(acceleration, window), crane)
    return np.asarray(np.median(cell - wire) + wire)


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


# -- what damps the wire
ALIKE, FEWEST_ALIKE = 0.2, 4  # of the damping's logarithm; runs of one wire
FEWEST_UNOPPOSED = 3  # of such runs, where as many others do not object
# times what a run leaves on a rigid wire, from where on the mode that others agree on is denied by it: less a swing too
# small to see may leave by chance, two deviations over twenty independent samples. On rigid wires of six winches runs
# with half the load or more left 2 to 10 000 times as much, on elastic ones of six others no run left more than 1.0
DENIED = 1.2
# of those that agree, how many may swing as well but seem damped otherwise: a motion sensor's noise, an inertia that is
# wrong and reversals all make them seem so, and which of them are alike is no chance: one in ten is within `ALIKE`
MOST_ASTRAY = 0.5
SWINGS_LEFT = 0.01  # of the swinging: what is left of it by less is told from nothing by nobody
# a damping ratio that leaves so many times what a rope's leaves where a load rings on it: what is damped by a filter is
# left alike by both. Relative: what half a percent of the length and of the load moves a frequency by, twice over
BLUNT, SHARP, IN_TUNE = 0.3, 1.6, 0.02
PLAIN = 0.1  # of what swings in a run that tells alone: by 0.01 to 0.03 of it plain ones did, by 0.2 what is blurred
STEPS = 43  # of a damping ratio from 0.01 to 0.65: a tenth each
# of what a mode that is damped like a filter leaves of all runs together: winches whose motion sensor's noise was most
# of it left 0.9 and more by any rope's damping, those whose load plainly swings 0.03 to 0.7
CLEARLY_BEST = 0.8
MOST_SPREAD = 0.6  # of the runs' damping, in its logarithm; one wire has one damping


def agreed_damping(modes: Sequence[tuple[float, float, float]]) -> Callable[[float, float], float] | None:
    """Damping ratio as a function of frequency rad/s and mass kg, from several runs' (frequency, ratio, mass).

    One damper for all runs or one ratio for all, whichever the runs agree on better; None if on neither, or if what
    they agree on is damped like no wire.
    """
    frequency, ratio, mass = np.array(modes).T
    if np.median(ratio) >= MOST_DAMPED:
        return None
    damper = 2.0 * ratio * frequency * mass  # N s/m
    spreads = [float(np.std(np.log(each))) for each in (damper, ratio)]
    if min(spreads) > MOST_SPREAD:
        return None
    return _one_damper(float(np.median(damper))) if spreads[0] < spreads[1] else _one_ratio(float(np.median(ratio)))


def denies(left: Sequence[float], ratio: float) -> bool:
    """Whether a run that rings by no mode speaks against one of this damping ratio: its gap would swing more by it.

    `left` as in `Swing`. A load too light, or a run too short, to show a swing leaves as much with it as without, and
    has no say; where nothing is known of what a mode leaves, the run stands for a rigid wire.
    """
    return not len(left) or _left_by(left, ratio) > DENIED


def shared_damping(
    modes: Sequence[tuple[float, float, float]], untold: Sequence[Sequence[float]] = ()
) -> Callable[[float, float], float] | None:
    """The same from (frequency, ratio, mass) of all runs that can follow their mode, if enough of them agree closely.

    `untold` has for each of these runs what it leaves, as `Swing.left`; one that cannot tell has no vote. What else
    rings does so at no mode of the wire, whose frequency the load and the length give: by chance the runs would not
    find one damping.
    """
    swinging = np.array([mode for mode in modes if mode[1] > 0.0]).reshape(-1, 3)
    if len(swinging) < FEWEST_UNOPPOSED:
        return None
    frequency, ratio, mass = swinging.T
    rigid = [mode for mode in zip(modes, untold or [()] * len(modes), strict=True) if mode[0][1] <= 0.0]

    def enough(alike: np.ndarray, agreed: Callable[[float, float], float]) -> bool:
        against = sum(denies(left, agreed(own, load)) for (own, _, load), left in rigid)
        opposed = against + (~alike).sum() > 0 or len(modes) < 2 * alike.sum()
        few = alike.sum() < FEWEST_ALIKE and opposed
        return not few and bool(alike.sum() > against + MOST_ASTRAY * (~alike).sum())

    found = []
    for values in (2.0 * ratio * frequency * mass, ratio):
        alike = _closest(values)
        if alike.sum() >= FEWEST_UNOPPOSED and np.median(ratio[alike]) < MOST_DAMPED / 2.0:
            agreed = agreed_damping(swinging[alike].tolist())
            found += [(agreed, alike.sum())] if agreed is not None and enough(alike, agreed) else []
    # by chance many of twelve runs are alike in the one or the other: what all of them leave tells which it is
    known = [(mode, left) for mode, left in zip(modes, untold, strict=False) if len(left) and mode[0] > 0.0]
    return min(found, key=lambda pair: (_leaves(known, pair[0]), -pair[1]), default=(None, 0))[0]


def ringing_damping(
    modes: Sequence[tuple[float, float, float]], left: Sequence[Sequence[float]], length: Sequence[float],
    variances: Sequence[float],
) -> tuple[Callable[[float, float], float], float] | None:  # fmt: skip
    """What damps the wire and its stiffness times its length, N, from runs that ring: a sharp resonance, of one damping
    and at the frequencies that one wire gives their loads and lengths. None of fewer than two, unless the one rings so
    plainly that next to nothing of it is left, or where as many runs say that the wire does not give.

    What an edge of the sensors or a motion sensor's noise looks like is damped more, fits anything alike, and moves
    with neither load nor length. What a motion sensor's noise rings by on a computed wire is small beside a swing that
    is plainly there, and denies none. `modes`, `left` and `variances` as in `pooled_damping`, `length` of the wire in m
    (nan: unknown).
    """
    sharp = [k for k, own in enumerate(left) if len(own) and 0.0 < modes[k][1] < MOST_DAMPED / 2.0 and
             min(own) <= LEAST_GAIN and _left_by(own, BLUNT) >= SHARP * min(own) and length[k] > 0.0]  # fmt: skip
    alone = len(sharp) == 1 and min(left[sharp[0]]) <= PLAIN
    if len(sharp) < 2 and not alone:
        return None
    frequency, ratio, mass = np.array([modes[k] for k in sharp]).T
    stiffness = frequency**2 * mass * np.array([length[k] for k in sharp])
    off = np.abs(np.log(stiffness[:, None] / stiffness)) <= 2.0 * IN_TUNE
    same = off & (np.abs(np.log(ratio[:, None] / ratio)) <= ALIKE)
    alike = same[np.argmax(same.sum(axis=1))]
    if alike.sum() < 2 and not alone:
        return None
    # one damper or one ratio: two runs of like loads and lengths do not tell, what all of them leave does
    known = [(mode, own) for mode, own in zip(modes, left, strict=True) if len(own) and mode[0] > 0.0]
    damper = float(np.median((2.0 * ratio * frequency * mass)[alike]))
    agreed = min(_one_damper(damper), _one_ratio(float(np.median(ratio[alike]))), key=partial(_leaves, known))
    swings = min((1.0 - min(left[k])) * variances[k] for k in np.array(sharp)[alike])
    rigid = [(own, agreed(mode[0], mode[2]), each) for mode, own, each in zip(modes, left, variances, strict=True)
             if mode[1] <= 0.0]  # fmt: skip
    against = sum(denies(own, ratio) and not (len(own) and (_left_by(own, ratio) - 1.0) * each <= PLAIN * swings)
                  for own, ratio, each in rigid)  # fmt: skip
    return (agreed, float(np.median(stiffness[alike]))) if alike.sum() > against else None


def pooled_damping(
    modes: Sequence[tuple[float, float, float]], left: Sequence[Sequence[float]], variances: Sequence[float]
) -> Callable[[float, float], float] | None:
    """The damping by which least is left of what swings in all runs together; None where that is not a rope's, or
    leaves too much of it.

    `modes` as in `shared_damping`, `left` and `variances` as in `Swing`; runs of which nothing is known have no part.
    What else a run's gap holds is its own, so that runs tell by the logarithm of what is left, as likelihoods of
    unknown noise do: a calm hoist that rings down to nothing by one damping says more than a sea that is followed
    alike by any. Where votes are at odds this decides: noise of a motion sensor rings on a computed wire as well, so
    that runs whose load hardly moves the motors vote for a rigid one or one damped like a filter. A resonance has a
    damping that leaves least; a wrong inertia or a late speed, which swing by no mode, leave alike whatever damps it.
    """
    known = [k for k, own in enumerate(left) if len(own) and modes[k][0] > 0.0]
    if len(known) < FEWEST_ALIKE or sum(variances[k] for k in known) <= 0.0:
        return None
    swings = [(modes[k], left[k]) for k in known]
    usual = float(np.median([2.0 * own * mass for (own, _, mass), _ in swings]))  # N s/m
    grid = np.geomspace(DAMPING_RATIOS[0], DAMPING_RATIOS[-1], STEPS)
    tried = [*map(_one_ratio, grid), *(_one_damper(ratio * usual) for ratio in grid)]
    leaves = np.array([_leaves(swings, each) for each in tried])
    at = int(np.argmin(leaves))
    kind, place = divmod(at, STEPS)
    filtered = leaves[kind * STEPS : (kind + 1) * STEPS][grid >= MOST_DAMPED / 2.0].min()
    if grid[place] >= MOST_DAMPED / 2.0 or leaves[at] > CLEARLY_BEST * filtered:
        return None
    shares = [_left_by(own, tried[at](mode[0], mode[2])) for mode, own in swings]
    return tried[at] if np.average(shares, weights=[variances[k] for k in known]) <= 1.0 - LEAST_GAIN else None


def _leaves(
    swings: Sequence[tuple[tuple[float, float, float], Sequence[float]]], agreed: Callable[[float, float], float]
) -> float:
    """The share of the swinging that runs leave by a damping, mean of the logarithm; 1 of no run."""
    shares = [_left_by(left, agreed(frequency, mass)) for (frequency, _, mass), left in swings]
    return float(np.exp(np.mean(np.log(np.array(shares) + SWINGS_LEFT)))) if shares else 1.0


def _one_damper(damper: float) -> Callable[[float, float], float]:
    """Damping ratio by frequency rad/s and mass kg, where all runs have one damper N s/m."""
    return lambda own, load: min(damper / (2.0 * own * load), 1.0)


def _one_ratio(ratio: float) -> Callable[[float, float], float]:
    return lambda _own, _load: ratio


def _left_by(left: Sequence[float], ratio: float) -> float:
    """The share that a damping ratio leaves, between those of `DAMPING_RATIOS`; beyond them that of the last."""
    return float(np.interp(np.log(ratio), np.log(DAMPING_RATIOS), left))


def _closest(values: np.ndarray) -> np.ndarray:
    """Which of them lie within `ALIKE` of one of them, as many as can be."""
    off = np.abs(np.log(values[:, None] / values))
    return np.asarray(off[np.argmax((off <= ALIKE).sum(axis=1))] <= ALIKE)
