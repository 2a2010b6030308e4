"""A suspected delay as what the runs are without it: at five values, with a swing on the wire that is told once, and
as a filter that makes all or half of it."""

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy.candidates.candidate import Candidate, Shape
from winch_friction.discrepancy.candidates.signals import PRESSURES, SMALL_DELAY, SPEED, tau
from winch_friction.discrepancy.detectors import delay
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
    return SimpleNamespace(name="run", start=0.0, time=TIME, gap=gap, wire_mode=mode)


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
        (found,) = delay.without_delay(given, [own], suspect, None, SimpleNamespace(slots=()))
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
        for size in (80, 100, 125)
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
    assert sizes[0] == pytest.approx([0.07, 0.085, 0.1, 0.115, 0.13, 0.16, 0.2, 0.25])
    assert sizes[1] == sizes[2] == pytest.approx([0.08, 0.1, 0.125])
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
