"""The demo's HTML page: figures, picture, what was learned, and whether the replay agrees."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from winch_friction.cli.demo.measures import BINS, PhaseFigures, bin_label
from winch_friction.cli.demo.plan import DemoPlan
from winch_friction.cli.demo.recording import Recording
from winch_friction.physics.friction import FrictionModel
from winch_friction.replay.live import AGREEMENT, Comparison
from winch_friction.report.base import Section, TextSection
from winch_friction.report.figures import figure_html
from winch_friction.report.tables import paragraph, table_html


def sections(
    plan: DemoPlan,
    recording: Recording,
    rows: list[PhaseFigures],
    agreements: Sequence[Comparison],
    truth: FrictionModel,
    picture: Any,
) -> list[Section]:
    """The page's sections."""
    return [
        TextSection("What was done", _story(plan)),
        TextSection("Compensation", residual_table(rows) + figure_html(picture, _CAPTION)),
        TextSection("Friction torque by speed", error_table(rows)),
        TextSection("What was learned", learned_table(plan.seed, recording.models[-1], truth)),
        TextSection("Live equals replay", agreement_table(agreements)),
        TextSection("Files", _files(plan)),
    ]


_CAPTION = (
    "Top: position error of the load over the last half minute of each phase, the same waves in each. Middle: the "
    "plant's true friction and the feedforward as sent. Bottom: error of the model behind the feedforward."
)


def _story(plan: DemoPlan) -> str:
    words = (
        f"A simulated 150 t crane ({plan.scenario}, sea {plan.sea}) compensates heave against its friction. Its gears "
        f"and drum turn {plan.friction_factor:g} times as hard as the seed model says, and nobody tells the nodes. "
        "Simulator, compensator and estimator are three processes that talk over DDS in lockstep. "
        f"The same {plan.duration:g} s of sea were sailed four times; the estimator learned all along. "
        "All figures were measured from the recorded bag, the first 20 s of each phase left out."
    )
    return paragraph(words)


def residual_table(rows: list[PhaseFigures]) -> str:
    """Residual heave by phase."""
    body = [
        (row.title, row.residual * 1e3, row.residual_at_reversal * 1e3, f"{row.gain:.0%}" if row.gain else "–")
        for row in rows
    ]
    columns = ("feedforward", "residual heave RMS [mm]", "around reversals [mm]", "less than without")
    return table_html(columns, body, "Position error of the load", digits=3)


def error_table(rows: list[PhaseFigures]) -> str:
    """Friction-torque error by phase and bin."""
    labels = [bin_label(each) for each in BINS]
    body = [(row.title, *map(_error, row.friction_error, row.friction_error_share)) for row in rows]
    caption = "RMS error in N m and as a share of the true friction, of the model behind the feedforward (sent / scale)"
    reversal = (
        "Below 50 rpm no model can be right: the feedforward spreads the change of sign over time on purpose, and at "
        "rest friction is whatever holds the load."
    )
    return table_html(("feedforward", *labels), body, caption) + paragraph(reversal, "faint")


def _error(error: float, share: float) -> str:
    return "–" if np.isnan(error) else f"{error:.0f} ({share:.0%})"


def learned_table(seed: FrictionModel, learned: FrictionModel, truth: FrictionModel) -> str:
    """Seed, learned and true parameters."""
    true = truth.as_dict()
    body = [
        (p.name, p.unit, seed.value(p.name), learned.value(p.name), float(std), true[p.name])
        for p, std in zip(learned.parameters, learned.std, strict=True)
    ]
    columns = ("parameter", "unit", "seed", "learned", "std", "truth")
    note = (
        "One load and one sea cannot tell all parameters apart: their sum is learned, each one only as far as excited."
    )
    return table_html(columns, body, "Parameters at the end") + paragraph(note, "faint")


def agreement_table(agreements: Sequence[Comparison]) -> str:
    """Live against replay."""
    body = [(a.node, a.compared, a.missing, f"{a.largest:.1e}", "yes" if a.equal else "NO") for a in agreements]
    columns = ("node", "samples", "without an answer", "largest relative difference", f"within {AGREEMENT:g}")
    return table_html(columns, body, "The bag's inputs through the same step objects again")


def _files(plan: DemoPlan) -> str:
    names = ("bag", "nodes.yaml", "plan.json", "demo.json", "demo.png", "learned_model.yaml", "logs")
    return paragraph(f"In {plan.out.name}/: " + ", ".join(names))
