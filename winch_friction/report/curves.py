"""Friction curves as pages: one model over speed with its uncertainty, or two against each other."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from winch_friction.physics.channels import CM3_PER_REV, RPM, beside
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.friction.correction import Correction
from winch_friction.physics.winch.model_curve import ModelCurve
from winch_friction.report.base import TextSection, write_report
from winch_friction.report.corrections import CORRECTIONS, correction_rows
from winch_friction.report.decision import decision_html, provenance_html
from winch_friction.report.equations import term_html
from winch_friction.report.plots import Frame, Line, Plot, plot_html
from winch_friction.report.tables import for_people, number, table_html, value_for_people

SPEED, TORQUE = "motor speed [rpm]", "friction torque [N·m]"
SINCE, LATE = "time since the run began [s]", "delay [ms]"
_ROLES = ("before", "after")


def write_model_page(path: Path, model: FrictionModel, curves: Sequence[ModelCurve], crane: str) -> Path:
    """A model: its friction curve at several loads, what each term gives, its parameters and equations."""
    middle = curves[len(curves) // 2]
    least = int(np.argmin(middle.torque))
    facts = [
        (f"{where} rpm, {middle.load / 1e3:.3g} t", f"{number(float(middle.torque[k]), 3)} N·m")
        for where, k in (
            (f"{middle.speed[0] / RPM:.0f}", 0),
            (f"{middle.speed[least] / RPM:.0f}", least),
            (f"{middle.speed[-1] / RPM:.0f}", -1),
        )
    ]
    said = f"{model.name}: {len(model.terms)} terms, {len(model.values)} parameters, on crane {crane}"
    equations = "".join(f"<h3>{term.name.replace('_', ' ')}</h3>{term_html(term)}" for term in model.terms)
    sections = [
        TextSection("Friction curve", decision_html(said, facts) + plot_html(curve_plot(curves))),
        TextSection("What each term gives", plot_html(parts_plot(middle))),
        TextSection("Parameters", parameter_html(model)),
        *([TextSection("What logs or crane file have wrong", corrections_html(model))] if model.corrections else []),
        TextSection("Equations", equations),
        TextSection("Provenance", provenance_html(dict(model.provenance) or {"model": model.name})),
    ]
    return write_report(path, f"Friction model {model.name}", sections)


def curve_plot(curves: Sequence[ModelCurve]) -> Plot:
    """Torque over speed at each load, with one standard deviation where the model knows it."""
    frames, lines = [], []
    for k, curve in enumerate(curves):
        label = f"{curve.load / 1e3:.3g} t"
        columns = {SPEED: curve.speed / RPM, TORQUE: curve.torque}
        if np.isfinite(curve.std).all():
            columns |= {"less 1 σ [N·m]": curve.torque - curve.std, "plus 1 σ [N·m]": curve.torque + curve.std}
            lines.append(
                Line(f"{label} ± 1 σ", SPEED, "less 1 σ [N·m]", k, kind="band", upper="plus 1 σ [N·m]", role="noise")
            )
        frames.append(Frame(label, columns))
        lines.append(Line(label, SPEED, TORQUE, k))
    where = "" if not curves[0].displacement else f" at {curves[0].displacement / CM3_PER_REV:.0f} cm³/rev"
    return Plot(
        "Friction over speed",
        frames,
        lines,
        SPEED,
        [TORQUE],
        f"Total friction at the motor shaft, hoisting steadily{where}; the shadow is one standard deviation.",
        height=330,
    )


def parts_plot(curve: ModelCurve) -> Plot:
    """The terms' torques over speed, stacked, those that take off it below zero; and what they are together."""
    parts = {f"{n} [N·m]": part for n, part in curve.parts.items()}
    frame = Frame(curve.model, {SPEED: curve.speed / RPM, **parts, TORQUE: curve.torque})
    lines = [Line(name.replace("_", " "), SPEED, f"{name} [N·m]", kind="area") for name in curve.parts]
    lines.append(Line("together", SPEED, TORQUE, role="measured"))
    said = f"Terms at {curve.load / 1e3:.3g} t; together they are the friction."
    return Plot("Friction by term", [frame], lines, SPEED, [TORQUE], said, height=330)


def parameter_html(model: FrictionModel) -> str:
    """Parameters in the units that people read."""
    known = model.covariance is not None
    rows = [
        (
            p.name,
            value_for_people(beside(value, std) if known else value, p.unit),
            value_for_people(std, p.unit) if known else None,
            for_people(p.unit),
            p.doc,
        )
        for p, value, std in zip(model.parameters, model.values, model.std.tolist(), strict=True)
    ]
    return table_html(("parameter", "value", "σ", "unit", "meaning"), rows, "Parameters")


