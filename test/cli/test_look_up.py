"""The verbs with which one looks around: list, show, terms, compare, plot, doctor; and completion of names."""

import json

import numpy as np
import pytest

import winch_friction as wf
from winch_friction.cli import names
from winch_friction.cli.main import run
from winch_friction.physics.channels import CM3_PER_REV, RPM
from winch_friction.physics.signals import GroupSample, Sample
from winch_friction.records.bag_write import MESSAGES, BagWriter
from winch_friction.records.strict_yaml import config_directory
from winch_friction.records.topics import crane_topics


def test_a_crane_that_only_a_models_file_knows_is_asked_for(tmp_path, capsys):
    model = tmp_path / "own.yaml"
    text = (config_directory() / "models" / "a6vm215_crane2.yaml").read_text()
    model.write_text(text.replace("crane: crane_150t", "crane: our_crane"))
    assert run(["show", str(model)]) == 2
    said = capsys.readouterr().err
    assert f"{model}: key 'crane' names 'our_crane': give its file with --crane FILE ('our_crane' is neither" in said
    assert run(["show", str(model), "--crane", "no_such_crane"]) == 2
    assert "key 'crane'" not in capsys.readouterr().err


@pytest.mark.parametrize("kind", sorted(names.KINDS))
def test_everything_that_has_a_name_is_listed(kind, capsys):
    assert run(["list", kind, "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)
    assert [row["name"] for row in rows] == sorted(names.KINDS[kind].names(), key=[r["name"] for r in rows].index)
    assert len(rows) >= 2


def test_a_list_says_what_there_is(capsys):
    assert run(["list"]) == 0
    assert "scenarios" in capsys.readouterr().out
    assert run(["list", "boats"]) == 2
    assert "models" in capsys.readouterr().err


def test_a_model_is_shown_as_a_curve_and_as_a_page(tmp_path, capsys):
    page = tmp_path / "model.html"
    assert run(["show", "a6vm215_crane2", "--load", "100", "--out", str(page)]) == 0
    shown = capsys.readouterr().out
    assert "rpm" in shown
    assert "* total" in shown
    assert "<math" in page.read_text()
    assert run(["show", "a6vm215_crane2", "--json"]) == 0
    content = json.loads(capsys.readouterr().out)
    parts = np.sum([content["curve"]["terms_Nm"][name] for name in content["terms"]], axis=0)
    assert np.allclose(parts, content["curve"]["torque_Nm"])


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["show", "crane_150t"], "gear_ratio"),
        (["show", "ahc_55t_215"], "duration"),
        (["show", "churning"], "2000 rpm"),
        (["show", "tare_load"], "Hang the empty hook"),
        (["terms", "stribeck"], "C4"),
        (["terms", "--json"], '"stribeck"'),
    ],
)
def test_a_name_is_explained(arguments, said, capsys):
    assert run(arguments) == 0
    assert said in capsys.readouterr().out


