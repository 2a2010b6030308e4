"""What a replay of a recording takes from where, with voices that only say what they were given."""

from contextlib import contextmanager
from math import inf
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.physics.errors import InputError
from winch_friction.replay import recording
from winch_friction.replay.recording import _replayed, replay_recording, replay_run


class Steps(list):
    def __init__(self, kind, count):
        super().__init__(range(count))
        self.run = lambda name: f"{kind} of {name}"


def voice(kind, samples, lacked=(), refused=()):
    law = SimpleNamespace(model=lambda: f"{kind} model", parameters=lambda: [f"{kind} K1"], status=lambda: {kind: 1})
    return SimpleNamespace(
        steps=Steps(f"{kind} steps", samples), record=Steps(f"{kind} record", 3), watchdog=Steps(f"{kind} watchdog", 1),
        lacked=dict(lacked), refused=list(refused), service=SimpleNamespace(law=law),
    )  # fmt: skip


def test_a_replay_is_the_compensators_steps_and_what_the_estimator_learned():
    compensator = voice("c", 200, {"speed": 30, "load": 20}, ["too large", "too large", "other"])
    estimator = voice("e", 999, {"hook_load": 120})
    found = _replayed("log", compensator, estimator, ("first",))
    assert (found.compensator, found.estimator, found.watchdog) == (
        "c steps of log", "e record of log", "c watchdog of log",
    )  # fmt: skip
    assert (found.model, found.parameters, found.status, found.live) == ("e model", ("e K1",), {"e": 1}, ())
    assert found.warnings == (
        "first", "log: model refused: too large", "log: model refused: other",
        "log: the compensator lacked or doubted speed (15 % of the samples)",
        "log: the estimator lacked or doubted hook_load (60 % of the samples)",
    )  # fmt: skip


@pytest.fixture
def heard(monkeypatch):
    """The voices' making and all they were given, in its order."""
    said = []

    class Voice:
        def __init__(self, *given):
            said.append((self.kind, "made", *given))
            own = voice(self.kind, 100)
            self.steps, self.record, self.watchdog = own.steps, own.record, own.watchdog
            self.lacked, self.refused, self.service = own.lacked, own.refused, own.service

        def take_rows(self, run):
            return iter([None, "m1", None, "m2"] if self.kind == "e" else [None] * 4)

        def take(self, each, now):
            said.append((self.kind, "take", each.stamp, now))
            return f"learned {each.stamp}" if each.stamp > 11.0 else None

        def offer(self, model):
            said.append((self.kind, "offer", model))

        def offer_text(self, text, topic):
            said.append((self.kind, "text", text, topic))

    for name, kind in (("CompensatorVoice", "c"), ("EstimatorVoice", "e")):
        monkeypatch.setattr(recording, name, type(kind, (Voice,), {"kind": kind}))
    return said


@pytest.mark.parametrize("learn", [True, False])
def test_what_is_learned_of_a_run_is_offered_unless_it_shall_not_be(learn, heard):
    run = SimpleNamespace(name="r", time=np.array([7.0, 7.9, 8.2, 10.1]), groups=("main",), warnings=("w",))
    done = []
    found = replay_run(run, "crane", "seed", "settings", learn=learn, told=done.append)
    assert done == [1, 3]  # whole seconds from the first row on
    made = [each for each in heard if each[1] == "made"]
    assert [(kind, crane, seed, settings, begin) for kind, _, crane, seed, _, settings, begin in made] == [
        ("c", "crane", "seed", "settings", 7.0), ("e", "crane", "seed", "settings", 7.0),
    ]  # fmt: skip
    assert all(each[4].groups == ("main",) for each in made)
    assert [each[2] for each in heard if each[1] == "offer"] == (["m1", "m2"] if learn else [])
    assert found.warnings == ("w",)


