"""Whose runs are they: the cranes that are looked at, and what is said of each, from made-up views."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.commissioning import other_cranes
from winch_friction.commissioning.other_cranes import claim, cranes_near, known_cranes, same_machine
from winch_friction.physics.errors import InputError
from winch_friction.physics.winch.crane import Drum
from winch_friction.records.crane_file import load_crane
from winch_friction.records.strict_yaml import config_directory

OURS = load_crane("crane_150t")
SIZE = OURS.max_displacement
THEIRS = replace(OURS, name="theirs", gear_ratio=0.7 * OURS.gear_ratio, max_displacement=0.6 * SIZE)


def view(*largest, lacks=()):
    """A run whose motor groups swivel this far, seen by cranes that have what it logs."""

    def on(crane):
        if crane.name in lacks:
            raise InputError("no such group")

    groups = {
        str(k): SimpleNamespace(displacement=np.array([0.1 * each, np.nan, each])) for k, each in enumerate(largest)
    }
    return SimpleNamespace(groups=groups, on=on)


@pytest.mark.parametrize(
    ("swivelled", "said"),
    [
        (0.6, "theirs"), (0.6 * 1.029, "theirs"), (0.6 * 0.971, "theirs"), (-0.6, "theirs"),
        (0.6 * 0.969, "unsure"), (0.3, "unsure"), (0.6 * 1.031, ""),  # beyond what theirs go
        (1.0, ""), (0.98, ""), (0.0, "unsure"),
    ],
)  # fmt: skip
def test_motors_that_were_fully_swivelled_tell_whose_they_are(swivelled, said):
    found = claim([view(0.1 * SIZE), view(0.2 * SIZE, swivelled * SIZE)], OURS, "theirs", THEIRS)
    if said == "theirs":
        assert found == "these are runs of crane 'theirs', not of 'crane_150t'"
    elif said == "unsure":
        assert found.startswith("gear, drum and number of motors of crane 'theirs' fit, those of 'crane_150t' do not")
    else:
        assert found == ""


def test_motors_of_the_crane_files_own_size_are_its_own():
    """Fully swivelled, and the other crane's motors would go as far."""
    larger = replace(THEIRS, max_displacement=2.0 * SIZE)
    assert claim([view(SIZE)], OURS, "theirs", larger) == ""
    assert claim([view(0.5 * SIZE)], OURS, "theirs", larger).startswith("gear, drum")


def test_a_crane_that_cannot_have_logged_it_claims_nothing():
    assert claim([view(0.6 * SIZE), view(0.6 * SIZE, lacks=("theirs",))], OURS, "theirs", THEIRS) == ""
    assert claim([view(0.6 * SIZE)], OURS, "theirs", OURS) == ""
    electric = SimpleNamespace(drive=SimpleNamespace(kind="electric"), name="theirs")
    assert claim([view(0.6 * SIZE)], OURS, "theirs", electric) == ""
    assert "differs from the shipped 'crane_150t', whose figures fit" in claim(
        [view(0.3 * SIZE)], OURS, "crane_150t", THEIRS
    )


def test_of_motors_without_a_swivel_nothing_tells_them_apart():
    kind = SimpleNamespace(kind="electric", hydraulic=False)
    own, other = (SimpleNamespace(name=name, drive=kind, max_displacement=0.0) for name in ("ours", "theirs"))
    assert claim([view()], own, "theirs", other) == "these are runs of crane 'theirs', not of 'ours'"


@pytest.mark.parametrize(
    "change",
    [{"gear_ratio": 1.0}, {"drum": Drum((1.0, 1.1))}, {"max_displacement": 1e-5}, {"groups": {"main": 11}},
     {"drive": SimpleNamespace(kind="electric")}],
)  # fmt: skip
def test_cranes_are_one_machine_by_what_the_torque_goes_through(change):
    assert same_machine(OURS, replace(OURS, name="other", inertia=9.0))
    own = {name: getattr(OURS, name) for name in ("gear_ratio", "drum", "groups", "max_displacement", "drive")}
    other = SimpleNamespace(**{**own, **change})
    assert not same_machine(OURS, other)


def test_the_users_own_cranes_are_looked_at_beside_the_shipped_and_nothing_else(tmp_path, monkeypatch):
    shipped = known_cranes()
    assert "crane_150t" in shipped
    text = (config_directory() / "cranes" / "crane_150t.yaml").read_text()
    here, logs = tmp_path / "here", tmp_path / "logs"
    for folder, name in ((here, "mine"), (logs, "aside")):
        folder.mkdir()
        (folder / f"{name}.yaml").write_text(text.replace("name: crane_150t", f"name: {name}"))
    (logs / "broken.yaml").write_text("schema: winch_friction.crane/1\nname: broken\n")
    (logs / "a_plant.yaml").write_text("schema: winch_friction.plant/1\n")
    (logs / "a_list.yaml").write_text("- 1\n")
    (logs / "a.csv").write_text("")
    monkeypatch.chdir(here)
    found = cranes_near([(logs / "run.csv")])
    assert set(found) == {*shipped, "mine", "aside"}
    monkeypatch.chdir(logs)
    monkeypatch.setattr(other_cranes.Path, "cwd", lambda: here)
    (tmp_path / "run.csv").write_text("")
    assert set(cranes_near([other_cranes.Path("run.csv")])) == {*shipped, "mine", "aside"}  # beside it, wherever it is
    assert known_cranes(tmp_path / "none") == shipped
    read = []
    monkeypatch.setattr(other_cranes, "read_yaml", lambda path: read.append(path.name) or [])
    for k in range(45):
        (here / f"k{k:02d}.yaml").write_text("")
    list(other_cranes._cranes_in(here))
    assert len(read) == 40
    assert read == sorted(read)
