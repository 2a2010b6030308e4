"""What is to be said of a supplier's table once a model was fitted to it: slips in rows, units that no motor has."""

import numpy as np

from winch_friction.identification.fit_data import modelled
from winch_friction.identification.motor_identification import MotorIdentification, at_largest
from winch_friction.identification.supplier_table import SupplierTable
from winch_friction.physics.channels import BAR, CM3_PER_REV, RPM

# of D dp, from the fit: models miss low displacements by less, and a tenth of what a digit in the wrong place makes
SLIP = 0.05
STANDS_OUT = 20.0  # times the usual error of the table
SHOWN = 3
BEYOND = 1.02  # of D_max: sizes are rounded, 107 cm^3/rev is 106.7


def remarks_on(found: MotorIdentification) -> list[str]:
    """Rows that stand out from the fit, parameters at the largest value a motor may have, strokes beyond D_max."""
    table, largest = found.table, at_largest(found.chosen)
    said = [*_beyond(table), *([f"{table.name}: {largest}?"] if largest else [])]
    return said + _slips(found, table)


def _beyond(table: SupplierTable) -> list[str]:
    most = float(table.displacement.max())
    if most <= BEYOND * table.max_displacement:
        return []
    return [
        f"{table.name}: displacements up to {most / CM3_PER_REV:.4g} cm^3/rev, and the motor's largest is given as "
        f"{table.max_displacement / CM3_PER_REV:.4g}: the table of another motor?"
    ]


def _slips(found: MotorIdentification, table: SupplierTable) -> list[str]:
    share = table.torque_loss / table.nominal_torque
    fitted = modelled(found.chosen.fitted.model, table.fit_data(found.weighting)) / table.nominal_torque
    off = np.abs(share - fitted)
    rows = np.flatnonzero(off > max(SLIP, STANDS_OUT * float(np.median(off))))
    rows = rows[np.argsort(-off[rows])]
    more = f" (and {len(rows) - SHOWN} more such rows)" if len(rows) > SHOWN else ""
    return [
        f"{table.name}: at {table.speed[k] / RPM:.4g} rpm, {table.pressure[k] / BAR:.4g} bar and "
        f"{table.displacement[k] / CM3_PER_REV:.4g} cm^3/rev {100.0 * share[k]:.3g} % of D dp are lost, where the fit "
        f"to all rows says {100.0 * fitted[k]:.3g} %: a slip in the table?" + (more if n == SHOWN - 1 else "")
        for n, k in enumerate(rows[:SHOWN])
    ]
