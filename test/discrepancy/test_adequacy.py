"""What the runs must hold before anything is searched: both directions, enough of a log, and what is left out."""

from contextlib import nullcontext
from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy.adequacy import (
    HEAVE,
    SWING,
    TELLING,
    Check,
    _by_way,
    _distinct,
    _hangs_still,
    long_enough,
    of_prepared,
    of_records,
)
from winch_friction.discrepancy.answer import INSUFFICIENT
from winch_friction.discrepancy.engine.chance import Size
from winch_friction.discrepancy.next_experiment import (
    insufficient,
    levels_of,
    of_own_terms,
    of_runs,
    of_unexplained,
    of_wire,
    supplying,
    with_what_was_seen,
)
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.discrepancy.workflow import find_gap
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import Run
from winch_friction.records.runs import apart
from winch_friction.records.strict_yaml import shipped

STEP = 0.1  # s


def prepared(name, hoisting, lowering):
    """So many seconds each way, and as much at rest between."""
    direction = np.concatenate([np.ones(round(hoisting / STEP)), np.zeros(50), -np.ones(round(lowering / STEP))])
    size = len(direction)
    return SimpleNamespace(
        name=name, dt=STEP, time=np.arange(size) * STEP, direction=direction, used=direction != 0.0,
        speed=direction * np.linspace(20.0, 100.0, size), load=np.full(size, 5e4), groups=(), channels={},
    )  # fmt: skip


def checked(*runs):
    return {each.what: each for each in of_prepared(SimpleNamespace(prepared=runs), ["a"], ["b"])}


def test_each_direction_is_counted_by_itself_and_of_the_training_runs_alone():
    found = checked(prepared("a", 20.0, 1.0), prepared("b", 6.0, 30.0))
    assert found["hoisting"].value == pytest.approx(20.0)
    assert found["hoisting"].met
    assert found["lowering"].value == pytest.approx(1.0)
    assert not found["lowering"].met
    assert found["moving time"].value == pytest.approx(21.0)
    assert found["moving time of the locked runs"].value == pytest.approx(36.0)
    assert found["reversals"].value == 1.0


@pytest.mark.parametrize(("felt", "heave", "sides", "silent"), [
    (0.0, False, 2, True),  # the motors feel none of what a load would take that moves with the wire
    (1.0, False, 2, False),  # the crane stands still, as the format says
    (0.0, True, 2, False),
    (0.0, False, 1, False),  # hoisting, where an inertia may be wrong
])  # fmt: skip
def test_heave_compensation_that_does_not_say_how_the_crane_moved_cannot_answer(felt, heave, sides, silent):
    """A gap that is the load's inertia, which the balance takes off, is no friction."""
    run = prepared("a", 20.0, 20.0)
    swell = np.sin(0.7 * run.time)
    run.groups, run.radius, run.gear_ratio = (
        (SimpleNamespace(balances=True, displacement=np.ones(1)),) * sides,
        0.8,
        100,
    )
    run.load_acceleration, run.channels = swell, {"heave_velocity": swell} if heave else {}
    run.gap = (felt - 1.0) * run.load * 0.8 / 100 * swell + 40.0 * run.direction
    found = checked(run, prepared("b", 6.0, 30.0))
    assert (HEAVE in found) == silent
    assert not silent or (found[HEAVE].value, found[HEAVE].needed, found[HEAVE].met) == (0.0, 1.0, False)


def test_speeds_and_temperatures_are_judged_by_how_far_they_reach():
    """A twentieth of the samples at either end is no speed that the runs were made at."""
    one = prepared("a", 20.0, 20.0)
    one.speed = one.direction * np.resize([10.0, *[50.0] * 9, *[60.0] * 9, 80.0], len(one.time))
    one.channels = {"oil_temperature": np.linspace(40.0, 55.0, len(one.time))}
    found = checked(one)
    assert found["speeds, upper over lower decile"].value == pytest.approx(1.2)
    assert found["oil temperatures, span"].value == pytest.approx(15.0)