def replayed_bag(
    monkeypatch,
    tmp_path,
    settings=None,
    learn=True,
    recorded=(),
    inputs=(10.0, 12.0),
    of_bag="of the bag",
    done=None,
):
    message = lambda stamp: SimpleNamespace(stamp=stamp, receipt=stamp + 0.5)

    class Bag:
        topics, warnings = "topics", ("of the bag",)
        no_speed = lambda self: "no speed"
        inputs = lambda self: iter([message(each) for each in inputs])
        topics_ending = lambda self, ending: list(recorded) if ending == "/friction_model" else []

        def events(self, *topics):
            assert topics == tuple(recorded)
            yield message(10.0)
            for topic in recorded:
                yield recording.Other(topic=topic, receipt=11.0, message=SimpleNamespace(data="text"))
            yield message(12.0)

    opened = []

    @contextmanager
    def open_bag(path, crane, **options):
        opened.append((path, crane, options))
        yield Bag()

    monkeypatch.setattr(recording, "open_bag", open_bag)
    monkeypatch.setattr(recording, "is_bag", lambda path: True)
    monkeypatch.setattr(recording, "bag_metadata", lambda path: ("metadata", ("spoilt",)))
    monkeypatch.setattr(recording, "settings_from_metadata", lambda metadata, where: of_bag)
    monkeypatch.setattr(recording, "ReplaySettings", lambda: "usual")
    compared = []
    monkeypatch.setattr(
        recording, "compare_live", lambda path, runs, **of: compared.append((path, runs, of)) or ["live"]
    )
    path = tmp_path / "bag"
    path.mkdir(exist_ok=True)
    found = replay_recording(
        path, "crane", "seed", settings, learn=learn, told=[].append if done is None else done.append, joint="j"
    )
    assert opened == [(path, "crane", {"joint": "j"})]
    assert compared == [(path, {"compensator": "c steps of bag", "estimator": "e record of bag",
                                "watchdog": "c watchdog of bag"}, {"crane": "crane", "joint": "j"})]  # fmt: skip
    return found


@pytest.mark.parametrize(
    ("given", "of_bag", "used"),
    [("given", "of the bag", "given"), (None, "of the bag", "of the bag"), (None, None, "usual")],
)
def test_settings_are_the_given_else_the_recordings_else_the_usual(given, of_bag, used, heard, monkeypatch, tmp_path):
    replayed_bag(monkeypatch, tmp_path, given, of_bag=of_bag)
    assert [each[2:] for each in heard if each[1] == "made"] == [("crane", "seed", "topics", used, 10.0)] * 2


def test_a_bag_is_replayed_from_its_first_input_by_both_and_compared(heard, monkeypatch, tmp_path):
    done = []
    found = replayed_bag(monkeypatch, tmp_path, done=done)
    assert done == [2]
    taken = [each for each in heard if each[1] == "take"]
    assert [each[:3] for each in taken] == [("c", "take", 10.0), ("e", "take", 10.0), ("c", "take", 12.0),
                                            ("e", "take", 12.0)]  # fmt: skip
    assert all(one[3] == other[3] for one, other in zip(taken[::2], taken[1::2], strict=True))
    assert heard[-1] == ("c", "offer", "learned 12.0")
    assert (found.live, found.warnings) == (("live",), ("spoilt", "of the bag"))
    heard.clear()
    replayed_bag(monkeypatch, tmp_path, inputs=(), done=done)
    assert (heard[0][-1], done) == (-inf, [2])


@pytest.mark.parametrize(
    ("learn", "recorded"), [(False, ()), (True, ("/e/friction_model",)), (False, ("/e/friction_model",))]
)
def test_models_that_were_recorded_are_taken_and_no_others(learn, recorded, heard, monkeypatch, tmp_path):
    replayed_bag(monkeypatch, tmp_path, learn=learn, recorded=recorded)
    assert not [each for each in heard if each[1] == "offer"]
    assert [each for each in heard if each[1] == "text"] == [("c", "text", "text", topic) for topic in recorded]


def test_a_file_is_read_by_its_crane_with_the_given_or_the_usual_settings(monkeypatch, tmp_path):
    path = tmp_path / "r.csv"
    path.write_text("")
    monkeypatch.setattr(recording, "read_run", lambda path, crane: (Path(path).name, crane))
    monkeypatch.setattr(recording, "ReplaySettings", lambda: "usual")
    monkeypatch.setattr(recording, "replay_run", lambda *given, **named: (given, named))
    for given, used in ((None, "usual"), ("given", "given")):
        assert replay_recording(path, "crane", "seed", given, learn=False, told=print) == (
            (("r.csv", "crane"), "crane", "seed", used), {"learn": False, "told": print},
        )  # fmt: skip
    with pytest.raises(InputError, match=r"none.csv: no such file or folder"):
        replay_recording(tmp_path / "none.csv", "crane", "seed")
