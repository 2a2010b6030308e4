"""Replayed outputs as one table, and a replay in a few numbers."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.compensation.feedforward import Feedforward
from winch_friction.estimation import ParameterEstimate
from winch_friction.physics.signals import Run
from winch_friction.records.model_file import load_model
from winch_friction.records.topics import stamp_time
from winch_friction.replay.compensator import FeedforwardRecord
from winch_friction.replay.outputs import _in_order, _learned, _said, _write_topics, output_table
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


def test_rows_before_the_estimators_first_answer_have_that_one():
    compensator = output([0.0, 1.0, 2.0], [1.0, 2.0, 3.0], ["waiting", "active", "stale"])
    estimator = output([1.0, 2.5], [5.0, 6.0], ["stick", "learning"])
    table = output_table(compensator, estimator)
    assert table["estimator.friction_torque"].tolist() == [5.0, 5.0, 5.0]
    assert list(table.aside["state"]) == ["waiting", "active", "stale"]
    assert list(table.aside["estimator.state"]) == ["stick"] * 3


def test_a_pressure_is_written_under_the_stamp_and_mark_of_its_torque():
    compensator, estimator = (output([10.5, 11.0], [3.0, 4.0], ["active"] * 2) for _ in range(2))
    columns = compensator.columns | {"pressure": np.array([2e5, np.nan])}
    aside = compensator.aside | {"number": np.array([41, 42]), "valid": np.array([True, False])}
    written, model = [], load_model("a6vm215_crane2")
    writer = SimpleNamespace(write=lambda *row: written.append(row))
    _write_topics(writer, replace(compensator, columns=columns, aside=aside), estimator, model, None)
    told = [(topic, stamp_time(m), m.header.frame_id) for topic, m, _ in written if topic.startswith("/compensator")]
    torque, pressure = "/compensator/friction_torque", "/compensator/pressure_feedforward"
    assert told == [(torque, 10.5, "valid 41"), (pressure, 10.5, "valid 41"), (torque, 11.0, "invalid 42")]


def test_a_record_keeps_the_number_of_each_feedforward():
    """A table's numbers are those that were published: what the watchdog said in between is counted."""
    record = FeedforwardRecord()
    for number in (1, 2, 7):
        record.take(Feedforward(number, 5.0, 0.0, 50.0, "active", 0.0, 1.0, True, number))
    assert record.run("r").aside["number"].tolist() == [1, 2, 7]


def test_a_parameter_of_a_summary_has_its_seed_what_was_learned_and_how_surely():
    one = ParameterEstimate("C3", "N*m", 0.6, 0.01, 0.5, 0.1, "learned", 0.3)
    runs = (output([0.0, 1.0], [0.0, 1.0], ["active"] * 2) for _ in range(2))
    found = summary(Replayed(*runs, load_model("a6vm215_crane2"), (one,), {"nis_share_inside": 0.9}))
    assert found["parameters"] == [
        {"parameter": "C3", "unit": "N*m", "seed": 0.5, "learned": 0.6, "sigma": 0.01, "status": "learned"}
    ]
    assert (found["samples"], found["recording"], found["nis_share_inside"]) == (2, "r", 0.9)


def test_what_a_compensator_and_its_watchdog_said_is_told_by_number_and_phase_after_phase():
    def said(*numbers):
        return [(number, float(k), "", 0.0, 0.0, 0.0) for k, number in enumerate(numbers)]

    samples, watchdog = said(1, 2, 5, 6, 1, 2), said(3, 4, 3)
    assert [each[0] for each in _in_order(samples, watchdog)] == [1, 2, 3, 4, 5, 6, 1, 2, 3]
    assert [each[0] for each in _in_order(said(1, 2), [])] == [1, 2]


def test_what_is_published_of_a_run_has_its_own_columns_and_marks():
    columns = {"time": [1.0, 2.0], "speed": [3.0, 4.0], "friction_torque": [5.0, math.nan], "pressure": [7.0, 8.0]}
    aside = {"valid": np.array([True, False]), "number": np.array([11, 12])}
    run = Run("r", {name: np.array(values) for name, values in columns.items()}, aside=aside)
    assert _said(run)[0] == (11, 1.0, "valid 11", 3.0, 5.0, 7.0)
    assert _said(run)[1][:4] == (12, 2.0, "invalid 12", 4.0)
    assert _learned(run) == [("valid 11", 3.0, 5.0), ("invalid 12", 4.0, 0.0)]
    assert _said(None) == []
    assert [each[2] for each in _said(Run("r", run.columns))] == ["valid 1", "valid 2"]
