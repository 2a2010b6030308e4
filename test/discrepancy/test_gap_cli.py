"""`winch-friction gap` from files to files."""

import hashlib
import json
import re
import subprocess
import sys
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from gap_rig import runs_with

from winch_friction import simulation
from winch_friction.cli.gap_output import _parameters, _unexplained
from winch_friction.cli.main import run as winch_friction
from winch_friction.discrepancy import workflow
from winch_friction.physics.signals import Run
from winch_friction.physics.winch.crane import Drive
from winch_friction.records import crane_file
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model
from winch_friction.records.runs import write_run
from winch_friction.simulation import load_scenario, simulate
from winch_friction.simulation.plant_file import load_plant

OWN_EFFECT = """
from winch_friction.physics.friction import Parameter, Scope, Term, register
from winch_friction.physics.friction.symbols import wire_out

q = Parameter("q_wire_guide", "N*m/m", 0.1, upper=10.0, doc="drag of the wire guide per metre paid out")
register(Term("wire_guide", q.symbol * wire_out, (q,), Scope.SHAFT, "a user's own", "gear and drum"))
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Runs in two formats, and the workflow's output."""
    folder = tmp_path_factory.mktemp("gap")
    runs = runs_with(4010, "quiet", ("gear_asymmetry", 0.5))
    for k, run in enumerate(runs):
        write_run(run, (folder / run.name).with_suffix(".parquet" if k % 2 else ".csv"))
    paths = sorted(str(path) for path in folder.glob("run_*"))
    assert winch_friction(["gap", *paths, "--out", str(folder / "out")]) == 0
    return folder


def test_gap_json_has_the_fields_of_the_design(folder):
    content = json.loads((folder / "out" / "gap.json").read_text())
    assert content["schema"] == "winch_friction.gap/2"
    assert content["verdict"] in ("missing_effect", "ambiguous")
    effect = content["effects"][0]
    assert "gear_asymmetry" in (effect["name"], *effect["indistinguishable_from"])
    assert set(effect["evidence"]) >= {"p_value", "cv_gain", "selection_frequency"}
    assert all(set(p) == {"value", "std", "unit"} for p in effect["parameters"].values())
    assert set(content["regions"][0]) == {"where", "share_of_gap", "mean_residual"}
    holdout = content["gap"]["holdout"]
    assert content["gap"]["unit"] == "bar"
    assert holdout["after_ci"][0] <= holdout["after"] <= holdout["after_ci"][1]
    assert holdout["after"] < 0.5 * holdout["before"]


def test_the_next_experiment_is_a_scenario_that_runs(folder):
    content = json.loads((folder / "out" / "gap.json").read_text())
    if content["verdict"] != "ambiguous":
        pytest.skip("these runs left nothing ambiguous")
    plan = content["next_experiment"]
    assert plan["expected_z"] >= 0.0
    scenario = folder / "out" / plan["scenario"]
    assert winch_friction(["simulate", str(scenario), "--out", str(folder / "next.csv")]) == 0
    assert (folder / "next.csv").is_file()


def test_the_repaired_model_is_a_model_file(folder):
    model = load_model(folder / "out" / "model.yaml")
    assert model.covariance is not None
    assert model.provenance["repaired_by"] == "winch-friction gap"


def test_the_page_holds_all_that_it_needs(folder):
    """It is opened without a network in test/browser; this says what it would ask for."""
    page = (folder / "out" / "report.html").read_text(encoding="utf-8")
    assert "Proof on locked runs" in page
    assert re.findall(r"""(?:src|href)=["']?(?:https?:|//)[^"'> ]*|url\(["']?(?:https?:|//)|@import""", page) == []


def with_a_wire_guide(number):
    """A minute of an electric drive whose wire guide drags by 0.2 N m per metre paid out."""
    rng, time = np.random.default_rng(number), 0.02 * np.arange(3000)
    speed = 0.15 * np.sin(2.0 * np.pi * time / (6 + number)) * np.sin(2.0 * np.pi * time / 37 + number)
    out = 10.0 + 8.0 * number + 30.0 * np.abs(np.sin(2.0 * np.pi * time / (50 + number)))
    torque = 95.109 * np.gradient(speed, time) + 203.5 * speed + 0.2 * out * np.sign(speed)
    columns = {"motor_torque": torque + rng.normal(0.0, 0.3, len(time)), "hook_load": 0.0 * time, "wire_out": out}
    return Run(f"run_{number}.csv", {"time": time, "motor_speed": speed, **columns})


