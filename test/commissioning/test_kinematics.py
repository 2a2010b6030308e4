"""Do the other channels agree with the speed: sign, size and time of each."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.commissioning.balance import top
from winch_friction.commissioning.check import quick_check
from winch_friction.commissioning.diagnose import _Bench
from winch_friction.commissioning.kinematics import LATE, MOST, SURE, agreements, score_of, ways
from winch_friction.commissioning.mistakes import delayed
from winch_friction.commissioning.view import view_of
from winch_friction.simulation import load_scenario, simulate

TIME = np.arange(300) * 0.2
SPEED = 100.0 * np.sin(0.8 * TIME) + 40.0 * np.sin(2.1 * TIME + 1.0)
LEVER = 0.004
GEAR = 160.0


def score(channel, rate, must_follow=()):
    view = SimpleNamespace(speed=SPEED, lever=LEVER, gear_ratio=GEAR, rates={channel: rate})
    found = agreements(view, must_follow)
    return (found[0].ratio, found[0].score) if found else None


def test_a_channel_that_tells_the_same_speed_costs_nothing():
    assert score("shaft_angle", SPEED) == pytest.approx((1.0, 0.0))
    assert score("wire_out", LEVER * SPEED) == pytest.approx((1.0, 0.0))
    assert score("drum_speed", SPEED / GEAR) == pytest.approx((1.0, 0.0))


def test_the_opposite_sign_is_a_flat_contradiction():
    assert score("shaft_angle", -SPEED) == pytest.approx((-1.0, MOST))


def test_another_size_counts_in_ordinary_errors_of_the_channel():
    assert score("shaft_angle", 1.03 * SPEED)[1] == pytest.approx(1.0, rel=0.05)
    assert score("speed_reference", 1.12 * SPEED)[1] == pytest.approx(1.0, rel=0.15)
    assert score("shaft_angle", 60.0 * SPEED)[1] == MOST
    assert score("drum_speed", SPEED / (0.75 * GEAR))[1] > SURE


@pytest.mark.parametrize("lag", [3, -3])
def test_a_channel_that_fits_only_when_it_is_shifted_is_late(lag):
    assert score("speed_reference", np.roll(SPEED, lag))[1] >= LATE


def test_one_late_channel_is_a_hint_and_a_second_names_the_mistake():
    late = score("shaft_angle", np.roll(SPEED, 3))[1]
    assert late < SURE <= 2.0 * late


def test_a_channel_that_does_not_follow_is_left_out_unless_it_must():
    noise = np.random.default_rng(0).standard_normal(300)
    assert score("heave_velocity", noise) is None
    assert score("heave_velocity", noise, ("heave_velocity",))[1] == MOST


@pytest.mark.parametrize(("seconds", "said"), [(0.3, "motor_speed is late"), (-0.3, "the drive's torque is late")])
def test_a_drive_without_oil_has_no_pressures_that_are_late(seconds, said):
    assert delayed(seconds, hydraulic=False).words.startswith(said)
    assert "pressures" not in delayed(seconds, hydraulic=False).words
    assert "pressures" in delayed(seconds).words


def test_what_is_looked_up_is_what_it_would_be_computed_anew(crane_150t, crane2_model):
    """A view that shares with a known one all but one of what its agreements rest on has agreements of its own."""
    run = simulate(load_scenario("ahc_irregular").override({"duration": 30.0}), crane_150t, crane2_model, seed=3).run
    view = view_of(run, crane_150t)
    bench = _Bench([view], np.array([0.0]), crane2_model)
    rates = {name: 1.3 * rate for name, rate in view.rates.items()}
    changes = (
        {}, {"load": 2.0 * view.load}, {"speed": 1.3 * view.speed}, {"rates": rates}, {"radius": 1.3 * view.radius},
        {"gear_ratio": 1.3 * view.gear_ratio},
    )  # fmt: skip
    assert {"wire_out", "speed_reference"} <= set(rates)
    scores = [
        (bench.score(changed), score_of(changed, crane2_model)) for changed in (replace(view, **c) for c in changes)
    ]
    for found, anew in scores:
        assert found == anew


def test_the_top_of_a_channel_is_numpys_percentile_to_the_last_digit():
    draw = np.random.default_rng(5)
    for size in (1, 2, 3, 51, 52, 100, 101, 333):
        values = np.concatenate([draw.normal(size=size), [np.nan, np.inf]])
        assert top(values) == np.percentile(np.abs(values[:size]), 99)
    assert top(np.array([np.nan])) == 0.0


def test_a_drum_speed_beside_the_motors_is_held_against_the_gear(crane_150t, crane2_model):
    """It was kept and compared with nothing: a crane file with another gear ratio passed."""
    run = simulate(load_scenario("normal_joystick"), crane_150t, crane2_model, seed=1).run
    drum = run["motor_speed"] / crane_150t.gear_ratio
    for factor, said in ((1.0, 0), (1.4, 1), (-1.0, 1)):
        both = replace(run, columns={**run.columns, "drum_speed": factor * drum})
        found = [each for each in quick_check([both], crane_150t, crane2_model) if each.channel == "drum_speed"]
        assert len(found) == said
    turned = {name: -run[name] for name in ("motor_speed", "speed_reference", "shaft_angle") if name in run}
    flipped = replace(run, columns={**run.columns, **turned, "drum_speed": -drum})
    found = quick_check([flipped], crane_150t, crane2_model)[0]
    assert found.cause == "sign"
    assert found.evidence["misfit_after"] < 0.5 * MOST  # nothing else is amiss


def test_the_way_of_a_coarse_wire_tells_a_clock_a_thousand_times_too_slow(crane_150t, crane2_model):
    """A log in ms under [s] whose wire is counted coarsely was plausible."""
    run = simulate(load_scenario("normal_joystick"), crane_150t, crane2_model, seed=1).run
    wire = np.round(2.0 * run["wire_out"]) / 2.0
    columns = {name: run[name] for name in run.columns if name not in ("shaft_angle", "speed_reference")}
    late = replace(run, columns={**columns, "wire_out": wire, "time": 1e3 * run.time})
    assert ways(replace(late, columns={**late.columns, "time": run.time}), crane_150t)["wire_out"] == pytest.approx(
        1.0, abs=0.2
    )
    found = quick_check([late], crane_150t, crane2_model)[0]
    assert (found.contradicts, found.channel) == (True, "time")
    assert "ms under [s]" in found.sentence
