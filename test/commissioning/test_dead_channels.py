"""A channel that nobody measured is named as that, not explained away by a unit, and proves nothing."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import winch_friction as wf
from winch_friction.commissioning.channels import first_contradiction
from winch_friction.commissioning.check import quick_check
from winch_friction.commissioning.commissioning import check
from winch_friction.commissioning.mistakes import _negative
from winch_friction.commissioning.summaries import channel_findings

CRANE = wf.load_crane("crane_150t")
MODEL = wf.load_model("a6vm215_crane2")


@pytest.fixture(scope="module")
def run():
    return wf.simulate("normal_joystick", CRANE, MODEL, duration=60.0).run


def with_constant(run, **values):
    columns = {name: np.full(len(run), values[name]) if name in values else run[name] for name in run.columns}
    return replace(run, columns=columns)


def test_a_speed_of_zero_while_the_wire_runs_is_a_dead_sensor(run):
    found = first_contradiction(quick_check([with_constant(run, motor_speed=0.0)], CRANE))
    assert found is not None
    assert (found.cause, found.channel) == ("stuck", "motor_speed")
    assert "motor_speed never changes" in found.sentence
    assert "wire_out" in found.sentence


def test_a_winch_that_really_rests_is_no_contradiction(run):
    rest = {name: float(run[name][0]) for name in ("motor_speed", "wire_out", "shaft_angle", "speed_reference")
            if name in run}  # fmt: skip
    resting = with_constant(run, **rest)
    assert first_contradiction(quick_check([resting], CRANE)) is None
    assert "does not move long enough" in check([resting], CRANE).sentence  # nor a proof: nothing was compared


def test_a_log_of_changes_alone_is_not_said_to_rest(run):
    """Its values stand alone between rows without one: a balance has none of them at once."""
    kept = np.random.default_rng(2).random((len(run), len(run.columns))) < 0.003
    kept[0] = kept[-1] = True
    columns = {n: np.where(kept[:, k], v, np.nan) for k, (n, v) in enumerate(run.columns.items()) if n != "time"}
    result = check([replace(run, columns={"time": run.time, **columns})], CRANE)
    assert "and those stand alone: log it in every row" in result.sentence
    assert "does not move" not in result.sentence
    assert "has no value in 1e+02 %" not in " ".join(each.sentence for each in result.findings)


@pytest.mark.parametrize("load", [0.0, 1.0])
def test_a_hook_load_of_zero_while_the_motors_hold_tonnes_is_a_dead_cell(run, load):
    found = first_contradiction(quick_check([with_constant(run, hook_load=load)], CRANE))
    assert found is not None
    assert (found.cause, found.channel) == ("cell", "hook_load")
    assert "load cell" in found.sentence
    held = float(found.sentence.partition("about ")[2].split()[0])
    assert held == pytest.approx(run["hook_load"].mean() / 1e3, rel=0.1)


def test_a_hook_load_of_the_wrong_sign_is_named_before_ports_that_would_mirror_the_balance(run):
    turned = replace(run, columns={**run.columns, "hook_load": -run["hook_load"]})
    found = first_contradiction(quick_check([turned], CRANE, MODEL))
    assert found is not None
    assert (found.cause, found.channel) == ("sign", "hook_load")
    assert "no negative mass: turn its sign (import --set hook_load.sign=-1)" in found.sentence
    slightly = with_constant(run, hook_load=-3e3)  # a tare that drifted, on the bare hook
    assert not [each for each in quick_check([slightly], CRANE) if each.cause == "sign" and each.channel == "hook_load"]


def test_a_run_of_zeros_is_answered_without_a_figure_that_is_none(run):
    zeros = dict.fromkeys(set(run.columns) - {"time"}, 0.0)
    found = first_contradiction(quick_check([with_constant(run, **zeros)], CRANE))
    assert found is not None
    assert "nan" not in found.sentence


def test_a_dead_run_with_a_layer_says_that_it_does_not_move(run):
    zeros = dict.fromkeys(set(run.columns) - {"time", "wire_layer"}, 0.0)
    found = first_contradiction(quick_check([with_constant(run, **zeros)], CRANE))
    assert found is not None
    assert "does not move long enough for a torque balance" in found.sentence


@pytest.mark.parametrize(("stands_at", "said"), [(0.0, 0), (50.0, 1)])
def test_a_speed_that_stands_at_zero_is_a_rest_and_at_another_value_is_stuck(run, stands_at, said):
    speed = run["motor_speed"] + 1e-3 * np.random.default_rng(0).standard_normal(len(run))
    rests = np.where((run.time > 20.0) & (run.time < 26.0), stands_at, speed)
    columns = {name: rests if name == "motor_speed" else run[name] for name in run.columns}
    found = [each for each in channel_findings(replace(run, columns=columns)) if each.cause == "stuck"]
    assert len(found) == said


def test_a_unit_in_one_port_of_one_run_is_told_by_the_others(run):
    """A tenth of the boost pressure upsets no torque balance; three runs that agree tell of the fourth."""

    def named(k, factor=1.0, channel="main.pressure_b"):
        return replace(run, name=f"run_{k}", columns={**run.columns, channel: factor * run[channel]})

    for factor, words in ((0.1, "MPa under [bar]"), (14.5038, "psi under [bar]")):
        spoilt = [named(0), named(1), named(2, factor), named(3, 1.1)]
        found = first_contradiction(quick_check(spoilt, CRANE, MODEL))
        assert found is not None
        assert (found.cause, found.channel, found.runs) == ("unit", "main.pressure_b", ("run_2",))
        assert words in found.sentence
    for fine in ([named(0), named(1), named(2, 0.5), named(3, 2.0)], [named(0), named(1, 0.1)], [named(0, 0.1)]):
        assert first_contradiction(quick_check(fine, CRANE, MODEL)) is None


def test_one_missing_speed_is_no_dead_sensor(run):
    columns = {name: run[name].copy() for name in run.columns}
    columns["motor_speed"][-1] = np.nan
    assert first_contradiction(quick_check([replace(run, columns=columns)], CRANE)) is None


@pytest.fixture(scope="module")
def compensating():
    return wf.simulate("ahc_irregular", CRANE, MODEL, duration=60.0).run


def test_a_motor_group_that_nobody_logged_is_named_before_a_load_that_would_make_up_for_it(compensating):
    def without(group):
        columns = {name: each for name, each in compensating.columns.items() if not name.startswith(f"{group}.")}
        return replace(compensating, columns=columns)

    assert not [each for each in quick_check([compensating], CRANE, MODEL) if each.cause == "groups"]
    found = first_contradiction(quick_check([without("passive")], CRANE, MODEL))
    assert found is not None
    assert (found.cause, found.channel) == ("groups", "passive.pressure_a")
    assert "3 of 11 motors; no columns of passive: forgotten" in found.sentence
    said = [each.sentence for each in quick_check([without("active")], CRANE, MODEL) if each.cause == "groups"]
    assert len(said) == 1
    assert "8 of 11 motors; no columns of active" in said[0]


@pytest.mark.parametrize(
    ("displacement", "negative"), [([], False), ([np.nan, np.nan], False), ([-1.0, np.nan], True), ([-1.0, 1.0], False)]
)
def test_a_displacement_that_nobody_measured_is_no_negative_one(displacement, negative):
    """A channel without a number has no largest one."""
    view = SimpleNamespace(groups={"main": SimpleNamespace(displacement=np.array(displacement))})
    assert _negative(view, "main") is negative
    assert not _negative(view, "active")


@pytest.mark.parametrize(
    ("groups", "said"),
    [
        ({"main": 11, "active": 3, "passive": 8}, []),
        ({"main": 10, "active": 3, "passive": 8},
         ["crane 'crane_150t': main has 10 motors, active and passive 11: is each counted once?"]),
        ({"main": 12, "active": 3, "passive": 8},
         ["crane 'crane_150t': main has 12 motors, active and passive 11: is each counted once?"]),
        ({"main": 10}, []),
        ({"active": 3, "passive": 8}, []),
    ],
)  # fmt: skip
def test_motors_that_a_crane_file_counts_in_two_ways_are_asked_for(groups, said):
    """A motor of eleven less in normal winch mode was plausible, and the runs of that mode 9 % off."""
    found = quick_check([], replace(CRANE, groups=groups))
    assert [each.sentence for each in found] == said
    assert not any(each.contradicts for each in found)
