"""What a node says of what it lacks: inputs of another type, a place where nothing can be kept, a clock to and fro."""

from pathlib import Path

import rclpy
from dds_bench import CRANE, Bench, diagnostics
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.context import Context
from rclpy.node import Node
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Float64

from winch_friction.nodes.inputs import ROS, clock_message
from winch_friction.nodes.qos import OUTPUT
from winch_friction.physics.signals import Sample
from winch_friction.records.topics import crane_topics

PLAIN = "winch/active/pressure_a"


def test_an_input_of_another_type_is_told_by_its_type(bench: Bench) -> None:
    """A plain bridge that nobody named in float64_inputs was told to change its quality of service."""
    context = Context()  # one participant cannot have two types under a name
    rclpy.init(context=context, domain_id=bench.domain)
    bridge = Node("bridge", context=context)
    bridge.create_publisher(Float64, PLAIN, OUTPUT)
    bench.start("compensator")
    seen = bench.listen("/diagnostics", DiagnosticArray, 10)
    others = {
        topic: bench.node.create_publisher(type(message), topic, OUTPUT)
        for topic, message in crane_topics(CRANE).encode(bench.sample(), ROS)
        if topic != PLAIN
    }
    assert bench.spin(40.0, lambda: others["winch/joint_states"].get_subscription_count() > 0)
    said = lambda: diagnostics(seen, "compensator: inputs").get("message", "")
    assert bench.spin(5.0, lambda: "send" in said()), said()
    assert f"{PLAIN}: 1 of 1 publishers send std_msgs/msg/Float64, not sensor_msgs/msg/FluidPressure" in said()
    assert "name 'active.pressure_a' in float64_inputs" in said()
    assert "quality of service" not in said()
    bridge.destroy_node()
    rclpy.shutdown(context=context)


def test_a_checkpoint_that_cannot_be_written_is_said_at_once_and_in_the_diagnostics(
    bench: Bench, tmp_path: Path
) -> None:
    """It was said in the log after a minute, and never in the diagnostics."""
    file = tmp_path / "file"
    file.write_text("no folder")
    bench.start("estimator", checkpoint=file / "kept.json")
    seen = bench.listen("/diagnostics", DiagnosticArray, 10)
    bench.announce()
    said = lambda: diagnostics(seen, "estimator: filter").get("message", "")
    assert bench.spin(5.0, lambda: "checkpoint not written" in said()), said()
    assert bench.says("estimator", "checkpoint not written")
    file.unlink()
    bench.remote("estimator").trigger("save")
    seen.clear()
    assert bench.spin(5.0, lambda: bool(said()) and "checkpoint" not in said()), said()


def test_two_clocks_do_not_fill_the_disk(bench: Bench) -> None:
    bench.start("compensator", use_sim_time=True)
    clock = bench.node.create_publisher(Clock, "/clock", 10)
    bench.announce()
    for k in range(100):
        clock.publish(clock_message(1000.0 + 0.02 * k - 20.0 * (k % 2)))
        bench.spin(0.02)
    assert bench.says("compensator", "time jumped")
    assert bench.log("compensator").count("time jumped") <= 5


def test_a_speed_that_is_published_before_the_rest_of_its_instant_is_said(bench: Bench) -> None:
    """Each sample held the inputs of the one before, or not, as they came: two nodes differed by 60 N m."""
    bench.start("compensator")
    seen = bench.listen("/diagnostics", DiagnosticArray, 10)
    bench.announce()
    said = lambda: diagnostics(seen, "compensator: inputs").get("message", "")
    bench.drive(3.2)
    assert "publish the speed last" not in said()

    def speed_first(sample: Sample) -> None:
        messages = crane_topics(CRANE).encode(sample, ROS)
        for topic, message in (messages[-1], *messages[:-1]):
            bench.publisher(topic).publish(message)
            bench.spin(0.002)

    bench.publish = lambda sample, namespace="": speed_first(sample)  # type: ignore[method-assign]
    bench.drive(3.2)
    assert "winch/reference: comes after the speed of its own instant" in said()


def test_a_clock_that_stops_under_the_watchdog_is_said(bench: Bench) -> None:
    """The torque stood at 155 N m for ever and the state was 'active', for the watchdog goes by that clock."""
    bench.start("compensator", ramp_time=0.3, use_sim_time=True, watchdog_clock="ros")
    said = bench.listen("/diagnostics", DiagnosticArray, 10)
    clock = bench.node.create_publisher(Clock, "/clock", 10)
    bench.announce()
    bench.drive(1.5, lambda sample: clock.publish(clock_message(sample.time)))
    assert "stands still" not in diagnostics(said, "feedforward")["message"]
    assert bench.spin(4.0, lambda: "/clock stands still" in diagnostics(said, "feedforward")["message"])
    bench.drive(1.5, lambda sample: clock.publish(clock_message(sample.time)))
    assert "stands still" not in diagnostics(said, "feedforward")["message"]
