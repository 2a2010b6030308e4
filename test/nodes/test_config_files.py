"""The shipped parameter files: every name is one that a node declares, every value one that it accepts."""

import re
from dataclasses import fields
from pathlib import Path
from typing import Any

import pytest
import yaml

from winch_friction.compensation import CompensatorConfig
from winch_friction.estimation import EstimatorConfig
from winch_friction.nodes.compensator import CompensatorNodeOptions
from winch_friction.nodes.estimator import EstimatorNodeOptions
from winch_friction.nodes.options import NodeOptions
from winch_friction.nodes.simulator import SimulatorNodeOptions
from winch_friction.physics.errors import from_mapping

NODES = Path(__file__).resolve().parents[2] / "config" / "nodes"
KINDS = {
    "*": (NodeOptions,),
    "compensator": (NodeOptions, CompensatorConfig, CompensatorNodeOptions),
    "estimator": (NodeOptions, EstimatorConfig, EstimatorNodeOptions),
    "simulator": (NodeOptions, SimulatorNodeOptions),
}


def _sections() -> list[Any]:
    found = []
    for path in sorted(NODES.glob("*.yaml")):
        for name, content in yaml.safe_load(path.read_text()).items():
            node = name.rsplit("/", 1)[-1]
            found.append(pytest.param(node, content["ros__parameters"], id=f"{path.name}:{node}"))
    return found


@pytest.mark.parametrize(("node", "parameters"), _sections())
def test_names_and_values_are_a_nodes_own(node: str, parameters: dict[str, Any]) -> None:
    for kind in KINDS[node]:
        names = {each.name for each in fields(kind)}
        own = {key: parameters.pop(key) for key in list(parameters) if key in names}
        from_mapping(kind, {k: tuple(filter(None, v)) if isinstance(v, list) else v for k, v in own.items()}, node)
    parameters.pop("use_sim_time", None)
    assert parameters == {}


@pytest.mark.parametrize("file", sorted(NODES.glob("*.yaml")), ids=lambda file: file.name)
def test_what_the_command_line_says_overrules_a_shipped_file(file: Path) -> None:
    """Under `/**` it became part of that section, and the compensator's own went on saying 0.9 of a scale of 0.5."""
    rclpy = pytest.importorskip("rclpy")
    context = rclpy.Context()
    rclpy.init(args=["--ros-args", "--params-file", str(file), "-p", "scale:=0.25"], context=context)
    node = rclpy.create_node("compensator", context=context, automatically_declare_parameters_from_overrides=True)
    assert (node.get_parameter("scale").value, node.has_parameter("crane")) == (0.25, True)
    node.destroy_node()
    rclpy.shutdown(context=context)


def test_the_commented_file_shows_the_compensators_defaults() -> None:
    shown = yaml.safe_load((NODES / "crane.yaml").read_text())["/**/compensator"]["ros__parameters"]
    names = {each.name for each in fields(CompensatorConfig)}
    config = from_mapping(CompensatorConfig, {k: v for k, v in shown.items() if k in names}, "crane.yaml")
    for each in fields(CompensatorConfig):
        if each.name not in ("load", "absolute_limit"):  # NaN, and the crane's own limit
            assert getattr(config, each.name) == getattr(CompensatorConfig(), each.name), each.name


def test_what_is_commented_out_is_the_default() -> None:
    """As the file says of itself."""
    text = (NODES / "crane.yaml").read_text()
    shown = {
        name: yaml.safe_load(said) for name, said in re.findall(r"^ *# (\w+): (.+?)(?:  #.*)?$", text, re.MULTILINE)
    }
    defaults = {each.name: each.default for kind in KINDS["estimator"] for each in fields(kind)}
    told = {name: value for name, value in shown.items() if name in defaults}
    assert len(told) > 20
    for name, value in told.items():
        assert defaults[name] == (pytest.approx(value, rel=1e-3) if isinstance(value, float) else value), name


def test_the_commented_file_names_every_setting() -> None:
    text = (NODES / "crane.yaml").read_text()
    for kind in (NodeOptions, CompensatorConfig, CompensatorNodeOptions, EstimatorConfig, EstimatorNodeOptions):
        for each in fields(kind):
            assert f"{each.name}:" in text, f"explain {each.name} of {kind.__name__} in config/nodes/crane.yaml"
