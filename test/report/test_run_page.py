"""Runs as a page: every channel in numbers, in the unit that people read."""

import numpy as np
import pytest

from winch_friction.physics.signals import Run
from winch_friction.report.run_page import channel_rows, run_plot

RUN = Run(
    "r",
    {
        "time": np.arange(4.0),
        "motor_speed": np.array([-10.0, 0.0, np.nan, 40.0]) * np.pi / 30.0,
        "main.pressure_a": np.array([1e7, 2e7, 3e7, np.nan]),
        "hook_load": np.array([np.nan, np.nan, 5e3, 7e3]),
    },
)


def test_range_mean_and_missing_samples_of_every_channel():
    rows = {row["channel"]: row for row in channel_rows(RUN)}
    shown = ("unit", "least", "largest", "mean", "missing [samples]")
    assert [rows["motor_speed"][key] for key in shown] == ["rpm", *map(pytest.approx, (-10.0, 40.0, 10.0)), 1]
    assert [rows["main.pressure_a"][key] for key in shown] == ["bar", *map(pytest.approx, (100.0, 300.0, 200.0)), 1]
    assert [rows["hook_load"][key] for key in shown] == ["t", *map(pytest.approx, (5.0, 7.0, 6.0)), 2]


def test_what_is_drawn_is_in_the_unit_of_its_label():
    columns = run_plot(RUN).frames[0].columns
    assert columns["main.pressure_a [bar]"][:3] == pytest.approx([100.0, 200.0, 300.0])
    assert columns["hook_load [t]"][2:] == pytest.approx([5.0, 7.0])
