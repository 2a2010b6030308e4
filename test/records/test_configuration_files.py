"""Model and crane files: strict, and wrong ones refused in one clear line that says where."""

import numpy as np
import pytest
import yaml

from winch_friction.physics.channels import CM3_PER_REV, RPM
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.friction.table import Table, tabulated
from winch_friction.records import strict_yaml
from winch_friction.records.crane_file import crane_from_content, load_crane
from winch_friction.records.model_file import load_model, model_from_text, model_to_text, save_model
from winch_friction.records.schemas import DECLARED, problems, with_all_problems
from winch_friction.records.strict_yaml import LARGEST_FILE, config_directory, parse_yaml, read_yaml

MODELS = sorted(path.stem for path in (config_directory() / "models").glob("*.yaml"))


def content(name="a6vm215_crane2", kind="models"):
    return yaml.safe_load((config_directory() / kind / f"{name}.yaml").read_text())


@pytest.mark.parametrize("name", MODELS)
def test_shipped_models_load_and_round_trip(name, tmp_path):
    model = load_model(name)
    again = load_model(save_model(model, tmp_path / "model.yaml"))
    assert again.values == model.values
    assert again.term_names == model.term_names
    if model.covariance is not None:
        np.testing.assert_allclose(again.covariance, model.covariance, rtol=1e-12)


def test_correlated_covariance_survives(crane2_model):
    size = len(crane2_model.values)
    mix = np.random.default_rng(3).normal(size=(size, 3 * size)) * crane2_model.std[:, None]
    model = crane2_model.with_covariance(mix @ mix.T / (3 * size))
    again = model_from_text(model_to_text(model))
    np.testing.assert_allclose(again.covariance, model.covariance, rtol=1e-9, atol=0)


def test_units_are_converted():
    model = load_model("a6vm215_crane2")
    assert model.value("C4") == pytest.approx(229 * RPM)
    assert model.constants["max_displacement"] == pytest.approx(215 * CM3_PER_REV)
    assert model.std[model.parameter_names.index("C6")] == pytest.approx(0.03 * 162e-7)


def correlated(entries, size=10):
    return [[entries.get((i, k), float(i == k)) for k in range(size)] for i in range(size)]


def without_deviations(data):
    """Said was: unknown key 'correlation'; did you mean corrections?"""
    for each in data["parameters"].values():
        each.pop("std", None)
    data["correlation"] = correlated({})


