"""The report of a replay: what would have been fed forward, what was learned, and how sure it is."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from winch_friction.physics.channels import RPM
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import Run
from winch_friction.replay.recording import Replayed
from winch_friction.replay.summary import summary
from winch_friction.report.base import TextSection, write_report
from winch_friction.report.decision import decision_html, list_html, provenance_html
from winch_friction.report.plots import Frame, Line, Plot, plot_html
from winch_friction.report.replay_picture import most_learned
from winch_friction.report.tables import (
    estimate_for_people,
    for_people,
    number,
    paragraph,
    table_html,
    value_for_people,
)

TIME = "time [s]"
NEXT = "<h3>What to do next</h3>"
TAUGHT = ("learning", "learned", "frozen")  # statuses of parameters that the recording told something about


def write_replay_page(path: Path, result: Replayed, seed: FrictionModel, provenance: Mapping[str, Any]) -> Path:
    """Write the page; opens offline."""
    content = summary(result)
    sections = [
        TextSection(
            "Decision", decision_html(sentence(content), facts(content), NEXT + list_html(next_steps(content)))
        ),
        TextSection("Friction torque and speed", plot_html(torque_plot(result.compensator, result.estimator))),
        TextSection("What was learned", learned_html(result, seed)),
    ]
    if content["live"]:
        rows = [[each[k] for k in ("node", "compared", "missing", "largest", "equal")] for each in content["live"]]
        columns = ("node", "samples compared", "without an answer", "largest relative difference", "equal")
        sections.append(TextSection("Live against replay", table_html(columns, rows)))
    notes = list_html([str(each) for each in result.warnings])
    sections.append(TextSection("Provenance", notes + provenance_html(provenance)))
    return write_report(path, f"Replay of {content['recording']}", sections)


def sentence(content: Mapping[str, Any]) -> str:
    """What came out, in one sentence."""
    if content["active_share"] == 0.0:
        return "The feedforward was never active: an input that it needs is missing (see what to do next)."
    learned = [each for each in content["parameters"] if each["status"] in TAUGHT]
    said = (
        f"{len(learned)} of {len(content['parameters'])} parameters were learned" if learned else "nothing was learned"
    )
    torque = number(content["feedforward_rms_Nm"], 3)
    return f"The feedforward carried {torque} N·m RMS, {100 * content['active_share']:.0f} % of the time; {said}."


def facts(content: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Torque, length, consistency."""
    inside = content["nis_share_inside"]
    known = isinstance(inside, float) and inside == inside
    return [
        ("Largest feedforward", f"{number(content['feedforward_peak_Nm'], 3)} N·m"),
        ("Recording", f"{content['duration_s']:.0f} s, {content['samples']} samples"),
        ("Samples that the estimator took", f"{100 * content['accepted_share']:.1f} %"),
        ("Innovations inside their 95 % band", f"{100 * inside:.0f} %" if known else ""),
    ]


def next_steps(content: Mapping[str, Any]) -> list[str]:
    """What to do with it."""
    if content["active_share"] == 0.0:
        return ["Log speed_reference, or set velocity_source: measured for the compensator in a --params-file."]
    if any(each["status"] == "invalid" for each in content["parameters"]):
        return ["A parameter ran to its bound: compare runs and model with `winch-friction gap`, something is missing."]
    if not any(each["status"] in TAUGHT for each in content["parameters"]):
        return [
            "Replay a longer recording, or one with more speeds and loads: these samples excite no parameter enough."
        ]
    return [
        "Save what was learned (--out BAG holds friction_model), or let `winch-friction gap` look for what is missing."
    ]


def torque_plot(compensator: Run, estimator: Run) -> Plot:
    """Feedforward and learned friction above; the measured speed below, and the one that the feedforward took."""
    start = compensator.time[0]
    names = ("feedforward [N·m]", "friction by the learned model [N·m]", "motor speed [rpm]", "taken speed [rpm]")
    fed = {
        TIME: compensator.time - start,
        names[0]: compensator["friction_torque"],
        names[3]: compensator["speed"] / RPM,
    }
    learned = {
        TIME: estimator.time - start,
        names[1]: estimator["friction_torque"],
        names[2]: estimator["speed"] / RPM,
    }
    lines = [Line("feedforward", TIME, names[0], 0, 0, "after"),
             Line("friction by the learned model", TIME, names[1], 1, 0, "before"),
             Line("speed", TIME, names[2], 1, 1, "measured")]  # fmt: skip
    if np.any(compensator["speed"] != 0.0):  # waiting, it takes none
        lines.append(Line("speed that the feedforward took", TIME, names[3], 0, 1, "after"))
    frames, rows = [Frame("compensator", fed), Frame("estimator", learned)], ["friction torque [N·m]", names[2]]
    return Plot("Friction torque", frames, lines, TIME, rows, "Torque at the motor shaft, all motors.", "time")


def learned_html(result: Replayed, seed: FrictionModel) -> str:
    """The parameters: a table, and those that the recording told most about over time."""
    meaning = {each.name: each.doc for each in seed.parameters}
    rows = [
        (meaning.get(e.name, ""), e.name,
         value_for_people(e.seed_value, e.unit), *estimate_for_people(e.value, e.std, e.unit), e.status)
        for e in result.parameters
    ]  # fmt: skip
    columns = ("what", "symbol", "seed", "learned", "σ", "unit", "status")
    shown = most_learned(result.estimator, seed)
    words = (
        "seed: the data did not say, it stays there; learning, learned: they did; frozen: learning rests; invalid: at "
        "the edge of its range around the seed."
    )
    plot = plot_html(parameter_plot(result.estimator, seed, shown)) if shown else ""
    return table_html(columns, rows, "Parameters at the end") + paragraph(words, "faint") + plot


def parameter_plot(estimator: Run, seed: FrictionModel, shown: list[str]) -> Plot:
    """The best learned parameters over time, each in its own unit, with one standard deviation."""
    units = {each.name: each.unit for each in seed.parameters}
    columns: dict[str, Any] = {TIME: estimator.time - estimator.time[0]}
    lines, rows = [], []
    for k, name in enumerate(shown):
        unit, value = for_people(units[name]), value_for_people(1.0, units[name]) * estimator[name]
        std = value_for_people(1.0, units[name]) * estimator[f"{name}_std"]
        labels = [f"{part}{name} [{unit}]" for part in ("", "lower ", "upper ")]
        columns |= dict(zip(labels, (value, value - std, value + std), strict=True))
        rows.append(labels[0])
        lines.append(Line("± 1 σ", TIME, labels[1], row=k, kind="band", upper=labels[2], role="noise"))
        lines.append(Line("learned", TIME, labels[0], row=k, role="after"))
        columns[f"seed {name} [{unit}]"] = np.full(len(estimator), value_for_people(seed.value(name), units[name]))
        lines.append(Line("seed", TIME, f"seed {name} [{unit}]", row=k, role="before"))
    return Plot("Learned parameters", [Frame("estimator", columns)], lines, TIME, rows,
                "The parameters that the recording told most about.", "time", height=150)  # fmt: skip
