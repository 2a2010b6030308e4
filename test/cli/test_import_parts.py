"""The parts of `import`: whose run a log becomes, what is shown of a map, what is refused and what is forced."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import winch_friction.importing.carry_out as carry_out
import winch_friction.importing.contradiction as contradiction
import winch_friction.importing.mapping as mapping
import winch_friction.records.crane_file as crane_file
import winch_friction.records.runs as runs_module
from winch_friction.cli import import_
from winch_friction.importing.mapping import Entry, LogMap
from winch_friction.importing.time_base import TimeBase
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import Run


@pytest.mark.parametrize(
    ("name", "stem"),
    [("log.csv", "log"), ("log.csv.gz", "log"), ("log.csv.zip", "log"), ("a.b.xlsx", "a.b"), ("bag", "bag"),
     ("log.txt", "log"), (".csv", ".csv"), ("log.gz", "log")],
)  # fmt: skip
def test_a_log_becomes_the_run_of_its_name(name, stem):
    assert import_._stem(Path("x") / name) == stem


def test_two_logs_of_one_name_are_refused_wherever_they_lie():
    import_._refuse_doubled([Path("a/log.csv"), Path("a/other.csv")])
    with pytest.raises(InputError, match="^log: two logs have this name"):
        import_._refuse_doubled([Path("other.csv"), Path("a/log.csv"), Path("b/log.xlsx")])


def test_a_proposal_is_shown_a_line_for_each_channel(capsys):
    shown = LogMap(
        {"motor_speed": Entry("n", "rpm", sign=-1, confidence=0.876, because="name"),
         "wire_layer": Entry("L", confidence=0.5, because="x"), "hook_load": Entry("", constant="96 kg")},
        ("Datum", "Uhrzeit"), TimeBase("datetime", unit="s"), time_confidence=0.25, time_because="dates",
    )  # fmt: skip
    import_._show(shown)
    for form in ("seconds", "unix"):
        import_._show(replace(shown, columns={}, time=TimeBase(form, unit="ms")))
    import_._show(replace(shown, columns={}, time_from=()))
    assert capsys.readouterr().out.splitlines() == [
        "time <- Datum + Uhrzeit (datetime), 0.25: dates",
        "motor_speed <- n (-1 * rpm), 0.88: name",
        "wire_layer <- L (-), 0.50: x",
        "hook_load <- 96 kg, a constant",
        "time <- Datum + Uhrzeit (seconds ms), 0.25: dates",
        "time <- Datum + Uhrzeit (unix ms), 0.25: dates",
        "time <- no column found",
    ]


def test_a_run_is_not_written_over_its_log_nor_over_another(tmp_path, monkeypatch):
    log, there = tmp_path / "log.csv", tmp_path / "there.csv"
    log.write_text("")
    there.write_text("")
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match="log.csv: is the log itself"):
        import_._refuse_existing([Path("log.csv")], [log], True)  # not even to overwrite
    with pytest.raises(InputError, match="there.csv: exists"):
        import_._refuse_existing([log], [there], False)
    import_._refuse_existing([log], [there], True)
    import_._refuse_existing([log], [tmp_path / "new.csv"], False)


@pytest.fixture
def importing(monkeypatch, tmp_path):
    """`import_logs` with runs out of the logs' names; what was asked and written."""
    asked = {"crane": [], "open": [], "against": [], "written": [], "settings": []}
    monkeypatch.setattr(mapping, "load_map", lambda path: LogMap({}, crane="of the map"))
    monkeypatch.setattr(
        mapping, "with_settings", lambda log_map, settings: asked["settings"].append(settings) or log_map
    )
    monkeypatch.setattr(mapping, "refuse_if_open", lambda log_map, where: asked["open"].append(where))
    monkeypatch.setattr(crane_file, "load_crane", lambda name: asked["crane"].append(name) or name)

    def one(path, log_map, crane):
        if "bad" in path.name:
            raise InputError(f"{path.name}: broken")
        values = np.zeros(len(path.stem))
        return Run("own", {"time": values, "motor_speed": values, "hook_load": values}, warnings=(f"odd {path.stem}",))

    def against(runs, crane):
        asked["against"].append([run.name for run in runs])
        return [f"{run.name}: no" for run in runs if "odd" in run.name]

    monkeypatch.setattr(carry_out, "import_log", one)
    monkeypatch.setattr(contradiction, "run_contradictions", against)
    monkeypatch.setattr(runs_module, "write_run", lambda run, path: asked["written"].append((run, path)) or path)

    def call(*names, crane="", form="csv", settings=(), accept=False, force=False, as_json=False):
        logs = [Path(name) for name in names]
        import_.import_logs(logs, Path("m.yaml"), crane, tmp_path, form, list(settings), accept, force, False, as_json)
        return asked

    return call


