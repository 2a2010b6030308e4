"""What all runs say of the wire together: whether it gives, what damps it, and whether its own weight swings along."""

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from winch_friction.discrepancy.preparation import wire_mode
from winch_friction.discrepancy.preparation.prepare import PreparedRun
from winch_friction.discrepancy.preparation.suspended_load import STILL, Mode, heavy_by_tune, no_filter
from winch_friction.discrepancy.preparation.wire_mode import DAMPING_RATIOS, FOLLOWED, LEAST_GAIN, MOST_DAMPED, TOLD
from winch_friction.physics.winch import Crane

# of the damping's logarithm; runs of one wire; the same where as many others do not object
ALIKE, FEWEST_ALIKE, FEWEST_UNOPPOSED = 0.2, 4, 3
# times what a run leaves on a rigid wire, from where on it denies the mode that others agree on: less may be chance (of
# twenty samples). Runs of half the load or more left 2 to 10 000 on rigid wires, 1.0 on elastic ones, of six winches
DENIED = 1.2
# of those that agree, how many may swing as well but seem damped otherwise, as a motion sensor's noise, a wrong inertia
# and reversals make them: which are alike is no chance. Of the swinging, what nobody tells from nothing
MOST_ASTRAY, SWINGS_LEFT = 0.5, 0.01
# a ratio that leaves so many times what a rope's leaves where a load rings: what a filter damps, both leave alike.
# Relative: what half a percent of the length and of the load moves a frequency by, twice over
BLUNT, SHARP, IN_TUNE = 0.3, 1.6, 0.02
PLAIN = 0.1  # of what swings in a run that tells alone: plain ones left 0.01 to 0.03 of it, what is blurred 0.2
STEPS = 43  # of a damping ratio from 0.01 to 0.65: a tenth each
# of what a filter's damping leaves of all runs together: winches of a motion sensor's noise left 0.9 and more by any
# rope's damping, those that plainly swing 0.03 to 0.7; in the logarithm of the runs' damping, for one wire has one
CLEARLY_BEST, MOST_SPREAD = 0.8, 0.6
# of the mass that swings, the wire's own: half of it in frequency; runs that swing most by such, and how many of them
# tell something; of the logarithm of what is left of the swing of each that tells: by less neither mass says more
HEAVY, ASKED, TELLING, PLAINLY = 0.1, 6, 3, 0.1


