"""The third rig shares nothing with package and other rigs, obeys the balance of torques, and is judged rightly."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from imported import imported

from campaign import third_rig
from campaign.second import in_turn
from campaign.third import diagnose, drawn, judged
from campaign.third_report import write_table
from campaign.third_rig import SETS, write_set
from campaign.third_rig.crane import BAR, CM3_PER_REV
from campaign.third_rig.plan import draw_plan
from campaign.third_rig.plant import residual, solve
from campaign.third_rig.sets import NULL, OUTSIDE, PAIR, SINGLE
from winch_friction.discrepancy.catalogue import all_candidates

FOREIGN = ("winch_friction", "campaign.rig", "campaign.second_rig")
FEW = {"runs": (3, 3), "seconds": (12, 15)}


def _short(key, **options):
    return replace(SETS[key], options=SETS[key].options | FEW | options)


def test_the_third_rig_imports_nothing_of_the_package_or_of_the_other_rigs():
    paths = list(Path(third_rig.__file__).parent.glob("*.py"))
    assert len(paths) > 10
    for path in paths:
        assert len(path.read_text().splitlines()) <= 300, path
        for name in imported(path):
            assert not any(f"{name}.".startswith(f"{foreign}.") for foreign in FOREIGN), (path, name)
            assert not name.startswith("campaign") or name.startswith("campaign.third_rig."), (path, name)


def _logged(path):
    header, *rows = path.read_text().splitlines()
    return dict(zip(header.split(","), np.array([row.split(",") for row in rows], float).T, strict=True))


def test_a_rigid_null_closes_the_balance_of_torques(tmp_path):
    """Without sensors to a hundredth of a bar; as logged to the noise of its pressures and of its load cell."""
    truth = write_set(tmp_path, _short("null_01", pulses=0), 5)
    plan, noise = truth.plan, truth.plan.options.pressure_noise
    for run in truth.runs:
        channels = solve(plan, run)
        moving = np.abs(run.speed) > 3
        assert np.max(np.abs(residual(plan, run, channels)[moving])) < 0.01 * BAR
        columns = _logged(tmp_path / "runs" / f"runs_{run.number:02d}_{run.mode}.csv")
        time = columns["time [s]"] - run.started
        read = columns["main.pressure_a [bar]"] - columns["main.pressure_b [bar]"]
        off = read - np.interp(time, run.time, channels["main.pressure_a"] - channels["main.pressure_b"]) / BAR
        slow = np.abs(np.interp(time, run.time, run.acceleration)) < 1
        assert np.std(off[slow]) == pytest.approx(np.sqrt(2 * (noise**2 + 0.15**2 / 12)), rel=0.1)
        assert abs(np.mean(off)) < 0.05
        displacement = columns["main.displacement [cm^3/rev]"] * CM3_PER_REV
        assert np.allclose(displacement, np.interp(time, run.time, channels["main.displacement"]), rtol=2e-3)


def test_a_wire_that_gives_leaves_its_swing_in_a_rigid_balance(tmp_path):
    rigid, soft = (write_set(tmp_path, _short("null_01", elastic=elastic), 5) for elastic in (False, True))
    left = [
        max(np.std(residual(each.plan, run, solve(each.plan, run))[np.abs(run.speed) > 3]) for run in each.runs)
        for each in (rigid, soft)
    ]
    assert left[0] < 0.01 * BAR < left[1]


def _content(folder):
    return {str(path.relative_to(folder)): path.read_text() for path in sorted(folder.rglob("*.*"))}


def test_a_draw_is_always_the_same_and_another_is_another(tmp_path):
    chosen = _short("null_09")
    for name, draw in (("first", 5), ("same", 5), ("other", 6)):
        write_set(tmp_path / name, chosen, draw)
    first, same, other = (_content(tmp_path / name) for name in ("first", "same", "other"))
    assert first == same
    assert {"crane.yaml", "model.yaml", "runs/runs_00_main.csv", "fresh/runs/fresh_00_main.csv"} <= set(first)
    assert all(first[name] != other.get(name) for name in first)


def test_every_set_can_be_specified():
    known = {each.name for each in all_candidates()}
    for chosen in SETS.values():
        plan = draw_plan(chosen.key, 5, chosen.options)
        assert plan.crane.rated > 0, chosen.key
        assert (chosen.kind == NULL) == (not chosen.effects)
        assert all(effect.law for effect in chosen.effects)
        if chosen.kind == OUTSIDE:
            assert chosen.causes == ()
        else:
            assert {effect.names[0] for effect in chosen.effects} <= known, chosen.key
    kinds = [each.kind for each in SETS.values()]
    assert [kinds.count(kind) for kind in (NULL, SINGLE, PAIR, OUTSIDE)] == [14, 46, 8, 8]
    assert {each.kind for each in in_turn(list(SETS.values()))[:12]} == {NULL, SINGLE, PAIR, OUTSIDE}


def test_a_size_gives_the_wanted_trace_and_none_is_an_error(tmp_path):
    truth = write_set(tmp_path, _short("churn_thr"), 5)
    (sized,) = truth.sized
    assert 2.9 < sized.trace < 10.4
    assert 0 < sized.beyond <= sized.trace
    unmarked = _short("poff_some", runs=(1, 1))
    unmarked = replace(unmarked, effects=(replace(unmarked.effects[0], first_size=0.0),))
    with pytest.raises(ValueError, match="no trace"):
        write_set(tmp_path / "none", unmarked, 5)
    assert diagnose(unmarked, 5)["outcome"] == "not drawn"


def _answer(verdict, *sets, proposals=()):
    effects = [{"name": each[0], "indistinguishable_from": list(each[1:])} for each in sets]
    held = {"holdout": {"before": 1.0, "after": 0.2, "noise_floor": 0.1}}
    return {"verdict": verdict, "effects": effects, "gap": held, "proposals": [{"sentence": p} for p in proposals]}


FOUND = "missing_effect"


@pytest.mark.parametrize(("key", "answer", "outcome"), [
    ("null_01", _answer("nothing_missing"), "quiet"),
    ("null_01", _answer("unexplained"), "alarm"),
    ("null_01", _answer("insufficient"), "insufficient"),
    ("churn_thr", _answer(FOUND, ["churning"]), "right"),
    ("gearload_thr", _answer(FOUND, ["sheave_bending"]), "right"),
    ("churn_thr", _answer("ambiguous", ["wear_drift", "brake_drag", "churning"]), "right"),
    ("churn_thr", _answer("ambiguous", ["wear_drift", "brake_drag", "stribeck", "churning"]), "wrong"),
    ("churn_thr", _answer(FOUND, ["churning"], ["stribeck"]), "right+extra"),
    ("churn_thr", _answer(FOUND, ["stribeck"]), "wrong"),
    ("churn_thr", _answer("unexplained", proposals=["friction"]), "unexplained"),
    ("churn_thr", _answer("nothing_missing"), "missed"),
    ("pair_2", _answer(FOUND, ["churning"], ["gear_asymmetry"]), "both"),
    ("pair_2", _answer(FOUND, ["churning"]), "one"),
    ("pair_2", _answer(FOUND, ["churning"], ["stribeck"]), "one+extra"),
    ("pair_2", _answer(FOUND, ["stribeck"]), "wrong"),
    ("pair_2", _answer("nothing_missing"), "missed"),
    ("x_hump", _answer(FOUND, ["notch_loss"]), "named"),
    ("x_hump", _answer("unexplained", proposals=["friction"]), "proposal"),
    ("x_hump", _answer("unexplained"), "unexplained"),
    ("x_hump", _answer("nothing_missing"), "missed"),
])  # fmt: skip
def test_outcomes(key, answer, outcome):
    assert judged(SETS[key], answer)["outcome"] == outcome


def test_a_wrong_single_name_is_told_beside_a_right_one():
    assert judged(SETS["churn_thr"], _answer(FOUND, ["churning"], ["stribeck"]))["wrong_single"]
    assert not judged(SETS["churn_thr"], _answer(FOUND, ["churning"], ["stribeck", "coulomb"]))["wrong_single"]


def test_the_table_tells_every_set(tmp_path):
    chosen = SETS["null_01"]
    told = drawn(write_set(tmp_path, _short("null_01"), 5)) | judged(chosen, _answer("nothing_missing"))
    null = {"set": "null_01", "kind": NULL, "seconds": 3.0} | told
    broken = {"set": "x_hump", "kind": OUTSIDE, "outcome": "refused", "error": "exit 2: a | b"} | {"rate": 50}
    none = {"set": "poff_some", "kind": SINGLE, "outcome": "not drawn", "error": "poff_some: no trace"}
    write_table(tmp_path / "table.md", [broken, none, null], 5)
    text = (tmp_path / "table.md").read_text()
    assert "| nulls: `nothing_missing` | 1 of 1 |" in text
    assert "| not drawn: the effect leaves no trace | 1 of 3 |" in text
    assert "| `null_01` | nothing | – | 50 | nothing_missing | quiet | 1.00 → 0.20 | 0.10 | – | 3 |" in text
    assert "exit 2: a / b | refused" in text
