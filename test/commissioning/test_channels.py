"""Every channel by itself: the clock, a pressure that nobody measured, and what lies beyond the machine."""

from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.api.work import simulate
from winch_friction.commissioning.balance import top
from winch_friction.commissioning.channels import (
    FIRST_READINGS,
    clock_findings,
    frozen_findings,
    reading_findings,
    runs_say,
    told_slow_clock,
    uneven_once,
)
from winch_friction.commissioning.check import quick_check
from winch_friction.commissioning.commissioning import check
from winch_friction.commissioning.excitation import Taught
from winch_friction.commissioning.kinematics import excesses, range_score
from winch_friction.commissioning.summaries import channel_findings
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import Run
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model


def said(time):
    return {each.cause: each.severity for each in clock_findings(Run("r", {"time": time}))}


def test_a_clock_that_jumps_by_days_is_an_error_and_an_even_one_is_nothing():
    even = np.arange(500) * 0.02
    assert said(even) == {}
    assert said(np.concatenate([even, even + 86400.0])) == {"clock": "error"}


@pytest.mark.parametrize(("unit", "factor"), [("ms", 1e3), ("us", 1e6), ("ns", 1e9)])
def test_a_unix_time_in_another_unit_than_s_is_named(unit, factor):
    time = 1743911276.344 + np.arange(500) * 0.02
    assert said(time) == {}
    (found,) = clock_findings(Run("r", {"time": factor * time}))
    assert (found.severity, found.cause, found.channel) == ("error", "unit", "time")
    assert f"time holds {unit} under [s]" in found.sentence
    assert found.sentence.endswith(f"0.02 s; write 'time [{unit}]'")


def test_a_run_whose_time_is_in_another_unit_is_left_out_of_the_balance(monkeypatch, crane_150t):
    """Its accelerations are nobody's; the others are balanced without it."""
    even = {"time": np.arange(9.0), "motor_speed": np.ones(9)}
    runs = [Run("one", even), Run("in ms", even | {"time": 1.7e12 + 20.0 * np.arange(9.0)}), Run("two", even)]

    def views_of(pairs):
        raise InputError(" ".join(run.name for run, _ in pairs))

    monkeypatch.setattr("winch_friction.commissioning.check.views_of", views_of)
    with pytest.raises(InputError, match="^one two$"):
        quick_check(runs, crane_150t)


def test_a_time_in_ms_from_any_origin_shows_in_the_rates_that_other_channels_tell():
    run = Run("r", {"time": np.arange(500) * 20.0})
    (found,) = told_slow_clock(run, {"wire_out": 1.3e-3, "heave_velocity": 1.0})
    assert "time holds ms under [s]: wire_out tells 0.0013 times the speed, and" in found.sentence
    assert not list(told_slow_clock(run, {"wire_out": 1.0}))
    assert not list(told_slow_clock(Run("r", {"time": np.arange(500) * 0.02}), {"wire_out": 1e-3}))  # km under [m]


@pytest.mark.parametrize(("rate", "found"), [(4.0, {"rate": "warning"}), (6.0, {})])
def test_a_log_too_slow_for_reversals_is_worth_a_word(rate, found):
    assert said(np.arange(100) / rate) == found
    for each in clock_findings(Run("r", {"time": np.arange(100) / rate})):  # samples a second, for machines too
        assert each.evidence == {"rate": pytest.approx(rate)}


@pytest.mark.parametrize(
    ("share", "deep", "told"),
    [(0.1, -0.08, True), (0.01, -0.08, False), (0.1, -0.04, False), (1.0, -0.08, False)],
)
def test_strokes_over_centre_are_told_as_the_nodes_see_them(share, deep, told):
    """They were plausible to `check`, and lost inputs to both nodes; throughout it is a sign, which is told as one."""
    crane = load_crane("crane_150t")
    strokes = np.where(np.arange(500) < 500 * share, deep, 0.6) * crane.max_displacement
    run = Run("r", {"time": np.arange(500) * 0.02, "main.pressure_a": strokes, "main.displacement": strokes})
    found = [each for each in reading_findings([run], crane) if each.cause == "over_centre"]
    assert [(each.severity, each.channel) for each in found] == [("error", "main.displacement")] * told
    for each in found:
        assert each.sentence.startswith("r: main.displacement is over centre, to -17.2 cm^3/rev: below -10.75 cm^3/rev")
        assert each.cause in FIRST_READINGS


