"""What some runs have and others have not: the cause is named, the file says when, and nothing is made of chance."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from gap_rig import names_of, runs_with

from campaign.gap import diagnose
from campaign.gap_cases import Case
from campaign.rig import DRAWN
from winch_friction.discrepancy import catalogue
from winch_friction.discrepancy.answer import GapOptions
from winch_friction.discrepancy.candidates.candidate import Candidate, Shape
from winch_friction.discrepancy.candidates.families import literature
from winch_friction.discrepancy.candidates.friction import shipped_friction
from winch_friction.discrepancy.engine.blocks import Blocks, Slot, grams
from winch_friction.discrepancy.engine.problem import Base, Layout, Problem
from winch_friction.discrepancy.logged_causes import _left_by, _medians, _spread, follows_a_signal, told_by_a_signal
from winch_friction.discrepancy.run_states import (
    EACH_RUN,
    SINCE,
    SOME_RUNS,
    THEN,
    State,
    _drag,
    _state,
    _then,
    _within,
    in_each_run,
    in_some_runs,
    levels_of,
    two_levels,
)
from winch_friction.discrepancy.workflow import find_gap
from winch_friction.physics.channels import BAR
from winch_friction.physics.friction.correction import Correction
from winch_friction.physics.friction.term import Parameter
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model, save_model

SEED = 4407
FULL = 12
LAYERS = np.array([1, 2, 4, 2, 3, 1, 4, 3, 2, 1, 3, 4], float)  # of the drum, in no rhythm that hours have as well


def gap(runs, model=None):
    crane = load_crane("crane_150t")
    return find_gap(runs, crane, model or load_model("a6vm215_crane2"), GapOptions(plan=False, proposals=False))


def with_offset(runs, there):
    """The runs with 2.5 bar too much at port A of every group where it is there."""
    found = []
    for run, on in zip(runs, there, strict=True):
        own = {n: run[n] + 2.5 * BAR * on for n in run.columns if n.endswith("pressure_a")}
        found.append(replace(run, columns={**run.columns, **own}))
    return found


@pytest.mark.long
@pytest.mark.parametrize("pattern", ["since a date", "in some runs"])
def test_a_zero_that_is_off_in_some_runs_is_named_and_the_file_says_when(pattern, tmp_path):
    runs = runs_with(SEED, "quiet")
    order = np.argsort([run.time[0] for run in runs])
    place = np.argsort(order)
    there = place >= 7 if pattern == "since a date" else np.isin(place, [1, 4, 5, 9, 10])
    result = gap(with_offset(runs, there))
    assert len(result.effects) == 1
    assert "pressure_offset" in names_of(result)[0]
    model = load_model(save_model(result.model, tmp_path / "model.yaml"))
    offset = next(each for each in model.corrections if each.name == "pressure_offset")
    assert offset.value == pytest.approx(2.5 * BAR, rel=0.1)
    assert [offset.holds(float(run.time[0])) for run in runs] == list(there)
    assert offset.holds(max(run.time[-1] for run in runs) + 1e7) == (pattern == "since a date")
    again = gap(with_offset(runs, there), model)
    assert again.verdict == "nothing_missing"


@pytest.mark.long
def test_a_brake_that_hangs_in_some_runs_is_named():
    """The rig's own, on a crane that it draws: which runs the brake hangs in is drawn there as well."""
    said = diagnose(Case("law", (("brake_drag:some_runs", 1.0),), DRAWN, SEED, (0.0, 1.5)))
    assert said["right"]
    assert said["detected"]
    assert not said["wrong_single"]


@pytest.mark.long
@pytest.mark.parametrize("seed", [31_000_998, 31_000_999])
def test_a_brake_that_drags_by_another_amount_in_every_run_is_named_where_nothing_else_explains(seed):
    """The amounts of the locked runs are those that their first halves tell; the file closes their second as well."""
    said = diagnose(Case("held_out", (("brake_drag:differs_by_run", 1.0),), DRAWN, seed, (0.0, 1.5)))
    (effect,) = said["answer"]["effects"]
    assert (effect["name"], effect["law"]) == ("brake_drag", EACH_RUN)
    held = said["answer"]["gap"]["holdout"]
    assert held["after"] < 1.2 * held["noise_floor"] < 0.2 * held["before"]


