"""A suspected delay as what the runs are without it: at five values, with a swing on the wire that is told once, and
as a filter that makes all or half of it."""

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy.candidates.candidate import Candidate, Shape
from winch_friction.discrepancy.candidates.lateness import PRESSURES, SMALL_DELAY, SPEED, tau
from winch_friction.discrepancy.detectors import delay
from winch_friction.discrepancy.detectors.delay_course import passing_delay
from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.search import long_delay
from winch_friction.physics.friction import FrictionModel

SIZE, MODE = 0.1, (3.0, 0.05, None)
TIME = np.linspace(0.0, 150.0, 101)  # a clock that drifts is late by SIZE in the middle


@dataclass
class Model:
    """A model that is asked for its corrections alone."""

    corrections: tuple = ()


def prepared(gap, mode=None):
    still = np.zeros(len(TIME))
    return SimpleNamespace(name="run", start=0.0, time=TIME, gap=gap, wire_mode=mode, used=np.ones(len(TIME), bool),
                           from_speed=still, predicted=still)  # fmt: skip


class Asked:
    """What was told anew, and in turn with which wires: the corrections, by name, of every model that was asked."""

    def __init__(self, monkeypatch):
        self.told, self.in_turn, self.kept = [], [], {}
        monkeypatch.setattr(delay, "meet", self.meet)
        monkeypatch.setattr(delay, "met_in_turn", self.met_in_turn)

    def gap_without(self, model):
        late = sum(each.value * (100.0 if each.name.endswith("_clock") else 1.0) for each in model.corrections)
        return np.full(len(TIME), 2.0 - late)

    def meet(self, runs, crane, model, _):
        self.told.append({each.name: each.value for each in model.corrections})
        return SimpleNamespace(prepared=(prepared(self.gap_without(model), MODE),))

    def met_in_turn(self, given, model, modes):
        assert modes == {"run": MODE}
        self.in_turn.append({each.name: each.value for each in model.corrections})
        yield prepared(self.gap_without(model))

    def once(self, key, make):
        if key not in self.kept:
            self.kept[key] = make()
        return self.kept[key]

    def shapes_of(self, size=SIZE, late=SPEED):
        runs = (prepared(np.full(len(TIME), 2.0)),)
        given = SimpleNamespace(runs=(), crane=None, model=Model(), prepared=runs, once=self.once)
        shape = Shape("late", {"ahead": max(size, 0.0), "behind": max(-size, 0.0), "late": late})
        suspect = Slot(delay.DELAY, "late", (0,), origin=(None, shape))
        own = Candidate(
            delay.DELAY, columns=lambda run, values: values["ahead"] * run.gap[:, None], shapes=lambda _: []
        )
        (found,) = delay.without_delay(given, [own], suspect, None, SimpleNamespace(slots=()), ("run",))
        return found, given.prepared[0]


def test_the_five_values_share_the_swing_that_is_told_without_the_first_estimate(monkeypatch):
    asked = Asked(monkeypatch)
    found, run = asked.shapes_of()
    assert asked.told[0] == {"signal_delay": pytest.approx(SIZE)}
    delays = [each["signal_delay"] for each in asked.in_turn[:4]]
    assert sorted(value / SIZE for value in (*delays, SIZE)) == pytest.approx(sorted(delay.AROUND))
    # of a clock that is late by as much in the middle of a run
    assert [75.0 * each["signal_clock"] / SIZE for each in asked.in_turn[4:7]] == pytest.approx(delay.COARSELY)
    for each in found.shapes([]):  # what a delay of one second would leave
        np.testing.assert_allclose(found.columns(run, each.values), 1.0)
    assert len(found.shapes([])) == 8 + 6
    count = len(asked.told), len(asked.in_turn)
    again, _ = asked.shapes_of()
    assert (len(asked.told), len(asked.in_turn)) == count  # a search that asks in another way suspects the same
    np.testing.assert_allclose(again.columns(run, found.shapes([])[0].values), 1.0)
    asked.shapes_of(2.0 * SIZE)
    assert (len(asked.told), len(asked.in_turn)) == (2 * count[0], 2 * count[1])
    # shapes of other sizes are the first derivative's
    small = found.columns(run, {"ahead": 0.01, "behind": 0.0, "late": SPEED})
    np.testing.assert_allclose(small, 0.01 * 2.0)


