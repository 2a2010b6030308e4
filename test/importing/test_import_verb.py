"""The crane engineer's way: three commands from a spreadsheet in German to a verdict, none of them an editor."""

import pytest
from importing.logs import example, rows_of, same, write_text, write_workbook

from winch_friction.cli.main import run
from winch_friction.discrepancy import workflow
from winch_friction.physics.errors import InputError
from winch_friction.records.crane_file import load_crane
from winch_friction.records.runs import read_run


def imported(tmp_path, *logs, settings=(), crane="crane_150t"):
    """Propose and import; the exit codes of both."""
    names = [str(log) for log in logs]
    where = ["--map", str(tmp_path / "map.yaml")]
    proposed = run(["import", *names, "--propose", "--crane", crane, *where])
    done = run(
        ["import", *names, *where, "--out", str(tmp_path / "runs"), *(x for s in settings for x in ("--set", s))]
    )
    return proposed, done


def test_german_spreadsheets_become_the_runs_they_were(tmp_path):
    names = ("test_02", "ahc_215")
    for name in names:
        folder = tmp_path / name
        folder.mkdir()
        log = write_workbook(folder / f"{name}.xlsx", rows_of(example(name)))
        assert imported(folder, log) == (0, 0)
        back = read_run(folder / "runs" / f"{name}.csv", load_crane("crane_150t"))
        assert same(back, example(name))
        assert back.time[0] == 1772359200.0  # 2026-03-01T10:00:00 UTC
        assert back.time[-1] - back.time[0] == pytest.approx(example(name).time[-1], abs=2e-3)


def test_three_commands_to_a_search(tmp_path, capsys, monkeypatch):
    """Several spreadsheets by one map, taken as they are by `gap`, whose search others test."""
    names = [f"test_{k:02d}" for k in (1, 3, 12)]
    logs = [write_workbook(tmp_path / f"{name}.xlsx", rows_of(example(name))) for name in names]
    assert imported(tmp_path, *logs) == (0, 0)

    def begun(runs, *_):
        raise InputError(f"searched {', '.join(each.name for each in runs)}")

    monkeypatch.setattr(workflow, "find_gap", begun)
    runs = [str(tmp_path / "runs" / f"{name}.csv") for name in names]
    arguments = ["gap", *runs, "--crane", "crane_150t", "--model", "a6vm215_crane2", "--out", str(tmp_path / "gap")]
    assert run(arguments) == 2
    assert "searched test_01.csv, test_03.csv, test_12.csv" in capsys.readouterr().err


DIALECTS = {
    "semicolons, decimal comma, cp1252, a preamble": (";", ",", "cp1252", "Messung;Kran 7\nDatum;01.03.2026\n\n"),
    "sep= line": (";", ",", "utf-8", "sep=;\n"),
    "tabs, utf-16": ("\t", ",", "utf-16", ""),
    "commas, points, byte order mark": (",", ".", "utf-8-sig", ""),
}


@pytest.mark.parametrize("dialect", DIALECTS)
def test_text_dialects(tmp_path, dialect):
    delimiter, decimal, encoding, head = DIALECTS[dialect]
    log = write_text(tmp_path / "log.txt", rows_of(example("test_08"), decimal=decimal), delimiter, encoding, head)
    assert imported(tmp_path, log) == (0, 0)
    assert same(read_run(tmp_path / "runs" / "log.csv"), example("test_08"))


def test_an_ambiguous_ton_is_asked_for_and_answered_without_an_editor(tmp_path, capsys):
    rows = rows_of(example("test_02"))
    rows[0] = [cell.replace("[t]", "[ton]") for cell in rows[0]]
    log = write_text(tmp_path / "log.csv", rows)
    assert imported(tmp_path, log) == (2, 2)
    assert "short_ton" in capsys.readouterr().err
    assert not (tmp_path / "runs").exists()
    again = ["import", str(log), "--map", str(tmp_path / "map.yaml"), "--out", str(tmp_path / "runs")]
    assert run([*again, "--set", "hook_load.unit=t"]) == 0
    assert same(read_run(tmp_path / "runs" / "log.csv"), example("test_02"))


def test_what_is_missing_is_said_with_what_was_found(tmp_path, capsys):
    rows = [[cell for k, cell in enumerate(row) if k not in (2, 4)] for row in rows_of(example("test_02"))]
    log = write_text(tmp_path / "log.csv", rows)
    assert imported(tmp_path, log) == (2, 2)
    said = capsys.readouterr().err
    assert "main.pressure_a" in said
    assert "main.displacement" in said


def test_a_log_of_another_crane_is_not_imported(tmp_path, capsys):
    run_of_it = example("test_02")
    halved = type(run_of_it)(
        "x", {k: v * (0.4 if k.startswith("main.pressure") else 1.0) for k, v in run_of_it.columns.items()}
    )
    log = write_text(tmp_path / "log.csv", rows_of(halved))
    assert imported(tmp_path, log) == (2, 2)
    said = capsys.readouterr().err
    assert "hook_load" in said  # 2.5 times the pressures, or 0.4 of the load: one and the same
    assert "put it right by --set" in said
    assert not (tmp_path / "runs").exists()
    again = ["import", str(log), "--map", str(tmp_path / "map.yaml"), "--out", str(tmp_path / "runs")]
    assert run([*again, "--set", "hook_load.factor=0.4"]) == 0, capsys.readouterr().err  # the question's own answer


def test_nothing_is_overwritten(tmp_path, capsys):
    log = write_text(tmp_path / "log.csv", rows_of(example("test_02")))
    assert imported(tmp_path, log) == (0, 0)
    assert imported(tmp_path, log) == (2, 2)
    assert "--overwrite" in capsys.readouterr().err