def test_a_gap_and_an_uneven_clock_are_said():
    assert said(np.concatenate([np.arange(100) * 0.02, 5.0 + np.arange(100) * 0.02])) == {"gaps": "note"}
    assert said(np.cumsum(np.resize([0.02, 0.02, 0.02, 0.04], 400))) == {"jitter": "warning"}


@pytest.mark.parametrize(("off", "found"), [(0.25, {}), (0.35, {"jitter": "warning"}), (0.55, {"jitter": "warning"})])
def test_a_clock_is_uneven_where_a_step_in_ten_is_a_third_off(off, found):
    """Every fourth step of 20 ms is longer by that share of it."""
    assert said(np.cumsum(np.resize([0.02, 0.02, 0.02, 0.02 * (1.0 + off)], 400))) == found


def test_the_clock_of_every_run_is_looked_at():
    crane = load_crane("crane_150t")
    steps = {"a": np.full(400, 0.02), "b": np.resize([0.02, 0.02, 0.02, 0.04], 400)}
    rest = {"motor_speed": 0.0, "hook_load": 0.0, "main.pressure_a": 30e5, "main.pressure_b": 30e5,
            "main.displacement": crane.max_displacement}  # fmt: skip
    still = {name: np.full(400, value) for name, value in rest.items()}
    runs = [Run(name, {"time": np.cumsum(own), **still}) for name, own in steps.items()]
    assert [each.runs for each in quick_check(runs, crane) if each.cause == "jitter"] == [("b",)]


def test_an_uneven_clock_of_many_runs_is_said_once():
    """A logger that is uneven is so in every run: a line for each buries what else there is to say."""
    steps = np.resize([0.02, 0.02, 0.02, 0.04], 400)
    runs = [Run(name, {"time": np.cumsum(steps) * (1.0 + k)}) for k, name in enumerate("abc")]
    even = Run("d", {"time": np.arange(500) * 0.02})
    each = [found for run in (*runs, even) for found in clock_findings(run)]
    (found,) = uneven_once(each, 4)
    assert (found.severity, found.cause, found.runs) == ("warning", "jitter", ("a", "b", "c"))
    assert (
        found.sentence == "3 of 4 runs (a, b, c) have an uneven clock: one step in ten is 100 % or more off the usual"
    )
    assert uneven_once(each[:1], 4) == each[:1]
    assert uneven_once([], 4) == []


def frozen(held, other, displacement=(3e-5, 3e-5)):
    time = np.arange(200) * 0.1
    moved = np.linspace(0.0, 1e5, 200)
    columns = {
        "time": time, "motor_speed": 50.0 * np.sin(time),
        "main.pressure_a": 2e7 + held * moved, "main.pressure_b": 2e6 + other * moved,
        "main.displacement": np.linspace(*displacement, 200),
    }  # fmt: skip
    return [each.channel for each in frozen_findings(Run("r", columns))]


def test_the_pressure_that_holds_the_load_must_move_and_the_boost_need_not():
    assert frozen(0.0, 1.0) == ["main.pressure_a"]
    assert frozen(1.0, 0.0) == []
    assert frozen(0.0, 1.0, displacement=(2e-5, 3e-5)) == []  # the torque may be controlled by the displacement


def view(displacement=3e-5, drop=1e7, speed=100.0):
    group = SimpleNamespace(
        drop=np.full(9, drop), pressure_sum=np.full(9, 3e7), displacement=np.full(9, displacement), torque=np.zeros(9)
    )
    return SimpleNamespace(
        heave=None, groups={"main": group}, speed=np.full(9, speed), max_displacement=3.4e-5, rated_torque=1e4,
        load=np.zeros(9), radius=np.ones(9), gear_ratio=250.0, load_torque=None, lever=np.full(9, 4e-3), wire=None,
        time=np.arange(9.0),
    )  # fmt: skip


