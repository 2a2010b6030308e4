"""Columns that are written in every n-th row only, as a logger with several rates does, between which cells stay empty.

What changes slowly beside the motion (a load, a temperature, a setting) is held at its latest value, as the nodes hold
their inputs; what follows it (a pressure, a force) is taken between its neighbours in time, for held ones come late.
The speed alone says which rows are looked at: its change is the acceleration.
"""

from dataclasses import replace

import numpy as np

from winch_friction.physics.channels import SLOW_INPUTS
from winch_friction.physics.signals import FloatArray, Run

SPARSE = 0.67  # of the rows: what has a value in more of them has holes
FEWEST = 10  # values from which on a rhythm is one
LONGEST = 5.0  # usual steps between values that are held; beyond them there is a hole
SPEED = "motor_speed"
HELD = (*SLOW_INPUTS, "displacement")  # all others follow the motion


def rows_between(values: FloatArray) -> float:
    """The usual number of rows from one value to the next of a column written in every n-th row; 0 for any other."""
    known = np.flatnonzero(np.isfinite(values))
    if len(known) < FEWEST or len(known) > SPARSE * len(values):
        return 0.0
    steps = np.diff(known)
    usual = float(np.median(steps))
    ends = max(known[0], len(values) - 1 - known[-1])
    return 0.0 if max(steps.max(), ends) > LONGEST * usual else usual  # holes, not a slower channel


def held(values: FloatArray) -> FloatArray:
    """A column's numbers, each held until the next; the first one stands for the rows before it too."""
    known = np.flatnonzero(np.isfinite(values))
    latest = np.searchsorted(known, np.arange(len(values)), side="right") - 1
    return np.asarray(values[known[np.maximum(latest, 0)]])


def filled(run: Run) -> tuple[Run, list[str]]:
    """A run whose slower columns have values in every row that has a speed, and what is said of it."""
    slow = {name: usual for name, values in run.columns.items() if (usual := rows_between(values))}
    if not slow:
        return run, []
    kept = np.isfinite(run[SPEED]) if SPEED in slow else np.ones(len(run), bool)
    columns, notes = {name: values[kept] for name, values in run.columns.items()}, []
    for name, usual in slow.items():
        how = f"{run.name}: {name} has a value in every {usual:g} rows"
        if name == SPEED:
            notes.append(f"{how}: only these rows are looked at")
        elif name.rpartition(".")[2] in HELD:
            columns[name] = held(run[name])[kept]
            notes.append(f"{how}: held at its latest value")
        else:
            known = np.isfinite(run[name])
            columns[name] = np.interp(run.time[kept], run.time[known], run[name][known])
            notes.append(f"{how}: taken between them")
    aside = {name: values[kept] if len(values) == len(run) else values for name, values in run.aside.items()}
    return replace(run, columns=columns, aside=aside), notes