def edited(change):
    data = content()
    change(data)
    return yaml.safe_dump(data)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda d: d["parameters"].pop("K3"), "key 'K3' is missing"),
        (lambda d: d["parameters"].update(K9={"value": 1, "unit": "N*m"}), "unknown key 'K9'"),
        (lambda d: d["parameters"]["K4"].update(unit="bar"), "K4.*unit 'bar' cannot be used, expected N\\*m"),
        (lambda d: d["parameters"]["K4"].update(value=float("nan")), "K4: value must be a finite number"),
        (lambda d: d["parameters"]["K4"].update(value="lots"), "K4: value must be a finite number"),
        (
            lambda d: d["parameters"]["K4"].update(value=-3),
            r"model.yaml: parameters: K4: value -3 N\*m is outside 0 ... ",
        ),
        (lambda d: d["parameters"]["K4"].update(upper=3), r"K4: value 14 N\*m is outside 0 ... 3 N\*m$"),
        (
            lambda d: d["parameters"]["K4"].update(value=520),
            r"outside 0 ... 200 N\*m; a machine of another size states its own lower and upper beside it$",
        ),
        (
            lambda d: d["parameters"]["K4"].update(std=-1),
            "model.yaml: parameters: K4: std must be 0 or above .*found -1",
        ),
        (
            lambda d: d["parameters"]["K4"].update(std=1e308),
            r"model.yaml: parameters: K4: std must be 1e\+150 N\*m or less, found 1e\+308$",
        ),
        (lambda d: d["parameters"]["K4"].update(std=float("nan")), "K4: std must be a finite number"),
        (lambda d: d["parameters"]["K4"].update(std=float("inf")), "K4: std must be a finite number"),
        (lambda d: d["parameters"]["K4"].pop("std"), "K4 lacks 'std'"),
        (lambda d: d["parameters"]["K4"].update(sdt=1), "K4: unknown key 'sdt'"),
        (lambda d: d["terms"].append("friktion"), "term 'friktion' is not known"),
        (lambda d: d["terms"].append("viscous"), "different term names"),
        (lambda d: d.update(schema="winch_friction.model/9"), "schema"),
        (lambda d: d.update(colour="red"), "unknown key 'colour'"),
        (
            lambda d: d["constants"].update(gear_ratoi=d["constants"].pop("gear_ratio")),
            "unknown key 'gear_ratoi'; did you mean gear_ratio",
        ),
        (lambda d: d["constants"].update(gear_ratio=-250), r"constants: gear_ratio is -250, outside 0\.001 ... 100000"),
        (lambda d: d["constants"].update(gear_ratio=0), "constants: gear_ratio is 0, outside"),
        (lambda d: d["constants"].update(density=0.87), r"constants: density is 0\.87 kg/m\^3, outside 400 ... 3000"),
        (lambda d: d["constants"].update(viscosity=-0.04), r"viscosity is -0\.04 Pa\*s, outside .* is the unit right"),
        (
            lambda d: d["constants"].update(max_displacement=215),
            r"max_displacement is 215 m\^3/rad, outside 0 ... 0\.06",
        ),
        (lambda d: d["constants"].update(density=0, viscosity=0), r"density is 0 .* \| .* viscosity is 0 "),
        (lambda d: d.update(correlation=[[1.0]]), "correlation must be 10 x 10"),
        (without_deviations, "model.yaml: correlation without deviations: give every parameter a std"),
        (lambda d: d.update(terms=[]), "model.yaml: parameters: unknown key 'C1'; none may stand here"),
        (
            lambda d: d["parameters"]["K4"].update(lower=50, upper=10),
            r"model.yaml: parameters: K4: lower 50 N\*m is above upper 10",
        ),
        (lambda d: d.update(correlation=[["a"]]), "correlation must be 10 x 10"),
        (lambda d: d.update(correlation=[[1.0], 0.5]), "correlation must be 10 x 10"),
        (lambda d: d.update(correlation=[[1.0, 2.0], [3.0]]), "correlation must be 10 x 10"),
        (lambda d: d.update(correlation={"K1": {"K2": 0.3}}), "correlation must be 10 x 10"),
        (lambda d: d.update(correlation=correlated({(0, 2): "x", (2, 0): "x"})), "row 1, column 3 must be a finite"),
        (lambda d: d.update(correlation=correlated({(0, 2): [0.3]})), "row 1, column 3 must be a finite number"),
        (lambda d: d["parameters"]["K4"].update(value=[14.0]), r"K4: value must be a finite number, found \[14.0\]"),
        (lambda d: d.update(correlation=correlated({(0, 2): 0.5})), "row 1, column 3 is 0.5 and its mirror 0;"),
        (lambda d: d.update(correlation=correlated({(3, 3): 4.0})), "row 4, column 4 must be 1, found 4"),
        (lambda d: d.update(correlation=correlated({(0, 2): 2.0, (2, 0): 2.0})), "model.yaml: correlation is not pos"),
        (lambda d: d.update(provenance=3), "model.yaml: provenance: expected a mapping"),
        (lambda d: d.update(provenance=["paper 2"]), "model.yaml: provenance: expected a mapping"),
        (lambda d: d.update(parameters=None), "expected a mapping"),
    ],
)
def test_a_wrong_model_is_one_clear_line(change, message):
    with pytest.raises(InputError, match=message) as caught:
        model_from_text(edited(change), "model.yaml")
    assert "\n" not in str(caught.value)


