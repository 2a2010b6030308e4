"""Two things measured side by side in one process: the ratio survives a noisy machine, single times do not."""

import time
from collections.abc import Callable
from statistics import median
from typing import Any

REPEATS = 5


def seconds(work: Callable[[], Any]) -> float:
    """Processor time of one call."""
    begin = time.process_time()
    work()
    return time.process_time() - begin


def paired(ours: Callable[[], Any], theirs: Callable[[], Any], repeats: int = REPEATS) -> tuple[float, float, float]:
    """Median times of both in s, and the median of the ratios of neighbouring runs, A B A B ..., after a warm-up."""
    ours(), theirs()
    times = [(seconds(ours), seconds(theirs)) for _ in range(repeats)]
    return median(a for a, _ in times), median(b for _, b in times), median(a / b for a, b in times)


def figure(value: float, unit: str, against: str = "", ratio: float | None = None, bar: str = "") -> dict[str, Any]:
    """One row of the table: a value, and where it is compared with something, with what and how it compares."""
    return {"value": value, "unit": unit, "against": against, "ratio": ratio, "bar": bar}
