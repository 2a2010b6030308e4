"""The report of the discrepancy workflow: one page, the decision first."""

import re
from collections.abc import Mapping
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from winch_friction.discrepancy.answer import Effect, GapResult, Side
from winch_friction.discrepancy.candidates.lateness import DELAY
from winch_friction.physics.channels import RPM, beside
from winch_friction.physics.effects import effect_text
from winch_friction.physics.errors import counted
from winch_friction.physics.friction import FrictionModel, Scope, Term, registered_terms
from winch_friction.physics.friction.table import FACTORS, at_knots, in_windows, tabulated
from winch_friction.report.base import Section, TextSection, write_report
from winch_friction.report.curves import course_plot
from winch_friction.report.decision import decision_html, list_html, provenance_html
from winch_friction.report.equations import latex_html, term_html
from winch_friction.report.gap_plots import heat_plot, run_plots, speed_plot
from winch_friction.report.gap_words import (
    amount_in_units,
    facts,
    next_steps,
    shape_in_words,
    shown_unit,
    verdict_sentence,
)
from winch_friction.report.plots import plot_html
from winch_friction.report.tables import (
    estimate_for_people,
    for_people,
    number,
    paragraph,
    table_html,
    value_for_people,
)

__all__ = ["GapResult", "Side", "gap_sections", "verdict_sentence", "write_gap_report"]


def write_gap_report(path: Path, result: GapResult, provenance: Mapping[str, Any] | None = None) -> Path:
    """Write report.html: self-contained, opens offline."""
    sections = gap_sections(result, provenance)
    return write_report(path, "Where simulation and measurement disagree", sections, _subtitle(result))


def gap_sections(result: GapResult, provenance: Mapping[str, Any] | None = None) -> list[Section]:
    """The sections in the order a reader needs them."""
    known = provenance or result.content().get("provenance") or {"model": result.seed_model.name}
    decision = decision_html(verdict_sentence(result), facts(result), _physics(result) + _steps(result))
    sections = [
        TextSection("Decision", decision),
        TextSection(
            "What is missing", "".join(_effect(effect, result) for effect in result.effects) + _proposals(result)
        ),
        TextSection("Whether these runs can answer", _adequacy(result)),
        TextSection("What the data say of the seed", _seed(result)),
        TextSection("Proof on locked runs", _proof(result)),
        TextSection("Where the gap is", _where(result)),
        TextSection("The runs that were learned from", _runs(result, result.train)),
        TextSection("What else was considered", _considered(result)),
        TextSection("Provenance", _notes(result) + provenance_html(known)),
    ]
    return [each for each in sections if each.content]


def _subtitle(result: GapResult) -> str:
    learned, locked = counted(len(result.train.runs), "run", "runs"), len(result.holdout.runs)
    return f"Model {result.seed_model.name}; {learned} learned from, {locked} locked for the proof."


def _physics(result: GapResult) -> str:
    return "".join(paragraph(effect_text(effect.name).physics) for effect in result.effects)


def _steps(result: GapResult) -> str:
    steps = next_steps(result)
    return "<h3>What to do next</h3>" + list_html(steps, ordered=len(steps) > 1) if steps else ""


def _effect(effect: Effect, result: GapResult) -> str:
    model = result.model
    text = effect_text(effect.name)
    rivals = paragraph(f"These runs cannot tell it from {' or '.join(effect.rivals)}.") if effect.rivals else ""
    drawn, curve = _curve(effect, model)
    if not drawn:
        drawn, curve = _by_run(effect, result)
    rows = [
        (name, *amount_in_units(name, e.value, e.std, e.unit))
        for name, e in effect.parameters.items()
        if name not in drawn
    ]
    told = any(effect.variant.startswith(f"{name} =") for name in effect.parameters)
    term = _declared(effect)
    combination = ""
    if (combined := effect.combination) and not drawn:
        value, std, unit = estimate_for_people(combined.value, combined.std, combined.unit)
        combination = paragraph(
            f"What these runs determine, where its members are tied: {combined.expression} = "
            f"{value:.4g} ± {std:.2g} {unit} ({combined.because})."
        )
    size = paragraph(f"Usual size: {text.size}.", "faint") if text.size else ""
    evidence = (
        f"Evidence ({effect.where}): p = {effect.p_value:.2g}; the error on data not fitted is lower by "
        f"{100 * effect.gain:.0f} %; named first in {100 * effect.selection_frequency:.0f} % of redrawn data."
    )
    return (
        f"<h3>{escape(text.title)} <code>{escape(effect.name)}</code></h3>{rivals}"
        + (paragraph(f"Found as: {shape_in_words(effect.variant)}.") if effect.variant and not told else "")
        + (table_html(("parameter", "value", "σ", "unit"), rows, "What was found", 4) if rows else "")
        + curve
        + "".join(plot_html(course_plot(c)) for c in (model.corrections if effect.name == DELAY else ()) if c.course)
        + paragraph(evidence)
        + size
        + combination
        + (term_html(term) if term else latex_html(effect.law) if not drawn else "")
    )


