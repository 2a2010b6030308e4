"""What counts as more than the prior's own uncertainty."""

from campaign.gap_cases import Case
from campaign.gap_report import _small
from campaign.gap_small import beyond_prior


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
