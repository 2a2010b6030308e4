"""The Foxglove server as a client sees it, and its MCAP as the reader of the format sees it."""

import json
import struct
import sys
import threading
import time
from pathlib import Path
from types import SimpleNamespace

import pytest
from mcap_ros2.decoder import DecoderFactory

from winch_friction.cli import foxglove, live
from winch_friction.cli.foxglove import serving, written
from winch_friction.cli.main import run
from winch_friction.physics.errors import InputError
from winch_friction.records.bag_write import MESSAGES, BagWriter
from winch_friction.records.topics import JOINT_STATE, joint_state, stamp_header

pytest.importorskip("foxglove", reason="needs foxglove-sdk: pip install '.[foxglove]'")
client = pytest.importorskip("websockets.sync.client")
OWN = {f"/winch_friction/{name}" for name in ("speed", "feedforward", "error", "estimates", "health")}
PARAMETERS = {"K4": "14.5", "K4 std": "0.7", "K4 status": "learned"}


@pytest.fixture(scope="module")
def bag(tmp_path_factory):
    """Two seconds of what the nodes say."""
    path = tmp_path_factory.mktemp("bag") / "bag"
    with BagWriter(path) as writer:
        for k in range(100):
            header = stamp_header(1000.0 + 0.02 * k, MESSAGES)
            speed = joint_state(MESSAGES, header, "winch_motor", velocity=10.0 + k)
            torque = joint_state(MESSAGES, header, "winch_motor", effort=300.0 + k)
            truth = MESSAGES.make(JOINT_STATE, header=header, name=["winch_motor", "load"],
                                  position=MESSAGES.doubles([0.0, 0.004]), velocity=MESSAGES.doubles([0.0, 0.0]),
                                  effort=MESSAGES.doubles([350.0, 0.0]))  # fmt: skip
            for topic, message in (("/winch/joint_states", speed), ("/compensator/friction_torque", torque),
                                   ("/simulator/truth", truth)):  # fmt: skip
                writer.write(topic, message, 1000.0 + 0.02 * k)
            if k % 50 == 49:
                writer.write("/diagnostics", diagnostics(header), 1000.0 + 0.02 * k)
    return path


def diagnostics(header):
    def status(name, level, said, **values):
        pairs = [MESSAGES.make("diagnostic_msgs/msg/KeyValue", key=k, value=v) for k, v in values.items()]
        return MESSAGES.make("diagnostic_msgs/msg/DiagnosticStatus", level=level, name=name, message=said,
                             hardware_id="crane_150t", values=pairs)  # fmt: skip

    parts = [
        status("estimator: parameters", 0, "learning", **PARAMETERS),
        status("compensator: inputs", 1, "an input was lost", **{"speed rate": "50", "speed age": "inf"}),
    ]
    return MESSAGES.make("diagnostic_msgs/msg/DiagnosticArray", header=header, status=parts)


def look(address, until, patience=20.0):
    """Speak the protocol: what is advertised by topic, and the messages of each topic until enough came."""
    channels, heard, names = {}, {}, {}
    with client.connect(address, subprotocols=["foxglove.sdk.v1"], close_timeout=0.5) as link:
        assert link.subprotocol == "foxglove.sdk.v1"
        while not until(heard):
            frame = link.recv(timeout=patience)
            if isinstance(frame, bytes):
                assert frame[0] == 1  # message data
                subscription, _ = struct.unpack_from("<IQ", frame, 1)
                heard.setdefault(names[subscription], []).append(frame[13:])
                continue
            said = json.loads(frame)
            if said["op"] == "advertise":
                new = {each["id"]: each for each in said["channels"]}
                channels |= {each["topic"]: each for each in new.values()}
                names |= {each["id"]: each["topic"] for each in channels.values()}
                wanted = [{"id": number, "channelId": number} for number in new]
                link.send(json.dumps({"op": "subscribe", "subscriptions": wanted}))
    return channels, heard


