"""What ROS people expect: known rosdep keys, layouts that name topics which exist, a package.xml that holds all."""

import json
import re
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).resolve().parents[2]
LAYOUTS = ROOT / "config" / "layouts"
ROS_PACKAGES = {
    "builtin_interfaces", "diagnostic_msgs", "launch", "launch_ros", "lifecycle_msgs", "rcl_interfaces", "rclpy",
    "rosgraph_msgs", "sensor_msgs", "std_msgs", "std_srvs",
}  # fmt: skip


def dependencies():
    tree = ET.parse(ROOT / "package.xml").getroot()
    return {each.text for kind in ("depend", "exec_depend", "test_depend") for each in tree.iter(kind)}


def test_every_dependency_is_a_ros_package_or_a_rosdep_key_that_was_looked_up():
    keys = yaml.safe_load((ROOT / "config" / "rosdep_keys.yaml").read_text())
    assert re.fullmatch(r"rosdistro [0-9a-f]{40}", keys["source"])
    assert dependencies() - ROS_PACKAGES == {*keys["confirmed"], *keys["unconfirmed"]}


def test_every_ros_package_that_the_nodes_import_is_a_dependency():
    imported = set()
    for path in [*(ROOT / "winch_friction" / "nodes").glob("*.py"), *(ROOT / "launch").glob("*.py")]:
        imported |= set(re.findall(r"^(?:from|import) (\w+)", path.read_text(), re.MULTILINE))
    assert {name for name in imported if name in ROS_PACKAGES} <= dependencies()
    assert {name for name in imported if name.endswith(("_msgs", "_srvs", "_interfaces"))} <= dependencies()


@pytest.fixture(scope="module")
def topics():
    """Topic -> message type, of the three running nodes."""
    pytest.importorskip("rclpy")
    sys.path.insert(0, str(ROOT / "docs"))
    try:
        import generate_nodes

        with generate_nodes.nodes() as made:
            return {topic: kind for node in made.values() for topic, way, kind in generate_nodes.topics_of(node)}
    finally:
        sys.path.remove(str(ROOT / "docs"))


def fields_of(kind):
    from winch_friction.nodes.inputs import message_type

    return set(message_type(kind).get_fields_and_field_types())


@pytest.mark.ros
def test_the_foxglove_layout_names_topics_and_fields_that_exist(topics):
    content = (LAYOUTS / "foxglove.json").read_text()
    json.loads(content)
    paths = re.findall(r'"value": "(/[\w/]+)\.(\w+)', content)
    assert len(paths) >= 8
    for topic, field in paths:
        assert field in fields_of(topics[topic]), f"{topic}.{field}"
    for topic in re.findall(r'"topicToRender": "([^"]+)"', content):
        assert topic in topics


def test_the_servers_layout_names_channels_and_fields_that_its_schemas_hold():
    from winch_friction.records.foxglove_channels import OWN_CHANNELS

    content = (LAYOUTS / "foxglove_server.json").read_text()
    panels = json.loads(content)["configById"]
    assert set(re.findall(r'"(\w+![a-z]+)"', json.dumps(json.loads(content)["layout"]))) == set(panels)
    paths = re.findall(r'"(?:value|topicPath)": "(/[^"]+)"', content)
    assert len(paths) >= 8
    for path in paths:
        topic, *fields = re.sub(r"\[\d+\]", "", path).split(".")
        schema = OWN_CHANNELS[topic]
        for field in fields:
            schema = schema.get("items", schema)["properties"][field]


@pytest.mark.ros
def test_the_plotjuggler_layout_names_topics_fields_and_parameters_that_exist(topics):
    import winch_friction as wf

    curves = [each.get("name") for each in ET.parse(LAYOUTS / "plotjuggler.xml").getroot().iter("curve")]
    known = set(wf.load_model("a6vm215_crane2").parameter_names)
    assert len(curves) >= 10
    for curve in curves:
        topic = max((t for t in topics if curve.startswith(f"{t}/")), key=len, default="")
        assert topic, curve
        rest = curve.removeprefix(f"{topic}/").split("/", 2)
        if topic == "/diagnostics":
            crane, part, value = rest
            assert crane == "crane_150t"
            assert part.split(":")[0] in ("compensator", "estimator", "simulator")
            assert part != "estimator: parameters" or value.removesuffix(" std") in known
        else:
            assert rest[-1].rpartition("/")[2] in {*fields_of(topics[topic]), "position", "velocity", "effort"}, curve
