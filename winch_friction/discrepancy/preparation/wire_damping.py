"""What damps the wire: one damper or one damping ratio for all runs, if they agree on it."""

from collections.abc import Callable, Sequence

import numpy as np

from winch_friction.discrepancy.preparation.wire_mode import DAMPING_RATIOS, LEAST_GAIN, MOST_DAMPED

ALIKE, FEWEST_ALIKE = 0.2, 4  # of the damping's logarithm; runs of one wire
# times what a run leaves on a rigid wire, from where on the mode that others agree on is denied by it: less a swing too
# small to see may leave by chance, two deviations over twenty independent samples. On rigid wires of six winches runs
# with half the load or more left 2 to 10 000 times as much, on elastic ones of six others no run left more than 1.0
DENIED = 1.2
# of those that agree, how many may swing as well but seem damped otherwise: a motion sensor's noise, an inertia that is
# wrong and reversals all make them seem so, and which of them are alike is no chance: one in ten is within `ALIKE`
MOST_ASTRAY = 0.5
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
    if len(swinging) < FEWEST_ALIKE:
        return None
    frequency, ratio, mass = swinging.T
    alike = max((_closest(each) for each in (2.0 * ratio * frequency * mass, ratio)), key=np.sum)
    if alike.sum() < FEWEST_ALIKE or np.median(ratio[alike]) >= MOST_DAMPED / 2.0:
        return None
    agreed = agreed_damping(swinging[alike].tolist())
    if agreed is None:
        return None
    rigid = [mode for mode in zip(modes, untold or [()] * len(modes), strict=True) if mode[0][1] <= 0.0]
    against = sum(denies(left, agreed(own, load)) for (own, _, load), left in rigid)
    return agreed if alike.sum() > against + MOST_ASTRAY * (~alike).sum() else None


def pooled_damping(
    modes: Sequence[tuple[float, float, float]], left: Sequence[Sequence[float]], variances: Sequence[float]
) -> Callable[[float, float], float] | None:
    """The damping by which least is left of what swings in all runs together; None where that is not a rope's, or
    leaves too much.

    `modes` as in `shared_damping`, `left` and `variances` as in `Swing`; runs of which nothing is known have no part.
    Where votes are at odds this decides: noise of a motion sensor rings on a computed wire as well, so that runs whose
    load hardly moves the motors vote for a rigid one or one damped like a filter. A resonance has a damping that leaves
    least; a wrong inertia or a late speed, which swing by no mode, leave alike whatever damps it.
    """
    known = [k for k, own in enumerate(left) if len(own) and modes[k][0] > 0.0]
    if len(known) < FEWEST_ALIKE or sum(variances[k] for k in known) <= 0.0:
        return None
    swinging = np.array([modes[k] for k in known])
    shares, weights = np.array([left[k] for k in known]), np.array([variances[k] for k in known])
    critical = 2.0 * swinging[:, 0] * swinging[:, 2]  # N s/m
    usual = float(np.median(critical))

    def leaves(ratios: np.ndarray) -> float:
        own = [_left_by(share, ratio) for share, ratio in zip(shares, ratios, strict=True)]
        return float(np.average(own, weights=weights))

    grid = np.geomspace(DAMPING_RATIOS[0], DAMPING_RATIOS[-1], STEPS)
    steady = np.array([leaves(np.full(len(known), ratio)) for ratio in grid])
    damper = np.array([leaves(ratio * usual / critical) for ratio in grid])
    best = min(steady, damper, key=lambda each: float(each.min()))
    found, filtered = float(grid[np.argmin(best)]), float(best[grid >= MOST_DAMPED / 2.0].min())
    if found >= MOST_DAMPED / 2.0 or best.min() > min(1.0 - LEAST_GAIN, CLEARLY_BEST * filtered):
        return None
    return _one_ratio(found) if best is steady else _one_damper(found * usual)


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
