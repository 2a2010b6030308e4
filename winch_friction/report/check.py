"""The commissioning page: verdict, findings, the balance of every run, every channel, what to log next."""

from collections.abc import Mapping
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from winch_friction.commissioning.commissioning import CheckResult
from winch_friction.commissioning.view import usable
from winch_friction.physics.channels import OF_GROUP, WINCH
from winch_friction.physics.signals import FloatArray, Run
from winch_friction.records.unit_names import conversion_to_si
from winch_friction.report.base import Section, TextSection, write_report
from winch_friction.report.decision import decision_html, list_html
from winch_friction.report.plots import Frame, Line, Plot, plot_html
from winch_friction.report.tables import for_people, paragraph, table_html

KILO = 1e3  # N m per kN m
MOST_RUNS_DRAWN = 24  # runs; beyond, the page would weigh more than a phone takes


def write_check_report(path: Path, result: CheckResult, provenance: Mapping[str, Any] | None = None) -> Path:
    """Write check.html: self-contained, opens offline."""
    count = len(result.runs)
    model = f", model {result.model}" if result.model else ""
    said = f"Crane {result.crane.name}{model}; {count} run{'s' if count != 1 else ''}."
    return write_report(path, "Commissioning check", check_sections(result), said, provenance)


def check_sections(result: CheckResult) -> list[Section]:
    """The sections in the order a reader needs them."""
    sections = [
        TextSection("Decision", _decision(result)),
        TextSection("Findings", _findings(result)),
        TextSection("Mistakes that were tried", _ranking(result)),
        TextSection("Torque balance", _balance(result)),
        TextSection("Channels", _channels(result)),
        TextSection("What these runs can teach", _lessons(result)),
    ]
    return [each for each in sections if each.content]


def _decision(result: CheckResult) -> str:
    errors = [each for each in result.findings if each.contradicts]
    facts = [
        ("verdict", "plausible" if result.plausible else "not this crane's as it stands"),
        ("contradictions", str(len(errors)) if errors else ""),
        ("largest misfit", f"{max((b.score for b in result.balance), default=0.0):.3g} (limit {result.limit:g})"),
    ]
    after = "<h3>Log next</h3>" + list_html(result.log_next) if result.log_next else ""
    return decision_html(result.sentence, facts, after)


def _findings(result: CheckResult) -> str:
    if not result.findings:
        return paragraph("Nothing was found.")
    return table_html(
        ("severity", "channel", "finding"), [(f.severity, f.channel, f.sentence) for f in result.findings]
    )


def _ranking(result: CheckResult) -> str:
    first = result.diagnosis.hypotheses[:8]
    if not first:
        return ""
    rows = [("as it stands", result.diagnosis.score, "")]
    rows += [(h.mistake.words, h.score, h.mistake.channel) for h in first]
    words = (
        "The misfit of all runs with each mistake undone, beside the misfit as the data stand: friction, load and "
        "inertia may be wrong by their ordinary errors for nothing. Less is better; a few units are no difference."
    )
    return paragraph(words) + table_html(("if", "misfit", "channel"), rows)


def _balance(result: CheckResult) -> str:
    rows = [
        (b.run, b.score, b.before, b.after, b.level, ", ".join(f"{a.channel} {a.ratio:.3g}" for a in b.agreements))
        for b in result.balance
    ]
    head = ("run", "misfit", "as it stands [N·m]", "after ordinary errors [N·m]", "load [N·m]", "speed told by")
    plots = "".join(plot_html(_balance_plot(result, k)) for k in range(min(len(result.closures), MOST_RUNS_DRAWN)))
    return table_html(head, rows) + plots


def _balance_plot(result: CheckResult, number: int) -> Plot:
    closure = result.closures[number]
    x, names = "time [s]", ("drive, measured [kN·m]", "load, friction and inertia [kN·m]")
    columns = {x: closure.time - closure.time[0], names[0]: closure.drive / KILO, names[1]: closure.expected / KILO}
    lines = [Line("measured", x, names[0], role="measured"), Line("expected", x, names[1], role="before")]
    caption = f"{closure.run}: torque of all motors at the shaft, against what load, friction and inertia ask for."
    return Plot(f"Balance {closure.run}", [Frame(closure.run, columns)], lines, x, ["torque [kN·m]"], caption, "runs")


def _channels(result: CheckResult) -> str:
    drawn = result.runs[:MOST_RUNS_DRAWN]
    said = "" if len(drawn) == len(result.runs) else paragraph(f"The first {len(drawn)} runs are drawn.", "faint")
    return said + "".join(f"<h3>{escape(run.name)}</h3>" + _numbers(result, run) + _drawn(run) for run in drawn)


def _numbers(result: CheckResult, run: Run) -> str:
    rows = []
    for c in result.channels[run.name]:
        smallest, unit = _shown(c.channel, np.array([c.smallest]))
        largest, _ = _shown(c.channel, np.array([c.largest]))
        rows.append((c.channel, unit, smallest[0], largest[0], 100.0 * c.missing, c.longest_still))
    return table_html(("channel", "unit", "smallest", "largest", "missing [%]", "longest still [s]"), rows)


def _drawn(run: Run) -> str:
    """Every channel over time, channels of one unit in one panel."""
    panels: dict[str, list[tuple[str, FloatArray]]] = {}
    for name, values in run.columns.items():
        if name != "time":
            shown, unit = _shown(name, usable(name, values))
            panels.setdefault(unit, []).append((f"{name} [{unit}]", shown))
    x = "time [s]"
    columns = {x: run.time - run.time[0], **{label: v for each in panels.values() for label, v in each}}
    lines = [
        Line(label.partition(" [")[0], x, label, row=row)
        for row, each in enumerate(panels.values())
        for label, _ in each
    ]
    rows = [f"[{unit}]" for unit in panels]
    plot = Plot(f"Channels {run.name}", [Frame(run.name, columns)], lines, x, rows, "", "runs", height=120)
    return plot_html(plot)


def _shown(column: str, values: FloatArray) -> tuple[FloatArray, str]:
    """Values in the unit that people read."""
    channel = OF_GROUP.get(column.rpartition(".")[2]) if "." in column else WINCH.get(column)
    if channel is None:
        return values, "SI"
    if channel.display == channel.unit:
        return values, for_people(channel.unit)
    scale, offset = conversion_to_si(channel.display, channel.unit, column)
    return (values - offset) / scale, for_people(channel.display)


def _lessons(result: CheckResult) -> str:
    if not result.identifiable:
        return ""
    rows = [(p.name, 100.0 * p.before, 100.0 * p.after, p.words) for p in result.identifiable]
    head = ("parameter", "model's std [%]", "std with these runs [%]", "these runs teach")
    words = "By the Jacobian of the model at these runs, terms with memory left out; nothing was fitted."
    return paragraph(words) + table_html(head, rows)
