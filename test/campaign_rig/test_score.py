"""The campaign's judge counts what the issue's bars count."""

import json

import pytest

from campaign.gap import finished
from campaign.gap_cases import QUICK, Case, Counts, all_cases
from campaign.gap_report import write_table
from campaign.gap_score import score
from campaign.rig import CATALOGUE, OUTSIDE

GAP = {"holdout": {"before": 3.0, "after": 1.2, "noise_floor": 1.0}}


def _answer(verdict, *sets, signals=()):
    effects = [{"name": first, "indistinguishable_from": rest} for first, *rest in sets]
    return {"verdict": verdict, "effects": effects, "unexplained": {"depends_on": list(signals)}, "gap": GAP}


def _single(effect):
    return Case("single", ((effect, 1.0),), "paper", 1)


def test_a_right_name_and_a_right_set_count():
    for answer in (_answer("missing_effect", ["churning"]), _answer("ambiguous", ["viscous", "churning"])):
        judged = score(_single("churning"), answer)
        assert judged["detected"]
        assert judged["right"]
        assert not judged["wrong_single"]
        assert judged["reduction"] == pytest.approx(0.9)


def test_a_set_of_four_is_not_a_name():
    judged = score(_single("churning"), _answer("ambiguous", ["a", "b", "c", "churning"]))
    assert not judged["right"]
    assert not judged["wrong_single"]


def test_a_wrong_name_beside_the_right_one_is_wrong():
    judged = score(_single("churning"), _answer("missing_effect", ["churning"], ["tare_load"]))
    assert judged["right"]
    assert judged["wrong_single"]


def test_a_pair_needs_both():
    case = Case("pair", (("churning", 1.0), ("tare_load", 1.0)), "paper", 1)
    assert score(case, _answer("missing_effect", ["churning"], ["tare_load", "layer_radius"]))["found"] == 2
    assert score(case, _answer("missing_effect", ["churning"]))["found"] == 1
    assert score(case, _answer("missing_effect", ["churning"], ["stribeck"]))["wrong_entry"]


def test_outside_the_library_the_first_signal_counts():
    case = Case("outside", (("wire_out_drag", 1.0),), "paper", 1)
    assert score(case, _answer("unexplained", signals=["wire_out"]))["right_signal"]
    assert not score(case, _answer("unexplained", signals=["motor_speed", "wire_out"]))["right_signal"]


def test_the_full_campaign_has_the_counts_of_the_issue_and_no_seed_twice():
    cases = all_cases(Counts(), 100_000)
    kinds = [case.kind for case in cases]
    assert kinds.count("null") == 200
    assert kinds.count("single") == 27 * 10 * 3
    assert kinds.count("pair") == 20 * 5
    assert kinds.count("outside") >= 6 * 10
    assert len({case.seed for case in cases}) == len(cases)
    assert {case.effects[0][0] for case in cases if case.kind == "single"} == set(CATALOGUE)
    assert {case.effects[0][0] for case in cases if case.kind == "outside"} == set(OUTSIDE)


def test_the_table_survives_an_interrupted_campaign(tmp_path):
    case = _single("churning")
    row = {"key": case.key, "kind": "single", "effects": case.effects, "flavour": "paper", "seed": 1}
    row |= {"seconds": 3.0, "megabytes": 400.0} | score(case, _answer("missing_effect", ["churning"]))
    results = tmp_path / "results.jsonl"
    results.write_text(json.dumps(row) + '\n{"key": "single/cut o')
    write_table(tmp_path / "table.md", list(finished(results).values()), QUICK)
    text = (tmp_path / "table.md").read_text()
    assert "| `churning` | 1 / 1 / 0 of 1 |" in text
    assert "90 %" in text
