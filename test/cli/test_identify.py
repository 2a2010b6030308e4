"""`winch-friction identify`: the shipped example end to end, and bad input that leaves good files alone."""

import json
import os
import re
import shutil

import pytest
import yaml

from winch_friction.cli.identify import PRACTICE
from winch_friction.cli.inputs import refuse_foreign
from winch_friction.cli.main import run
from winch_friction.identification.practice import read_practice
from winch_friction.records.model_file import load_model
from winch_friction.records.runs import read_run, write_run
from winch_friction.records.strict_yaml import config_directory

EXAMPLE = config_directory() / "examples" / "practice_150t"
QUICK = ["--restarts", "1", "--evaluations", "300"]


@pytest.fixture(scope="module")
def practice(tmp_path_factory):
    """The shipped example, once, with its JSON."""
    import contextlib
    import io

    out = tmp_path_factory.mktemp("practice")
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        status = run(["identify", "practice", "practice_150t", "--out", str(out), "--resamples", "4", "--json", *QUICK])
    assert status == 0
    return out, json.loads(said.getvalue())


def test_practice_writes_report_and_seeds(practice):
    out, said = practice
    assert sorted(path.name for path in out.iterdir()) == ["motor.yaml", "report.html", "seed.yaml"]
    seed = load_model(out / "seed.yaml")
    assert set(seed.as_dict()) == {"K1", "K2", "K3", "K4", "K5", "C1", "C3", "C4", "C5", "C6"}
    assert (seed.std > 0).all()
    assert len(seed.provenance["data_sha256"]) == 15
    assert said["seed"]["parameters"]["K2"]["value"] == pytest.approx(seed.value("K2"))
    assert load_model(out / "motor.yaml").covariance is not None
    refuse_foreign(out, ("motor.yaml",), "report.html", PRACTICE)  # a second call may replace them


def test_the_seed_holds_the_truth(practice):
    out, _ = practice
    seed, truth = load_model(out / "seed.yaml"), load_model("a6vm215_crane2")
    for name, std in zip(seed.parameter_names, seed.std, strict=True):
        assert abs(seed.value(name) - truth.value(name)) < 3.5 * std, name


def test_the_summary_states_errors_within_the_papers(practice):
    _, said = practice
    text = " ".join(said["summary"])
    above, below = map(
        float, re.search(r"5 held-out tests: within ([\d.]+) % .* above 250 rpm, ([\d.]+) %", text).groups()
    )
    assert above < 1.0
    assert below < 2.0
    for bar in re.findall(r"within ([\d.]+) bar RMS", text):
        assert float(bar) < 5.0
    assert "K3" in text


def test_the_report_is_one_page_with_the_papers_tables(practice):
    out, _ = practice
    page = (out / "report.html").read_text(encoding="utf-8")
    assert not re.search(r"(src|href)=.https?://", page)
    for expected in ("paper 2 Table 3", "paper 2 Table 4", "paper 2 Tables 2 and 5", "C4 [rpm]",
                     "Huhtala: a reconstruction", "paper 1 Fig 6 and 7", "GENERATED, not measured",
                     "K1 and C5 (cosine 1.00000)"):  # fmt: skip
        assert expected in page, expected
    for figure in (3, 6, 7, 8, 10, 13, 16, 17):
        assert f"paper 2 Fig {figure}" in page, figure
    for figures in ("paper 2 Fig 11, 12, 14", "paper 2 Fig 18 and 19", "paper 2 Fig 15, 20-23"):
        assert figures in page
    assert page.count('<figure class="plot"') >= 14
    assert "nan" not in re.sub(r"<svg.*?</svg>", "", page, flags=re.DOTALL).lower().split()


@pytest.fixture
def folder(tmp_path):
    """A copy of the example to break."""
    return shutil.copytree(EXAMPLE, tmp_path / "example")


GOOD = f"<title>{PRACTICE}good</title>"  # what an earlier call has left


@pytest.fixture
def good(tmp_path):
    """An output folder with good results."""
    out = tmp_path / "out"
    out.mkdir()
    for name in ("seed.yaml", "motor.yaml", "report.html"):
        (out / name).write_text(GOOD)
    return out


def remove_test(folder):
    (folder / "test_05.parquet").unlink()


def efficiency_above_one(folder):
    path = folder / "supplier.csv"
    lines = path.read_text().splitlines()
    lines[40] = lines[40].rpartition(",")[0] + ",101.5"
    path.write_text("\n".join(lines))