def test_a_filter_may_make_all_or_half_of_what_is_late(monkeypatch):
    asked = Asked(monkeypatch)
    found, run = asked.shapes_of()
    # a wire is told anew under each: what a delay leaves of a filter sounds like one
    assert asked.told[1:] == [
        {"signal_filter": pytest.approx(SIZE)},
        {"signal_delay": pytest.approx(SIZE / 2), "signal_filter": pytest.approx(SIZE / 2)},
    ]
    sums = [sum(each.values()) / SIZE for each in asked.in_turn[7:]]
    assert sums == pytest.approx([0.8, 1.25, 0.8, 1.25])
    shapes = found.shapes([])
    assert [each.label for each in shapes[8:]] == [
        f"speed late by a filter{more}, looked at with {size} ms"
        for more in ("", " and a delay")
        for size in (100, 80, 125)
    ]
    assert len({each.label for each in shapes}) == len(shapes)
    for each in shapes:
        np.testing.assert_allclose(found.columns(run, each.values), 1.0)


@pytest.mark.parametrize(("size", "late", "other"), [(-SIZE, SPEED, PRESSURES), (SIZE, PRESSURES, SPEED)])
def test_what_seems_early_may_be_the_other_side_that_is_late(monkeypatch, size, late, other):
    found, run = Asked(monkeypatch).shapes_of(size, late)
    shapes = found.shapes([])
    sides = {each.values["late"]: "filtered" in each.values for each in shapes}
    assert sides == {late: False, other: True}  # a filter makes nothing early
    assert [each.label.split()[1].strip(",") for each in shapes] == ["early"] * 8 + ["late"] * 14
    assert len({each.label for each in shapes}) == len(shapes) == 8 + 8 + 6
    for each in shapes:
        sign = 1.0 if each.values["late"] == SPEED else -1.0  # pressures are corrected the other way
        np.testing.assert_allclose(found.columns(run, each.values), sign)


@pytest.mark.parametrize(("late", "sign"), [(SPEED, 1.0), (PRESSURES, -1.0)])
def test_what_is_suspected_of_a_clock_that_drifts_is_its_delay_in_the_middle(late, sign):
    shape = delay._shape(sign * 0.3, late, by_time=1.0)
    suspect = Slot(delay.DELAY, shape.label, (0,), origin=(None, shape))
    assert delay._size(suspect, None, SimpleNamespace(slots=()), half=60.0) == pytest.approx(sign * 0.3 * 0.6)
    (one,) = delay._without(shape, FrictionModel("m", (), ())).corrections
    assert (one.name, one.value) == ("signal_clock" if late == SPEED else "pressure_clock", pytest.approx(0.003))
    assert "late, looked at with 300 ms after 100 s" in shape.label


@pytest.mark.parametrize(("value", "long"), [(0.021, True), (-0.04, True), (0.019, False)])
def test_a_small_delay_as_long_as_one_may_be_is_taken_out_of_the_runs(value, long):
    slot = Slot(delay.DELAY, "small", (0,), origin=(None, Shape("small", SMALL_DELAY)))
    cross = SimpleNamespace(size=lambda explanation, slot: value)
    assert long_delay([slot], cross, SimpleNamespace(slots=(slot,))) == (slot if long else None)
    # what is only near to what was found has no size of its own
    assert long_delay([slot], cross, SimpleNamespace(slots=())) is None


