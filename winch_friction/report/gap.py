"""The report of the discrepancy workflow: one page, verdict first."""

from collections.abc import Iterable, Sequence
from html import escape
from pathlib import Path
from typing import Any

from winch_friction.discrepancy.answer import Effect, GapResult
from winch_friction.report.base import Section, TextSection, write_report
from winch_friction.report.gap_pictures import equation, heat_maps, speed_bars, traces


def write_gap_report(path: Path, result: GapResult) -> Path:
    """Write report.html: self-contained, opens offline."""
    return write_report(
        path, "Where simulation and measurement disagree", gap_sections(result), verdict_sentence(result)
    )


def gap_sections(result: GapResult) -> list[Section]:
    """The sections in the order a reader needs them."""
    return [
        TextSection("Verdict", f"<p><strong>{escape(verdict_sentence(result))}</strong></p>{_figures(result)}"),
        TextSection("Where", heat_maps(result) + _regions(result)),
        TextSection("What is missing", _effects(result.effects)),
        TextSection("Before and after on locked runs", traces(result) + speed_bars(result)),
        TextSection("Ranking", _ranking(result)),
        TextSection("Considered and rejected", _rejected(result)),
        TextSection("Next experiment", _next(result)),
    ]


def verdict_sentence(result: GapResult) -> str:
    """The verdict in one sentence."""
    names = ", ".join(effect.name for effect in result.effects)
    if result.verdict == "nothing_missing":
        return "Nothing is missing: what is left is noise and parameters within the model's own uncertainty."
    if result.verdict == "unexplained":
        signals = ", ".join(each.signal for each in result.depends) or "no recorded signal"
        return f"Something is missing that no named effect explains; it depends on {signals} ({result.refused})."
    if result.verdict == "ambiguous":
        rivals = "; ".join(f"{e.name} or {' or '.join(e.rivals)}" for e in result.effects if e.rivals)
        return f"Missing: {names}. These runs cannot tell apart: {rivals}."
    return f"Missing: {names}."


def _figures(result: GapResult) -> str:
    side, unit = result.holdout, result.unit
    rows = [
        ("model as given", f"{side.size_before.value:.3g} {unit}", _interval(side.size_before.interval)),
        ("repaired model", f"{side.size_after.value:.3g} {unit}", _interval(side.size_after.interval)),
        ("independent noise", f"{side.noise_floor:.3g} {unit}", ""),
    ]
    notes = "".join(f"<li>{escape(note)}</li>" for note in result.notes)
    locked = ", ".join(run.name for run in side.runs)
    return (
        _table(("on locked runs", "RMS gap", "95 % interval"), rows)
        + f"<p>Locked before anything else was looked at: {escape(locked)}.</p>"
        + (f"<ul>{notes}</ul>" if notes else "")
    )


def _interval(interval: tuple[float, float]) -> str:
    return f"{interval[0]:.3g} ... {interval[1]:.3g}"


def _regions(result: GapResult) -> str:
    rows = [(r.where, f"{100 * r.share_of_gap:.0f} %", f"{r.mean_residual:+.3g} {result.unit}") for r in result.regions]
    return _table(("where", "share of the gap", "mean"), rows)


def _effects(effects: Sequence[Effect]) -> str:
    if not effects:
        return "<p>No effect was added.</p>"
    return "".join(_effect(effect) for effect in effects)


def _effect(effect: Effect) -> str:
    rivals = f" or {escape(' or '.join(effect.rivals))}" if effect.rivals else ""
    rows = [(name, f"{e.value:.4g}", f"{e.std:.2g}", e.unit) for name, e in effect.parameters.items()]
    variant = f"<p>{escape(effect.variant)}</p>" if effect.variant else ""
    return (
        f"<h3>{escape(effect.name)}{rivals}</h3>{equation(effect.law)}{variant}"
        + _table(("parameter", "value", "std", "unit"), rows)
        + f"<p>Evidence ({escape(effect.where)}): p = {effect.p_value:.2g}, held-out error lower by "
        f"{100 * effect.gain:.0f} %, first in {100 * effect.selection_frequency:.0f} % of redrawn segments.</p>"
    )


def _ranking(result: GapResult) -> str:
    first = [each for each in result.considered if each.stage == 0][:8]
    rows = [(c.name, c.variant, f"{100 * c.gain:.1f} %", f"{c.p_value:.2g}") for c in first]
    text = "<p>Each candidate alone, added to the base model: what it takes off the held-out error.</p>"
    return text + _table(("effect", "shape", "gain", "family-wise p"), rows)


def _rejected(result: GapResult) -> str:
    kept = {effect.name for effect in result.effects}
    rows = [(c.stage + 1, c.name, c.variant, c.verdict) for c in result.considered if c.name not in kept]
    blind = [(u.name, u.needs, u.because) for u in result.untestable]
    return _table(("step", "effect", "shape", "outcome"), rows) + (
        "<h3>Untestable with these channels</h3>" + _table(("effect", "needs", "because"), blind) if blind else ""
    )


def _next(result: GapResult) -> str:
    plan = result.next_experiment
    if not plan:
        return "<p>None is needed to tell rivals apart.</p>"
    rows = [(name, f"{z:.2f}") for name, z in plan["considered"].items()]
    note = f"<p>{escape(plan['note'])}</p>" if plan.get("note") else ""
    return (
        f"<p>Run <code>winch-friction simulate {escape(plan['scenario'])}</code>, or its likeness on the crane: it "
        f"separates {escape(' from '.join(plan['separates']))} by {plan['expected_z']:.1f} sigma.</p>{note}"
        + _table(("scenario", "expected separation, sigma"), rows)
    )


def _table(head: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    top = "".join(f"<th>{escape(str(cell))}</th>" for cell in head)
    body = "".join("<tr>" + "".join(f"<td>{escape(str(cell))}</td>" for cell in row) + "</tr>" for row in rows)
    return f"<table><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table>"
