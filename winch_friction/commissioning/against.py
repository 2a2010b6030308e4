"""Runs against each other: what is alike in every run of a winch, and in some of them a unit's factor off."""

from collections.abc import Iterator, Sequence

import numpy as np

from winch_friction.commissioning.finding import Finding
from winch_friction.commissioning.mistakes import PRESSURE_UNITS
from winch_friction.physics.signals import Run
from winch_friction.physics.units import BAR

FEWEST = 3  # runs of a motor group, for most of them to say what is usual
ALIKE = 1.25  # times: boost pressures of one machine differ by less, most of the time
EXACT = 0.05  # relative, by which a unit's factor is met


def lone_units(runs: Sequence[Run]) -> Iterator[Finding]:
    """Port B of a motor group, whose pressure is the boost's, off by exactly a unit in some of the runs: too little to
    upset the torque balance, and no friction whatever."""
    channels = dict.fromkeys(name for run in runs for name in run.columns if name.endswith(".pressure_b"))
    for channel in channels:
        own = [run for run in runs if channel in run.columns]
        medians = np.array([float(np.nanmedian(run[channel])) for run in own])
        if len(own) < FEWEST or not np.all(medians > 0.0):
            continue
        usual = float(np.median(medians))
        alike = (medians < ALIKE * usual) & (medians > usual / ALIKE)
        if 2 * alike.sum() <= len(own):
            continue
        for factor, words in PRESSURE_UNITS:
            odd = ~alike & (np.abs(medians * factor / usual - 1.0) < EXACT)
            if odd.any():
                names = tuple(run.name for run, off in zip(own, odd, strict=True) if off)
                said = (
                    f"{', '.join(names)}: {channel} is {np.median(medians[odd]) / BAR:.3g} bar, in the other runs "
                    f"{usual / BAR:.3g}: {words} there?"
                )
                yield Finding("error", "unit", said, channel, names, {"factor": factor, "usual": usual})