@pytest.mark.long
def test_an_offset_since_a_date_is_named_though_a_run_before_it_is_hardly_known():
    """Nine runs are above the others by 25 deviations and more; the three before are less well known than most."""
    said = diagnose(Case("law", (("pressure_offset:since_a_date", 1.0),), DRAWN, 75_000_233, (0.0, 1.5)))
    (effect,) = said["answer"]["effects"]
    assert (effect["name"], effect["law"]) == ("pressure_offset", SINCE)
    held = said["answer"]["gap"]["holdout"]
    assert held["after"] < 1.2 * held["noise_floor"] < 0.2 * held["before"]


# -- levels
def test_two_clear_levels_are_told_and_one_is_not():
    rng = np.random.default_rng(0)
    small, sure = np.full(FULL, 0.1), np.full(FULL, 1e-9)
    levels = np.where(np.arange(FULL) % 3 == 0, 6.0, 0.0) + 0.1 * rng.standard_normal(FULL)
    assert list(two_levels(levels, small)) == [k % 3 == 0 for k in range(FULL)]
    assert list(two_levels(-levels, small)) == [k % 3 == 0 for k in range(FULL)]
    draws = [np.random.default_rng(seed) for seed in range(500)]
    for spread in ("standard_normal", "random", "exponential"):
        seeming = [two_levels(getattr(each, spread)(size=FULL), sure) is not None for each in draws]
        assert np.mean(seeming) < 0.01, spread
    assert two_levels(levels, np.full(FULL, 2.0)) is None  # nobody knows them well enough
    assert two_levels(levels, np.full(FULL, 1.2)) is not None  # runs that agree are known better than they state
    alone = np.where(np.arange(FULL) == 3, 6.0, 0.0)
    assert two_levels(alone, small) is None  # one run is no state


@pytest.mark.parametrize(("apart", "told"), [(1.6, True), (0.3, False)])
def test_of_levels_that_are_apart_by_far_the_least_known_run_is_known_well_enough(apart, told):
    """Three runs before a date are known by a half to a seventh as well as is usual, and by 25 of their deviations."""
    rng, there = np.random.default_rng(4), np.arange(FULL) > 2
    deviations = np.where(there, 0.022, np.array([0.036, 0.031, 0.066, *[1.0] * (FULL - 3)]))
    levels = apart * there + 0.3 * deviations * rng.standard_normal(FULL)
    found = two_levels(levels, deviations)
    assert (found is not None) is told
    assert not told or list(found) == list(there)


def test_levels_by_chance_are_no_two_however_unequally_they_are_known():
    seeming = []
    for seed in range(500):
        rng = np.random.default_rng(seed)
        deviations = np.exp(rng.standard_normal(FULL))
        seeming.append(two_levels(deviations * rng.standard_normal(FULL), deviations, rng.random(FULL)) is not None)
    assert np.mean(seeming) < 0.01


def test_two_levels_may_follow_the_load_alike_but_a_law_of_the_load_is_no_level():
    """What the base model has wrong of the load's friction moves the levels of all runs."""
    rng = np.random.default_rng(0)
    load, small = rng.uniform(10e3, 150e3, FULL), np.full(FULL, 0.1)
    there = np.arange(FULL) % 3 == 0
    levels = 2.0 * there - 9e-6 * load + 0.05 * rng.standard_normal(FULL)
    assert two_levels(levels, small) is None
    assert list(two_levels(levels, small, load)) == list(there)
    assert two_levels(2e-5 * load + 0.05 * rng.standard_normal(FULL), small, load) is None
    draws = [np.random.default_rng(seed) for seed in range(500)]
    for spread in ("standard_normal", "random"):
        seeming = [two_levels(getattr(d, spread)(size=FULL), 1e-8 * small, load) is not None for d in draws]
        assert np.mean(seeming) < 0.01, spread


def test_levels_that_rounding_alone_has_made_are_none():
    """A search ended with "Weights sum to zero": in most runs there was nothing of a candidate, to the last digit."""
    rng = np.random.default_rng(0)
    levels, deviations = 1e-15 * rng.standard_normal(FULL), 1e-14 * (np.arange(FULL) % 3 == 0)
    assert two_levels(levels, deviations) is None
    assert two_levels(levels + (np.arange(FULL) < 4), deviations) is None