def agreed_damping(modes: Sequence[tuple[float, float, float]]) -> Callable[[float, float], float] | None:
    """Damping ratio as a function of frequency rad/s and mass kg, from several runs' (frequency, ratio, mass): one
    damper or one ratio, whichever they agree on better; None if on neither, or if that is damped like no wire."""
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

    `left` as in `Swing`. A load too light, or a run too short, to show a swing leaves as much with it as without and
    has no say; of which nothing is known stands for a rigid wire.
    """
    return not len(left) or _left_by(left, ratio) > DENIED


def shared_damping(
    modes: Sequence[tuple[float, float, float]], untold: Sequence[Sequence[float]] = ()
) -> Callable[[float, float], float] | None:
    """The same from (frequency, ratio, mass) of all runs that can follow their mode, if enough agree closely.

    `untold` has for each of these runs what it leaves, as `Swing.left`; one that cannot tell has no vote. By chance the
    runs would not find one damping."""
    swinging = np.array([mode for mode in modes if mode[1] > 0.0]).reshape(-1, 3)
    if len(swinging) < FEWEST_UNOPPOSED:
        return None
    frequency, ratio, mass = swinging.T
    told = list(zip(modes, untold or [()] * len(modes), strict=True))
    rigid = [each for each in told if each[0][1] <= 0.0]
    sure = np.array([no_filter(left) for mode, left in told if mode[1] > 0.0])

    def enough(alike: np.ndarray, agreed: Callable[[float, float], float]) -> bool:
        against = sum(denies(left, agreed(own, load)) for (own, _, load), left in rigid)
        opposed = against + (~alike).sum() > 0 or len(modes) < 2 * alike.sum()
        few = alike.sum() < FEWEST_ALIKE and opposed
        return not few and bool(alike.sum() > against + MOST_ASTRAY * (~alike).sum())

    found = []
    for values in (2.0 * ratio * frequency * mass, ratio):
        alike = _closest(values)
        if alike.sum() >= FEWEST_UNOPPOSED and (np.median(ratio[alike]) < MOST_DAMPED / 2.0 or sure[alike].all()):
            agreed = agreed_damping(swinging[alike].tolist())
            found += [(agreed, alike.sum())] if agreed is not None and enough(alike, agreed) else []
    known = [(mode, own) for mode, own in zip(modes, untold, strict=False) if len(own) and mode[0] > 0.0]
    return min(found, key=lambda pair: (_leaves(known, pair[0]), -pair[1]), default=(None, 0))[0]


def ringing_damping(
    modes: Sequence[tuple[float, float, float]], left: Sequence[Sequence[float]], length: Sequence[float],
    variances: Sequence[float],
) -> tuple[Callable[[float, float], float], float] | None:  # fmt: skip
    """What damps the wire and its stiffness times its length, N, from runs that ring: a sharp resonance, of one damping
    and at the frequencies that one wire gives their loads and lengths. None of fewer than two, unless the one rings so
    plainly that next to nothing of it is left, or where as many runs say that the wire does not give.

    What a motion sensor's noise looks like is damped more, moves with neither load nor length, and denies no plain
    swing. `modes`, `left`, `variances` as in `pooled_damping`, `length` of the wire in m (nan: unknown).
    """
    sharp = _sharp(modes, left, length)
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
    # one damper or one ratio: what all that follow a mode leave tells, others leave more by any that is not a filter's
    known = [(modes[k], own) for k, own in enumerate(left) if len(own) and min(own) <= LEAST_GAIN and modes[k][0] > 0.0]
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
    What else a gap holds is its run's own, so that runs tell by the logarithm of what is left, as likelihoods of
    unknown noise do: a calm hoist that rings down to nothing by one damping says more than a sea that any follows.
    Where that does not tell, the variance does, as likelihoods of one noise do: many runs of noise alone outvote by
    their logarithms the one whose load swings by ten times as much. Where votes are at odds this decides: runs whose
    load hardly moves vote for a rigid wire or a filter, as a motion sensor's noise rings on a computed one. What is no
    resonance leaves alike whatever damps it.
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


def _sharp(
    modes: Sequence[tuple[float, float, float]], left: Sequence[Sequence[float]], length: Sequence[float]
) -> list[int]:
    """Which runs ring as on a rope of known length: sharply, as no noise and no other cause does."""
    return [k for k, own in enumerate(left) if len(own) and 0.0 < modes[k][1] < MOST_DAMPED / 2.0 and
            min(own) <= LEAST_GAIN and _left_by(own, BLUNT) >= SHARP * min(own) and length[k] > 0.0]  # fmt: skip


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
    """The share that a damping ratio leaves, between those of `DAMPING_RATIOS`; beyond them the last's."""
    return float(np.interp(np.log(ratio), np.log(DAMPING_RATIOS), left))


def _closest(values: np.ndarray) -> np.ndarray:
    """Which of them lie within `ALIKE` of one of them, as many as can be."""
    off = np.abs(np.log(values[:, None] / values))
    return np.asarray(off[np.argmax((off <= ALIKE).sum(axis=1))] <= ALIKE)


# -- what all runs say
def swinging_along(
    prepared: Sequence[PreparedRun], crane: Crane, again: Callable[[int, float], PreparedRun]
) -> list[PreparedRun]:
    """Runs whose wire's own mass swings along where one stiffness then fits them, or, unless one fits already, those of
    heavy wires swing less. `again` prepares a run so, by its place and its wire's mass in kg."""
    weights = crane.wire_mass * np.nan_to_num([_length(run) for run in prepared])
    along = (STILL * weights > HEAVY * np.array([run.swinging for run in prepared])) & np.isfinite(crane.wire_stiffness)
    heavy = sorted(map(int, np.flatnonzero(along)), key=lambda k: -prepared[k].swing_variance)[:ASKED]
    said = _by_one_stiffness(prepared, weights)
    tried = {k: again(k, float(weights[k])) for k in heavy} if said is not False else {}
    less = [np.log(_least(own) / _least(prepared[k])) for k, own in tried.items()]
    if not (less and (said or np.sum(less) <= -PLAINLY * min(len(less), TELLING))):
        return list(prepared)
    return [tried.get(k) or again(k, float(weights[k])) for k in range(len(prepared))]


def _by_one_stiffness(prepared: Sequence[PreparedRun], weights: np.ndarray) -> bool | None:
    """As `heavy_by_tune`, from the runs that ring: None of too few."""
    length, modes = [_length(run) for run in prepared], [(*run.wire_mode[:2], run.swinging) for run in prepared]
    sharp = _sharp(modes, [_said(run) for run in prepared], length)
    told = (np.array(modes)[sharp, 0], np.array(length)[sharp], np.array(modes)[sharp, 2], weights[sharp])
    return heavy_by_tune(*told) if len(sharp) >= FEWEST_UNOPPOSED else None


