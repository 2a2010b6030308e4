"""The command line's frame: exit statuses, one clear line for bad input, help without importing the verbs."""

import importlib
import os
import subprocess
import sys
import types
import typing

import pytest
import typer

from winch_friction import __version__
from winch_friction.cli import main
from winch_friction.physics.errors import InputError


def failing(error):
    def command() -> None:
        raise error

    return command


@pytest.fixture
def verb(monkeypatch):
    def install(error):
        app = typer.Typer()
        app.command("replay")(failing(error))
        monkeypatch.setattr(main.Verb, "load", lambda self: typer.main.get_command(app))

    return install


def test_version_and_help(capsys):
    assert main.run(["--version"]) == 0
    assert __version__ in capsys.readouterr().out
    assert main.run([]) == 0
    shown = capsys.readouterr().out
    assert all(each.name in shown for each in main.VERBS)


@pytest.mark.parametrize(
    ("error", "status", "said"),
    [
        (InputError("run.csv: row 3,\n column x"), 2, "run.csv: row 3, column x"),
        (PermissionError(13, "Permission denied", "/root/out"), 2, "/root/out: Permission denied"),
        (ModuleNotFoundError("no dask", name="dask"), 2, "pip install"),
    ],
)
def test_bad_input_is_one_line_without_a_traceback(verb, capsys, error, status, said):
    verb(error)
    assert main.run(["replay"]) == status
    line = capsys.readouterr().err
    assert said in line
    assert line.count("\n") == 1
    assert "Traceback" not in line


def test_a_defect_is_said_to_be_one(verb, capsys):
    verb(ZeroDivisionError("oops"))
    assert main.run(["replay"]) == 1
    shown = capsys.readouterr().err
    assert "Traceback" in shown
    assert "defect: ZeroDivisionError: oops" in shown.splitlines()[-1]


@pytest.mark.parametrize("arguments", [["weld"], ["--nonsense"]])
def test_usage_errors_are_bad_input(arguments, capsys):
    assert main.run(arguments) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_an_interrupt_has_its_own_status_and_is_said(verb, capsys):
    verb(KeyboardInterrupt())
    assert main.run(["replay"]) == 130
    assert capsys.readouterr().err.split() == ["winch-friction:", "interrupted"]


def test_help_imports_no_verb():
    code = (
        "import sys; from winch_friction.cli.main import run; run(['--help'])\n"
        "heavy = {'pandas', 'pint', 'rosbags', 'matplotlib', 'scipy', 'sympy'} & set(sys.modules)\n"
        "sys.exit(str(heavy) if heavy else 0)"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert result.returncode == 0, result.stderr


@pytest.mark.parametrize("arguments", [["list", "effects"], ["compare", "a6vm215_crane1", "a6vm215_crane2"]])
def test_a_reader_that_has_gone_is_no_defect(arguments):
    """`| head`: rich ends with status 1 where a table finds nobody to read it, Typer where a line does."""
    call = [sys.executable, "-u", "-c", "from winch_friction.cli.main import main; main()", *arguments]
    with subprocess.Popen(call, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as started:
        started.stdout.close()
        said = started.stderr.read()
        assert (started.wait(60), said) == (0, b"")


def test_a_reader_that_has_gone_leaves_the_status_of_bad_input(tmp_path):
    """`check runs/ 2>&1 | head -1` ended with 1, the status of a defect."""
    call = [
        sys.executable,
        "-u",
        "-c",
        "from winch_friction.cli.main import main; main()",
        "check",
        str(tmp_path / "a"),
    ]
    with subprocess.Popen(call, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as started:
        started.stderr.close()
        assert (started.stdout.read(), started.wait(60)) == (b"", 2)


@pytest.mark.parametrize(("given", "used"), [(None, "1"), ("3", "3")])
def test_small_matrices_take_one_thread_unless_somebody_says_otherwise(given, used, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["winch-friction", "--version"])
    for name in main.SERIAL:
        monkeypatch.delenv(name, raising=False)
        if given:
            monkeypatch.setenv(name, given)
    with pytest.raises(SystemExit, match="0"):
        main.main()
    assert [os.environ[name] for name in main.SERIAL] == [used] * len(main.SERIAL)


def test_the_module_is_the_command():
    done = subprocess.run(
        [sys.executable, "-m", "winch_friction.cli.main", "--version"], capture_output=True, text=True
    )
    assert (done.returncode, done.stdout.strip()) == (0, f"winch-friction {__version__}")


@pytest.mark.parametrize("verb", main.VERBS, ids=lambda verb: verb.name)
def test_no_option_is_of_a_type_that_ubuntus_typer_does_not_read(verb):
    """Typer 0.9 knows `Optional[Path]`, not `Path | None`: the verb would end with a traceback."""
    module = importlib.import_module(f"winch_friction.cli.{verb.module}")
    app = getattr(module, "app", None)
    functions = [each.callback for each in app.registered_commands] if app else [module.command]
    for function in functions:
        for name, hint in typing.get_type_hints(function, include_extras=True).items():
            kind = typing.get_args(hint)[0] if hasattr(hint, "__metadata__") else hint
            assert name == "return" or not isinstance(kind, types.UnionType), name


@pytest.mark.parametrize("verb", ["convert", "identify", "init"])
def test_a_group_of_verbs_offers_what_it_can_do(verb, capsys):
    """Completion is installed for the whole command; each group offered to do so once more."""
    assert main.run([verb, "--help"]) == 0
    assert "--install-completion" not in capsys.readouterr().out


@pytest.mark.parametrize(
    "words",
    [["gap", "runs", "--crane", "crane_150t", "--model", "a6vm215_crane2"], ["gap", "--blind", "1"],
     ["identify", "motor", "a6vm215_generated"], ["identify", "practice", "practice_150t"],
     ["simulate", "ahc_55t_215"]],
)  # fmt: skip
def test_a_seed_below_zero_is_bad_input_and_no_defect(words, tmp_path, capsys):
    """gap and identify worked, and then ended in numpy's own complaint."""
    assert main.run([*words, "--seed", "-3", "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "'--seed'" in error
