"""Whatever is wrong with the inputs of a verb is said at once: one line for each problem, with file and place."""

import contextlib
import os
import pickle
import re

import pytest
import yaml

from winch_friction.cli.main import run
from winch_friction.physics.errors import InputError, Problems
from winch_friction.records.model_file import load_model
from winch_friction.records.runs import read_run
from winch_friction.records.strict_yaml import config_directory

HEAD = ["time [s]", "motor_speed [rpm]", "motor_torque [N*m]", "hook_load [kg]"]
ROWS = [[f"{0.02 * k:.2f}", "60", "12", "1000"] for k in range(200)]


def table(path, head=HEAD, cells=None, cut=()):
    rows = [list(row) for row in ROWS]
    for (line, column), text in (cells or {}).items():
        rows[line - 2][column] = text
    for line in cut:
        rows[line - 2] = rows[line - 2][:2]
    path.write_text("\n".join(",".join(row) for row in [head, *rows]) + "\n")
    return path


def problems_of(path, **options):
    with pytest.raises(InputError) as caught:
        read_run(path, **options)
    return list(caught.value.problems)


def said(capsys):
    lines = capsys.readouterr().err.splitlines()
    assert all(line.startswith("winch-friction: ") for line in lines)
    return [line.removeprefix("winch-friction: ") for line in lines]


def test_problems_are_gathered_and_travel():
    problems = Problems()
    for words in ("one", "two\n  lines"):
        with problems:
            raise InputError(words)
    with problems, pytest.raises(KeyError):
        raise KeyError("a defect is none of the user's")
    with pytest.raises(InputError) as caught:
        problems.say()
    assert caught.value.problems == ("one", "two lines")
    assert str(caught.value) == "one | two lines"
    assert pickle.loads(pickle.dumps(caught.value)).problems == ("one", "two lines")
    Problems().say()  # nothing to say


def test_every_unit_that_cannot_be_is_named(tmp_path):
    head = ["time [s]", "motor_speed [bananas]", "motor_torque [m]", "hook_load [kg"]
    found = problems_of(table(tmp_path / "run.csv", head))
    assert len(found) == 3
    assert all(any(word in each for each in found) for word in ("bananas", "'m'", "hook_load [kg"))


def test_every_cell_that_is_no_number_is_named_up_to_three_a_column(tmp_path):
    cells = {(9, 1): "abc", (10, 3): "--", **{(line, 2): "#REF!" for line in range(20, 80)}}
    found = problems_of(table(tmp_path / "run.csv", cells=cells))
    assert [re.search(r"line (\d+)", each)[1] for each in found] == ["9", "20", "21", "22", "10"]
    assert "57 more like it in this column" in found[3]


def test_decimal_commas_are_told_once_for_a_file_with_what_reads_them(tmp_path):
    """It was three lines for each column, and one more for each that then held no number."""
    columns = 4
    cells = {(line, column): f'"{line},{column}"' for line in range(2, 202) for column in range(columns)}
    (found,) = problems_of(table(tmp_path / "run.csv", cells=cells))
    assert found.count("'") == 8
    assert "decimal comma in columns 'time [s]', " in found
    assert " and 1 more (as '2,0', line 2); winch-friction import reads" in found
    (found,) = problems_of(table(tmp_path / "run.csv", cells={(line, 3): f'"{line},5"' for line in range(2, 202)}))
    assert "decimal comma in column '" in found
    assert " more" not in found
    found = problems_of(table(tmp_path / "run.csv", cells={(9, 1): '"1,5"', (10, 2): '"1,5"', (11, 2): '"1,5,5"'}))
    assert [re.search(r"line (\d+)", each)[1] for each in found] == ["9", "10", "11"]


