"""What all runs say of the wire together: whether it gives, what damps it, and whether its own weight swings along."""

from collections.abc import Callable, Sequence

import numpy as np

from winch_friction.discrepancy.preparation import damping as wire
from winch_friction.discrepancy.preparation.prepare import PreparedRun
from winch_friction.discrepancy.preparation.suspended_load import STILL
from winch_friction.discrepancy.preparation.wire_mode import FOLLOWED, MOST_DAMPED, TOLD, Mode
from winch_friction.physics.signals import NAN
from winch_friction.physics.winch import Crane

HEAVY = 0.1  # of the mass that swings, by which the wire's own changes it: half of it in frequency, what tuning finds
# of the mean logarithm of what swings is left, over the runs whose wire is heavy: by less neither mass says more
PLAINLY = 0.1


def swinging_along(
    prepared: Sequence[PreparedRun], crane: Crane, again: Callable[[int, float], PreparedRun]
) -> list[PreparedRun]:
    """Runs whose wire's own mass swings along where that leaves less swinging in those whose wire is heavy.

    Nobody tells whether a load cell feels the wire, or the stated weight is that of the wire that hangs there. `again`
    prepares a run so, by its place and its wire's mass in kg.
    """
    weights = crane.wire_mass * np.array([np.nan_to_num(_length(run)) for run in prepared])
    share = STILL * weights / np.array([run.swinging for run in prepared])
    heavy = np.flatnonzero((share > HEAVY) & np.isfinite(crane.wire_stiffness))
    along = {int(k): again(int(k), float(weights[k])) for k in heavy}
    less = [np.log(_least(own) / _least(prepared[k])) for k, own in along.items()]
    if not less or np.mean(less) > -PLAINLY:
        return list(prepared)
    return [along.get(k) or again(k, float(weights[k])) for k in range(len(prepared))]


def _least(run: PreparedRun) -> float:
    """The share of what swings that the best damping leaves, 1 of a run that tells of none."""
    return min(*_said(run), 1.0) + wire.SWINGS_LEFT if run.swing_left else 1.0


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
    ringing = wire.ringing_damping(modes, left, [_length(run) for run in able], variances)
    ratio = ringing[0] if ringing else wire.shared_damping(modes, left)
    told = [run for run in compensating if _slow(run, TOLD)]
    if ratio is not None and not ringing and 2 * sum(_denied(run, ratio) for run in told) > len(told):
        ratio = None
    if ratio is None:
        ratio = wire.pooled_damping(modes, left, variances)
    swinging = [(*run.wire_mode[:2], run.swinging) for run in compensating if run.wire_mode.damping > 0.0]
    if ratio is None and 2 * len(swinging) > max(3, len(compensating)):
        every = [(*run.wire_mode[:2], run.swinging) for run in prepared if run.wire_mode.damping > 0.0]
        ratio = wire.agreed_damping(swinging) or wire.agreed_damping(every)
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
    return given if own > 0.0 and abs(np.log(own / given)) > wire.IN_TUNE else own


def _outvoted(able: Sequence[PreparedRun], ratio: Callable[[float, float], float]) -> bool:
    """Whether as many runs speak against a load that swings so damped as ring like one on a rope: a mode that is damped
    more than any rope takes the noise of a motion sensor out of heave compensation, and tears the other runs apart."""
    ringing = sum(0.0 < run.wire_mode.damping < MOST_DAMPED for run in able)
    return sum(_denied(run, ratio) for run in able) >= max(ringing, 1)


def _denied(run: PreparedRun, ratio: Callable[[float, float], float]) -> bool:
    """Whether a run speaks against a load that swings so damped."""
    return run.wire_mode.damping <= 0.0 and wire.denies(_said(run), ratio(run.wire_mode.frequency, run.swinging))


def _rings(run: PreparedRun, ratio: Callable[[float, float], float], plain: bool) -> bool:
    """Whether a computed wire would make noise ring that no motor feels; any, where others ring `plain`."""
    tells = (run.swing_noise or plain) and run.wire_mode.damping <= 0.0 and _slow(run)
    return tells and wire.denies(run.swing_left, ratio(run.wire_mode.frequency, run.swinging))


def _said(run: PreparedRun) -> tuple[float, ...]:
    """What a run says that a swing of each damping ratio would leave; where its sensors' noise rings by one, that is
    nothing against it."""
    return tuple(min(each, 1.0) for each in run.swing_left) if run.swing_noise else run.swing_left


def _slow(run: PreparedRun, turn: float = FOLLOWED) -> bool:
    """Whether the wire's mode turns by less than so much, rad, in a sample."""
    return 0.0 < run.wire_mode.frequency * run.dt < turn
