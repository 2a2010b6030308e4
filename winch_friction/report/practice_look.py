"""Colours, legends and names that the practice's figures and tables share."""

from typing import Any

from winch_friction.identification.friction_curve import FrictionCurve
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.units import CM3_PER_REV, RPM
from winch_friction.report.figures import COLOURS

MOTOR = ("K1", "K2", "K3", "K4", "K5")
SYSTEM = ("C1", "C2", "C3", "C4", "C5", "C6")


def colour(number: int) -> str:
    """The report's colour of this number, starting again after the last."""
    return COLOURS[number % len(COLOURS)]


def below_legend(axes: Any, columns: int = 4) -> None:
    """A legend under the axes, where it covers no curve."""
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.18), ncols=columns, fontsize=8)


def name(run: str) -> str:
    """A test's name for people."""
    return run.rpartition(".")[0] or run


def curve_label(curve: FrictionCurve) -> str:
    """A test with its displacement and load."""
    load = curve.load_torque * curve.motors
    return f"{name(curve.test)}: {curve.displacement / CM3_PER_REV:.0f} cm³/rev, {load:.0f} N·m load"


def label(parameter: str) -> str:
    """A parameter with its unit, C4 in rpm as the paper prints it."""
    units = {"K1": "N·m·s", "K2": "N·s²/m⁸", "K3": "–", "K4": "N·m", "K5": "m⁵/N", "C1": "–", "C2": "N·m", "C3": "N·m",
             "C4": "rev/min", "C5": "N·m·s", "C6": "–"}  # fmt: skip
    return f"{parameter} [{units.get(parameter, '')}]"


def shown(model: FrictionModel, parameter: str) -> float:
    """A parameter's value in the unit of `label`; a parameter that the model lacks is 0."""
    value = model.as_dict().get(parameter, 0.0)
    return value / RPM if parameter == "C4" else value
