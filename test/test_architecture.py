"""The house rules: imports go down only, rclpy in the nodes alone, the node path free of desk libraries."""

import ast
import re
import subprocess
import sys
import tomllib
from importlib.util import find_spec
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
DESK_ONLY = {"pint", "pandas", "pyarrow", "pydantic", "matplotlib", "plotly", "typer", "rosbags", "sklearn", "numba"}


def test_layers_are_kept():
    command = [str(Path(sys.executable).with_name("lint-imports")), "--config", "pyproject.toml", "--no-cache"]
    result = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stdout


def test_the_page_of_the_architecture_has_the_layers_and_every_room():
    """Five files of the discrepancy workflow stood in no room, three packages in no layer."""
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]["contracts"]
    layers = {tuple(each["containers"]): each["layers"] for each in contracts if each["type"] == "layers"}
    page = (ROOT / "docs" / "architecture.md").read_text()
    assert " → ".join(f"`{layer}`" for layer in layers["winch_friction",]) in page.replace("\n", " ")
    rooms = set(re.findall(r"\w+", " ".join(layers["winch_friction.discrepancy",])))
    found = {path.stem for path in (ROOT / "winch_friction" / "discrepancy").glob("*") if path.stem.isidentifier()}
    assert rooms == found - {"__init__", "__pycache__"}
    table = re.findall(r"^\| (`.*`) \|", page.partition("The rooms of `discrepancy/`")[2], re.MULTILINE)
    assert set(re.findall(r"\w+", " ".join(table))) == rooms


@pytest.mark.parametrize("package", ["physics", "estimation", "compensation"])
def test_the_node_path_needs_no_desk_library(package):
    """What a node imports needs numpy, scipy, sympy, filterpy and YAML alone."""
    code = (
        "import pkgutil, importlib, sys, winch_friction\n"
        f"package = importlib.import_module('winch_friction.{package}')\n"
        "for each in pkgutil.walk_packages(package.__path__, package.__name__ + '.'):\n"
        "    importlib.import_module(each.name)\n"
        f"print(sorted({DESK_ONLY!r} & set(sys.modules)))"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "[]"


@pytest.mark.skipif(not find_spec("rclpy"), reason="rclpy is not installed")
@pytest.mark.parametrize("node", ["compensator", "estimator"])
def test_a_node_starts_without_what_it_does_not_use(node):
    """Half a second of its start: filterpy is the reference of a test, scipy's statistics are a few closed forms."""
    code = (
        f"import sys, winch_friction.nodes.{node}; print(sorted({{'scipy', 'filterpy', 'numba'}} & set(sys.modules)))"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "[]"


def imported_modules(path):
    """What a source file imports, by full name."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def test_hidden_effects_do_not_know_the_candidates():
    """Otherwise the discrepancy workflow would be tested against itself."""
    sources = list((ROOT / "winch_friction/simulation/hidden").rglob("*.py"))
    assert sources
    for path in sources:
        for module in imported_modules(path):
            assert "friction.terms" not in module
            assert "discrepancy" not in module
            assert "registry" not in module


def test_a_file_can_be_read_at_a_sitting():
    """Median at most 120 lines, none above 300."""
    lines = sorted(len(path.read_text().splitlines()) for path in (ROOT / "winch_friction").rglob("*.py"))
    assert lines[len(lines) // 2] <= 120
    assert lines[-1] <= 300


def test_make_looks_for_the_tests_of_nodes_where_they_are():
    """A test that is marked and stands elsewhere would run nowhere."""
    (places,) = re.findall(r"^ROS_TESTS := (.*)$", (ROOT / "Makefile").read_text(), re.MULTILINE)
    looked_through = [ROOT / place for place in places.split()]
    marked = [path for path in (ROOT / "test").rglob("test_*.py") if re.search(r"mark\.ros\b", path.read_text())]
    assert len(marked) >= 3
    assert [str(path) for path in marked if not {path, *path.parents} & set(looked_through)] == []
