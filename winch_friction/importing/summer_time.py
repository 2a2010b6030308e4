"""Local times around the two nights in which clocks are changed: which of them went through the change, and how."""

from datetime import UTC, datetime
from zoneinfo import ZoneInfo

import numpy as np

from winch_friction.physics.signals import FloatArray

HOUR = 3600.0  # s that clocks go back
_DAY, _THURSDAY, _LATEST = 86400.0, 4, 4.0 * 3600.0  # s; of 1970-01-01, Sunday being 0; s from midnight
_QUARTER = 900.0  # s; zones change at whole ones


def hour_back(seconds: FloatArray) -> int:
    """The row (from 0) at which times (n,) in s go back, where they do so once and by an hour; else 0."""
    steps = np.diff(seconds)
    back = np.flatnonzero(steps < 0.0)
    if len(back) != 1 or len(steps) < 2:
        return 0
    usual = float(np.median(steps))
    return int(back[0]) + 1 if abs(steps[back[0]] + HOUR - usual) < max(5.0 * usual, 1.0) else 0


def _hour_ahead(seconds: FloatArray) -> int:
    """The row (from 0) before which an hour lacks, where one does once and in the small hours of a Sunday; else 0."""
    steps = np.diff(seconds)
    usual = float(np.median(steps)) if len(steps) > 1 else 0.0
    ahead = np.flatnonzero(np.abs(steps - HOUR - usual) < max(5.0 * usual, 1.0))
    if len(ahead) != 1 or usual > HOUR / 2.0:
        return 0
    days, clock = divmod(float(seconds[ahead[0]]), _DAY)
    return int(ahead[0]) + 1 if (days + _THURSDAY) % 7 == 0 and clock < _LATEST else 0


def change_asked(seconds: FloatArray, first: str) -> str:
    """What to ask of times (n,) in s without a zone that show a change of clocks; '' of others. `first` is a cell."""
    back, ahead = hour_back(seconds), _hour_ahead(seconds)
    if back:
        return (
            f"'{first}' goes back by an hour at row {back + 1}: the end of summer time? set time.zone to the log's, "
            "e.g. Europe/Oslo; else cut the log there"
        )
    if ahead:
        return (
            f"'{first}' leaps by an hour at row {ahead + 1}, in the small hours of a Sunday: the beginning of summer "
            "time? set time.zone to the log's, e.g. Europe/Oslo, or to UTC where nothing was logged for an hour"
        )
    return ""


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
