"""Times that a logger cuts to whole ticks: rows of one tick laid evenly, fractions kept in a column of their own."""

import numpy as np

from winch_friction.importing.log import LogColumn
from winch_friction.physics.signals import FloatArray

_UNSTEADY = 0.5  # periods that a steady clock's row may miss its tick by, for what its own jitter is
_PAUSE = 5.0  # usual ticks; a longer way to the next is a gap in the log, as in `records.run_checks`: no row lies in it


def fraction_unit(seconds: FloatArray, column: LogColumn) -> str:
    """The unit in which a column holds the fraction of these whole seconds, '' where it does not.

    Within each second it rises from near nothing to near the whole, and starts again with the next.
    """
    values = column.values
    if not column.numeric or not np.isfinite(values).all() or not np.isfinite(seconds).all() or values.min() < 0.0:
        return ""
    if np.any(seconds % 1.0 != 0.0) or np.ptp(seconds) < 2.0:
        return ""
    same = np.diff(seconds) == 0.0
    rises = np.diff(values) >= 0.0
    if not same.any() or rises[same].mean() < 0.98 or rises[~same].mean() > 0.5:
        return ""
    return next((u for u, most in (("ms", 1e3), ("us", 1e6), ("ns", 1e9)) if 0.5 * most < values.max() < most), "")


def rows_of_one_tick(seconds: FloatArray) -> float:
    """Rows per different time where the ticks are regular, else 1."""
    _, counts = np.unique(seconds, return_counts=True)
    inner = counts[1:-1]
    if len(inner) < 3 or np.median(inner) < 2:
        return 1.0
    return float(np.mean(inner)) if np.mean(np.abs(inner - np.median(inner)) <= 0.35 * np.median(inner)) > 0.8 else 1.0


def spread_ticks(seconds: FloatArray) -> FloatArray:
    """Rows of one time at a steady rate where one puts every row into its tick; else laid evenly between this time and
    the next, the first and last tick like the others, and so one before a gap.
    """
    ticks, first, counts = np.unique(seconds, return_index=True, return_counts=True)
    if len(ticks) < 2 or np.any(np.diff(seconds) < 0.0) or not np.isfinite(seconds).all():
        return seconds
    steady = _steady_clock(seconds, float(np.median(np.diff(ticks))))
    if steady is not None:
        return steady
    usual = float(np.median(counts[1:-1])) if len(ticks) > 2 else float(max(counts))
    width = float(np.median(np.diff(ticks)))
    rank = np.arange(len(seconds)) - np.repeat(first, counts)
    share = np.repeat(np.maximum(counts, 1), counts).astype(float)
    ways = np.append(np.diff(ticks), width)
    ends = np.repeat(np.where(ways > _PAUSE * width, width, ways), counts)
    last, begin = (
        np.repeat(np.arange(len(ticks)) == len(ticks) - 1, counts),
        np.repeat(np.arange(len(ticks)) == 0, counts),
    )
    share = np.where(last, np.maximum(share, usual), share)
    rank = np.where(begin, rank + np.maximum(usual - counts[0], 0.0), rank)  # the first tick was joined late
    share = np.where(begin, np.maximum(share, usual), share)
    return seconds + ends * rank / share


def _steady_clock(seconds: FloatArray, tick: float) -> FloatArray | None:
    """Times at one rate that rounding or cutting to whole ticks makes of these, or None.

    A logger that writes whole seconds gives 9 and 11 rows in turn at 10 Hz; spread inside each tick, the rate would
    jump by a fifth from one to the next, and every acceleration with it.
    """
    row = np.arange(len(seconds))
    period = float(np.polyfit(row, seconds - seconds[0], 1)[0])
    off = seconds - seconds[0] - period * row
    if not period > 0.0 or np.ptp(off) > tick + _UNSTEADY * period:
        return None
    return np.asarray(seconds[0] + float(off.max() + off.min()) / 2.0 + 0.5 * tick + period * row)
