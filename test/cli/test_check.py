"""`winch-friction check`, and the verbs that ask it first: nothing is written from data that contradict the crane."""

import json
import shutil
from dataclasses import replace

import pytest

from winch_friction.cli.main import run
from winch_friction.physics.channels import RPM
from winch_friction.records.runs import read_run, write_run
from winch_friction.records.strict_yaml import config_directory

TEST = config_directory() / "examples" / "practice_150t" / "test_02.parquet"
OTHER = TEST.with_name("test_01.parquet")


@pytest.fixture
def spoilt(tmp_path):
    """A run file with some columns changed, as CSV: no metadata tell on it."""

    def make(**factors):
        read = read_run(TEST)
        columns = {name: values * factors.get(name.rpartition(".")[2], 1.0) for name, values in read.columns.items()}
        path = tmp_path / "spoilt.csv"
        write_run(replace(read, columns=columns), path)
        return path

    return make


SPOILT = {
    "kg under [t]": ({"hook_load": 1e3}, "hook_load holds kg under [t]"),
    "Pa under [bar]": ({"pressure_a": 1e5, "pressure_b": 1e5}, "pressure holds Pa under [bar]"),
    "rad/s under [rpm]": ({"motor_speed": RPM}, "motor_speed holds rad/s under [rpm]"),
    "speed sign": ({"motor_speed": -1.0}, "the sign of motor_speed is flipped"),
}


@pytest.mark.parametrize("name", SPOILT)
def test_the_first_line_names_the_mistake(name, spoilt, capsys):
    factors, words = SPOILT[name]
    path = spoilt(**factors)
    assert run(["check", str(path), "--crane", "crane_150t", "--model", "a6vm215_crane2"]) == 2
    assert capsys.readouterr().out.splitlines()[0].startswith(words)


@pytest.mark.parametrize("name", SPOILT)
def test_nothing_is_written_from_a_contradiction(name, spoilt, tmp_path, capsys):
    factors, words = SPOILT[name]
    path, out = str(spoilt(**factors)), tmp_path / "out"
    model = ["--crane", "crane_150t", "--model", "a6vm215_crane2"]
    for verb in (
        ["gap", path, *model, "--out", str(out)],
        ["replay", path, *model, "--out", str(out / "replayed.csv")],
        ["identify", "system", path, str(OTHER), "--motor", "a6vm215", "--crane", "crane_150t", "--out",
         str(out / "model.yaml")],
    ):  # fmt: skip
        assert run(verb) == 2
        said = capsys.readouterr().err.strip().splitlines()[-1]
        assert words in said, verb
        assert "Traceback" not in said
    assert not out.exists()


def test_force_goes_on_and_is_recorded(spoilt, tmp_path, capsys):
    path = spoilt(motor_speed=-1.0)
    out = tmp_path / "replayed.parquet"
    arguments = ["--model", "a6vm215_crane2", "--out", str(out), "--json", "--force"]
    assert run(["replay", str(path), *arguments]) == 0
    assert "sign of motor_speed" in json.loads(capsys.readouterr().out)["forced"]
    assert "sign of motor_speed" in read_run(out, complete=False).metadata["forced"]


def test_a_good_run_is_plausible_with_a_page_and_json(tmp_path, capsys):
    arguments = [str(TEST), "--crane", "crane_150t", "--model", "a6vm215_crane2", "--out", str(tmp_path)]
    assert run(["check", *arguments]) == 0
    assert capsys.readouterr().out.startswith("plausible")
    content = json.loads((tmp_path / "check.json").read_text())
    assert content["schema"] == "winch_friction.check/1"
    assert content["plausible"] is True
    page = (tmp_path / "check.html").read_text()
    for column in read_run(TEST).columns:
        assert column in page
    assert "http://" not in page.replace("http://www.w3.org", "")


def test_two_runs_of_one_name_are_refused(tmp_path, capsys):
    """In check.json the second would stand for both."""
    for folder in ("monday", "tuesday"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "log.parquet").write_bytes(TEST.read_bytes())
    paths = [str(tmp_path / folder / "log.parquet") for folder in ("monday", "tuesday")]
    assert run(["check", *paths, "--crane", "crane_150t"]) == 2
    assert f"log.parquet: two runs have this name ({', '.join(paths)})" in capsys.readouterr().err


IDENTIFY = ["identify", "system", "--motor", "a6vm215", "--out", "winch.yaml"]


@pytest.mark.parametrize(
    ("verb", "between"),
    [(["gap", "--model", "a6vm215_crane2"], []), (IDENTIFY, []), (IDENTIFY, ["--held-out"])],
    ids=["gap", "fitted", "held out"],
)
def test_of_copies_in_two_folders_the_folders_are_told(tmp_path, capsys, monkeypatch, verb, between):
    """It was "test_02.parquet and test_02.parquet hold the same samples"."""
    (tmp_path / "monday").mkdir()
    monkeypatch.chdir(tmp_path)
    one, two = str(TEST), str(shutil.copy(TEST, tmp_path / "monday"))
    assert run([*verb, one, *between, two, "--crane", "crane_150t"]) == 2
    assert f"{TEST.name}: two runs have this name ({one}, {two})" in capsys.readouterr().err


