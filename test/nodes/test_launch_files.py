"""The launch files read as code, so that what they name exists; and by launch_ros itself where that is installed."""

import ast
import importlib.util
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest
import yaml

ROOT = Path(__file__).resolve().parents[2]
FILES = sorted((ROOT / "launch").glob("*.launch.py"))
REQUIRED = {"params_file", "namespace", "use_sim_time", "autostart"}
# what launch and launch_ros of Jazzy export from these modules, as far as the files use it
EXPORTED = {
    "launch": {"LaunchContext", "LaunchDescription"},
    "launch.actions": {"DeclareLaunchArgument", "ExecuteProcess", "OpaqueFunction"},
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
    assert any(type(entity).__name__ == "OpaqueFunction" for entity in description.entities)


# -- what the nodes are given, with as much of launch as the files use
def _started(path: Path, monkeypatch: pytest.MonkeyPatch, **said: str) -> dict[str, dict[str, Any]]:
    """The parameters that come behind the file's, by executable, when the command line says this."""
    told = SimpleNamespace(said={}, functions=[], nodes=[])

    class Configuration:
        def __init__(self, name: str) -> None:
            self.name = name

        def perform(self, context: Any) -> str:
            return str(told.said[self.name])

    class Value(tuple[str, type]):
        def __new__(cls, value: Configuration, value_type: type) -> "Value":
            return super().__new__(cls, (value.perform(None), value_type))

    def argument(name: str, default_value: Any = None, description: str = "") -> None:
        told.said[name] = said.get(name, default_value)

    stand_ins = {
        "LaunchContext": object, "LaunchDescription": list, "DeclareLaunchArgument": argument,
        "OpaqueFunction": lambda function: told.functions.append(function), "LaunchConfiguration": Configuration,
        "LifecycleNode": lambda **node: told.nodes.append(node), "ParameterFile": lambda file, allow_substs: file,
        "ParameterValue": Value,
    }  # fmt: skip
    for module, names in EXPORTED.items():
        made = ModuleType(module)
        made.__dict__.update({name: stand_ins.get(name, lambda *_, **__: None) for name in names})
        monkeypatch.setitem(sys.modules, module, made)
    content: dict[str, Any] = {"__name__": path.stem}
    exec(compile(path.read_text(), str(path), "exec", dont_inherit=True), content)
    content["generate_launch_description"]()
    for each in told.functions:
        each(None)
    return {node["executable"]: node["parameters"][1] for node in told.nodes}


@pytest.mark.parametrize("path", FILES, ids=lambda p: p.name)
def test_what_the_command_line_does_not_say_the_file_says(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A file's `autostart: false` was overruled by the argument's own default: a torque that nobody asked for."""
    for own in _started(path, monkeypatch).values():
        assert not {"autostart", "scenario", "rate", "seed"} & set(own)
    for own in _started(path, monkeypatch, autostart="false").values():
        assert own["autostart"] == ("false", bool)


def test_beside_a_crane_the_file_says_what_time_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    crane, simulation, replay = (ROOT / "launch" / f"{n}.launch.py" for n in ("crane", "ahc_simulation", "replay"))
    assert set(_started(crane, monkeypatch)) == {"compensator", "estimator"}
    assert not any(_started(crane, monkeypatch).values())
    assert _started(crane, monkeypatch, use_sim_time="true")["estimator"] == {"use_sim_time": ("true", bool)}
    assert _started(replay, monkeypatch)["compensator"] == {"use_sim_time": ("true", bool), "watchdog_clock": "ros"}
    told = _started(simulation, monkeypatch, rate="2", seed="7")
    assert told["simulator"] == {
        "rate": ("2", float), "seed": ("7", int), "publish_clock": ("true", bool), "use_sim_time": False,
    }  # fmt: skip
    assert told["compensator"] == {"use_sim_time": ("true", bool)}
