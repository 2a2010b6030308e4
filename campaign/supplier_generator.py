"""A generated supplier's table, made to look like a real one: coarse grid, 0.1 % rounding, missing corners.

The real tables are not public. The torque loss is written here once more in plain numpy, on purpose: a table generated
by the declared terms would test them against themselves. Parameters are Table 1 of paper 2.
"""

import sys
from pathlib import Path

import numpy as np

from winch_friction.records.table import write_table

TABLE_1 = {  # D_max cm^3/rev: K1 N m s, K2 N s^2/m^8, K3 -, K4 N m, K5 m^5/N
    280: (8.38e-3, 2.58e10, 0.00519, 18.1, 1.47e-14),
    215: (4.05e-3, 3.69e10, 0.0050, 14.0, 1.16e-14),
    170: (2.48e-3, 5.01e10, 0.0049, 11.0, 0.925e-14),
}
LOW_DISPLACEMENT_LOSS = 1.5e-7  # m^3, factor of p (1 - D/D_max)^4, which MJ4 lacks: 0.5 % of T_N at 0.27 D_max
_SPEEDS = np.array([400, 600, 800, 1000, 1250, 1500, 1750, 2000, 2250, 2500])  # rpm
_PRESSURES = np.array([50, 100, 150, 200, 250, 300, 350])  # bar
_SETTINGS = np.array([1.0, 0.85, 0.7, 0.55, 0.4, 0.27])  # D / D_max
_CORNER_POWER = 1.0  # of the power at 2250 rpm and 330 bar with full displacement: above it the supplier gives nothing


def torque_loss(motor: int, rpm, bar, cm3, low_displacement_loss: float = 0.0):
    """Truth in N m of the motor with this D_max."""
    k1, k2, k3, k4, k5 = TABLE_1[motor]
    w, p, d = np.asarray(rpm) * np.pi / 30, np.asarray(bar) * 1e5, np.asarray(cm3) * 1e-6 / (2 * np.pi)
    return k1 * w + k2 * w**2 * d**3 + k3 * p * d + k4 + k5 * p**2 + low_displacement_loss * p * (1 - cm3 / motor) ** 4


def supplier_rows(motor: int, low_displacement_loss: float = 0.0, rounding: float = 0.001):
    """(rpm, bar, cm^3/rev, efficiency); missing corners: beyond the corner power, and low torque at speed."""
    rpm, bar, cm3 = (g.ravel() for g in np.meshgrid(_SPEEDS, _PRESSURES, np.round(_SETTINGS * motor), indexing="ij"))
    power = rpm * bar * cm3 / (2250 * 330 * motor)
    keep = (power <= _CORNER_POWER) & ~((bar <= 50) & (rpm >= 2250)) & ~((cm3 < 0.3 * motor) & (bar <= 50))
    rpm, bar, cm3 = rpm[keep], bar[keep], cm3[keep]
    nominal = bar * 1e5 * cm3 * 1e-6 / (2 * np.pi)
    efficiency = 1 - torque_loss(motor, rpm, bar, cm3, low_displacement_loss) / nominal
    return rpm, bar, cm3, np.round(efficiency / rounding) * rounding


def write_supplier_table(path: Path, motor: int, low_displacement_loss: float = 0.0) -> Path:
    """Write the table as CSV; efficiency in % with one decimal."""
    rpm, bar, cm3, efficiency = supplier_rows(motor, low_displacement_loss)
    columns = {
        "speed [rpm]": rpm,
        "pressure [bar]": bar,
        "displacement [cm^3/rev]": cm3.astype(int),
        "efficiency [%]": [f"{100 * value:.1f}" for value in efficiency],
    }
    comments = [
        "GENERATED, not the supplier's (campaign/supplier_generator.py):",
        f"hydro-mechanical efficiency of a {motor} cm^3/rev motor",
        "from the parameters of paper 2 Table 1, rounded to 0.1 %, coarse grid, missing corners,",
        f"with a low-displacement loss c p (1 - D/D_max)^4, c = {low_displacement_loss:g} m^3, that MJ4 lacks",
    ]
    return write_table(path, columns, comments)


def main() -> None:
    """Write the shipped tables."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "config/suppliers")
    for motor in TABLE_1:
        print(write_supplier_table(folder / f"a6vm{motor}_generated.csv", motor, LOW_DISPLACEMENT_LOSS))


if __name__ == "__main__":
    main()
