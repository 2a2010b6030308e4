"""What all runs say of the wire together: whether it gives, what damps it, and whether its own weight swings along."""

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from winch_friction.discrepancy.preparation.prepare import PreparedRun
from winch_friction.discrepancy.preparation.suspended_load import STILL
from winch_friction.discrepancy.preparation.wire_mode import (
    DAMPING_RATIOS,
    FOLLOWED,
    LEAST_GAIN,
    MOST_DAMPED,
    TOLD,
    Mode,
)
from winch_friction.physics.signals import NAN
from winch_friction.physics.winch import Crane

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
HEAVY, ASKED = 0.1, 3  # of the mass that swings, the wire's own: half of it in frequency; runs that swing most by such
# of the mean logarithm of what swings is left, over the runs whose wire is heavy: by less neither mass says more
PLAINLY = 0.1


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
    alike by any. Where that does not tell, the variance does, as likelihoods of one noise do: many runs that hardly
    swing, and hold nothing but noise, outvote by their logarithms the one whose load swings by ten times as much. Where
    votes are at odds this decides: noise of a motion sensor rings on a computed wire as well, so that runs whose load
    hardly moves the motors vote for a rigid one or one damped like a filter. A resonance has a damping that leaves
    least; a wrong inertia or a late speed, which swing by no mode, leave alike whatever damps it.
    """
    known = [k for k, own in enumerate(left) if len(own) and modes[k][0] > 0.0]
    if len(known) < FEWEST_ALIKE or sum(variances[k] for k in known) <= 0.0:
        return None
    swings = [(modes[k], left[k]) for k in known]
    usual = float(np.median([2.0 * own * mass for (own, _, mass), _ in swings]))  # N s/m
    grid = np.geomspace(DAMPING_RATIOS[0], DAMPING_RATIOS[-1], STEPS)
    tried = [*map(_one_ratio, grid), *(_one_damper(ratio * usual) for ratio in grid)]
    shares = np.array([[_left_by(own, each(mode[0], mode[2])) for mode, own in swings] for each in tried])
    by_variance = np.average(shares, axis=1, weights=[variances[k] for k in known])
    for leaves in (np.exp(np.mean(np.log(shares + SWINGS_LEFT), axis=1)), by_variance):
        at = int(np.argmin(leaves))
        kind, place = divmod(at, STEPS)
        filtered = leaves[kind * STEPS : (kind + 1) * STEPS][grid >= MOST_DAMPED / 2.0].min()
        a_rope, clearly = grid[place] < MOST_DAMPED / 2.0, leaves[at] <= CLEARLY_BEST * filtered
        if a_rope and clearly and by_variance[at] <= 1.0 - LEAST_GAIN:
            return tried[at]
    return None


def _leaves(
    swings: Sequence[tuple[tuple[float, float, float], Sequence[float]]], agreed: Callable[[float, float], float]
) -> float:
    """The share of the swinging that runs leave by a damping, mean of the logarithm; 1 of no run."""
    shares = [_left_by(left, agreed(own, mass)) for (own, _, mass), left in swings]
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


# -- what all runs say
def swinging_along(
    prepared: Sequence[PreparedRun], crane: Crane, again: Callable[[int, float], PreparedRun]
) -> list[PreparedRun]:
    """Runs whose wire's own mass swings along where that leaves less swinging in those whose wire is heavy.

    Nobody tells whether a load cell feels the wire, or the stated weight is that of the wire that hangs there. `again`
    prepares a run so, by its place and its wire's mass in kg.
    """
    weights = crane.wire_mass * np.array([np.nan_to_num(_length(run)) for run in prepared])
    along = (STILL * weights > HEAVY * np.array([run.swinging for run in prepared])) & np.isfinite(crane.wire_stiffness)
    heavy = sorted(map(int, np.flatnonzero(along)), key=lambda k: -prepared[k].swing_variance)[:ASKED]
    tried = {k: again(k, float(weights[k])) for k in heavy}
    less = [np.log(_least(own) / _least(prepared[k])) for k, own in tried.items()]
    if not less or np.mean(less) > -PLAINLY:
        return list(prepared)
    return [tried.get(k) or again(k, float(weights[k])) for k in range(len(prepared))]


def _least(run: PreparedRun) -> float:
    """The share of what swings that the best damping leaves, 1 of a run that tells of none."""
    return min(*_said(run), 1.0) + SWINGS_LEFT if run.swing_left else 1.0


def agreed_modes(prepared: Sequence[PreparedRun]) -> list[Mode]:
    """The wire is elastic in every run or in none: what a single run takes for swinging may be another effect.

    All share what damps it: what two tell that ring as this wire makes their loads do; else what most that can tell
    agree on closely, unless most of heave compensation denies it, where friction at reversals blurs a swing but does
    not take it away (a load too light to show one has no vote); else what swings in all of them together. If none of
    these tells, heave compensation decides, which excites the mode throughout, and where a sparse log leaves its runs
    at odds the kicks of the others have a say.
    """
    compensating = [run for run in prepared if len(run.groups) > 1] or list(prepared)
    able = [run for run in prepared if _slow(run, TOLD)]
    modes, variances = [(*run.wire_mode[:2], run.swinging) for run in able], [run.swing_variance for run in able]
    left = [_said(run) for run in able]
    ringing = ringing_damping(modes, left, [_length(run) for run in able], variances)
    ratio = ringing[0] if ringing else shared_damping(modes, left)
    told = [run for run in compensating if _slow(run, TOLD)]
    if ratio is not None and not ringing and 2 * sum(_denied(run, ratio) for run in told) > len(told):
        ratio = None
    if ratio is None:
        ratio = pooled_damping(modes, left, variances)
    swinging = [(*run.wire_mode[:2], run.swinging) for run in compensating if run.wire_mode.damping > 0.0]
    if ratio is None and 2 * len(swinging) > max(3, len(compensating)):
        every = [(*run.wire_mode[:2], run.swinging) for run in prepared if run.wire_mode.damping > 0.0]
        ratio = agreed_damping(swinging) or agreed_damping(every)
        ratio = None if ratio is not None and _outvoted(able, ratio) else ratio
    if ratio is None:
        return [Mode(run.wire_mode.frequency, 0.0) for run in prepared]
    said = [run.wire_mode.follows for run in prepared if run.wire_mode.follows is not None]
    follows = 2 * sum(said) >= len(said)  # as a spring's stiffness does, unless the runs that tell deny it
    return [
        Mode(
            at, ratio(at, run.swinging) if _slow(run) else 0.0,
            run.wire_mode.follows if run.wire_mode.damping > 0.0 else follows, _rings(run, ratio, bool(ringing)),
        )
        for run, at in ((run, _in_tune(run, ringing[1]) if ringing else run.wire_mode.frequency) for run in prepared)
    ]  # fmt: skip


def _length(run: PreparedRun) -> float:
    """Of the wire, m; nan where nobody logged it."""
    return float(np.median(run.channels.get("wire_out", [NAN])))


def _in_tune(run: PreparedRun, stiffness: float) -> float:
    """The frequency of a run's mode, rad/s, unless it is off what the wire's stiffness times its length, N, gives."""
    given, own = float(np.sqrt(stiffness / max(run.swinging * _length(run), 1e-9))), run.wire_mode.frequency
    return given if own > 0.0 and abs(np.log(own / given)) > IN_TUNE else own


def _outvoted(able: Sequence[PreparedRun], ratio: Callable[[float, float], float]) -> bool:
    """Whether as many runs speak against a load that swings so damped as ring like one on a rope: a mode that is damped
    more than any rope takes the noise of a motion sensor out of heave compensation, and tears the other runs apart."""
    ringing = sum(0.0 < run.wire_mode.damping < MOST_DAMPED for run in able)
    return sum(_denied(run, ratio) for run in able) >= max(ringing, 1)


def _denied(run: PreparedRun, ratio: Callable[[float, float], float]) -> bool:
    """Whether a run speaks against a load that swings so damped."""
    return run.wire_mode.damping <= 0.0 and denies(_said(run), ratio(run.wire_mode.frequency, run.swinging))


def _rings(run: PreparedRun, ratio: Callable[[float, float], float], plain: bool) -> bool:
    """Whether a computed wire would make noise ring that no motor feels; any, where others ring `plain`."""
    tells = (run.swing_noise or plain) and run.wire_mode.damping <= 0.0 and _slow(run)
    return tells and denies(run.swing_left, ratio(run.wire_mode.frequency, run.swinging))


def _said(run: PreparedRun) -> tuple[float, ...]:
    """What a run says that a swing of each damping ratio would leave; where its sensors' noise rings by one, that is
    nothing against it."""
    return tuple(min(each, 1.0) for each in run.swing_left) if run.swing_noise else run.swing_left


def _slow(run: PreparedRun, turn: float = FOLLOWED) -> bool:
    """Whether the wire's mode turns by less than so much, rad, in a sample."""
    return 0.0 < run.wire_mode.frequency * run.dt < turn
