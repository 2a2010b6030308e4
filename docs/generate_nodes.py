"""Reference of the nodes, asked of the nodes themselves: parameters with their descriptors, topics, services."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

INPUTS_TEXT = "measured; columns of a run: "
# what the nodes publish and offer; a test holds that nothing is missing here
TOPIC_TEXTS = {
    "/compensator/friction_torque": (
        "the feedforward: `effort` N·m in total at the motor shaft, `velocity` rad/s where it was taken"
    ),
    "/compensator/pressure_feedforward": "the same as Pa on the active group; not with an electric drive",
    "/friction_model": "the learned model as text of a model file, latched, every `model_period` s",
    "/estimator/friction_torque": "what the learned model says at the measured speed, N·m",
    "/simulator/truth": (
        "joint `winch_motor`: angle, speed, true friction; joint `load`: position error m, heave speed m/s"
    ),
    "/simulator/progress": "share of the sea that is over, 1: all",
    "/clock": "simulated time, with `publish_clock`",
    "/diagnostics": "state, clamps, rates, ages, refusals; parameters with σ and status; NIS",
}
SERVICE_TEXTS = {
    "enable": "fade the feedforward in or out; learn or rest",
    "reset": "forget the past; back to the seed; begin the same sea again",
    "load_model": "load what `model_file` (and `terms_file`) says by then",
    "save": "write the checkpoint",
}
LIFECYCLE = ("change_state", "get_state", "get_available_states", "get_available_transitions", "get_transition_graph")
OWN = ("parameters", "parameter_types", "parameters_atomically", "type_description")  # rclpy's, on every node


@contextmanager
def nodes() -> Iterator[dict[str, Any]]:
    """The three nodes, active, in this process and on a domain of their own."""
    os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    import rclpy
    from rclpy.context import Context
    from rclpy.parameter import Parameter

    from winch_friction.nodes.compensator import CompensatorNode
    from winch_friction.nodes.estimator import EstimatorNode
    from winch_friction.nodes.simulator import SimulatorNode

    context = Context()
    rclpy.init(context=context, domain_id=50 + os.getpid() % 50)
    made = {}
    try:
        for kind in (CompensatorNode, EstimatorNode, SimulatorNode):
            node = kind(context=context, parameter_overrides=[Parameter("autostart", value=False)])
            made[node.get_name()] = node
            node.trigger_configure()
            node.trigger_activate()
        yield made
    finally:
        for node in made.values():
            node.destroy_node()
        rclpy.shutdown(context=context)


def parameters_of(node: Any) -> list[tuple[str, str, str, str]]:
    """Name, default, range and description of every parameter, as `ros2 param describe` says them."""
    rows = []
    for name in sorted(node._parameters):
        if name.startswith(("qos_overrides", "gains.", "use_sim_time", "start_type_description")):
            continue
        described = node.describe_parameter(name)
        spans = [*described.floating_point_range, *described.integer_range]
        span = f"{spans[0].from_value:g} … {spans[0].to_value:g}" if spans else ""
        fixed = " Fixed while the node lives." if described.read_only else ""
        rows.append((name, str(node.get_parameter(name).value), span, described.description + fixed))
    return rows


def topics_of(node: Any) -> list[tuple[str, str, str]]:
    """Topic, in or out, and type."""
    rows = {(each.topic_name, "out", _type(each.msg_type)) for each in node.publishers}
    rows |= {(each.topic_name, "in", _type(each.msg_type)) for each in node.subscriptions}
    return sorted(row for row in rows if not row[0].endswith(("/rosout", "/parameter_events", "transition_event")))


def services_of(node: Any) -> list[tuple[str, str]]:
    """Service and type, without what every lifecycle node has."""
    found = [(each.service_name, _type(each.srv_type)) for each in node.services]
    return sorted(row for row in found if not row[0].endswith((*LIFECYCLE, *OWN)))


def _type(kind: Any) -> str:
    """`sensor_msgs/msg/JointState` of its class."""
    package, folder, *_ = kind.__module__.split(".")
    return f"{package}/{folder}/{kind.__name__}"


def meaning(topic: str) -> str:
    """What a topic carries."""
    from winch_friction.records.crane_file import load_crane
    from winch_friction.records.topics import crane_topics

    if topic in TOPIC_TEXTS:
        return TOPIC_TEXTS[topic]
    for each in crane_topics(load_crane("crane_150t")).inputs.values():
        if f"/{each.topic}" == topic:
            return INPUTS_TEXT + ", ".join(f"`{channel}`" for channel in each.channels)
    return ""
