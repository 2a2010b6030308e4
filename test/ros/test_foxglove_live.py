"""The Foxglove server passes on what running publishers say, from a listener in a process of its own."""

import json
import struct
import threading
import time

import pytest

from winch_friction.cli.foxglove import serving
from winch_friction.nodes.inputs import message_type
from winch_friction.records.topics import JOINT_STATE

pytest.importorskip("foxglove", reason="needs foxglove-sdk: pip install '.[foxglove]'")
client = pytest.importorskip("websockets.sync.client")


def hear(address, topic, channels, messages):
    """Advertised channels, and messages of one topic until there are ten."""
    wanted = {}
    with client.connect(address, subprotocols=["foxglove.sdk.v1"], close_timeout=0.5) as link:
        while len(messages) < 10:
            frame = link.recv(timeout=30.0)
            if isinstance(frame, bytes):
                assert struct.unpack_from("<I", frame, 1)[0] == 7
                messages.append(frame[13:])
                continue
            said = json.loads(frame)
            for each in said.get("channels", []):
                channels[each["topic"]] = each
                if each["topic"] == topic:
                    wanted = {"op": "subscribe", "subscriptions": [{"id": 7, "channelId": each["id"]}]}
                    link.send(json.dumps(wanted))
            # the SDK advertises a channel a moment before it takes subscriptions to it, and says that there is none
            if said.get("op") == "status" and wanted:
                time.sleep(0.1)
                link.send(json.dumps(wanted))


def test_live_topics_are_advertised_and_heard(bench, monkeypatch):
    from rclpy.serialization import deserialize_message

    monkeypatch.setenv("ROS_DOMAIN_ID", str(bench.domain))
    channels, raw = {}, []
    with serving(None, "", 1.0, 0) as address:
        listener = threading.Thread(target=hear, args=(address, "/winch/joint_states", channels, raw), daemon=True)
        listener.start()
        bench.announce()
        for _ in range(15):
            bench.drive(1.0)
            if not listener.is_alive():
                break
    assert len(raw) == 10
    speeds = [deserialize_message(each, message_type(JOINT_STATE)).velocity[0] for each in raw]
    assert max(map(abs, speeds)) < 105.0  # rad/s; the swell turns at 100 at most
    assert channels["/winch/joint_states"]["schemaName"] == JOINT_STATE
    assert channels["/winch_friction/speed"]["schemaEncoding"] == "jsonschema"