@pytest.mark.parametrize(
    ("value", "shown"), [(19.96, "19.96"), (19.99996, "19.99996"), (20.0, "20"), (20.04, "20"), (3.14159, "3.14")]
)
def test_what_falls_short_is_not_rounded_to_what_is_needed(value, shown):
    assert Check("records that can be used", value, 20.0, "s", value >= 20.0).sentence.endswith(
        f"used: {shown} s, needed 20 s"
    )


@pytest.mark.parametrize(("rate", "kept"), [(0.5, False), (0.9, False), (0.99, True), (4.0, True)])
def test_a_log_slower_than_a_search_needs_is_left_out_by_name(rate, kept):
    time = np.arange(0.0, 30.0, 1.0 / (rate * LIMITS.lowest_rate))
    run = Run("slow", {"time": time, "motor_speed": 100.0 * np.sin(time)})
    found, notes = long_enough([run])
    assert bool(found) is kept
    assert ("slow left out: logged at" in "".join(notes)) is not kept


def test_a_record_too_short_for_a_hoist_and_a_lower_is_left_out_by_name():
    time = np.arange(0.0, 0.9 * LIMITS.shortest_record, 0.02)
    found, notes = long_enough([Run("brief", {"time": time, "motor_speed": np.sin(time)})])
    assert not found
    assert "brief left out: it lasts" in notes[0]
    with pytest.raises(InputError, match="brief: lasts 0.9 s; that is no record"):
        long_enough([Run("brief", {"time": np.linspace(0.0, 0.9, 50), "motor_speed": np.ones(50)})])


def logged(name, *stretches):
    """A record of a sample every tenth of a second in these stretches of s."""
    time = np.concatenate([np.arange(start, end, STEP) for start, end in stretches])
    return Run(name, {"time": time, "motor_speed": time}, {"mine": time, "note": ["a"]})


def test_a_record_is_another_run_after_a_long_hole():
    (whole, *parts), notes = apart(
        [logged("whole", (0.0, 40.0), (65.0, 90.0)), logged("two", (0.0, 40.0), (2000.0, 2100.0))]
    )
    assert (whole.name, len(whole)) == ("whole", 650)  # a hole of 25 s is one in a run
    assert [(each.name, len(each)) for each in parts] == [("two, part 1", 400), ("two, part 2", 1000)]
    for each in parts:
        np.testing.assert_array_equal(each["motor_speed"], each.time)
        np.testing.assert_array_equal(each.aside["mine"], each.time)
        assert each.aside["note"] == ["a"]
    assert notes == ["two: nothing was logged for up to 1.96e+03 s; looked at as 2 runs"]


def test_what_is_no_record_between_two_holes_is_no_run():
    parts, notes = apart([logged("two", (0.0, 40.0), (100.0, 100.5), (200.0, 230.0))])
    assert [(each.name, each.time[0]) for each in parts] == [("two, part 1", 0.0), ("two, part 2", 200.0)]
    assert "2 runs" in notes[0]


def test_a_log_of_a_sample_a_minute_is_no_record_full_of_holes():
    """Between its samples nothing is long enough to be a run: the record stays what it is, and is left out by name."""
    slow = Run("slow", {"time": 60.0 * np.arange(60.0), "motor_speed": np.arange(60.0)})
    assert apart([slow]) == ([slow], [])
    kept, notes = long_enough([slow])
    assert (kept, [note.partition(":")[0] for note in notes]) == ([], ["slow left out"])
    assert not all(each.met for each in of_records([slow], kept))


def test_a_hole_makes_no_log_slow():
    """10 Hz with 29 s of silence after every second; over the whole of it there are 0.4 samples a second."""
    holed = logged("holed", *((30.0 * k, 30.0 * k + 1.05) for k in range(8)))
    kept, notes = long_enough([holed])
    assert (kept, notes) == ([holed], [])
    (rate,) = (each.value for each in of_records([holed], kept) if each.what == "fastest log")
    assert rate == pytest.approx(10.0, rel=0.05)


def test_the_answer_says_that_a_record_is_looked_at_in_parts(crane_150t, crane2_model):
    result = find_gap([logged("two", (0.0, 6.0), (100.0, 106.0))], crane_150t, crane2_model)
    assert result.verdict == INSUFFICIENT
    assert result.content()["notes"][0].startswith("two: nothing was logged for up to 94")