def test_a_client_sees_channels_with_schemas_and_their_messages(bag):
    with serving(bag, "", 0.0, 0) as address:
        assert address.startswith("ws://127.0.0.1:")
        enough = lambda heard: set(heard) >= OWN and len(heard.get("/simulator/truth", [])) == 100
        channels, heard = look(address, enough)
    assert {*OWN, "/winch/joint_states", "/compensator/friction_torque", "/diagnostics"} <= set(channels)
    joints = channels["/compensator/friction_torque"]
    assert (joints["encoding"], joints["schemaName"], joints["schemaEncoding"]) == ("cdr", JOINT_STATE, "ros2msg")
    assert "float64[] effort" in joints["schema"]
    assert "MSG: std_msgs/Header" in joints["schema"]
    torque = MESSAGES.store.deserialize_cdr(heard["/compensator/friction_torque"][-1], JOINT_STATE)
    assert torque.effort[0] == 399.0
    for topic in OWN:
        schema = json.loads(channels[topic]["schema"])
        assert channels[topic]["schemaEncoding"] == "jsonschema"
        for message in heard[topic]:
            jsonschema(json.loads(message), schema)
    assert json.loads(heard["/winch_friction/error"][0])["value"] == pytest.approx(4.0)
    (estimate,) = json.loads(heard["/winch_friction/estimates"][0])["parameters"]
    assert (estimate["parameter"], estimate["std"], estimate["upper"]) == ("K4", 0.7, pytest.approx(15.9))
    health = json.loads(heard["/winch_friction/health"][0])
    assert health["faults"] == ["warning: compensator: inputs: an input was lost"]
    assert health["inputs"] == [{"input": "speed", "rate": 50.0, "age": None}]
    assert health["header"]["stamp"] == {"sec": 1000, "nsec": 980000000}


def jsonschema(message, schema):
    import jsonschema

    jsonschema.validate(message, schema)
    assert set(message) <= set(schema["properties"])


def test_a_bag_plays_again_for_the_next_client(bag):
    with serving(bag, "", 0.0, 0) as address:
        for _ in range(2):
            look(address, lambda heard: len(heard.get("/simulator/truth", [])) == 100)


def test_a_port_that_is_taken_is_said_in_one_line(bag):
    with serving(bag, "", 0.0, 0) as address:
        port = int(address.rpartition(":")[2])
        with pytest.raises(InputError, match=f"--port {port}: .*give another port"), serving(bag, "", 0.0, port):
            pass


def test_the_mcap_holds_schemas_and_is_read_by_the_formats_own_reader(bag, tmp_path):
    from mcap.reader import make_reader

    assert run(["foxglove", "--bag", str(bag), "--out", str(tmp_path / "out.mcap")]) == 0
    with (tmp_path / "out.mcap").open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        schemas = {c.topic: reader.get_summary().schemas[c.schema_id] for c in reader.get_summary().channels.values()}
        torques = [m.effort[0] for _, _, _, m in reader.iter_decoded_messages(["/compensator/friction_torque"])]
        times = [m.log_time for _, _, m in reader.iter_messages(["/compensator/friction_torque"])]
        says = [json.loads(m.data) for _, _, m in reader.iter_messages(["/winch_friction/estimates"])]
    assert torques == [300.0 + k for k in range(100)]
    assert times == [round((1000.0 + 0.02 * k) * 1e9) for k in range(100)]  # when they came, not when they were copied
    assert (schemas["/simulator/truth"].encoding, schemas["/simulator/truth"].name) == ("ros2msg", JOINT_STATE)
    assert schemas["/winch_friction/estimates"].encoding == "jsonschema"
    assert says[0]["parameters"][0]["value"] == 14.5


