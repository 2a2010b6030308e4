"""Replay: over a run, over its bag and live, the same samples give the same outputs."""

import itertools
import json
from dataclasses import replace

import numpy as np
import pytest
from own_term_files import forgotten, own_model, own_terms

import winch_friction as wf
from winch_friction.cli import main
from winch_friction.compensation import CompensatorConfig, FeedforwardCompensator
from winch_friction.estimation import EstimatorConfig, FrictionEstimator
from winch_friction.online.compensator import read_mark
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import Run
from winch_friction.records.bag_file import open_reader
from winch_friction.records.bag_write import MESSAGES, BagWriter
from winch_friction.records.model_file import load_model, model_to_text
from winch_friction.records.runs import read_run, write_run
from winch_friction.records.sample_stream import InputHold
from winch_friction.records.strict_yaml import config_directory
from winch_friction.records.topics import crane_topics, joint_state, stamp_header
from winch_friction.replay.compensator import replay_compensator
from winch_friction.replay.estimator import replay_estimator
from winch_friction.replay.outputs import write_outputs
from winch_friction.replay.recording import replay_recording
from winch_friction.replay.settings import Phase, ReplaySettings, settings_from_file, settings_from_metadata
from winch_friction.simulation.scenario import load_scenario
from winch_friction.simulation.simulator import simulate

SETTINGS = ReplaySettings(phases=(Phase(config=CompensatorConfig(ramp_time=0.2)),))


@pytest.fixture(scope="module")
def run(crane_150t, crane2_model):
    scenario = load_scenario("ahc_irregular").override({"duration": 12.0})
    return simulate(scenario, crane_150t, crane2_model, seed=11).run


@pytest.fixture(scope="module")
def bag(run, tmp_path_factory):
    return write_run(run, tmp_path_factory.mktemp("replay") / "bag")


def test_replay_is_the_nodes_own_step(run, crane_150t, crane2_model):
    replayed = replay_compensator(run, FeedforwardCompensator(crane_150t, crane2_model, CompensatorConfig()))
    again = FeedforwardCompensator(crane_150t, crane2_model, CompensatorConfig())
    by_hand = [again.step(sample).friction_torque for sample in InputHold(run.groups).samples(run)]
    assert replayed["friction_torque"].tolist() == by_hand
    assert np.abs(replayed["friction_torque"]).max() > 100.0


def test_a_bag_replays_like_its_run(run, bag, crane_150t, crane2_model):
    fresh = FeedforwardCompensator(crane_150t, crane2_model, SETTINGS.phases[0].config)
    direct = replay_compensator(read_run(bag, crane_150t), fresh)
    replayed = replay_recording(bag, crane_150t, crane2_model, SETTINGS, learn=False)
    np.testing.assert_allclose(replayed.compensator["friction_torque"], direct["friction_torque"], rtol=1e-9, atol=1e-9)


def test_the_estimator_replays_too(run, bag, crane_150t, crane2_model):
    direct = replay_estimator(read_run(bag, crane_150t), FrictionEstimator(crane_150t, crane2_model, EstimatorConfig()))
    replayed = replay_recording(bag, crane_150t, crane2_model, SETTINGS)
    np.testing.assert_allclose(replayed.estimator["innovation"], direct["innovation"], rtol=1e-9, equal_nan=True)
    assert replayed.estimator["C4"][-1] == replayed.model.value("C4") == pytest.approx(direct["C4"][-1], rel=1e-9)
    assert replayed.estimator["K2_std"][0] >= replayed.estimator["K2_std"][-1] > 0.0


@pytest.fixture(scope="module")
def heard(bag, crane_150t):
    """The run as messages carry it: to the nanosecond."""
    return read_run(bag, crane_150t)


