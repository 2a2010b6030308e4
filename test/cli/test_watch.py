"""Watch on a bag."""

import io
import json

import pytest

import winch_friction as wf
from winch_friction.cli.main import run
from winch_friction.cli.watch import DISCOVERY, counted
from winch_friction.physics.errors import InputError


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


@pytest.mark.parametrize(("heard", "said"), [(0, ""), (2, "no samples yet")])
def test_an_error_begins_a_line_of_its_own(heard, said, monkeypatch, capsys):
    """It stood on the line of the last frame, and a bad namespace only after "nothing heard yet"."""

    def frames(*_):
        yield from [{"time": None, "status": {"w/estimator: clock": status_of()}, "points": {}, "notes": []}] * heard
        raise InputError("the namespace is none")

    monkeypatch.setattr("winch_friction.cli.live.frames", frames)
    assert run(["watch"]) == 2
    told = capsys.readouterr()
    assert told.err == "winch-friction: the namespace is none\n"
    assert told.out == "" or told.out.endswith("\n")
    assert said in told.out
    assert (told.out == "") is (heard == 0)


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


def rendered(frame, latest, capsys):
    from rich.console import Console

    from winch_friction.cli.watch import view

    console = Console(width=200, record=True, file=io.StringIO(), force_terminal=True, color_system="standard")
    console.print(view(frame, latest))
    text = console.export_text(clear=False)
    return (
        text,
        console.export_text(styles=True),
        [[cell.strip() for cell in line.split("│") if cell.strip()] for line in text.splitlines() if "│" in line],
    )


def status_of(**values):
    return {
        "level": 0,
        "message": "",
        "hardware": "",
        "values": {k.replace("_", " "): str(v) for k, v in values.items()},
    }


def test_a_frame_shows_each_figure_under_its_own_head(capsys):
    status = {
        "w/estimator: parameters": status_of(K1=2.0, K1_std=0.123, K1_status="learned"),
        "w/estimator: inputs": status_of(winch_rate=40.0, winch_age=0.25),
    }
    frame = {"time": 12.34, "status": status, "points": {}, "notes": [("joint", "[odd] name")]}
    text, _, rows = rendered(frame, {"speed": 123.456, "error": -1.5}, capsys)
    assert "time 12.3 s" in text
    assert "no fault" in text
    assert ["motor speed [rpm]", "123.5"] in rows
    assert ["position error of the load [mm]", "-1.5"] in rows
    assert ["joint", "[odd] name"] in rows
    (estimate,) = [row for row in rows if row[0].endswith("K1")]
    assert estimate[-3:] == ["2", "0.12", "learned"]
    (found,) = [row for row in rows if row[0].endswith("winch")]
    assert found[-2:] == ["40.0", "0.250"]
    heads = [line.split() for line in text.splitlines() if "┃" in line]
    assert ["┃", "input", "┃", "rate", "[Hz]", "┃", "age", "[s]", "┃"] in heads
    assert ["┃", "parameter", "┃", "value", "┃", "sigma", "┃", "status", "┃"] in heads


def test_a_fault_is_red_and_what_is_not_there_yet_is_said(capsys):
    lost = {"w/compensator: inputs": {**status_of(winch_rate=1.0), "level": 2, "message": "lost [x]"}}
    text, styled, _ = rendered({"time": None, "status": lost, "points": {}}, {}, capsys)
    assert "no samples yet" in text
    assert "lost [x]" in text
    assert "no fault" not in text
    assert "\x1b[1;31m" in styled
    assert "now: nothing yet" in text
    assert "estimates, SI: nothing yet" in text
    said, _, _ = rendered({"time": None, "status": {}, "points": {}}, {}, capsys)
    assert said.startswith("nothing heard yet: are the nodes running")


def test_the_verb_asks_for_what_it_was_given_and_shows_the_latest_point(monkeypatch, capsys):
    from winch_friction.cli import live, watch

    asked, shown = [], []
    frames = [{"time": float(k), "status": {}, "points": {"speed": [[k, 1.0 + k], [k, 5.0 + k]]}} for k in range(9)]
    monkeypatch.setattr(live, "frames", lambda *given: asked.append(given) or iter(frames))
    monkeypatch.setattr(watch, "view", lambda frame, latest: shown.append((frame["time"], dict(latest))) or "")
    watch.command(None, "w", "j", 3.0, 2, False)
    assert asked == [(None, "w", 3.0, "j")]
    assert shown == [(0.0, {"speed": 5.0}), (1.0, {"speed": 6.0})]
    watch.command(None, "w", "j", 3.0, 0, True)
    assert [json.loads(line)["time"] for line in capsys.readouterr().out.splitlines() if line.startswith("{")] == [
        float(k) for k in range(9)
    ]
