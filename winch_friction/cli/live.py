"""What `watch`, `dashboard` and `foxglove` show: from running nodes, or from a bag at its own pace."""

import base64
import contextlib
import importlib.util
import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from winch_friction.cli.inputs import show_warnings
from winch_friction.physics.errors import InputError
from winch_friction.records.raw import RawMessage

BAG_PERIOD = 0.2  # s of the bag per frame


def frames(bag: Path | None, namespace: str, rate: float, joint: str = "") -> Iterator[dict[str, Any]]:
    """Frames of a bag (`rate` times as fast as it was; 0: at once) or, without one, of the running nodes.

    `joint` carries the winch's speed; '' stands for winch_motor, else the first there is. Raises `InputError` for
    what is no bag, before anything is served.
    """
    if bag is not None:
        bag_topics(bag)
    return bag_frames(bag, namespace, rate, joint) if bag is not None else live_frames(namespace, joint)


def live_frames(namespace: str, joint: str = "") -> Iterator[dict[str, Any]]:
    """Frames of the running nodes, from a listener in a process of its own; ends with it."""
    listener = Listener(namespace, "--joint", joint)
    try:
        yield from listener
    finally:
        listener.close()


class Listener:
    """A process that hears the running nodes and writes what it heard as JSON lines.

    `close` ends it, from whatever thread: the one that reads may wait for a message that never comes. Raises
    `InputError` without rclpy, and to the reader when the process ends by itself.
    """

    def __init__(self, namespace: str, *options: str) -> None:
        if importlib.util.find_spec("rclpy") is None:
            raise InputError(
                "running nodes are heard with rclpy: source ROS 2, or pip install 'winch_friction[ros]'; or give --bag"
            )
        command = [sys.executable, "-m", "winch_friction.nodes.telemetry", "--namespace", namespace, *options]
        command += ["--reader", str(os.getpid())]
        self._process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        self._closed = False

    def __iter__(self) -> Iterator[dict[str, Any]]:
        said = ""
        for line in self._process.stdout or ():
            try:
                heard = json.loads(line)
            except ValueError:  # the middleware's own words, or half a line of a process that was killed
                said = f": {line.strip()}" if line.strip() else said
                continue
            if "error" in heard:
                raise InputError(heard["error"])
            yield heard
        if not self._closed:
            raise InputError(f"the listener ended{said}; is the middleware in order? 'winch-friction doctor' looks")

    def messages(self) -> Iterator[RawMessage]:
        """With the option --raw: every message of the winch's topics and /diagnostics, serialised as it came."""
        for line in self:
            yield RawMessage(line["topic"], line["type"], line["receipt"], base64.b64decode(line["data"]))

    def close(self) -> None:
        """End the process."""
        self._closed = True
        self._process.terminate()
        self._process.wait()


def bag_frames(path: Path, namespace: str, rate: float, joint: str = "") -> Iterator[dict[str, Any]]:
    """Frames of a bag, one per 0.2 s of its time."""
    from winch_friction.records.bag_storage import readable
    from winch_friction.records.telemetry import TOPICS, Telemetry

    prefix = f"/{namespace.strip('/')}/" if namespace.strip("/") else "/"
    names = {topic if topic.startswith("/") else prefix + topic: topic for topic in TOPICS}
    telemetry = Telemetry(joint, namespace)
    with _opened(path) as reader:
        chosen = [each for each in reader.connections if each.topic in names]
        if not chosen:
            raise InputError(f"{path}: none of the winch's topics is in it ({', '.join(names)})")
        last, broken, said = 0, 0, list[str]()
        for connection, stamp, raw in readable(reader, chosen, str(path), said):
            try:
                message = reader.deserialize(raw, connection.msgtype)
                telemetry.take(names[connection.topic], message, stamp * 1e-9)
            except Exception:  # whatever the bytes of a broken message lead to
                broken += 1
                continue
            if stamp - last >= BAG_PERIOD * 1e9:
                if rate > 0.0 and last:
                    time.sleep(min(BAG_PERIOD, (stamp - last) * 1e-9) / rate)
                last = stamp
                yield telemetry.frame()
        yield telemetry.frame()
        said += [f"{path}: {broken} messages cannot be read"] * bool(broken)
        if said:
            raise InputError(*said)


def bag_topics(path: Path) -> dict[str, str]:
    """Topics of a bag with their types."""
    with _opened(path) as reader:
        return {each.topic: each.msgtype for each in reader.connections}


def bag_messages(path: Path, rate: float) -> Iterator[RawMessage]:
    """Every message of a bag, serialised as it is there, at its own pace (`rate` times as fast; 0: at once)."""
    from winch_friction.records.bag_storage import readable

    with _opened(path) as reader:
        began, first, said = time.monotonic(), None, list[str]()
        for connection, stamp, raw in readable(reader, reader.connections, str(path), said):
            first = stamp if first is None else first
            if rate > 0.0:
                time.sleep(max(0.0, began + (stamp - first) * 1e-9 / rate - time.monotonic()))
            yield RawMessage(connection.topic, connection.msgtype, stamp, bytes(raw))
    show_warnings(said)


@contextlib.contextmanager
def _opened(path: Path) -> Iterator[Any]:
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import Stores, get_typestore

    from winch_friction.records.bag_storage import refused, storage_of

    if not path.exists():
        raise InputError(f"{path}: no such bag")
    storage = storage_of(path)
    try:
        reader: Any = AnyReader([storage], default_typestore=get_typestore(Stores.ROS2_JAZZY))
        reader.open()
    except Exception as error:  # rosbags raises its own kinds for what is no bag
        raise refused(path, error) from error
    try:
        yield reader
    finally:
        reader.close()
