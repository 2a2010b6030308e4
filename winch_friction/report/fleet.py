"""The fleet's page: verdict per crane, who changed and when, who is unlike the others, and the months themselves."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from winch_friction.fleet.drift import Series, month_text, monthly
from winch_friction.fleet.fingerprint import TRAITS
from winch_friction.fleet.ledger import Outcome, verdict_of
from winch_friction.report.base import Section, TextSection, write_report
from winch_friction.report.decision import decision_html, list_html
from winch_friction.report.plots import Frame, Line, Plot, plot_html
from winch_friction.report.tables import paragraph, table_html

MOST_DRAWN = 60  # cranes in one figure; more are said, not drawn
MOST_NAMED = 6  # changes in the first sentence; the table has them all
MONTH = "month"
# trait -> what it is, and what to look at when it jumps
TRAIT_WORDS = {
    "friction": ("friction beyond the model's", "seals, brake, bearings, or new parts that run in"),
    "constant_torque": (
        "torque that does not change sign with the motion",
        "a pressure transducer's zero, or the load",
    ),
}


def write_fleet_report(
    path: Path,
    verb: str,
    outcomes: Sequence[Outcome],
    content: Mapping[str, Any],
    store: Path,
    provenance: Mapping[str, Any] | None = None,
) -> Path:
    """Write the page atomically; `content` is that of fleet.json."""
    cranes = len({each.crane for each in outcomes})
    sections: list[Section] = [
        TextSection("Decision", _decision(outcomes, content, cranes)),
        TextSection("What changed", _changes(content)),
        TextSection("Over the months", _months(store, content)),
        TextSection("Per crane", _per_crane(outcomes)),
        TextSection("Per recording", _per_recording(outcomes)),
    ]
    said = f"{cranes} cranes, {len(outcomes)} results of {verb}"
    return write_report(path, f"Fleet: {verb}", sections, said, provenance)


def _decision(outcomes: Sequence[Outcome], content: Mapping[str, Any], cranes: int) -> str:
    """Who changed and when, how many recordings gave nothing, what to look at."""
    steps, unlike = content["steps"], content["unlike"]
    failed = sum(each.status != 0 for each in outcomes)
    changed = len({step["crane"] for step in steps})
    said = [f"{s['crane']} {s['month']} ({s['trait'].replace('_', ' ')} {_size(s)})" for s in steps]
    more = f" and {len(said) - MOST_NAMED} more" if len(said) > MOST_NAMED else ""
    sentence = (
        f"{changed} of {cranes} cranes changed suddenly: {', '.join(said[:MOST_NAMED])}{more}."
        if steps
        else f"No crane of {cranes} changed suddenly."
    )
    facts = [
        ("Cranes unlike the others", ", ".join(dict.fromkeys(u["crane"] for u in unlike)) or "none"),
        ("Recordings without a result", f"{failed} of {len(outcomes)}" if failed else ""),
    ]
    looked = [f"{words[0].capitalize()} jumped: look at {words[1]}." for trait, words in TRAIT_WORDS.items()
              if any(step["trait"] == trait for step in steps)]  # fmt: skip
    looked += ["Read the messages of the recordings that gave no result, below."] if failed else []
    return decision_html(sentence, facts, "<h3>What to do next</h3>" + list_html(looked) if looked else "")


def _size(step: Mapping[str, Any]) -> str:
    return f"{step['size']:+.3g} {step['unit'].replace('*', '·')}"


def _changes(content: Mapping[str, Any]) -> str:
    steps = [
        (s["crane"], s["trait"].replace("_", " "), s["month"], _size(s), float(f"{s['p_value']:.1g}"))
        for s in content["steps"]
    ]
    unlike = [
        (
            u["crane"],
            u["trait"].replace("_", " "),
            *(f"{u[k]:.3g} {u['unit'].replace('*', '·')}" for k in ("level", "fleet")),
        )
        for u in content["unlike"]
    ]
    parts = [paragraph(f"{trait.replace('_', ' ')}: {words}.", "faint") for trait, (words, _) in TRAIT_WORDS.items()]
    parts += [] if steps else [paragraph("No sudden change.")]
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


def _per_recording(outcomes: Sequence[Outcome]) -> str:
    rows = [(o.recording, o.status, round(o.seconds, 1), verdict_of(o)) for o in outcomes]
    return table_html(("recording", "exit status", "time [s]", "outcome"), rows)


def _months(store: Path, content: Mapping[str, Any]) -> str:
    """One figure per trait: a line per crane, those that changed drawn strongly."""
    from winch_friction.fleet.store import read_store

    if not store.is_dir():
        return "<p>No recording with a date.</p>"
    frame = read_store(store)
    frame = frame[frame["kind"] == "trait"]
    rows: dict[tuple[str, str], list[tuple[float, float, float]]] = {}
    for row in frame.itertuples():
        rows.setdefault((row.crane, row.name), []).append((row.time, row.value, row.std))
    series = monthly(rows)
    months = {month for each in series for month in each.months.tolist()}
    if len(months) == 1:
        return f"<p>All recordings are of one month, {month_text(months.pop())}: there is nothing to follow yet.</p>"
    changed = {step["crane"] for step in content["steps"]}
    cranes = sorted({each.crane for each in series}, key=lambda name: (name not in changed, name))
    drawn = set(cranes[:MOST_DRAWN])
    figures = []
    for trait in sorted({each.trait for each in series}):
        own = [each for each in series if each.trait == trait and each.crane in drawn]
        figures.append(plot_html(_plot(trait, own, {s["crane"] for s in content["steps"] if s["trait"] == trait})))
    left = len(cranes) - len(drawn)
    return "".join(figures) + (f"<p>{left} further cranes are not drawn.</p>" if left > 0 else "")


def _plot(trait: str, series: Sequence[Series], changed: set[str]) -> Plot:
    """A line per crane, those that changed strongly, the others faint."""
    label = f"{trait.replace('_', ' ')} [{TRAITS[trait].replace('*', '·')}]"
    frames = [
        Frame(each.crane, {MONTH: [f"{month_text(m)}-15" for m in each.months.tolist()], label: each.values})
        for each in series
    ]
    lines = [
        Line(each.crane if each.crane in changed else "no change", MONTH, label, k,
             role="plain" if each.crane in changed else "other", kind="lines" if len(each.months) > 1 else "dots")
        for k, each in enumerate(series)
    ]  # fmt: skip
    said = f"{TRAIT_WORDS[trait][0].capitalize()}, by month; a line is a crane, those that changed in colour."
    title = trait.replace("_", " ").capitalize()
    return Plot(title, frames, sorted(lines, key=lambda e: e.role), MONTH, [label], said, "months", height=300)
