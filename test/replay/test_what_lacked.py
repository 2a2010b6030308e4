"""A replay says what its nodes did without: `stale 62 %` alone left nobody a next step."""

import numpy as np
import pytest

from winch_friction.physics.signals import Run
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model
from winch_friction.replay.recording import MUCH, _lacking, replay_run
from winch_friction.replay.settings import ReplaySettings

CRANE = load_crane("crane_150t")


def logged(**more):
    time = 0.04 * np.arange(100)
    speed, one = 80.0 * np.sin(time), np.ones(len(time))
    group = {"pressure_a": 150e5 * one, "pressure_b": 25e5 * one, "displacement": CRANE.max_displacement * one}
    columns = {"time": time, "motor_speed": speed, "speed_reference": speed, "hook_load": 1.2e5 * one}
    return Run("log.csv", columns | {f"main.{name}": values for name, values in group.items()} | more)


def test_what_a_node_did_without_is_said_with_its_share():
    half = np.where(np.arange(100) < 50, 1.0, np.nan)
    seed = load_model("a6vm215_crane2")
    assert replay_run(logged(), CRANE, seed, ReplaySettings()).warnings == ()
    said = replay_run(logged(heave_velocity=0.0 * half), CRANE, seed, ReplaySettings()).warnings
    assert said == ("log.csv: the estimator lacked or doubted heave_velocity (48 % of the samples)",)
    said = replay_run(logged(speed_reference=half), CRANE, seed, ReplaySettings()).warnings
    assert said[0].startswith("log.csv: the compensator lacked or doubted speed_reference (48 % of the samples)")


@pytest.mark.parametrize(("count", "said"), [(10, []), (11, ["x lacked or doubted a (11 % of the samples)"])])
def test_a_start_and_single_lost_messages_are_not_said(count, said):
    assert MUCH == 0.1
    assert _lacking("x", {"a": count, "b": 1}, 100) == said
    assert _lacking("x", {}, 0) == []
