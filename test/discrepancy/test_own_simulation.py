"""`gap` against a user's own simulation: by its column, and by its FMU."""

import json
from dataclasses import replace

import numpy as np
import pytest
from own_winch import churning, cycle

from campaign.own_fmu import MAP, build
from campaign.own_simulation import named
from winch_friction.cli import main
from winch_friction.discrepancy.answer import GapOptions
from winch_friction.discrepancy.preparation.own_simulation import simulated_column, simulated_error
from winch_friction.discrepancy.workflow import find_gap
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import Run
from winch_friction.records.runs import write_run
from winch_friction.simulation.fmu import load_fmu_map, simulate_fmu


def without_column(run):
    return replace(run, columns={k: v for k, v in run.columns.items() if not k.endswith("_simulated")})


def first_minute(run):
    """Less of a run for an FMU whose every step, one in 2 ms, calls Python."""
    return replace(run, columns={name: values[:3000] for name, values in run.columns.items()})


def names_of(found):
    return {each["name"] for each in found["effects"]} | {
        rival for each in found["effects"] for rival in each["indistinguishable_from"]
    }


def test_what_the_simulation_lacks_is_named_whatever_its_own_friction(crane_150t, crane2_model):
    runs = [cycle(k, f"run_{k}") for k in range(8)]
    found = find_gap(runs, crane_150t, crane2_model, GapOptions(plan=False)).content()
    assert found["verdict"] in ("missing_effect", "ambiguous")
    assert "churning" in names_of(found)
    gap = found["gap"]["holdout"]
    assert gap["after"] < 1.2 * gap["noise_floor"] < 0.5 * gap["before"]


@pytest.mark.parametrize("effect", [pytest.param("inertia_error", marks=pytest.mark.long), "tare_load"])
def test_an_error_of_crane_file_or_log_is_named_against_a_column_too(crane_150t, crane2_model, effect):
    """A correction changes what is right for the winch, and not what was simulated: the proof must see it."""
    found, said = named(effect, 9000, True, crane_150t, crane2_model)
    assert found, said


@pytest.mark.long
def test_a_simulation_that_lacks_nothing_is_left_alone(crane_150t, crane2_model):
    runs = [cycle(20 + k, f"run_{k}", missing=False) for k in range(10)]
    assert find_gap(runs, crane_150t, crane2_model, GapOptions(plan=False)).verdict == "nothing_missing"
    # the same logs without the column: the built-in model is another winch's and must not be content
    plain = [without_column(run) for run in runs[:6]]
    options = GapOptions(plan=False, proposals=False)
    assert find_gap(plain, crane_150t, crane2_model, options).verdict != "nothing_missing"


def test_runs_with_and_without_a_simulation_do_not_mix(crane_150t, crane2_model):
    runs = [cycle(0, "with"), without_column(cycle(1, "without"))]
    with pytest.raises(InputError, match="without has no simulated column"):
        find_gap(runs, crane_150t, crane2_model, GapOptions(plan=False))


@pytest.fixture(scope="module")
def fmu(tmp_path_factory):
    pytest.importorskip("fmpy")
    pytest.importorskip("pythonfmu")
    return build(tmp_path_factory.mktemp("fmu"))


def test_an_fmu_gives_the_column_that_its_formulas_give(fmu):
    run = cycle(3, "run")
    bare = without_column(run)
    simulated = simulate_fmu(fmu[0], load_fmu_map(fmu[1]), bare)
    assert simulated_column(simulated) == "main.pressure_drop_simulated"
    inside = slice(100, -100)
    error = simulated["main.pressure_drop_simulated"] - run["main.pressure_drop_simulated"]
    # it knows the noisy speed alone, and differentiates it; its friction step at a reversal is smeared by that
    assert float(np.sqrt(np.mean(error[inside] ** 2))) < 2e5


def test_the_verb_takes_an_fmu_and_writes_what_to_add(fmu, tmp_path, capsys):
    """From files to files: logs without a simulated column, the FMU, the table for the simulation's owner."""
    for k in range(6):
        write_run(first_minute(without_column(cycle(40 + k, f"run_{k}"))), tmp_path / "runs" / f"run_{k}.csv")
    out = tmp_path / "out"
    call = ["gap", str(tmp_path / "runs"), "--crane", "crane_150t", "--model", "a6vm215_crane2", "--out", str(out)]
    assert main.run([*call, "--fmu", str(fmu[0])]) == 2
    assert "belong together" in capsys.readouterr().err
    assert main.run([*call, "--fmu", str(fmu[0]), "--fmu-map", str(fmu[1]), "--no-report", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert "churning" in names_of(found)
    table = np.genfromtxt(out / "addition.csv", delimiter=",", names=True, deletechars="")
    speed, torque = table["motor_speed_[rpm]"] * np.pi / 30.0, table["torque_to_add_[N*m]"]
    fast = np.abs(speed) > 60.0
    assert np.sqrt(np.mean((torque - churning(speed))[fast] ** 2)) < 0.5 * np.sqrt(np.mean(churning(speed)[fast] ** 2))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ("winch_friction.fmu/9", "is not"),
        ("no_such_variable: {column: motor_speed}", "no variable no_such_variable"),
        ("parameters: {gain: much}", "parameters: gain must be a finite number"),
        ("parameters: [gain]", "parameters: expected a mapping"),
    ],
)
def test_a_wrong_map_is_said(fmu, tmp_path, change, said):
    if "/9" in change:
        text = MAP.replace("winch_friction.fmu/1", change)
    elif change.startswith("parameters"):
        text = f"{MAP}\n{change}\n"
    else:
        text = MAP.replace("inputs:", f"inputs:\n  {change}")
    path = tmp_path / "map.yaml"
    path.write_text(text)
    with pytest.raises(InputError, match=said):
        simulate_fmu(fmu[0], load_fmu_map(path), without_column(cycle(3, "run")))


def test_a_file_that_is_no_fmu_is_said(fmu, tmp_path):
    (tmp_path / "x.fmu").write_text("not an archive")
    with pytest.raises(InputError, match="not an FMU"):
        simulate_fmu(tmp_path / "x.fmu", load_fmu_map(fmu[1]), cycle(3, "run"))


def test_the_error_of_each_simulated_column_is_measured_minus_simulated_drive_torque(crane_150t):
    """Drop and torque: what was measured on top. Force: a rope that pulls less than simulated has lost torque."""
    radius, one = np.full(3, 1.1), np.ones(3)
    columns = {"rope_force": 90e3 * one, "rope_force_simulated": 100e3 * one}
    lost = simulated_error(columns, Run("force", {"time": np.arange(3.0), **columns}), (), crane_150t, radius)
    assert lost == pytest.approx(10e3 * 1.1 / crane_150t.gear_ratio)
    columns = {"motor_torque": 120.0 * one, "motor_torque_simulated": 100.0 * one}
    more = simulated_error(columns, Run("torque", {"time": np.arange(3.0), **columns}), (), crane_150t, radius)
    assert more == pytest.approx(20.0 * crane_150t.motor_total(()))
