"""The rig's data obey the torque balance of docs/physics.md, show each effect, and share nothing with the package."""

import ast
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from campaign import rig
from campaign.rig.oil import viscosity
from campaign.rig.truth import CRANE2, GEAR, RADII, RELATIVE_SIGMA, draw_friction
from winch_friction.physics.signals import Run, column_unit
from winch_friction.physics.winch.crane import run_drive_torque, run_drum_torque
from winch_friction.physics.winch.operating_point import run_operating_points
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model

RIG = Path(rig.__file__).parent
SHORT = 0.11  # of a campaign's runs; less is no run


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
    size = round(1.0 / np.median(np.diff(run["time"]))) // 2 * 2 + 1  # a second
    window = np.ones(size) / size
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


def test_one_winch_makes_one_run_at_a_time():
    """Two runs of a crane of this seed, another load on the hook of each, went on for three minutes together."""
    starts = np.sort([columns["time"][0] for columns in rig.make_dataset(79000257, rig.DRAWN, length=SHORT)])
    assert np.diff(starts).min() >= 299.0


def test_a_seed_is_one_crane_and_another_seed_another():
    first, again, other = (rig.make_dataset(seed, "paper", length=SHORT) for seed in (7, 7, 8))
    assert all(np.array_equal(first[0][name], again[0][name]) for name in first[0])
    assert len(first[0]["time"]) != len(other[0]["time"])


@pytest.mark.parametrize("effect", [*rig.CATALOGUE, *rig.OUTSIDE])
def test_every_effect_changes_what_is_logged(effect):
    flavour = rig.suitable_flavours(effect)[0]
    assert _difference(_null(flavour), rig.make_dataset(9, flavour, [(effect, 1.0)], length=SHORT)) > 0.0


@pytest.mark.parametrize("effect", ["stribeck", "presliding", "signal_delay", "wire_out_drag"])
def test_an_effect_grows_with_its_size(effect):
    small, full = (rig.make_dataset(9, "paper", [(effect, size)], length=SHORT) for size in (0.1, 1.0))
    assert _difference(_null("paper"), full) > _difference(_null("paper"), small) > 0.0


@cache
def _null(flavour):
    return rig.make_dataset(9, flavour, length=SHORT)


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
    runs = [
        {name: column[:50] for name, column in columns.items()}
        for columns in rig.make_dataset(10, "paper", length=SHORT)
    ]
    paths = rig.write_csv(tmp_path, runs, units)
    header = paths[0].read_text().splitlines()[0]
    assert ("motor_speed [rpm]" in header) == (units == "plant")
    assert len(paths) == 12
    table = np.loadtxt(paths[-1], delimiter=",", skiprows=1)
    assert table.shape == (50, len(runs[-1]))
    assert np.abs(np.diff(table[:, 0]) - np.diff(runs[-1]["time"])).max() < 1e-5


def test_every_cause_has_three_laws_and_one_that_the_package_lacks():
    assert set(rig.LAWS) == set(rig.CATALOGUE)
    for cause, laws in rig.LAWS.items():
        assert len(laws) >= 3, cause
        assert len({law.name for law in laws}) == len(laws), cause
        assert any(law.held_out for law in laws), cause


@pytest.mark.parametrize(
    "effect",
    [
        pytest.param(f"{cause}:{law.name}", marks=pytest.mark.long if k and not law.held_out else [])
        for cause, laws in rig.LAWS.items()
        for k, law in enumerate(laws[1:])
    ],
)
def test_every_law_changes_what_is_logged(effect):
    runs = (rig.make_dataset(21, rig.DRAWN, [(effect, size)], length=SHORT) for size in (0.0, 1.0))
    assert _difference(*runs) > 0.0


@pytest.mark.parametrize("seed", [31, 32, 33])
def test_a_drawn_crane_obeys_the_balance_as_its_files_describe_it(seed, tmp_path):
    """Crane and seed model as written to files, read by the package, close the torque balance of the drawn plant."""
    world = rig.world_of(seed, rig.DRAWN)
    crane_file, model_file = rig.write_world(tmp_path, world)
    crane, model = load_crane(str(crane_file)), load_model(str(model_file))
    runs = rig.make_dataset(seed, rig.DRAWN, truth=world.seed, length=0.5)
    friction = 300.0 * world.winch_size  # N m, about
    for columns in runs[:8]:
        assert abs(_plateau_residual(columns, crane, model).mean()) < 0.03 * friction


def test_drawn_cranes_differ_in_all_that_a_crane_file_holds():
    worlds = [rig.world_of(seed, rig.DRAWN) for seed in range(40, 52)]
    for name in ("gear", "radii", "max_displacement", "motors", "inertia", "wire_mass", "seed"):
        assert len({getattr(world, name) for world in worlds}) > 4, name
    rates = {
        round(1 / np.median(np.diff(rig.make_dataset(s, rig.DRAWN, length=SHORT)[0]["time"]))) for s in range(40, 52)
    }
    assert min(rates) <= 25, rates
    assert max(rates) >= 100, rates


def test_truth_lies_as_far_from_the_seed_as_asked():
    rng = np.random.default_rng(1)
    for least, most in ((0.0, 1.5), (2.0, 3.0)):
        away = [
            abs(value / seed - 1.0) / sigma
            for _ in range(20)
            for value, seed, sigma in zip(
                draw_friction(rng, True, most, CRANE2, least), CRANE2, RELATIVE_SIGMA, strict=True
            )
            if value > 0.0
        ]
        assert max(away) <= most + 1e-9
        assert min(away) >= least - 1e-9