def test_a_users_own_effect_needs_one_declaration(tmp_path):
    own = tmp_path / "own.py"
    own.write_text(OWN_EFFECT)
    paths = [str(write_run(with_a_wire_guide(k), tmp_path / f"run_{k}.csv")) for k in range(5)]
    known = ["--crane", "emps", "--model", "emps_viscous", "--effects", str(own)]
    script = (
        "import sys; from winch_friction.cli.main import run; "
        f"sys.exit(run(['gap', *{paths}, *{known}, '--out', '{tmp_path / 'out'}', '--json', '--no-report']))"
    )  # a process of its own: the registry of terms is this process's
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    (effect,) = json.loads(done.stdout)["effects"]
    assert effect["name"] == "wire_guide"
    assert effect["parameters"]["q_wire_guide"]["value"] == pytest.approx(0.2, rel=0.02)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [([], "no run given"), (["missing.csv"], "missing.csv"), (["bad.csv"], "bad.csv"), (["short.csv"], "short.csv")],
)
def test_bad_input_is_one_line(arguments, words, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bad.csv").write_text("time,motor_speed\n0,1\n1,x\n")
    rows = "\n".join(f"{t:g},1,2e6,1e6,3e-5,55000" for t in np.arange(0, 1, 0.1))
    header = "time,motor_speed,main.pressure_a,main.pressure_b,main.displacement,hook_load"
    (tmp_path / "short.csv").write_text(f"{header}\n{rows}\n")
    assert winch_friction(["gap", *arguments, "--out", "out"]) == 2
    error = capsys.readouterr().err.strip()
    assert words in error.splitlines()[-1]
    assert "Traceback" not in error
    assert not (tmp_path / "out").exists()


def test_blind_trials_open_the_seal_only_afterwards(tmp_path, capsys, monkeypatch):
    """The search is told what the runs show and nothing else, while the seal is promised and not yet open."""
    seal = tmp_path / "trial_01" / "seal.json"
    promise = seal.with_suffix(".sha256")

    def searched(runs, crane, model, options):
        assert len(runs) == 12
        assert not any("hidden" in str(run.metadata) for run in runs)
        assert promise.is_file()
        assert not seal.exists()
        found = [{"name": "tare_load", "indistinguishable_from": ["churning"]}]
        return SimpleNamespace(content=lambda: {"verdict": "ambiguous", "effects": found})

    monkeypatch.setattr(workflow, "find_gap", searched)
    assert winch_friction(["gap", "--blind", "1", "--seed", "3", "--out", str(tmp_path), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    (trial,) = told["trials"]
    assert hashlib.sha256(seal.read_text().strip().encode()).hexdigest() == promise.read_text().strip()
    assert json.loads(seal.read_text())["effect"] == trial["hidden"] == "churning"
    assert json.loads(seal.with_name("gap.json").read_text())["verdict"] == trial["verdict"] == "ambiguous"
    assert trial["found"] == ["tare_load", "churning"]
    assert told["right"] == 1


def test_blind_trials_of_another_crane_are_its_own(tmp_path, capsys, monkeypatch):
    """Simulated on a plant scaled from the shipped one, which is kept; nothing is promised of a crane without one."""
    monkeypatch.chdir(tmp_path)
    own = ["--name", "own", "--load", "50", "--motors", "5", "--displacement", "160", "--gear-ratio", "180",
           "--radius", "0.6", "--layers", "5", "--active", "2", "--wire", "44", "--out", "own.yaml"]  # fmt: skip
    assert winch_friction(["init", "crane", *own]) == 0
    assert winch_friction(["init", "model", "--crane", "own.yaml", "--out", "seed.yaml"]) == 0
    searched, asked = [], []

    def simulated(scenario, *_):
        asked.append(scenario)
        return SimpleNamespace(run=scenario.name)

    def nothing(runs, *_):
        searched.append(runs)
        return SimpleNamespace(content=lambda: {"verdict": "nothing_missing", "effects": []})

    monkeypatch.setattr(simulation, "simulate", simulated)
    monkeypatch.setattr(workflow, "find_gap", nothing)
    blind = ["gap", "--blind", "1", "--crane", "own.yaml", "--model", "seed.yaml", "--out", "blind"]
    assert winch_friction(blind) == 0
    assert len(searched[0]) == 12
    plant = tmp_path / "blind" / "plant.yaml"
    assert {each.plant for each in asked} == {str(plant.relative_to(tmp_path))}
    assert load_plant(plant).crane == "own"
    assert "blind/plant.yaml, scaled from winch_150t" in capsys.readouterr().err
    (tmp_path / "second").mkdir()
    kept = tmp_path / "second" / "plant.yaml"
    kept.write_text("somebody's own\n")
    assert winch_friction([*blind[:-1], "second"]) == 2
    assert "second/plant.yaml" in capsys.readouterr().err
    assert [kept.read_text(), *kept.parent.iterdir()] == ["somebody's own\n", kept]
    other = replace(load_crane("own.yaml"), drive=Drive("electric"))
    monkeypatch.setattr(crane_file, "load_crane", lambda name: other)
    assert winch_friction(["gap", "--blind", "1", "--crane", "own.yaml", "--model", "seed.yaml", "--out", "other"]) == 2
    assert "scenarios simulate hydraulic winches" in capsys.readouterr().err
    assert not (tmp_path / "other").exists()


def test_runs_of_another_crane_without_a_word_of_it_are_refused_for_that(tmp_path, capsys):
    """Nothing is silently taken for the 150 t crane."""
    other = replace(load_crane("crane_150t"), gear_ratio=120.0, name="other")
    model = replace(load_model("a6vm215_crane2"), crane="", constants={})
    scenario = load_scenario("ahc_55t_215").override({"duration": 60.0, "load": 12e3, "crane": ""})
    write_run(simulate(scenario, other, model, seed=1).run, tmp_path / "run.csv")
    assert winch_friction(["gap", str(tmp_path / "run.csv"), "--out", str(tmp_path / "out")]) == 2
    assert "no --crane and no --model were given" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_the_rises_of_a_curve_are_not_listed_and_other_parameters_are():
    size = {"value": 3.0e5, "std": 1.234e4, "unit": "Pa"}
    found = {"R_line": size, "free_line_pressure_drop_displacement_1": size}
    assert (
        _parameters({"law_kind": "free", "parameters": found})
        == "R_line = 3 ± 0.12 bar, a curve (in the page and in model.yaml)"
    )
    assert _parameters({"law_kind": "literature", "parameters": {"free_play": size}}) == "free_play = 3 ± 0.12 bar"
    share = {"value": 0.0123, "std": 0.0004, "unit": "1"}
    assert _parameters({"law_kind": "literature", "parameters": {"e_p": share}}) == "e_p = 0.0123 ± 0.0004"
    tried = {"value": 12.5664, "std": 5e-11, "unit": "rad/s"}
    assert _parameters({"law_kind": "literature", "parameters": {"C4": tried}}) == "C4 = 120 rpm"


def test_what_depends_on_no_signal_is_not_said_to_depend_on_anything():
    assert _unexplained(["oil"], "too small", share_of_gap=0.5) == "it depends on: oil (too small)"
    assert _unexplained([], "too small", share_of_gap=0.5) == "no effect is named: too small"


def test_what_is_doubted_of_the_runs_stands_in_the_answer_too(tmp_path, monkeypatch, capsys):
    """That a wire_layer is one too low in three runs was said on the way, and nowhere in gap.json or on the page."""
    doubt = SimpleNamespace(severity="warning", sentence="run_01: wire_layer seems one too low")
    monkeypatch.setattr("winch_friction.commissioning.check.quick_check", lambda *_: [doubt])
    monkeypatch.setattr("winch_friction.commissioning.channels.first_contradiction", lambda _: None)
    write_run(runs_with(4010, "quiet", length=0.2)[0], path := tmp_path / "run_01.csv")
    assert winch_friction(["gap", str(path), "--out", str(tmp_path / "out"), "--no-report"]) == 0
    assert json.loads((tmp_path / "out/gap.json").read_text())["notes"][0] == doubt.sentence
    shown = capsys.readouterr()
    assert f"warning: {doubt.sentence}" in shown.err
    assert doubt.sentence not in shown.out  # once


@pytest.mark.parametrize("quiet", [False, True])
def test_what_a_file_lacks_stands_in_the_answer_too(quiet, tmp_path, capsys):
    """Who opens gap.json, or said `--quiet`, has not seen what was said while the runs were read."""
    run = runs_with(4010, "quiet", length=0.2)[0]
    holes = replace(
        run, columns=run.columns | {"hook_load": np.where(np.arange(len(run)) < 30, np.nan, run["hook_load"])}
    )
    path = tmp_path / "run_01.csv"
    write_run(holes, path)
    said = ["--quiet"] if quiet else []
    assert winch_friction([*said, "gap", str(path), "--out", str(tmp_path / "out"), "--no-report"]) == 0
    shown = capsys.readouterr()
    (note,) = [each for each in json.loads((tmp_path / "out/gap.json").read_text())["notes"] if "not numbers" in each]
    assert "'hook_load': 30 of" in note
    assert (f"warning: {note}" in shown.err) is not quiet
    assert note not in shown.out