def test_a_time_that_is_no_number_is_said_once(tmp_path):
    """A second line said of it that it is no time, with another advice."""
    (cell,) = problems_of(table(tmp_path / "run.csv", cells={(50, 0): "abc"}))
    assert cell.endswith("line 50, column 'time [s]': 'abc' is not a number; fill it in or remove the row")
    whole = problems_of(table(tmp_path / "run.csv", cells={(line, 0): f"{line} s" for line in range(2, 202)}))
    assert all("import reads other ways of writing" in each for each in whole)
    found = problems_of(table(tmp_path / "run.csv", cells={(50, 0): "abc", (90, 0): "0.1", (70, 0): ""}))
    assert sorted(int(re.search(r"line (\d+)", each)[1]) for each in found) == [50, 70]


def test_lines_of_another_width_are_named_up_to_three(tmp_path):
    found = problems_of(table(tmp_path / "run.csv", cut=(5, 7, 9, 11, 13)))
    assert [re.search(r"line (\d+)", each)[1] for each in found] == ["5", "7", "9"]
    assert "2 more lines" in found[-1]


def test_a_misspelt_column_a_unit_and_time_that_goes_back_are_said_together(tmp_path):
    head = ["time [s]", "motor_sped [rpm]", "motor_torque [kN]", "hook_load [kg]"]
    found = problems_of(table(tmp_path / "run.csv", head, {(50, 0): "0.1"}))
    assert len(found) == 3
    assert any("did you mean motor_speed" in each for each in found)
    assert any("goes back" in each and "line 50" in each for each in found)


def test_every_key_of_a_model_file_that_cannot_be_is_a_line_of_its_own(tmp_path, capsys):
    content = yaml.safe_load((config_directory() / "models" / "a6vm215_crane2.yaml").read_text())
    content["parameters"]["K44"] = content["parameters"].pop("K4")
    content["parameters"]["K1"]["value"] = "much"
    content["parameters"]["C5"]["unit"] = "bananas"
    content["terms"].append("stribek")
    content["craen"] = content.pop("crane")
    path = tmp_path / "bad.yaml"
    path.write_text(yaml.safe_dump(content))
    assert run(["show", str(path)]) == 2
    lines = said(capsys)
    for words in ("'K4' is missing", "'K44'", "K1: value", "bananas", "did you mean stribeck", "'craen'"):
        assert sum(words in line for line in lines) == 1, (words, lines)
    assert len(lines) == 6
    assert all(str(path) in line or "stribek" in line for line in lines)


def test_a_crane_s_problems_are_told_once_each(tmp_path, capsys):
    content = yaml.safe_load((config_directory() / "cranes" / "crane_150t.yaml").read_text())
    content["gear_ration"] = content.pop("gear_ratio")
    content["inertia"] = "-5 kg*m^2"
    path = tmp_path / "bad.yaml"
    path.write_text(yaml.safe_dump(content))
    assert run(["show", str(path)]) == 2
    lines = said(capsys)
    assert len(lines) == 3, lines
    assert all(str(path) in line for line in lines)
    assert any("did you mean gear_ratio" in line for line in lines)


