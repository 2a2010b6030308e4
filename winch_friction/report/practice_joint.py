"""Report of the practice: the joint fit, what it determines and what it cannot."""

from typing import Any

from winch_friction.identification.fit_data import contributions
from winch_friction.identification.friction_curve import curve_data
from winch_friction.identification.practice import Practice
from winch_friction.physics.units import RPM
from winch_friction.report.figures import figure_html, new_figure
from winch_friction.report.practice_look import (
    below_legend,
    curve_label,
)
from winch_friction.report.tables import paragraph, table_html


def joint_html(practice: Practice) -> str:
    """Parameters before and after, ties, unseen directions, sensor errors, contributions."""
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
    axes.set(xlabel="motor speed [rpm]", ylabel="T_ft per motor [N·m]", title=curve_label(curve))
    below_legend(axes, 5)
    return figure