def test_a_row_that_is_lost_of_a_time_in_ms_is_no_hole():
    """Steps of 20 'seconds', one of 40: what is wrong is the unit, and the run is whole."""
    time = np.delete(np.arange(500.0) * 20.0, 250)
    run = Run("in ms", {"time": time, "motor_speed": np.sin(time)})
    assert apart([run]) == ([run], [])


@pytest.mark.parametrize(("stiffness", "silent", "said"), [
    (1e8, "ab", "no run says wire_out"), (1e8, "a", "a do not say wire_out"), (1e8, "", ""), (float("nan"), "ab", ""),
])  # fmt: skip
def test_a_wire_whose_length_is_not_told_may_be_the_gap(stiffness, silent, said):
    runs = [SimpleNamespace(name=own, channels={} if own in silent else {"wire_out": 0}) for own in "ab"]
    notes = of_wire(SimpleNamespace(crane=SimpleNamespace(wire_stiffness=stiffness), prepared=runs))
    assert len(notes) == bool(said)
    assert "".join(notes).startswith(said)


@pytest.mark.parametrize(("left", "said"), [
    ((1.0, 5.0, 1.1, 0.9, 6.0, 1.2), "b, e keep 5 times the noise and more, no other run more than 1.2 times"),
    ((1.0, 5.0, 1.1, 0.9, 0.8, 1.2), "b keeps 5 times"),
    ((0.5, 1.9, 0.3, 0.2, 0.3, 0.2), ""),  # nothing that matters
    ((1.0, 5.0, 3.0, 2.0, 4.0, 2.6), ""),  # by and by
    ((1.0, 5.0, 5.0, 5.0, 5.0, 1.0), ""),  # most of the runs: what is another is what the others are
])  # fmt: skip
def test_runs_that_keep_plainly_more_than_any_other_are_said(left, said):
    runs = list(zip("abcdef", left, strict=True))
    notes = of_runs([SimpleNamespace(most_left_first=dict(part)) for part in (runs[:4], runs[4:])])
    assert len(notes) == bool(said)
    assert "".join(notes).startswith(said)


def left_of(levels, friction=0.0):
    """What runs of 400 N m per unit and 40 kN m at a gear of 100 keep: a level each, and friction beside noise. A wave
    that makes twice the torque for a while is no load."""
    way = np.tile([1.0, -1.0, -1.0, -1.0], 50)
    noise = 0.2 * np.random.default_rng(3).standard_normal((len(levels), 200))
    after = np.array(levels)[:, None] + friction * way + noise
    runs = [
        SimpleNamespace(drum_torque=np.array([4e4, -9e4, 4e4, 4e4, 4e4]), gear_ratio=100.0, unit_torque=4.0)
        for _ in levels
    ]
    blocks = SimpleNamespace(run=np.repeat(np.arange(len(levels)), 200), direction=np.tile(way, len(levels)))
    return SimpleNamespace(runs=runs, blocks=blocks, after=after.ravel(), floor=0.22)


@pytest.mark.parametrize(("trained", "friction", "said"), [
    ((0.5, -0.6, 0.8, -0.3), 0.0, "-0.6 to +0.82 % of its load, and no more than noise beside it: that is no friction"),
    ((0.5, -0.6, 0.8), 0.0, ""),  # too few runs
    ((0.5, 0.6, 0.8, 0.7), 0.0, "+0.15 to +0.82 % of its load (all of one sign, +0.49 % in the mean: such as a zero"),
    ((0.5, -0.6, 0.8, -0.3), 0.3, "-0.6 to +0.82 % of its load, which is no friction, and 90 % of what they keep"),
    ((0.5, -0.6, 0.8, -0.3), 0.5, ""),  # most of it is something else
    ((0.05, -0.06, 0.08, -0.03), 0.0, ""),  # that are noise
])  # fmt: skip
def test_of_loads_that_are_off_by_another_amount_in_each_run_is_said_to_weigh_them(trained, friction, said):
    levels = levels_of([left_of(trained, friction), left_of((0.4 * trained[0], 0.3 * trained[0]), friction)])
    assert (levels is not None) == bool(said)
    assert levels is None or said in levels.said
    one_way = left_of(trained, friction)
    one_way.blocks.direction = np.ones(len(one_way.after))
    assert levels_of([one_way] * 2) is None  # nobody tells such a level from friction