def _curve(effect: Effect, model: FrictionModel) -> tuple[set[str], str]:
    """Parameters of a curve over one signal that an effect's law is or holds, and the curve's values for a person."""
    tables = [term.table for term in model.terms if term.table is not None and term.name in effect.law_name.split()]
    if len(tables) != 1 or len(tables[0].knots) != 1 or tables[0].shape == "windows":
        return set(), ""
    table = tables[0]
    (signal, knots), matrix = table.knots[0], at_knots(table)
    names = [parameter.name for parameter in tabulated(table).parameters]
    at = [model.parameter_names.index(name) for name in names]
    heights = matrix @ np.array(model.values)[at]
    own = np.zeros((len(at), len(at))) if model.covariance is None else model.covariance[np.ix_(at, at)]
    std = np.sqrt(np.maximum(np.diag(matrix @ own @ matrix.T), 0.0))
    unit = FACTORS[signal][1]
    shown = [[value_for_people(float(v), table.unit) for v in values] for values in (heights, std)]
    rows = [(value_for_people(k, unit), beside(h, s), s) for k, h, s in zip(knots, *shown, strict=True)]
    head = (f"{_words(signal)} [{for_people(unit)}]", f"value [{for_people(table.unit)}]", "σ")
    times = f", times {' and '.join(map(_words, table.times))}" if table.times else ""
    said = f"A curve over {_words(signal)} that the data drew{times}, {_WHERE[table.scope]}, linear between its places:"
    return set(names), paragraph(said) + table_html(head, rows, "What was found", 4)


def _by_run(effect: Effect, result: GapResult) -> tuple[set[str], str]:
    """The parameter of a table of windows over time that an effect's law is, and what it says of every run."""
    tables = [(term.table, term.parameters[0].name) for term in result.model.terms if term.table is not None]
    own = [(table, name) for table, name in tables if table.in_times and name in effect.parameters]
    if len(own) != 1:
        return set(), ""
    table, name = own[0]
    level = value_for_people(effect.parameters[name].value, table.unit)
    runs = sorted([*result.train.runs, *result.holdout.runs], key=lambda run: run.start)
    rows = [(run.name, in_windows(table, level, run.start + 0.5 * float(run.time[-1]))) for run in runs]
    where = "at each motor's shaft" if table.scope is Scope.SYSTEM else _WHERE[table.scope]
    said = f"{effect.law_name.capitalize()}, {where}; the runs by their dates:"
    return {name}, paragraph(said) + table_html(
        ("run", f"torque [{for_people(table.unit)}]"), rows, "What was found", 3
    )


_WHERE = {Scope.MOTOR: "of each motor", Scope.SYSTEM: "of all motors", Scope.SHAFT: "at the shaft"}


def _words(name: str) -> str:
    return name.replace("_", " ")


def _declared(effect: Effect) -> Term | None:
    """The declared term whose law was found: the effect's own, or the member of its family with these parameters."""
    names = set(effect.parameters)
    known = registered_terms()
    own = [known[effect.name]] if effect.name in known else []
    fitting = [term for term in (*own, *known.values()) if names and {p.name for p in term.parameters} == names]
    return fitting[0] if fitting else None


def _proof(result: GapResult) -> str:
    side, unit = result.holdout, shown_unit(result)
    if not side.blocks.y.size:
        return ""
    rows = [
        ("model as given", side.size_before.value, _interval(side.size_before.interval)),
        ("model.yaml, read back", side.size_after.value, _interval(side.size_after.interval)),
        ("independent noise", side.noise_floor, "–"),
    ]
    locked = ", ".join(run.name for run in side.runs)
    return (
        paragraph(f"Locked before anything else was looked at: {locked}.")
        + table_html(("on locked runs", f"RMS gap [{unit}]", "95 % interval"), rows, digits=3)
        + plot_html(speed_plot(result))
        + _runs(result, side)
    )


