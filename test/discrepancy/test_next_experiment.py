"""The proposed experiment does what it promises: run it, and the rivals part."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy import next_experiment
from winch_friction.discrepancy.adequacy import Check
from winch_friction.discrepancy.engine.blocks import Blocks, Slot, grams
from winch_friction.discrepancy.engine.crossfit import CrossFit
from winch_friction.discrepancy.engine.problem import Base, Layout, Problem
from winch_friction.discrepancy.next_experiment import (
    NextExperiment,
    insufficient,
    of_own_terms,
    of_wire,
    plan_experiment,
)
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.discrepancy.workflow import find_gap
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import Run
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model
from winch_friction.records.strict_yaml import shipped
from winch_friction.simulation import load_scenario, simulate

HIDDEN = [("pressure_offset", 1.0)]
MOST = 3  # experiments


def recorded(scenario: str, seed: int) -> Run:
    """A run of the simulated crane with the effect hidden in it."""
    crane, model = load_crane("crane_150t"), load_model("a6vm215_crane2")
    run = simulate(load_scenario(scenario), crane, model, seed=seed, hidden=HIDDEN).run
    return Run(f"{scenario}_{seed}", run.columns)


@pytest.mark.long
def test_running_the_proposed_scenarios_resolves_the_ambiguity():
    """Each experiment parts the two that it was proposed for, or, where more names than a set holds do as well, leaves
    fewer; and a few of them leave the one that is there."""
    crane, model = load_crane("crane_150t"), load_model("a6vm215_crane2")
    runs = [recorded("test_02", seed) for seed in range(6)]  # one load, one displacement
    result, asked = find_gap(runs, crane, model), []
    for k in range(MOST):
        if result.verdict not in ("ambiguous", "insufficient"):
            break
        plan = result.content()["next_experiment"]
        asked.append(plan["scenario"].removesuffix(".yaml"))
        parted = set(plan["separates"])
        if result.verdict == "ambiguous":
            assert plan["expected_z"] > 3.0
            assert parted <= {result.effects[0].name, *result.effects[0].rivals}
        else:
            assert "more effects apart" in result.refused
        runs += [recorded(asked[-1], 50 + 10 * k + j) for j in range(3)]
        result = find_gap(runs, crane, model)
        assert result.verdict != "insufficient"
        assert not parted or not parted <= {result.effects[0].name, *result.effects[0].rivals}
    assert asked, "six runs at one load and one displacement tell nothing apart"
    assert result.verdict == "missing_effect"
    assert [effect.name for effect in result.effects] == ["pressure_offset"]


@pytest.mark.long
def test_a_single_run_without_an_effect_is_no_discovery():
    """Both halves of one voyage are told the same of its wire, so a refit to the first does not go astray: it moves no
    parameter by half of its deviation, and the other half is none the worse."""
    crane, model = load_crane("crane_150t"), load_model("a6vm215_crane2")
    for seed in (0, 1):
        run = simulate(load_scenario("ahc_55t_215"), crane, model, seed=seed).run
        result = find_gap([Run("voyage", run.columns)], crane, model)
        assert result.verdict == "nothing_missing"
        assert not result.effects
        moved = np.abs(np.subtract(result.model.values, model.values)) / np.array(model.std)
        assert moved.max() < 0.5
        assert result.holdout.size_after.value <= 1.01 * result.holdout.size_before.value


# -- the plan by itself: runs in which all causes are one trace, and scenarios by what each cause does in them
RUNS, BLOCKS, SIZE = 6, 40, 2.0  # of the effect, in its own units; the noise is 1
TRACE = np.tile(np.sin(np.linspace(0.0, 20.0, BLOCKS)), RUNS)
OLD = float(TRACE @ TRACE)


def slots_of(*laws):
    return tuple(Slot(name, "", (k,), law=law) for k, (name, law) in enumerate(laws, start=1))


def tied(slots):
    """Runs in which every one of these has the same trace, and one base parameter that has none."""
    zero, run = np.zeros(RUNS * BLOCKS), np.repeat(np.arange(RUNS), BLOCKS)
    x, position = np.column_stack([zero, *(TRACE for _ in slots)]), np.tile(np.arange(BLOCKS), RUNS)
    blocks = Blocks(SIZE * TRACE, x, run, 2 * run + (position >= BLOCKS // 2), zero + 1.0, {}, zero + 1.0, position)
    bound = np.full(len(slots) + 1, 100.0)
    base = Base(("b",), 1, bound[:1], 0.0 * bound[:1], -bound[:1], bound[:1])
    problem = Problem(
        Layout(base, slots, 0.0 * bound + 1.0, -bound, bound), blocks, grams(blocks), dict.fromkeys(range(RUNS), 1.0)
    )
    return CrossFit(problem)


def planned(monkeypatch, slots, scenarios, own=0, rivals=(1,)):
    """The plan where each scenario has these traces of the slots, one column each, and no other can be run."""

    def simulated(name, *_):
        if name not in scenarios:
            raise InputError("not of this crane")
        return np.pad(np.array(scenarios[name], float).T @ np.array(scenarios[name], float), ((1, 0), (1, 0)))

    monkeypatch.setattr(next_experiment, "_simulated", simulated)
    cross = tied(slots)
    chosen = [slots[k] for k in rivals]
    return plan_experiment(None, SimpleNamespace(), cross, cross.explain((slots[own],)), slots[own], chosen, 0)


ZERO, HOLD = "experiment_zero_check", "experiment_hold_times"


def test_the_separation_is_what_the_rival_misses_of_old_and_new_runs_in_thinned_deviations(monkeypatch):
    """Where the two are at right angles the rival keeps to the old runs and misses the new ones twice over."""
    new = 50.0
    plan = planned(monkeypatch, slots_of(("one", ""), ("two", "")), {ZERO: np.sqrt(new) * np.eye(2)})
    missed = SIZE**2 * (new + OLD * new / (OLD + new))
    assert plan.expected_z == pytest.approx(np.sqrt(missed / 10.0), rel=1e-3)
    assert plan.separates == ("one", "two")
    assert plan.content()["note"] == ""


@pytest.mark.parametrize("cause", ["one", "two"])
def test_a_cause_that_has_a_law_like_the_other_is_not_told_from_it(monkeypatch, cause):
    """Whichever of the two is there, and although the law that was found is another one."""
    slots = slots_of(("one", ""), ("two", ""), (cause, "bent"))
    like = [1.0, 0.0] if cause == "two" else [0.0, 1.0]
    plan = planned(monkeypatch, slots, {ZERO: 9.0 * np.array([[1.0, 0.0, like[0]], [0.0, 1.0, like[1]]])})
    assert plan.expected_z < 0.1
    assert "tied in every scenario" in plan.content()["note"]


def test_what_is_missed_by_less_than_a_rival_may_be_worse_separates_nothing(monkeypatch):
    """A hundredth of what the effect explains, however sure it is in a long run."""
    slots = slots_of(("one", ""), ("two", ""))
    plan = planned(monkeypatch, slots, {ZERO: 300.0 * np.array([[1.0, 1.0], [0.0, 0.1]])})
    assert plan.expected_z == pytest.approx(1.0, rel=0.05)  # 3 deviations by a third of 3 %


@pytest.mark.parametrize(
    ("scenarios", "chosen"),
    [
        # both rivals parted by a little, or one of them by far
        ({ZERO: 30.0 * np.array([[1, 0, 1], [0, 1, 0]]), HOLD: 9.0 * np.eye(3)}, HOLD),
        # one of them either way: by far, though the other not at all, or by less
        ({ZERO: 30.0 * np.array([[1, 0, 1], [0, 1, 0]]), HOLD: 9.0 * np.array([[1, 0, 1], [0, 1, 0.1]])}, ZERO),
    ],
)
def test_most_rivals_first_and_of_those_the_nearest_farthest_away(monkeypatch, scenarios, chosen):
    plan = planned(monkeypatch, slots_of(("one", ""), ("two", ""), ("three", "")), scenarios, rivals=(1, 2))
    assert plan.name == chosen
    assert plan.separates[1] in (("two", "three") if chosen == HOLD else ("two",))
    assert set(plan.alternatives) == {ZERO, HOLD}
    assert list(plan.alternatives.values()) == sorted(plan.alternatives.values(), reverse=True)


def test_where_none_can_be_run_nothing_is_planned(monkeypatch):
    assert planned(monkeypatch, slots_of(("one", ""), ("two", "")), {}) is None


# -- what is said and written of it
def test_a_plans_entry_has_its_file_the_two_in_their_order_and_what_was_considered():
    told = NextExperiment(ZERO, "text", ("found", "rival"), LIMITS.enough_separation, {ZERO: 3.04, HOLD: 0.12})
    assert told.content() == {
        "scenario": f"{ZERO}.yaml", "separates": ["found", "rival"], "expected_z": LIMITS.enough_separation, "note": "",
        "considered": {ZERO: 3.04, HOLD: 0.12},
    }  # fmt: skip
    tied_ = replace(told, expected_z=LIMITS.enough_separation - 0.01).content()
    assert tied_["note"] == "tied in every scenario of the family: another channel must decide"


def test_what_was_considered_is_said_to_two_digits_behind_the_point(monkeypatch):
    plan = planned(monkeypatch, slots_of(("one", ""), ("two", "")), {ZERO: np.sqrt(50.0) * np.eye(2)})
    assert plan.alternatives == {ZERO: round(plan.expected_z, 2)}
    assert plan.alternatives[ZERO] != round(plan.expected_z)
    assert plan.file == f"{ZERO}.yaml"
    assert plan.text == shipped("scenarios", ZERO).read_text(encoding="utf-8")


def test_some_runs_that_do_not_say_their_wire_are_named():
    runs = [SimpleNamespace(name=name, channels={"wire_out": 0} if name == "b" else {}) for name in "abc"]
    (note,) = of_wire(SimpleNamespace(crane=SimpleNamespace(wire_stiffness=1e8), prepared=runs))
    assert note.startswith("a, c do not say wire_out, so that")


@pytest.mark.parametrize(
    ("after", "said"),
    [
        ((-4.0, 2.0), "too much of it: a -5 becomes -4, b 2 becomes 2"),
        ((-6.0, 2.0), "something else of it: a -5 becomes -6"),
    ],
)
def test_a_term_that_the_model_has_says_too_much_where_its_sizes_fall_whatever_their_sign(after, said):
    """A shape of it is no size."""
    parameters = [SimpleNamespace(name=name, shape=name == "shape") for name in ("a", "b", "shape")]
    terms = [SimpleNamespace(name="own", parameters=parameters), SimpleNamespace(name="other", parameters=parameters)]
    given = SimpleNamespace(terms=terms, as_dict=lambda: {"a": -5.0, "b": 2.0, "shape": 1.0})
    written = SimpleNamespace(as_dict=lambda: {"a": after[0], "b": after[1], "shape": 9.0})
    (note,) = of_own_terms({"own"}, given, written)
    assert note.startswith(f"own: the given model has this term already and says {said}")
    assert "shape" not in note
    lost = SimpleNamespace(as_dict=lambda: {"a": 1.0, "shape": 1.0})
    assert of_own_terms({"own"}, given, lost) == []


def test_runs_that_were_looked_at_show_both_sides_as_given(monkeypatch, crane_150t, crane2_model):
    asked = []
    sides = {("t",): next_experiment.nothing_compared(), ("h",): next_experiment.nothing_compared()}
    monkeypatch.setattr(
        next_experiment, "compare", lambda before, after, names, _: asked.append((before, after)) or sides[names]
    )
    split = SimpleNamespace(train=("t",), holdout=("h",))
    checks = [Check("hoisting", 1.0, 3.0, "s", False)]
    found = insufficient(checks, (), crane_150t, crane2_model, ("given", split))
    assert (found.train is sides["t",], found.holdout is sides["h",]) == (True, True)
    assert asked == [("given", "given")] * 2
    electric = SimpleNamespace(drive=SimpleNamespace(hydraulic=False, unit="N*m"), name="electric")
    other = insufficient(checks, (), electric, crane2_model)
    assert (other.next_experiment, other.next_scenario, other.unit) == (None, "", "N*m")
