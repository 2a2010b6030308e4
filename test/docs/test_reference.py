"""The generated reference and the architecture picture hold what the code holds."""

import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def generators(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "docs"))
    yield lambda name: __import__(name)
    for name in ("generate", "generate_nodes", "generate_architecture"):
        sys.modules.pop(name, None)


def test_the_architecture_picture_is_that_of_the_imports(generators):
    pytest.importorskip("grimp")
    drawn = generators("generate_architecture")
    assert drawn.TARGET.read_text() == drawn.picture(), "run: python docs/generate_architecture.py"


def test_every_import_between_packages_goes_down(generators):
    pytest.importorskip("grimp")
    drawn = generators("generate_architecture")
    level = {name: k for k, row in enumerate(drawn.layers()) for name in row}
    found = drawn.imports()
    assert len(found) > 20
    assert all(level[importer] < level[imported] for importer, imported in found)


@pytest.mark.ros
def test_every_parameter_topic_and_service_is_described(generators):
    pytest.importorskip("rclpy")
    asked = generators("generate_nodes")
    with asked.nodes() as made:
        for name, node in made.items():
            for parameter, value, span, doc in asked.parameters_of(node):
                assert doc.strip(), f"{name}: {parameter}"
                number = type(node.get_parameter(parameter).value) in (int, float)
                # NaN says that there is no load; a range would refuse it
                assert span or not number or value == "nan", f"{name}: {parameter} has no range"
            for topic, _, _ in asked.topics_of(node):
                assert asked.meaning(topic), f"{name}: {topic}"
            for service, _ in asked.services_of(node):
                assert service.rpartition("/")[2] in asked.SERVICE_TEXTS, f"{name}: {service}"


@pytest.mark.ros
def test_the_pages_hold_every_parameter_topic_and_schema(generators, tmp_path):
    pytest.importorskip("rclpy")
    generators("generate").write_reference(tmp_path)
    parameters, nodes = (tmp_path / "parameters.md").read_text(), (tmp_path / "nodes.md").read_text()
    for name in ("reversal_time", "checkpoint", "friction_factor", "watchdog_timeout"):
        assert f"`{name}`" in parameters
    for name in ("/compensator/friction_torque", "/winch/joint_states", "/compensator/load_model", "/friction_model"):
        assert f"`{name}`" in nodes
    schemas = (tmp_path / "schemas.md").read_text()
    for path in (ROOT / "config" / "schemas").glob("*.json"):
        assert f"## {path.name.split('.')[0]}" in schemas