def test_a_deviation_far_beyond_its_range_is_read_as_an_identification_may_write_it():
    model = model_from_text(edited(lambda d: d["parameters"]["K4"].update(std=1e149)), "model.yaml")
    assert model.std[model.parameter_names.index("K4")] == pytest.approx(1e149, rel=1e-12)


@pytest.mark.parametrize("text", ["{", "- 1", "", "\t x: 1", "a: *b"])
def test_not_yaml_or_not_a_model(text):
    with pytest.raises(InputError, match="here"):
        model_from_text(text, "here")


@pytest.mark.parametrize(("encoding", "name"), [("utf-16", "Größe"), ("utf-16-le", "Größe"), ("latin-1", "Größe"),
                                                  ("utf-16-le", "size")])  # fmt: skip
def test_a_file_in_another_encoding_is_to_be_saved_as_utf_8(tmp_path, encoding, name):
    """Plain letters in UTF-16 are valid UTF-8, with a zero behind each."""
    path = tmp_path / "crane.yaml"
    path.write_bytes(f"name: {name}\n".encode(encoding))
    with pytest.raises(InputError) as caught:
        read_yaml(path)
    assert str(caught.value).startswith(f"{path}: not UTF-8 text (")
    assert str(caught.value).endswith("); save it as UTF-8")


def test_a_key_that_stands_twice_is_refused_and_none_is_taken(tmp_path):
    text = (config_directory() / "cranes" / "crane_150t.yaml").read_text()
    crane = tmp_path / "crane.yaml"
    crane.write_text(text.replace("  passive: 8\n", "  passive: 8\n  main: 14\n") + "gear_ratio: 25\n")
    first = [text.splitlines().index(next(x for x in text.splitlines() if x.startswith(key))) + 1
             for key in ("gear_ratio", "  main")]  # fmt: skip
    with pytest.raises(InputError) as caught:
        load_crane(crane)
    last = len(crane.read_text().splitlines())
    assert f"{crane} line {last}: key 'gear_ratio' stands on line {first[0]} already" in caught.value.problems[0]
    assert f"key 'main' stands on line {first[1]} already" in caught.value.problems[1]


def test_a_key_that_stands_in_a_merged_mapping_too_overrules_it():
    assert parse_yaml("a: &a {x: 1}\nb: {<<: *a, x: 2}\nc: {x: 3}", "here")["b"] == {"x": 2}


