"""What the pages tell people to type works: commands of the start page, Python snippets, names in every page."""

import re
import shlex
import sys
from pathlib import Path

import pytest

from winch_friction.cli.main import VERBS, run

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")), *sorted((ROOT / "docs/tutorials").glob("*.md"))]


def fenced(path, language):
    return re.findall(rf"^```{language}\n(.*?)^```", path.read_text(), re.DOTALL | re.MULTILINE)


TWELVE_RUNS = "gap_campaign"  # half a minute; `make test` searches twelve runs elsewhere


def start_page():
    return [line for block in fenced(ROOT / "docs/start.md", "sh") for line in block.splitlines()]


def test_the_start_page_can_be_typed(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    commands = [line for line in start_page() if TWELVE_RUNS not in line and " gap " not in line]
    assert len(commands) > 5
    for line in commands:
        assert run(shlex.split(line)[1:]) == 0, f"{line}: {capsys.readouterr()}"
    for block in fenced(ROOT / "docs/start.md", "python"):
        exec(compile(block, "docs/start.md", "exec"), {})
    assert "feedforward active" in capsys.readouterr().out


@pytest.mark.long
def test_the_start_pages_search_finds_the_brake_that_it_lets_drag(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    commands = [line for line in start_page() if TWELVE_RUNS in line or " gap " in line]
    assert len(commands) == 2
    for line in commands:
        assert run(shlex.split(line)[1:]) == 0, f"{line}: {capsys.readouterr()}"
    assert "brake_drag" in capsys.readouterr().out


def test_the_python_in_the_readme_runs(capsys):
    blocks = fenced(ROOT / "README.md", "python")
    assert blocks
    for block in blocks:
        exec(compile(block, "README.md", "exec"), {})
    assert "feedforward active" in capsys.readouterr().out


@pytest.mark.parametrize("page", PAGES, ids=lambda path: path.stem)
def test_every_verb_and_option_that_a_page_names_exists(page):
    known = {verb.name: verb for verb in VERBS}
    for line in re.findall(r"winch-friction ([a-z]+[^`\n]*)", page.read_text()):
        words = line.split()
        assert words[0] in known, f"{page.name}: winch-friction {line}"
        command = known[words[0]].load()
        for sub in words[1:2]:
            command = getattr(command, "commands", {}).get(sub, command)
        options = {option for each in command.params for option in (*each.opts, *each.secondary_opts)} | {"--help"}
        for option in re.findall(r"(?<=\s)--[a-z][a-z-]*", line.split("#")[0]):
            assert option in options or words[0] == "fleet", f"{page.name}: winch-friction {line}: {option}"


def typed(path):
    """Command lines of a page: fenced or indented, without comments; outlines with dots or brackets are left out."""
    lines = re.findall(r"^(?: {4}|)(?:\$ )?(?:\.venv/bin/)?winch-friction (.+)$", path.read_text(), re.MULTILINE)
    bare = [line.split(" #")[0].strip() for line in lines]
    return [line for line in bare if not re.search(r"\.\.\.|…|\[|\\$", line)]


@pytest.mark.parametrize("page", PAGES, ids=lambda path: path.stem)
def test_every_command_of_a_page_is_understood(page):
    """Each one is parsed as when it is typed: verb, arguments, options and their types; what is required is there."""
    known = {verb.name: verb for verb in VERBS}
    for line in typed(page):
        verb, *words = [word for word in shlex.split(line) if word not in ("--quiet", "--plain")]
        command = known[verb].load() if verb in known else None
        assert command or verb.startswith("-"), f"{page.name}: winch-friction {line}"
        while command and getattr(command, "commands", None) and words and words[0] in command.commands:
            command, *words = [command.commands[words[0]], *words[1:]]
        if command and "--help" not in words and not getattr(command, "commands", None):
            command.make_context(verb, list(words))


def test_the_pages_hold_commands():
    assert sum(len(typed(page)) for page in PAGES) > 40


@pytest.mark.parametrize("page", PAGES, ids=lambda path: path.stem)
def test_links_between_pages_lead_somewhere(page):
    for target in re.findall(r"\]\(([^)#:\s]+)(?:#[^)]*)?\)", page.read_text()):
        generated = "reference/" in target and target.endswith(".md")
        assert generated or (page.parent / target).exists(), f"{page.name} -> {target}"


def test_the_generated_reference_holds_every_verb_and_public_name(monkeypatch):
    import winch_friction as wf

    monkeypatch.syspath_prepend(str(ROOT / "docs"))
    generate = __import__("generate")
    command_line, python, effects = generate._cli(), generate._api(), generate._effects()
    assert all(f"## `{verb.name}`" in command_line for verb in VERBS)
    assert all(name in python for name in wf.__all__)
    assert "stribeck" in effects
    sys.modules.pop("generate")
