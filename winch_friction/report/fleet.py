"""The fleet's page: verdict per crane, who changed and when, who is unlike the others, and the months themselves."""

from collections.abc import Mapping, Sequence
from datetime import date
from pathlib import Path
from typing import Any

from winch_friction.fleet.fingerprint import TRAITS
from winch_friction.fleet.ledger import Outcome, verdict_of
from winch_friction.report.base import Section, TextSection, write_report
from winch_friction.report.figures import figure_html, legend_above, new_figure
from winch_friction.report.tables import paragraph, table_html

MOST_DRAWN = 60  # cranes in one figure; more are said, not drawn
MOST_NAMED = 12  # lines that a legend can tell apart
_OTHERS: dict[str, Any] = {"linewidth": 0.7, "color": "0.55", "zorder": 0}


def write_fleet_report(
    path: Path, verb: str, outcomes: Sequence[Outcome], content: Mapping[str, Any], store: Path
) -> Path:
    """Write the page atomically; `content` is that of fleet.json."""
    failed = sum(each.status != 0 for each in outcomes)
    summary = f"{len(outcomes)} results, {failed} without; {len(content['steps'])} sudden changes"
    sections: list[Section] = [
        TextSection("What changed", _changes(content)),
        TextSection("Over the months", _months(store, content)),
        TextSection("Per crane", _per_crane(outcomes)),
        TextSection("Per recording", table_html(("recording", "exit", "s", "outcome"), _outcome_rows(outcomes))),
    ]
    return write_report(path, f"Fleet: {verb}", sections, summary)


def _changes(content: Mapping[str, Any]) -> str:
    steps = [
        (s["crane"], s["trait"], s["month"], f"{s['size']:+.1f} {s['unit']}", f"{s['p_value']:.1g}")
        for s in content["steps"]
    ]
    unlike = [
        (u["crane"], u["trait"], f"{u['level']:.1f} {u['unit']}", f"{u['fleet']:.1f} {u['unit']}")
        for u in content["unlike"]
    ]
    words = (
        "<p><b>friction</b>: friction beyond the model's, in % of it (seals, wear). "
        "<b>constant_torque</b>: what does not change sign with the motion (transducers, weight).</p>"
    )
    parts = [words, "<p>No sudden change.</p>" if not steps else ""]
    if steps:
        parts.append(table_html(("crane", "what", "first month after", "size", "p"), steps))
    if unlike:
        parts.append("<h3>Unlike the others</h3>" + table_html(("crane", "what", "level", "fleet"), unlike))
    parts += [paragraph(note) for note in content["notes"]]
    return "".join(parts)


def _per_crane(outcomes: Sequence[Outcome]) -> str:
    rows = []
    for crane in sorted({each.crane for each in outcomes}):
        own = [each for each in outcomes if each.crane == crane]
        good = [each for each in own if each.status == 0]
        said = verdict_of(good[-1]) if good else own[-1].message
        rows.append((crane, f"{len(good)} of {len(own)}", said))
    return table_html(("crane", "worked", "last outcome"), rows)


def _outcome_rows(outcomes: Sequence[Outcome]) -> list[tuple[str, ...]]:
    return [(o.recording, str(o.status), f"{o.seconds:.1f}", verdict_of(o)) for o in outcomes]


def _months(store: Path, content: Mapping[str, Any]) -> str:
    """One small figure per trait: a line per crane, those that changed drawn strongly."""
    from winch_friction.fleet.drift import month_text, monthly
    from winch_friction.fleet.store import read_store

    if not store.is_dir():
        return "<p>No recording with a date.</p>"
    frame = read_store(store)
    frame = frame[frame["kind"] == "trait"]
    rows: dict[tuple[str, str], list[tuple[float, float, float]]] = {}
    for row in frame.itertuples():
        rows.setdefault((row.crane, row.name), []).append((row.time, row.value, row.std))
    series = monthly(rows)
    changed = {step["crane"] for step in content["steps"]}
    cranes = sorted({each.crane for each in series}, key=lambda name: (name not in changed, name))
    drawn = set(cranes[:MOST_DRAWN])
    figures = []
    for trait in sorted({each.trait for each in series}):
        own = [each for each in series if each.trait == trait and each.crane in drawn]
        lines = [
            (each.crane, [f"{month_text(m)}-15" for m in each.months.tolist()], each.values.tolist()) for each in own
        ]
        figures.append(_figure(trait, lines, changed))
    left = len(cranes) - len(drawn)
    return "".join(figures) + (f"<p>{left} further cranes are not drawn.</p>" if left > 0 else "")


def _figure(trait: str, lines: Sequence[tuple[str, list[str], list[float]]], changed: set[str]) -> str:
    """The lines as a picture: cranes that changed in colour, the others thin and grey."""
    figure, axes = new_figure(height=3.4)
    for crane, days, values in lines:
        strong = {"linewidth": 1.8, "label": crane} if crane in changed else _OTHERS
        axes.plot([date.fromisoformat(day) for day in days], values, **strong)
    axes.set_ylabel(f"{trait.replace('_', ' ')}, {TRAITS[trait].replace('*', ' ')}")
    if 0 < len(changed) <= MOST_NAMED:
        legend_above(axes, columns=4)
    return figure_html(figure, f"{trait.replace('_', ' ')} beyond the model, by month and crane")
