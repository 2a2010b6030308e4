"""Supplier's tables of another shape than a row per point, and those that say two things of one point."""

from collections.abc import Iterable, Sequence

import numpy as np

from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import FloatArray
from winch_friction.records.table import Table

REPEATED = 0.02  # of D dp, between rows of one point: twice what MJ4 misses a table by (paper 1), so each is as good


def refuse_another_shape(table: Table, axes: Iterable[str]) -> None:
    """A table none of whose columns is an axis: names of another language or in parentheses, or a map of the losses."""
    if not any(name in table for name in axes):
        raise InputError(
            f"{table.path}: the columns must be 'speed [rpm]', 'pressure [bar]', 'displacement [cm^3/rev]' and one of "
            f"'efficiency [%]', 'torque [N*m]' and 'torque_loss [N*m]'; found {', '.join(table.cells)}; a map with a "
            "speed per row and a pressure per column needs a row per point"
        )


def refuse_two_of_a_point(table: Table, axes: Sequence[FloatArray], share: FloatArray) -> None:
    """Rows of one speed, pressure and displacement that lose another share of D dp: two motors, or two efficiencies."""
    _, first, point = np.unique(np.column_stack(axes), axis=0, return_index=True, return_inverse=True)
    earlier = first[point.ravel()]
    at_odds = np.flatnonzero(np.abs(share - share[earlier]) > REPEATED)
    if at_odds.size:
        row, other = table.rows[at_odds[0]], table.rows[earlier[at_odds[0]]]
        more = f", and {at_odds.size - 1} more such rows" if at_odds.size > 1 else ""
        raise InputError(
            f"{table.path} row {row}: the same speed, pressure and displacement as in row {other}, and "
            f"{100.0 * abs(share[at_odds[0]] - share[earlier[at_odds[0]]]):.3g} % of D dp between their losses{more}: "
            "two motors, or two kinds of efficiency? Leave in those of one"
        )
