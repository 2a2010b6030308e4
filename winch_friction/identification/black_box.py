"""The black-box map: linear interpolation of the supplier's table, which paper 2 compares the parametric model with."""

import numpy as np
from scipy.interpolate import LinearNDInterpolator, NearestNDInterpolator, RegularGridInterpolator

from winch_friction.identification.supplier_table import SupplierTable
from winch_friction.physics.signals import FloatArray

_ONE_VALUE = 0.02  # of the largest: values of an axis that differ by no more are one, as a feedback shows them


class BlackBoxMap:
    """Torque loss of one motor by interpolation; outside the table it holds the nearest value.

    That is the map's weakness (paper 2). A complete grid is interpolated trilinearly, a table with missing corners
    over its triangulation. Along an axis with one value (the displacement of motors that do not swing) there is nothing
    to interpolate: other values are outside.
    """

    def __init__(self, table: SupplierTable) -> None:
        self._axes = np.column_stack([table.speed, table.pressure, table.displacement])
        self._scale = self._axes.max(axis=0)
        self._loss = table.torque_loss
        points = self._axes / self._scale
        self._varied = points.min(axis=0) < 1.0 - _ONE_VALUE
        self._nearest = NearestNDInterpolator(points, self._loss)
        self._inside = self._grid(points[:, self._varied]) or LinearNDInterpolator(points[:, self._varied], self._loss)

    def _grid(self, points: FloatArray) -> RegularGridInterpolator | None:
        levels = [np.unique(column) for column in points.T]
        shape = tuple(len(each) for each in levels)
        if np.prod(shape) != len(points):
            return None
        loss = np.empty(shape)
        loss[tuple(np.searchsorted(each, column) for each, column in zip(levels, points.T, strict=True))] = self._loss
        return RegularGridInterpolator(levels, loss, bounds_error=False, fill_value=np.nan)

    def torque_loss(self, speed: FloatArray, pressure: FloatArray, displacement: FloatArray) -> FloatArray:
        """Torque loss in N m per motor at |speed| rad/s, |pressure| Pa, displacement m^3/rad (n,)."""
        points = self._points(speed, pressure, displacement)
        inside = self._interpolated(points)
        return np.where(np.isnan(inside), self._nearest(points), inside)

    def outside(self, speed: FloatArray, pressure: FloatArray, displacement: FloatArray) -> FloatArray:
        """True where the map has to hold its nearest value (n,)."""
        points = self._points(speed, pressure, displacement)
        elsewhere = np.abs(points[:, ~self._varied] - 1.0).max(axis=1, initial=0.0) > _ONE_VALUE
        return np.isnan(self._interpolated(points)) | elsewhere

    def _points(self, speed: FloatArray, pressure: FloatArray, displacement: FloatArray) -> FloatArray:
        return np.column_stack(np.broadcast_arrays(np.abs(speed), np.abs(pressure), displacement)) / self._scale

    def _interpolated(self, points: FloatArray) -> FloatArray:
        return np.asarray(self._inside(points[:, self._varied]), float)