@pytest.mark.parametrize("verb", ["check", "gap", "plot", "replay", "simulate", "compare"])
def test_model_crane_and_runs_are_said_together(verb, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    bad = str(table(tmp_path / "run.csv", cells={(9, 1): "abc"}))
    named = ["--crane", "crane_150x", "--model", "a6vm215_crane22"]
    words = {
        "replay": [bad, *named], "simulate": ["ahc_55t_21", *named], "compare": ["a6vm215_crane22", "a6vm215_crane21"],
    }.get(verb, [bad, "nothere.csv", *named])  # fmt: skip
    assert run([verb, *words]) == 2
    lines = said(capsys)
    wanted = {
        "replay": ("crane_150x", "crane22", "'abc'"), "simulate": ("crane_150x", "crane22", "ahc_55t_21"),
        "compare": ("crane22", "crane21"),
    }.get(verb, ("crane_150x", "crane22", "'abc'", "nothere.csv"))  # fmt: skip
    for word in wanted:
        assert sum(f"{word}" in line.partition(";")[0] for line in lines) == 1, (word, lines)
    assert len(lines) == len(wanted)
    assert [each.name for each in tmp_path.iterdir()] == ["run.csv"]


def test_a_good_model_stays_good():
    assert load_model("a6vm215_crane2").crane == "crane_150t"


def test_a_practice_s_crane_tests_and_table_are_said_together(tmp_path, capsys):
    shipped = config_directory() / "examples" / "practice_150t"
    for path in shipped.iterdir():
        (tmp_path / path.name).write_bytes(path.read_bytes())
    content = yaml.safe_load((shipped / "practice.yaml").read_text())
    content["tests"][2:4] = ["test_33.parquet", "test_44.parquet"]
    (tmp_path / "practice.yaml").write_text(yaml.safe_dump({**content, "crane": "crane_150x", "colour": "red"}))
    lines = (shipped / "supplier.csv").read_text().splitlines()
    for row, (column, text) in {20: (1, "x"), 21: (1, "y"), 22: (2, "z")}.items():
        cells = lines[row - 1].split(",")
        cells[column] = text
        lines[row - 1] = ",".join(cells)
    (tmp_path / "supplier.csv").write_text("\n".join(lines) + "\n")
    assert run(["identify", "practice", str(tmp_path), "--out", str(tmp_path / "out")]) == 2
    lines = said(capsys)
    for words in ("crane_150x", "test_33", "test_44", "row 20", "row 21", "row 22", "'colour'"):
        assert sum(words in line for line in lines) == 1, (words, lines)
    assert len(lines) == 7
    assert not (tmp_path / "out").exists()


def test_a_scenario_s_problems_are_a_line_each(tmp_path, capsys):
    content = yaml.safe_load((config_directory() / "scenarios" / "ahc_55t_215.yaml").read_text())
    path = tmp_path / "bad.yaml"
    path.write_text(yaml.safe_dump({**content, "duration": -4, "mode": "sideways", "lode": 4}))
    assert run(["simulate", str(path), "--out", str(tmp_path / "x.csv")]) == 2
    lines = said(capsys)
    assert len(lines) == 3
    assert all(line.startswith(f"{path}: ") for line in lines)


def test_a_misspelt_key_is_known_by_the_one_that_is_missing(tmp_path, capsys):
    content = yaml.safe_load((config_directory() / "models" / "a6vm215_crane2.yaml").read_text())
    content["parameters"]["K44"] = content["parameters"].pop("K4")
    path = tmp_path / "bad.yaml"
    path.write_text(yaml.safe_dump(content))
    assert run(["show", str(path)]) == 2
    assert "unknown key 'K44'; did you mean K4" in capsys.readouterr().err


KINDS = [("--crane", "crane"), ("--model", "model"), ("--plant", "plant"), (None, "scenario")]


@pytest.mark.parametrize(("option", "kind"), KINDS)
def test_a_file_of_another_kind_is_refused_by_that_alone(tmp_path, capsys, option, kind):
    """A crane given as the model broke a dozen rules of models, each told."""
    other = tmp_path / "other.yaml"
    other.write_text(
        yaml.safe_dump({"schema": f"winch_friction.{'crane' if kind != 'crane' else 'model'}/1", "name": "x"})
    )
    out = ["--out", str(tmp_path / "run.csv")]
    words = ["simulate", "ahc_55t_215", option, str(other)] if option else ["simulate", str(other)]
    assert run([*words, *(["--crane", "crane_150t"] if option != "--crane" else []), *out]) == 2
    told = said(capsys)
    assert len(told) == 1
    assert "other.yaml: this is a " in told[0]
    assert f"a {kind} file is asked for" in told[0]


def test_a_log_given_as_a_scenario_is_told_as_no_scenario(tmp_path, capsys):
    assert run(["simulate", str(table(tmp_path / "run.csv")), "--out", str(tmp_path / "out.csv")]) == 2
    assert "is this a scenario file?" in said(capsys)[0]


@pytest.mark.parametrize("words", [["simulate", "AHC_55T_215"], ["show", "A6VM215_CRANE2"]])
def test_a_name_in_capitals_is_known_again(words, capsys):
    assert run(words) == 2
    assert f"did you mean {words[1].lower()}" in said(capsys)[0]


# -- of every verb: what it writes to, its crane and model, and all that it reads
def lines_of(capsys, *words):
    """The problems that a call is refused with, by the file or option that each begins with."""
    assert run([str(each) for each in words]) == 2
    return [line.partition(":")[0].strip("'").split("' is neither")[0] for line in said(capsys)]


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "empty.csv").write_text("")
    (tmp_path / "there.csv").write_text("mine")
    (tmp_path / "there.html").write_text("mine")
    (tmp_path / "params.yaml").write_bytes(b"\xff\xfe")
    return tmp_path


