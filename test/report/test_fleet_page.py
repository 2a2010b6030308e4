"""The fleet's page: who changed, and how many recordings gave nothing."""

from winch_friction.fleet.ledger import Outcome
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
