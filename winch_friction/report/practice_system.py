"""Report sections of the practice, steps 2 to 4: tests, friction curves, system model, loops, joint fit."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from winch_friction.identification.fit_data import contributions, modelled
from winch_friction.identification.friction_curve import FrictionCurve, curve_data, winch_points
from winch_friction.identification.practice import Practice
from winch_friction.identification.supplier_table import motor_points
from winch_friction.identification.system_fit import system_start
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.units import BAR, CM3_PER_REV, RPM
from winch_friction.report.base import TextSection
from winch_friction.report.figures import figure_html, new_figure
from winch_friction.report.practice_look import below_legend, colour
from winch_friction.report.tables import paragraph, table_html

_MOTOR = ("K1", "K2", "K3", "K4", "K5")
_SYSTEM = ("C1", "C2", "C3", "C4", "C5", "C6")


def system_sections(practice: Practice) -> list[TextSection]:
    """Steps 2 to 4, the second loop and the joint fit."""
    return [
        TextSection("Tests and plateaus", _tests_html(practice)),
        TextSection("Total friction from hoisting and lowering", figure_html(
            friction_figure([test.curve for test in practice.system.tests]),
            "T_ft per motor (eq 2-6) of the fitted tests; paper 2 Fig 7.")),
        TextSection("System model", _system_html(practice)),
        TextSection("Second loop", _loop_html(practice)),
        TextSection("Joint fit of motor and system", _joint_html(practice)),
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


def name(run: str) -> str:
    """A test's name for people."""
    return run.rpartition(".")[0] or run


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
        axes.plot(curve.speed / RPM, curve.friction_torque, "o-", ms=2.5, lw=0.9, label=_label(curve))
    axes.set(xlabel="motor speed [rpm]", ylabel="T_ft per motor [N·m]", ylim=(0, None))
    below_legend(axes, 2)
    return figure


def _label(curve: FrictionCurve) -> str:
    load = curve.load_torque * curve.motors
    return f"{name(curve.test)}: {curve.displacement / CM3_PER_REV:.0f} cm³/rev, {load:.0f} N·m load"


def _system_html(practice: Practice) -> str:
    fits = practice.system.fits
    first = next(iter(fits))
    columns = ["model", *fits]
    rows = [[label(p), *(shown(each.model, p) for each in fits.values())] for p in _SYSTEM]
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


def label(parameter: str) -> str:
    """A parameter with its unit, C4 in rpm as the paper prints it."""
    units = {"K1": "N·m·s", "K2": "N·s²/m⁸", "K3": "–", "K4": "N·m", "K5": "m⁵/N", "C1": "–", "C2": "N·m", "C3": "N·m",
             "C4": "rev/min", "C5": "N·m·s", "C6": "–"}  # fmt: skip
    return f"{parameter} [{units.get(parameter, '')}]"


def shown(model: FrictionModel, parameter: str) -> float:
    """A parameter's value in the unit of `label`; a parameter that the model lacks is 0."""
    value = model.as_dict().get(parameter, 0.0)
    return value / RPM if parameter == "C4" else value


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
    for crane_name, values in _PAPER_CRANES.items():
        model = system_start().with_values(values)
        axes.plot(speed / RPM, model.torque(points) / motors, ls="--", lw=1.0, label=f"paper 2 {crane_name}")
    axes.set(xlabel="motor speed [rpm]", ylabel="T_fs per motor [N·m]")
    axes.legend()
    return figure


def _paper_cranes() -> dict[str, dict[str, float]]:
    from winch_friction.records.model_file import load_model

    shipped = {"crane 1": "a6vm215_crane1", "crane 2": "a6vm215_crane2"}
    known = set(system_start().parameter_names)
    return {
        crane: {key: value for key, value in load_model(file).as_dict().items() if key in known}
        for crane, file in shipped.items()
    }


_PAPER_CRANES: dict[str, dict[str, float]] = _paper_cranes()


