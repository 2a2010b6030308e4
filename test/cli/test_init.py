"""`winch-friction init`: a stranger's 50 t crane, from nothing to a checked simulation, without an editor."""

import json
import math
from pathlib import Path

import pytest
import yaml

from winch_friction.cli.main import run
from winch_friction.importing.map_schema import map_schema
from winch_friction.importing.mapping import load_map
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction.model import refuse_other_crane
from winch_friction.records.crane_file import crane_from_content, load_crane
from winch_friction.records.model_file import load_model
from winch_friction.records.schemas import problems
from winch_friction.records.strict_yaml import config_directory
from winch_friction.simulation.file_schemas import all_schemas
from winch_friction.simulation.plant_file import load_plant
from winch_friction.simulation.scenario import load_scenario

CRANE = ["--name", "crane_50t", "--load", "50", "--motors", "5", "--displacement", "160", "--gear-ratio", "180",
         "--radius", "0.6", "--layers", "5", "--active", "2", "--wire", "44"]  # fmt: skip
KINDS = {"cranes": "crane", "models": "model", "plants": "plant", "scenarios": "scenario"}


@pytest.fixture
def own(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for arguments in (
        ["crane", *CRANE],
        ["plant", "--crane", "crane_50t.yaml"],
        ["model", "--crane", "crane_50t.yaml"],
        ["scenario", "--crane", "crane_50t.yaml"],
        ["scenario", "--crane", "crane_50t.yaml", "--mode", "normal"],
        ["map", "--crane", "crane_50t.yaml"],
    ):
        assert run(["init", *arguments]) == 0
    capsys.readouterr()
    return tmp_path


def test_what_is_written_is_read(own):
    crane, plant = load_crane("crane_50t.yaml"), load_plant("plant_crane_50t.yaml")
    assert crane.groups == {"main": 5, "active": 2, "passive": 3}
    assert plant.crane == crane.name
    refuse_other_crane(load_model("seed_crane_50t.yaml"), crane)
    assert load_scenario("ahc_crane_50t.yaml").crane == crane.name
    assert load_map(own / "log_map.yaml").crane == crane.name
    schemas = {**all_schemas(), "map": map_schema()}
    written = {"crane_50t": "crane", "plant_crane_50t": "plant", "seed_crane_50t": "model", "log_map": "map"}
    for name, kind in {**written, "ahc_crane_50t": "scenario", "normal_crane_50t": "scenario"}.items():
        assert problems(yaml.safe_load((own / f"{name}.yaml").read_text()), schemas[kind]) == []


def test_ratings_are_written_or_lines_to_be_filled_in(tmp_path, monkeypatch):
    """Of a slow motor the rated speed tells motion from rest: without it no guard ever saw the winch turn."""
    monkeypatch.chdir(tmp_path)
    assert run(["init", "crane", *CRANE, "--rated-speed", "300", "--rated-pressure", "320"]) == 0
    rated = load_crane("crane_50t.yaml")
    assert (rated.rated_speed, rated.rated_pressure) == (pytest.approx(300.0 * math.pi / 30.0), pytest.approx(320e5))
    assert run(["init", "crane", *CRANE, "--out", "bare.yaml"]) == 0
    assert not load_crane("bare.yaml").rated_speed
    written = Path("bare.yaml").read_text()
    Path("bare.yaml").write_text(written.replace("# rated_speed", "rated_speed").replace("# rated_pr", "rated_pr"))
    filled = load_crane("bare.yaml")
    assert (filled.rated_speed, filled.rated_pressure) == (pytest.approx(100.0 * math.pi / 30.0), pytest.approx(350e5))


def test_a_pressure_is_rated_of_hydraulic_motors_alone(capsys):
    electric = ["--drive", "electric", "--name", "w", "--load", "5", "--motors", "1", "--gear-ratio", "90", "--radius",
                "0.3", "--layers", "4", "--wire", "20", "--inertia", "0.4"]  # fmt: skip
    assert run(["init", "crane", *electric, "--rated-pressure", "300", "--rated-speed", "0"]) == 2
    assert capsys.readouterr().err.splitlines() == [
        "winch-friction: init crane: --rated-pressure is not of --drive electric",
        "winch-friction: init crane: --rated-speed 0.0 must be above 0",
    ]


def test_of_no_motors_none_is_active_and_nothing_is_said_of_that(capsys):
    """`--active 9 must be 0 ... -1`."""
    hydraulic = ["--name", "w", "--load", "5", "--motors", "0", "--active", "9", "--gear-ratio", "90",
                 "--radius", "0.3", "--layers", "4", "--wire", "20", "--displacement", "160"]  # fmt: skip
    assert run(["init", "crane", *hydraulic]) == 2
    said = capsys.readouterr().err
    assert "--motors 0 must be above 0" in said
    assert "--active" not in said


@pytest.mark.parametrize(
    ("load", "motors", "displacement", "gear", "radius"),
    [("0.8", "1", "28", "5", "0.05"), ("1", "1", "28", "25", "0.15"), ("2", "1", "2000", "1", "0.25"),
     ("20", "2", "5000", "1", "0.15"), ("300", "40", "215", "250", "1.1")],
)  # fmt: skip
def test_a_model_for_any_crane_is_read(load, motors, displacement, gear, radius, tmp_path, monkeypatch):
    """A small gear, a large slow motor: what its shaft loses has another size than on the crane it is scaled from."""
    monkeypatch.chdir(tmp_path)
    own = ["--load", load, "--motors", motors, "--displacement", displacement, "--gear-ratio", gear, "--radius", radius]
    assert run(["init", "crane", "--name", "k", *own, "--layers", "1", "--active", "0", "--wire", "10"]) == 0
    assert run(["init", "model", "--crane", "k.yaml"]) == 0
    model = load_model("seed_k.yaml")
    for name in model.parameter_names:
        lower, upper = model.bounds_of(name)
        assert lower <= model.value(name) <= 0.5 * upper, name  # and room to learn
    assert run(["show", "seed_k.yaml", "--crane", "k.yaml"]) == 0


@pytest.mark.parametrize("name", ["12", "yes", "Nord: 7", "Kran # 7", "[7]"])
def test_any_name_is_read_back_as_it_was_given(name, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert run(["init", "crane", "--name", name, *CRANE[2:], "--out", "crane.yaml"]) == 0
    of = ["--crane", "crane.yaml", "--name", name]
    for kind in ("plant", "model", "scenario", "map"):
        assert run(["init", kind, *of[: 2 if kind == "map" else 4], "--out", f"{kind}.yaml"]) == 0
    crane, plant, model = load_crane("crane.yaml"), load_plant("plant.yaml"), load_model("model.yaml")
    assert {crane.name, plant.name, plant.crane, model.name, model.crane} == {name}
    assert load_map(tmp_path / "map.yaml").crane == load_scenario("scenario.yaml").crane == name


def test_a_model_that_assumes_nothing_is_of_its_crane_whatever_its_own_name(tmp_path, monkeypatch):
    """No motor like an electric drive's is known to scale from: a file without a term, for that crane alone."""
    monkeypatch.chdir(tmp_path)
    electric = ["--drive", "electric", "--load", "20", "--gear-ratio", "50", "--radius", "0.5", "--motors", "2",
                "--inertia", "1"]  # fmt: skip
    assert run(["init", "crane", "--name", "deck", *electric, "--layers", "1", "--wire", "100"]) == 0
    assert run(["init", "model", "--crane", "deck.yaml", "--name", "bare", "--out", "bare.yaml"]) == 0
    model = load_model("bare.yaml")
    assert (model.name, model.crane, model.terms) == ("bare", "deck", ())


def test_falls_are_so_many_ropes_side_by_side_at_a_part_of_the_radius(own, capsys):
    assert run(["init", "crane", *CRANE, "--falls", "2", "--out", "two.yaml"]) == 0
    one, two = load_crane("crane_50t.yaml"), load_crane("two.yaml")
    assert two.drum.layer_radii == pytest.approx([0.5 * radius for radius in one.drum.layer_radii], rel=1e-3)
    assert two.wire_mass == pytest.approx(2.0 * one.wire_mass, rel=1e-2)
    assert two.wire_stiffness == pytest.approx(2.0 * one.wire_stiffness, rel=1e-3)
    assert (two.gear_ratio, two.inertia) == (one.gear_ratio, one.inertia)
    assert "rope paid out / 2" in Path("two.yaml").read_text()
    capsys.readouterr()
    for wrong, said in ((["--falls", "0"], "--falls 0 must be above 0"), (["--active", "5"], "one group: 0")):
        assert run(["init", "crane", *CRANE, *wrong, "--out", "three.yaml"]) == 2
        assert said in capsys.readouterr().err


def test_an_own_crane_is_simulated_and_checked(own, capsys):
    machine = ["--crane", "crane_50t.yaml", "--model", "seed_crane_50t.yaml"]
    for scenario in ("ahc_crane_50t.yaml", "normal_crane_50t.yaml"):
        assert run(["simulate", scenario, *machine, "--out", "runs", "--truth"]) == 0
    assert run(["check", "runs", *machine]) == 0
    shown = capsys.readouterr()
    assert "plausible: 2 runs" in shown.out
    # the same runs with the wrong crane: refused, and the right one named
    assert run(["check", "runs", "--crane", "crane_150t"]) == 2
    assert "crane 'crane_50t'" in capsys.readouterr().out.splitlines()[0]


def test_another_crane_s_plant_model_or_load_is_refused(own, capsys):
    machine = ["--crane", "crane_50t.yaml", "--model", "seed_crane_50t.yaml", "--out", "x.csv"]
    assert run(["simulate", "ahc_55t_215", *machine]) == 2
    assert "plant 'winch_150t' is of crane 'crane_150t'" in capsys.readouterr().err
    assert run(["simulate", "ahc_crane_50t.yaml", "--crane", "crane_50t.yaml", "--out", "x.csv"]) == 2
    assert "does not belong to crane 'crane_50t'" in capsys.readouterr().err
    assert run(["init", "scenario", "--crane", "crane_50t.yaml", "--load", "300", "--name", "heavy"]) == 0
    assert run(["simulate", "heavy.yaml", *machine]) == 2
    assert "load 300 t is more than crane 'crane_50t'" in capsys.readouterr().err
    assert not (own / "x.csv").exists()


def test_missing_answers_are_told_at_once_and_files_are_kept(own, capsys, monkeypatch):
    monkeypatch.setattr("sys.stdin", open("/dev/null"))  # noqa: SIM115  nobody to ask
    assert run(["init", "crane", "--name", "x"]) == 2
    said = capsys.readouterr().err
    assert "--gear-ratio" in said
    assert "--wire" in said
    assert run(["init", "plant", "--crane", "crane_50t.yaml"]) == 2
    assert "exists already" in capsys.readouterr().err
    assert run(["init", "crane", *CRANE[:4], "--motors", "-1", *CRANE[6:], "--out", "y.yaml"]) == 2
    assert "--motors -1 must be above 0" in capsys.readouterr().err


def test_all_problems_of_a_file_are_told_at_once(own):
    content = yaml.safe_load((own / "crane_50t.yaml").read_text())
    del content["gear_ratio"], content["inertia"]
    content.update(colour="red", groups={"main": "five"})
    (own / "bad.yaml").write_text(yaml.safe_dump(content))
    with pytest.raises(InputError) as caught:
        load_crane(own / "bad.yaml")
    assert all(word in str(caught.value) for word in ("gear_ratio", "inertia", "colour", "main"))
    content = yaml.safe_load((own / "ahc_crane_50t.yaml").read_text())
    content.update(lode=3, duration=-1, mode="sideways")
    (own / "bad.yaml").write_text(yaml.safe_dump(content))
    with pytest.raises(InputError) as caught:
        load_scenario(own / "bad.yaml")
    assert all(word in str(caught.value) for word in ("lode", "duration", "mode"))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("folder", KINDS)
def test_shipped_files_fit_their_schema(folder):
    schema = all_schemas()[KINDS[folder]]
    for path in sorted((config_directory() / folder).glob("*.yaml")):
        assert problems(yaml.safe_load(path.read_text()), schema) == [], path


def test_the_schema_refuses_a_motor_groups_name_that_the_reader_refuses():
    content = yaml.safe_load((config_directory() / "cranes" / "crane_150t.yaml").read_text())
    content["groups"] = {"active 1": 3, "passive": 8}
    assert problems(content, all_schemas()["crane"]) == [
        "groups: must be a name of a motor group: letters, digits and _, a letter first, found 'active 1'"
    ]


@pytest.mark.parametrize(
    ("gear", "said"),
    [
        (-3, "gear_ratio: must be above 0, found -3"),
        ([3], "gear_ratio: must be a number, or {value, unit}, found [3]"),
    ],
)
def test_what_a_schema_says_is_a_sentence(gear, said):
    """`-3 is not in 1, or {value, unit}`."""
    content = yaml.safe_load((config_directory() / "cranes" / "crane_150t.yaml").read_text())
    content["gear_ratio"] = gear
    assert problems(content, all_schemas()["crane"]) == [said]


def test_published_schemas_are_the_readers(tmp_path):
    assert run(["init", "schemas", "--out", str(tmp_path)]) == 0
    published = config_directory() / "schemas"
    for path in tmp_path.iterdir():
        assert (published / path.name).read_text() == path.read_text(), (
            f"run: winch-friction init schemas --out {published}"
        )
    assert {path.name for path in published.iterdir()} == {path.name for path in tmp_path.iterdir()}


@pytest.mark.parametrize(
    "arguments", [["schemas", "--out", "taken"], ["crane", *CRANE, "--out", "taken/deep/crane.yaml"]]
)
def test_a_file_where_a_folder_is_needed_is_said(arguments, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("taken").write_text("kept")
    assert run(["init", *arguments, "--overwrite"]) == 2
    said = capsys.readouterr().err.splitlines()
    assert len(said) == 1
    assert said[0].startswith("winch-friction: --out taken/")
    assert said[0].endswith(f": {tmp_path / 'taken'} is a file, no folder; give another place")
    assert Path("taken").read_text() == "kept"


def test_what_a_schema_allows_the_reader_asks_for():
    """Every key of a declared schema is one that the strict reader knows, and the other way round."""
    content = yaml.safe_load((config_directory() / "cranes" / "crane_150t.yaml").read_text())
    with pytest.raises(InputError, match="known keys are") as caught:
        crane_from_content({**content, "unknown": 1}, "crane")
    known = set(str(caught.value).partition("known keys are ")[2].split(", "))
    optional = {"max_displacement", "wire_mass", "wire_stiffness"}
    assert known <= set(all_schemas()["crane"]["properties"]) <= known | optional


def test_what_was_written_is_said_as_json(tmp_path, capsys):
    out = tmp_path / "plant.yaml"
    assert run(["init", "plant", "--crane", "crane_150t", "--out", str(out), "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == {"written": [str(out)]}
    assert run(["init", "schemas", "--out", str(tmp_path / "schemas"), "--json"]) == 0
    assert len(json.loads(capsys.readouterr().out)["written"]) == len(list((tmp_path / "schemas").iterdir())) > 3


@pytest.mark.parametrize(
    ("option", "value", "said"),
    [
        ("--displacement", "0.0000255", "--displacement 2.55e-05 is outside 5 ... 5000 cm^3/rev"),
        ("--radius", "600", "--radius 600 is outside 0.05 ... 5 m"),
        ("--wire", "0.044", "--wire 0.044 is outside 2 ... 300 mm"),
        ("--load", "50000", "times the rated load of 50000 t"),
        ("--gear-ratio", "1.8", "times the rated load of 50 t"),
    ],
)
def test_a_figure_in_another_unit_is_not_written_down(option, value, said, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    arguments = list(CRANE)
    arguments[arguments.index(option) + 1] = value
    assert run(["init", "crane", *arguments]) == 2
    assert said in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("option", ["--overwrite", "--force"])
def test_a_file_is_replaced_by_the_option_of_the_other_verbs(option, tmp_path, capsys):
    """It was `--force` here alone, which elsewhere goes on with data that contradict the crane."""
    out = tmp_path / "plant.yaml"
    out.write_text("kept")
    arguments = ["init", "plant", "--crane", "crane_150t", "--out", str(out)]
    assert run(arguments) == 2
    assert "--overwrite" in capsys.readouterr().err
    assert out.read_text() == "kept"
    assert run([*arguments, option]) == 0
    assert out.read_text() != "kept"


@pytest.mark.parametrize("name", ["../elsewhere", "/tmp/elsewhere", "a/b"])
def test_a_name_is_no_path(name, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert run(["init", "crane", *CRANE, "--name", name]) == 2
    assert "--out says where" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_a_torque_limit_goes_with_the_number_of_motors_and_their_size(tmp_path, monkeypatch):
    """That of the shipped crane, 11 motors of 215 cm^3/rev, in proportion to what all motors together displace."""
    monkeypatch.chdir(tmp_path)
    shipped, limits = load_crane("crane_150t").absolute_torque_limit, []
    for motors, displacement in (("5", "160"), ("10", "160"), ("5", "80")):
        size = ["--motors", motors, "--displacement", displacement]
        assert run(["init", "crane", *CRANE[:4], *size, *CRANE[8:], "--out", f"{motors}_{displacement}.yaml"]) == 0
        limits.append(load_crane(f"{motors}_{displacement}.yaml").absolute_torque_limit)
    own = shipped * 160.0 / 215.0 / 11.0
    assert limits == pytest.approx([5.0 * own, 10.0 * own, 2.5 * own], rel=0.01)


def test_the_sets_are_simulated_for_an_own_crane(own, monkeypatch, capsys):
    """They were the 150 t crane's alone: its sixth layer, its motors' displacement."""
    from winch_friction.cli import simulate

    asked = []
    monkeypatch.setattr(simulate, "_simulate_to", lambda path, chosen, *_: asked.append(chosen) or {"run": str(path)})
    given = ["--crane", "crane_50t.yaml", "--model", "seed_crane_50t.yaml"]
    assert run(["simulate", "gap_campaign", *given, "--out", "runs"]) == 2
    assert "plant 'winch_150t' is of crane 'crane_150t', not of 'crane_50t'" in capsys.readouterr().err
    assert run(["simulate", "gap_campaign", *given, "--plant", "plant_crane_50t.yaml", "--out", "runs"]) == 0
    assert len(asked) == 12
    assert {each.wire_layer for each in asked} == {3, 4, 5}
    assert max(each.displacement for each in asked) == pytest.approx(load_crane("crane_50t.yaml").max_displacement)
    without = Path("crane_50t.yaml").read_text().replace("  active: 2\n", "").replace("  passive: 3\n", "")
    Path("crane_50t.yaml").write_text(without)
    assert run(["simulate", "gap_campaign", *given, "--plant", "plant_crane_50t.yaml", "--out", "runs"]) == 0
    assert "4 of 12 runs left out: 'crane_50t' has motor groups main" in capsys.readouterr().err
    assert len(asked) == 20
