"""Report sections of the practice, steps 2 to 4: tests, friction curves, system model, loops, joint fit."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from winch_friction.identification.friction_curve import FrictionCurve, winch_points
from winch_friction.identification.practice import Practice
from winch_friction.identification.system_fit import system_start
from winch_friction.physics.units import BAR, CM3_PER_REV, RPM
from winch_friction.records.model_file import load_model
from winch_friction.report.base import TextSection
from winch_friction.report.figures import figure_html, new_figure
from winch_friction.report.practice_joint import joint_html
from winch_friction.report.practice_look import (
    SYSTEM,
    below_legend,
    colour,
    curve_label,
    label,
    name,
    shown,
)
from winch_friction.report.practice_loops import loop_html
from winch_friction.report.tables import paragraph, table_html


def system_sections(practice: Practice) -> list[TextSection]:
    """Steps 2 to 4, the second loop and the joint fit."""
    return [
        TextSection("Tests and plateaus", _tests_html(practice)),
        TextSection("Total friction from hoisting and lowering", figure_html(
            friction_figure([test.curve for test in practice.system.tests]),
            "T_ft per motor (eq 2-6) of the fitted tests; paper 2 Fig 7.")),
        TextSection("System model", _system_html(practice)),
        TextSection("Second loop", loop_html(practice)),
        TextSection("Joint fit of motor and system", joint_html(practice)),
    ]  # fmt: skip


def _tests_html(practice: Practice) -> str:
    rows = [
        [
            name(test.run.name), f"{test.curve.displacement / CM3_PER_REV * test.curve.motors:.0f}/"
            f"{test.curve.displacement / CM3_PER_REV:.0f}", float(np.mean(test.run["hook_load"])) / 1e3,
            len(test.plateaus), test.curve.speed[0] / RPM, test.curve.speed[-1] / RPM,
            "fitted" if test in practice.system.tests else "held out",
        ]
        for test in (*practice.system.tests, *practice.system.held_out)
    ]  # fmt: skip
    columns = ("name", "displacement cm³/rev", "load t", "plateaus", "from rpm", "to rpm", "use")  # fmt: skip
    return table_html(columns, rows, "Evaluated test scenarios (paper 2 Tables 2 and 5)") + figure_html(
        plateau_figure(practice), "A test cycle; marked: the plateaus whose means are used; paper 2 Fig 6."
    )


def plateau_figure(practice: Practice) -> Any:
    """Paper 2 Fig 6: speed and pressure drop of one cycle with its plateaus."""
    test = practice.system.tests[min(2, len(practice.system.tests) - 1)]
    figure, (above, below) = new_figure(2, 1, height=2.2, sharex=True)
    run = test.run
    above.plot(run.time, run["motor_speed"] / RPM, lw=0.8)
    below.plot(run.time, (run["main.pressure_a"] - run["main.pressure_b"]) / BAR, lw=0.6, color=colour(1))
    for plateau in test.plateaus:
        above.plot([plateau.start, plateau.end], [plateau.speed / RPM] * 2, color=colour(2), lw=3)
        below.plot([plateau.start, plateau.end], [plateau.pressure_drop / BAR] * 2, color=colour(2), lw=3)
    above.set(ylabel="motor speed [rpm]", title=name(run.name))
    below.set(ylabel="Δp [bar]", xlabel="time [s]")
    return figure


def friction_figure(curves: Sequence[FrictionCurve]) -> Any:
    """Paper 2 Fig 7: measured total friction per motor over speed."""
    figure, axes = new_figure(height=3.4)
    for curve in curves:
        axes.plot(curve.speed / RPM, curve.friction_torque, "o-", ms=2.5, lw=0.9, label=curve_label(curve))
    axes.set(xlabel="motor speed [rpm]", ylabel="T_ft per motor [N·m]", ylim=(0, None))
    below_legend(axes, 2)
    return figure


def _system_html(practice: Practice) -> str:
    fits = practice.system.fits
    first = next(iter(fits))
    columns = ["model", *fits]
    rows = [[label(p), *(shown(each.model, p) for each in fits.values())] for p in SYSTEM]
    rows.append(["E", *(each.cost for each in fits.values())])
    rows.append(["model evaluations", *(each.evaluations for each in fits.values())])
    said = f"Eq 7 with the supplier's motor model, cost of eq 9; condition number {fits[first].condition:.3g} for eq 8."
    return (
        paragraph(said)
        + table_html(columns, rows, "Optimized system friction parameters (paper 2 Table 3)")
        + figure_html(
            breakdown_figure(practice),
            "System friction at 100 t on the outer layer: fit, and the papers' two cranes; paper 2 Fig 8.",
        )
    )


def breakdown_figure(practice: Practice) -> Any:
    """Paper 2 Fig 8: Coulomb, stiction and viscous parts of the system friction at 100 t."""
    figure, axes = new_figure(height=3.2)
    crane, system = practice.folder.crane, practice.system.loops[0].system
    speed = np.linspace(0.0, 2000.0, 201) * RPM
    motors = practice.system.tests[0].curve.motors
    torque = np.full_like(speed, crane.drum_torque(100e3))
    points = winch_points(speed, np.zeros_like(speed), np.full_like(speed, crane.max_displacement), torque, motors)
    bottom = np.zeros_like(speed)
    for term, part in system.contributions(points).items():
        axes.fill_between(speed / RPM, bottom / motors, (bottom + part) / motors, alpha=0.5, label=term)
        bottom = bottom + part
    for crane_name, values in _paper_cranes().items():
        model = system_start().with_values(values)
        axes.plot(speed / RPM, model.torque(points) / motors, ls="--", lw=1.0, label=f"paper 2 {crane_name}")
    axes.set(xlabel="motor speed [rpm]", ylabel="T_fs per motor [N·m]")
    axes.legend()
    return figure


def _paper_cranes() -> dict[str, dict[str, float]]:
    """System parameters of the papers' two cranes (Table 3)."""
    shipped = {"crane 1": "a6vm215_crane1", "crane 2": "a6vm215_crane2"}
    known = set(system_start().parameter_names)
    return {
        crane: {key: value for key, value in load_model(file).as_dict().items() if key in known}
        for crane, file in shipped.items()
    }