def test_repetitions_that_make_a_billion_entries_are_refused_and_others_taken(monkeypatch):
    monkeypatch.setattr(strict_yaml, "MOST_UNFOLDED", 1000)  # a hundredth of them, in a hundredth of the time
    lists = "a: &a0 [1,1,1,1,1,1,1,1,1,1]\nb1: &a1 [*a0, *a0, *a0, *a0, *a0, *a0, *a0, *a0, *a0, *a0]\n"
    assert len(parse_yaml(lists, "here")["b1"]) == 10
    more = lists + "b2: &a2 [*a1, *a1, *a1, *a1, *a1, *a1, *a1, *a1, *a1, *a1]\n"
    with pytest.raises(InputError, match="here: its repetitions .* more than 1000 entries"):
        parse_yaml(more, "here")
    with pytest.raises(InputError, match="here: its repetitions"):
        parse_yaml("a: &a {b: *a}", "here")
    assert len(parse_yaml(f"a: [{'1,' * 1001}]", "here")["a"]) == 1001  # long, and nothing repeated


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda d: d.pop("gear_ratio"), "key 'gear_ratio' is missing"),
        (lambda d: d.update(drive="steam"), "drive must be one of hydraulic, electric"),
        (lambda d: d.update(inertia={"value": 0, "unit": "kg*m^2"}), "inertia must be above 0"),
        (lambda d: d["drum"].update(layer_radii=[1.0, 0.9]), "grow from layer to layer"),
        (lambda d: d["groups"].update(active=2.5), "whole number of motors"),
        (lambda d: d.update(max_displacement={"value": 215, "unit": "bar"}), "unit 'bar'"),
        (lambda d: d.update(groups={}), "groups: none is there; a hydraulic crane needs one at least, e.g. main: 11"),
        (lambda d: d["groups"].update({"": 2}), "groups: '' is no name of a motor group: write letters"),
        (lambda d: d["groups"].update({"ma.in": 2}), "groups: 'ma.in' is no name of a motor group: write letters"),
        (lambda d: d["groups"].update({2: 2}), "groups: '2' is no name of a motor group: write letters"),
        (lambda d: d["groups"].update({"a/b": 2, "a b": 2}), r"'a/b' is no name.* \| .*'a b' is no name"),
    ],
)
def test_a_wrong_crane_is_one_clear_line(change, message):
    data = content("crane_150t", "cranes")
    change(data)
    with pytest.raises(InputError, match=message):
        crane_from_content(data, "crane.yaml")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda d: d["drum"].update(layer_radii=[403, 440]), r"layer_radii\[1\] is 403 m, of winches 0.001 ... 10 m: "
         r"did you mean mm \(0.403 m\)\?$"),
        (lambda d: d["drum"].update(layer_radii=[40.3, 44]), r"did you mean cm \(0.403 m\)"),
        (lambda d: d.update(gear_ratio=0.004), r"gear_ratio is 0.004.* did you mean its inverse \(250\)"),
        (lambda d: d.update(max_displacement=215), r"max_displacement is 215 m\^3/rad.* did you mean cm\^3/rev"),
        (lambda d: d.update(inertia=15400), r"inertia \(at the motor shaft\) is 1.54e\+04.* kg\*cm\^2 \(1.54 kg"),
        (lambda d: d.update(wire_mass=24500), r"did you mean kg/km \(24.5 kg/m\)"),
        (lambda d: d.update(wire_mass=-24.5), "wire_mass is -24.5 kg/m.* correct the number or its unit"),
        (lambda d: d.update(wire_stiffness=3e5), r"did you mean kN \(3e\+08 N\)"),
        (lambda d: d.update(rated_pressure=450), "rated_pressure is 450 Pa.* did you mean bar"),
        (lambda d: d.update(rated_load=150), r"rated_load is 150 kg, of motors and a gear.* did you mean t"),
        (lambda d: d.update(rated_speed=4800), "rated_speed is 4800 rad/s.* did you mean rpm"),
        (lambda d: d["groups"].update(main=1100), r"groups: main has 1100 motors, of winches 1 ... 200"),
    ],
)  # fmt: skip
def test_a_number_that_no_winch_has_is_said_with_its_range_and_the_likely_unit(change, message):
    data = content("crane_150t", "cranes")
    change(data)
    with pytest.raises(InputError, match=message) as caught:
        crane_from_content(data, "crane.yaml")
    assert len(caught.value.problems) == 1


def test_all_numbers_that_no_winch_has_are_said_at_once():
    data = content("crane_150t", "cranes")
    data.update(gear_ratio=0.004, rated_pressure=450)
    with pytest.raises(InputError) as caught:
        crane_from_content(data, "crane.yaml")
    assert len(caught.value.problems) == 2


def test_unknown_name_lists_what_is_shipped(tmp_path, monkeypatch):
    with pytest.raises(InputError, match="did you mean crane_150t.* shipped: crane_150t, emps"):
        load_crane("crane_15t")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "crane_15t.yaml").write_text("")
    with pytest.raises(InputError, match=r"did you mean the file crane_15t\.yaml\? shipped"):
        load_crane("crane_15t")


def test_a_layer_that_does_not_exist(crane_150t):
    with pytest.raises(InputError, match="layers 1 ... 6"):
        crane_150t.drum.radius(7)
    assert crane_150t.drum.radius(float("nan")) == pytest.approx(1.136)


