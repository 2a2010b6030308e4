"""The rig's data obey the torque balance of docs/physics.md, show each effect, and share nothing with the package."""

import ast
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from campaign import rig
from campaign.rig.oil import viscosity
from campaign.rig.truth import CRANE2, GEAR, RADII
from winch_friction.physics.signals import Run, column_unit
from winch_friction.physics.winch.operating_point import run_drum_torque, run_operating_points
from winch_friction.physics.winch.torque_balance import run_drive_torque

RIG = Path(rig.__file__).parent


def test_the_rig_imports_nothing_of_the_package():
    for path in RIG.glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            names = [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            names += [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            assert not any(name.startswith("winch_friction") for name in names), path


def _plateau_residual(columns, crane, model):
    """Mean torque that balance and model leave open where the speed is steady, N m."""
    run = Run("run", columns)
    speed = run["motor_speed"]
    window = np.ones(51) / 51
    slow = np.convolve(speed, window, "same")
    spread = np.convolve((speed - slow) ** 2, window, "same") ** 0.5
    steady = (np.abs(slow) > 5.0) & (spread < 1.0)
    drum_torque = run_drum_torque(run, crane)
    friction = model.torque(run_operating_points(run, crane, drum_torque=drum_torque))
    residual = run_drive_torque(run, crane) - drum_torque / crane.gear_ratio - friction
    return residual[steady]


@pytest.mark.parametrize("flavour", [name for name, style in rig.FLAVOURS.items() if "hook_load" in style.channels])
def test_without_an_effect_the_balance_closes(flavour, crane_150t, crane2_model):
    runs = rig.make_dataset(5, flavour, truth=CRANE2)
    means = [_plateau_residual(columns, crane_150t, crane2_model).mean() for columns in runs[:8]]
    assert np.abs(means).max() < 4.0, means  # of 300-800 N m of friction


def test_a_run_holds_what_the_contract_names():
    runs = rig.make_dataset(6, "quiet")
    assert len(runs) == 12
    assert all(column_unit(name) is not None for columns in runs for name in columns)
    assert sum("active.pressure_a" in columns for columns in runs) == 4
    for columns in runs:
        assert 169 < np.ptp(columns["time"]) < 241
        assert abs(np.diff(columns["time"]).mean() - 0.02) < 1e-4
        travelled = (
            np.ptp(columns["wire_out"])
            - np.ptp(columns["shaft_angle"]) * RADII[int(columns["wire_layer"][0]) - 1] / GEAR
        )
        assert abs(travelled) < 0.05


def test_a_seed_is_one_crane_and_another_seed_another():
    first, again, other = rig.make_dataset(7, "paper"), rig.make_dataset(7, "paper"), rig.make_dataset(8, "paper")
    assert all(np.array_equal(first[0][name], again[0][name]) for name in first[0])
    assert len(first[0]["time"]) != len(other[0]["time"])


@pytest.mark.parametrize("effect", [*rig.CATALOGUE, *rig.OUTSIDE])
def test_every_effect_changes_what_is_logged(effect):
    flavour = rig.suitable_flavours(effect)[0]
    assert _difference(_null(flavour), rig.make_dataset(9, flavour, [(effect, 1.0)])) > 0.0


@pytest.mark.parametrize("effect", ["stribeck", "presliding", "signal_delay", "wire_out_drag"])
def test_an_effect_grows_with_its_size(effect):
    small, full = (rig.make_dataset(9, "paper", [(effect, size)]) for size in (0.1, 1.0))
    assert _difference(_null("paper"), full) > _difference(_null("paper"), small) > 0.0


@cache
def _null(flavour):
    return rig.make_dataset(9, flavour)


def _difference(first, second):
    """Sum over the channels of the rms change relative to the channel's own spread."""
    total = 0.0
    for a, b in zip(first, second, strict=True):
        for name in a:
            total += np.sqrt(np.mean((a[name] - b[name]) ** 2)) / (np.std(a[name]) + 1e-12)
    return total


def test_the_oil_follows_walther():
    assert viscosity(np.array([20.0, 60.0])) == pytest.approx([134.0, 21.0], rel=1e-6)
    assert viscosity(np.array(40.0)) == pytest.approx(46.0, rel=0.1)  # ISO VG 46


@pytest.mark.parametrize("units", ["plant", "si"])
def test_files_carry_the_columns(units, tmp_path):
    runs = [{name: column[:50] for name, column in columns.items()} for columns in rig.make_dataset(10, "paper")]
    paths = rig.write_csv(tmp_path, runs, units)
    header = paths[0].read_text().splitlines()[0]
    assert ("motor_speed [rpm]" in header) == (units == "plant")
    assert len(paths) == 12
    table = np.loadtxt(paths[-1], delimiter=",", skiprows=1)
    assert table.shape == (50, len(runs[-1]))
    assert np.abs(np.diff(table[:, 0]) - np.diff(runs[-1]["time"])).max() < 1e-5