def no_table(folder):
    (folder / "supplier.csv").unlink()


def misspelt_key(folder):
    path = folder / "practice.yaml"
    path.write_text(path.read_text().replace("motor_model:", "motor_modell:"))


def one_direction(folder):
    import numpy as np

    from winch_friction.records.runs import read_run, write_run

    run_ = read_run(folder / "test_03.parquet")
    columns = dict(run_.columns) | {"motor_speed": np.abs(run_["motor_speed"])}
    from dataclasses import replace

    write_run(replace(run_, columns=columns), folder / "test_03.parquet")


def nan_in_a_log(folder):
    from dataclasses import replace

    from winch_friction.records.runs import read_run, write_run

    run_ = read_run(folder / "test_02.parquet")
    pressure = run_["main.pressure_a"].copy()
    pressure[99] = float("nan")
    write_run(replace(run_, columns={**run_.columns, "main.pressure_a": pressure}), folder / "test_02.parquet")


def a_copy_held_out(folder):
    content = yaml.safe_load((folder / "practice.yaml").read_text())
    shutil.copy(folder / content["tests"][0], folder / "copy.parquet")
    content["held_out_tests"] = ["copy.parquet"]
    (folder / "practice.yaml").write_text(yaml.safe_dump(content))


def a_copy_compensates(folder):
    """The heave-compensated run that the page proves the seed by was one that it was fitted to."""
    content = yaml.safe_load((folder / "practice.yaml").read_text())
    shutil.copy(folder / content["tests"][0], folder / "ahc.parquet")
    content["ahc_tests"] = ["ahc.parquet"]
    (folder / "practice.yaml").write_text(yaml.safe_dump(content))


BROKEN = {
    a_copy_compensates: r"ahc.parquet hold the same samples: a copy proves nothing",
    a_copy_held_out: r"copy.parquet hold the same samples: a copy proves nothing",
    remove_test: r"test_05.parquet: no such file",
    efficiency_above_one: r"supplier.csv row 41: column 'efficiency' = 101.5 is above 1",
    no_table: r"supplier.csv: cannot be read",
    misspelt_key: r"practice.yaml: unknown key 'motor_modell'",
    one_direction: r"motor_speed has no sign.*test_03.parquet",
    nan_in_a_log: r"test_02.parquet row 1\d\d: column 'main.pressure_a' is not a finite number",
}


@pytest.mark.parametrize("damage", BROKEN, ids=lambda damage: damage.__name__)
def test_a_broken_folder_is_one_line_and_good_results_stay(damage, folder, good, capsys):
    damage(folder)
    assert (
        run(
            ["identify", "practice", str(folder), "--out", str(good), *QUICK[:2], "--evaluations", "100", "--overwrite"]
        )
        == 2
    )
    said = capsys.readouterr().err.strip().splitlines()
    assert len([line for line in said if line.startswith("winch-friction:")]) == 1
    assert re.search(BROKEN[damage], said[-1]), said
    assert {path.read_text() for path in good.iterdir()} == {GOOD}


def test_a_test_may_be_a_bag(folder):
    bag = write_run(read_run(folder / "test_01.parquet"), folder / "test_01")
    text = (folder / "practice.yaml").read_text()
    (folder / "practice.yaml").write_text(text.replace("test_01.parquet", bag.name))
    read = read_practice(folder)
    assert read.tests[0].name == "test_01"
    assert "test_02.parquet" in read.hashes


def test_the_crane_is_named_from_the_folder_as_every_other_file_is(folder, tmp_path):
    """From another folder than its own, a practice with a crane file of one's own was refused."""
    shutil.copy(config_directory() / "cranes" / "crane_150t.yaml", tmp_path / "mine.yaml")
    text = (folder / "practice.yaml").read_text()
    for named in (os.path.relpath(tmp_path / "mine.yaml", folder), str(tmp_path / "mine.yaml")):
        (folder / "practice.yaml").write_text(text.replace("crane: crane_150t", f"crane: {named}"))
        assert read_practice(folder).crane.name == "crane_150t"


