"""The black-box map: linear interpolation of the supplier's table, which paper 2 compares the parametric model with."""

import numpy as np
from scipy.interpolate import LinearNDInterpolator, NearestNDInterpolator, RegularGridInterpolator

from winch_friction.identification.supplier_table import SupplierTable
from winch_friction.physics.signals import FloatArray


class BlackBoxMap:
    """Torque loss of one motor by interpolation; outside the table it holds the nearest value.

    That is the map's weakness (paper 2). A complete grid is interpolated trilinearly, a table with missing corners
    over its triangulation.
    """

    def __init__(self, table: SupplierTable) -> None:
        self._axes = np.column_stack([table.speed, table.pressure, table.displacement])
        self._scale = self._axes.max(axis=0)
        self._loss = table.torque_loss
        self._nearest = NearestNDInterpolator(self._axes / self._scale, self._loss)
        self._inside = self._grid() or LinearNDInterpolator(self._axes / self._scale, self._loss)

    def _grid(self) -> RegularGridInterpolator | None:
        points = self._axes / self._scale
        levels = [np.unique(column) for column in points.T]
        shape = tuple(len(each) for each in levels)
        if np.prod(shape) != len(points) or min(shape) < 2:
            return None
        loss = np.empty(shape)
        loss[tuple(np.searchsorted(each, column) for each, column in zip(levels, points.T, strict=True))] = self._loss
        return RegularGridInterpolator(levels, loss, bounds_error=False, fill_value=np.nan)

    def torque_loss(self, speed: FloatArray, pressure: FloatArray, displacement: FloatArray) -> FloatArray:
        """Torque loss in N m per motor at |speed| rad/s, |pressure| Pa, displacement m^3/rad (n,)."""
        points = np.column_stack(np.broadcast_arrays(np.abs(speed), np.abs(pressure), displacement)) / self._scale
        inside = np.asarray(self._inside(points), float)
        return np.where(np.isnan(inside), self._nearest(points), inside)

    def outside(self, speed: FloatArray, pressure: FloatArray, displacement: FloatArray) -> FloatArray:
        """True where the map has to hold its nearest value (n,)."""
        points = np.column_stack(np.broadcast_arrays(np.abs(speed), np.abs(pressure), displacement)) / self._scale
        return np.isnan(np.asarray(self._inside(points), float))
