"""`winch-friction load`: a model file into a running compensator, from the command line alone."""

import json
import os
import subprocess
import sys
from pathlib import Path

from dds_bench import Bench

import winch_friction as wf


def load(bench: Bench, *arguments: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "ROS_DOMAIN_ID": str(bench.domain)}
    command = [sys.executable, "-m", "winch_friction", "load", *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False, env=environment, timeout=60)


def test_a_model_is_handed_over_and_a_wrong_one_changes_nothing(bench: Bench, tmp_path: Path) -> None:
    bench.start("compensator")
    model = wf.load_model("a6vm215_crane2")
    mine = wf.save_model(model.with_values({"C3": 1.2 * model.value("C3")}), tmp_path / "mine.yaml")
    done = load(bench, str(mine), "--json")
    assert (done.returncode, done.stderr) == (0, "")
    assert "in use" in json.loads(done.stdout)["said"]
    node = bench.remote("compensator")
    assert node.get("model_file").string_value == str(mine)
    other = load(bench, "emps_viscous")
    assert other.returncode == 2
    assert "compensator" in other.stderr
    assert node.get("model_file").string_value == str(mine)


def test_a_file_that_is_no_model_is_said_before_any_node_is_asked(bench: Bench, tmp_path: Path) -> None:
    (tmp_path / "no.yaml").write_text("schema: something else\n")
    done = load(bench, str(tmp_path / "no.yaml"))
    assert done.returncode == 2
    assert "no.yaml" in done.stderr


def test_nobody_there_is_said(bench: Bench) -> None:
    done = load(bench, "a6vm215_crane2")
    assert done.returncode == 2
    assert "did it start?" in done.stderr


def test_a_namespace_that_there_cannot_be_is_said(bench: Bench) -> None:
    done = load(bench, "a6vm215_crane2", "--namespace", "crane 1")
    assert done.returncode == 2
    assert "namespace must not contain" in done.stderr
    assert "'/crane 1'" in done.stderr
