"""Local times around the two nights in which clocks are changed: which of them went through the change, and how."""

from datetime import UTC, datetime
from zoneinfo import ZoneInfo

import numpy as np

from winch_friction.physics.signals import FloatArray

HOUR = 3600.0  # s that clocks go back
_QUARTER = 900.0  # s; zones change at whole ones


def hour_back(seconds: FloatArray) -> int:
    """The row (from 0) at which times (n,) in s go back, where they do so once and by an hour; else 0."""
    steps = np.diff(seconds)
    back = np.flatnonzero(steps < 0.0)
    if len(back) != 1 or len(steps) < 2:
        return 0
    usual = float(np.median(steps))
    return int(back[0]) + 1 if abs(steps[back[0]] + HOUR - usual) < max(5.0 * usual, 1.0) else 0


def from_utc(local: FloatArray, zone: ZoneInfo) -> FloatArray:
    """Offsets (n,) from UTC in s of local times (n,) since 1970, NaN allowed.

    A clock that was changed in the midst of the log shows it by an hour that is there twice or lacks; one that ran on
    keeps the offset that it began with. Of what is possible the times without a step back and with the least gap count.
    """
    known = np.isfinite(local)
    times = local[known]
    if not times.size:
        return np.zeros(len(local))
    quarters, which = np.unique(np.floor(times / _QUARTER), return_inverse=True)
    first, second = (np.array([_offset(q * _QUARTER, zone, fold) for q in quarters])[which] for fold in (0, 1))
    ran_on = np.full(len(times), first[0])
    turned = np.arange(len(times)) >= (hour_back(times) or len(times))
    choices = (ran_on, first, second, np.where(turned, second, first))
    found = np.zeros(len(local))
    found[known] = min(choices, key=lambda offset: _unsteadiness(times - offset))
    return found


def _unsteadiness(seconds: FloatArray) -> tuple[int, float]:
    steps = np.diff(seconds)
    return int(np.sum(steps < 0.0)), round(float(np.max(steps, initial=0.0)), 3)


def _offset(local: float, zone: ZoneInfo, fold: int) -> float:
    naive = datetime.fromtimestamp(local, UTC).replace(tzinfo=zone, fold=fold)
    offset = naive.utcoffset()
    return offset.total_seconds() if offset else 0.0