def _interval(interval: tuple[float, float]) -> str:
    return f"{number(interval[0], 3)} … {number(interval[1], 3)}"


def _runs(result: GapResult, side: Side) -> str:
    return "".join(plot_html(plot) for plot in run_plots(result, side))


def _where(result: GapResult) -> str:
    return plot_html(heat_plot(result)) + _regions(result) if result.train.blocks.y.size else ""


def _regions(result: GapResult) -> str:
    rows = [(_in_rpm(r.where), 100 * r.share_of_gap, r.mean_residual) for r in result.regions]
    columns = ("where", "share of the gap [%]", f"mean gap [{shown_unit(result)}]")
    return table_html(columns, rows, "Where it is largest", 3) if rows else ""


def _proposals(result: GapResult) -> str:
    proposals = result.content()["proposals"]
    if not proposals:
        return ""
    unit = shown_unit(result)
    said = "".join(
        paragraph(f"{p['sentence'][:1].upper()}{p['sentence'][1:]}.")
        + latex_html(p["latex"])
        + table_html(
            ("parameter", "value", "σ", "unit"),
            [(name, *estimate_for_people(e["value"], e["std"], e["unit"])) for name, e in p["parameters"].items()],
            digits=4,
        )
        for p in proposals
    )  # fmt: skip
    rows = [(p["equation"], p["holdout"]["before"], p["holdout"]["after"],
             100.0 * min(p["holdout"]["closed"], 1.0), p["terms_file"], p["model_file"])
            for p in proposals]  # fmt: skip
    columns = ("equation, SI", f"gap before [{unit}]", f"gap after [{unit}]", "closed [%]", "terms", "model")
    return said + table_html(columns, rows, "Laws proposed for what has no name; locked runs", 3)


def _adequacy(result: GapResult) -> str:
    rows = [
        (c.what, *(value_for_people(each, c.unit) for each in (c.value, c.needed)), for_people(c.unit),
         "yes" if c.met else "no")
        for c in result.adequacy
    ]  # fmt: skip
    return table_html(("what a search needs", "these runs", "needed", "unit", "met"), rows, digits=3) if rows else ""


def _seed(result: GapResult) -> str:
    said = [
        f"{', '.join(each.shifts)} leave what the seed says of them, by {each.sigma:.1f} σ together"
        + (f"; it looks like {', '.join(each.mimics)}." if each.mimics else ".")
        for each in result.seed_refuted
    ]
    return list_html(said)


def _in_rpm(where: str) -> str:
    """A region's words with speeds in rpm, as everywhere on the page."""
    return re.sub(r"([\d.e+-]+) rad/s(?!\^)", lambda found: f"{number(float(found[1]) / RPM, 3)} rpm", where)


def _considered(result: GapResult) -> str:
    kept = {effect.name for effect in result.effects}
    alone = [c for c in result.considered if c.stage == 0][:8]
    rejected = [c for c in result.considered if c.name not in kept]
    first = [(c.name, shape_in_words(c.variant), 100 * c.gain, c.p_value) for c in alone]
    rows = [(c.stage + 1, c.name, shape_in_words(c.variant), c.verdict) for c in rejected]
    blind = [(u.name, u.needs, u.because) for u in result.untestable]
    html = ""
    if first:
        html += table_html(("effect", "shape", "error lower by [%]", "p, family-wise"), first,
                           "Each candidate alone: what it takes off the error on data not fitted", 3)  # fmt: skip
    if rows:
        table = table_html(("step", "effect", "shape", "outcome"), rows, "Considered and rejected")
        html += f"<details><summary>{len(rows)} rejected</summary>{table}</details>"
    if blind:
        html += table_html(("effect", "needs", "because"), blind, "Cannot be tested with these channels")
    return html + _plan(result)


def _plan(result: GapResult) -> str:
    plan = result.next_experiment
    if not plan:
        return ""
    rows = list(plan["considered"].items())
    note = paragraph(str(plan["note"])) if plan.get("note") else ""
    if not rows:
        return note
    return table_html(("scenario", "expected separation [σ]"), rows, "Experiments that were weighed", 3) + note


def _notes(result: GapResult) -> str:
    return list_html([str(note) for note in result.notes])
