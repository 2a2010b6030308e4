"""The launch files read as code, so that what they name exists; and by launch_ros itself where that is installed."""

import ast
import importlib.util
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).resolve().parents[2]
FILES = sorted((ROOT / "launch").glob("*.launch.py"))
REQUIRED = {"params_file", "namespace", "use_sim_time", "autostart"}
# what launch and launch_ros of Jazzy export from these modules, as far as the files use it
EXPORTED = {
    "launch": {"LaunchDescription"},
    "launch.actions": {"DeclareLaunchArgument", "ExecuteProcess"},
    "launch.substitutions": {"LaunchConfiguration", "PathJoinSubstitution"},
    "launch_ros.actions": {"LifecycleNode", "Node"},
    "launch_ros.parameter_descriptions": {"ParameterFile", "ParameterValue"},
    "launch_ros.substitutions": {"FindPackageShare"},
}


def _calls(tree: ast.AST, name: str) -> list[ast.Call]:
    return [n for n in ast.walk(tree) if isinstance(n, ast.Call) and getattr(n.func, "id", "") == name]


def _texts(tree: ast.AST, name: str) -> set[str]:
    first = [call.args[0] for call in _calls(tree, name) if call.args]
    return {each.value for each in first if isinstance(each, ast.Constant)}


def test_the_three_files_are_there() -> None:
    assert [f.name for f in FILES] == ["ahc_simulation.launch.py", "crane.launch.py", "replay.launch.py"]


@pytest.mark.parametrize("path", FILES, ids=lambda p: p.name)
def test_arguments_are_declared_before_they_are_used(path: Path) -> None:
    tree = ast.parse(path.read_text(), str(path))
    compile(tree, str(path), "exec")
    declared, used = _texts(tree, "DeclareLaunchArgument"), _texts(tree, "LaunchConfiguration")
    assert declared >= REQUIRED
    assert used <= declared
    assert any(isinstance(n, ast.FunctionDef) and n.name == "generate_launch_description" for n in tree.body)


@pytest.mark.parametrize("path", FILES, ids=lambda p: p.name)
def test_only_names_that_launch_exports_are_imported(path: Path) -> None:
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("launch"):
            assert {alias.name for alias in node.names} <= EXPORTED[node.module or ""]


@pytest.mark.parametrize("path", FILES, ids=lambda p: p.name)
def test_default_parameter_file_is_shipped(path: Path) -> None:
    parts = [
        [element.value for element in call.args[0].elts if isinstance(element, ast.Constant)]
        for call in _calls(ast.parse(path.read_text()), "PathJoinSubstitution")
    ]
    assert parts
    for each in parts:
        content = yaml.safe_load((ROOT.joinpath(*each)).read_text())
        assert all(set(section) == {"ros__parameters"} for section in content.values())


def test_every_loop_has_a_clock_of_its_own() -> None:
    """Two simulations in two namespaces would set each other's time."""
    nodes = _calls(ast.parse((ROOT / "launch" / "ahc_simulation.launch.py").read_text()), "LifecycleNode")
    for each in nodes:
        remappings = next(keyword.value for keyword in each.keywords if keyword.arg == "remappings")
        assert ast.literal_eval(remappings) == [("/clock", "clock")]


def test_a_replay_does_not_go_by_the_walls_clock() -> None:
    text = (ROOT / "launch" / "replay.launch.py").read_text()
    assert '"watchdog_clock": "ros"' in text


@pytest.mark.parametrize("path", FILES, ids=lambda p: p.name)
def test_launch_ros_itself_reads_them(path: Path) -> None:
    launch = pytest.importorskip("launch", reason="launch and launch_ros are not on PyPI: source ROS 2 to run this")
    pytest.importorskip("launch_ros", reason="launch and launch_ros are not on PyPI: source ROS 2 to run this")
    spec = importlib.util.spec_from_file_location(path.stem.replace(".", "_"), path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    description = module.generate_launch_description()
    assert isinstance(description, launch.LaunchDescription)
    declared = {argument.name for argument in description.get_launch_arguments()}
    assert declared == _texts(ast.parse(path.read_text()), "DeclareLaunchArgument")
    assert any(type(entity).__name__ in ("LifecycleNode", "Node") for entity in description.entities)