@dataclass(frozen=True)
class Unexplained:
    train: SimpleNamespace
    holdout: SimpleNamespace
    depends: tuple[str, ...] = ("oil_temperature",)


@pytest.mark.parametrize(
    ("friction", "signals", "said"), [(0.0, (), 1), (0.3, ("oil_temperature",), 1), (0.5, ("oil_temperature",), 0)]
)
def test_levels_of_runs_depend_on_no_signal(friction, signals, said):
    """What is steady within each run tells runs apart, and so imitates any level of theirs."""
    sides = [left_of(levels, friction) for levels in ((0.5, -0.6, 0.8, -0.3), (0.2, 0.15))]
    for side in sides:
        side.most_left_first = {}
    given = SimpleNamespace(prepared=[], crane=SimpleNamespace(wire_stiffness=np.nan))
    found, notes = of_unexplained(Unexplained(*sides), given, False)
    assert found.depends == signals
    assert len(notes) == said


@pytest.mark.parametrize("said", [False, True])
def test_where_an_equation_says_what_is_missing_nobody_is_sent_to_look_at_the_runs(said):
    sides = [left_of(levels) for levels in ((0.5, -0.6, 0.8, -0.3), (0.2, 0.15))]
    sides[0].most_left_first, sides[1].most_left_first = {"a": 13.0, "b": 1.0, "c": 1.0}, {"d": 1.0}
    given = SimpleNamespace(prepared=[], crane=SimpleNamespace(wire_stiffness=np.nan))
    found, notes = of_unexplained(Unexplained(*sides), given, said)
    assert len(notes) == (0 if said else 2)
    assert found.depends == (("oil_temperature",) if said else ())


@pytest.mark.parametrize(("share", "kept"), [(0.2, False), (0.8, True)])
def test_a_run_whose_pressure_is_lost_in_most_rows_at_random_is_left_out(share, kept):
    """What lies between was drawn straight and had no noise: a floor of a thousandth of a bar, a verdict of chance."""
    rows = np.random.default_rng(5).random(3000) < share
    columns = {"time": 0.02 * np.arange(3000), "motor_speed": np.ones(3000)}
    found, notes = long_enough([Run("lost", {**columns, "main.pressure_a": np.where(rows, 1e7, np.nan)})])
    assert bool(found) == kept
    if not kept:
        assert notes[0].startswith("lost left out: main.pressure_a has a value in 20")
        assert "those stand alone: log it in every row" in notes[0]


def test_a_run_whose_pressure_was_dead_for_most_of_it_tells_what_it_has():
    columns = {"time": 0.02 * np.arange(3000), "motor_speed": np.ones(3000)}
    dead = np.where(np.arange(3000) < 600, 1e7, np.nan)
    assert long_enough([Run("dead", {**columns, "main.pressure_a": dead})])[0]


@pytest.mark.parametrize("named", [False, True])
def test_runs_that_lack_something_say_what_was_seen_of_them_all_the_same(crane_150t, crane2_model, named):
    """Twelve runs, of which nine losses did as well, got a page without a region, a candidate or the refit."""
    lacking = insufficient([], ["a note"], crane_150t, crane2_model)
    holdout = replace(lacking.holdout, size_after=Size(0.306, (0.3, 0.31)))
    result = replace(
        lacking, considered=("loss",), untestable=("signal",), holdout=holdout, effects=("effect",) * named,
    )  # fmt: skip
    said = with_what_was_seen(lacking, result)
    assert (said.verdict, said.effects, said.model) == ("insufficient", (), crane2_model)
    assert (said.considered, said.untestable) == (("loss",), ("signal",))
    assert said.holdout is lacking.holdout  # of the model that is written, which is the given one
    assert said.notes[0] == "a note"
    assert [("0.306 bar" in note) for note in said.notes[1:]] == [True] * (not named)


