"""Runs as `gap` and `check` look at them: of records merged into one file each is a run of its own, and slower columns
have values in every row.
"""

import itertools
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from winch_friction.physics.signals import Run
from winch_friction.records.slow_columns import filled

NO_PAUSE = 1e9  # s, thirty years: a clock that is wrong, which `check` says
SLOW = 10.0  # usual steps; a time in ms under [s] has steps of 20 s, and no hole where one is lost
NO_RECORD = 1.0  # s; less is no record of a winch at work
LONGEST_HOLE = 30.0  # s without a sample, after which a record is another run: half the time a swing takes


def apart(runs: Sequence[Run]) -> tuple[list[Run], list[str]]:
    """The records, those with long holes as a run for each part between them, and what is said of these: after minutes
    of silence wire, load and oil are others, and what the winch did meanwhile nobody knows. So with what is said of
    columns that are written in every n-th row only."""
    found, notes = list[Run](), list[str]()
    for run in runs:
        steps = np.diff(run.time)
        ends = np.flatnonzero(steps > max(LONGEST_HOLE, SLOW * float(np.median(steps)) if len(steps) else 0.0)) + 1
        bounds = itertools.pairwise([0, *ends.tolist(), len(run)])
        whole = [(a, b) for a, b in bounds if run.time[b - 1] - run.time[a] >= NO_RECORD]
        # a log of a sample a minute is a slow one, and not full of holes
        if not len(ends) or not whole or steps.max() > NO_PAUSE:
            found.append(run)
            continue
        found += [_part(run, f"{run.name}, part {k}", a, b) for k, (a, b) in enumerate(whole, start=1)]
        longest = float(steps.max())
        notes.append(f"{run.name}: nothing was logged for up to {longest:.3g} s; looked at as {len(whole)} runs")
    whole_rows = [filled(run) for run in found]
    return [run for run, _ in whole_rows], notes + [note for _, said in whole_rows for note in said]


def _part(run: Run, name: str, start: int, end: int) -> Run:
    columns = {each: values[start:end] for each, values in run.columns.items()}
    aside = {each: values[start:end] if len(values) == len(run) else values for each, values in run.aside.items()}
    return replace(run, name=name, columns=columns, aside=aside)