@pytest.mark.parametrize(
    ("words", "problems"),
    [
        ("import empty.csv lost.csv --propose --crane nope --map map.yaml", ["nope", "empty.csv", "lost.csv"]),
        ("import lost.csv more.csv --propose --map map.yaml", ["lost.csv", "more.csv"]),
        ("import empty.csv --propose --map there.csv", ["there.csv", "empty.csv"]),
        ("fleet check lost more --crane nope --model no --out f", ["lost", "more", "nope", "no"]),
        ("simulate ahc_55t_215 --crane nope --hide foo --hide bar --out there.csv",
         ["--hide foo", "--hide bar", "there.csv", "nope"]),
        ("gap lost.csv empty.csv --crane nope --model no --out there.csv",
         ["--out there.csv/model.yaml", "no", "nope", "lost.csv", "empty.csv"]),
        ("replay lost.csv --crane nope --model no --out there.csv --params-file params.yaml",
         ["--out there.csv", "params.yaml", "no", "nope", "lost.csv"]),
        ("plot lost.csv empty.csv --out there.html", ["--out there.html", "lost.csv", "empty.csv"]),
        ("plot lost.csv --out there.html --crane nope --model no", ["--out there.html", "no", "nope", "lost.csv"]),
        ("check lost.csv --crane nope --out there.csv", ["--out there.csv/check.html", "nope", "lost.csv"]),
        ("convert run lost.csv there.csv a.xls --crane nope", ["--out there.csv", "a.xls", "nope", "lost.csv"]),
        ("compare one two --crane nope --out there.html", ["--out there.html", "one", "two", "nope"]),
    ],
)  # fmt: skip
def test_what_a_verb_writes_to_hides_nothing_of_what_it_reads(here, capsys, words, problems):
    assert lines_of(capsys, *words.split()) == problems
    assert (here / "there.csv").read_text() == (here / "there.html").read_text() == "mine"


@pytest.mark.parametrize("verb", ["check RUN --crane crane_150t", "plot RUN", "import RUN --propose --map m.yaml"])
def test_a_pipe_is_no_run_and_nobody_waits_for_it(here, capsys, verb):
    os.mkfifo(here / "pipe.csv")
    assert run(verb.replace("RUN", "pipe.csv").split()) == 2
    assert said(capsys) == ["pipe.csv: neither a file nor a folder"]


@pytest.mark.parametrize("verb", ["check RUN --crane crane_150t", "import RUN --propose --map m.yaml"])
@pytest.mark.parametrize("at", [1, 7])
def test_a_quotation_mark_that_nothing_closes_is_told_by_its_line(here, capsys, verb, at):
    """It was "line 657: field larger than field limit (131072)"."""
    lines = [",".join(HEAD), *(f"{0.02 * k:.2f},60,12,1000" for k in range(9000))]
    lines[at - 1] = lines[at - 1].replace("60", '"60').replace("motor_speed", '"motor_speed')
    (here / "run.csv").write_text("\n".join(lines))
    assert run(verb.replace("RUN", "run.csv").split()) == 2
    (line,) = said(capsys)
    assert line.startswith(f"run.csv: line {at}: a cell that begins here has no end")


