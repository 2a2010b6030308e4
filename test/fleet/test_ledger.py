"""The ledger survives what kills its writer."""

import json

import pytest

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


@pytest.mark.parametrize(("verb", "said"), [
    ({"verdict": "nothing_missing", "effects": []}, "nothing_missing"),
    ({"verdict": "missing_effect", "effects": [{"name": "a"}, {"name": "b", "indistinguishable_from": ["c"]}]},
     "missing_effect: a + b or c"),
    ({"active_share": 0.25, "feedforward_peak_Nm": 456.4}, "active 25 %, peak 456 N m"),
    ({"plausible": False}, "done"), ({"seed": {}}, "done"),
])  # fmt: skip
def test_each_verbs_answer_is_told_in_its_own_words(verb, said):
    assert verdict_of(outcome("a", result={"verb": verb})) == said


def test_what_failed_is_told_by_its_message_whatever_it_gave():
    given = {"verb": {"verdict": "nothing_missing"}}
    assert verdict_of(Outcome("a", "c", "r", 1, 0.0, given, "KeyError: x")) == "KeyError: x"
    assert verdict_of(Outcome("a", "c", "r", 0, 0.0, {"verb": "text"}, "")) == "done"


def test_a_ledger_of_whole_lines_is_left_as_it_is(tmp_path):
    ledger = Ledger(tmp_path / "deep" / "fleet.jsonl")
    assert list(ledger.outcomes()) == []
    ledger.add(outcome("a", result={"x": 1}))
    before = ledger.path.read_bytes()
    again = Ledger(ledger.path)
    assert ledger.path.read_bytes() == before
    assert list(again.outcomes()) == [outcome("a", result={"x": 1})]


def test_the_order_of_options_is_no_other_work():
    assert work_key("gap", "v", "x", {"a": 1, "b": 2}) == work_key("gap", "v", "x", {"b": 2, "a": 1})
    assert len({work_key("gap", "v", "x", {"a": value}) for value in (1, 2, None, "1")}) == 4
