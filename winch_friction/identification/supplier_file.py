"""Reading a supplier's table: CSV with units in the headers, efficiency or torque."""

import re
from pathlib import Path

import numpy as np

from winch_friction.identification.supplier_shape import refuse_another_shape, refuse_two_of_a_point
from winch_friction.identification.supplier_table import SupplierTable
from winch_friction.physics.channels import OF_GROUP, WINCH, factor_to_si
from winch_friction.physics.errors import InputError, Problems
from winch_friction.physics.signals import FloatArray
from winch_friction.records.table import Table, read_table

_AXES = {"speed": "rad/s", "pressure": "Pa", "displacement": "m^3/rad"}
LEAST_BEST_EFFICIENCY = 0.1  # any piston motor reaches several times that somewhere in its table
_MOST_LOST = 0.5  # of the largest D dp of a table: a piston motor loses a tenth there
_MAY_BE = {"torque_loss": "name it 'torque' if it is the torque at the shaft",
           "torque": "name it 'torque_loss' if it is what is lost",
           "efficiency": "an efficiency is what is left, not what is lost"}  # fmt: skip
_UNITS = {"efficiency": "1", "torque": "N*m", "torque_loss": "N*m"}
_LOSSES = tuple(_UNITS)
_CHANNELS = {"speed": "motor_speed", "pressure": "pressure_a", "displacement": "displacement",
             "torque": "motor_torque", "torque_loss": "motor_torque"}  # fmt: skip
_HEAD = 10_000  # characters; a table has ten columns at most
_NEXT_TO_NONE = 1e-9  # of the largest value that a channel can mean
_WEIGHTS = (1e-9, 1e9)


def is_supplier_table(path: Path) -> bool:
    """Whether a file's head is that of a supplier's table, whatever its rows are."""
    if path.suffix.lower() != ".csv" or not path.is_file():
        return False
    with path.open(encoding="utf-8-sig", errors="replace") as file:
        head = next((line for line in file if line.strip() and not line.startswith("#")), "")
    names = {cell.partition("[")[0].strip().strip('"') for cell in re.split("[,;\t]", head[:_HEAD])}
    return names >= set(_AXES) and bool(names & set(_LOSSES))


def read_supplier_table(path: str | Path, max_displacement: float | None = None) -> SupplierTable:
    """A supplier's table with columns speed, pressure, displacement and one of three for the loss.

    These are efficiency (hydro-mechanical), torque (at the shaft) or torque_loss; a column weight is optional. Raises
    `InputError` naming file, row and column.
    """
    table = read_table(Path(path))
    refuse_another_shape(table, _AXES)
    problems, axes = Problems(), {}
    for name, unit in _AXES.items():
        with problems:
            axes[name] = _positive(table, name, unit)
    for name in _LOSSES:
        with problems:
            if name == "efficiency" and name in table:
                _efficiency(table)
            elif name in table:
                table.column(name, _UNITS[name])
    problems.say()
    displacement = axes["displacement"]
    loss = _torque_loss(table, axes["pressure"] * displacement)
    _refuse_another_torque(table, loss, axes["pressure"] * displacement)
    refuse_two_of_a_point(table, list(axes.values()), loss / (axes["pressure"] * displacement))
    return SupplierTable(
        name=table.name,
        torque_loss=loss,
        weight=_positive(table, "weight", "1") if "weight" in table else np.ones(len(displacement)),
        max_displacement=float(max_displacement or displacement.max()),
        **axes,
    )


def _torque_loss(table: Table, nominal: FloatArray) -> FloatArray:
    given = [name for name in _LOSSES if name in table]
    if len(given) != 1:
        found = " and ".join(given) or "none"
        raise InputError(f"{table.path}: exactly one of the columns {', '.join(_LOSSES)} is needed, found {found}")
    if given == ["torque_loss"]:
        return _plausible(table, "torque_loss", table.column("torque_loss", "N*m"))
    if given == ["torque"]:
        return nominal - _torque(table, nominal)
    return (1.0 - _efficiency(table)) * nominal


def _refuse_another_torque(table: Table, loss: FloatArray, nominal: FloatArray) -> None:
    """Where a motor loses least, at its largest torque, half of it is not lost: the column is another, or its unit."""
    most, given = int(np.argmax(nominal)), next(name for name in _LOSSES if name in table)
    share = loss[most] / nominal[most]
    if share > _MOST_LOST:
        raise InputError(
            f"{table.path} row {table.rows[most]}: column '{given}': {100.0 * share:.3g} % of the largest torque D dp, "
            f"{nominal[most]:.4g} N*m, would be lost, which no motor does; {_MAY_BE[given]}, or correct the unit in "
            "the header"
        )


def _efficiency(table: Table) -> FloatArray:
    values, problems = table.column("efficiency", "1"), Problems()
    with problems:
        table.refuse("efficiency", values > 1.0, "is above 1 (100 %); a motor cannot give more torque than D dp")
    with problems:
        table.refuse("efficiency", values <= 0.0, "is not above 0; leave such rows out")
    problems.say()
    if values.max() < LEAST_BEST_EFFICIENCY:
        raise InputError(
            f"{table.path}: column 'efficiency': {100.0 * values.max():.3g} % at best is no motor's; a fraction under "
            "[%]? Write 'efficiency' without a unit, or values in per cent"
        )
    return values


def _torque(table: Table, nominal: FloatArray) -> FloatArray:
    values = table.column("torque", "N*m")
    table.refuse("torque", values > nominal * (1 + 1e-9), "is above D dp: the efficiency would exceed 1")
    return _plausible(table, "torque", values)


def _positive(table: Table, column: str, unit: str) -> FloatArray:
    values = table.column(column, unit)
    table.refuse(column, values <= 0.0, "must be above 0")
    if column == "weight":
        lower, upper = _WEIGHTS
        table.refuse(column, (values < lower) | (values > upper), f"must be {lower:g} ... {upper:g}")
        return values
    return _plausible(table, column, values)


def _plausible(table: Table, column: str, values: FloatArray) -> FloatArray:
    """The values; raises `InputError` for those that no motor has: their squares would leave the range of numbers."""
    channel = OF_GROUP.get(_CHANNELS[column]) or WINCH[_CHANNELS[column]]
    lower, upper = channel.limits
    if column in _AXES:
        lower = _NEXT_TO_NONE * upper
    said = f" ('{table.units[column]}')" if table.units[column] else " (none: SI)"
    factor = factor_to_si(channel.display, channel.unit)
    table.refuse(
        column,
        (values < lower) | (values > upper),
        f"is no motor's: {lower / factor:.4g} ... {upper / factor:.4g} {channel.display}; correct the number or the "
        f"unit in the header{said}",
    )
    return values
