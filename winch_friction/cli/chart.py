"""A line chart in the terminal, in plain characters that every terminal has."""

from collections.abc import Mapping, Sequence

import numpy as np

MARKS = "*o+x#%@"


def chart(
    x: Sequence[float],
    lines: Mapping[str, Sequence[float]],
    x_label: str,
    y_label: str,
    width: int = 72,
    height: int = 16,
) -> str:
    """The lines over `x` (n,), one mark each, with ranges and units on the axes and a legend below."""
    across = np.asarray(x, float)
    values = {name: np.asarray(y, float) for name, y in lines.items()}
    every = np.concatenate([v[np.isfinite(v)] for v in values.values()] or [np.zeros(1)])
    low, high = min(0.0, float(every.min(initial=0.0))), float(every.max(initial=0.0))
    high = high if high > low else low + 1.0
    field = [[" "] * width for _ in range(height)]
    span = float(across[-1] - across[0]) or 1.0
    places = np.linspace(across[0], across[-1], width)
    for mark, (_, y) in zip(MARKS * 2, values.items(), strict=False):
        for column, value in enumerate(np.interp(places, across, y)):
            if np.isfinite(value):
                row = height - 1 - round((value - low) / (high - low) * (height - 1))
                field[row][column] = mark
    labels = [f"{high:9.4g}", *[" " * 9] * (height - 2), f"{low:9.4g}"]
    rows = [f"{label} |{''.join(row).rstrip()}" for label, row in zip(labels, field, strict=True)]
    left, right = f"{across[0]:.4g}", f"{across[0] + span:.4g} {x_label}"
    foot = " " * 10 + "+" + "-" * width + "\n" + " " * 11 + left + right.rjust(width - len(left))
    legend = "   ".join(f"{mark} {name}" for mark, name in zip(MARKS * 2, values, strict=False))
    return "\n".join([f"{y_label}", *rows, foot, " " * 11 + legend])