@pytest.mark.parametrize(
    ("written", "read"), [("014", 12), ("1:14", 74), ("-1:14.5", -74.5), ("0x14", 20), ("0b11", 3)]
)
def test_a_number_to_another_base_than_ten_is_refused(written, read):
    """YAML 1.1 takes 014 for 12 without a word."""
    with pytest.raises(InputError, match=f"line 2: {written} is {read} to YAML"):
        parse_yaml(f"a: 1\nb: {written}\n", "model.yaml")


@pytest.mark.parametrize(
    ("written", "read"),
    [("0", 0), ("0.14", 0.14), ("14", 14), ("1_000", 1000), ("1e3", "1e3"), ("'014'", "014"), ("1.5e+3", 1500.0)],
)
def test_a_number_to_the_base_ten_is_what_it_says(written, read):
    assert parse_yaml(f"a: {written}\n", "model.yaml") == {"a": read}


def test_what_a_file_may_have_is_among_the_known_keys():
    """A section that this file does not have was missing from the list: `corrections` looked forbidden."""
    text = yaml.safe_dump({**content(), "foo": 1})
    with pytest.raises(InputError, match="unknown key 'foo'") as caught:
        model_from_text(text)
    known = set(str(caught.value).partition("known keys are ")[2].split(", "))
    assert {"corrections", "tables"} <= known


def test_every_number_of_a_crane_that_cannot_be_is_told_at_once(tmp_path):
    """The reader stopped at its first, and the schema knows neither units nor what is finite."""
    given = {**content("crane_150t", "cranes"), "gear_ratio": -160, "absolute_torque_limit": {"value": float("nan")}}
    given |= {"max_displacement": {"value": 215, "unit": "cm^3"}, "drum": {"layer_radii": [0.8, 0.7]}}
    path = tmp_path / "crane.yaml"
    path.write_text(yaml.safe_dump(given))
    with pytest.raises(InputError) as caught:
        load_crane(path)
    for key in ("gear_ratio", "layer_radii", "max_displacement", "absolute_torque_limit"):
        assert sum(key in each for each in caught.value.problems) == 1


@pytest.mark.parametrize(
    ("written", "instead", "said"),
    [
        ("{value: 1.54, ", "{value: 1,54, ", "inertia: 'value: 1,' ends there in YAML; write a decimal point"),
        ("gear_ratio: 250", "gear_ratio: 250,5", "gear_ratio must be a finite number.*write a decimal point: 250.5"),
        (
            "{value: 24.5, unit: kg/m}", "24.5 kg/m",
            "wire_mass: '24.5 kg/m' is one text; write {value: 24.5, unit: kg/m}",
        ),
        ("name: crane_150t", "name: no", "name must be a string, found False .bool.; put it in quotes"),
        ("name: crane_150t", "name: 2026-01-01", "name must be a string.*; put it in quotes"),
    ],
)  # fmt: skip
def test_how_a_number_or_a_name_is_to_be_written_is_said(written, instead, said):
    text = (config_directory() / "cranes" / "crane_150t.yaml").read_text()
    assert written in text
    with pytest.raises(InputError, match=said):
        crane_from_content(parse_yaml(text.replace(written, instead, 1), "crane.yaml"), "crane.yaml")


@pytest.mark.parametrize("written", ["[Nord, 7]", "{of: Nord}"])
def test_a_list_or_a_section_in_a_names_place_is_not_to_be_put_in_quotes(written):
    text = (config_directory() / "cranes" / "crane_150t.yaml").read_text()
    text = text.replace("name: crane_150t", f"name: {written}")
    with pytest.raises(InputError, match="name must be a string") as caught:
        crane_from_content(parse_yaml(text, "crane.yaml"), "crane.yaml")
    assert "quotes" not in str(caught.value)


