"""Frames of telemetry for `watch` and `dashboard`: from running nodes, or from a bag at its own pace."""

import contextlib
import importlib.util
import json
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from winch_friction.physics.errors import InputError

BAG_PERIOD = 0.2  # s of the bag per frame


def frames(bag: Path | None, namespace: str, rate: float) -> Iterator[dict[str, Any]]:
    """Frames of a bag (`rate` times as fast as it was; 0: at once) or, without one, of the running nodes."""
    return bag_frames(bag, namespace, rate) if bag is not None else live_frames(namespace)


def live_frames(namespace: str) -> Iterator[dict[str, Any]]:
    """Frames of the running nodes, from a listener in a process of its own; ends with it."""
    if importlib.util.find_spec("rclpy") is None:
        raise InputError(
            "running nodes are heard with rclpy: source ROS 2, or pip install 'winch_friction[ros]'; or give --bag"
        )
    command = [sys.executable, "-m", "winch_friction.nodes.telemetry", "--namespace", namespace]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as listener:
        try:
            for line in listener.stdout or ():
                yield json.loads(line)
            raise InputError("the listener ended; is the middleware in order? 'winch-friction doctor' looks")
        finally:
            listener.terminate()


def bag_frames(path: Path, namespace: str, rate: float) -> Iterator[dict[str, Any]]:
    """Frames of a bag, one per 0.2 s of its time."""
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import Stores, get_typestore

    from winch_friction.records.telemetry import TOPICS, Telemetry

    if not path.exists():
        raise InputError(f"{path}: no such bag")
    prefix = f"/{namespace.strip('/')}/" if namespace.strip("/") else "/"
    names = {topic if topic.startswith("/") else prefix + topic: topic for topic in TOPICS}
    telemetry = Telemetry()
    try:
        reader: Any = AnyReader([path], default_typestore=get_typestore(Stores.ROS2_JAZZY))
    except Exception as error:  # rosbags raises its own kinds for what is no bag
        raise InputError(f"{path}: not a bag that can be read ({error})") from error
    with contextlib.ExitStack() as stack:
        stack.enter_context(reader)
        chosen = [each for each in reader.connections if each.topic in names]
        if not chosen:
            raise InputError(f"{path}: none of the winch's topics is in it ({', '.join(names)})")
        last = 0
        for connection, stamp, raw in reader.messages(chosen):
            telemetry.take(names[connection.topic], reader.deserialize(raw, connection.msgtype))
            if stamp - last >= BAG_PERIOD * 1e9:
                if rate > 0.0 and last:
                    time.sleep(min(BAG_PERIOD, (stamp - last) * 1e-9) / rate)
                last = stamp
                yield telemetry.frame()
        yield telemetry.frame()
