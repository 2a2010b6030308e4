"""Samples that no sensor measured: a channel that stands still while the others live, and single ones that jump.

A transmitter that hangs repeats its last value to the last digit, and where what it measures moved on meanwhile it
leaps when it wakes; a lost telegram is one sample of 0 or of full scale.
They are made missing, which every reader knows how to leave out, and said.
"""

import itertools
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from winch_friction.physics.errors import counted
from winch_friction.physics.signals import FloatArray, Run

# what has noise whatever the winch does; a speed in counts of an encoder is the same for seconds, and hangs if it leaps
LIVING = (
    "pressure_a", "pressure_b", "motor_torque", "mechanical_power", "motor_current", "rope_force", "load_torque",
)  # fmt: skip
MEASURED = ("motor_speed", *LIVING)
STILL, FEWEST = 1.0, 20  # s and samples that a channel must repeat; slow loggers repeat a value for some samples
LIVES = 0.5  # of the steps between samples, in which a channel changes that has noise, and so does not stand by chance
LEAST_ALIVE = 0.25  # of a record, that says how the channel lives; a coarse digit stands still for most of it
JUMPS = 20.0  # usual steps between samples, from the median of three
LEAPS, QUICK = 3.0, 99.0  # times a step of this percentile: those of the hardest ramps, hangs themselves are rarer
MOST = 0.01  # of the samples; what jumps oftener is how the sensor is, and no lost telegram


def without_broken(runs: Sequence[Run]) -> tuple[list[Run], list[str]]:
    """The runs with what nobody measured as NaN, and what is said of these."""
    found, notes = list[Run](), list[str]()
    for run in runs:
        own = {name: run[name] for name in run.columns if name.rpartition(".")[2] in MEASURED}
        changes = {name: np.abs(np.diff(values)) > 0.0 for name, values in own.items()}
        mended = dict(run.columns)
        for name, values in own.items():
            others = [each for other, each in changes.items() if other != name]
            lives = name.rpartition(".")[2] in LIVING
            find = _standing if lives else _hanging
            still = find(run.time, values, changes[name], others)
            jumping = _jumping(values)
            if still.any():
                notes.append(f"{run.name}: {name} stands still for {_length(run.time, still):.3g} s; left out")
            if jumping.any():
                samples = counted(int(jumping.sum()), "single sample", "single samples")
                notes.append(f"{run.name}: {name} jumps in {samples}; left out")
            if (still | jumping).any():
                mended[name] = np.where(still | jumping, np.nan, values)
        found.append(replace(run, columns=mended))
    return found, notes


def _standing(time: FloatArray, values: FloatArray, changes: np.ndarray, others: Sequence[np.ndarray]) -> np.ndarray:
    """Samples (samples,) that repeat the one before for long, while another channel lives; none of a winch at rest."""
    still = np.zeros(len(values), bool)
    long = [(a, b) for a, b in _long_spells(time, values, changes) if values[a] != 0.0]
    rest = np.ones(len(changes), bool)
    for a, b in long:
        rest[a : b - 1] = False
    if not long or rest.mean() < LEAST_ALIVE or changes[rest].mean() < LIVES:
        return still
    for a, b in long:
        if any(each[a : b - 1].mean() >= LIVES for each in others):
            still[a + 1 : b] = True
    return still


def _hanging(time: FloatArray, values: FloatArray, changes: np.ndarray, others: Sequence[np.ndarray]) -> np.ndarray:
    """Samples (samples,) of a speed that repeat the one before for long, while another channel lives, and from which it
    leaps: a coarse one rests on its digits, and goes on from there by steps.
    """
    still, steps = np.zeros(len(values), bool), np.abs(np.diff(values))
    moved = steps[np.isfinite(steps) & (steps > 0.0)]
    for a, b in _long_spells(time, values, changes) if len(moved) else ():
        leaps = b < len(values) and steps[b - 1] > LEAPS * float(np.percentile(moved, QUICK))
        if leaps and any(each[a : b - 1].mean() >= LIVES for each in others):
            still[a + 1 : b] = True
    return still


def _long_spells(time: FloatArray, values: FloatArray, changes: np.ndarray) -> list[tuple[int, int]]:
    """First sample and end of what is repeated to the last digit for long."""
    ends = np.flatnonzero(np.concatenate([[True], changes | np.isnan(values[1:] + values[:-1]), [True]]))
    spells = [(a, b) for a, b in itertools.pairwise(ends.tolist()) if b - a >= FEWEST]
    return [(a, b) for a, b in spells if time[b - 1] - time[a] >= STILL]


def _jumping(values: FloatArray) -> np.ndarray:
    """Single samples (samples,) far from both of their neighbours."""
    none = np.zeros(len(values), bool)
    if len(values) < FEWEST:
        return none
    middle = np.median(np.stack([values[:-2], values[1:-1], values[2:]]), axis=0)
    off = np.abs(values[1:-1] - middle)
    steps = np.abs(np.diff(values))
    steps = steps[np.isfinite(steps) & (steps > 0.0)]  # a digit of a coarse transducer is no jump
    if len(steps):
        none[1:-1] = off > JUMPS * float(np.median(steps))
    return none if none.mean() <= MOST else np.zeros(len(values), bool)


def _length(time: FloatArray, marked: np.ndarray) -> float:
    return float(np.sum(np.diff(time)[marked[1:]]))