def test_a_folder_without_practice_file(tmp_path, capsys):
    assert run(["identify", "practice", str(tmp_path), "--out", str(tmp_path / "out")]) == 2
    assert "'practice.yaml' is missing" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_motor_by_shipped_name(tmp_path, capsys):
    out = tmp_path / "seed.yaml"
    arguments = ["identify", "motor", "a6vm280_generated", "--out", str(out), "--model", "mj3", "--model", "mj4"]
    assert run([*arguments, "--json", *QUICK]) == 0
    said = json.loads(capsys.readouterr().out)
    assert [score["model"] for score in said["scores"]] == ["mj4", "mj3"]
    assert said["scores"][0]["cost"] <= said["scores"][0]["cost_complex"]
    assert load_model(out).value("K2") == pytest.approx(2.58e10, rel=0.02)


@pytest.mark.parametrize(
    ("displacements", "said"),
    [((280, 140), "held-out displacement"), ((280,), "BIC, with one displacement in the fit")],
)
def test_what_recommends_a_motor_model_is_said(tmp_path, capsys, displacements, said):
    rows = [
        f"{speed},{pressure},{displacement},{95 - speed / 1000 - 300 / pressure + (speed * pressure % 7) / 50:.2f}"
        for displacement in displacements
        for speed in (500, 1200, 2400)
        for pressure in (60, 150, 340)
    ]
    table, out = tmp_path / "table.csv", tmp_path / f"{60 * 's'}[1]{60 * 's'}[red].yaml"  # neither broken nor markup
    table.write_text("\n".join(["speed [rpm],pressure [bar],displacement [cm^3/rev],efficiency [%]", *rows]))
    arguments = ["identify", "motor", str(table), "--out", str(out), "--overwrite", "--no-complex"]
    assert run(["--plain", *arguments, "--use", "wilson"]) == 0
    told = capsys.readouterr().out
    assert f"wrote wilson to {out}" in told
    assert "recommended" not in told  # of one there is nothing to choose
    assert "nan" not in told  # the columns of Box's method were, without it
    assert run(["--plain", *arguments, "--model", "wilson", "--model", "thoma", "--use", "thoma"]) == 0
    assert f"recommended by {said}: wilson (--use wilson writes it)\nwrote thoma to {out}" in capsys.readouterr().out
    assert run([*arguments, "--use", "wilson", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["recommended_by"] == said


def test_the_best_motor_model_is_chosen_among_all_unless_some_are_named(tmp_path, capsys):
    """It was MJ4, whatever the table said."""
    arguments = ["identify", "motor", "a6vm170_generated", "--use", "best", "--no-complex", "--json"]
    for chosen, count in (([], 13), (["--model", "wilson", "--model", "mj3"], 2)):
        assert run([*arguments, *chosen, "--out", str(tmp_path / f"{count}.yaml")]) == 0
        assert len(json.loads(capsys.readouterr().out)["scores"]) == count


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--speed", "2500-400"], r"--speed '2500-400': the first number must be below the second"),
        (["--pressure", "all"], r"--pressure 'all': give two numbers with a dash"),
        (["--model", "dorey"], r"motor model 'dorey' is not known"),
        (["--weighting", "both"], r"weighting 'both' is not known"),
        (["--max-displacement", "1e300"], r"'--max-displacement': .*376991"),
        (["--speed", "1-2"], r"no row lies inside the range"),
    ],
)
def test_bad_options_leave_the_seed_alone(tmp_path, capsys, options, message):
    out = tmp_path / "seed.yaml"
    out.write_text("good")
    arguments = ["identify", "motor", "a6vm280_generated", "--out", str(out), "--overwrite", "--no-complex"]
    assert run([*arguments, *options]) == 2
    assert re.search(message, capsys.readouterr().err)
    assert out.read_text() == "good"


def test_system_on_the_examples_logs(tmp_path, capsys):
    out = tmp_path / "crane.yaml"
    tests = [str(EXAMPLE / f"test_0{k}.parquet") for k in range(1, 7)]
    arguments = ["identify", "system", *tests, "--motor", "a6vm215", "--out", str(out), "--resamples", "0"]
    assert run([*arguments, "--held-out", str(EXAMPLE / "test_09.parquet"), "--json", *QUICK]) == 0
    said = json.loads(capsys.readouterr().out)
    assert said["errors_percent_of_nominal"]["test_09.parquet"]["above_250_rpm"] < 1.0
    assert "K1 = C5" in said["tied"]
    assert load_model(out).value("C1") == pytest.approx(155e-7, rel=0.05)