def corrections_html(model: FrictionModel) -> str:
    """The corrections of a model, and a picture of each delay that takes a course."""
    table = table_html(CORRECTIONS, correction_rows(model.corrections), "Corrections")
    return table + "".join(plot_html(course_plot(each)) for each in model.corrections if each.course)


def course_plot(correction: Correction) -> Plot:
    """How late a signal is over the time since a run began, as data have drawn it."""
    time, share = np.transpose(correction.course)
    frame = Frame(correction.name, {SINCE: time, LATE: 1e3 * correction.value * share})
    said = f"How late {'the speed is' if correction.name.startswith('signal') else 'the pressures are'} logged."
    return Plot("Delay over the run", [frame], [Line("delay", SINCE, LATE)], SINCE, [LATE], said, height=230)


def write_comparison_page(
    path: Path,
    pairs: Sequence[tuple[ModelCurve, ModelCurve]],
    sentence: str,
    facts: Sequence[tuple[str, str]],
    provenance: Mapping[str, Any] | None = None,
) -> Path:
    """Two models on one grid: curves and difference at each load, and which terms make the difference."""
    first, second = pairs[0]
    body = "".join(plot_html(pair_plot(a, b)) for a, b in pairs)
    middle = pairs[len(pairs) // 2]
    sections = [
        TextSection("Decision", decision_html(sentence, facts)),
        TextSection("Curves and their difference", body),
        TextSection("Which terms differ", plot_html(difference_plot(*middle))),
    ]
    return write_report(path, f"{second.model} against {first.model}", sections, "", provenance)


def pair_plot(first: ModelCurve, second: ModelCurve) -> Plot:
    """Both torques above, the difference with its standard deviation below."""
    difference, spread = second.torque - first.torque, joint_std(first, second)
    names = [f"{first.model} [N·m]", f"{second.model} [N·m]"]
    if names[0] == names[1]:
        names[1] += " "
    columns = {
        SPEED: first.speed / RPM,
        names[0]: first.torque,
        names[1]: second.torque,
        "difference [N·m]": difference,
        "less 1 σ [N·m]": difference - spread,
        "plus 1 σ [N·m]": difference + spread,
    }
    lines = [
        Line(c.model, SPEED, name, role=role) for c, name, role in zip((first, second), names, _ROLES, strict=True)
    ]
    if np.isfinite(spread).all():
        lines.append(Line("± 1 σ", SPEED, "less 1 σ [N·m]", row=1, kind="band", upper="plus 1 σ [N·m]", role="noise"))
    lines.append(Line("difference", SPEED, "difference [N·m]", row=1, role="measured"))
    title = f"At {first.load / 1e3:.3g} t"
    return Plot(
        title,
        [Frame(title, columns)],
        lines,
        SPEED,
        [TORQUE, "difference [N·m]"],
        f"Hanging mass {first.load / 1e3:.3g} t; below: {second.model} minus {first.model}.",
        "curves",
        height=200,
    )


def joint_std(first: ModelCurve, second: ModelCurve) -> np.ndarray:
    """Standard deviation of the difference of two independent estimates, N m; NaN where neither knows its own."""
    return np.sqrt(np.nansum([first.std**2, second.std**2], axis=0)) + 0.0 * np.fmin(first.std, second.std)


def difference_plot(first: ModelCurve, second: ModelCurve) -> Plot:
    """Difference of each term's torque over speed; a term that one model lacks counts as zero there."""
    zero = np.zeros_like(first.speed)
    names = list(dict.fromkeys((*first.parts, *second.parts)))
    parts = {name: second.parts.get(name, zero) - first.parts.get(name, zero) for name in names}
    shown = {name: part for name, part in parts.items() if np.abs(part).max() > 1e-9}
    frame = Frame("terms", {SPEED: first.speed / RPM, **{f"{n} [N·m]": part for n, part in shown.items()}})
    lines = [Line(name.replace("_", " "), SPEED, f"{name} [N·m]") for name in shown]
    return Plot(
        "Difference by term",
        [frame],
        lines,
        SPEED,
        ["difference [N·m]"],
        f"Terms of {second.model} minus those of {first.model}, at {first.load / 1e3:.3g} t.",
        height=300,
    )
