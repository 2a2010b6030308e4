"""The ledger survives what kills its writer."""

import json

from winch_friction.fleet.ledger import Ledger, Outcome, verdict_of, work_key


def outcome(key, status=0, result=None):
    return Outcome(key, "north", f"{key}.csv", status, 0.1, result, "")


def test_a_line_cut_short_is_dropped_and_spoils_no_other(tmp_path):
    ledger = Ledger(tmp_path / "fleet.jsonl")
    ledger.add(outcome("a"))
    ledger.add(outcome("b"))
    whole = ledger.path.read_text()
    ledger.path.write_text(whole[:-20])  # killed while writing b
    again = Ledger(ledger.path)
    again.add(outcome("c"))
    assert sorted(again.latest()) == ["a", "c"]
    assert len(ledger.path.read_text().splitlines()) == 3
    assert json.loads(ledger.path.read_text().splitlines()[-1])["key"] == "c"


def test_the_last_outcome_of_a_piece_of_work_counts(tmp_path):
    ledger = Ledger(tmp_path / "fleet.jsonl")
    ledger.add(outcome("a", status=1))
    ledger.add(outcome("a", status=0))
    assert ledger.latest()["a"].status == 0


def test_any_change_is_other_work():
    same = work_key("gap", "v1", "x.csv", {"holdout": "0.3"})
    assert same == work_key("gap", "v1", "x.csv", {"holdout": "0.3"})
    others = [
        work_key("replay", "v1", "x.csv", {"holdout": "0.3"}),
        work_key("gap", "v2", "x.csv", {"holdout": "0.3"}),
        work_key("gap", "v1", "y.csv", {"holdout": "0.3"}),
        work_key("gap", "v1", "x.csv", {"holdout": "0.4"}),
    ]
    assert same not in others


def test_the_verdict_is_told_with_its_names():
    found = {"verb": {"verdict": "ambiguous", "effects": [{"name": "churning", "indistinguishable_from": ["notch"]}]}}
    assert verdict_of(outcome("a", result=found)) == "ambiguous: churning or notch"
    assert verdict_of(outcome("a", result={"verb": {"plausible": True}})) == "plausible"
    assert verdict_of(Outcome("a", "c", "r", 2, 0.0, None, "no such file")) == "no such file"