def test_a_number_and_an_entry_without_a_value_are_no_decimal_comma():
    text = "schema: winch_friction.crane/1\nname: x\ngear_ratio: 250\nnotes:\n"
    with pytest.raises(InputError) as caught:
        crane_from_content(parse_yaml(text, "crane.yaml"), "crane.yaml")
    assert "decimal" not in str(caught.value)


# -- what a schema finds besides
@pytest.mark.parametrize(
    ("kind", "change", "said"),
    [
        ("crane", {"inertia": 0}, "inertia: must be above 0, found 0"),
        ("crane", {"gear_ratio": -3}, "gear_ratio: must be above 0, found -3"),
        ("crane", {"rated_load": 0}, "rated_load: must be above 0, found 0"),
        ("crane", {"wire_mass": "heavy"}, "wire_mass: must be a number in kg/m, or {value, unit}, found 'heavy'"),
        ("crane", {"gear_ratio": "much"}, "gear_ratio: must be a number, or {value, unit}, found 'much'"),
        ("crane", {"groups": {"main": 0}}, "groups.main: 0 is less than the minimum of 1"),
        ("crane", {"groups": {"main": "two"}}, "groups.main: must be a whole number, found 'two'"),
        ("crane", {"name": 3}, "name: must be a text, found 3"),
        ("crane", {"colour": "red"}, "unknown key 'colour'; known keys are schema, name, drive"),
        ("crane", {"drum": {}}, "drum: key 'layer_radii' is missing"),
        ("crane", {"inertia": None}, "key 'inertia' is missing"),
        ("model", {"terms": "coulomb"}, "terms: must be a list [...], found 'coulomb'"),
        ("model", {"parameters": []}, "parameters: must be a mapping of keys, found []"),
    ],
)
def test_a_schema_says_where_and_what_is_wrong(kind, change, said):
    name, folder = {"crane": ("crane_150t", "cranes"), "model": ("a6vm215_crane2", "models")}[kind]
    data = {key: value for key, value in (content(name, folder) | change).items() if value is not None}
    found = problems(data, DECLARED[kind])
    assert len(found) == 1
    assert found[0].startswith(said)


def test_a_whole_file_breaks_no_schema():
    assert problems(content("crane_150t", "cranes"), DECLARED["crane"]) == []
    assert all(problems(content(name), DECLARED["model"]) == [] for name in MODELS)


@pytest.mark.parametrize(
    ("name", "taken"), [("main", True), ("a_2", True), ("2a", False), ("_a", False), ("a-b", False)]
)
def test_a_group_has_a_name_that_a_topic_can_have(name, taken):
    assert (problems(content("crane_150t", "cranes") | {"groups": {name: 2}}, DECLARED["crane"]) == []) is taken


@pytest.mark.parametrize(("count", "told", "more"), [(2, 2, ""), (12, 12, ""), (15, 12, "f: ... and 3 more")])
def test_a_dozen_problems_are_told_behind_the_readers_own_and_how_many_more(count, told, more):
    data = content("crane_150t", "cranes") | {f"odd_{k}": 1 for k in range(count)}
    said = with_all_problems(InputError("f: the first"), data, "crane", "f").problems
    assert said[0] == "f: the first"
    assert sum("unknown key 'odd_" in each for each in said) == told
    assert (said[-1] if more else "") == more


def test_what_the_reader_has_said_is_not_said_again():
    data = content("crane_150t", "cranes") | {"inertia": 0, "rated_load": 0, "colour": 1}
    first = InputError("f: inertia must be above 0 kg*m^2", "f: unknown key 'colour'")
    assert with_all_problems(first, data, "crane", "f").problems == (
        *first.problems, "f: rated_load: must be above 0, found 0",
    )  # fmt: skip
    assert str(with_all_problems(first, [1], "crane", "f")).endswith(": is this a crane file?")