def test_a_run_bears_its_files_name_and_is_held_against_the_given_crane_else_the_maps(importing, capsys):
    asked = importing("abc.xlsx", "de.csv", form="parquet", settings=["x.unit=t"])
    assert [(run.name, path.name) for run, path in asked["written"]] == [("abc.parquet",) * 2, ("de.parquet",) * 2]
    assert (asked["crane"], asked["settings"], asked["open"]) == (["of the map"], [["x.unit=t"]], ["m.yaml"])
    assert asked["against"] == [["abc.parquet", "de.parquet"]]
    out = capsys.readouterr().out.splitlines()
    assert [line.rpartition("/")[2] for line in out] == [
        "abc.parquet: 3 samples of time, motor_speed, hook_load",
        "de.parquet: 2 samples of time, motor_speed, hook_load",
    ]  # fmt: skip
    assert importing("abc.xlsx", crane="given")["crane"][-1] == "given"


def test_as_json_all_samples_and_warnings_are_counted(importing, capsys):
    importing("abc.csv", "de.csv", as_json=True)
    said = json.loads(capsys.readouterr().out)
    assert [Path(each).name for each in said["written"]] == ["abc.csv", "de.csv"]
    assert (said["samples"], said["warnings"]) == ([3, 2], [["odd abc"], ["odd de"]])


def test_what_contradicts_the_crane_is_written_by_force_alone_and_says_so(importing):
    with pytest.raises(InputError, match=r"odd.csv: no \(nothing written; put it right by --set.*--force imports"):
        importing("ab.csv", "odd.csv")
    with pytest.raises(InputError, match="odd.csv: no"):
        importing("odd.csv", accept=True)
    asked = importing("ab.csv", "odd.csv", force=True)
    assert [run.metadata["forced"] for run, _ in asked["written"]] == [["odd.csv: no"]] * 2
    assert "forced" not in importing("ab.csv", force=True)["written"][-1][0].metadata


def test_all_logs_that_cannot_be_read_are_told_at_once_and_none_is_written(importing):
    with pytest.raises(InputError, match=r"^bad1.csv: broken \| bad2.csv: broken \(nothing written\)$"):
        importing("bad1.csv", "odd.csv", "bad2.csv", force=True)
    with pytest.raises(InputError):
        importing("odd.csv", "bad.csv")
    assert importing("ab.csv")["against"] == [["ab.csv"]]  # nor held against the crane


@pytest.mark.parametrize(("options", "asked"), [({}, 1), ({"accept": True}, 0), ({"force": True}, 0)])
def test_open_questions_are_asked_unless_they_are_accepted(options, asked, importing):
    assert len(importing("ab.csv", **options)["open"]) == asked


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
def test_a_folder_is_not_made_under_the_name_of_a_run_file(suffix, tmp_path):
    """`simulate --out run.csv` is a file: `import --out run.csv` made a folder of that name, which `replay` refused,
    and `--out run.parquet` one with a CSV file in it."""
    with pytest.raises(InputError, match=f"this verb writes a folder of files; give a name without {suffix}"):
        import_.import_logs(
            [Path("a.csv")], Path("m"), "", tmp_path / f"run{suffix}", "csv", [], False, False, False, False
        )