def _least(run: PreparedRun) -> float:
    """The share of what swings that the best damping leaves; 1: tells of none."""
    return min(wire_mode.least_left(_said(run)), 1.0) + SWINGS_LEFT if run.swing_left else 1.0


def agreed_modes(prepared: Sequence[PreparedRun]) -> list[Mode]:
    """The wire is elastic in every run or in none: what a single run takes for swinging may be another effect.

    All share what damps it: what two tell that ring as this wire makes their loads do; else what most that can tell
    agree on closely, unless most of heave compensation denies it, where reversals blur a swing but do not take it away
    (a load too light to show one has no vote); else what swings in all of them together. If none of these tells, heave
    compensation decides, which excites the mode throughout, and of a sparse log the kicks of the others as well."""
    compensating = [run for run in prepared if len(run.groups) > 1] or list(prepared)
    able = [run for run in prepared if _slow(run, TOLD)]
    modes, variances = [(*run.wire_mode[:2], run.swinging) for run in able], [run.swing_variance for run in able]
    left = [_said(run) for run in able]
    ringing = ringing_damping(modes, left, [_length(run) for run in able], variances)
    plain, ratio = ringing is not None, ringing[0] if ringing else shared_damping(modes, left)
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
        return [run.wire_mode._replace(damping=0.0, follows=None) for run in prepared]
    said = [run.wire_mode.follows for run in prepared if run.wire_mode.follows is not None]
    follows = 2 * sum(said) >= len(said)  # as a spring's stiffness does, unless the runs that tell deny it
    return [
        run.wire_mode._replace(
            frequency=at, damping=ratio(at, run.swinging) if _slow(run) else 0.0, unheard=_rings(run, ratio, plain),
            follows=run.wire_mode.follows if run.wire_mode.damping > 0.0 else follows,
        )
        for run, at in ((run, _in_tune(run, ringing[1]) if ringing else run.wire_mode.frequency) for run in prepared)
    ]  # fmt: skip


def _length(run: PreparedRun) -> float:
    """Of the wire, m; nan where nobody logged it."""
    return float(np.median(run.channels.get("wire_out", [np.nan])))


def _in_tune(run: PreparedRun, stiffness: float) -> float:
    """The frequency of a run's mode, rad/s, unless it is off what the wire's stiffness times its length, N, gives."""
    given, own = float(np.sqrt(stiffness / max(run.swinging * _length(run), 1e-9))), run.wire_mode.frequency
    return given if own > 0.0 and abs(np.log(own / given)) > IN_TUNE else own


def _outvoted(able: Sequence[PreparedRun], ratio: Callable[[float, float], float]) -> bool:
    """Whether as many runs speak against a load so damped as ring like one on a rope: a filter's damping takes a motion
    sensor's noise out of heave compensation and tears others apart. Two outvote any number that it suits as well."""
    ringing = [run for run in able if 0.0 < run.wire_mode.damping < MOST_DAMPED]
    ropes = sum(not _blunt(run) for run in ringing)
    return sum(_denied(run, ratio) for run in able) >= max(ropes, min(len(ringing), 2), 1)


def _blunt(run: PreparedRun) -> bool:
    """Whether no rope's damping leaves clearly less of a run's swinging than a filter's does."""
    left, filters = _said(run), np.searchsorted(DAMPING_RATIOS, MOST_DAMPED / 2.0)
    return bool(left) and min(left[:filters]) > CLEARLY_BEST * min(left[filters:])


def _denied(run: PreparedRun, ratio: Callable[[float, float], float]) -> bool:
    """Whether a run speaks against a load that swings so damped."""
    return run.wire_mode.damping <= 0.0 and denies(_said(run), ratio(run.wire_mode.frequency, run.swinging))


def _rings(run: PreparedRun, ratio: Callable[[float, float], float], plain: bool) -> bool:
    """Whether a computed wire would make noise ring that no motor feels; any, where others ring `plain`."""
    tells = (run.swing_noise or plain) and run.wire_mode.damping <= 0.0 and _slow(run)
    return tells and denies(run.swing_left, ratio(run.wire_mode.frequency, run.swinging))


def _said(run: PreparedRun) -> tuple[float, ...]:
    """What a swing of each damping ratio would leave of a run; that its sensors' noise rings is nothing against one."""
    return tuple(min(each, 1.0) for each in run.swing_left) if run.swing_noise else run.swing_left


def _slow(run: PreparedRun, turn: float = FOLLOWED) -> bool:
    """Whether the wire's mode turns by less than so much, rad, in a sample."""
    return 0.0 < run.wire_mode.frequency * run.dt < turn
