"""The scan of thresholds: what branches off is what a search with that threshold would have said."""

import json
import subprocess
import sys
from dataclasses import replace

import pytest

from campaign.thresholds import (
    ADEQUACY,
    FROZEN,
    SETTINGS,
    all_cases,
    branched,
    deciding,
    finished,
    scaled,
    table,
    whole,
)
from winch_friction.discrepancy.thresholds import LIMITS, Thresholds

# in a process of its own: what branches off is a copy of all that runs in it
SEARCH = """
import json, os, sys
from campaign.thresholds import branched
from winch_friction.discrepancy.thresholds import LIMITS

def work():
    steps.append("begun")
    first = LIMITS.left_over
    steps.append("on")
    if LIMITS.most_named > 2 and first > 0:
        raise ValueError("too many")
    return [first, LIMITS.prior_weight, LIMITS.left_over, LIMITS.most_effects, len(steps)]

def tell(name, factor, result):
    with open(sys.argv[1], "a") as out:
        out.write(json.dumps([os.getpid() == this, name, factor, result]) + "\\n")

steps, this = [], os.getpid()
branched(work, ["left_over", "most_effects", "most_named", "never_noise"], tell)
assert LIMITS.left_over == 0.15 and "__getattribute__" not in vars(type(LIMITS))
"""


def test_each_branch_goes_on_with_its_own_threshold_and_what_was_done_before(tmp_path):
    told = tmp_path / "told.jsonl"
    subprocess.run([sys.executable, "-c", SEARCH, str(told)], check=True, capture_output=True, timeout=120)
    lines = [json.loads(line) for line in told.open()]
    rows = {(name, factor): (here, result) for here, name, factor, result in lines}
    assert len(lines) == len(rows)  # what branched off branches no further
    as_frozen = [0.15, 10.0, 0.15, 4, 2]
    assert rows == {
        ("left_over", 0.5): (False, [0.075, 10.0, 0.075, 4, 2]), ("left_over", 2.0): (False, [0.3, 10.0, 0.3, 4, 2]),
        ("most_effects", 0.5): (False, [0.15, 10.0, 0.15, 2, 2]),
        ("most_effects", 2.0): (False, [0.15, 10.0, 0.15, 8, 2]),
        ("most_named", 0.5): (False, as_frozen), ("most_named", 2.0): (True, {"error": "its process died"}),
        ("never_noise", 0.5): (True, as_frozen), ("never_noise", 2.0): (True, as_frozen),
        FROZEN: (True, as_frozen),
    }  # fmt: skip


def test_a_search_that_fails_as_frozen_says_so_and_leaves_the_table_as_it_was():
    def work():
        raise ValueError("no runs")

    with pytest.raises(ValueError, match="no runs"):
        branched(work, [], lambda *_: None)
    assert "__getattribute__" not in vars(Thresholds)
    told = []
    branched(lambda: LIMITS.left_over, [], lambda *row: told.append(row), also=False)
    assert told == []


@pytest.mark.parametrize(
    ("value", "factor", "changed"),
    [
        (0.15, 0.5, 0.075),
        (0.8, 2.0, 1.0),
        (1.05, 2.0, 2.1),
        (3, 0.5, 2),
        (1, 0.5, 1),
        (3, 2.0, 6),
        (((10, 9.0), (6, 14.0)), 0.5, ((10, 4.5), (6, 7.0))),
    ],
)  # fmt: skip
def test_a_count_stays_one_and_of_a_table_the_bars_change(value, factor, changed):
    assert scaled(value, factor) == changed
    assert type(scaled(value, factor)) is type(value)


def test_every_threshold_is_scanned_or_said_not_to_be():
    apart = {*ADEQUACY, *SETTINGS}
    fields = set(Thresholds.__dataclass_fields__)
    assert apart <= fields
    assert len(apart) == len(ADEQUACY) + len(SETTINGS)
    assert set(deciding()) == fields - apart
    for name in deciding():
        replace(LIMITS, **{name: scaled(getattr(LIMITS, name), 2.0)})


def test_the_data_sets_are_of_every_kind_and_none_twice():
    cases = all_cases(5)
    assert len({case.seed for case in cases}) == len({case.key for case in cases}) == len(cases)
    kinds = [case.kind for case in cases]
    assert {kind: kinds.count(kind) for kind in kinds} == {
        "drawn_outside": 1, "held_out": 2, "drawn_null": 6, "law": 2, "far_seed": 1,
    }  # fmt: skip
    assert len(set(kinds[:5])) == 5


def _row(key, name, factor, verdict, **also):
    judged = {"sets": [], "detected": verdict != "nothing_missing", "commit": "abc"} | also
    return {"key": key, "kind": key.split("/")[0], "threshold": name, "factor": factor, "verdict": verdict, **judged}


def test_the_table_says_what_changes_and_where_and_names_what_does_not(tmp_path):
    null, law = "drawn_null/nothing/drawn/1", "law/wear_drift:catalogue*1/drawn/2"
    named = {"sets": [["wear_drift"]], "right": True, "wrong_single": False}
    rows = [
        _row(null, *FROZEN, "nothing_missing"), _row(law, *FROZEN, "missing_effect", **named),
        _row(null, "left_over", 0.5, "unexplained"), _row(law, "left_over", 0.5, "missing_effect", **named),
        _row(null, "left_over", 2.0, "nothing_missing"), _row(law, "left_over", 2.0, "missing_effect", **named),
        *(_row(null, "never_noise", factor, "nothing_missing") for factor in (0.5, 2.0)),
        *(_row(law, "never_noise", factor, "missing_effect", **named) for factor in (0.5, 2.0)),
        _row(null, "outdone", 2.0, "nothing_missing"),
        _row(law, "outdone", 2.0, "missing_effect", sets=[["brake_drag"]], wrong_single=True),
    ]  # fmt: skip
    text = table(rows)
    lines = {line.split(" | ")[0].strip("| `"): line for line in text.splitlines() if line.startswith("| ")}
    assert lines["**as frozen**"].startswith("| **as frozen** | 1 | | 0 of 1 | 0 of 0 | 1 of 1 | 0 of 0 | 0 of 2 |")
    assert "| 0.5 | a null: `unexplained` | 1 of 1 | " in lines["left_over"]
    assert "| 2 | wear_drift:catalogue: `missing_effect` brake_drag | 0 of 1 |" in lines["outdone"]
    assert "| 0.5 | 2× a null: `unexplained` | 2 of 2 |" in table(
        [{**row, "key": f"{null}{part}"} for part in ("", "0") for row in rows if row["key"] == null]
    )
    assert "No verdict and no name changes with 1, halved or doubled: `never_noise`." in text
    assert "\nNor with `left_over` × 2.\n" in text
    assert text.endswith("with an error: 0.")
    begun = [_row("law/x*1/drawn/3", name, 0.5, "unexplained") for name in ("left_over", "outdone")]
    assert whole([*rows, *begun]) == rows  # what was not searched as frozen is compared with nothing
    assert whole([*rows, *begun, _row("law/x*1/drawn/3", *FROZEN, "unexplained")]) == rows  # nor what lacks branches
    out = tmp_path / "rows.jsonl"
    out.write_text("\n".join(json.dumps(row) for row in [rows[0], rows[0] | {"verdict": "again"}]) + '\n{"key": "cut')
    assert [row["verdict"] for row in finished(out)] == ["again"]