@pytest.mark.parametrize(
    ("named", "values", "said"),
    [
        (["stribeck"], {"C1": 0.0, "C3": 1.0}, "too much of it: C1 0.02 becomes 0, C3 "),
        (["stribeck"], {"C1": 0.03}, "something else of it: C1 0.02 becomes 0.03, C3 "),
        (["coulomb", "churning"], {"C1": 0.0}, None),
    ],
)
def test_a_named_term_that_the_given_model_has_is_not_missing(crane2_model, named, values, said):
    """A model with Stribeck friction met a winch without: `missing_effect: stribeck` with a negative amount, alone."""
    given = crane2_model.with_values({**crane2_model.as_dict(), "C1": 0.02, "C3": 2.0})
    notes = of_own_terms(named, given, given.with_values({**given.as_dict(), **values}))
    assert [f"stribeck: the given model has this term already and says {said}" in each for each in notes] == (
        [True] if said else []
    )


@pytest.mark.parametrize(
    ("values", "count"),
    [
        ([], 0), ([5.0], 1), ([5.0, 5.4], 1), ([5.0, 5.6], 2), ([5.6, 5.0], 2), ([1.0, 9.0, 1.0, 9.0], 2),
        ([1.0, 1.09, 1.18], 1),  # by and by
        ([0.0, 0.0], 1), ([0.0, 1.0, 2.0], 3),
    ],
)  # fmt: skip
def test_loads_are_two_where_they_differ_by_a_tenth(values, count):
    assert _distinct(values) == count


def test_loads_displacements_and_temperatures_are_those_of_the_training_runs():
    first, second, locked = (prepared(name, 20.0, 20.0) for name in "acb")
    for run, load, swash, oil in ((first, 5e4, 2e-5, 20.0), (second, 8e4, 2e-5, 32.0), (locked, 2e4, 9e-5, 70.0)):
        idle = SimpleNamespace(balances=False, displacement=np.full(3, load))
        run.groups = (idle, SimpleNamespace(balances=True, displacement=np.full(3, swash)))
        run.load, run.channels = np.full(len(run.time), load), {"oil_temperature": np.array([oil, oil + 3.0])}
        run.channels["heave_velocity"] = np.zeros(2)
    found = {each.what: each for each in of_prepared(SimpleNamespace(prepared=(first, second, locked)), "ac", "b")}
    assert found["loads"].value == 2.0
    assert found["displacements"].value == 1.0
    assert (found["oil temperatures, span"].value, found["oil temperatures, span"].unit) == (15.0, "K")
    assert found["usable share of the samples"].value == pytest.approx(40.0 / 44.9)
    assert found["reversals"].value == 2.0


def test_the_mean_of_each_way_is_that_of_its_own_samples():
    found = _by_way(np.array([1.0, 3.0, 10.0, 20.0, 7.0]), np.array([1.0, 1.0, -1.0, -1.0, 0.0]))
    assert found.tolist() == [2.0, 2.0, 15.0, 15.0, 7.0]


@pytest.mark.parametrize(
    ("lacking", "scenario"),
    [
        ((SWING,), "ahc_55t_215"), ((HEAVE, "loads"), "ahc_55t_215"), (("loads",), "experiment_loads"),
        ((f"{TELLING} (a, b)",), "experiment_loads"), (("hoisting",), "test_02"), ((), "test_02"),
    ],
)  # fmt: skip
def test_what_runs_lack_is_supplied_by_a_scenario_that_has_it(lacking, scenario):
    """What they have counts for nothing."""
    met = [Check(what, 1.0, 1.0, "1", True) for what in (SWING, "loads") if what not in lacking]
    assert supplying([*met, *(Check(what, 0.0, 1.0, "1", False) for what in lacking)]) == scenario


def test_runs_that_cannot_answer_say_what_they_lack_and_what_supplies_it(crane_150t, crane2_model):
    checks = [
        Check("hoisting", 1.5, 3.0, "s", False), Check("lowering", 9.0, 3.0, "s", True),
        Check("loads", 1.0, 2.0, "1", False),
    ]  # fmt: skip
    found = insufficient(checks, ["a note"], crane_150t, crane2_model)
    lacks = "hoisting: 1.5 s, needed 3 s; loads: 1, needed 2"
    assert (found.verdict, found.refused, found.effects) == (INSUFFICIENT, lacks, ())
    assert found.next_experiment == {
        "scenario": "experiment_loads.yaml", "separates": [], "expected_z": 0.0, "considered": {},
        "note": f"supplies what the runs lack ({lacks})",
    }  # fmt: skip
    assert found.next_scenario == shipped("scenarios", "experiment_loads").read_text(encoding="utf-8")
    assert (found.adequacy, found.notes, found.unit) == (tuple(checks), ("a note",), "bar")
    assert found.model is found.seed_model is crane2_model