def live_recording(path, run, crane, model, settings, order=None):
    """A bag as the nodes leave it: inputs, a model, outputs a little late; `order` shuffles the inputs of a scan."""
    topics = crane_topics(crane, run.groups)
    compensator = FeedforwardCompensator(crane, model, settings.phases[0].config)
    compensator.load_model(model)
    hold = InputHold(run.groups)
    with BagWriter(path, metadata={"phases": [{"start": 0.0, "name": "all", "parameters": {"ramp_time": 0.2}}]}) as bag:
        bag.write("/friction_model", MESSAGES.make("std_msgs/msg/String", data=model_to_text(model)), 0.0)
        for sample in hold.samples(run):
            messages = topics.encode(sample, MESSAGES)
            others = messages[:-1] if order is None else [messages[k] for k in order.permutation(len(messages) - 1)]
            for topic, message in (*others, messages[-1]):
                bag.write(f"/{topic}", message, sample.time)
            torque = compensator.step(sample).friction_torque
            answer = joint_state(MESSAGES, stamp_header(sample.time, MESSAGES), "winch_motor", effort=torque)
            bag.write("/compensator/friction_torque", answer, sample.time + 0.004)
    return path


@pytest.mark.parametrize("shuffled", [False, True])
def test_the_replay_of_a_live_recording_equals_it(tmp_path, heard, crane_150t, crane2_model, shuffled):
    order = np.random.default_rng(1) if shuffled else None
    path = live_recording(tmp_path / "live", heard, crane_150t, crane2_model, SETTINGS, order)
    replayed = replay_recording(path, crane_150t, crane2_model)  # the settings come from the recording
    (live,) = replayed.live
    assert live.node == "compensator"
    assert live.compared == len(replayed.compensator)
    assert live.missing == 0
    assert live.largest < 1e-9
    assert live.equal


def test_another_winch_in_the_bag_neither_teaches_nor_is_compared(tmp_path, heard, crane_150t, crane2_model):
    """Two winches on one deck: the other one's models and torques are its own."""
    topics, hold = crane_topics(crane_150t, heard.groups), InputHold(heard.groups)
    other = replace(crane2_model, values=tuple(1.2 * value for value in crane2_model.values))
    with BagWriter(tmp_path / "deck") as bag:
        said = MESSAGES.make("std_msgs/msg/String", data=model_to_text(other))
        bag.write("/starboard/friction_model", said, 0.0)
        for sample in hold.samples(heard):
            for winch in ("port", "starboard"):
                for topic, message in topics.encode(sample, MESSAGES):
                    bag.write(f"/{winch}/{topic}", message, sample.time)
            answer = joint_state(MESSAGES, stamp_header(sample.time, MESSAGES), "winch_motor", effort=0.0)
            bag.write("/starboard/compensator/friction_torque", answer, sample.time + 0.004)
    given = (crane_150t, crane2_model, SETTINGS)
    port = replay_recording(tmp_path / "deck", *given, learn=False, namespace="port")
    starboard = replay_recording(tmp_path / "deck", *given, learn=False, namespace="starboard")
    alone = replay_compensator(heard, FeedforwardCompensator(crane_150t, crane2_model, SETTINGS.phases[0].config))
    np.testing.assert_allclose(port.compensator["friction_torque"], alone["friction_torque"], rtol=1e-9, atol=1e-9)
    assert port.live == ()
    assert [each.node for each in starboard.live] == ["compensator"]
    assert np.abs(starboard.compensator["friction_torque"] - alone["friction_torque"]).max() > 10.0


def test_the_python_call_tells_two_winches_apart_and_reads_a_bag_as_its_parameter_file_says(
    tmp_path, heard, crane_150t, crane2_model
):
    """`replay(..., params_file=)` passed over the joints that the file names, and could not be told a winch of two."""
    topics, hold = crane_topics(crane_150t, heard.groups), InputHold(heard.groups)
    with BagWriter(tmp_path / "deck") as bag:
        for sample in itertools.islice(hold.samples(heard), 300, 400):
            for winch, times in (("port", 1.0), ("starboard", 0.5)):
                own = replace(sample, motor_speed=times * sample.motor_speed)
                for topic, message in topics.encode(own, MESSAGES):
                    bag.write(f"/{winch}/{topic}", message, sample.time)
    (tmp_path / "nodes.yaml").write_text("/**:\n  ros__parameters: {speed_joint: vinsj}\n")
    given = tmp_path / "deck", crane_150t, crane2_model
    with pytest.raises(InputError, match="several winches.*--namespace"):
        wf.replay(*given)
    port, starboard = (wf.replay(*given, namespace=each) for each in ("port", "/starboard"))
    assert np.abs(starboard.estimator["speed"]).max() < 0.9 * np.abs(port.estimator["speed"]).max()
    with pytest.raises(InputError, match="vinsj"):
        wf.replay(*given, namespace="port", params_file=tmp_path / "nodes.yaml")
    with pytest.raises(InputError, match="namespace 'port': a run is of one winch; leave it out"):
        wf.replay(heard, crane_150t, crane2_model, namespace="port")


