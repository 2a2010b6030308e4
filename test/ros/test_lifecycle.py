"""Lifecycle, autostart, parameters and the end of a process."""

import subprocess
import sys
from pathlib import Path

import pytest
import yaml
from dds_bench import Bench

from winch_friction.nodes.remote import RemoteNode
from winch_friction.physics.errors import InputError


def test_transitions_gate_the_output(bench: Bench) -> None:
    bench.start("compensator", autostart=False)
    node, torque = bench.remote("compensator"), bench.listen("compensator/friction_torque")
    assert node.state() == "unconfigured"
    node.change("configure")
    assert node.state() == "inactive"
    bench.drive(0.3)
    assert torque == []
    node.change("activate")
    bench.announce()
    sent = bench.drive(0.5)
    heard = len(torque)
    assert heard >= 0.8 * len(sent)
    node.change("deactivate")
    bench.spin(0.3)
    heard = len(torque)
    bench.drive(0.4)
    assert len(torque) == heard
    node.change("cleanup", "configure", "activate")
    bench.announce()
    bench.drive(0.3)
    assert len(torque) > heard
    assert bench.stop("compensator") == 0


def test_what_was_switched_off_stays_so_over_a_new_configuration(bench: Bench) -> None:
    bench.start("compensator")
    node, torque = bench.remote("compensator"), bench.listen("compensator/friction_torque")
    node.switch("enable", False)
    node.change("deactivate", "cleanup", "configure", "activate")
    bench.announce()
    torque.clear()
    bench.drive(0.8)
    assert len(torque) > 10
    assert all(message.effort[0] == 0.0 for message in torque)
    node.switch("enable", True)
    bench.drive(0.8)
    assert abs(torque[-1].effort[0]) > 0.0


def test_a_bad_model_leaves_the_node_unconfigured(bench: Bench) -> None:
    bench.start("compensator", autostart=False, model_file="no_such_model")
    node = bench.remote("compensator")
    with pytest.raises(InputError, match="refused to configure"):
        node.change("configure")
    assert node.state() == "unconfigured"
    assert bench.says("compensator", "'no_such_model' is neither a file nor a shipped name")
    node.set({"model_file": "a6vm215_crane1"})
    node.change("configure")
    assert node.state() == "inactive"
    assert bench.says("compensator", "crane 'crane_150t' (hydraulic), model 'a6vm215_crane1', groups active, passive")


def test_parameters_are_refused_with_a_reason_and_without_effect(bench: Bench) -> None:
    bench.start("compensator")
    node: RemoteNode = bench.remote("compensator")
    with pytest.raises(InputError, match="out of range"):
        node.set({"scale": 3.0})
    with pytest.raises(InputError, match="cycle at reversal"):
        node.set({"drive": "torque"}) or node.set({"velocity_source": "measured"})
    with pytest.raises(InputError, match=r"read.only"):
        node.set({"groups": ["main"]})
    with pytest.raises(InputError, match=r"read.only"):
        node.set({"pressure_group": "passive"})  # the pressure would jump by the ratio of the displacements
    with pytest.raises(InputError, match=r"read.only"):
        node.set({"min_displacement": 0.5})
    node.set({"scale": 0.5})
    assert node.get("scale").double_value == 0.5
    assert node.get("velocity_source").string_value == "reference"


@pytest.mark.parametrize(
    ("executable", "override", "said"),
    [
        ("compensator", "scale:=7.0", "scale"),
        ("compensator", "scale:=much", "scale"),
        ("compensator", "pressure_group:=activ", "must be one of active, passive, found 'activ'"),
        ("compensator", "qos_overrides./winch/joint_states.subscription.reliability:=maybe", "reliable, best_effort"),
        ("estimator", "crane:=no_such_crane", "no_such_crane"),
        ("simulator", "scenario:=no_such_sea", "no_such_sea"),
        ("estimator", "terms_file:=no_such_terms.py", "no_such_terms.py"),
        ("estimator", "pressure_reference:=relative", "gauge, absolute"),
    ],
)
def test_bad_parameters_are_one_line_and_status_2(executable: str, override: str, said: str) -> None:
    command = [sys.executable, "-m", f"winch_friction.nodes.{executable}", "--ros-args", "-p", override]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=60.0)
    assert ended.returncode == 2
    lines = [line for line in ended.stderr.splitlines() if "error" in line.lower()]
    assert len(lines) == 1
    assert said in lines[0]
    assert "Traceback" not in ended.stderr


