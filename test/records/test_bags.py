"""Bags: a run survives the journey in both storages, other readers agree, and odd recordings are answered properly."""

import shutil

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from run_strategies import make_run, runs, same

from winch_friction.cli.live import bag_frames, bag_messages
from winch_friction.importing.reading import read_log
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import Run
from winch_friction.records.bag_file import open_bag
from winch_friction.records.bag_storage import refused
from winch_friction.records.bag_write import MESSAGES, BagWriter, write_bag
from winch_friction.records.bags import bag_samples
from winch_friction.records.runs import read_run, write_run
from winch_friction.records.sample_stream import InputHold
from winch_friction.records.topics import TopicMap, crane_topics, joint_state, stamp_header
from winch_friction.replay.recording import replay_recording

FEW = settings(max_examples=8, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
STORAGES = ("mcap", "sqlite3")


@pytest.mark.parametrize("kind", ["mcap", "sqlite3", ".mcap", ".db3"])
@FEW
@given(run=runs)
def test_a_run_comes_back_from_a_bag(tmp_path_factory, kind, run):
    path = tmp_path_factory.mktemp("bag") / f"run{kind if kind[0] == '.' else ''}"
    write_run(run, path, **({} if kind[0] == "." else {"storage": kind}))
    back = read_run(path)
    assert path.is_file() == kind.startswith(".")
    assert same(run, back, rel=1e-12)
    np.testing.assert_allclose(back.time, run.time, rtol=0, atol=3e-7 if run.time[0] > 1e9 else 1e-9)


@pytest.mark.parametrize("joint", ["winch_motor", "winch_drum"])
@pytest.mark.parametrize("reference", ["gauge", "absolute"])
@pytest.mark.parametrize("unit", ["fraction", "m3_per_rad"])
def test_every_convention_comes_back(tmp_path, crane_150t, joint, reference, unit):
    run = make_run(groups=("active", "passive"), rows=5)
    conventions = {"speed_joint": joint, "pressure_reference": reference}
    topics = crane_topics(crane_150t, run.groups, displacement_unit=unit, **conventions)
    back = read_run(write_bag(run, tmp_path / "bag", topics), crane_150t, **conventions)
    assert same(run, back, rel=1e-11)


def test_metadata_travels_in_the_folder(tmp_path):
    run = Run("x", make_run(rows=5).columns, metadata={"scenario": "ahc", "seed": 3})
    assert read_run(write_run(run, tmp_path / "x")).metadata == {"scenario": "ahc", "seed": 3}


@pytest.mark.parametrize("name", ["run", "run.mcap"])
def test_an_independent_reader_agrees(tmp_path, name):
    from mcap_ros2.reader import read_ros2_messages

    run = make_run(rows=20)
    path = write_run(run, tmp_path / name)
    file = path if path.is_file() else next(path.glob("*.mcap"))
    read = {"/winch/joint_states": [], "/winch/active/pressure_a": [], "/winch/hook_load": []}
    for each in read_ros2_messages(file):
        message = each.ros_msg
        if each.channel.topic == "/winch/joint_states":
            assert list(message.name) == ["winch_motor"]
            read[each.channel.topic].append(message.velocity[0])
        elif each.channel.topic in read:
            read[each.channel.topic].append(getattr(message, "fluid_pressure", None) or message.data)
    assert read["/winch/joint_states"] == list(run["motor_speed"])
    assert read["/winch/active/pressure_a"] == list(run["active.pressure_a"])
    assert read["/winch/hook_load"] == list(run["hook_load"])


def test_rows_are_the_samples_that_a_node_would_see(tmp_path):
    run = make_run(rows=50)
    holed = {**run.columns, "active.pressure_a": np.where(np.arange(50) % 3, np.nan, run["active.pressure_a"])}
    back = read_run(write_run(Run("x", holed), tmp_path / "x"))
    held = InputHold(run.groups)
    samples = list(held.samples(Run("x", holed)))
    assert list(back["active.pressure_a"]) == [s.groups["active"].pressure_a for s in samples]
    assert back["active.pressure_a"][2] == run["active.pressure_a"][0]


def test_a_lost_channel_becomes_nan_after_its_age_and_is_said(tmp_path):
    run = make_run(rows=50)
    lost = {**run.columns, "active.pressure_b": np.where(run.time > 0.4, np.nan, run["active.pressure_b"])}
    back = read_run(write_run(Run("x", lost), tmp_path / "x"))
    assert np.isnan(back["active.pressure_b"][run.time > 0.51]).all()
    assert not np.isnan(back["active.pressure_b"][run.time < 0.49]).any()
    assert any("active.pressure_b" in each and "/winch/joint_states" in each for each in back.warnings)


def test_what_of_a_bag_is_not_believed_is_said(tmp_path, crane_150t):
    """A load in g passes no sensor's range; a displacement in per cent was told as a column that is not there."""
    run = make_run(rows=50)
    heavy = {**run.columns, "hook_load": np.where(np.arange(50) < 20, 1e9, run["hook_load"])}
    back = read_run(write_run(Run("x", heavy), tmp_path / "x"))
    assert any("topic '/winch/hook_load': 20 of 50 messages are left out" in each for each in back.warnings)
    topics = crane_topics(crane_150t, run.groups)
    per_cent = {**run.columns, "active.displacement": np.full(50, 80.0 * crane_150t.max_displacement)}
    write_bag(Run("y", per_cent), tmp_path / "y", topics)
    with pytest.raises(InputError, match="/winch/active/displacement': 50 of 50 messages are left out"):
        read_run(tmp_path / "y", crane_150t)


def test_of_times_that_go_back_nothing_else_is_told(tmp_path):
    with BagWriter(tmp_path / "x") as writer:
        for k in range(100):
            time = 0.02 * (k if k < 80 else k - 75)
            writer.write("/winch/joint_states", speed_message(time, 1.0), 0.02 * k)
            load = MESSAGES.make("std_msgs/msg/Float64", data=1e9 if k < 20 else 55e3)
            writer.write("/winch/hook_load", load, 0.02 * k)
    with pytest.raises(InputError, match="time goes back") as refused:
        read_run(tmp_path / "x", complete=False)
    assert len(refused.value.problems) == 1


def test_stamps_that_stand_still_are_for_import(tmp_path):
    with BagWriter(tmp_path / "x") as writer:
        for k in range(100):
            writer.write("/winch/joint_states", speed_message(0.0, float(k)), 1.7e9 + 0.02 * k)
    with pytest.raises(InputError, match="is stamped 0 s: .* winch-friction import takes the times of receipt"):
        read_run(tmp_path / "x", complete=False)
    assert np.diff(read_log(tmp_path / "x").column("time").values) == pytest.approx(np.full(99, 0.02), abs=1e-6)


def test_a_recorder_on_another_clock_does_not_matter(tmp_path):
    run, topics = make_run(rows=30), TopicMap(groups=("active",), displacement_unit="m3_per_rad")
    with BagWriter(tmp_path / "x") as writer:
        for sample in run.samples():
            for topic, message in topics.encode(sample, MESSAGES):
                writer.write(f"/crane_1/{topic}", message, 1.7e9 + sample.time)
    back = read_run(tmp_path / "x")
    assert same(run, back, rel=1e-6)
    with open_bag(tmp_path / "x") as bag:
        for each in bag.inputs():  # the receipt stands on the stamps' clock, also of a message without a stamp
            assert run.time[0] - 0.1 <= each.receipt <= run.time[-1] + 0.1
            assert each.receipt == pytest.approx(each.stamp, abs=1e-3)


def speed_message(time, speed, joint="winch_motor"):
    return joint_state(MESSAGES, stamp_header(time, MESSAGES), joint, velocity=speed)


def test_two_winches_in_one_bag_are_told_apart(tmp_path):
    with BagWriter(tmp_path / "x") as writer:
        for k in range(60):
            writer.write("/aft/winch/joint_states", speed_message(0.02 * k, 1.0), 0.02 * k)
            writer.write("/fore/winch/joint_states", speed_message(0.02 * k, 2.0), 0.02 * k)
    with pytest.raises(InputError, match="several winches"):
        read_run(tmp_path / "x", complete=False)
    assert read_run(tmp_path / "x", complete=False, namespace="fore")["motor_speed"][0] == 2.0


def test_broken_messages_are_counted_not_fatal(tmp_path):
    with BagWriter(tmp_path / "x") as writer:
        for k in range(60):
            writer.write("/winch/joint_states", speed_message(0.02 * k, 1.0), 0.02 * k)
            if k % 20 == 5:
                writer.write_raw("/winch/joint_states", "sensor_msgs/msg/JointState", b"\0\1\0\0\7", int(2e7 * k))
    run = read_run(tmp_path / "x", complete=False)
    assert len(run) == 60
    assert any("3 messages cannot be read" in each for each in run.warnings)
    shown = []
    with pytest.raises(InputError, match="3 messages cannot be read"):
        shown.extend(bag_frames(tmp_path / "x", "", 0.0))  # a list keeps what came before an error
    assert any("3 messages cannot be read" in each for each in read_log(tmp_path / "x").notes)
    assert sum(len(frame["points"].get("speed", [])) for frame in shown) > 10


def damaged_in_the_middle(path, spoil):
    """A bag whose file has 4000 bytes of another content in its middle; its index is whole."""
    storage = next(path.glob("*.mcap"))
    content = bytearray(storage.read_bytes())
    place = len(content) // 2
    content[place : place + 4000] = bytes(map(spoil, content[place : place + 4000]))
    storage.write_bytes(content)


@pytest.mark.parametrize("spoil", [lambda byte: byte ^ 0x5A, lambda byte: 0xFF], ids=["skipped", "stumbled over"])
def test_what_a_damaged_file_has_lost_is_said(tmp_path, spoil, crane_150t, crane2_model):
    path = write_run(make_run(rows=3000), tmp_path / "x")
    assert not any("damaged" in each for each in read_run(path).warnings)
    damaged_in_the_middle(path, spoil)
    run, log = read_run(path, complete=False), read_log(path)
    assert 500 < len(run) <= len(log) < 3000
    replayed = replay_recording(path, crane_150t, crane2_model)
    for said in (run.warnings, log.notes, replayed.warnings):
        assert sum("the file is damaged: of " in each for each in said) == 1
    with pytest.raises(InputError, match="the file is damaged"):
        list(bag_frames(path, "", 0.0))
    assert len(run) <= len(list(bag_messages(path, 0.0)))


@pytest.mark.parametrize(("kind", "repair"), [("mcap", "mcap recover run.mcap"), ("db3", "sqlite3 run.db3 .recover")])
def test_of_a_file_that_was_cut_it_is_said_what_saves_it(tmp_path, kind, repair):
    path = write_run(make_run(rows=400), tmp_path / f"run.{kind}")
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    for read in (read_run, read_log, lambda path: list(bag_frames(path, "", 0.0))):
        with pytest.raises(InputError, match=f"nothing is read .*{repair}"):
            read(path)


def test_of_several_files_that_were_cut_the_first_is_named(tmp_path):
    for name in ("a.mcap", "b.mcap"):
        (tmp_path / name).write_bytes(b"\x89MCAP0\r\n")
    said = str(refused(tmp_path, ValueError("it ends too soon")))
    assert said.count("mcap recover") == 1
    assert "mcap recover a.mcap" in said


def test_fractions_need_the_crane(tmp_path, crane_150t):
    run = make_run(rows=5)
    write_bag(run, tmp_path / "x", crane_topics(crane_150t, run.groups))
    with pytest.raises(InputError, match="give the crane"):
        read_run(tmp_path / "x")


@pytest.mark.parametrize("damage", ["no metadata", "half a file", "bad metadata", "empty folder", "other type"])
def test_damaged_recordings(tmp_path, damage):
    path = write_run(make_run(rows=400), tmp_path / "x")
    storage = next(path.glob("*.mcap"))
    if damage == "no metadata":  # the recorder was killed
        (path / "metadata.yaml").unlink()
        assert len(read_run(path)) == 400
        return
    if damage == "half a file":
        storage.write_bytes(storage.read_bytes()[: storage.stat().st_size // 2])
    elif damage == "bad metadata":
        (path / "metadata.yaml").write_text("rosbag2_bagfile_information: [")
    elif damage == "empty folder":
        shutil.rmtree(path)
        path.mkdir()
    else:
        shutil.rmtree(path)
        with BagWriter(path) as writer:
            for k in range(3):
                writer.write("/winch/joint_states", MESSAGES.make("std_msgs/msg/Float64", data=1.0), 0.02 * k)
    with pytest.raises(InputError) as caught:
        read_run(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_nothing_is_overwritten_and_a_failed_write_leaves_nothing(tmp_path):
    write_run(make_run(rows=5), tmp_path / "x")
    with pytest.raises(InputError, match="exists already"):
        write_run(make_run(rows=5), tmp_path / "x")
    with pytest.raises(RuntimeError), BagWriter(tmp_path / "y"):
        raise RuntimeError
    with pytest.raises(InputError, match="before 0"):
        write_run(make_run(rows=5, start=-1.0), tmp_path / "z")
    for start in (1.7e12, 6.4e10):  # ms since 1970 that are called s; days of MATLAB in s
        with pytest.raises(InputError, match="a bag holds times from 0 to"):
            write_run(make_run(rows=5, start=start), tmp_path / "z")
    assert [each.name for each in tmp_path.iterdir()] == ["x"]


HUSKY = {"remap": {"winch/joint_states": "/joint_states"}}


@pytest.mark.shared
def test_a_bag_that_rosbag2_wrote(shared_data):
    path = shared_data / "rosbags" / "husky_ur_sim_sqlite3"
    joint = "front_left_wheel_joint"
    with open_bag(path, **HUSKY) as bag:
        names = next(message.name for _, _, message in bag.messages("/joint_states"))
        joint = names[0]
    run = read_run(path, complete=False, speed_joint=joint, motor_joint=joint, **HUSKY)
    assert len(run) == 396
    assert "motor_torque" not in run  # effort is NaN throughout
    assert np.isfinite(run["shaft_angle"]).all()
    said = "\n".join(run.warnings)
    assert "'/dynamic_joint_states' is of a type that is not installed, control_msgs/msg/DynamicJointState" in said
    with pytest.raises(InputError, match="motor_torque"):
        read_run(path, speed_joint=joint, motor_joint=joint, **HUSKY)
    with pytest.raises(InputError, match="remap"):
        read_run(path)


@pytest.mark.shared
def test_a_bag_without_messages(shared_data):
    with pytest.raises(InputError, match="no message"):
        read_run(shared_data / "rosbags" / "empty_sqlite3")


def test_samples_of_a_bag_match_its_run(tmp_path):
    run = make_run(rows=20)
    with open_bag(write_run(run, tmp_path / "x")) as bag:
        samples = list(bag_samples(bag, InputHold(bag.topics.groups)))
    assert [s.motor_speed for s in samples] == list(run["motor_speed"])


def test_what_a_bag_holds_beside_the_winch_is_read_past_and_said(tmp_path):
    with BagWriter(tmp_path / "bag") as writer:
        for k in range(5):
            header = stamp_header(1000.0 + 0.02 * k, MESSAGES)
            writer.write(
                "/winch/joint_states", joint_state(MESSAGES, header, "winch_motor", velocity=1.0), 1000.0 + 0.02 * k
            )
            writer.write("/arm/joint_states", joint_state(MESSAGES, header, "boom", velocity=1.0), 1000.0 + 0.02 * k)
    with open_bag(tmp_path / "bag") as bag:
        assert bag.warnings == ["bag: topics that are no inputs of the winch's, read past: /arm/joint_states"]


def spoken(tmp_path, crane, joint, name="bag"):
    """A bag whose speed bears this joint's name; `winch_drum` turns with the drum."""
    run = make_run(groups=("active", "passive"), rows=5)
    conventions = {"speed_joint": joint} | ({"motor_joint": joint} if joint != "winch_drum" else {})
    return run, write_bag(run, tmp_path / name, crane_topics(crane, run.groups, **conventions))


def test_a_drums_joint_by_its_own_name_needs_no_word(tmp_path, crane_150t):
    """The contract knows both names; a bag with the drum's was refused as one without a speed."""
    run, bag = spoken(tmp_path, crane_150t, "winch_drum")
    assert same(run, read_run(bag, crane_150t), rel=1e-11)
    with pytest.raises(InputError, match="no finite speed of joint 'winch_motor'"):
        read_run(bag, crane_150t, speed_joint="winch_motor")  # what is said holds


def test_a_joint_of_another_name_is_told_with_what_to_say(tmp_path, crane_150t, crane2_model):
    run, bag = spoken(tmp_path, crane_150t, "Winch_Motor")
    for read in (lambda: read_run(bag, crane_150t), lambda: replay_recording(bag, crane_150t, crane2_model)):
        with pytest.raises(
            InputError, match="joint 'winch_motor'; found Winch_Motor: name the winch's, replay --joint"
        ):
            read()
    assert same(run, read_run(bag, crane_150t, speed_joint="Winch_Motor", motor_joint="Winch_Motor"), rel=1e-11)
