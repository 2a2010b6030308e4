"""Watch on a bag."""

import json

import pytest

import winch_friction as wf
from winch_friction.cli.main import run
from winch_friction.cli.watch import DISCOVERY, counted


@pytest.fixture(scope="module")
def bag(tmp_path_factory):
    crane, model = wf.load_crane("crane_150t"), wf.load_model("a6vm215_crane2")
    log = wf.simulate("ahc_55t_215", crane, model, duration=6.0).run
    return wf.write_run(log, tmp_path_factory.mktemp("bags") / "sea")


def test_a_bag_is_watched_as_tables_and_as_json(bag, capsys):
    assert run(["watch", "--bag", str(bag), "--rate", "0"]) == 0
    assert "motor speed" in capsys.readouterr().out
    assert run(["watch", "--bag", str(bag), "--rate", "0", "--json"]) == 0
    frames = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert sum(len(frame["points"].get("speed", [])) for frame in frames) == pytest.approx(
        100, abs=5
    )  # 50 Hz thinned to every third


def test_a_joint_that_is_not_there_is_said(bag, capsys):
    assert run(["watch", "--bag", str(bag), "--rate", "0", "--joint", "moon"]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "no joint 'moon'" in said
    assert "motor speed" not in said


@pytest.mark.parametrize("name", ["nothing", "pyproject.toml"])
def test_what_is_no_bag_is_one_line(name, capsys):
    assert run(["watch", "--bag", name]) == 2
    assert capsys.readouterr().err.count("\n") == 1


@pytest.mark.parametrize(("silent", "first"), [(0, 0), (3, 3), (DISCOVERY + 9, DISCOVERY)])
def test_frames_count_from_the_first_word_of_a_node_or_once_nodes_should_have_been_found(silent, first):
    """Two frames were over before the nodes were found: they were said not to run."""
    status = [{}] * silent + [{"compensator: feedforward": {}}] * 9
    found = counted(({"time": None, "status": each, "number": k} for k, each in enumerate(status)), 2)
    assert [each["number"] for each in found] == [first, first + 1]
