"""The demo's HTML page: figures, picture, what was learned, and whether the replay agrees."""

from collections.abc import Sequence

import numpy as np

from winch_friction.cli.demo.learned import LearnedParameter
from winch_friction.cli.demo.measures import BINS, SETTLING, PhaseFigures, bin_label, of_feedforward, of_leg
from winch_friction.cli.demo.plan import DemoPlan
from winch_friction.cli.demo.plots import leg_plots
from winch_friction.cli.demo.recording import Recording
from winch_friction.cli.demo.tuning import EfficiencySearch
from winch_friction.physics.channels import beside
from winch_friction.replay.live import AGREEMENT, Comparison
from winch_friction.report.base import Section, TextSection
from winch_friction.report.decision import decision_html
from winch_friction.report.plots import plot_html
from winch_friction.report.tables import for_people, paragraph, table_html, value_for_people


def sections(
    plan: DemoPlan,
    recording: Recording,
    rows: list[PhaseFigures],
    agreements: Sequence[Comparison],
    parameters: Sequence[LearnedParameter],
    search: EfficiencySearch,
) -> list[Section]:
    """The page's sections."""
    return [
        TextSection("Decision", _decision(plan, rows, agreements)),
        TextSection("What was done", _story(plan)),
        TextSection("Compensation", residual_table(plan, rows) + "".join(map(plot_html, leg_plots(plan, recording)))),
        TextSection("Friction torque by speed", error_table(plan, rows)),
        TextSection("How the efficiency factor was tuned", search_table(plan, search)),
        TextSection("What was learned", learned_table(parameters)),
        TextSection("Live equals replay", agreement_table(agreements)),
        TextSection("Files", _files(plan)),
    ]


def _decision(plan: DemoPlan, rows: list[PhaseFigures], agreements: Sequence[Comparison]) -> str:
    """What the learned feedforward leaves of the heave, beside what one would have without it."""
    last = of_feedforward(rows, plan.feedforwards[-1].name)
    gains = sorted(row.gain for row in last)
    sentence = (
        f"The feedforward of the learned model ({plan.feedforwards[-1].title}) leaves "
        f"{min(r.residual for r in last) * 1e3:.1f} to {max(r.residual for r in last) * 1e3:.1f} mm RMS of the heave: "
        f"{100 * gains[0]:.0f} to {100 * gains[-1]:.0f} % less than "
        "without feedforward."
    )
    facts = [
        (f"Left of the heave by leg, {each.title}", _range(of_feedforward(rows, each.name)))
        for each in plan.feedforwards
    ]
    same = all(each.equal for each in agreements)
    facts.append(("Live equals replay", "yes" if same else "NO"))
    return decision_html(sentence, facts)


def _range(rows: Sequence[PhaseFigures]) -> str:
    """What is left of the heave, leg by leg."""
    return ", ".join(f"{row.residual * 1e3:.1f}" for row in rows) + " mm"


def _story(plan: DemoPlan) -> str:
    legs = "; ".join(f"{leg.load:g} t at {leg.displacement:g} cm³/rev" for leg in plan.legs)
    words = (
        f"A simulated 150 t crane ({plan.scenario}, sea {plan.sea}) compensates heave against its friction. Its gears "
        f"and drum turn {plan.friction_factor:g} times as hard as the seed model says, and nobody tells the nodes. "
        "Simulator, compensator and estimator are three processes that talk over DDS in lockstep. "
        f"The voyage has {len(plan.legs)} legs of {plan.duration:g} s each ({legs}) and was sailed "
        f"{len(plan.feedforwards)} times; the estimator learned all along. The efficiency factor is today's practice "
        f"at its best: {plan.efficiency:.2f} leaves the least heave on the first leg of this very sea, found by search "
        f"with the true plant. All figures were measured from the recorded bag, the first {SETTLING:g} s of each leg "
        "left out."
    )
    return paragraph(words)


def residual_table(plan: DemoPlan, rows: list[PhaseFigures]) -> str:
    """Residual heave by leg and feedforward."""
    body = [(leg.title, *map(_residual, of_leg(rows, leg.name))) for leg in plan.legs]
    columns = ("leg", *(each.title for each in plan.feedforwards))
    caption = "Position error of the load, RMS in mm, and how much less than without feedforward"
    return table_html(columns, body, caption)


def _residual(row: PhaseFigures) -> str:
    return f"{row.residual * 1e3:.1f}" + (f" (−{100 * row.gain:.0f} %)" if row.phase.feedforward.enabled else "")


def error_table(plan: DemoPlan, rows: list[PhaseFigures]) -> str:
    """Friction-torque error by feedforward, leg and bin."""
    labels = [bin_label(each) for each in BINS]
    body = [
        (each.title, row.phase.leg.title, *map(_error, row.friction_error, row.friction_error_share))
        for each in plan.feedforwards
        for row in of_feedforward(rows, each.name)
    ]
    caption = "RMS error in N·m and as a share of the true friction, of the model behind the feedforward (sent / scale)"
    reversal = (
        "Below 50 rpm no model can be right: the feedforward spreads the change of sign over time on purpose, and at "
        "rest friction is whatever holds the load."
    )
    return table_html(("feedforward", "leg", *labels), body, caption) + paragraph(reversal, "faint")


def _error(error: float, share: float) -> str:
    return "–" if np.isnan(error) else f"{error:.0f} ({100 * share:.0f} %)"


def search_table(plan: DemoPlan, search: EfficiencySearch) -> str:
    """Every factor that was tried."""
    body = [
        (f"{each:.2f}", residual * 1e3, "best" if each == search.best else "")
        for each, residual in zip(search.efficiencies, search.residuals, strict=True)
    ]
    words = (
        f"Tried on the first leg ({plan.legs[0].title}) with the true plant, in one process. A factor cannot know "
        "that friction hardly falls with the load, nor that it changes with displacement and speed."
    )
    columns = ("efficiency factor", "residual heave RMS [mm]", "chosen")
    return table_html(columns, body, "Search for the efficiency factor", digits=3) + paragraph(words, "faint")


def learned_table(parameters: Sequence[LearnedParameter]) -> str:
    """Seed, learned and true parameters, with the stated sigma."""
    body = [
        (p.name, for_people(p.unit), *(value_for_people(each, p.unit) for each in
                                       (p.seed, beside(p.learned, p.std), p.std, p.truth)),
         f"{p.sigmas:+.1f}".replace("-", "−"))
        for p in parameters
    ]  # fmt: skip
    columns = ("parameter", "unit", "seed", "learned", "stated σ", "truth", "(learned − truth)/σ")
    inside = sum(abs(p.sigmas) <= 2.0 for p in parameters)
    note = (
        f"{inside} of {len(parameters)} lie within two of their stated standard deviations of the truth. A few loads "
        "and one sea cannot tell all parameters apart: their sum is learned, each one only as far as excited."
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
