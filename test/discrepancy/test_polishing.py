"""The last fit of a repaired model, along the path by which its file will be read."""

from dataclasses import replace

import pytest
from gap_rig import runs_with

from winch_friction.discrepancy.repair import Repair, polished
from winch_friction.physics.friction.correction import Correction
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model


def test_a_delay_is_all_of_what_the_signals_are_out_of_step_by():
    """Half a sample is within what any log is off by; kept there, it is not in the file."""
    crane, seed = load_crane("crane_150t"), load_model("a6vm215_crane2")
    runs = runs_with(4061, "si_files", ("signal_delay", 1.0), length=0.3)
    late = Correction("signal_delay", 0.047, std=1e-4)  # 50 ms are hidden
    drafted = Repair(replace(seed, corrections=(late,)), {"signal_delay": {}})
    found = polished(drafted, seed, runs, [run.name for run in runs[:3] + runs[9:]], crane).model.corrections
    assert found[0].value == pytest.approx(0.050, abs=5e-4)
