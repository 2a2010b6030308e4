"""The demo's stage: in which order the nodes are led through the phases, and what is said of it."""

import json
from types import SimpleNamespace
from typing import Any

import pytest

pytest.importorskip("rclpy", reason="needs rclpy: pip install '.[ros]'")

from winch_friction.nodes import stage as of_nodes
from winch_friction.nodes.stage import SPEAKERS, Stage
from winch_friction.physics.errors import InputError

PHASES = [
    {"name": "without", "parameters": {"scale": 0.0}, "enabled": False},
    {"name": "seed", "parameters": {"scale": 1.0}, "enabled": True},
    {"name": "learned", "parameters": {"scale": 0.9}, "enabled": True},
]


class Remote:
    """A node that notes what it is asked for."""

    def __init__(self, name: str, calls: list[tuple[Any, ...]], state: str = "unconfigured") -> None:
        self.name, self.calls, self.now = name, calls, state

    def state(self) -> str:
        return self.now

    def change(self, *transitions: str) -> None:
        self.calls.append((self.name, *transitions))
        after = {"configure": "inactive", "activate": "active", "deactivate": "inactive", "cleanup": "unconfigured"}
        self.now = after[transitions[-1]]

    def __getattr__(self, what: str) -> Any:
        return lambda *arguments: self.calls.append((self.name, what, *arguments))


@pytest.fixture
def played(monkeypatch: pytest.MonkeyPatch) -> Any:
    """A stage of fakes whose clock goes on by a tenth of a second with each turn, each phase by `steps` of progress."""
    now, calls, stage = [0.0], [], object.__new__(Stage)
    monkeypatch.setattr(of_nodes, "time", SimpleNamespace(monotonic=lambda: now[0], sleep=lambda _: None))
    stage._compensator, stage._estimator, stage._simulator = (
        Remote(name, calls) for name in ("compensator", "estimator", "simulator")
    )
    stage._phases, stage._progress = PHASES, 0.0
    stage.steps = steps = []
    left: list[float] = []

    def collect() -> None:
        now[0] += 0.1
        if stage.under_way and not left:
            left.extend(steps)
        if stage.under_way:
            stage._progress = left.pop(0)

    counts, taken = {"winch/load": 7}, {"winch/load": 9}
    stage.recorder = SimpleNamespace(
        collect=collect, finish=lambda: calls.append(("recorder", "finish", round(now[0], 1))),
        hears=lambda *topics: topics == SPEAKERS, counts=counts, taken=taken,
    )  # fmt: skip
    stage._executor = SimpleNamespace(spin_once=lambda timeout_sec: None)
    stage.under_way, watch = False, stage._watch

    def watched(name: str) -> None:
        stage.begun.append(stage._progress)
        stage.under_way = True
        watch(name)
        stage.under_way = False

    stage.begun = []
    stage._watch, stage.calls, stage.now = watched, calls, now
    return stage


def test_each_phase_has_a_fresh_compensator_on_the_same_sea(played: Any, capsys: pytest.CaptureFixture[str]) -> None:
    played.steps[:] = [0.004, 0.009, 0.01, 0.5, 0.505, 0.999, 1.0]
    played.play()
    fresh = [("compensator", "deactivate"), ("compensator", "cleanup")]
    begun = [
        [("compensator", "set", each["parameters"]), ("compensator", "configure", "activate"),
         ("compensator", "switch", "enable", each["enabled"])]
        for each in PHASES
    ]  # fmt: skip
    assert played.calls == [
        ("simulator", "configure"), *begun[0], ("simulator", "activate"), *fresh, *begun[1],
        ("simulator", "trigger", "reset"), *fresh, *begun[2], ("simulator", "trigger", "reset"),
        ("recorder", "finish", pytest.approx(3 * 0.7 + 1.0, abs=0.11)), ("estimator", "deactivate"),
    ]  # fmt: skip
    assert played.begun == [0.0, 0.0, 0.0]  # what the phase before had reached is none of this one's
    said = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert said[0] == {"event": "waiting", "nodes": ["compensator", "estimator", "simulator"]}
    assert [each["name"] for each in said if each["event"] == "phase"] == ["without", "seed", "learned"]
    progress = [(each["name"], each["value"]) for each in said if each["event"] == "progress"]
    assert progress == [(each["name"], value) for each in PHASES for value in (0.01, 0.5, 0.999)]
    assert said[-1] == {"event": "recorded", "messages": {"winch/load": 7}}


@pytest.mark.parametrize(
    ("state", "changes"), [("active", ["deactivate", "cleanup"]), ("inactive", ["cleanup"]), ("unconfigured", [])]
)
def test_a_compensator_in_any_state_is_configured_anew(played: Any, state: str, changes: list[str]) -> None:
    played._compensator.now = state
    played._prepare(PHASES[1])
    assert [call[1] for call in played.calls] == [*changes, "set", "configure", "switch"]


def test_who_is_never_heard_is_waited_for_and_then_said(played: Any) -> None:
    played.recorder.hears = lambda *topics: played.now[0] > 10.0
    played._wait_until_heard()
    played.recorder.hears = lambda *topics: False
    began = played.now[0]
    with pytest.raises(InputError, match=r"not heard within 60 s: one of compensator/friction_torque, estimator/"):
        played._wait_until_heard()
    assert played.now[0] - began == pytest.approx(60.0, abs=0.3)