def test_a_text_that_is_no_model_is_refused_as_by_the_node(tmp_path, heard, crane_150t, crane2_model):
    topics, hold = crane_topics(crane_150t, heard.groups), InputHold(heard.groups)
    with BagWriter(tmp_path / "bag") as bag:
        bag.write("/friction_model", MESSAGES.make("std_msgs/msg/String", data="hello"), 0.0)
        for sample in hold.samples(heard):
            for topic, message in topics.encode(sample, MESSAGES):
                bag.write(f"/{topic}", message, sample.time)
    replayed = replay_recording(tmp_path / "bag", crane_150t, crane2_model, SETTINGS)
    assert [said for said in replayed.warnings if "model refused: /friction_model" in said]
    assert np.abs(replayed.compensator["friction_torque"]).max() > 100.0


def test_other_settings_are_seen_to_differ(tmp_path, heard, crane_150t, crane2_model):
    path = live_recording(tmp_path / "live", heard, crane_150t, crane2_model, SETTINGS)
    other = ReplaySettings(phases=(Phase(config=CompensatorConfig(ramp_time=0.2, lead=0.001)),))
    (live,) = replay_recording(path, crane_150t, crane2_model, other).live
    assert not live.equal


def test_phases_begin_afresh(bag, run, crane_150t, crane2_model):
    config = SETTINGS.phases[0].config
    middle = float(run.time[len(run) // 2])
    settings = ReplaySettings((Phase(config=config), Phase(start=middle, config=config, enabled=False)))
    replayed = replay_recording(bag, crane_150t, crane2_model, settings, learn=False).compensator
    assert (replayed.aside["state"][replayed.time >= middle] == "disabled").all()
    assert not replayed["friction_torque"][replayed.time >= middle].any()
    assert replayed["friction_torque"][replayed.time < middle].any()


def test_settings_come_from_the_nodes_own_files(tmp_path):
    settings = settings_from_file(config_directory() / "nodes" / "crane.yaml")
    assert isinstance(settings.phases[0].config, CompensatorConfig)
    broken = tmp_path / "p.yaml"
    broken.write_text("/**/compensator:\n  ros__parameters:\n    scale: 7.0\n")
    with pytest.raises(InputError, match="scale"):
        settings_from_file(broken)
    with pytest.raises(InputError, match="speed"):
        settings_from_metadata({"phases": [{"parameters": {"speed": 1}}]}, "bag")


def test_outputs_as_bag_and_table(tmp_path, bag, crane_150t, crane2_model):
    replayed = replay_recording(bag, crane_150t, crane2_model, SETTINGS)
    parts = (replayed.compensator, replayed.estimator, replayed.model)
    table = read_run(write_outputs(tmp_path / "o.parquet", *parts), complete=False)
    np.testing.assert_array_equal(table.aside["friction_torque"], replayed.compensator["friction_torque"])
    assert write_outputs(tmp_path / "o.pq", *parts).read_bytes() == (tmp_path / "o.parquet").read_bytes()
    assert {"estimator.C4", "estimator.C4_std", "state"} <= set(table.aside)
    written = read_run(
        write_outputs(tmp_path / "o", *parts),
        complete=False,
        remap={"winch/joint_states": "/compensator/friction_torque"},
    )
    np.testing.assert_array_equal(written["motor_torque"], replayed.compensator["friction_torque"])


def test_a_bag_of_outputs_says_what_is_valid_and_what_a_silence_was_answered_by(
    tmp_path, run, crane_150t, crane2_model
):
    """A consumer that is tried on it must see a ramp to zero as one; it had no mark, and the ramps were not there."""
    gap = tmp_path / "gap"
    hole = run.time[len(run) // 2]
    with BagWriter(gap) as writer:
        for sample in run.samples():
            if not hole < sample.time < hole + 0.5:
                for topic, message in crane_topics(crane_150t, run.groups).encode(sample, MESSAGES):
                    writer.write(f"/{topic}", message, sample.time)
    replayed = replay_recording(gap, crane_150t, crane2_model, SETTINGS)
    assert len(replayed.watchdog) > 5
    out = write_outputs(tmp_path / "o", replayed.compensator, replayed.estimator, replayed.model, replayed.watchdog)
    said = {
        "/compensator/friction_torque": [],
        "/compensator/pressure_feedforward": [],
        "/estimator/friction_torque": [],
    }
    with open_reader(out) as (reader, types):
        for connection, _, raw in reader.messages():
            if connection.topic in said:
                text = types.deserialize_cdr(raw, connection.msgtype).header.frame_id
                said[connection.topic].append(read_mark(text))
    torque, pressure, learned = said.values()
    assert [number for _, number in torque] == list(range(1, len(torque) + 1)) == [number for _, number in pressure]
    assert len(torque) == len(replayed.compensator) + len(replayed.watchdog)
    assert {valid for valid, _ in torque} == {valid for valid, _ in learned} == {True, False}


def test_a_run_from_before_its_zero_makes_a_table_and_no_bag(tmp_path, run, capsys):
    early = replace(run, columns={**run.columns, "time": run.time - run.time[0] - 5.0})
    source = str(write_run(early, tmp_path / "early.parquet"))
    words = ["replay", source, "--crane", "crane_150t", "--model", "a6vm215_crane2", "--out"]
    assert main.run([*words, str(tmp_path / "bag")]) == 2
    assert "a bag holds times from 0 to" in capsys.readouterr().err
    assert main.run([*words, str(tmp_path / "table.csv")]) == 0
    assert sorted(each.name for each in tmp_path.iterdir()) == ["early.parquet", "table.csv"]


def test_the_verb(tmp_path, bag, capsys):
    arguments = ["replay", str(bag), "--crane", "crane_150t", "--model", "a6vm215_crane2"]
    files = ["--out", str(tmp_path / "o.csv"), "--picture", str(tmp_path / "o.png")]
    assert main.run([*arguments, *files, "--json"]) == 0
    content = json.loads(capsys.readouterr().out)
    assert content["samples"] > 500
    assert {each["parameter"] for each in content["parameters"]} >= {"K1", "C6"}
    assert (tmp_path / "o.png").read_bytes()[:4] == b"\x89PNG"
    assert main.run([*arguments, "--model", "nonsense"]) == 2
    assert main.run(["replay", str(tmp_path / "nothing"), *arguments[2:]]) == 2
    assert main.run([*arguments, "--remap", "x"]) == 2
    assert main.run([*arguments, "--remap", "a=b"]) == 2
    assert main.run([*arguments, "--model", ""]) == 2
    said = capsys.readouterr().err
    assert "Traceback" not in said
    assert said.splitlines()[-1] == "winch-friction: --model: give a model file or a shipped name; list has them"


def test_a_model_with_a_users_own_term_needs_its_file(tmp_path, bag, capsys):
    term, parameter = "replay_drag", "k_replay"
    model = own_model(tmp_path, term, parameter)
    arguments = ["replay", str(bag), "--crane", "crane_150t", "--model", str(model), "--json"]
    assert main.run(arguments) == 2
    assert "one of your own needs its file" in capsys.readouterr().err
    assert main.run([*arguments, "--terms-file", str(tmp_path / "missing.py")]) == 2
    assert "missing.py: not a readable" in capsys.readouterr().err
    with forgotten(term):
        assert main.run([*arguments, "--terms-file", str(own_terms(tmp_path, term, parameter))]) == 0
        content = json.loads(capsys.readouterr().out)
    assert parameter in {each["parameter"] for each in content["parameters"]}


def test_the_nodes_parameter_file_names_the_terms_too(tmp_path, bag, capsys):
    names = ("params_drag", "k_params")
    params = tmp_path / "nodes.yaml"
    params.write_text(f"/**:\n  ros__parameters:\n    terms_file: {own_terms(tmp_path, *names)}\n")
    arguments = ["--crane", "crane_150t", "--model", str(own_model(tmp_path, *names)), "--params-file", str(params)]
    with forgotten(names[0]):
        assert main.run(["replay", str(bag), *arguments, "--json"]) == 0
    assert names[1] in {each["parameter"] for each in json.loads(capsys.readouterr().out)["parameters"]}


def test_a_recording_names_the_terms_of_its_models(tmp_path):
    names = ("phase_drag", "k_phase")
    files = {"terms_file": str(own_terms(tmp_path, *names)), "model_file": str(own_model(tmp_path, *names))}
    with forgotten("phase_drag"):
        settings = settings_from_metadata({"phases": [{"parameters": files}]}, "bag")
    assert settings.phases[0].seed.term_names[-1] == "phase_drag"


def test_phases_of_a_recording_begin_after_its_pauses(tmp_path, run, crane_150t, crane2_model):
    shifts = (0.0, run.time[-1] + 2.0, 2.0 * (run.time[-1] + 2.0))
    phases = [
        {"name": "off", "enabled": False},
        {"name": "half", "parameters": {"scale": 0.45, "follow_model_topic": False}},
        {"name": "other", "parameters": {"model_file": "a6vm215_crane1", "scale": 0.9, "follow_model_topic": False}},
    ]
    topics = crane_topics(crane_150t, run.groups)
    with BagWriter(tmp_path / "bag", metadata={"phases": phases}) as writer:
        for shift in shifts:
            for sample in run.samples():
                sample.time += shift
                for topic, message in topics.encode(sample, MESSAGES):
                    writer.write(f"/{topic}", message, sample.time)
    replayed = replay_recording(tmp_path / "bag", crane_150t, crane2_model).compensator
    torques = np.split(replayed["friction_torque"], 3)
    assert not torques[0].any()
    for part, model, scale in ((1, crane2_model, 0.45), (2, load_model("a6vm215_crane1"), 0.9)):
        alone = FeedforwardCompensator(crane_150t, model, CompensatorConfig(scale=scale))
        np.testing.assert_allclose(
            torques[part], replay_compensator(run, alone)["friction_torque"], rtol=1e-5, atol=1e-3
        )


def test_a_log_too_slow_to_be_replayed_is_said_by_its_step(tmp_path, run, capsys):
    columns = {name: values[:20] for name, values in run.columns.items() if name != "wire_out"}
    columns["time"] = np.arange(20) * 20.0
    write_run(Run("slow", columns), tmp_path / "slow.csv")
    options = ["--crane", "crane_150t", "--model", "a6vm215_crane2", "--force"]
    assert main.run(["replay", str(tmp_path / "slow.csv"), *options]) == 2
    said = capsys.readouterr().err.splitlines()[-1]
    assert "slow.csv: column 'time': a sample every 20 s is too slow for a replay, which takes one every 4 s" in said
    assert "max_age" not in said


@pytest.mark.parametrize(
    "option",
    [["--pressure-reference", "absolute"], ["--joint", "winch"], ["--remap", "a=b"], ["--namespace", "winch_2"]],
)
def test_an_option_of_bags_is_not_ignored_with_a_run_file(option, tmp_path, capsys):
    """Absolute pressures of a CSV were taken for gauge all the same."""
    from winch_friction.cli.main import run

    path = tmp_path / "run.csv"
    path.write_text("time [s]\n0\n1\n")
    assert run(["replay", str(path), "--model", "a6vm215_crane2", *option]) == 2
    assert f"{option[0]}: of a bag's topics alone" in capsys.readouterr().err
