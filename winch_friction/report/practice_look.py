"""Colours and legends that the practice's figures share."""

from typing import Any

from winch_friction.report.figures import COLOURS


def colour(number: int) -> str:
    """The report's colour of this number, starting again after the last."""
    return COLOURS[number % len(COLOURS)]


def below_legend(axes: Any, columns: int = 4) -> None:
    """A legend under the axes, where it covers no curve."""
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.18), ncols=columns, fontsize=8)