def _loop_html(practice: Practice) -> str:
    system = practice.system
    loops = system.loops
    columns = ["model", *(f"loop {loop.number}" for loop in loops)]
    rows: list[list[Any]] = [
        [label(p), *(shown(loop.model, p) for loop in loops)]
        for p in (*_MOTOR, *_SYSTEM)
        if p in loops[0].model.as_dict() or p in _SYSTEM
    ]
    rows.append(["E", *(loop.cost for loop in loops)])
    if system.held_out_costs:
        rows.append(["E on held-out tests", *system.held_out_costs])
    return (
        paragraph(_loop_verdict(practice), "verdict")
        + table_html(columns, rows, "Optimized friction parameters (paper 2 Table 4)")
        + figure_html(motor_change_figure(practice), "Motor loss before and after the loops; paper 2 Fig 10.")
        + figure_html(
            derived_figure(practice),
            "System friction derived from the measurements by subtracting the motor: equal loads should coincide; "
            "paper 2 Fig 11, 12, 14.",
        )
        + figure_html(
            map_derived_figure(practice), "System friction derived with the model and with the map; paper 2 Fig 13."
        )
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


def motor_change_figure(practice: Practice) -> Any:
    """Paper 2 Fig 10: motor loss with old and new parameters."""
    figure, axes = new_figure(height=3.2)
    speed = np.linspace(50, 2000, 79) * RPM
    first, last = practice.system.loops[0].motor, practice.system.loops[-1].motor
    for k, cm3 in enumerate((215.0, 145.0, 70.0)):
        points = motor_points(speed, np.full_like(speed, 200 * BAR), np.full_like(speed, cm3 * CM3_PER_REV))
        axes.plot(speed / RPM, first.torque(points), color=colour(k), label=f"{cm3:.0f} cm³/rev")
        axes.plot(speed / RPM, last.torque(points), color=colour(k), ls="--")
    axes.set(xlabel="motor speed [rpm]", ylabel="torque loss [N·m]", title="200 bar; dashed: after the loops")
    axes.legend()
    return figure


def _derived(curves: Sequence[FrictionCurve], motor: FrictionModel) -> list[np.ndarray]:
    return [curve.friction_torque - modelled(motor, curve_data([curve])) for curve in curves]


def derived_figure(practice: Practice) -> Any:
    """Paper 2 Fig 11, 12, 14: derived system friction by load, first loop (solid) and last (dashed)."""
    curves = [test.curve for test in (*practice.system.tests, *practice.system.held_out)]
    loads = sorted({round(curve.drum_torque, -3) for curve in curves})
    figure, axes = new_figure(1, len(loads), height=3.4, squeeze=False)
    for axis, load in zip(axes[0], loads, strict=True):
        chosen = [curve for curve in curves if round(curve.drum_torque, -3) == load]
        first = _derived(chosen, practice.system.loops[0].motor)
        last = _derived(chosen, practice.system.loops[-1].motor)
        for k, (curve, before, after) in enumerate(zip(chosen, first, last, strict=True)):
            axis.plot(curve.speed / RPM, before * curve.motors, color=colour(k), label=_short(curve))
            axis.plot(curve.speed / RPM, after * curve.motors, color=colour(k), ls="--")
        axis.set(xlabel="motor speed [rpm]", title=f"T_d = {load / 1e3:.0f} kN·m")
        below_legend(axis, 2)
    axes[0][0].set(ylabel="T_fs, all motors [N·m]")
    return figure


def _short(curve: FrictionCurve) -> str:
    return f"{curve.displacement / CM3_PER_REV:.0f} cm³/rev"


def map_derived_figure(practice: Practice) -> Any:
    """Paper 2 Fig 13: derived system friction with the parametric model and with the black-box map."""
    figure, axes = new_figure(height=3.4)
    curves = [test.curve for test in (*practice.system.tests, *practice.system.held_out)]
    for k, curve in enumerate(_extremes(curves)):
        displacement = np.full_like(curve.speed, curve.displacement)
        sides = [
            practice.map.torque_loss(curve.speed, side, displacement)
            for side in (curve.pressure_up, curve.pressure_down)
        ]
        by_model = _derived([curve], practice.system.loops[0].motor)[0]
        by_map = curve.friction_torque - 0.5 * (sides[0] + sides[1])
        axes.plot(curve.speed / RPM, by_model * curve.motors, color=colour(k), label=_label(curve))
        axes.plot(curve.speed / RPM, by_map * curve.motors, color=colour(k), ls=":")
    axes.set(xlabel="motor speed [rpm]", ylabel="T_fs, all motors [N·m]", title="solid: model; dotted: map")
    below_legend(axes, 2)
    return figure


def _extremes(curves: Sequence[FrictionCurve]) -> list[FrictionCurve]:
    """The lightest and the heaviest test at the largest and the smallest displacement."""
    ordered = sorted(curves, key=lambda curve: (round(curve.drum_torque, -3), curve.displacement))
    return list({id(each): each for each in (ordered[0], ordered[-1], *ordered[1:4:2], *ordered[-3:-1:2])}.values())[:5]


def _joint_html(practice: Practice) -> str:
    joint, system = practice.system.joint, practice.system
    boot = dict(zip(system.bootstrap.names, system.bootstrap.std, strict=True)) if system.bootstrap else {}
    rows = [
        [p.name, p.unit, joint.prior.value(p.name), prior_std or float("nan"), value, std,
         boot.get(p.name, float("nan"))]
        for p, prior_std, value, std in zip(
            joint.model.parameters, joint.prior.std, joint.model.values, joint.model.std, strict=True)
    ]  # fmt: skip
    columns = ("parameter", "unit", "before", "its σ", "joint fit", "σ", "σ, bootstrap")
    tied = "; ".join(f"{tie.first} and {tie.second} (cosine {tie.cosine:.5f})" for tie in system.ties) or "none"
    unseen = "; ".join(f"{direction} (seen {direction.seen:.2g})" for direction in system.unseen) or "none"
    sensors = [[key.replace("_", " "), *pair] for key, pair in joint.sensor_errors.items()]
    return (
        paragraph(f"Act alike in these tests: {tied}.", "verdict")
        + paragraph(
            f"Directions that the tests say less about than the spread between units does, in its units: {unseen}. "
            "Along them the estimate stays at the prior, and its σ says so."
        )
        + table_html(columns, rows)
        + table_html(("sensor error", "estimate", "σ"), sensors, "Systematic errors found beside (relative, and Pa)")
        + figure_html(joint_breakdown_figure(practice), "Contributions in the joint fit: the heaviest fitted test.")
    )


def joint_breakdown_figure(practice: Practice) -> Any:
    """What makes up the total friction of the heaviest test."""
    figure, axes = new_figure(height=3.2)
    curve = max((test.curve for test in practice.system.tests), key=lambda each: each.load_torque)
    parts = contributions(practice.system.joint.model, curve_data([curve]))
    axes.stackplot(curve.speed / RPM, *parts.values(), labels=list(parts), alpha=0.6)
    axes.plot(curve.speed / RPM, curve.friction_torque, "ko", ms=2.5, label="measured")
    axes.set(xlabel="motor speed [rpm]", ylabel="T_ft per motor [N·m]", title=_label(curve))
    below_legend(axes, 5)
    return figure