def test_a_run_of_which_little_is_known_hides_no_two_levels():
    """A light load says little of a displacement: between the levels of the others its own is no third one."""
    rng = np.random.default_rng(0)
    there = np.arange(FULL) % 3 == 0
    levels, deviations = 3.0 * there + 0.05 * rng.standard_normal(FULL), np.full(FULL, 0.1)
    levels[1] = 1.4  # half way
    assert two_levels(levels, deviations) is None
    deviations[1] = 0.5
    found = two_levels(levels, deviations)
    assert [bool(own) for k, own in enumerate(found) if k != 1] == [bool(own) for k, own in enumerate(there) if k != 1]
    few = np.where(np.arange(FULL) < 2, 3.0, 0.0) + 0.05 * rng.standard_normal(FULL)
    assert two_levels(few, np.full(FULL, 0.1)) is not None
    assert two_levels(few, np.where(np.arange(FULL) < 2, 0.5, 0.1)) is None  # both of that level hardly known
    draws = [np.random.default_rng(seed) for seed in range(500)]
    for spread in ("standard_normal", "random", "exponential"):
        seeming = [
            two_levels(getattr(each, spread)(size=FULL), 0.1 * np.exp(each.standard_normal(FULL))) is not None
            for each in draws
        ]
        assert np.mean(seeming) < 0.01, spread


def test_what_a_logged_signal_tells_is_no_state():
    def run(load, kind=("main",), swash=2e-5, layer=0):
        channels = {"hook_load": np.full(5, load), "time": np.arange(5.0)}
        channels |= {"wire_layer": np.full(5, layer)} if layer else {}
        group = SimpleNamespace(balances=True, displacement=np.full(5, swash), pressure=np.zeros(5))
        return SimpleNamespace(channels=channels, used=np.ones(5, bool), kind=kind, groups=[group])

    there = np.array([True, True, False, False, False])
    assert told_by_a_signal([run(60e3), run(55e3), run(20e3), run(25e3), run(30e3)], there)
    assert not told_by_a_signal([run(60e3), run(20e3), run(20e3), run(25e3), run(70e3)], there)
    two, one = ("active", "passive"), ("main",)
    # the drive's group has another name in heave compensation: its displacement tells all the same
    full = [run(load, mode, swash) for load, mode, swash in zip(
        (60e3, 20e3, 20e3, 25e3, 70e3), (two, one, one, two, one), (3e-5, 3.2e-5, 2e-5, 2.1e-5, 2e-5), strict=True
    )]  # fmt: skip
    assert told_by_a_signal(full, there)
    layers = [
        run(load, layer=layer) for load, layer in zip((60e3, 20e3, 20e3, 25e3, 70e3), (3, 3, 2, 4, 2), strict=True)
    ]
    assert told_by_a_signal(layers, there)  # all runs on layer 3, which is neither the lowest nor the highest
    layers[3].channels["wire_layer"][:] = 3
    assert not told_by_a_signal(layers, there)
    for each, layer in zip(layers, (2, 4, 3, 1, 3), strict=True):
        each.channels["wire_layer"][:] = layer
    assert not told_by_a_signal(layers, there)  # each on a layer of its own: by chance
    three = np.array([True, True, True, False, False])
    for each, layer in zip(layers, (2, 4, 2, 3, 1), strict=True):
        each.channels["wire_layer"][:] = layer
    assert told_by_a_signal(layers, three)
    same = [run(60e3, two), run(20e3, two), run(20e3, one), run(25e3, one), run(70e3, one)]
    assert told_by_a_signal(same, there)


def test_levels_that_a_logged_signal_or_the_date_says_are_no_amounts_of_a_brake():
    def run(k, load, kind=("main",)):
        group = SimpleNamespace(balances=True, displacement=np.full(5, 2e-5), pressure=np.zeros(5))
        channels = {"hook_load": np.full(5, load), "time": np.arange(5.0)}
        channels["wire_layer"] = np.full(5, LAYERS[k])
        channels["oil_temperature"] = np.full(5, 20.0 + 7.0 * (k * 5 % 12))
        return SimpleNamespace(
            channels=channels, used=np.ones(5, bool), kind=kind, groups=[group], start=1e9 + 41_000.0 * k,
            load=channels["hook_load"],
        )  # fmt: skip

    seeming = []
    for seed in range(80):
        rng = np.random.default_rng(seed)
        load, modes = rng.uniform(1e4, 1.5e5, FULL), [("main",)] * 8 + [("active", "passive")] * 4
        runs = [run(k, *each) for k, each in enumerate(zip(load, modes, strict=True))]
        drawn = rng.uniform(0.0, 6.0, FULL)
        seeming.append(follows_a_signal(runs, drawn))
        noise = 0.3 * rng.standard_normal(FULL)
        heavier, bent = 4e-5 * load + noise, 6.0 * ((load - 8e4) / 7e4) ** 2 + noise
        later = 0.5 * np.arange(FULL) + noise
        of_mode, step = np.where(np.arange(FULL) < 8, 0.0, 6.0), 3.0 * (load > np.sort(load)[4]) + noise
        assert all(follows_a_signal(runs, levels) for levels in (heavier, bent, later, heavier + of_mode, step)), seed
        oil = np.array([each.channels["oil_temperature"][0] for each in runs])
        warm = 1e-6 * load * (oil - 40.0) + noise  # the product of two
        of_layer = 4.0 * np.isin(LAYERS, (2.0, 4.0)) + noise  # on two layers that are no neighbours
        by_night = 3.0 * np.sin(2.0 * np.pi * np.array([each.start for each in runs]) / 86400.0) + noise
        assert all(follows_a_signal(runs, levels) for levels in (warm, of_layer, by_night)), seed
    assert np.mean(seeming) < 0.1
    few = [run(k, load) for k, load in enumerate((1e4, 5e4, 7e4, 9e4, 1.2e5))]
    assert follows_a_signal(few, np.array([1.0, 5.0, 2.0, 4.0, 3.0]))  # five runs never tell that it does not