def test_what_is_computed_carries_the_stamp_of_its_measurement_and_the_time_it_came(tmp_path):
    from mcap.reader import make_reader

    late = 0.5  # s on the way
    with BagWriter(tmp_path / "bag") as writer:
        for k in range(50):
            time = 1000.0 + 0.02 * k
            header = stamp_header(time, MESSAGES)
            torque = joint_state(MESSAGES, header, "winch_motor", effort=300.0 + k)
            truth = joint_state(MESSAGES, header, "load", position=0.004, effort=0.0)
            writer.write("/simulator/truth", truth, time + late)
            writer.write("/compensator/friction_torque", torque, time + late)
        writer.write("/diagnostics", diagnostics(header), time + late)
    assert run(["foxglove", "--bag", str(tmp_path / "bag"), "--out", str(tmp_path / "out.mcap")]) == 0
    with (tmp_path / "out.mcap").open("rb") as file:
        own = [(c.topic, m.log_time, json.loads(m.data)) for _, c, m in make_reader(file).iter_messages([*OWN])]
    assert {topic for topic, *_ in own} >= {"/winch_friction/error", "/winch_friction/estimates"}
    for topic, came, said in own:
        stamp = said["header"]["stamp"]
        assert came * 1e-9 - (stamp["sec"] + 1e-9 * stamp["nsec"]) == pytest.approx(late, abs=1e-6), topic


def test_what_cannot_be_written_is_said_and_nothing_is_lost(bag, tmp_path, capsys):
    (tmp_path / "there.mcap").write_text("mine")
    for out in ("there.mcap", "name.bag"):
        assert run(["foxglove", "--bag", str(bag), "--out", str(tmp_path / out)]) == 2
    assert run(["foxglove", "--out", str(tmp_path / "x.mcap")]) == 2
    assert run(["foxglove", "--bag", str(tmp_path / "none"), "--out", str(tmp_path / "x.mcap")]) == 2
    assert (tmp_path / "there.mcap").read_text() == "mine"
    assert [each.name for each in tmp_path.iterdir()] == ["there.mcap"]
    assert len(capsys.readouterr().err.strip().splitlines()) == 4


def test_without_the_sdk_one_line_says_what_to_install(bag, monkeypatch):
    monkeypatch.setitem(sys.modules, "foxglove", None)
    with pytest.raises(InputError, match=r"pip install 'winch_friction\[foxglove\]'"):
        written(bag, Path("x.mcap"))


def test_a_topic_of_a_type_that_nobody_knows_is_read_past_and_said(tmp_path, capsys):
    """A crane's own message type kept the whole bag from being shown."""
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    store = get_typestore(Stores.ROS2_JAZZY)
    store.register(get_types_from_msg("float64 grease", "crane_msgs/msg/Grease"))
    joint = MESSAGES.store.types[JOINT_STATE]
    with Writer(tmp_path / "bag", version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        speed = writer.add_connection("/winch/joint_states", joint.__msgtype__, typestore=store)
        own = writer.add_connection("/crane/grease", "crane_msgs/msg/Grease", typestore=store)
        for k in range(50):
            message = joint_state(MESSAGES, stamp_header(0.02 * k, MESSAGES), "winch_motor", velocity=10.0)
            writer.write(speed, 20_000_000 * k, MESSAGES.store.serialize_cdr(message, JOINT_STATE))
            grease = store.types["crane_msgs/msg/Grease"](grease=1.0)
            writer.write(own, 20_000_000 * k, store.serialize_cdr(grease, "crane_msgs/msg/Grease"))
        writer.write(speed, 10**9, b"\0\1\0\0\7")  # broken
    assert written(tmp_path / "bag", tmp_path / "out.mcap") == 51
    assert "topic '/crane/grease': crane_msgs/msg/Grease" in capsys.readouterr().err
    with serving(tmp_path / "bag", "", 0.0, 0) as address:
        assert address.startswith("ws://")


def test_a_bag_is_played_once_for_each_time_that_somebody_asks(monkeypatch):
    """Played again and again for whoever asked once, its end is never seen."""
    asked, ended, played = threading.Event(), threading.Event(), []
    monkeypatch.setattr(live, "bag_messages", lambda *_: played.append("begins") or iter(["message"]))
    relay = SimpleNamespace(take=played.append)
    job = threading.Thread(target=foxglove._pump, args=(None, relay, None, Path("bag"), 1.0, asked, ended), daemon=True)
    job.start()
    for k in range(2):
        asked.set()
        began = time.monotonic()
        while (len(played) < 2 * (k + 1) or asked.is_set()) and time.monotonic() - began < 5.0:
            time.sleep(0.01)
    time.sleep(0.1)  # and not a third time
    ended.set()
    job.join(5.0)
    assert played == ["begins", "message"] * 2
