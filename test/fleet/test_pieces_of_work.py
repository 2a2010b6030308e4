"""Pieces of a fleet's work: what belongs together, what makes it other work, how a verb is called, what is kept."""

import pytest

from winch_friction.cli import fleet_work, main
from winch_friction.cli.fleet_work import _message, _parsed, carry_out, dated_rows, own_folders, plan
from winch_friction.fleet.ledger import Outcome
from winch_friction.fleet.recordings import Recording
from winch_friction.physics.errors import InputError


def recording(crane, name, version=1):
    return Recording(f"logs/{crane}/{name}.csv", crane, name, ((f"{name}.csv", 10),), version)


TWO = [recording("north", "a"), recording("south", "b"), recording("north", "c")]


@pytest.mark.parametrize(("verb", "named", "targets"), [
    ("replay", ["logs/north/a.csv", "logs/south/b.csv", "logs/north/c.csv"],
     ["replay/north/a.parquet", "replay/south/b.parquet", "replay/north/c.parquet"]),
    ("check", ["logs/north/a.csv", "logs/south/b.csv", "logs/north/c.csv"], ["check/north/a", "check/south/b",
     "check/north/c"]),
    ("gap", ["north (2 recordings)", "south (1 recordings)"], ["gap/north", "gap/south"]),
    ("identify", ["north (2 recordings)", "south (1 recordings)"], ["identify/north.yaml", "identify/south.yaml"]),
])  # fmt: skip
def test_each_recording_or_each_crane_is_a_piece_of_work_with_a_place_of_its_own(verb, named, targets, tmp_path):
    tasks = plan(verb, TWO, tmp_path, "cranes/{crane}.yaml", "{crane}_seed.yaml", ["--x"], {"b": 2, "a": 1})
    assert [task.name for task in tasks] == named
    assert [task.target for task in tasks] == [str(tmp_path / each) for each in targets]
    for task in tasks:
        assert task.crane_file == f"cranes/{task.crane}.yaml"
        assert task.model_file == f"{task.crane}_seed.yaml"
        assert {each.crane for each in task.recordings} == {task.crane}
        assert (task.options, task.storage) == (("--x",), (("a", 1), ("b", 2)))
    assert len({task.key for task in tasks}) == len(tasks)


def test_a_verb_that_fleets_do_not_know_is_refused(tmp_path):
    with pytest.raises(InputError, match="fleet knows the verbs replay, check, gap, identify, not 'plot'"):
        plan("plot", TWO, tmp_path, "c", "m", [], {})


def test_anything_that_makes_another_result_is_other_work_and_the_storage_is_not(tmp_path):
    of = lambda verb="gap", recordings=TWO, out=tmp_path, crane="c", model="m", options=(), storage=None: (
        plan(verb, recordings, out, crane, model, options, storage or {})[0].key
    )
    others = [of(verb="check"), of(recordings=TWO[:2]), of(out=tmp_path / "other"), of(crane="d"), of(model="n"),
              of(options=["--x"]), of(recordings=[recording("north", "a", 2), *TWO[1:]])]  # fmt: skip
    assert len({of(), *others}) == 1 + len(others)
    assert of(storage={"key": "secret"}) == of()


def test_a_fleets_own_results_are_known_where_a_ledger_lies(tmp_path):
    assert own_folders(tmp_path) == []
    (tmp_path / "fleet.jsonl").write_text("")
    assert {each.name for each in own_folders(tmp_path)} == {"replay", "check", "gap", "identify", "store"}