@pytest.mark.parametrize(
    ("executable", "overrides", "said"),
    [
        (
            "compensator",
            {"scale": "7.0", "max_age": "'soon'", "velocity_source": "referenc", "pressure_reference": "3"},
            {
                "parameter 'scale' must be 0 ... 1.3, found 7.0",
                "parameter 'max_age' must be a number 0.001 ... 0.5 s, found 'soon'",
                "parameter 'pressure_reference' must be a text, found 3",
                "parameter 'velocity_source' must be one of reference, measured, found 'referenc'",
            },
        ),
        ("compensator", {"scale": "3"}, {"parameter 'scale' must be a number 0 ... 1.3, found 3"}),
        ("compensator", {"scale": "1"}, {"parameter 'scale' must be a number 0 ... 1.3, found 1: write 1.0"}),
        (
            "estimator",
            {"crane": "crane_150", "model_file": "a6vm215_crane22"},
            {"mean crane_150t", "mean a6vm215_crane2"},
        ),
    ],
)
def test_all_bad_parameters_are_said_at_once(executable: str, overrides: dict[str, str], said: set[str]) -> None:
    command = [sys.executable, "-m", f"winch_friction.nodes.{executable}", "--ros-args"]
    for name, value in overrides.items():
        command += ["-p", f"{name}:={value}"]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=60.0)
    assert ended.returncode == 2
    lines = [line for line in ended.stderr.splitlines() if "error" in line.lower()]
    assert len(lines) == len(said)
    assert all(any(words in line for line in lines) for words in said), lines
    assert "write 3.0" not in ended.stderr  # is out of range as well


def test_a_misspelt_parameter_is_said_and_quality_of_service_can_be_overridden(bench: Bench, tmp_path: Path) -> None:
    file = tmp_path / "parameters.yaml"
    overrides = {"/winch/joint_states": {"subscription": {"reliability": "reliable"}}}
    parameters = {"scal": 0.8, "qos_overrides": overrides}
    file.write_text(yaml.safe_dump({"/**/compensator": {"ros__parameters": parameters}}))
    bench.start("compensator", "--params-file", str(file))
    bench.announce()
    assert bench.says("compensator", "parameter 'scal' is not known and has no effect; did you mean scale?")
    (subscription,) = bench.node.get_subscriptions_info_by_topic("/winch/joint_states")
    assert subscription.qos_profile.reliability.name == "RELIABLE"


def test_a_file_that_is_no_checkpoint_is_not_written_over(bench: Bench, tmp_path: Path) -> None:
    given = tmp_path / "notes.yaml"
    given.write_text("crane: north\n")
    bench.start("estimator", checkpoint=given)
    assert bench.remote("estimator").state() == "active"
    assert bench.stop("estimator") == 0
    kept = tmp_path / "notes.yaml.refused"
    assert kept.read_text() == "crane: north\n"
    assert bench.says("estimator", f"starts from the seed: {given}: not a checkpoint")
    assert bench.says("estimator", f"the file is kept as {kept}")


def test_a_model_given_as_the_checkpoint_is_refused(tmp_path: Path) -> None:
    given = tmp_path / "my_model.yaml"
    given.write_text("schema: winch_friction.model/1\n")
    command = [sys.executable, "-m", "winch_friction.nodes.estimator", "--ros-args", "-p", f"checkpoint:={given}"]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=60.0)
    assert ended.returncode == 2
    (line,) = [line for line in ended.stderr.splitlines() if "error" in line.lower()]
    assert f"{given}: a file of schema 'winch_friction.model/1', not a checkpoint" in line
    assert given.read_text() == "schema: winch_friction.model/1\n"
