"""The supplier's data: torque loss of one motor over speed, pressure and displacement (paper 2 section 2.1)."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from winch_friction.identification.fit_data import FitData
from winch_friction.physics.channels import BAR, CM3_PER_REV, RPM
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import FloatArray
from winch_friction.physics.winch import operating_point

# of the smallest motor of paper 2 (50 of 170 cm^3/rev) and of its speeds (400 of 2500 rpm): what is left out there
LOW_STROKE, LOW_SPEED = 50.0 / 170.0, 400.0 / 2500.0
ROUNDED = 3e-4  # relative; 50 and 350 bar may have been written in whole psi
_UNITS = {"speed": ("rpm", RPM), "pressure": ("bar", BAR), "displacement": ("cm^3/rev", CM3_PER_REV)}
WEIGHTINGS = ("equal", "nominal", "column")


@dataclass(frozen=True)
class SupplierTable:
    """Rows of a supplier's table, SI, arrays (n,): speed rad/s, pressure Pa, displacement m^3/rad, torque loss N m.

    `weight` is the table's own weight column (ones without it); `max_displacement` m^3/rad.
    """

    name: str
    speed: FloatArray
    pressure: FloatArray
    displacement: FloatArray
    torque_loss: FloatArray
    weight: FloatArray
    max_displacement: float

    def __len__(self) -> int:
        return len(self.speed)

    @property
    def nominal_torque(self) -> FloatArray:
        """T_N = D dp in N m (paper 1 eq 21)."""
        return self.displacement * self.pressure

    def where(self, keep: FloatArray) -> "SupplierTable":
        """The rows of a mask (n,)."""
        columns = ("speed", "pressure", "displacement", "torque_loss", "weight")
        return replace(self, **{name: getattr(self, name)[keep] for name in columns})

    def fit_data(self, weighting: str = "nominal") -> FitData:
        """The table as data for a fit: `nominal` divides errors by D dp (a table's rounding is one of
        efficiency), `equal` is the papers' plain squared error, `column` uses the table's own weights. Groups are the
        displacements; errors persist over a displacement and over a pressure, so both are clusters.
        """
        return FitData(
            name=self.name,
            points=motor_points(self.speed, self.pressure, self.displacement),
            torque=self.torque_loss,
            weight=self._weights(weighting),
            group=np.round(self.displacement / CM3_PER_REV, 1),
            cluster=np.column_stack([self.displacement, self.pressure]).round(12),
        )

    def _weights(self, weighting: str) -> FloatArray:
        if weighting == "equal":
            return np.ones(len(self))
        if weighting == "column":
            return self.weight
        if weighting == "nominal":
            inverse = 1.0 / self.nominal_torque**2
            return inverse / inverse.mean()
        raise InputError(f"weighting '{weighting}' is not known; weightings are {', '.join(WEIGHTINGS)}")


@dataclass(frozen=True)
class FitRange:
    """Which rows count; paper 2's by default: 400-2500 rpm, 50-350 bar, 50 cm^3/rev to D_max. SI."""

    speed: tuple[float, float] = (400 * RPM, 2500 * RPM)
    pressure: tuple[float, float] = (50 * BAR, 350 * BAR)
    displacement: tuple[float, float] = (50 * CM3_PER_REV, float("inf"))

    @classmethod
    def usual(cls, table: SupplierTable) -> "FitRange":
        """Paper 2's range, and of a motor that is smaller, or turns slower, than its motors the same part."""
        speed, displacement = cls.speed, cls.displacement
        slowest = min(speed[0], LOW_SPEED * float(table.speed.max()))
        least = min(displacement[0], LOW_STROKE * table.max_displacement)
        return cls(speed=(slowest, speed[1]), displacement=(least, displacement[1]))

    def _inside(self, table: SupplierTable, column: str) -> Any:
        (lower, upper), values = getattr(self, column), getattr(table, column)
        return np.asarray((values >= lower * (1 - ROUNDED)) & (values <= upper * (1 + ROUNDED)))

    def left_out(self, table: SupplierTable) -> str:
        """How many rows the range leaves out, and by which column, in one line; '' for none."""
        inside = {column: self._inside(table, column) for column in _UNITS}
        kept = int(np.all(list(inside.values()), axis=0).sum())
        said = []
        for column, (unit, factor) in _UNITS.items():
            lower, upper = (each / factor for each in getattr(self, column))
            span = f"{lower:.4g} ... {upper:.4g} {unit}" if np.isfinite(upper) else f"from {lower:.4g} {unit} on"
            if not inside[column].all():
                said.append(f"{(~inside[column]).sum()} by {column} ({span} count)")
        return f"{table.name}: {len(table) - kept} of {len(table)} rows are left out: {', '.join(said)}" if said else ""

    def _off(self, table: SupplierTable) -> str:
        """Where the table and the range lie, of the columns that leave rows out."""
        said = []
        for column, (unit, factor) in _UNITS.items():
            values, (lower, upper) = getattr(table, column) / factor, (each / factor for each in getattr(self, column))
            if not self._inside(table, column).all():
                span = f"{lower:.4g} ... {upper:.4g}" if np.isfinite(upper) else f"from {lower:.4g} on"
                said.append(f"{column} {values.min():.4g} ... {values.max():.4g} {unit} ({span} count)")
        return ", ".join(said)

    def select(self, table: SupplierTable) -> SupplierTable:
        """The rows inside the range; raises `InputError` when none is."""
        keep = np.all([self._inside(table, column) for column in _UNITS], axis=0)
        if not keep.any():
            raise InputError(
                f"{table.name}: no row lies inside the range of the fit: {self._off(table)}; widen the range, or "
                "correct the unit in the header (a column without one is SI)"
            )
        return table.where(keep)


def motor_points(speed: FloatArray, pressure: FloatArray, displacement: FloatArray) -> tuple[FloatArray, ...]:
    """Operating points of one motor on its own."""
    return operating_point(
        direction=1.0, speed=speed, drum_torque=0.0, groups=[(1.0, pressure, pressure, displacement)], motor_total=1.0
    )
