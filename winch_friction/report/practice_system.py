"""Report sections of the practice, steps 2 to 4: tests, friction curves, system model, loops, joint fit."""

from collections.abc import Sequence

import numpy as np

from winch_friction.identification.friction_curve import FrictionCurve, winch_points
from winch_friction.identification.practice import Practice
from winch_friction.identification.system_fit import system_start
from winch_friction.physics.channels import BAR, CM3_PER_REV, RPM
from winch_friction.physics.winch.model_curve import usual_loads
from winch_friction.records.model_file import load_model
from winch_friction.report.base import TextSection
from winch_friction.report.plots import Frame, Line, Plot, plot_html
from winch_friction.report.practice_joint import joint_html
from winch_friction.report.practice_look import SPEED, SYSTEM, Curve, curve_label, curves_html, label, name, shown
from winch_friction.report.practice_loops import loop_html
from winch_friction.report.tables import paragraph, table_html


def system_sections(practice: Practice) -> list[TextSection]:
    """Steps 2 to 4, the second loop and the joint fit."""
    return [
        TextSection("Tests and plateaus", _tests_html(practice)),
        TextSection("Total friction from hoisting and lowering",
                    friction_html([test.curve for test in practice.system.tests])),
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
    columns = ("name", "displacement [cm³/rev]", "load [t]", "plateaus", "from [rpm]", "to [rpm]", "use")  # fmt: skip
    return table_html(columns, rows, "Evaluated test scenarios (paper 2 Tables 2 and 5)") + plateau_html(practice)


def plateau_html(practice: Practice) -> str:
    """Paper 2 Fig 6: speed and pressure drop of one cycle with its plateaus."""
    test = practice.system.tests[min(2, len(practice.system.tests) - 1)]
    run = test.run
    drop = (run["main.pressure_a"] - run["main.pressure_b"]) / BAR
    curves = [Curve("logged", run.time, run["motor_speed"] / RPM, 0, "measured"),
              Curve("logged", run.time, drop, 1, "measured")]  # fmt: skip
    for row, values in enumerate(
        ((p.speed / RPM for p in test.plateaus), (p.pressure_drop / BAR for p in test.plateaus))
    ):
        times = np.concatenate([[p.start, p.end, np.nan] for p in test.plateaus] or [[np.nan]])
        means = np.concatenate([[value, value, np.nan] for value in values] or [[np.nan]])
        curves.append(Curve("plateau", times, means, row, "after"))
    said = f"{name(run.name)}: a test cycle, and the plateaus whose means are used; paper 2 Fig 6."
    return curves_html("A test cycle", "time [s]", [SPEED, "Δp [bar]"], curves, said, 200)


def friction_html(curves: Sequence[FrictionCurve]) -> str:
    """Paper 2 Fig 7: measured total friction per motor over speed."""
    shown_curves = [Curve(curve_label(each), each.speed / RPM, each.friction_torque) for each in curves]
    said = "T_ft per motor (eq 2-6) of the fitted tests; paper 2 Fig 7."
    return curves_html("Total friction of the tests", SPEED, ["T_ft per motor [N·m]"], shown_curves, said, 360)


def _system_html(practice: Practice) -> str:
    fits = practice.system.fits
    first = next(iter(fits))
    columns = ["parameter", *fits]
    rows = [[label(p), *(shown(each.model, p) for each in fits.values())] for p in SYSTEM]
    rows.append(["cost E", *(each.cost for each in fits.values())])
    rows.append(["model evaluations", *(each.evaluations for each in fits.values())])
    said = f"Eq 7 with the supplier's motor model, cost of eq 9; condition number {fits[first].condition:.3g} for eq 8."
    return (
        paragraph(said)
        + table_html(columns, rows, "Optimised system friction parameters (paper 2 Table 3)")
        + breakdown_html(practice)
    )


def breakdown_html(practice: Practice) -> str:
    """Paper 2 Fig 8: Coulomb, stiction and viscous parts of the system friction at a heavy load, 100 t of 150 t."""
    crane, system = practice.folder.crane, practice.system.loops[0].system
    speed = np.linspace(0.0, 2000.0, 201) * RPM
    motors = practice.system.tests[0].curve.motors
    load = usual_loads(crane)[-1]
    torque = np.full_like(speed, crane.drum_torque(load))
    points = winch_points(speed, np.zeros_like(speed), np.full_like(speed, crane.max_displacement), torque, motors)
    parts = {term: part / motors for term, part in system.contributions(points).items()}
    papers = {f"paper 2 {k}": system_start().with_values(v).torque(points) / motors for k, v in _paper_cranes().items()}
    columns = {SPEED: speed / RPM, **{f"{key} [N·m]": value for key, value in {**parts, **papers}.items()}}
    lines = [Line(term.replace("_", " "), SPEED, f"{term} [N·m]", kind="area") for term in parts]
    lines += [Line(label, SPEED, f"{label} [N·m]") for label in papers]
    said = f"System friction at {load / 1e3:.3g} t on the outer layer: fit, and the papers' two cranes; paper 2 Fig 8."
    return plot_html(
        Plot("System friction", [Frame("system", columns)], lines, SPEED, ["T_fs per motor [N·m]"], said, height=320)
    )


def _paper_cranes() -> dict[str, dict[str, float]]:
    """System parameters of the papers' two cranes (Table 3)."""
    shipped = {"crane 1": "a6vm215_crane1", "crane 2": "a6vm215_crane2"}
    known = set(system_start().parameter_names)
    return {
        crane: {key: value for key, value in load_model(file).as_dict().items() if key in known}
        for crane, file in shipped.items()
    }
