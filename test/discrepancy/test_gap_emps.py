"""Real data: the EMPS drive (Janot, Gautier, Brunot 2019), from inertia and viscous friction alone."""

from pathlib import Path

import numpy as np
import pytest

from winch_friction.discrepancy.workflow import find_gap
from winch_friction.physics.signals import Run
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model

DATA = Path(__file__).parents[3] / "shared" / "data" / "emps" / "DATA_EMPS.mat"
FORCE_PER_VOLT = 35.1507


@pytest.mark.shared
def test_finds_coulomb_offset_and_asymmetry_and_then_stops():
    if not DATA.is_file():
        pytest.skip(f"the EMPS data are not at {DATA}")
    from scipy.io import loadmat
    from scipy.signal import butter, filtfilt

    data = {name: np.ravel(values) for name, values in loadmat(DATA).items() if not name.startswith("_")}
    position = filtfilt(*butter(4, 100 / 500), data["qm"])
    speed = np.gradient(position, data["t"])
    run = Run("emps", {"time": data["t"], "motor_speed": speed, "motor_torque": FORCE_PER_VOLT * data["vir"]})
    result = find_gap([run], load_crane("emps"), load_model("emps_viscous"))
    assert {effect.name for effect in result.effects} == {"coulomb", "torque_offset", "direction_asymmetry"}
    assert result.verdict == "missing_effect"
    assert result.unit == "N*m"
    assert result.holdout.relative[0] > 0.17
    assert result.holdout.relative[1] <= 0.033
    assert result.model.value("C2") == pytest.approx(20.4, abs=1.0)