@pytest.mark.parametrize("arguments", [["show", "nothing"], ["terms", "nothing"], ["compare", "a6vm215", "nothing"]])
def test_an_unknown_name_is_one_line(arguments, capsys):
    assert run(arguments) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_two_models_are_compared_on_a_grid_and_on_runs(tmp_path, capsys):
    model = wf.load_model("a6vm215_crane2")
    more = wf.save_model(model.with_values({"K4": 1.5 * model.value("K4")}), tmp_path / "more.yaml")
    assert run(["compare", "a6vm215_crane2", str(more), "--json", "--out", str(tmp_path / "page.html")]) == 0
    content = json.loads(capsys.readouterr().out)
    motors = wf.load_crane("crane_150t").groups["main"]
    assert content["rows"][0]["largest [N*m]"] == pytest.approx(0.5 * model.value("K4") * motors, rel=0.02)
    assert content["rows"][0]["mostly by"].startswith("motor_coulomb")
    result = wf.simulate("ahc_55t_215", wf.load_crane("crane_150t"), model, duration=4.0)
    path = wf.write_run(result.run, tmp_path / "run.csv")
    assert run(["compare", "a6vm215_crane2", str(more), str(path), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["rows"][0]["RMS [N*m]"] > 50.0
    assert run(["compare", "a6vm215_crane2", str(more), str(tmp_path), "--json"]) == 0  # the folder of runs
    assert json.loads(capsys.readouterr().out)["rows"][0]["RMS [N*m]"] > 50.0


def test_a_run_is_drawn(tmp_path, capsys):
    run_ = wf.from_frame({"time": [0.0, 1.0], "motor_speed [rpm]": [0.0, 60.0], "motor_torque": [0.0, 5.0]}, "a.csv")
    path = wf.write_run(run_, tmp_path / "a.csv")
    assert run(["plot", str(path), "--out", str(tmp_path / "a.html"), "--json"]) == 0
    channels = {row["channel"]: row for row in json.loads(capsys.readouterr().out)["channels"]}
    assert channels["motor_speed"]["largest"] == pytest.approx(60.0)
    assert channels["motor_speed"]["unit"] == "rpm"
    assert "figure" in (tmp_path / "a.html").read_text()
    assert run(["plot", str(tmp_path), "--out", str(tmp_path / "b.html"), "--json"]) == 0  # the folder of runs
    assert json.loads(capsys.readouterr().out)["channels"]


def test_which_winch_of_a_bag_is_looked_at_is_said_by_its_namespace(tmp_path, capsys):
    """`plot` and `compare` alone of those that read runs could not be told, and pointed to a verb that makes a file."""
    crane, bag, page = wf.load_crane("crane_150t"), str(tmp_path / "deck"), str(tmp_path / "a.html")
    topics = crane_topics(crane, ("main",))
    group = {"main": GroupSample(130e5, 25e5, 215 * CM3_PER_REV)}
    with BagWriter(tmp_path / "deck") as writer:
        for winch, speed in (("port", 10.0), ("starboard", 20.0)):
            for k in range(60):
                sample = Sample(0.02 * k, speed, hook_load=55e3, groups=group)
                for topic, message in topics.encode(sample, MESSAGES):
                    writer.write(f"/{winch}/{topic}", message, sample.time)
    for verb in (
        ["plot", bag, "--out", page, "--crane", "crane_150t"],
        ["compare", "a6vm215_crane1", "a6vm215_crane2", bag],
    ):
        assert run(verb) == 2
        assert "several winches: /port" in capsys.readouterr().err
        assert run([*verb, "--namespace", "starboard", "--json"]) == 0
        said = json.loads(capsys.readouterr().out)
        speeds = {row["channel"]: row["largest"] for row in said.get("channels", ())}
        rpm = speeds["motor_speed"] if speeds else said["rows"][0]["at [rpm]"]
        assert rpm == pytest.approx(20.0 / RPM, rel=1e-2)
    assert run(["plot", bag, "--out", str(tmp_path / "b.html"), "--namespace", "starboard"]) == 2
    assert "displacements are fractions; give the crane" in capsys.readouterr().err


def test_what_a_list_says_of_a_scenario_is_a_whole_sentence(capsys):
    assert run(["list", "scenarios", "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)
    assert [row["name"] for row in rows if not row["about"].endswith((".", ")"))] == []


def test_the_doctor_finds_nothing_wrong_here_and_says_what_it_looked_at(capsys, monkeypatch, tmp_path):
    monkeypatch.setenv("ROS_LOG_DIR", str(tmp_path / "of the first node"))  # which makes it
    assert run(["doctor", "--no-dds", "--json"]) == 0
    findings = json.loads(capsys.readouterr().out)
    areas = {"environment", "libraries", "configuration", "permissions", "compiled code", "clock"}
    assert areas <= {each["area"] for each in findings}


@pytest.mark.parametrize("domain", ["500", "102", "-1", "x", "\u00b2", "9" * 5000])
def test_the_doctor_reports_a_domain_that_cannot_be(domain, capsys, monkeypatch):
    pytest.importorskip("rclpy")
    monkeypatch.setenv("ROS_DOMAIN_ID", domain)
    assert run(["doctor", "--no-dds", "--json"]) == 2
    bad = [each for each in json.loads(capsys.readouterr().out) if each["state"] == "problem"]
    assert [each["what"] for each in bad] == ["ROS_DOMAIN_ID"]


@pytest.mark.parametrize("domain", ["", "0", "007", "101"])
def test_the_doctor_takes_a_domain_as_ros_reads_it(domain, capsys, monkeypatch):
    pytest.importorskip("rclpy")
    monkeypatch.setenv("ROS_DOMAIN_ID", domain)
    run(["doctor", "--no-dds", "--json"])
    states = {each["what"]: each["state"] for each in json.loads(capsys.readouterr().out)}
    assert states["ROS_DOMAIN_ID"] == "ok"


def test_names_complete():
    assert names.complete_model("a6vm215_cr") == ["a6vm215_crane1", "a6vm215_crane2", "a6vm215_crane2_loop2"]
    assert "stribeck" in names.complete_shown("strib")
    assert names.complete_kind("mo") == ["models"]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["show", "churnin"], "did you mean churning?"),
        (["simulate", "ahc_55t_21", "--out", "x.csv"], "did you mean ahc_55t_215"),
        (["simulate", "ahc_55t_215", "--hide", "tare", "--out", "x.csv"], "tare_load"),
        (["simulate", "ahc_55t_215", "--hide", "churnin", "--out", "x.csv"], "did you mean churning?"),
        (["compare", "a6vm215_crane2", "a6vm215_cran2"], "did you mean a6vm215_crane2"),
        (["check", "one.csv", "--crane", "crane_150t"], "one.csv: no such file or folder"),
        (["import", "logs", "--propose", "--map", "m.yaml"], "give the logs themselves, as logs/*.csv"),
        (["show", "motor_speed"], "in winch-friction list units"),
        (["show", "a6vm215_generated"], "in winch-friction list suppliers"),
        (["show", "files/run.csv"], "winch-friction plot draws runs"),
        (["show", "files/plant.yaml"], "a plant file, and show knows files of models, cranes and scenarios"),
        (["show", "a6vm215_crane2", "--out", "/proc/x.html"], "/proc/x.html: cannot be written"),
    ],
)
def test_a_slip_is_one_line_that_says_what_was_meant(words, said, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "logs").mkdir()
    (tmp_path / "files").mkdir()
    (tmp_path / "files" / "run.csv").write_text("time,motor_speed\n0,1\n")
    (tmp_path / "files" / "plant.yaml").write_text("schema: winch_friction.plant/1\n")
    assert run(words) == 2
    error = capsys.readouterr().err.strip()
    assert said in error
    assert len(error.splitlines()) == 1
    assert sorted(each.name for each in tmp_path.iterdir()) == ["files", "logs"]


@pytest.mark.parametrize("name", ["crane_150t", "churning", "ahc_55t_215"])
@pytest.mark.parametrize("option", [["--load", "100"], ["--crane", "crane_150t"]])
def test_an_option_of_a_models_curve_is_not_ignored_elsewhere(name, option, capsys):
    assert run(["show", name, *option]) == 2
    assert "--load and --crane are for the curve of a model" in capsys.readouterr().err
