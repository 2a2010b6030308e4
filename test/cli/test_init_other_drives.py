"""`winch-friction init` for a winch that is not hydraulic: crane, bare model and map by flags, and what is refused."""

import numpy as np
import pytest
import yaml

from winch_friction.cli.main import run
from winch_friction.importing.expectations import fits
from winch_friction.importing.map_schema import map_schema
from winch_friction.importing.mapping import load_map
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model
from winch_friction.records.schemas import problems
from winch_friction.simulation.file_schemas import all_schemas

WINCH = ["--name", "winch_5t", "--load", "5", "--motors", "2", "--gear-ratio", "90", "--radius", "0.3", "--layers", "4",
         "--wire", "20", "--inertia", "0.4"]  # fmt: skip
CHANNELS = {"electric": "motor_torque", "power": "mechanical_power", "current": "motor_current"}


def init(drive, *more):
    constant = ["--torque-constant", "1.9"] if drive == "current" else []
    return run(["init", "crane", "--drive", drive, *WINCH, *constant, *more])


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("drive", CHANNELS)
def test_a_winch_without_pressures_has_its_files(drive, here, capsys):
    assert init(drive) == 0
    crane = load_crane("winch_5t.yaml")
    assert (crane.drive.kind, crane.groups, crane.inertia, crane.rated_load) == (drive, {"main": 2}, 0.4, 5000.0)
    assert crane.drive.torque_constant == (1.9 if drive == "current" else 0.0)
    assert crane.motor_total(()) == 2
    for what in ("model", "map"):
        assert run(["init", what, "--crane", "winch_5t.yaml"]) == 0
    model, found = load_model("seed_winch_5t.yaml"), load_map(here / "log_map.yaml")
    assert (model.crane, model.terms) == ("winch_5t", ())
    assert CHANNELS[drive] in found.columns
    assert not [name for name in found.columns if "pressure" in name or "displacement" in name]
    schemas = {**all_schemas(), "map": map_schema()}
    for file, kind in (("winch_5t", "crane"), ("seed_winch_5t", "model"), ("log_map", "map")):
        assert problems(yaml.safe_load((here / f"{file}.yaml").read_text()), schemas[kind]) == []
    # 5 t at the outer of four layers: 50 kN on 0.352 m over 90, of which a feedforward may take 0.3
    assert crane.absolute_torque_limit == pytest.approx(
        0.3 * 5000 * 9.80665 * crane.drum.layer_radii[-1] / 90, rel=0.01
    )


def test_all_that_lacks_or_is_of_another_drive_is_said_at_once(capsys):
    assert run(["init", "crane", "--drive", "current", *WINCH[:-2]]) == 2
    said = capsys.readouterr().err
    assert "--inertia (inertia at the motor shaft, kg m^2: rotors, gear and drum)" in said
    assert "--torque-constant (N m at the motor shaft per A)" in said
    assert "--displacement" not in said
    assert "--active" not in said
    assert init("electric", "--displacement", "160", "--active", "1", "--torque-constant", "2") == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 3
    for flag in ("active", "displacement", "torque-constant"):
        assert f"--{flag} is not of --drive electric" in said


def test_a_torque_constant_of_a_hydraulic_crane_is_refused(capsys):
    hydraulic = ["--displacement", "160", "--active", "0", "--torque-constant", "2"]
    assert run(["init", "crane", *WINCH, *hydraulic]) == 2
    assert "--torque-constant is not of --drive hydraulic" in capsys.readouterr().err


@pytest.mark.parametrize("value", ["0", "-1", "nan", "inf"])
def test_an_inertia_is_above_zero_and_finite(value, capsys):
    assert init("electric", "--inertia", value) == 2
    assert f"--inertia {float(value)!r} must be above 0" in capsys.readouterr().err


def test_an_unknown_drive_and_what_the_simulator_cannot_do_are_said(capsys):
    assert init("steam") == 2
    assert "--drive steam: use hydraulic, electric, power, current" in capsys.readouterr().err
    assert init("power") == 0
    for what in ("plant", "scenario"):
        assert run(["init", what, "--crane", "winch_5t.yaml"]) == 2
        assert f"a {what} is for the simulator, whose cranes are hydraulic" in capsys.readouterr().err


def test_an_electric_winch_holds_its_rated_load(capsys):
    """The bound of the feedforward, 0.3 of what the drive gives, was taken for it: 2 t of 5 was "beyond what it holds",
    and a log's loads of 4 t had no size that such a crane can have."""
    assert init("electric") == 0
    assert run(["init", "model", "--crane", "winch_5t.yaml"]) == 0
    capsys.readouterr()
    show = ["show", "seed_winch_5t.yaml", "--crane", "winch_5t.yaml"]
    assert run(show) == 0
    assert "on winch_5t, 1.8 t:" in capsys.readouterr().out  # a third of the rated load, as its help says
    assert run([*show, "--load", "5"]) == 0
    assert capsys.readouterr().err == ""
    assert run([*show, "--load", "6"]) == 0
    assert (
        "--load 6: beyond what crane 'winch_5t' holds by its file (0 to 5 t: its rated load)" in capsys.readouterr().err
    )
    assert fits("hook_load", np.full(9, 4e3), load_crane("winch_5t.yaml"))
    assert not fits("hook_load", np.full(9, 4e6), load_crane("winch_5t.yaml"))