@pytest.mark.parametrize("side", [SPEED, PRESSURES])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_shape_says_which_side_is_late_or_early_how_long_and_by_what(side, sign):
    """Its bounds reach half way to the next size on either side, in units of the delay's typical one."""
    plain = delay._shape(0.1 * sign, side)
    late = "late" if (sign > 0.0) == (side == SPEED) else "early"
    of = "speed" if side == SPEED else "pressures"
    assert plain.label == f"{of} {late}, looked at with 100 ms"
    assert plain.values == {"ahead": max(0.1 * sign, 0.0), "behind": max(-0.1 * sign, 0.0), "late": side,
                            "delay": 0.1 * sign}  # fmt: skip
    reach = sorted((0.1 * sign / 1.1 / tau.typical, 0.1 * sign * 1.1 / tau.typical))
    assert plain.bounds == pytest.approx(reach)
    assert delay._shape(0.1 * sign, side, by_time=1.0).label == f"{of} {late}, looked at with 100 ms after 100 s"
    assert delay._shape(0.1 * sign, side, filtered=1.0).label == f"{of} {late} by a filter, looked at with 100 ms"
    both = delay._shape(0.1 * sign, side, filtered=0.5)
    assert both.label == f"{of} {late} by a filter and a delay, looked at with 100 ms"
    assert (both.values["filtered"], both.values["delay"]) == (0.5, 0.1 * sign)


def test_delays_clocks_and_filters_are_tried_around_the_first_estimate_and_at_it():
    """A clock's delay is what it has grown to after a hundred seconds, where the estimate is of the middle."""
    kinds = delay._ways(0.1, SPEED, 50.0)
    assert [len(each) for each in kinds] == [8, 3, 3]
    sizes = [[shape.values["delay"] for shape in each] for each in kinds]
    assert sizes[0] == pytest.approx([0.1, 0.07, 0.085, 0.115, 0.13, 0.2, 0.16, 0.25])
    assert sizes[1] == sizes[2] == pytest.approx([0.1, 0.08, 0.125])
    assert ["by_time" in shape.values for shape in kinds[0]] == [False] * 5 + [True] * 3
    assert [each[0].values["filtered"] for each in kinds[1:]] == [1.0, 0.5]
    early = delay._ways(-0.1, SPEED, 50.0)
    assert [each[0].values["late"] for each in early] == [SPEED, PRESSURES, PRESSURES, PRESSURES]


@pytest.mark.parametrize(("values", "fitted", "size"), [
    ({"ahead": 0.06, "behind": 0.0}, None, 0.06), ({"ahead": 0.0, "behind": 0.06}, None, -0.06),
    ({"ahead": 0.06, "behind": 0.0}, -0.02, -0.02), ({"ahead": 0.06, "behind": 0.0, "by_time": 1.0}, None, 0.03),
    ({"ahead": 0.06, "behind": 0.0, "by_time": 1.0}, 0.02, 0.01),
])  # fmt: skip
def test_a_suspects_size_is_as_fitted_or_as_its_shape_has_it_in_the_middle_of_a_run(values, fitted, size):
    slot = Slot("signal_delay", "", (0,), origin=(None, Shape("", values)))
    cross = SimpleNamespace(size=lambda *_: fitted)
    explained = SimpleNamespace(slots=(slot,) if fitted is not None else ())
    assert delay._size(slot, cross, explained, 50.0) == pytest.approx(size)


# -- a delay that changes within a run
TAU = {"buffer": 17.0, "backlog": 30.0, "settles": 30.0, "stays": None, "clock": None}
HOW = {"buffer": "fills_in", "backlog": "drains_in", "settles": "settles_in"}


def logged(kind, late, seconds=200.0, seed=1, used=None):
    """A run whose torque swings as a crane in waves does, and the gap that a delay of 0.12 s of this kind leaves."""
    time = np.arange(0.0, seconds, 0.02)
    rng = np.random.default_rng(seed)
    torque = sum(40.0 * np.sin(2.0 * np.pi * (time / period + rng.random())) for period in (6.1, 8.3, 11.7))
    share = {
        "buffer": (time / 17.0) % 1.0, "backlog": np.exp(-time / 30.0), "settles": 1.0 - np.exp(-time / 30.0),
        "stays": np.ones_like(time), "clock": time / seconds,
    }[kind]  # fmt: skip
    sign = 1.0 if late == SPEED else -1.0
    gap = np.interp(time + sign * 0.12 * share, time, torque) - torque + rng.normal(0.0, 1.0, len(time))
    used = np.ones(len(time), bool) if used is None else used(time)
    return SimpleNamespace(
        name="run", time=time, gap=np.where(used, gap, 1e6), used=used, predicted=torque, from_speed=torque
    )