def test_a_cell_of_1e30_is_named_with_its_place(tmp_path, capsys):
    read = read_run(TEST)
    pressure = read["main.pressure_a"].copy()
    pressure[41] = 1e30
    path = tmp_path / "cell.csv"
    write_run(replace(read, columns={**read.columns, "main.pressure_a": pressure}), path)
    assert run(["check", str(path), "--crane", "crane_150t"]) == 2
    first = capsys.readouterr().out.splitlines()[0]
    assert "main.pressure_a = 1e+30" in first
    assert "sample 42" in first


def test_what_to_log_next_is_said_line_by_line(capsys):
    arguments = ["check", str(TEST), "--crane", "crane_150t", "--model", "a6vm215_crane2"]
    assert run([*arguments, "--json"]) == 0
    asked = json.loads(capsys.readouterr().out)["log_next"]
    assert run(arguments) == 0
    said = [line for line in capsys.readouterr().out.splitlines() if line.startswith("log next: ")]
    assert len(said) == len(asked) > 0
    assert [line.removeprefix("log next: ")[:40] for line in said] == [line[:40] for line in asked]


def test_no_crane_is_assumed(tmp_path, capsys):
    path = tmp_path / "plain.csv"
    write_run(replace(read_run(TEST), metadata={}), path)
    assert run(["check", str(path)]) == 2
    assert "which crane?" in capsys.readouterr().err
    assert run(["check", str(TEST)]) == 0  # Parquet remembers
    assert "taken as 'crane_150t'" in capsys.readouterr().err


def test_folders_stand_for_their_runs_and_truth_is_none(tmp_path, capsys):
    read = replace(read_run(TEST), metadata={})
    folder = tmp_path / "runs"
    write_run(read, folder / "a.parquet")
    write_run(read, folder / "truth" / "a_truth.parquet")
    assert run(["check", str(folder), "--crane", "crane_150t", "--json"]) == 0
    assert list(json.loads(capsys.readouterr().out)["channels"]) == ["a.parquet"]
    (tmp_path / "empty").mkdir()
    assert run(["check", str(tmp_path / "empty"), "--crane", "crane_150t"]) == 2
    assert "no run in there" in capsys.readouterr().err


def test_a_model_of_another_crane_is_refused(tmp_path, capsys):
    for verb in (["check", str(TEST)], ["replay", str(TEST)], ["gap", str(TEST), "--out", str(tmp_path / "gap")]):
        assert run([*verb, "--crane", "emps", "--model", "a6vm215_crane2"]) == 2
        assert "does not belong to crane 'emps'" in capsys.readouterr().err


def test_a_slow_log_is_replayed_and_its_age_limit_told(tmp_path, capsys):
    read = read_run(TEST)  # 10 Hz, without a commanded speed
    path = tmp_path / "slow.csv"
    write_run(replace(read, columns={**read.columns, "speed_reference": read["motor_speed"]}), path)
    arguments = ["--model", "a6vm215_crane2", "--json"]
    assert run(["replay", str(path), *arguments]) == 0
    shown = capsys.readouterr()
    assert json.loads(shown.out)["active_share"] > 0.9
    assert "logged at 10 Hz" in shown.err


def test_a_silent_compensator_is_explained(capsys):
    assert run(["replay", str(TEST), "--model", "a6vm215_crane2", "--json"]) == 0
    shown = capsys.readouterr()
    assert json.loads(shown.out)["active_share"] == 0.0
    assert "has no speed_reference" in shown.err


def test_one_load_is_not_enough_to_identify_a_system(tmp_path, capsys):
    out = tmp_path / "model.yaml"
    assert run(["identify", "system", str(TEST), "--motor", "a6vm215", "--out", str(out)]) == 2
    assert "at least two loads" in capsys.readouterr().err
    assert not out.exists()


def test_a_fraction_under_per_cent_is_refused(tmp_path, capsys):
    lines = (config_directory() / "suppliers" / "a6vm215_generated.csv").read_text().splitlines()
    head = next(k for k, line in enumerate(lines) if not line.startswith("#"))
    place = [h.split(" ")[0] for h in lines[head].split(",")].index("efficiency")
    assert "%" in lines[head].split(",")[place]
    for k in range(head + 1, len(lines)):
        cells = lines[k].split(",")
        cells[place] = f"{float(cells[place]) / 100:.4f}"
        lines[k] = ",".join(cells)
    table, out = tmp_path / "table.csv", tmp_path / "seed.yaml"
    table.write_text("\n".join(lines))
    assert run(["identify", "motor", str(table), "--out", str(out), "--no-complex"]) == 2
    assert "a fraction under [%]" in capsys.readouterr().err
    assert not out.exists()
