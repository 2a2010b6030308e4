"""What `identify system` prints: each test's error above and below 250 rpm under its own heading."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np

from winch_friction.cli.identify_output import show_system
from winch_friction.identification.verification import TestError
from winch_friction.records.model_file import load_model


def test_errors_above_and_below_250_rpm_stand_under_their_headings(capsys):
    found = SimpleNamespace(unseen=[], ties=[], fits={}, held_out_costs=[], loops=[], bootstrap=None)
    speed = np.array([10.0, 100.0])  # rad/s: 95 and 955 rpm
    error = TestError("test_07", speed, np.zeros(2), np.array([30.0, 10.0]), 100.0)
    show_system(found, load_model("a6vm215_crane2"), [error], Path("seed.yaml"), False)
    lines = capsys.readouterr().out.splitlines()
    head = next(line for line in lines if "above 250 rpm" in line)
    row = next(line for line in lines if "test_07" in line)
    assert head.index("above") < head.index("below")
    assert row.index(" 10") < row.index(" 30")