LATE_BY = {"buffer": {"buffer": 1.0}, "backlog": {"backlog": 1.0}, "settles": {"delay": 1.0, "backlog": -1.0}}


@pytest.mark.parametrize(("late", "sign"), [(SPEED, 1.0), (PRESSURES, -1.0)])
@pytest.mark.parametrize("kind", HOW)
def test_how_a_delay_changes_is_told_by_its_time_constant(kind, late, sign):
    """From a first estimate of half of it; what is not used does not count."""
    runs = [logged(kind, late, seed=k, used=lambda time: np.abs(time - 90.0) > 20.0) for k in range(3)]
    shapes = delay._changing(runs, sign * 0.06)
    assert [each.values["late"] for each in shapes] == [late] * 3
    near = 2e-3 if kind == "buffer" else 0.12  # half a step of the grid, and noise
    assert [each.values[HOW[kind]] for each in shapes] == pytest.approx([TAU[kind]] * 3, rel=near)
    first, *others = (each.values["delay"] * sign for each in shapes)
    assert first == pytest.approx(0.12, rel=0.1)
    assert [each / first for each in others] == pytest.approx([0.8, 1.25])
    side = "speed" if late == SPEED else "pressures"
    by = {"buffer": " by a buffer", "backlog": " by a backlog", "settles": " more and more"}[kind]
    assert shapes[0].label.startswith(f"{side} late{by}, looked at with 1")
    end = {"buffer": "when full, every", "backlog": "at first, worked off over", "settles": "in the end, after some"}
    assert f" ms {end[kind]} " in shapes[0].label
    of = "signal" if late == SPEED else "pressure"
    found = {each.name: each for each in delay._without(shapes[0], FrictionModel("m", (), ())).corrections}
    assert {name: each.value for name, each in found.items()} == {
        f"{of}_{name}": pytest.approx(share * first) for name, share in LATE_BY[kind].items()
    }
    assert {name: each.time_constant for name, each in found.items()} == {
        f"{of}_{name}": None if name == "delay" else shapes[0].values[HOW[kind]] for name in LATE_BY[kind]
    }


def test_what_is_late_does_not_change_as_what_seems_early_would():
    assert delay._changing([logged("buffer", SPEED, seed=k) for k in range(3)], -0.06) == []


def test_how_a_delay_changes_is_told_by_the_training_runs_and_anew_by_others(monkeypatch):
    looked, told = [], []
    monkeypatch.setattr(delay, "_changing", lambda runs, size: looked.append([run.name for run in runs]) or [])
    monkeypatch.setattr(delay, "_gaps_without", lambda given, ways: told.append(len(ways)) or {})
    runs = [SimpleNamespace(name=name, time=TIME) for name in ("a", "b", "c")]
    given = SimpleNamespace(prepared=runs, once=Asked(monkeypatch).once)
    suspect = Slot(
        delay.DELAY, "late", (0,), origin=(None, Shape("late", {"ahead": SIZE, "behind": 0.0, "late": SPEED}))
    )
    for train in (("a", "b"), ("b", "c"), ("a", "b")):
        delay.without_delay(given, [], suspect, None, SimpleNamespace(slots=()), train)
    assert looked == [["a", "b"], ["b", "c"]]
    assert told == [3]  # what hangs on no training runs is told once
    monkeypatch.setattr(delay, "_changing", lambda runs, size: [delay._shape(size, SPEED, fills_in=20.0)])
    for train in (("a", "c"), ("c",), ("a", "c")):
        delay.without_delay(given, [], suspect, None, SimpleNamespace(slots=()), train)
    assert told == [3, 1, 1]


