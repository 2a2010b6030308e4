"""A recording with topics, joints and types of somebody else becomes a run by the same map as any other log."""

import numpy as np
import pytest
from importing.logs import example, same

from winch_friction.importing.carry_out import import_log
from winch_friction.importing.propose import propose
from winch_friction.importing.reading import read_log
from winch_friction.records.bag_write import MESSAGES, BagWriter
from winch_friction.records.topics import FLUID_PRESSURE, joint_state, stamp_header


def write_foreign_bag(path, run):
    """Speeds in a JointState of several joints, pressures and load as plain Float64 in a PLC bridge's units."""
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_JAZZY)
    joint, plain = store.types["sensor_msgs/msg/JointState"], store.types["std_msgs/msg/Float64"]
    header, stamp = store.types["std_msgs/msg/Header"], store.types["builtin_interfaces/msg/Time"]
    floats = {
        "/plc/winch/druck_A_bar": run["main.pressure_a"] * 1e-5,
        "/plc/winch/druck_B_bar": run["main.pressure_b"] * 1e-5,
        "/plc/winch/displacement_m3_per_rad": run["main.displacement"], "/plc/hook_load_t": run["hook_load"] * 1e-3,
        "/plc/wire_out_m": run["wire_out"],
    }  # fmt: skip
    with Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        motion = writer.add_connection("/machine/joint_states", joint.__msgtype__, typestore=store)
        topics = {name: writer.add_connection(name, plain.__msgtype__, typestore=store) for name in floats}
        for k, time in enumerate(run.time + 1.7e9):
            now = int(round(time * 1e9))
            for name, values in floats.items():
                writer.write(topics[name], now, store.serialize_cdr(plain(float(values[k])), plain.__msgtype__))
            at = header(stamp(now // 10**9, now % 10**9), "")
            speeds = np.array([0.3, run["motor_speed"][k]])
            message = joint(at, ["boom", "winch_motor_7"], np.zeros(2), speeds, np.full(2, np.nan))
            writer.write(motion, now, store.serialize_cdr(message, joint.__msgtype__))


def test_a_foreign_recording_is_proposed_and_imported(tmp_path, crane_150t):
    pytest.importorskip("rosbags")
    run = example("test_08")
    write_foreign_bag(tmp_path / "bag", run)
    found = propose([tmp_path / "bag"], crane_150t, "crane_150t")
    assert found.problems == ()
    assert found.log_map.columns["motor_speed"].source == "/machine/joint_states:velocity[winch_motor_7]"
    back = import_log(tmp_path / "bag", found.log_map, crane_150t)
    assert len(back) == len(run)
    assert same(back, run, ["motor_speed", "main.pressure_a", "main.pressure_b", "main.displacement", "hook_load"])


@pytest.mark.parametrize(("stamped", "taken"), [(99.9, 99.9), (0.0, 100.0)])
def test_numbers_of_messages_within_messages_are_signals(stamped, taken, tmp_path):
    """A speed in a TwistStamped was not read, and not said to be left out. A stamp far off dates nothing."""
    kind = "geometry_msgs/msg/TwistStamped"
    with BagWriter(tmp_path / "bag") as bag:
        for k in range(5):
            header = stamp_header(stamped + 0.02 * k, MESSAGES)
            vectors = {
                each: MESSAGES.make("geometry_msgs/msg/Vector3", x=1.0 * k, y=0.0, z=0.0)
                for each in ("linear", "angular")
            }
            twist = MESSAGES.make("geometry_msgs/msg/Twist", **vectors)
            bag.write("/winch/twist", MESSAGES.make(kind, header=header, twist=twist), 100.0 + 0.02 * k)
    log = read_log(tmp_path / "bag")
    assert log.column("/winch/twist:twist.angular.x").unit == "rad/s"
    assert log.column("/winch/twist:twist.linear.x").unit == "m/s"
    assert log.column("/winch/twist:twist.angular.x").values.tolist() == [0.0, 1.0, 2.0, 3.0, 4.0]
    assert log.column("time").values == pytest.approx(taken + 0.02 * np.arange(5))
    assert not [each.name for each in log.columns if "stamp" in each.name]
    assert not [each.name for each in log.columns if each.name.endswith((".y", ".z"))]
    assert any("zero throughout" in each and "/winch/twist:twist.angular.y" in each for each in log.notes)


def test_a_sensor_that_falls_silent_is_said(tmp_path):
    """Its last value is held to the end of the log."""
    with BagWriter(tmp_path / "bag") as bag:
        for k in range(500):
            header = stamp_header(100.0 + 0.02 * k, MESSAGES)
            speed = joint_state(MESSAGES, header, "drum", velocity=1.0 + k)
            bag.write("/plc/speed", speed, 100.0 + 0.02 * k)
            for name, lasts in (("a", 200), ("b", 500)):
                if k % 2 == 0 and k < lasts:
                    made = MESSAGES.make(FLUID_PRESSURE, header=header, fluid_pressure=2e7 + k, variance=0.0)
                    bag.write(f"/plc/{name}", made, 100.0 + 0.02 * k)
    (said,) = [each for each in read_log(tmp_path / "bag").notes if "say nothing for long" in each]
    assert "/plc/a:fluid_pressure for 6.02 s, 3.96 s after its first value" in said
    assert "/plc/b" not in said