def test_of_a_whole_run_all_samples_say_its_level():
    rng = np.random.default_rng(5)
    count, runs = 200, 4
    run, position = np.repeat(np.arange(runs), count), np.tile(np.arange(count), runs)
    wave = np.sign(np.sin(position / 7.0))
    base = Base(("K",), 1, np.ones(1), np.zeros(1), -np.ones(1), np.ones(1))
    slot = Slot("brake", "", (1,))
    y = 3.0 * wave * (position > count // 2) + rng.standard_normal(len(run))
    blocks = Blocks(
        y, np.column_stack([0.0 * wave, wave]), run, run, np.ones(len(run)), {}, np.sign(wave), position
    )  # fmt: skip
    problem = Problem(Layout(base, (slot,), np.ones(2), -np.ones(2), np.ones(2)), blocks, grams(blocks), {})
    levels, _ = levels_of(problem, slot, runs, [True, True, False, False])
    assert levels == pytest.approx([1.5, 1.5, 0.0, 0.0], abs=0.4)


def test_what_the_base_makes_as_well_is_known_by_how_sure_the_base_is():
    """A parameter that acts in one run alone as the candidate does: nobody tells its level there from it."""
    count, runs = 100, 4
    run, position = np.repeat(np.arange(runs), count), np.tile(np.arange(count), runs)
    wave = np.sign(np.sin(position / 7.0))
    base = Base(("K",), 1, np.ones(1), np.zeros(1), -np.ones(1), np.ones(1))
    slot = Slot("brake", "", (1,))
    x = np.column_stack([wave * (run == 0), wave])
    noise, found = np.random.default_rng(5).standard_normal(len(run)), []
    for size in (2.0, 6.0):  # of what is left
        blocks = Blocks(size * noise, x, run, run, np.ones(len(run)), {}, np.sign(wave), position)
        problem = Problem(Layout(base, (slot,), np.ones(2), -np.ones(2), np.ones(2)), blocks, grams(blocks), {})
        found.append(levels_of(problem, slot, runs)[1])
    assert found[0][0] > 1.5 * found[0][1:].max()
    assert found[1] == pytest.approx(3.0 * found[0], rel=0.02)


def test_the_second_half_of_a_run_has_no_say_in_its_state():
    """What begins in the middle of a run is no state of it: the first half says that it is not there."""
    rng = np.random.default_rng(5)
    count, runs = 200, 8
    run = np.repeat(np.arange(runs), count)
    position = np.tile(np.arange(count), runs)
    wave = np.sign(np.sin(position / 7.0))
    base = Base(("K",), 1, np.ones(1), np.zeros(1), -np.ones(1), np.ones(1))
    slot = Slot("brake", "", (1,))
    late = (run >= 5) & (position > count // 2)
    for there, told in ((run >= 5, True), (late, False)):
        y = 3.0 * wave * there + rng.standard_normal(len(run))
        x = np.column_stack([0.0 * wave, wave])
        blocks = Blocks(y, x, run, run, np.ones(len(run)), {}, np.sign(wave), position)
        problem = Problem(Layout(base, (slot,), np.ones(2), -np.ones(2), np.ones(2)), blocks, grams(blocks), {})
        levels, deviations = levels_of(problem, slot, runs)
        assert np.all(np.abs(levels - 3.0 * told * (np.arange(runs) >= 5)) < 5.0 * deviations)
        assert np.all(deviations < 0.6)


# -- windows
INF = float("inf")


def dated(*spans):
    """Runs that begin and last so, in s; the clock of each begins with it."""
    return [SimpleNamespace(start=begin, time=np.array([0.0, lasts]), name=f"r{begin:g}") for begin, lasts in spans]


@pytest.mark.parametrize(
    ("there", "windows", "law"),
    [
        ("..##", ((115.0, INF),), SINCE),  # half way between the end of the one and the beginning of the next
        ("##..", ((-1.0, 31.0),), SOME_RUNS),  # what ends is no date from which on it is there
        (".#..", ((19.0, 31.0),), SOME_RUNS),
        (".#.#", ((19.0, 31.0), (299.25, 311.0)), SOME_RUNS),
        ("..#.", ((199.0, 299.25),), SOME_RUNS),  # no further than half way to the next run
        ("#..#", ((-1.0, 11.0), (299.25, 311.0)), SOME_RUNS),
    ],
)
def test_a_state_is_there_in_the_windows_of_its_runs_and_no_others(there, windows, law):
    """In the order of their dates, whatever the order that they are given in."""
    spans = [(0.0, 10.0), (20.0, 10.0), (200.0, 99.0), (299.5, 10.5)]
    shuffled = [2, 0, 3, 1]
    runs, own = dated(*(spans[k] for k in shuffled)), np.array([there[k] == "#" for k in shuffled])
    state = _state(runs, np.where(own, 5.0, 0.0), own)
    assert (state.law, state.count, state.runs, state.both) == (law, there.count("#"), 4, False)
    assert [pytest.approx(each) for each in windows] == list(state.windows)
    for run, inside in zip(runs, own, strict=True):
        assert any(begin <= run.start <= end for begin, end in state.windows) is bool(inside)


@pytest.mark.parametrize(
    ("other", "level", "both"),
    [(0.9, 6.0, False), (1.1, 6.0, True), (-1.1, 5.0, False), (-1.3, 5.0, True), (1.1, -6.0, False), (6.0, 0.0, True)],
)
def test_what_the_other_runs_have_counts_beside_what_lies_between_the_levels(other, level, both):
    """A fifth of the step between the two, whichever way; a run of which nothing is known has no say."""
    there = np.array([False, False, True, True, False])
    levels = np.where(there, level, other)
    levels[4] = np.nan
    state = _state(dated(*((100.0 * k, 10.0) for k in range(5))), levels, there)
    assert state.both is both
    assert state.label == "in some runs, 2 of 5" + ", and another size else" * both


@pytest.mark.parametrize(("start", "inside"), [(9.0, 0.0), (10.0, 1.0), (20.0, 1.0), (21.0, 0.0), (35.0, 1.0)])
@pytest.mark.parametrize("both", [False, True])
def test_a_states_column_is_its_causes_within_its_windows(start, inside, both):
    candidate = Candidate("zero", columns=lambda run, values: np.full((3, 1), values["x"]))
    state = State(((10.0, 20.0), (30.0, 40.0)), 2, 4, both)
    found = _within(candidate, state, SimpleNamespace(start=start), {"x": 7.0})
    assert found.tolist() == [[7.0] * both + [7.0 * inside]] * 3


@pytest.mark.parametrize("both", [False, True])
def test_a_states_corrections_hold_during_its_windows_and_what_all_runs_have_always(both):
    def corrects(found, *_):
        return [Correction("pressure_offset", found["x"])]

    windows = ((10.0, 20.0),)
    found = {"x": 2.0e5, "x" + THEN: 3.0e5} if both else {"x": 3.0e5}
    made = _then(Candidate("zero", corrects=corrects), State(windows, 1, 2, both), found, None, None)
    always = [(2.0e5, ())] * both
    assert [(each.value, tuple(each.during)) for each in made] == [*always, (3.0e5, windows)]


def a_slot(name):
    shape = Shape("all groups", {"port_a": 1.0})
    linear = (Parameter("x", "Pa", 1.0, doc="a zero"),)
    own = Candidate(name, linear=linear, corrects=lambda *_: [], continuous=("late",), shapes=lambda _: [shape])
    return Slot(name, "", (1,), origin=(own, shape))


@pytest.mark.parametrize(("other", "names"), [(0.0, ["x"]), (3.0, ["x", "x" + THEN])])
def test_a_zero_in_some_runs_is_a_law_of_its_cause_with_an_amount_for_the_others_where_they_have_some(
    monkeypatch, other, names
):
    monkeypatch.setattr("winch_friction.discrepancy.run_states.told_by_a_signal", lambda *_: False)
    there = np.array([False, True, False])
    runs = dated((0.0, 10.0), (100.0, 10.0), (200.0, 10.0))
    (found,) = in_some_runs(a_slot("zero"), runs, np.where(there, 8.0, other), there)
    assert (found.name, found.law_name, found.continuous) == ("zero", SOME_RUNS, ())
    assert [each.name for each in found.linear] == names
    (shape,) = found.shapes(runs)
    assert shape.label.startswith("all groups, in some runs, 1 of 3")
    assert shape.values == {"port_a": 1.0}


@pytest.mark.parametrize(("there", "laws"), [([False, True, False], [SOME_RUNS]), ([False, True, True], [])])
def test_a_brake_that_drags_since_a_date_has_a_law_of_its_own(monkeypatch, there, laws):
    monkeypatch.setattr("winch_friction.discrepancy.run_states.told_by_a_signal", lambda *_: False)
    there = np.array(there)
    runs = dated((0.0, 10.0), (100.0, 10.0), (200.0, 10.0))
    found = in_some_runs(a_slot("brake_drag"), runs, np.where(there, 8.0, 0.0), there)
    assert [each.law_name for each in found] == laws


def test_what_a_signal_tells_is_no_candidate(monkeypatch):
    monkeypatch.setattr("winch_friction.discrepancy.run_states.told_by_a_signal", lambda *_: True)
    there = np.array([False, True, False])
    runs = dated((0.0, 10.0), (100.0, 10.0), (200.0, 10.0))
    assert in_some_runs(a_slot("zero"), runs, 8.0 * there, there) == []


def test_a_drag_of_each_run_has_its_windows_by_date_and_its_amounts_as_shares_of_the_largest(monkeypatch):
    """A brake drives nothing: what seems to is what the base has too much of, in every run alike."""
    made = []
    monkeypatch.setattr("winch_friction.discrepancy.run_states._drag", lambda *each: made.append(each) or each)
    runs = dated((200.0, 10.0), (0.0, 10.0), (100.0, 10.0))
    windows = ((-1.0, 11.0), (99.0, 111.0), (199.0, 211.0))
    for levels, weights in (([1.0, 3.0, -2.0], (1.0, 0.0, 0.6)), ([1.0, 3.0, 2.0], (1.0, 0.6667, 0.3333))):
        made.clear()
        in_each_run(runs, np.array(levels))
        assert made == [(cause, windows, EACH_RUN, weights) for cause in ("brake_drag", "wear_drift")]


@pytest.mark.parametrize("pause", [1e-3, 0.4, 1.0, 2.0, 5.0])
def test_runs_of_one_recording_that_follow_closely_have_a_drag_each(pause):
    """Windows of neighbours met in the middle of the pause: a search ended with "the knots must be rising"."""
    starts = [1.7e9 + k * (10.0 + pause) for k in range(6)]
    runs = dated(*((start, 10.0) for start in starts))
    found = in_each_run(runs, np.arange(1.0, 7.0))
    assert [each.name for each in found] == ["brake_drag", "wear_drift"]


@pytest.mark.parametrize("starts", [(0.0, 0.0, 0.0, 0.0), (0.0, 5.0, 100.0, 200.0), (0.0, 10.0, 100.0, 200.0)])
def test_runs_whose_clocks_all_begin_anew_have_no_dates_and_so_no_states(monkeypatch, starts):
    monkeypatch.setattr("winch_friction.discrepancy.run_states.told_by_a_signal", lambda *_: False)
    runs = dated(*((start, 10.0) for start in starts))
    there = np.array([False, True, False, True])
    assert in_each_run(runs, np.arange(1.0, 5.0)) == []
    assert in_some_runs(a_slot("zero"), runs, 8.0 * there, there) == []


@pytest.mark.parametrize(
    ("runs", "there", "windows"),
    [
        # two records of one lift, of which one has a tail; and one within the other
        (((0.0, 10.0), (100.0, 10.0), (105.0, 10.0), (200.0, 10.0)), (0, 1, 1, 0), ((99.0, 116.0),)),
        (((0.0, 10.0), (100.0, 30.0), (105.0, 10.0), (200.0, 10.0)), (0, 1, 1, 0), ((99.0, 131.0),)),
        (((0.0, 30.0), (5.0, 10.0), (30.5, 10.0), (200.0, 10.0)), (0, 0, 1, 1), ((30.25, np.inf),)),
        (((0.0, 30.0), (5.0, 10.0), (29.0, 10.0), (200.0, 10.0)), (0, 0, 1, 1), None),  # the first went on
        (((0.0, 10.0), (9.0, 10.0), (100.0, 10.0), (200.0, 10.0)), (1, 0, 1, 1), None),
    ],
)
def test_records_of_one_lift_that_overlap_are_in_one_state(monkeypatch, runs, there, windows):
    """An offset since a date got a second name where two of twelve runs went on at once, both of them before it."""
    monkeypatch.setattr("winch_friction.discrepancy.run_states.told_by_a_signal", lambda *_: False)
    own = np.array(there, bool)
    found = in_some_runs(a_slot("zero"), dated(*runs), 8.0 * own, own)
    assert len(found) == (windows is not None)
    assert not found or _state(dated(*runs), 8.0 * own, own).windows == windows


@pytest.mark.parametrize(
    ("starts", "there"),
    [
        ((0.0, 20.0, 40.0), True),
        ((1.7e9, 1.7e9 - 50.0, 1.7e9 + 10.0), True),  # in any order; two that share the row at their seam
        ((0.0, 9.0, 18.0), True),
        ((0.0, 5.0, 10.0), False),
        ((0.0, 0.0, 40.0), False),
        ((3.0, 1.0, 0.0), False),
        ((0.0, 20.0, 23.0, 40.0), True),  # two cuts of one recording among others
        ((0.0,), True),
    ],
)
def test_what_follows_the_date_is_asked_of_runs_whose_clocks_go_on(crane2_model, starts, there):
    """A wear over clocks that all begin anew is what changes while a run goes on, under another name."""
    runs = dated(*((start, 10.0) for start in starts))
    for run in runs:
        run.present, run.groups = frozenset(), ()
    asked = [
        each
        for each in (*shipped_friction(), *literature())
        if each.name in ("wear_drift", "brake_drag", "coulomb") and each.blind is None
    ]
    usable, blind = catalogue.testable(asked, runs, crane2_model)
    of_dates = {each.name for each in usable if "time" in each.term.reads}
    assert of_dates == ({"wear_drift", "brake_drag"} if there else set())
    assert {each.name for each in usable} >= {"brake_drag", "coulomb"}  # a steady drag needs no date
    assert [(each.name, each.needs) for each in blind] == ([] if there else [("wear_drift", "time")])


def test_a_drag_for_a_time_is_named_for_its_cause_and_its_law():
    own = _drag("brake_drag", ((1.0, 2.0), (3.0, 4.0)), SOME_RUNS)
    assert (own.name, own.law_name, own.term.name) == ("brake_drag", SOME_RUNS, "brake_drag_in_some_runs")


# -- what was logged, by figures
def logged(values, used=None, kind=("main",), start=0.0, **drives):
    """A run with these samples of `x`, and what its groups do, by name: (closes the balance, displacement)."""
    count = len(values)
    groups = [
        SimpleNamespace(balances=closes, displacement=np.full(count, swept), pressure=np.full(count, 1e7))
        for closes, swept in (drives or {"main": (True, 2e-5)}).values()
    ]
    channels = {
        "x": np.array(values),
        "time": np.arange(count),
        "shaft_angle": np.ones(count),
        "acceleration": np.ones(count),
    }
    used = np.ones(count, bool) if used is None else np.array(used, bool)
    return SimpleNamespace(
        channels=channels, used=used, kind=kind, groups=groups, start=start, load=np.full(count, 1.0)
    )


def test_what_a_signal_was_in_the_middle_of_a_run_is_that_of_its_moving_samples():
    first = logged([9.0, 9.0, 9.0, 1.0, 2.0, 8.0], [0, 0, 0, 1, 1, 1], passive=(False, 7e-5), active=(True, 3e-5))
    still, other = logged([5.0], [0]), logged([4.0])
    other.channels["oil"] = np.ones(1)
    found = _medians([first, still, other])
    assert sorted(found) == ["displacement", "pressure", "x"]  # what all have, and no clock
    np.testing.assert_equal(found["x"], [2.0, np.nan, 4.0])
    np.testing.assert_equal(found["displacement"], [3e-5, np.nan, 2e-5])


@pytest.mark.parametrize(
    ("values", "spread"),
    [
        ([1.0, 2.0, 5.0], [-5.0 / 12.0, -2.0 / 12.0, 7.0 / 12.0]), ([3.0, 3.0], None), ([1.0, np.nan], None),
        ([1e9, 1e9 + 0.5], None), ([1e9, 1e9 + 2.0], [-0.5, 0.5]), ([-7.0, -5.0], [-0.5, 0.5]),
    ],
)  # fmt: skip
def test_a_signal_that_hardly_differs_tells_nothing(values, spread):
    found = _spread(np.array(values))
    assert (found is None) == (spread is None)
    assert found is None or found.tolist() == pytest.approx(spread)


def test_what_a_fit_leaves_is_told_per_value_that_it_does_not_use_up():
    values = np.array([1.0, 2.0, 6.0, 7.0])
    assert _left_by(np.ones((4, 1)), values) == pytest.approx(np.var(values, ddof=1))
    assert _left_by(np.eye(4), values) == pytest.approx(0.0)


def test_six_runs_of_one_kind_are_enough_to_tell_that_levels_follow_nothing():
    """What two runs of a kind are spread by, and a parabola uses up, is no freedom."""
    levels = np.array([1.0, 5.0, 2.0, 6.0, 1.5, 5.5, 2.5])
    assert follows_a_signal([logged([1.0], start=0.0) for _ in range(5)], levels[:5])
    assert not follows_a_signal([logged([1.0], start=0.0) for _ in range(6)], levels[:6])
    two = [("main",)] * 3 + [("active", "passive")] * 3
    assert follows_a_signal([logged([1.0], kind=kind) for kind in two], levels[:6])
    assert not follows_a_signal([logged([1.0], kind=kind) for kind in [*two, ("main",)]], levels)


@pytest.mark.parametrize(("kinds", "told"), [("aabb", True), ("abab", False), ("aaaa", False)])
def test_what_one_kind_of_run_alone_has_is_told_by_the_kind(kinds, told):
    there = np.array([True, True, False, False])
    runs = [logged([value], kind=kind) for kind, value in zip(kinds, (1.0, 4.0, 2.0, 3.0), strict=True)]
    assert told_by_a_signal(runs, there) == told
    assert not told_by_a_signal([runs[0], runs[0]], np.ones(2, bool))  # all have it, and all are alike


@pytest.mark.parametrize(
    ("values", "told"),
    [
        ((3.0, 4.0, 1.0, 2.0), True),
        ((1.0, 2.0, 3.0, 4.0), True),
        ((2.0, 4.0, 1.0, 2.0), False),
        ((1.0, 3.0, 2.0, 4.0), False),
    ],
)
def test_a_signal_tells_where_all_runs_of_one_level_lie_beyond_the_others(values, told):
    assert told_by_a_signal([logged([value]) for value in values], np.array([True, True, False, False])) == told


@pytest.mark.parametrize(("layers", "told"), [((2, 2, 1, 3), True), ((2, 2, 2, 3), False), ((2, 4, 1, 3), False)])
def test_a_layer_tells_where_runs_of_one_level_share_it_and_no_other_has_it(layers, told):
    runs = [logged([value]) for value in (1.0, 3.0, 2.0, 4.0)]
    for run, layer in zip(runs, layers, strict=True):
        run.channels["wire_layer"] = np.array([float(layer)])
    assert told_by_a_signal(runs, np.array([True, True, False, False])) == told


def test_a_state_is_since_a_date_where_its_last_window_has_no_end():
    laws = [State(((0.0, 5.0), (9.0, end)), 2, 4, False).law for end in (INF, 12.0)]
    assert laws == [SINCE, SOME_RUNS]


def test_a_candidate_of_some_runs_has_its_causes_column_and_correction_then(monkeypatch):
    monkeypatch.setattr("winch_friction.discrepancy.run_states.told_by_a_signal", lambda *_: False)
    there = np.array([False, True, False])
    runs = dated((0.0, 10.0), (100.0, 10.0), (200.0, 10.0))
    shape = Shape("all groups", {})
    own = Candidate(
        "zero", linear=(Parameter("x", "Pa", 1.0, doc="a zero"),), columns=lambda run, values: np.full((2, 1), 7.0),
        corrects=lambda found, *_: [Correction("pressure_offset", found["x"])], shapes=lambda _: [shape],
    )  # fmt: skip
    (found,) = in_some_runs(Slot("zero", "", (1,), origin=(own, shape)), runs, 8.0 * there, there)
    assert [found.columns(run, {}).tolist() for run in runs] == [[[0.0]] * 2, [[7.0]] * 2, [[0.0]] * 2]
    (made,) = found.corrects({"x": 3e5}, shape, None)
    assert (made.value, tuple(made.during)) == (3e5, ((99.0, 111.0),))


def test_a_drag_for_a_time_is_a_few_newton_metres_beside_a_friction_that_is_there():
    own = _drag("wear_drift", ((1.0, 2.0), (3.0, 4.0)), SOME_RUNS, (1.0, 0.25))
    assert own.presumes == ("coulomb", "motor_coulomb")
    assert [(each.typical, each.lower) for each in own.linear] == [(3.0, 0.0)]
    assert own.linear == own.term.parameters
    assert own.term.table.knots == (("time", (1.0, 2.0, 3.0, 4.0)),)
    assert own.term.table.weights == (1.0, 0.25)