def test_first_estimates_that_hardly_differ_begin_the_same(monkeypatch):
    """A search comes back to one delay with another estimate each time; to take each out of the runs takes seconds."""
    asked = Asked(monkeypatch)
    asked.shapes_of()
    count = len(asked.told)
    found, _ = asked.shapes_of(SIZE + 0.0009)
    assert len(asked.told) == count
    assert found.shapes([])[0].values["delay"] == pytest.approx(SIZE)
    asked.shapes_of(SIZE + 0.0011)
    assert len(asked.told) == 2 * count


@pytest.mark.parametrize("kind", ["stays", "clock"])
def test_a_delay_that_stays_or_grows_on_does_not_change_otherwise(kind):
    assert delay._changing([logged(kind, SPEED, seed=k) for k in range(3)], 0.1) == []


def test_a_buffer_that_is_not_seen_to_start_again_is_not_looked_for():
    """Emptied after 17 s, and that in one run and a half of it: of runs of 16 s it fills too seldom."""
    runs = [logged("buffer", SPEED, seconds=seconds) for seconds in (12.0, 40.0, 24.0)]
    assert delay._changing(runs, 0.06)[0].values["fills_in"] == pytest.approx(17.0, rel=0.05)
    short = [logged("buffer", SPEED, seconds=seconds) for seconds in (16.0, 16.0, 40.0)]
    assert all(each.values.get("fills_in", 0.0) < 14.0 for each in delay._changing(short, 0.06))
    assert delay._changing([logged("buffer", SPEED, seconds=5.0)], 0.06) == []


def test_of_a_long_log_its_beginning_tells_how_often_a_buffer_is_emptied():
    """An hour is looked at for as long as a test lasts: what comes later does not move what is found."""
    long = logged("buffer", SPEED, seconds=1500.0)
    long.gap[long.time > 600.0] = 1e6
    assert delay._changing([long], 0.06)[0].values["fills_in"] == pytest.approx(17.0, rel=2e-3)


def test_a_delay_that_changes_is_one_of_the_shapes_that_a_delay_may_have(monkeypatch):
    asked = Asked(monkeypatch)
    buffer = [delay._shape(0.2 * factor, SPEED, fills_in=20.0) for factor in delay.COARSELY]
    monkeypatch.setattr(delay, "_changing", lambda runs, size: buffer if [r.name for r in runs] == ["run"] else [])
    found, run = asked.shapes_of()
    assert found.shapes([])[-3:] == buffer
    assert asked.told[-1] == {"signal_buffer": pytest.approx(0.2)}  # its wire is told without it
    for each in buffer:
        np.testing.assert_allclose(found.columns(run, each.values), 1.0)


# -- a delay that is there for a part of each run
def late_slots():
    def slot(label, law="", **values):
        return Slot(delay.DELAY, label, (0,), law=law, origin=(None, Shape(label, values)))

    return [
        slot("speed 50", ahead=0.05, behind=0.0, late=SPEED), slot("speed", ahead=0.1, behind=0.0, late=SPEED),
        slot("pressures", ahead=0.0, behind=0.1, late=PRESSURES),
        slot("other", "a law", ahead=0.1, behind=0.0, late=SPEED),
        Slot("churning", "", (0,), origin=(None, Shape(""))),
    ]  # fmt: skip


def passing(kind, late, excess=1.0, train=("run",), more=(), noise=0.0):
    runs = [logged(kind, late, seed=k) for k in range(2)]
    for run in runs:
        run.gap = run.gap + noise * np.random.default_rng(9).normal(0.0, 1.0, len(run.gap))
    cross = SimpleNamespace(excess=lambda base: excess, problem=SimpleNamespace(slots=late_slots()))
    found = passing_delay(SimpleNamespace(prepared=[*runs, *more]), train, cross, SimpleNamespace(base=None))
    return found and found.label


