"""What comes again: periods over the wire paid out and over the turning of the drum that keep step from run to run.

Runs at depths far from each other tell a period to a thousandth, and hide it from whoever misses that: 9 m is 50 waves
on the way to 450 m. So periods that show within runs come first, each run with a phase of its own; around the best of
them those are asked for that all runs share.
"""

import numpy as np

from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.engine.grammar import Factor, Grammar
from winch_friction.discrepancy.vocabulary import PERIODS, SEEN

FINE = 6  # steps over which what keeps step at one end is a turn off at the other
MOST = 3000  # periods looked at within the runs: whoever pays out more than 300 m at once hides the shortest
PEAKS = 4  # periods that show within the runs, of which it is asked whether they keep step from run to run
TURNS = (1.0, 0.5)  # of the drum: once round, and twice


def waves(grammar: Grammar, signal: str, x: FloatArray) -> list[Factor]:
    """Waves over a signal in m that keep step from run to run; `x` (blocks,) is its mean in each."""
    whole = float(np.ptp(x))
    run = grammar.cross.problem.blocks.run
    most = max((float(np.ptp(x[run == k])) for k in np.unique(run)), default=0.0)
    shortest = max(PERIODS[0], FINE * most / MOST)
    covered = shortest * len(np.unique(np.floor(x / shortest)))  # of wire that came and went, whatever lay between
    longest = min(most, covered / SEEN)
    if longest <= 2.0 * shortest:
        return []
    coarse = np.arange(1.0 / longest, 1.0 / shortest, 1.0 / (FINE * most))
    gains = grammar.periodic(x, coarse, apart=True)[0]
    inner = np.r_[False, (gains[1:-1] >= gains[:-2]) & (gains[1:-1] > gains[2:]), False]
    peaks = sorted(inner.nonzero()[0], key=lambda k: -gains[k])[:PEAKS]
    around = np.arange(-1.0 / (FINE * most), 1.0 / (FINE * most), 1.0 / (FINE * whole))
    return [_best_wave(grammar, signal, x, coarse[peak] + around) for peak in peaks]


def turns(grammar: Grammar, x: FloatArray) -> list[Factor]:
    """Waves over the turning of the drum, whose angle is `x` rad in each block."""
    if float(np.ptp(x)) < np.pi:
        return []
    return [_best_wave(grammar, "drum_angle", x, np.array([1.0 / (2.0 * np.pi * each)])) for each in TURNS]


def _best_wave(grammar: Grammar, signal: str, x: FloatArray, frequencies: FloatArray) -> Factor:
    """The wave of these frequencies that takes most, with its phase."""
    gains, sines, cosines = grammar.periodic(x, frequencies, apart=False)
    k = int(np.argmax(gains))
    period = 1.0 / frequencies[k]
    late = -np.arctan2(cosines[k], sines[k]) / (2.0 * np.pi)
    late = 0.5 + (late - 0.5) % 1.0  # a phase of next to nothing has no room to be fitted in
    return Factor("wave", signal, (("c", float(f"{period:.6g}")), ("h", float(f"{late * period:.6g}"))))
