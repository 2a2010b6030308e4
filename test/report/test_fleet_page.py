"""The fleet's page: who changed, and how many recordings gave nothing."""

import json
import re

import numpy as np
import pytest

from winch_friction.fleet.drift import Series
from winch_friction.fleet.ledger import Outcome
from winch_friction.fleet.store import write_store
from winch_friction.report.fleet import _changes, _per_crane, _per_recording, _plot, write_fleet_report

NOTHING = {"steps": [], "unlike": [], "notes": []}
STEP = {
    "crane": "north", "trait": "friction", "month": "2026-03", "size": 12.0, "unit": "%", "p_value": 1e-4,
}  # fmt: skip


def outcome(k, status):
    return Outcome(str(k), "north", f"run_{k}", status, 1.0, {}, "" if status == 0 else "no such column")


def page(tmp_path, content, *statuses):
    outcomes = [outcome(k, status) for k, status in enumerate(statuses)]
    return write_fleet_report(tmp_path / "f.html", "gap", outcomes, content, tmp_path / "none").read_text("utf-8")


def test_recordings_without_a_result_are_counted(tmp_path):
    said = page(tmp_path, NOTHING, 0, 0, 2)
    assert "<dd>1 of 3</dd>" in said
    assert "No crane of 1 changed suddenly." in said
    assert "Recordings without a result" not in page(tmp_path, NOTHING, 0, 0)


def test_who_changed_when_and_by_how_much_stands_first(tmp_path):
    said = page(tmp_path, {**NOTHING, "steps": [STEP]}, 0)
    assert "1 of 1 cranes changed suddenly: north 2026-03 (friction +12 %)." in said
    assert "look at seals" in said


def months_page(tmp_path, months_of):
    """A page whose cranes were recorded in these months, counted from January 2024."""
    rows = [{"crane": crane, "recording": f"{m}", "time": 1_704_884_400.0 + m * 30.44 * 86400.0, "kind": "trait",
             "name": "friction", "value": 1.0 + m, "std": 0.3, "unit": "%"}
            for crane, months in months_of.items() for m in months]  # fmt: skip
    write_store(tmp_path / "store", rows)
    return write_fleet_report(tmp_path / "f.html", "check", [outcome(0, 0)], NOTHING, tmp_path / "store").read_text()


def test_one_month_is_no_course_of_time(tmp_path):
    """An empty picture with an axis of milliseconds was drawn."""
    said = months_page(tmp_path, {"north": (1,), "south": (1,)})
    assert "one month, 2024-02" in said
    assert '<figure class="plot"' not in said


def test_a_crane_of_one_month_among_others_is_a_dot(tmp_path):
    said = months_page(tmp_path, {"north": (1,), "south": (1, 2, 3)})
    content = json.loads(re.search(r'application/json">(.*?)</script></figure>', said)[1])
    kinds = {content["frames"][line[3]]["name"]: line[6] for line in content["lines"]}
    assert kinds == {"north": "dots", "south": "lines"}


def cells(html):
    found = re.findall(r"<tr>(.*?)</tr>", html)
    return [[re.sub("<[^>]*>", "", each) for each in re.findall(r"<td[^>]*>(.*?)</td>", row)] for row in found][1:]


def test_a_crane_is_named_once_however_often_it_changed_and_many_changes_are_counted(tmp_path):
    steps = [{**STEP, "month": f"2026-{k + 1:02d}"} for k in range(8)]
    said = page(tmp_path, {**NOTHING, "steps": steps}, 0)
    assert "1 of 1 cranes changed suddenly: north 2026-01 (friction +12 %)," in said
    assert "2026-06 (friction +12 %) and 2 more." in said


def test_cranes_unlike_the_others_are_among_the_first_facts(tmp_path):
    unlike = {"crane": "south", "trait": "constant_torque", "level": 40.0, "fleet": 2.0, "unit": "N*m", "score": 9.0}
    said = page(tmp_path, {**NOTHING, "unlike": [unlike, unlike]}, 0)
    assert "<dt>Cranes unlike the others</dt><dd>south</dd>" in said
    assert "<dt>Cranes unlike the others</dt><dd>none</dd>" in page(tmp_path, NOTHING, 0)
    (row,) = cells(_changes({**NOTHING, "unlike": [unlike]}))
    assert row == ["south", "constant torque", "40 N·m", "2 N·m"]


@pytest.mark.parametrize(("trait", "look", "other"), [
    ("friction", "look at seals", "transducer"), ("constant_torque", "look at a pressure transducer", "seals"),
])  # fmt: skip
def test_what_to_look_at_is_that_of_the_trait_that_jumped(tmp_path, trait, look, other):
    said = page(tmp_path, {**NOTHING, "steps": [{**STEP, "trait": trait}]}, 0)
    todo = said.partition("What to do next")[2].partition("</ul>")[0]
    assert look in todo
    assert other not in todo
    assert "Read the messages" not in todo
    assert "Read the messages" in page(tmp_path, NOTHING, 0, 1).partition("What to do next")[2]


def test_a_change_stands_with_month_signed_size_and_chance():
    step = {**STEP, "trait": "load_proportional", "size": -3.456, "p_value": 0.0123}
    (row,) = cells(_changes({**NOTHING, "steps": [step], "notes": ["a note"]}))
    assert row == ["north", "load proportional", "2026-03", "-3.46\u00a0%", "0.01"]
    assert "<p>a note</p>" in _changes({**NOTHING, "notes": ["a note"]})
    assert "No sudden change." in _changes(NOTHING)


def done(crane, name, status, seconds=1.26, message=""):
    return Outcome(name, crane, name, status, seconds, {"verb": {"verdict": name}} if status == 0 else None, message)


def test_a_cranes_last_outcome_is_the_last_that_worked():
    outcomes = [
        done("b", "b1", 2, message="none"),
        done("a", "a1", 0),
        done("a", "a2", 0),
        done("a", "a3", 1, message="bad"),
        done("b", "b2", 2, message="no column"),
    ]
    assert cells(_per_crane(outcomes)) == [["a", "2 of 3", "a2"], ["b", "0 of 2", "no column"]]
    assert cells(_per_recording(outcomes[:2])) == [["b1", "2", "1.3", "none"], ["a1", "0", "1.3", "a1"]]


def test_cranes_that_changed_are_drawn_strongly_over_the_others():
    months = np.array([24290, 24291])  # February and March 2024
    of = lambda crane, *values: Series(crane, "constant_torque", months, np.array(values), np.ones(2))
    plot = _plot("constant_torque", [of("north", 1.0, 2.0), of("south", 3.0, 4.0)], {"north"})
    assert [(line.label, line.role, plot.frames[line.frame].name) for line in plot.lines] == [
        ("no change", "other", "south"), ("north", "plain", "north"),
    ]  # fmt: skip
    assert plot.frames[0].columns["month"] == ["2024-03-15", "2024-04-15"]
    assert plot.frames[1].columns["constant torque [N·m]"].tolist() == [3.0, 4.0]