# -- bounds of a parameter
@pytest.mark.parametrize(
    ("given", "bounds"),
    [({"upper": 5}, (-1e4, 5.0)), ({"lower": -5}, (-5.0, 1e4)), ({"lower": -2, "upper": 3}, (-2.0, 3.0)),
     ({}, (-1e4, 1e4))],
)  # fmt: skip
def test_a_bound_that_is_not_given_is_the_declared_one(given, bounds):
    """Of a torque that may have either sign."""
    entry = {"value": 1.0, "unit": "N*m"} | given
    own = {"schema": "winch_friction.model/1", "name": "m", "terms": ["torque_offset"], "parameters": {"T_0": entry}}
    assert model_from_text(yaml.safe_dump(own)).bounds_of("T_0") == bounds


@pytest.mark.parametrize(
    ("bounds", "written"),
    [((float("-inf"), 5.0), {"upper": 5.0}), ((-5.0, float("inf")), {"lower": -5.0}),
     ((float("-inf"), float("inf")), {}), ((-5.0, 5.0), {"lower": -5.0, "upper": 5.0})],
)  # fmt: skip
def test_a_bound_is_written_where_there_is_one(bounds, written):
    term = tabulated(Table("t", (("wire_out", (0.0, 1.0)),)))
    model = FrictionModel("m", (term,), (2.0, 1.0), bounds={"t_0": bounds})
    entry = yaml.safe_load(model_to_text(model))["parameters"]["t_0"]
    assert entry == {"value": 2.0, "unit": "N*m"} | written
    assert model_from_text(model_to_text(model)).bounds_of("t_0") == bounds


def test_a_file_of_another_kind_in_a_models_place_is_said_to_be_that():
    """Not that its key 'terms' is missing: the two paths were exchanged on the command line."""
    with pytest.raises(InputError, match="this is a crane file .*, and a model file is asked for"):
        load_model(config_directory() / "cranes" / "crane_150t.yaml")


def test_a_text_that_is_read_again_is_parsed_once_and_given_anew(monkeypatch):
    """The check reads every shipped crane for each log; what one reader changes is not what the next one gets."""
    text = "crane: {groups: [1, 2]}\n# read again\n"
    first = parse_yaml(text, "a.yaml")
    first["crane"]["groups"].append(3)
    monkeypatch.setattr(strict_yaml, "_Loader", None)
    assert parse_yaml(text, "a.yaml") == {"crane": {"groups": [1, 2]}}


def test_a_refusal_names_the_file_that_is_read_now():
    for name in ("a.yaml", "b.yaml", "a.yaml"):
        with pytest.raises(InputError, match=f"{name} line 2: key 'k' stands on line 1 already"):
            parse_yaml("k: 1\nk: 2\n", name)


def test_a_model_file_in_place_of_a_cranes_is_told_as_such_alone():
    path = config_directory() / "models" / "a6vm215_crane2.yaml"
    with pytest.raises(InputError) as told:
        load_crane(path)
    said = "this is a model file (schema 'winch_friction.model/1'), and a crane file is asked for"
    assert str(told.value) == f"{path}: {said}"


def test_a_key_that_stands_thrice_is_told_with_the_line_on_which_it_stood_first():
    with pytest.raises(InputError) as told:
        parse_yaml("a: 1\nb: 2\na: 3\na: 4\n", "here")
    said = "key 'a' stands on line 1 already; keep one of them"
    assert list(told.value.problems) == [f"here line 3: {said}", f"here line 4: {said}"]


@pytest.mark.parametrize(("size", "refused"), [(LARGEST_FILE, False), (LARGEST_FILE + 1, True)])
def test_a_file_that_is_too_large_for_one_is_not_read(tmp_path, size, refused):
    """30 MB of text took 40 s, at the desk and in a node beside its torque."""
    path = tmp_path / "log.yaml"
    path.write_text("a: 1\n" + (size - 5) * "#")
    if refused:
        with pytest.raises(
            InputError, match=r"log\.yaml: 1 MB are no model, crane or scenario .* is it the right file"
        ):
            read_yaml(path)
    else:
        assert read_yaml(path) == {"a": 1}