@pytest.mark.parametrize(("verb", "words"), [
    ("replay", ["replay", "P", "--crane", "c", "--model", "m", "--x", "--out", "T", "--overwrite", "--json"]),
    ("check", ["check", "P", "--crane", "c", "--model", "m", "--x", "--out", "T", "--json"]),
    ("identify", ["identify", "system", "P", "--crane", "c", "--motor", "m", "--x", "--out", "T", "--overwrite",
                  "--json"]),
])  # fmt: skip
def test_a_verb_is_called_as_from_the_command_line(verb, words, tmp_path, monkeypatch):
    called = []

    def run(arguments):
        called.append(arguments)
        print('{"plausible": true}')
        return 0

    monkeypatch.setattr(main, "run", run)
    monkeypatch.setattr(fleet_work, "_traits", lambda task, paths: ["trait"])
    (task,) = plan(verb, TWO[1:2], tmp_path, "c", "m", ["--x"], {})
    done = carry_out(task)
    names = {"P": TWO[1].address, "T": task.target}
    assert called == [[names.get(word, word) for word in words]]
    assert (done.key, done.crane, done.recording, done.status, done.message) == (task.key, "south", task.name, 0, "")
    assert done.result == {"verb": {"plausible": True}, "traits": ["trait"]}


@pytest.mark.parametrize(("raised", "status", "said"), [
    (InputError("no column"), 2, "no column"), (KeyError("x"), 1, "KeyError: 'x'"), (None, 2, "last words"),
])  # fmt: skip
def test_what_goes_wrong_is_the_outcome_of_one_piece_of_work(raised, status, said, tmp_path, monkeypatch):
    import sys

    def run(arguments):
        if raised is not None:
            raise raised
        print("first\nlast words\n", file=sys.stderr)
        return 2

    monkeypatch.setattr(main, "run", run)
    (task,) = plan("check", TWO[:1], tmp_path, "c", "m", [], {})
    done = carry_out(task)
    assert (done.status, done.message, done.result) == (status, said, {"verb": None, "traits": []})


def test_a_verbs_own_sentence_goes_before_its_last_words():
    assert _message({"sentence": "not this crane's"}, "a\nb") == "not this crane's"
    assert _message({"sentence": ""}, "a\n\nb\n  \n") == "b"
    assert _message("text", "") == "no message"
    assert (_parsed('{"a": 1}'), _parsed(" text\n")) == ({"a": 1}, "text")


def test_rows_of_the_store_are_of_what_worked_and_has_a_date():
    trait = {"recording": "a", "time": 1.7e9, "name": "friction", "value": 1.0, "std": 0.1, "unit": "%"}
    old = {**trait, "time": 12.0}
    learned = {"parameter": "C3", "learned": 2.0, "sigma": 0.5, "unit": "N*m", "seed": 9.0, "status": "learned"}
    given = lambda traits, parameters: {"traits": traits, "verb": {"parameters": list(parameters)}}
    of = lambda status, traits, *parameters: Outcome("k", "north", "a.csv", status, 1.0, given(traits, parameters), "")
    assert dated_rows([of(0, [trait], learned, {**learned, "learned": None})]) == [
        {"crane": "north", "kind": "trait", **trait},
        {"crane": "north", "kind": "learned", "recording": "a", "time": 1.7e9, "name": "C3", "value": 2.0, "std": 0.5,
         "unit": "N*m"},
    ]  # fmt: skip
    assert dated_rows([of(2, [trait], learned), of(0, [old], learned), of(0, [], learned)]) == []


def test_what_failed_is_done_again_and_what_worked_is_not(tmp_path, monkeypatch):
    from winch_friction.cli import fleet as verb
    from winch_friction.fleet.ledger import Ledger

    tasks, called, statuses = plan("check", TWO, tmp_path, "c", "m", [], {}), [], {"logs/south/b.csv": 2}

    def work(task):
        called.append(task.name)
        return Outcome(task.key, task.crane, task.name, statuses.get(task.name, 0), 0.1, {}, "")

    monkeypatch.setattr(verb, "carry_out", work)
    calls = []
    for anew in (False, False, True):
        called.clear()
        outcomes = verb._done(tasks, Ledger(tmp_path / "fleet.jsonl"), 0, "", anew)
        assert [each.recording for each in outcomes] == ["logs/north/a.csv", "logs/north/c.csv", "logs/south/b.csv"]
        calls.append(sorted(called))
    every = sorted(task.name for task in tasks)
    assert calls == [every, ["logs/south/b.csv"], every]
