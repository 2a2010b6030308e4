"""Columns without a unit are SI: what gives away that somebody meant another unit."""

from collections.abc import Iterable, Mapping

import numpy as np

from winch_friction.physics.errors import InputError
from winch_friction.physics.plausible import plausible
from winch_friction.physics.signals import FloatArray, column_unit

# channel -> (smallest, largest) largest magnitude that a winch's log in SI has, and the unit that is meant outside it
_USUAL = {
    "motor_speed": (0.0, 600.0, "rpm"),  # 5700 rpm: no motor of a winch turns faster
    "speed_reference": (0.0, 600.0, "rpm"),
    "pressure_a": (2.0e4, 1.0e8, "bar"),  # 0.2 bar: the boost alone is a hundred times that
    "pressure_b": (2.0e4, 1.0e8, "bar"),
    "displacement": (0.0, 1.0e-3, "cm^3/rev"),  # 6300 cm^3/rev
    "hook_load": (100.0, 1.0e7, "t"),  # an empty hook of an offshore crane weighs more than 100 kg
}


def remarks_on_bare_columns(name: str, columns: Mapping[str, FloatArray], bare: Iterable[str]) -> list[str]:
    """What to say of columns whose header has no unit; raises `InputError` for values that no sensor in SI can give."""
    said, impossible = [], []
    for column in bare:
        channel = column.rpartition(".")[2]
        if channel not in _USUAL or column not in columns:
            continue
        values = np.abs(columns[column][np.isfinite(columns[column])])
        if not values.size or not values.any():
            continue
        lower, upper, meant = _USUAL[channel]
        largest, unit = float(values.max()), column_unit(column)
        text = f"column '{column}' has no unit and is read in {unit}: {largest:.4g} {unit} at most; if it is {meant},"
        if not plausible(channel, float(np.median(values))):
            impossible.append(f"{text} write '{column} [{meant}]'")
        elif not lower <= largest <= upper:
            said.append(f"{name}: {text} write '{column} [{meant}]'")
    if impossible:
        raise InputError(
            f"{name}: no sensor gives this: {'; '.join(impossible + [s.partition(': ')[2] for s in said])}"
        )
    return said
