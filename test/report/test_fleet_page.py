"""The fleet's page: who changed, and how many recordings gave nothing."""

import json
import re

from winch_friction.fleet.ledger import Outcome
from winch_friction.fleet.store import write_store
from winch_friction.report.fleet import write_fleet_report

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
