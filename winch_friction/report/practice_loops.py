"""Report of the practice: what the second loop and those after it change."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from winch_friction.identification.fit_data import modelled
from winch_friction.identification.friction_curve import FrictionCurve, curve_data
from winch_friction.identification.practice import Practice
from winch_friction.identification.supplier_table import motor_points
from winch_friction.physics.channels import BAR, CM3_PER_REV, RPM
from winch_friction.physics.friction import FrictionModel
from winch_friction.report.practice_look import (
    MOTOR,
    SPEED,
    SYSTEM,
    Curve,
    curve_label,
    curves_html,
    label,
    shown,
)
from winch_friction.report.tables import number, paragraph, table_html

SETTINGS = (1.0, 145.0 / 215.0, 70.0 / 215.0)  # of the largest displacement, as in paper 2 Fig 10
EQUAL_LOADS = 0.01  # of the heaviest; a load cell tells one load twice by less


def loop_html(practice: Practice) -> str:
    """Table 4, the motor before and after, derived system friction, map against model."""
    system = practice.system
    loops = system.loops
    columns = ["parameter", *(f"loop {loop.number}" for loop in loops)]
    rows: list[list[Any]] = [
        [label(p), *(shown(loop.model, p) for loop in loops)]
        for p in (*MOTOR, *SYSTEM)
        if p in loops[0].model.as_dict() or p in SYSTEM
    ]
    rows.append(["cost E", *(loop.cost for loop in loops)])
    if system.held_out_costs:
        rows.append(["cost E on held-out tests", *system.held_out_costs])
    return (
        paragraph(_loop_verdict(practice), "verdict")
        + table_html(columns, rows, "Optimised friction parameters (paper 2 Table 4)")
        + motor_change_html(practice)
        + derived_html(practice)
        + map_derived_html(practice)
    )


def _loop_verdict(practice: Practice) -> str:
    costs, held = [loop.cost for loop in practice.system.loops], practice.system.held_out_costs
    gain = 100.0 * (1.0 - costs[-1] / costs[0])
    said = f"{len(costs)} loops lower E by {gain:.0f} % on the fitted tests"
    if held:
        change = 100.0 * (1.0 - held[-1] / held[0])
        word = "lower" if change > 0 else "raise"
        said += f" and {word} it by {abs(change):.0f} % on the held-out ones"
        said += " (no over-fit)" if change > 0.0 else " (over-fit)"
    return said + "."


def motor_change_html(practice: Practice) -> str:
    """Paper 2 Fig 10: motor loss with old and new parameters."""
    speed = np.linspace(50, 2000, 79) * RPM
    first, last = practice.system.loops[0].motor, practice.system.loops[-1].motor
    curves = []
    largest = practice.folder.crane.max_displacement
    for k, share in enumerate(SETTINGS):
        points = motor_points(speed, np.full_like(speed, 200 * BAR), np.full_like(speed, share * largest))
        label = f"{share * largest / CM3_PER_REV:.3g} cm³/rev"
        curves.append(Curve(label, speed / RPM, first.torque(points)))
        curves.append(Curve(f"{label}, after", speed[::4] / RPM, last.torque(points)[::4], kind="dots", like=k))
    said = "Motor loss at 200 bar before (lines) and after the loops (dots); paper 2 Fig 10."
    return curves_html("Motor before and after", SPEED, ["torque loss [N·m]"], curves, said)


def _derived(curves: Sequence[FrictionCurve], motor: FrictionModel) -> list[np.ndarray]:
    return [curve.friction_torque - modelled(motor, curve_data([curve])) for curve in curves]


def _of_equal_load(curves: Sequence[FrictionCurve]) -> list[list[FrictionCurve]]:
    """The curves in groups of one load, the lightest first."""
    ordered = sorted(curves, key=lambda curve: curve.drum_torque)
    apart = EQUAL_LOADS * max(abs(curve.drum_torque) for curve in ordered)
    groups = [ordered[:1]]
    for before, curve in pairwise(ordered):
        if curve.drum_torque - before.drum_torque > apart:
            groups.append([])
        groups[-1].append(curve)
    return groups


def derived_html(practice: Practice) -> str:
    """Paper 2 Fig 11, 12, 14: derived system friction by load, first loop (lines) and last (dots)."""
    every = [test.curve for test in (*practice.system.tests, *practice.system.held_out)]
    figures = []
    for chosen in _of_equal_load(every):
        torque = f"{number(float(np.mean([curve.drum_torque for curve in chosen])) / 1e3, 4)} kN·m"
        first = _derived(chosen, practice.system.loops[0].motor)
        last = _derived(chosen, practice.system.loops[-1].motor)
        curves = []
        for k, (curve, before, after) in enumerate(zip(chosen, first, last, strict=True)):
            curves.append(Curve(_short(curve), curve.speed / RPM, before * curve.motors))
            curves.append(
                Curve(f"{_short(curve)}, after", curve.speed / RPM, after * curve.motors, kind="dots", like=k)
            )
        said = (
            f"T_d = {torque}: system friction derived by subtracting the motor, before (lines) and after "
            "the loops (dots); equal loads should coincide; paper 2 Fig 11, 12, 14."
        )
        title = f"System friction at {torque}"
        figures.append(curves_html(title, SPEED, ["T_fs, all motors [N·m]"], curves, said, 280, "derived"))
    return "".join(figures)


def _short(curve: FrictionCurve) -> str:
    return f"{curve.displacement / CM3_PER_REV:.3g} cm³/rev"


def map_derived_html(practice: Practice) -> str:
    """Paper 2 Fig 13: derived system friction with the parametric model and with the black-box map."""
    every = [test.curve for test in (*practice.system.tests, *practice.system.held_out)]
    curves = []
    for k, curve in enumerate(_extremes(every)):
        displacement = np.full_like(curve.speed, curve.displacement)
        sides = [
            practice.map.torque_loss(curve.speed, side, displacement)
            for side in (curve.pressure_up, curve.pressure_down)
        ]
        by_model = _derived([curve], practice.system.loops[0].motor)[0]
        by_map = curve.friction_torque - 0.5 * (sides[0] + sides[1])
        curves.append(Curve(curve_label(curve), curve.speed / RPM, by_model * curve.motors))
        label = f"{curve_label(curve)}, map"
        curves.append(Curve(label, curve.speed / RPM, by_map * curve.motors, kind="dots", like=k))
    said = "System friction derived with the model (lines) and with the map (dots); paper 2 Fig 13."
    return curves_html("Model and map in the loop", SPEED, ["T_fs, all motors [N·m]"], curves, said, 340)


def _extremes(curves: Sequence[FrictionCurve]) -> list[FrictionCurve]:
    """The lightest and the heaviest test at the largest and the smallest displacement."""
    ordered = sorted(curves, key=lambda curve: (round(curve.drum_torque, -3), curve.displacement))
    return list({id(each): each for each in (ordered[0], ordered[-1], *ordered[1:4:2], *ordered[-3:-1:2])}.values())[:5]