@pytest.mark.parametrize("words", ["a6vm215_crane2", "churning", "churning --json"])
def test_a_page_is_there_whoever_stops_reading_what_is_printed(here, monkeypatch, words):
    """`show MODEL --out PAGE | head` wrote none, and said nothing."""

    def closed(*_, **__):
        raise BrokenPipeError

    monkeypatch.setattr("builtins.print", closed)
    monkeypatch.setattr("winch_friction.cli.show.show_json", closed)
    with contextlib.suppress(BrokenPipeError):
        run(["show", *words.split(), "--out", "page.html"])
    assert "<html" in (here / "page.html").read_text()


@pytest.mark.parametrize(
    ("corrections", "places"),
    [
        ("{pressure_offset: {value: 1, unit: furlong}, tare_load: {value: 1, unit: bar}}",
         ["corrections: pressure_offset: unit 'furlong'", "corrections: tare_load: unit 'bar'"]),
        ("{nope: {value: 1}, tare_load: {value: abc, unit: t}}",
         ["corrections: nope: correction 'nope' is not known", "corrections: tare_load: value must be a finite number",
          "corrections.nope: key 'unit' is missing"]),
    ],
)  # fmt: skip
def test_every_correction_that_is_none_is_told(here, capsys, corrections, places):
    model = (config_directory() / "models" / "a6vm215_crane2.yaml").read_text()
    (here / "m.yaml").write_text(f"{model}\ncorrections: {corrections}\n")
    assert run(["show", "m.yaml"]) == 2
    found = said(capsys)
    assert len(found) == len(places)
    assert all(each.startswith(f"m.yaml: {place}") for each, place in zip(found, places, strict=True))


def test_a_term_that_stands_twice_is_told_once(here, capsys):
    model = yaml.safe_load((config_directory() / "models" / "a6vm215_crane2.yaml").read_text())
    model["terms"].append(model["terms"][0])
    (here / "m.yaml").write_text(yaml.safe_dump(model))
    assert run(["show", "m.yaml"]) == 2
    assert len(said(capsys)) == 1


@pytest.mark.parametrize(("words", "line"), [
    ("a6vm215_crane2 --load -5", "show: --load -5 t: a hanging mass is a number from 0 on"),
    ("empty.yaml", "show: empty.yaml holds no model, crane or scenario: these are mappings of keys (YAML)"),
])  # fmt: skip
def test_what_cannot_be_shown_is_told_as_it_was_given(here, capsys, words, line):
    (here / "empty.yaml").write_text("")
    assert run(["show", *words.split()]) == 2
    assert said(capsys) == [line]


@pytest.mark.parametrize(
    ("words", "place"),
    [("check run.csv --out there.csv", "--out there.csv/check.html"),
     ("gap run.csv --out there.csv", "--out there.csv/model.yaml")],
)  # fmt: skip
def test_a_run_is_held_against_the_models_crane_though_nothing_can_be_written(here, capsys, words, place):
    """Without a crane a run was read for its time alone, and what it lacks came up at the next call."""
    rows = [",".join([f"{0.02 * k:.2f}", "2", "120", "20"]) for k in range(200)]
    head = "time [s],drum_speed [rpm],main.pressure_a [bar],hook_load [t]"
    (here / "run.csv").write_text("\n".join([head, *rows]) + "\n")
    assert run([*words.split(), "--model", "a6vm215_crane2"]) == 2
    lines = [line for line in capsys.readouterr().err.splitlines() if line.startswith("winch-friction: ")]
    assert [line.removeprefix("winch-friction: ").partition(":")[0] for line in lines] == [place, "run.csv"]