@pytest.mark.parametrize(
    ("changed", "channel"),
    [
        ({}, None),
        ({"displacement": 3e-7}, "main.displacement"),  # per cent read as a share
        ({"displacement": 3e-4}, "main.displacement"),
        ({"drop": 1e9}, "main.pressure"),
        ({"speed": 955.0}, "motor_speed"),
    ],
)
def test_what_the_machine_cannot_do_is_told_by_channel(changed, channel):
    found = excesses(view(**changed))
    assert list(found) == ([channel] if channel else [])
    assert (range_score(view(**changed)) > 0.0) == bool(channel)


@pytest.mark.parametrize(("after", "words"), [(0.05, "much"), (0.07, "a little"), (0.095, "nothing"), (0.1, "nothing")])
def test_what_runs_teach_is_what_they_take_off_the_models_own_sigma(after, words):
    assert Taught("C5", 0.1, after).words == words


def test_one_run_fits_and_several_fit():
    assert runs_say(("a.csv",), 1, "fit") == "run a.csv fits"
    assert runs_say(("a.csv",), 3, "leave") == "1 of 3 runs (a.csv) leaves"
    assert runs_say(("a", "b"), 2, "say") == "all 2 runs say"


def merged(pause):
    """Two minutes of a shipped scenario in one file, the second so many s after the first."""
    crane, model = load_crane("crane_150t"), load_model("a6vm215_crane2")
    one, other = (simulate("ahc_55t_215", crane, model, seed=seed, duration=60.0).run for seed in (1, 2))
    columns = {name: np.concatenate([one[name], other[name]]) for name in one.columns}
    columns["time"] = np.concatenate([one.time, other.time + pause])
    return crane, Run("merged.csv", columns)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("pause", [3600.0, 90000.0, 2.0 * 86400.0])
def test_recordings_of_several_days_in_one_file_are_looked_at_one_by_one(pause):
    """Block means over days were of minutes each: nothing moved in them, or the clock was said to jump."""
    crane, run = merged(pause)
    assert not any(each.contradicts for each in quick_check([run], crane))
    found = check([run], crane)
    assert found.sentence == "plausible: 2 runs of crane 'crane_150t' close the torque balance"
    assert any("looked at as 2 runs" in each.sentence for each in found.findings)
    assert not any("stands still" in each.sentence for each in found.findings)


@pytest.mark.filterwarnings("error")
def test_a_run_without_a_number_in_its_speed_warns_of_nothing():
    assert top(np.full(5, np.nan)) == 0.0
    assert top(np.array([np.nan, 3.0, 3.0])) == 3.0


@pytest.mark.parametrize(("during", "stuck"), [(0.0, []), (20.0, ["shaft_angle"])])
def test_an_angle_that_stands_with_the_winch_is_not_stuck(during, stuck, crane_150t):
    """Every joystick cycle that ended in a rest of 3 s was warned of."""
    time = np.arange(0.0, 40.0, 0.02)
    rest = (time > 15.0) & (time < 20.0)
    speed = np.where(rest, during, 30.0 + np.sin(time))
    angle = np.cumsum(np.where(rest, 0.0, speed)) * 0.02
    found = channel_findings(Run("r", {"time": time, "motor_speed": speed, "shaft_angle": angle}))
    assert [each.channel for each in found if each.cause == "stuck" and each.channel == "shaft_angle"] == stuck


@pytest.mark.parametrize(("digit", "coarse"), [(0.0, False), (1e-4, False), (0.05, True), (0.1465, True)])
def test_a_channel_has_steps_where_its_changes_share_one_and_noise_has_none(digit, coarse):
    """Of white noise of 0.2 bar `check` said that it has steps of 0.0175 bar, 82 over its range."""
    values = 20.0 + np.random.default_rng(7).normal(0.0, 0.2, 5000)
    values = np.round(np.round(values / digit) * digit, 4) if digit else values
    run = Run("r", {"time": 0.02 * np.arange(5000), "main.pressure_b": 1e5 * values})
    notes = [each.sentence for each in channel_findings(run) if each.cause == "quantisation"]
    assert [each.partition(" has steps of ")[2].partition(" bar")[0] for each in notes] == [f"{digit:.4g}"] * coarse
