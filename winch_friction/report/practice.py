"""The report of the practice: one page with the figures and tables of paper 2."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from winch_friction.identification.practice import Practice
from winch_friction.physics.channels import RPM
from winch_friction.physics.winch.model_curve import ModelCurve, model_curve, usual_loads
from winch_friction.report.base import Section, TextSection, write_report
from winch_friction.report.curves import curve_plot
from winch_friction.report.decision import decision_html, list_html
from winch_friction.report.plots import plot_html
from winch_friction.report.practice_motor import motor_sections
from winch_friction.report.practice_system import system_sections
from winch_friction.report.practice_verification import verification_sections
from winch_friction.report.tables import estimate_for_people, number, table_html


def write_practice_report(practice: Practice, path: Path, provenance: Mapping[str, Any] | None = None) -> Path:
    """Write the page; returns its path."""
    title = f"Friction practice: {practice.folder.name}"
    return write_report(path, title, practice_sections(practice), practice.folder.note, provenance)


def practice_sections(practice: Practice) -> list[Section]:
    """Summary first, then the steps in order."""
    return [
        TextSection("Result", summary_html(practice)),
        *motor_sections(practice),
        *system_sections(practice),
        *verification_sections(practice),
    ]


def summary_html(practice: Practice) -> str:
    """What came out, in a few lines, and the seed."""
    rows = [
        [p.doc, p.name, *estimate_for_people(float(value), float(std), p.unit)]
        for p, value, std in zip(practice.seed.parameters, practice.seed.values, practice.seed.std, strict=True)
    ]
    first, *others = summary_lines(practice)
    steps = ["Take seed.yaml as model_file of both nodes, or replay a bag with it first.",
             "Let `winch-friction gap` ask heave-compensated runs whether the model lacks anything."]  # fmt: skip
    return (
        decision_html(first, _facts(practice), list_html(others))
        + "<h3>What to do next</h3>"
        + list_html(steps, ordered=True)
        + plot_html(curve_plot(_curves(practice)))
        + table_html(("what", "symbol", "seed", "σ", "unit"), rows, "The seed for the online nodes (joint fit)")
    )


def _facts(practice: Practice) -> list[tuple[str, str]]:
    middle = _curves(practice)[1]
    return [
        (
            f"Friction at {middle.load / 1e3:.3g} t, {where} rpm",
            f"{number(float(middle.torque[k]), 3)} ± {number(float(middle.std[k]), 2)} N·m",
        )
        for where, k in ((f"{middle.speed[0] / RPM:.0f}", 0), (f"{middle.speed[-1] / RPM:.0f}", -1))
    ]


def _curves(practice: Practice) -> list[ModelCurve]:
    """The seed's friction at a light, a middle and a heavy load of its crane."""
    crane = practice.folder.crane
    return [model_curve(practice.seed, crane, load=load) for load in usual_loads(crane)]


def summary_lines(practice: Practice) -> list[str]:
    """Verdicts for page and terminal."""
    fitted = len(practice.system.tests)
    errors = practice.errors["joint fit"]
    lines = []
    for title, chosen in (("fitted", errors[:fitted]), ("held-out", errors[fitted:])):
        if chosen:
            above, below = (np.nanmax([each.worst(side) for each in chosen]) for side in (True, False))
            lines.append(
                f"Total friction on {len(chosen)} {title} tests: within {above:.2g} % of nominal torque above 250 rpm, "
                f"{below:.2g} % below."
            )
    for check in practice.ahc["joint fit"]:
        lines.append(f"{check.run}: predicted pressure within {check.moving_rms / 1e5:.2g} bar RMS while turning.")
    unseen = "; ".join(str(direction) for direction in practice.system.unseen)
    lines.append(f"Not determined by these tests, held by the prior: {unseen or 'nothing'}.")
    return lines
