"""Report sections of the practice, step 1: the motor models against the supplier's table."""

from typing import Any

import numpy as np

from winch_friction.identification.fit import FitResult
from winch_friction.identification.motor_identification import MotorIdentification
from winch_friction.identification.motor_models import motor_model_named
from winch_friction.identification.practice import Practice
from winch_friction.identification.supplier_table import motor_points
from winch_friction.physics.channels import BAR, CM3_PER_REV, RPM, beside
from winch_friction.physics.friction import FrictionModel
from winch_friction.report.base import TextSection
from winch_friction.report.plots import Frame, Line, Plot, plot_html
from winch_friction.report.practice_look import SPEED, Curve, curves_html
from winch_friction.report.tables import for_people, paragraph, table_html, value_for_people


def motor_sections(practice: Practice) -> list[TextSection]:
    """Ranking, parameters, map against parametric model, contributions."""
    motor = practice.motor
    return [
        TextSection("Motor models on the supplier's table", ranking_html(motor)),
        TextSection("Motor parameters", parameters_html(motor)),
        TextSection(
            "Motor model, map and contributions",
            map_html(practice) + error_html(motor) + contributions_html(motor.chosen.fitted.model),
        ),
    ]


def ranking_html(motor: MotorIdentification) -> str:
    """All models: held-out displacement with the parameters counted, then both fitters beside each other."""
    described = {score.name: motor_model_named(score.name) for score in motor.scores}
    rows = [
        [described[score.name].title, described[score.name].year, described[score.name].displacement,
         score.fitted.parameter_count, score.fitted.rms, score.held_out, score.bic]
        for score in motor.scores
    ]  # fmt: skip
    columns = ("model", "year", "displacement", "parameters", "RMS [N·m]", "held-out RMS [N·m]", "BIC")
    notes = "; ".join(f"{each.title}: {each.note}" for each in described.values() if each.note)
    verdict = (
        f"Used: {described[motor.chosen.name].title}. Held-out displacements, with the parameters counted, recommend "
        f"{described[motor.recommended].title}."
    )
    said = (
        f"{len(motor.table)} rows of {motor.table.name}, weighting '{motor.weighting}'. Held out: one displacement at "
        f"a time. {notes}."
    )
    return paragraph(verdict, "verdict") + paragraph(said) + table_html(columns, rows) + _fitters_html(motor)


def _fitters_html(motor: MotorIdentification) -> str:
    """Cost and model evaluations of least squares and of the complex method."""
    if not motor.by_complex:
        return ""
    rows: list[list[Any]] = []
    for score in motor.scores:
        other = motor.by_complex[score.name]
        rows.append(
            [motor_model_named(score.name).title, score.fitted.cost, other.cost, score.fitted.evaluations,
             other.evaluations, other.evaluations / score.fitted.evaluations]
        )  # fmt: skip
    columns = ("model", "cost, LS", "cost, complex", "evaluations, LS", "evaluations, complex", "ratio")
    said = "Cost: weighted squared error. An evaluation is one torque over all rows, or one column of a Jacobian."
    return table_html(columns, rows, "Least squares (LS) and the complex method of paper 2") + paragraph(said, "faint")


def parameters_html(motor: MotorIdentification) -> str:
    """The used model's parameters by both fitters."""
    fitted, by_complex = motor.chosen.fitted, motor.by_complex.get(motor.chosen.name)
    bounds = f"; on a bound: {', '.join(fitted.at_bound)}" if fitted.at_bound else ""
    return paragraph(f"Condition number {fitted.condition:.3g} (columns of unit length){bounds}.") + parameter_table(
        fitted, by_complex
    )


