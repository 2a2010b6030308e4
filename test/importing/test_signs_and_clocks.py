"""Signs and ports that only the physics tells, on a log of twelve columns; and signals put on one clock, by hand."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from winch_friction.importing import one_clock
from winch_friction.importing.draft import Draft
from winch_friction.importing.log import Log, number_column
from winch_friction.importing.mapping import Entry, LogMap
from winch_friction.importing.one_clock import Signal, column_of, of_one_length, on_one_clock
from winch_friction.importing.orientation import settle_orientation, speed_by_motion
from winch_friction.importing.ticks import fraction_unit, rows_of_one_tick, spread_ticks
from winch_friction.importing.time_base import TimeBase
from winch_friction.physics.channels import GRAVITY
from winch_friction.physics.winch.crane import POWER, Drive, Drum

TIME = np.arange(1500) * 0.05
SPEED = 100.0 * np.sin(0.4 * TIME)
ONE = np.ones(len(TIME))
WAY = np.concatenate([[0.0], np.cumsum(SPEED[1:] * np.diff(TIME))])  # rad
HELD, RUBS = 2000.0, 100.0  # N m; ten motors at 2e-5 m^3/rad give 20 N m per bar
UNITS = {
    "motor_speed": "rad/s", "speed_reference": "rad/s", "shaft_angle": "rad", "hook_load": "kg", "wire_out": "m",
    "heave_velocity": "m/s", "mechanical_power": "W", "main.pressure_a": "Pa", "main.pressure_b": "Pa",
    "main.displacement": "m^3/rad",
}  # fmt: skip


@pytest.fixture
def crane(crane_150t):
    return replace(crane_150t, gear_ratio=50.0, drum=Drum((0.5, 1.0)), groups={"main": 10}, max_displacement=2e-5)


def right():
    """A log that is right: what is held and friction, the wire and all that tells the speed again."""
    return {
        "motor_speed": SPEED,
        "main.pressure_a": 25e5 + (HELD + RUBS * np.sign(SPEED)) / 2e-4,
        "main.pressure_b": 25e5 * ONE,
        "main.displacement": 2e-5 * ONE,
        "hook_load": HELD * 50.0 / GRAVITY * ONE,
        "wire_out": 400.0 - WAY / 50.0,
        "speed_reference": SPEED,
        "shaft_angle": WAY,
    }


def settled(crane, columns, said=(), signs=None, names=None):
    """The draft of a log whose columns bear names that tell nothing, once signs and ports are settled."""
    names = {channel: f"col{k}" for k, channel in enumerate(columns)} | (names or {})
    numbers = [number_column(names[channel], values) for channel, values in columns.items()]
    log = Log(Path("log.csv"), (number_column("t", TIME, "s"), *numbers), {}, str)
    entries = {c: Entry(names[c], UNITS[c], sign=(signs or {}).get(c, 1), confidence=0.8) for c in columns}
    draft = Draft([log], crane, LogMap(entries, ("t",), TimeBase("seconds", "s")))
    settle_orientation(draft, frozenset(said))
    return draft


def signs_of(draft):
    return {channel for channel, entry in draft.log_map.columns.items() if entry.sign == -1}


def ports_of(draft):
    return [int(draft.log_map.columns[f"main.pressure_{port}"].source[3:]) for port in "ab"]


def test_a_log_that_is_right_stays_as_it_is(crane):
    draft = settled(crane, right())
    assert signs_of(draft) == set()
    assert ports_of(draft) == [1, 2]
    assert draft.questions == []


@pytest.mark.parametrize("channel", ["hook_load", "main.displacement", "speed_reference", "shaft_angle"])
def test_what_counts_the_other_way_is_turned_alone(channel, crane):
    draft = settled(crane, {**right(), channel: -right()[channel]})
    assert signs_of(draft) == {channel}
    assert ports_of(draft) == [1, 2]
    assert "sign turned" in draft.log_map.columns[channel].because


def test_a_log_of_paying_out_has_all_that_tells_the_speed_turned(crane):
    turned = {name: -right()[name] for name in ("motor_speed", "speed_reference", "shaft_angle")}
    assert signs_of(settled(crane, {**right(), **turned})) == set(turned)


def test_a_second_speed_that_a_sign_had_turned_is_turned_back(crane):
    draft = settled(crane, right(), signs={"speed_reference": -1})
    assert draft.log_map.columns["speed_reference"].sign == 1


@pytest.mark.parametrize("channel", ["motor_speed", "speed_reference"])
def test_what_the_person_said_stays(channel, crane):
    draft = settled(crane, {**right(), channel: -right()[channel]}, said=[channel])
    assert draft.log_map.columns[channel].sign == 1


def test_without_a_wire_friction_tells_the_speeds_sign(crane):
    columns = right()
    del columns["wire_out"], columns["speed_reference"], columns["shaft_angle"]
    assert signs_of(settled(crane, columns)) == set()
    assert signs_of(settled(crane, {**columns, "motor_speed": -SPEED})) == {"motor_speed"}
    untold = settled(crane, {**columns, "main.pressure_a": 25e5 + HELD / 2e-4 + 1e5 * np.cos(3.0 * TIME)})
    assert signs_of(untold) == set()
    assert untold.log_map.columns["motor_speed"].confidence == pytest.approx(0.9 * 0.8)


def test_a_name_of_paying_out_tells_the_sign_by_itself(crane):
    draft = settled(crane, right(), names={"motor_speed": "payout_speed"})
    assert "motor_speed" in signs_of(draft)
    assert "the name says" in draft.log_map.columns["motor_speed"].because


def test_a_load_that_is_negative_at_times_was_not_tared(crane):
    load = right()["hook_load"] * np.where(TIME < 20.0, -0.01, 1.0)
    assert "hook_load" not in signs_of(settled(crane, {**right(), "hook_load": load}))


def test_swapped_ports_are_told_by_the_load(crane):
    columns = right()
    a, b = columns["main.pressure_a"], columns["main.pressure_b"]
    assert ports_of(settled(crane, {**columns, "main.pressure_a": b, "main.pressure_b": a})) == [2, 1]
    named = settled(crane, {**columns, "main.pressure_a": b, "main.pressure_b": a},
                    names={"main.pressure_a": "main.pressure_a", "main.pressure_b": "main.pressure_b"})  # fmt: skip
    assert named.log_map.columns["main.pressure_a"].source == "main.pressure_a"  # the name has told it


@pytest.mark.parametrize(("gain", "sign", "sure"), [(1.0, 1, 0.8), (-1.0, -1, 0.8), (0.35, 1, 0.8), (-0.35, -1, 0.8),
                                                    (0.2, 1, 0.7 * 0.8), (-0.2, 1, 0.7 * 0.8)])  # fmt: skip
def test_a_power_that_lifts_is_positive(gain, sign, sure, crane):
    by_power = replace(crane, drive=Drive(POWER), groups={"motor": 1})
    columns = {"motor_speed": SPEED, "hook_load": right()["hook_load"], "wire_out": right()["wire_out"],
               "mechanical_power": gain * HELD * SPEED}  # fmt: skip
    entry = settled(by_power, columns).log_map.columns["mechanical_power"]
    assert (entry.sign, entry.confidence) == (sign, pytest.approx(sure))


@pytest.mark.parametrize(("factor", "unit"), [(1.0, "rad/s"), (-1.0, "rad/s"), (30.0 / np.pi, "rpm"), (3.0, None)])
def test_a_speed_that_no_name_says_is_the_column_whose_sum_follows_the_wire(factor, unit, crane):
    columns = {c: right()[c] for c in ("wire_out", "hook_load")}
    log = Log(Path("log.csv"), (number_column("t", TIME, "s"), number_column("a", columns["wire_out"]),
                                number_column("b", columns["hook_load"]), number_column("x", np.cos(TIME)),
                                number_column("y", factor * SPEED)), {}, str)  # fmt: skip
    entries = {"wire_out": Entry("a", "m"), "hook_load": Entry("b", "kg")}
    draft = Draft([log], crane, LogMap(entries, ("t",), TimeBase("seconds", "s")))
    speed_by_motion(draft, crane)
    found = draft.log_map.columns.get("motor_speed")
    assert (found and (found.source, found.unit, found.confidence)) == (unit and ("y", unit, 0.6))


# -- one clock
def test_signals_are_held_at_their_latest_value_or_drawn_as_lines():
    slow = Signal("slow", np.array([10.0, 20.0]), times=np.array([1.0, 3.0]))
    base = np.array([0.5, 1.0, 2.0, 3.0, 9.0])
    np.testing.assert_array_equal(column_of("slow", slow, base).values, [np.nan, 10.0, 10.0, 20.0, 20.0])
    np.testing.assert_array_equal(column_of("slow", slow, base, lines=True).values, [np.nan, 10.0, 15.0, 20.0, 20.0])
    np.testing.assert_array_equal(column_of("slow", slow).values, [10.0, 20.0])


def test_the_densest_clock_counts_and_who_has_another_is_counted():
    dense = Signal("dense", np.arange(100.0), "bar", np.arange(100) * 0.1, "a note")
    slow = Signal("slow", np.arange(10.0), "t", np.arange(10.0))
    columns, notes = on_one_clock([slow, dense])
    assert [(each.name, each.unit, each.note) for each in columns] == [
        ("time", "s", ""), ("slow", "t", ""), ("dense", "bar", "a note"),
    ]  # fmt: skip
    np.testing.assert_array_equal(columns[0].values, dense.times)
    np.testing.assert_array_equal(columns[1].values, np.floor(dense.times + 1e-9))
    assert notes == ["1 signals have times of their own: held at their latest value on the times of the densest"]


def test_a_signal_that_says_nothing_for_long_is_told_with_where():
    dense = Signal("dense", np.arange(400.0), times=5.0 + np.arange(400) * 0.1)
    gap = np.concatenate([np.arange(10.0), [17.0, 18.0, 19.0]])
    _, notes = on_one_clock([dense, Signal("slow", gap, times=6.0 + gap)])
    assert notes[1] == (
        "signals that say nothing for long, their last value held: slow for 19.9 s, 19 s after its first value"
    )
    end = np.concatenate([np.arange(10.0), 20.0 + np.arange(19.0)])
    _, notes = on_one_clock([dense, Signal("slow", end, times=6.0 + end)])
    assert notes[1].endswith("slow for 11 s, 9 s after its first value")


def test_of_arrays_without_times_those_of_the_usual_length_are_kept():
    def lengths(*sizes):
        columns, notes = of_one_length([Signal(f"s{k}", np.arange(float(n))) for k, n in enumerate(sizes)])
        return [len(each.values) for each in columns], notes

    assert lengths(3, 5, 3) == ([3, 3], ["arrays of another length than 3 left out: 's1 (5)'"])
    assert lengths(3, 5) == ([5], ["arrays of another length than 5 left out: 's0 (3)'"])  # as many: the longer
    assert lengths(4, 4) == ([4, 4], [])


@pytest.mark.parametrize(("times", "steady"), [
    (np.arange(50) * 0.1, True),
    (np.cumsum(np.tile([0.1, 0.29], 25)), True),
    (np.cumsum(np.tile([0.1, 0.31], 25)), False),
    (np.concatenate([np.arange(50) * 0.1, [99.0]]), True),  # one pause is a pause
])  # fmt: skip
def test_a_clock_whose_steps_are_within_three_times_each_other_is_steady(times, steady):
    assert one_clock.is_steady(times) == steady


def test_half_of_the_signals_that_leap_draw_lines():
    """One that leaps behind silences, one that climbs step by step: as many as not, so lines."""
    sparse = np.cumsum(np.tile([0.1, 0.1, 5.0], 10))
    leaping = Signal("corners", np.tile([0.0, 0.0, 10.0, 10.0, 10.0, 0.0], 5), times=sparse)
    ramp = np.concatenate([np.arange(6.0), np.arange(6.0)[::-1], np.arange(6.0), np.arange(6.0)[::-1]])
    climbing = Signal("ramp", ramp, times=np.concatenate([9.0 * k + np.arange(6) * 0.1 for k in range(4)]))
    assert one_clock.draws_lines([leaping])
    assert not one_clock.draws_lines([climbing])
    assert one_clock.draws_lines([leaping, climbing])
    assert not one_clock.draws_lines([leaping, climbing, climbing])


# -- ticks
def test_a_fraction_rises_within_a_second_and_starts_again():
    seconds = np.repeat(np.arange(5.0), 4)
    rising = np.tile([10.0, 260.0, 510.0, 760.0], 5)
    for most, unit in ((1e3, "ms"), (1e6, "us"), (1e9, "ns")):
        assert fraction_unit(seconds, number_column("f", rising * most / 1e3)) == unit
    for other in (
        np.arange(20.0) * 40.0,  # goes on over the seconds
        rising * 0.6,  # never comes near the whole
        rising[::-1],
        rising - 20.0,
        np.where(np.arange(20) == 3, np.nan, rising),
    ):
        assert fraction_unit(seconds, number_column("f", other)) == ""
    assert fraction_unit(seconds + 0.5, number_column("f", rising)) == ""


@pytest.mark.parametrize(("counts", "rows"), [
    ([1, 9, 11, 9, 11, 10, 2], 10.0),
    ([1, 9, 9, 9, 9, 9, 15, 2], 10.0),  # the mean of those between the first and the last
    ([5, 1, 1, 1, 1, 5], 1.0),
    ([2, 10, 30, 10, 30, 10, 2], 1.0),  # as they come
])  # fmt: skip
def test_the_rows_of_a_tick_are_their_mean_where_they_are_regular(counts, rows):
    assert rows_of_one_tick(np.repeat(np.arange(float(len(counts))), counts)) == pytest.approx(rows)


def test_rows_of_a_tick_lie_evenly_where_no_clock_is_steady():
    """Bursts of two and of eight: each within its own second; the first was joined late, the last is as the rest."""
    ticks = np.repeat(np.arange(6.0), [1, 2, 8, 2, 2, 1])
    found = spread_ticks(ticks)
    np.testing.assert_allclose(found[1:3], [1.0, 1.5])
    np.testing.assert_allclose(found[3:11], 2.0 + np.arange(8) / 8.0)
    assert (found[0], found[-1]) == (0.5, 5.0)
    backwards = np.array([0.0, 2.0, 1.0])
    assert spread_ticks(backwards) is backwards


def test_a_value_climbs_by_three_steps_or_more_that_follow_each_other_the_same_way():
    """One step is what a historian leaves of a leap, two of one sign are often noise."""
    steps = np.array([3.0, -3.0, 2.0, 2.0, -1.0, 2.0, 2.0, 2.0, -0.1, -0.1, -0.1, 4.0])
    assert one_clock._climbed(steps, np.ones(12, bool), 1.0) == pytest.approx(6.0)
    late = np.array([True] * 6 + [False] + [True] * 5)  # a silence within the three
    assert one_clock._climbed(steps, late, 1.0) == 0.0
