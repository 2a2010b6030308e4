"""Replayed outputs as one table, and a replay in a few numbers."""

import numpy as np
import pytest

from winch_friction.physics.signals import Run
from winch_friction.records.model_file import load_model
from winch_friction.replay.outputs import output_table
from winch_friction.replay.recording import Replayed
from winch_friction.replay.summary import summary


def output(time, torque, states):
    time = np.array(time, float)
    columns = {"time": time, "friction_torque": np.array(torque, float), "speed": 2.0 * time}
    return Run("r", columns, aside={"state": np.array(states, dtype=object)})


def test_each_row_has_what_the_estimator_said_last_by_then():
    compensator = output([1.0, 2.0, 3.0, 4.0], [10.0, 20.0, 30.0, 40.0], ["active"] * 4)
    estimator = output([0.5, 2.0, 3.5], [5.0, 6.0, 7.0], ["stick", "learning", "rejected"])
    table = output_table(compensator, estimator)
    assert table["estimator.friction_torque"].tolist() == [5.0, 6.0, 6.0, 7.0]
    assert table["friction_torque"].tolist() == [10.0, 20.0, 30.0, 40.0]
    assert list(table.aside["estimator.state"]) == ["stick", "learning", "learning", "rejected"]
    assert table.time.tolist() == [1.0, 2.0, 3.0, 4.0]


def test_the_peak_is_the_largest_torque_either_way_and_the_shares_are_of_the_samples():
    compensator = output([0.0, 1.0, 2.0, 3.0], [-40.0, 20.0, 0.0, 0.0], ["active", "fading", "active", "stale"])
    estimator = output([0.0, 1.0, 2.0, 3.0], [0.0] * 4, ["rejected", "learning", "stick", "learning"])
    found = summary(Replayed(compensator, estimator, load_model("a6vm215_crane2"), (), {}))
    assert found["feedforward_peak_Nm"] == 40.0
    assert found["feedforward_rms_Nm"] == pytest.approx(np.sqrt((1600.0 + 400.0) / 4.0))
    assert found["active_share"] == 0.5
    assert found["accepted_share"] == 0.75
    assert found["duration_s"] == 3.0
