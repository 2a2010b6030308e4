"""The steps of a practice by themselves: what its folder names, which run goes where, and what is held against what."""

import hashlib
from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
import pytest
import yaml

from winch_friction.identification import practice
from winch_friction.identification.practice import SCHEMA, Practice, PracticeFolder, read_practice, run_practice
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import Run


# -- the folder
@pytest.fixture
def folder(tmp_path, monkeypatch, crane):
    """A practice of three kinds of runs; what is read is a run of the file's name."""
    (tmp_path / "table.csv").write_text("speed,pressure\n")
    for name in ("one", "two", "held", "sea"):
        (tmp_path / f"{name}.csv").write_text(name)
    (tmp_path / "bag").mkdir()

    def read_run(path, own, complete):
        if not path.exists():
            raise InputError(f"{path.name}: is not there")
        asked.append((path.name, own and own.name, complete))
        return Run(path.name, {"time": np.zeros(1)})

    def read_table(path, largest):
        asked.append((path.name, largest))
        return "the table"

    asked = []
    monkeypatch.setattr(practice, "read_run", read_run)
    monkeypatch.setattr(practice, "read_supplier_table", read_table)
    monkeypatch.setattr(practice, "run_as_main", lambda run, own: replace(run, metadata={"main of": own.name}))
    content = {
        "schema": SCHEMA, "name": "own", "crane": "crane_150t", "supplier_table": "table.csv",
        "tests": ["two.csv", "one.csv"], "held_out_tests": ["held.csv"], "ahc_tests": ["sea.csv", "bag"],
    }  # fmt: skip

    def write(**changed):
        asked.clear()
        known = {key: value for key, value in {**content, **changed}.items() if value is not None}
        (tmp_path / "practice.yaml").write_text(yaml.safe_dump(known))
        return tmp_path

    return SimpleNamespace(write=write, asked=asked)


def test_a_practice_is_what_its_file_names_each_run_in_its_place(folder, crane):
    read = read_practice(folder.write(note="n", motor_model="schlosser"))
    assert (read.name, read.note, read.motor_model, read.table) == ("own", "n", "schlosser", "the table")
    named = [[run.name for run in runs] for runs in (read.tests, read.held_out, read.ahc)]
    assert named == [["two.csv", "one.csv"], ["held.csv"], ["sea.csv", "bag"]]
    assert {run.metadata["main of"] for run in (*read.tests, *read.ahc)} == {"crane_150t"}
    assert read.crane.groups == crane.groups
    assert folder.asked[-1] == ("table.csv", crane.max_displacement)
    assert folder.asked[:2] == [("two.csv", "crane_150t", True), ("one.csv", "crane_150t", True)]
    files = ("table.csv", "one.csv", "two.csv", "held.csv", "sea.csv")  # a bag is a folder
    assert read.hashes["one.csv"] == hashlib.sha256(b"one").hexdigest()[:16]
    assert set(read.hashes) == set(files)


def test_a_practice_needs_no_more_than_its_tests_and_takes_mj4(folder):
    read = read_practice(folder.write(held_out_tests=None, ahc_tests=None))
    assert (read.motor_model, read.note, read.held_out, read.ahc) == ("mj4", "", (), ())


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        (
            {"schema": "winch_friction.practice/2"},
            "schema 'winch_friction.practice/2' is not 'winch_friction.practice/1'",
        ),
        ({"tests": []}, "tests must name at least one logged test"),
        ({"tests": None}, "tests must name at least one logged test"),
        ({"tests": "one.csv"}, "tests must be a list of file names"),
        ({"held_out_tests": [1]}, "held_out_tests must be a list of file names"),
        ({"ahc_tests": ["no.csv"], "held_out_tests": ["nor.csv"]}, "no.csv: is not there"),
        ({"colour": "red"}, "colour"),
        ({"crane": "crane_of_nobody"}, "crane_of_nobody"),
    ],
)
def test_what_is_wrong_with_a_practice_is_told(folder, changed, said):
    with pytest.raises(InputError) as caught:
        read_practice(folder.write(**changed))
    assert said in str(caught.value)
    if "ahc_tests" in changed:
        assert list(caught.value.problems) == ["nor.csv: is not there", "no.csv: is not there"]
    if "crane" in changed:
        assert ("one.csv", None, False) in folder.asked  # what can be read without one is looked at all the same
        assert ("table.csv", None) in folder.asked


# -- the steps
@dataclass(frozen=True)
class Fitted:
    """A test with its curve's load and displacement, as an identification gives it back."""

    run: Run
    curve: SimpleNamespace


def fitted(name, load, swept):
    return Fitted(Run(name, {"time": np.zeros(1)}), SimpleNamespace(load_torque=load, displacement=swept, name=name))