@pytest.mark.parametrize(
    ("check", "said"),
    [
        (Check("lasts", 1.234567, 3.0, "s", False), "lasts: 1.23 s, needed 3 s"),
        (Check("share", 0.1, 0.2, "1", False), "share: 0.1, needed 0.2"),
        (Check(f"{TELLING} (a)", 0.0, 1.0, "1", False), f"{TELLING} (a)"),
    ],
)
def test_what_is_lacking_is_said_with_its_unit(check, said):
    assert check.sentence == said


@pytest.mark.parametrize(("value", "met"), [(5.0, True), (4.999, False)])
def test_a_record_that_lasts_just_long_enough_does(value, met):
    runs = [Run("a", {"time": np.linspace(7.0, 7.0 + value, 500)}), Run("b", {"time": np.linspace(0.0, 2.0, 21)})]
    found = {each.what: each for each in of_records(runs, runs[:1])}
    assert found["longest record"].met is met
    assert found["records that can be used"].value == pytest.approx(value)
    assert found["fastest log"].value == pytest.approx(499.0 / value / 0.98)


@pytest.mark.parametrize(("left", "still"), [(0.69, True), (0.72, False)])
def test_a_load_hangs_still_where_half_of_the_gaps_square_is_gone_with_its_inertia(left, still):
    """Beside what friction that is off adds in either direction; of no sample there is nothing to say."""
    swell, way = np.sin(np.linspace(0.0, 60.0, 4000)), np.where(np.arange(4000) % 20 < 10, 1.0, -1.0)
    other = np.cos(np.linspace(0.0, 60.0, 4000))
    taken = np.sqrt(1.0 - left**2) * swell
    run = SimpleNamespace(
        direction=way, used=np.ones(4000, bool), load=2e4, radius=0.8, gear_ratio=200.0,
        gap=left * other - taken + 30.0 * way,
        load_acceleration=taken / (2e4 * 0.8 / 200.0),
    )  # fmt: skip
    assert _hangs_still(run) is still
    run.used = np.zeros(4000, bool)
    assert _hangs_still(run) is False


def test_a_reversal_through_rest_is_one_and_one_load_and_displacement_are_enough():
    run = prepared("a", 20.0, 20.0)
    run.used = np.ones(len(run.time), bool)  # at rest as well
    found = checked(run)
    assert found["reversals"].value == 1.0
    assert [(found[what].needed, found[what].met) for what in ("loads", "displacements")] == [(1.0, True)] * 2
    assert found["oil temperatures, span"].needed == found["reversals"].needed == 0.0


def test_what_is_needed_and_no_more_is_enough():
    runs = [Run("r", {"time": np.array([0.0, 1.0]), "motor_speed": np.zeros(2)})]
    needed = {each.what: each.needed for each in of_records(runs, runs)}["longest record"]
    exact = [Run("r", {"time": np.linspace(0.0, needed, 200), "motor_speed": np.zeros(200)})]
    (own,) = [each for each in of_records(exact, exact) if each.what == "longest record"]
    assert (own.value, own.met) == (needed, True)


@pytest.mark.parametrize(("lasts", "said"), [(0.5, "lasts 0.5 s; that is no record"), (3.0, "left out: it lasts 3 s")])
def test_rows_without_a_time_at_the_end_make_no_record_long(lasts, said):
    time = np.concatenate([np.linspace(0.0, lasts, 51), [np.nan, np.nan]])
    runs = [Run("r", {"time": time, "motor_speed": np.ones(53)})]
    with pytest.raises(InputError, match=said) if lasts < 1.0 else nullcontext():
        kept, notes = long_enough(runs)
        assert kept == []
        assert said in notes[0]
