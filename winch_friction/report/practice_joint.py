"""Report of the practice: the joint fit, what it determines and what it cannot."""

from winch_friction.identification.fit_data import contributions
from winch_friction.identification.friction_curve import curve_data
from winch_friction.identification.practice import Practice
from winch_friction.physics.channels import RPM, beside
from winch_friction.report.plots import Frame, Line, Plot, plot_html
from winch_friction.report.practice_look import SPEED, curve_label
from winch_friction.report.tables import estimate_for_people, for_people, paragraph, table_html, value_for_people


def joint_html(practice: Practice) -> str:
    """Parameters before and after, ties, unseen directions, sensor errors, contributions."""
    joint, system = practice.system.joint, practice.system
    boot = dict(zip(system.bootstrap.names, system.bootstrap.std, strict=True)) if system.bootstrap else {}
    rows = [
        [p.name, for_people(p.unit), *(value_for_people(each, p.unit) for each in (
            joint.prior.value(p.name), prior_std or float("nan"), beside(value, std), std,
            boot.get(p.name, float("nan"))))]
        for p, prior_std, value, std in zip(
            joint.model.parameters, joint.prior.std, joint.model.values, joint.model.std, strict=True)
    ]  # fmt: skip
    columns = ("parameter", "unit", "before", "its σ", "joint fit", "σ", "σ, bootstrap")
    tied = "; ".join(f"{tie.first} and {tie.second} (cosine {tie.cosine:.5f})" for tie in system.ties) or "none"
    unseen = "; ".join(f"{direction} (seen {direction.seen:.2g})" for direction in system.unseen) or "none"
    sensors = [_sensor_error(*each) for each in joint.sensor_errors.items()]
    return (
        paragraph(f"Act alike in these tests: {tied}.", "verdict")
        + paragraph(
            f"Directions that the tests say less about than the spread between units does, in its units: {unseen}. "
            "Along them the estimate stays at the prior, and its σ says so."
        )
        + table_html(columns, rows)
        + table_html(("sensor error", "estimate", "σ", "unit"), sensors, "Systematic errors found beside")
        + joint_breakdown_html(practice)
    )


def _sensor_error(name: str, found: tuple[float, float]) -> list[object]:
    """A row: an offset is a pressure, the rest are relative."""
    unit = "Pa" if name.endswith("offset") else "1"
    return [name.replace("_", " "), *estimate_for_people(*found, unit)]


def joint_breakdown_html(practice: Practice) -> str:
    """What makes up the total friction of the heaviest test."""
    curve = max((test.curve for test in practice.system.tests), key=lambda each: each.load_torque)
    parts = contributions(practice.system.joint.model, curve_data([curve]))
    columns = {SPEED: curve.speed / RPM, **{f"{key} [N·m]": part for key, part in parts.items()}}
    columns["measured [N·m]"] = curve.friction_torque
    lines = [Line(key.replace("_", " "), SPEED, f"{key} [N·m]", kind="area") for key in parts]
    lines.append(Line("measured", SPEED, "measured [N·m]", role="measured", kind="dots"))
    said = f"Contributions in the joint fit: the heaviest fitted test, {curve_label(curve)}."
    return plot_html(
        Plot(
            "Joint fit by term", [Frame("joint fit", columns)], lines, SPEED, ["T_ft per motor [N·m]"], said, height=340
        )
    )
