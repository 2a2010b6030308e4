"""Figures, names and units that the practice's figures and tables share."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from winch_friction.identification.friction_curve import FrictionCurve
from winch_friction.physics.channels import CM3_PER_REV, RPM
from winch_friction.physics.friction import FrictionModel
from winch_friction.report.plots import Frame, Line, Plot, plot_html

SPEED = "motor speed [rpm]"
MOTOR = ("K1", "K2", "K3", "K4", "K5")
SYSTEM = ("C1", "C2", "C3", "C4", "C5", "C6")


@dataclass(frozen=True)
class Curve:
    """One line of a figure: its numbers, panel, look, and whose colour it takes (-1: its own)."""

    label: str
    x: Any
    y: Any
    row: int = 0
    role: str = "plain"
    kind: str = "lines"
    like: int = -1


def curves_html(title: str, x: str, rows: Sequence[str], curves: Sequence[Curve], caption: str, height: int = 300,
                link: str = "") -> str:  # fmt: skip
    """An interactive figure of curves over one quantity; each curve's numbers are a frame of the CSV."""
    frames = [Frame(each.label, {x: np.asarray(each.x, float), rows[each.row]: np.asarray(each.y, float)})
              for each in curves]  # fmt: skip
    lines = [Line(each.label, x, rows[each.row], k, each.row, each.role, each.kind, like=each.like)
             for k, each in enumerate(curves)]  # fmt: skip
    return plot_html(Plot(title, frames, lines, x, list(rows), caption, link, height=height))


def name(run: str) -> str:
    """A test's name for people."""
    return run.rpartition(".")[0] or run


def curve_label(curve: FrictionCurve) -> str:
    """A test with its displacement and load."""
    load = curve.load_torque * curve.motors
    return f"{name(curve.test)}: {curve.displacement / CM3_PER_REV:.0f} cm³/rev, {load:.0f} N·m load"


def label(parameter: str) -> str:
    """A parameter with its unit, C4 in rpm as the paper prints it."""
    units = {"K1": "N·m·s/rad", "K2": "N·s²/m⁸", "K3": "–", "K4": "N·m", "K5": "m⁵/N", "C1": "–", "C2": "N·m",
             "C3": "N·m", "C4": "rpm", "C5": "N·m·s/rad", "C6": "–"}  # fmt: skip
    return f"{parameter} [{units.get(parameter, '')}]"


def shown(model: FrictionModel, parameter: str) -> float:
    """A parameter's value in the unit of `label`; a parameter that the model lacks is 0."""
    value = model.as_dict().get(parameter, 0.0)
    return value / RPM if parameter == "C4" else value
