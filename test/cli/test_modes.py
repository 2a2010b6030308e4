"""Quiet and plain modes, wherever they stand on the line; NO_COLOR; completion of names in a real shell's protocol."""

import os
import subprocess
import sys

import pytest

from winch_friction.cli.main import run

FRAMES = set("│┃━┏┓└┘")


def shell(*words, **environment):
    return subprocess.run(
        [sys.executable, "-m", "winch_friction", *words], capture_output=True, text=True, check=False,
        env={**os.environ, **environment}, timeout=60,
    )  # fmt: skip


@pytest.mark.parametrize("words", [["--plain", "list", "cranes"], ["list", "cranes", "--plain"]])
def test_plain_tables_are_columns_between_tabs(words, capsys):
    assert run(words) == 0
    shown = capsys.readouterr().out
    assert not FRAMES & set(shown)
    head, *rows = (line.split("\t") for line in shown.splitlines()[1:])
    assert head[0] == "name"
    assert all(len(row) == len(head) for row in rows)
    assert run(["list", "cranes"]) == 0
    assert FRAMES & set(capsys.readouterr().out)


def test_quiet_leaves_results_and_errors(tmp_path, capsys):
    assert run(["simulate", "ahc_55t_215", "--out", str(tmp_path / "run.csv"), "--quiet"]) == 0
    capsys.readouterr()
    words = ["check", str(tmp_path / "run.csv")]
    assert run([*words, "--crane", "crane_150t", "-q"]) == 0
    shown = capsys.readouterr()
    assert "plausible" in shown.out
    assert shown.err == ""
    assert run(["check", str(tmp_path / "none.csv"), "--crane", "crane_150t", "--quiet"]) == 2
    assert "none.csv" in capsys.readouterr().err


def test_no_color_is_respected():
    coloured = shell("list", FORCE_COLOR="1").stdout
    assert "\x1b[" in coloured
    plain = shell("list", FORCE_COLOR="1", NO_COLOR="1").stdout
    assert not any(f"\x1b[{code}" in plain for code in ("31", "32", "33", "34", "35", "36", "91", "92"))
    assert "\x1b[" not in shell("list", "--plain", FORCE_COLOR="1").stdout


@pytest.mark.parametrize(
    ("words", "offered"),
    [
        ("winch-friction show a6vm", "a6vm215_crane2"),
        ("winch-friction list mo", "models"),
        ("winch-friction terms stri", "stribeck"),
        ("winch-friction com", "compare"),
        ("winch-friction simulate ahc_", "ahc_swell"),
        ("winch-friction gap --crane cra", "crane_150t"),
        ("winch-friction gap --model a6vm", "a6vm215_crane2"),
        ("winch-friction load a6vm", "a6vm215_crane2"),
        ("winch-friction replay --model emps", "emps_symmetric"),
        ("winch-friction check --crane e", "emps"),
    ],
)
def test_names_are_completed(words, offered):
    split = words.split()
    protocol = {"_WINCH_FRICTION_COMPLETE": "complete_bash", "COMP_WORDS": words, "COMP_CWORD": str(len(split) - 1)}
    code = "from winch_friction.cli.main import app; app(prog_name='winch-friction')"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False, env={**os.environ, **protocol},
        timeout=60,
    )  # fmt: skip
    assert offered in done.stdout.split(), done.stdout + done.stderr
