"""A bad network over DDS: a relay that loses, delays and reorders, and qualities of service that do not match."""

import os
import subprocess
import sys
from typing import Any

from campaign.faults.watch import Row

PATIENCE = 30.0  # s that a process may take to start on a busy machine
STRICT, PART = "strict", "strict: inputs"


def lossy_relay(probe: Any, row: Row) -> None:
    """All inputs through a process that loses, delays and reorders them."""
    bench, draw = probe.bench, probe.random
    options = {"seed": draw.randrange(10**6), "loss": draw.uniform(0.0, 0.5), "delay": draw.uniform(0.0, 0.15)}
    options["jitter"] = draw.choice((0.0, 0.02, 0.1))
    arguments = [word for name, value in options.items() for word in (f"--{name}", str(value))]
    environment = {**os.environ, "ROS_DOMAIN_ID": str(bench.domain)}
    relay = subprocess.Popen([sys.executable, "-m", "campaign.faults.relay", *arguments], env=environment)
    try:
        bench.publish(bench.sample(), "raw")
        raw, direct = (bench.publisher(f"{name}winch/joint_states") for name in ("raw/", ""))
        if not bench.spin(PATIENCE, lambda: raw.get_subscription_count() > 0 and direct.get_subscription_count() > 0):
            row.violations["the relay did not start"] += 1
        probe.settle_after_pause()
        heard = len(probe.torques)
        bench.drive(draw.uniform(2.0, 4.0), namespace="raw")
        if len(probe.torques) == heard:
            row.violations["nothing is heard through the relay"] += 1
    finally:
        relay.terminate()
        relay.wait(10.0)
    bench.spin(0.2)
    probe.settle_after_pause()


def mismatch(probe: Any, row: Row) -> None:
    """The command is offered best effort to a compensator that asks for reliable: it feeds nothing forward, and says
    why."""
    from sensor_msgs.msg import JointState

    from winch_friction.nodes.qos import OUTPUT, SENSOR, fresh

    bench, heard = probe.bench, []
    if STRICT not in bench.processes:
        override = {f"qos_overrides./{STRICT}/reference.subscription.reliability": "reliable"}
        names = ("-r", f"__node:={STRICT}", "-r", f"winch/reference:={STRICT}/reference")
        bench.start("compensator", *names, name=STRICT, ramp_time=0.3, diagnostics_period=0.2, **override)
    offered = bench.node.create_publisher(JointState, f"{STRICT}/reference", fresh(SENSOR))
    listener = bench.node.create_subscription(JointState, f"{STRICT}/friction_torque", heard.append, OUTPUT)
    for _ in range(int(PATIENCE / 0.5)):
        bench.drive(0.5)
        if heard:
            break
    offered.publish(JointState(name=["winch_motor"], velocity=[50.0]))
    bench.drive(1.0)
    if not heard or any(message.effort[0] != 0.0 for message in heard):
        row.violations["fed forward without a command"] += 1
    if "do not match its quality of service" not in probe.said(PART):
        row.violations["the mismatch was not reported"] += 1
    bench.node.destroy_subscription(listener)
    bench.node.destroy_publisher(offered)


def late_joiner(probe: Any, row: Row) -> None:
    """Who comes late hears the torque within a second."""
    from sensor_msgs.msg import JointState

    from winch_friction.nodes.qos import OUTPUT

    heard: list[Any] = []
    late = probe.bench.node.create_subscription(JointState, "compensator/friction_torque", heard.append, OUTPUT)
    probe.bench.drive(1.0)
    probe.bench.node.destroy_subscription(late)
    if not heard:
        row.violations["a late subscriber hears nothing"] += 1