@pytest.fixture
def steps(monkeypatch):
    """Every step of a practice told instead of done."""
    asked = SimpleNamespace(read=[], usable=[], motor=None, seed=None, system=None, errors=[], checks=[], written=None)
    tests, held = (
        [fitted("light", 90.0, 1.0), fitted("heavy", 60.0, 2.0), fitted("other", 50.0, 2.0)],
        [fitted("h", 99.0, 9.0)],
    )
    joint = SimpleNamespace(model="third", sensor_errors={"displacement_scale": (0.02, 0.01), "other": (9.0, 9.0)})
    system = SimpleNamespace(tests=tests, held_out=held, first_loop="first", last_loop="second", joint=joint)

    def identify_system(runs, crane, model, spread, **more):
        asked.system = ([run.name for run in runs], crane, model, spread, more)
        return system

    def identify_motor(table, models, **more):
        asked.motor = (table, more)
        return SimpleNamespace(table="table inside")

    def check(run, crane, model, scale):
        asked.checks.append((run.name, model, scale))
        return f"{run.name} by {model}"

    for name, value in {
        "read_test": lambda run, crane: asked.read.append(run.name),
        "refuse_unusable": lambda run: asked.usable.append(run.name), "identify_motor": identify_motor,
        "motor_seed": lambda motor, name, provenance: asked.__setattr__("seed", (name, provenance)) or "the seed",
        "identify_system": identify_system, "load_unit_spread": lambda: "usual spread",
        "winch_seed": lambda system, crane, name, provenance: asked.__setattr__("written", (name, provenance)) or "w",
        "BlackBoxMap": lambda table: f"map of {table}", "pressure_check": check,
        "test_errors": lambda model, curves: asked.errors.append((model, [each.name for each in curves])) or model,
    }.items():  # fmt: skip
        monkeypatch.setattr(practice, name, value)
    runs = [
        tuple(Run(name, {"time": np.zeros(1)}) for name in group) for group in (("a", "b"), ("h",), ("sea", "swell"))
    ]
    own = PracticeFolder("own", "crane", "table", "mj4", *runs, {"f": "hash"}, "")
    asked.tests = tests
    return asked, own


def test_a_practice_goes_from_table_to_motor_to_winch_and_is_held_against_all_tests(steps):
    asked, folder = steps
    done = run_practice(folder, resamples=7, seed=3, complex_options={"restarts": 1})
    assert (asked.read, asked.usable) == (["a", "b", "h"], ["a", "b", "sea", "swell"])
    assert asked.motor[0] == "table"
    assert {k: asked.motor[1][k] for k in ("chosen", "seed", "complex_options", "force")} == {
        "chosen": "mj4", "seed": 3, "complex_options": {"restarts": 1}, "force": False,
    }  # fmt: skip
    assert asked.seed == ("own_motor", {"data_sha256": {"f": "hash"}})
    assert asked.written == ("own", {"data_sha256": {"f": "hash"}})
    assert asked.system[:4] == (["a", "b"], "crane", "the seed", "usual spread")
    assert {k: v for k, v in asked.system[4].items() if k != "held_out"} == {
        "resamples": 7, "seed": 3, "complex_options": {"restarts": 1}
    }  # fmt: skip
    assert [run.name for run in asked.system[4]["held_out"]] == ["h"]
    assert asked.errors == [(model, ["light", "heavy", "other", "h"]) for model in ("first", "second", "third")]
    assert (done.motor_seed, done.seed, done.map) == ("the seed", "w", "map of table inside")


def test_the_heaviest_fitted_test_and_every_one_in_a_sea_are_checked_with_what_the_joint_fit_found(steps):
    """By the pressure it takes times the displacement, which is the load; the held-out ones are not chosen from."""
    asked, folder = steps
    done = run_practice(folder, spread="own spread")
    assert asked.system[3] == "own spread"
    assert done.normal_mode == {
        "first loop": "heavy by first", "second loop": "heavy by second", "joint fit": "heavy by third"
    }  # fmt: skip
    assert done.ahc["joint fit"] == ["sea by third", "swell by third"]
    assert {(model, scale) for _, model, scale in asked.checks} == {("first", 0.0), ("second", 0.0), ("third", 0.02)}
    assert done.models == {"first loop": "first", "second loop": "second", "joint fit": "third"}
    assert list(done.models) == list(done.errors) == list(done.normal_mode) == list(done.ahc)
    assert isinstance(done, Practice)


def test_of_two_tests_of_one_load_the_later_name_is_checked(steps):
    asked, folder = steps
    asked.tests[2] = fitted("zz", 60.0, 2.0)
    assert run_practice(folder).normal_mode["first loop"] == "zz by first"