@pytest.mark.parametrize(("late", "label"), [(SPEED, "speed"), (PRESSURES, "pressures")])
def test_a_delay_that_is_there_for_a_part_of_each_run_is_suspected_of_the_side_that_is_late(late, label):
    assert passing("backlog", late) == label
    assert passing("backlog", late, noise=6.0) is None  # a small part of what the base leaves
    assert passing("backlog", late, excess=0.3) is None  # nothing is missing
    assert passing("stays", late) is None  # others suspect it


def test_a_passing_delay_is_told_by_the_training_runs():
    locked = logged("backlog", SPEED, seed=5)
    locked.name = "locked"
    assert passing("stays", SPEED, more=[locked]) is None
    still = [logged("stays", SPEED, seed=k) for k in range(3)]
    for run in still:
        run.gap, run.name = run.gap * 100.0, "locked"
    assert passing("backlog", SPEED, more=still) == "speed"


# -- a delay by a course that the data draw
WANDERED = ((0.0, 0.3), (35.0, 0.0), (70.0, 1.0), (95.0, 0.9), (140.0, 0.1), (200.0, 0.5))


def wandering(late, seed, course=WANDERED, size=0.12):
    """The same run with a delay that no known course describes."""
    run = logged("stays", late, seed=seed)
    sign = 1.0 if late == SPEED else -1.0
    share = np.interp(run.time, *np.transpose(course))
    noise = np.random.default_rng(seed + 100).normal(0.0, 1.0, len(run.time))
    run.gap = np.interp(run.time + sign * size * share, run.time, run.predicted) - run.predicted + noise
    return run


@pytest.mark.parametrize(("late", "sign"), [(SPEED, 1.0), (PRESSURES, -1.0)])
def test_a_delay_of_no_known_course_is_drawn(late, sign):
    shapes = delay._changing([wandering(late, seed) for seed in range(4)], 0.06 * sign)
    assert [each.values["late"] for each in shapes] == [late] * 3
    (own,) = delay._without(shapes[0], FrictionModel("m", (), ())).corrections
    assert own.name == ("signal_course" if late == SPEED else "pressure_course")
    time, share = np.transpose(own.course)
    assert time == pytest.approx(shapes[0].values["drawn_in"] * np.arange(len(time)))
    assert 190.0 < time[-1] < 250.0
    at = np.linspace(0.0, 190.0, 40)
    drawn, true = own.value * np.interp(at, time, share), 0.12 * np.interp(at, *np.transpose(WANDERED))
    assert np.sqrt(np.mean((drawn - true) ** 2)) < 0.01
    assert shapes[0].label.startswith(f"{'speed' if late == SPEED else 'pressures'} late by a course of its own")
    assert f"ms at most, by points {shapes[0].values['drawn_in']:.3g} s apart" in shapes[0].label


def test_a_course_is_no_ones_where_every_run_has_another():
    """Drawn from one half of the runs it tells nothing of the others."""
    turned = [tuple((time, share[k]) for time, share in zip((0.0, 50.0, 100.0, 150.0, 200.0), (
        (0.0, 1.0), (1.0, 0.0), (0.0, 1.0), (1.0, 0.0), (0.0, 1.0)), strict=True)) for k in (0, 1)]  # fmt: skip
    alike = [wandering(SPEED, seed, turned[0]) for seed in range(4)]
    assert "drawn_in" in delay._changing(alike, 0.06)[0].values
    runs = [wandering(SPEED, seed, turned[seed % 2]) for seed in range(4)]
    assert all("drawn_in" not in each.values for each in delay._changing(runs, 0.06))
    assert all("drawn_in" not in each.values for each in delay._changing(alike[:1], 0.06))


def test_nothing_but_noise_has_no_course():
    for seed in range(20):
        runs = [wandering(SPEED, 10 * seed + k, size=0.0) for k in range(4)]
        assert all("drawn_in" not in each.values for each in delay._changing(runs, 0.06)), seed
