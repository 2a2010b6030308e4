"""The report of the practice: one page with the figures and tables of paper 2."""

from pathlib import Path

import numpy as np

from winch_friction.identification.practice import Practice
from winch_friction.report.base import Section, TextSection, write_report
from winch_friction.report.practice_motor import motor_sections
from winch_friction.report.practice_system import system_sections
from winch_friction.report.practice_verification import verification_sections
from winch_friction.report.tables import paragraph, table_html


def write_practice_report(practice: Practice, path: Path) -> Path:
    """Write the page; returns its path."""
    title = f"Friction practice: {practice.folder.name}"
    return write_report(path, title, practice_sections(practice), practice.folder.note)


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
        [p.name, p.unit, value, std]
        for p, value, std in zip(practice.seed.parameters, practice.seed.values, practice.seed.std, strict=True)
    ]
    return "".join(paragraph(line, "verdict") for line in summary_lines(practice)) + table_html(
        ("parameter", "unit", "seed", "σ"), rows, "The seed for the online nodes (joint fit)"
    )


def summary_lines(practice: Practice) -> list[str]:
    """Verdicts for page and terminal."""
    fitted = len(practice.system.tests)
    errors = practice.errors["joint fit"]
    lines = []
    for title, chosen in (("fitted", errors[:fitted]), ("held-out", errors[fitted:])):
        if chosen:
            above, below = (np.nanmax([each.worst(side) for each in chosen]) for side in (True, False))
            lines.append(
                f"T_ft on {len(chosen)} {title} tests: within {above:.2g} % of nominal torque above 250 rpm, "
                f"{below:.2g} % below."
            )
    for check in practice.ahc["joint fit"]:
        lines.append(f"{check.run}: predicted pressure within {check.moving_rms / 1e5:.2g} bar RMS while turning.")
    unseen = "; ".join(str(direction) for direction in practice.system.unseen)
    lines.append(f"Not determined by these tests, held by the prior: {unseen or 'nothing'}.")
    return lines