def parameter_table(fitted: FitResult, by_complex: FitResult | None = None) -> str:
    """Values with standard errors beside the complex method's values."""
    model = fitted.model
    rows: list[list[Any]] = [
        [
            p.name,
            for_people(p.unit),
            value_for_people(beside(value, std), p.unit),
            value_for_people(std, p.unit),
            100.0 * std / abs(value) if value else float("nan"),
            p.doc,
        ]
        for p, value, std in zip(model.parameters, model.values, model.std, strict=True)
    ]
    columns = ["parameter", "unit", "least squares", "standard error", "%", "meaning"]
    if by_complex is not None:
        columns.insert(5, "complex")
        for row, p in zip(rows, model.parameters, strict=True):
            row.insert(5, value_for_people(by_complex.model.value(p.name), p.unit))
    return table_html(columns, rows)


def map_html(practice: Practice) -> str:
    """Paper 2 Fig 3: model against linear interpolation of the table."""
    table, model = practice.motor.table, practice.motor.chosen.fitted.model
    speed = np.asarray(np.linspace(100, 2500, 97) * RPM, float)
    curves = []
    for k, displacement in enumerate(np.unique(table.displacement.round(9))[::-1]):
        pressure, setting = np.full_like(speed, 200 * BAR), np.full_like(speed, displacement)
        label = f"{displacement / CM3_PER_REV:.3g} cm³/rev"
        curves.append(Curve(label, speed / RPM, model.torque(motor_points(speed, pressure, setting))))
        every = speed[::4]
        loss = practice.map.torque_loss(every, pressure[::4], setting[::4])
        inside = ~np.asarray(practice.map.outside(every, pressure[::4], setting[::4]), bool)
        curves.append(Curve(f"{label}, map", every[inside] / RPM, loss[inside], kind="dots", like=k))
    said = "Torque loss at 200 bar: model (lines) and the table's map (dots, within the table); paper 2 Fig 3."
    return curves_html("Motor model and map", SPEED, ["torque loss [N·m]"], curves, said, 340)


def error_html(motor: MotorIdentification) -> str:
    """Paper 1 Fig 8 and 9: error in % of nominal torque over displacement, a colour per range of speed."""
    table = motor.table
    points = motor_points(table.speed, table.pressure, table.displacement)
    error = 100.0 * (motor.chosen.fitted.model.torque(points) - table.torque_loss) / table.nominal_torque
    edges = np.quantile(table.speed, (0.0, 0.25, 0.5, 0.75, 1.0))
    curves = []
    for low, high in zip(edges[:-1], edges[1:], strict=True):
        own = (table.speed >= low) & ((table.speed < high) | (high == edges[-1]))
        label = f"{low / RPM:.0f} to {high / RPM:.0f} rpm"
        curves.append(Curve(label, table.displacement[own] / CM3_PER_REV, error[own], kind="dots"))
    said = "Model error in % of D Δp; paper 1 finds about 1 %; paper 1 Fig 8 and 9."
    return curves_html("Motor model error", "displacement [cm³/rev]", ["error [% of D Δp]"], curves, said)


def contributions_html(model: FrictionModel) -> str:
    """Paper 1 Fig 6 and 7: the terms over speed, stacked, and each one's share over 300-2500 rpm."""
    speed = np.asarray(np.arange(300, 2501, 10) * RPM, float)
    setting = np.full_like(speed, 0.88 * model.constants["max_displacement"])
    parts = model.contributions(motor_points(speed, np.full_like(speed, 200 * BAR), setting))
    total = sum(part.sum() for part in parts.values())
    frame = Frame("terms", {SPEED: speed / RPM, **{f"{name} [N·m]": part for name, part in parts.items()}})
    lines = [Line(name.replace("_", " "), SPEED, f"{name} [N·m]", kind="area") for name in parts]
    said = "What each term gives at 200 bar and 88 % of D_max; paper 1 Fig 6 and 7."
    rows = [(name.replace("_", " "), 100.0 * part.sum() / total) for name, part in parts.items()]
    return plot_html(
        Plot("Motor losses by term", [frame], lines, SPEED, ["torque [N·m]"], said, height=300)
    ) + table_html(("term", "share of the loss [%]"), rows, digits=3)
