"""What counts as more than the prior's own uncertainty."""

import pytest

from campaign.gap_cases import Case
from campaign.gap_report import _small
from campaign.gap_report_drawn import drawn_worlds
from campaign.gap_small import beyond_prior, counted


@pytest.mark.long
def test_a_brake_that_k4_can_be_is_inside_the_prior_and_a_tare_is_not():
    brake, tare = (
        beyond_prior(Case("single", ((name, 0.3),), "quiet", 21), 0.15) for name in ("brake_drag", "tare_load")
    )
    assert brake["trace"] > 0.3
    assert not brake["exceeds"]
    assert tare["exceeds"]
    assert tare["left"] > 0.5 * tare["trace"]


def test_the_table_lists_those_apart_that_do_not_count():
    rows = [
        {
            "kind": "single", "effects": [(name, 0.3)], "flavour": "quiet", "key": name, "floor": 0.1, "sets": [],
            "verdict": "nothing_missing", "beyond": {"trace": 1.0, "left": left, "exceeds": left > 0.1},
        }
        for name, left in (("brake_drag", 0.01), ("tare_load", 0.9))
    ]  # fmt: skip
    first, second = _small(rows).splitlines()[-2:]
    assert first.startswith("| tare_load × 0.3")
    assert "| yes |" in first
    assert second.startswith("| brake_drag × 0.3")
    assert "| no |" in second


def test_laws_are_counted_once_more_without_those_that_the_prior_can_be():
    rows = [
        {
            "kind": "held_out", "effects": [("tare_load:rope", 1.0)], "flavour": "drawn", "key": str(k), "seed": k,
            "floor": 0.1, "sets": [], "verdict": "nothing_missing", "detected": right, "right": right,
            "wrong_single": False, "beyond": {"trace": 1.0, "left": left, "exceeds": left > 0.1},
        }
        for k, (right, left) in enumerate([(True, 0.9), (False, 0.05), (False, 0.5), (True, 0.7)])
    ]  # fmt: skip
    text = drawn_worlds(rows, lambda some, key: f"{sum(row[key] for row in some)} of {len(some)}")
    assert "| held-out laws: right or in a set of at most 3 | ≥ 85 % | 2 of 4 |" in text
    assert "| … of those whose trace the prior's two σ cannot take | shown | 2 of 3 |" in text
    missed = [line for line in text.splitlines() if line.startswith("| `tare_load:rope` |")]
    assert [line.split("|")[2].strip() for line in missed[-2:]] == ["2", "1"]  # what should have been seen comes first
    assert counted("held_out", [("tare_load:rope", 1.0)])
    assert not counted("single", [("tare_load", 1.0)])
