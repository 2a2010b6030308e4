"""The demo's parts that need no processes; the whole of it runs in test/ros/test_loop.py."""

from pathlib import Path

import numpy as np
import pytest

from winch_friction.cli.demo.measures import measure, near_reversal
from winch_friction.cli.demo.plan import EFFICIENCY, efficiency_model, make_plan
from winch_friction.cli.demo.recording import Recording
from winch_friction.cli.main import run
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction.scaled import scaled_system
from winch_friction.physics.units import RPM
from winch_friction.physics.winch.operating_point import operating_point
from winch_friction.records.crane_file import load_crane


def test_a_folder_with_other_files_is_not_touched(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    (tmp_path / "thesis.tex").write_text("precious")
    assert run(["demo", "--out", str(tmp_path)]) == 2
    assert "holds other files" in capsys.readouterr().err
    assert (tmp_path / "thesis.tex").read_text() == "precious"


def test_the_efficiency_factor_is_a_share_of_the_load_torque() -> None:
    crane = load_crane("crane_150t")
    point = operating_point(
        direction=1.0, speed=50.0, drum_torque=600e3, groups=[(3, 1e7, 1e7, 3e-5), (8, 2e7, 3e7, 1e-5)], motor_total=11
    )
    assert efficiency_model(crane, EFFICIENCY).torque(point) == pytest.approx(0.1 * 600e3 / crane.gear_ratio)


def test_only_the_system_turns_harder(crane2_model) -> None:
    harder = scaled_system(crane2_model, 1.3)
    assert harder.value("C6") == pytest.approx(1.3 * crane2_model.value("C6"))
    assert harder.value("C4") == crane2_model.value("C4")
    assert harder.value("K4") == crane2_model.value("K4")


def test_the_window_around_reversals() -> None:
    time = np.arange(0.0, 10.0, 0.1)
    near = near_reversal(time, np.where(time < 5.0, 1.0, -1.0))
    assert time[near].min() == pytest.approx(4.8)
    assert time[near].max() == pytest.approx(6.0)


def _recording(phases: int, error: float, share: float) -> Recording:
    time = np.concatenate([1000.0 + 70.0 * k + np.arange(0.0, 60.0, 0.1) for k in range(phases)])
    speed = 500.0 * RPM * np.sin(time)
    friction = 400.0 * np.sign(speed)
    truth = np.column_stack([time, np.full_like(time, error), speed, friction, friction])
    fed = np.column_stack([time, share * friction, speed])
    return Recording(truth, fed, fed, [])


def test_errors_are_those_of_the_model_behind_the_feedforward(tmp_path: Path) -> None:
    plan = make_plan(tmp_path, "ahc_irregular", 60.0, 1, 1.3)
    rows = measure(plan, _recording(4, 0.004, 0.9))
    assert [row.residual for row in rows] == pytest.approx([0.004] * 4)
    assert rows[3].friction_error_share[:3] == pytest.approx((0.0, 0.0, 0.0), abs=1e-12)
    assert rows[1].friction_error_share[1] == pytest.approx(0.1)
    assert np.isnan(rows[3].friction_error[3])  # the sea did not go there: no figure, not a zero


def test_an_interrupted_recording_is_said() -> None:
    with pytest.raises(InputError, match="3 phases, expected 4"):
        _recording(3, 0.0, 1.0).phases(4)
