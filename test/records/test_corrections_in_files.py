"""Corrections and the crane's name in model files: round trip, units, and what is refused."""

from dataclasses import replace

import pytest
import yaml

from winch_friction.physics.channels import BAR, CM3_PER_REV
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction.correction import Correction
from winch_friction.physics.friction.declared_correction import DECLARED
from winch_friction.physics.friction.table import tabulated
from winch_friction.physics.friction.term import Scope
from winch_friction.records.corrections import corrections_content, read_tables, tables_content
from winch_friction.records.model_file import load_model, model_from_text, model_to_text, save_model
from winch_friction.records.schemas import DECLARED as SCHEMAS
from winch_friction.records.schemas import problems
from winch_friction.records.strict_yaml import Section, config_directory


def every_correction():
    found = []
    for name, own in DECLARED.items():
        more = {"time_constant": 45.0} if own.has_time_constant else {}
        more |= {"during": ((1.7e9, 1.8e9),)} if own.grows else {}
        more |= {"beyond": {"Pa": 150 * BAR, "m^3/rad": 100 * CM3_PER_REV}[own.bends_in]} if own.bends_in else {}
        more |= {"course": ((0.0, 0.0), (30.0, 1.0), (70.0, -0.25))} if own.course == "drawn" else {}
        lower = 0.0 if own.parameter.lower == 0.0 else 0.5 * own.parameter.lower
        value = own.parameter.typical / 3.0
        found.append(Correction(name, value, 0.1 * value, lower, 2.0 * own.parameter.typical, "a test", **more))
        if own.by_group:
            found.append(Correction(name, value, None, groups=("active", "passive"), **more))
        if own.by_layer:
            found.append(Correction(name, -value, layers=(2, 3), **more))
    return tuple(found)


def test_every_correction_survives_the_file(crane2_model, tmp_path):
    model = replace(crane2_model, corrections=every_correction(), crane="crane_150t")
    again = load_model(save_model(model, tmp_path / "model.yaml"))
    assert again.corrections == model.corrections
    assert again.crane == "crane_150t"
    assert model_to_text(again) == model_to_text(model)


def test_a_file_with_every_correction_is_one_by_the_schema(crane2_model):
    """An editor, and the list of problems of a file that is refused for another reason, called `course` unknown."""
    text = model_to_text(replace(crane2_model, corrections=every_correction(), crane="crane_150t"))
    content = yaml.safe_load(text)
    assert problems(content, SCHEMAS["model"]) == []
    for course in ([[0.0, 1.0], [30.0]], [[0.0, 1.0]]):
        content["corrections"]["signal_course"]["course"] = course
        (said,) = problems(content, SCHEMAS["model"])
        assert said.startswith("corrections.signal_course")


def with_section(section):
    data = yaml.safe_load((config_directory() / "models" / "a6vm215_crane2.yaml").read_text())
    return yaml.safe_dump(data | {"corrections": section})


@pytest.mark.parametrize(
    ("name", "entry", "value"),
    [
        ("pressure_offset", {"value": 1.5, "unit": "bar"}, 1.5 * BAR),
        ("pressure_offset", {"value": 20, "unit": "psi"}, 20 * 6894.757),
        ("displacement_offset", {"value": -2, "unit": "cm^3/rev"}, -2 * CM3_PER_REV),
        ("displacement_scale", {"value": 2, "unit": "percent"}, 0.02),
        ("displacement_scale", {"value": 2, "unit": "%"}, 0.02),
        ("signal_delay", {"value": 50, "unit": "ms"}, 0.05),
        ("tare_load", {"value": 2.5, "unit": "t"}, 2500.0),
        ("tare_load", {"value": 1000, "unit": "lb"}, 453.59237),
        ("layer_radius", {"value": "67e0", "unit": "mm", "layers": [6]}, 0.067),
    ],
)
def test_units_are_converted(name, entry, value):
    (found,) = model_from_text(with_section({name: entry})).corrections
    assert found.value == pytest.approx(value, rel=1e-6)


def test_std_and_bounds_have_the_unit_of_the_value():
    entry = {"value": 1.5, "unit": "bar", "std": 0.2, "lower": -3, "upper": 3}
    (found,) = model_from_text(with_section({"pressure_offset": entry})).corrections
    assert (found.std, *found.bounds) == pytest.approx((0.2 * BAR, -3 * BAR, 3 * BAR))


@pytest.mark.parametrize(
    ("section", "message"),
    [
        ([], "expected a mapping"),
        ({"friction": {"value": 1, "unit": "bar"}}, "friction: correction 'friction' is not known"),
        ({"tare_load": 3}, "tare_load: expected a mapping"),
        ({"tare_load": {"unit": "t"}}, "tare_load: key 'value' is missing"),
        ({"tare_load": {"value": 3}}, "tare_load: key 'unit' is missing"),
        ({"tare_load": {"value": 3, "unit": "bananas"}}, "tare_load: unit 'bananas' cannot be read as kg"),
        ({"tare_load": {"value": 3, "unit": "bar"}}, "tare_load: unit 'bar'"),
        ({"tare_load": {"value": 3, "unit": "t", "sigma": 1}}, "unknown key 'sigma'"),
        ({"wire_weight": {"value": -18.9, "unit": "kg/m"}}, "wire_weight: .*outside 0"),
        (
            {"tare_load": [{"value": 3, "unit": "t"}, {"value": 4, "unit": "t"}]},
            "^model.yaml: .*stands twice",
        ),
        ({"pressure_scale": {"value": -1, "unit": "1"}}, "pressure_scale': -1 is outside -0.2 ... 0.2$"),
        ({"pressure_offset": {"value": 3, "unit": "bar", "groups": "active"}}, "groups must be a list"),
        ({"pressure_offset": [{"value": 3, "unit": "bar", "groups": []}]}, r"pressure_offset\[1\]: groups must be"),
        ({"layer_radius": {"value": 3, "unit": "mm", "layers": ["6"]}}, "layers must be a list"),
        ({"accumulator_heat": {"value": 0.5, "unit": "1"}}, "needs a time_constant"),
        (
            {"signal_course": {"value": 0.1, "unit": "s"}},
            r"'signal_course' needs course: points \[s since the run began",
        ),
        ({"signal_course": {"value": 0.1, "unit": "s", "course": 3}}, "signal_course: course must be a list of points"),
        ({"signal_course": {"value": 0.1, "unit": "s", "course": [[0, 1]]}}, "course must be a list of points"),
        ({"signal_course": {"value": 0.1, "unit": "s", "course": [[0, 1], [9]]}}, "course must be a list of points"),
        (
            {"signal_course": {"value": 0.1, "unit": "s", "course": [[0, 1], ["a", 1]]}},
            "course must be a finite number",
        ),
    ],
)
def test_what_is_not_a_correction_is_refused_in_one_line(section, message):
    with pytest.raises(InputError, match=message) as error:
        model_from_text(with_section(section), "model.yaml")
    assert "\n" not in str(error.value)


def test_a_window_may_stay_open_to_its_end_alone():
    entry = {"value": 1.5, "unit": "bar", "during": [[0, 10], [20, float("inf")]]}
    (found,) = model_from_text(with_section({"pressure_offset": entry})).corrections
    assert found.during == ((0.0, 10.0), (20.0, float("inf")))
    with pytest.raises(InputError, match="during must be a finite number"):
        model_from_text(with_section({"pressure_offset": entry | {"during": [[float("-inf"), 10]]}}))


@pytest.mark.parametrize(
    ("entry", "said"),
    [
        ({"groups": ["active", "active"]}, "groups must be a list of different motor groups"),
        ({"groups": [1]}, "groups must be a list of different motor groups"),
        ({"layers": [True]}, "layers must be a list of different wire layers, from 1"),
    ],
)
def test_what_a_correction_is_tied_to_stands_once_by_its_kind(entry, said):
    name = "layer_radius" if "layers" in entry else "pressure_offset"
    unit = "mm" if "layers" in entry else "bar"
    with pytest.raises(InputError, match=said):
        model_from_text(with_section({name: {"value": 1.0, "unit": unit} | entry}))


def test_where_a_bend_begins_may_be_in_any_unit_of_its_channel():
    entry = {"value": 2, "unit": "%", "beyond": {"value": 150, "unit": "bar"}}
    (found,) = model_from_text(with_section({"pressure_bend": entry})).corrections
    assert (found.value, found.beyond) == pytest.approx((0.02, 150e5))
    assert corrections_content([found])["pressure_bend"]["beyond"] == {"value": pytest.approx(150e5), "unit": "Pa"}


def test_a_table_that_says_its_knots_unit_and_scope_alone_is_free_and_opposes_the_motion():
    given = {"tables": {"t": {"knots": {"wire_out": [0, 100]}, "unit": "N*m", "scope": "shaft"}}}
    term = read_tables(Section(given, "file"))["t"]
    table = term.table
    assert (table.opposing, table.shape, table.anchor, table.typical) == (True, "free", "none", 1.0)
    assert (table.place, table.source, table.side, table.weights, table.times) == (
        "gear and drum", "tabulated", "both", (), (),
    )  # fmt: skip
    assert (term.opposing, term.place, term.scope) == (True, "gear and drum", Scope.SHAFT)


def test_what_a_table_says_of_itself_is_taken():
    said = {
        "knots": {"pressure": [1e6, 2e7]}, "unit": "Pa", "times": ["displacement"], "scope": "motor", "opposing": False,
        "shape": "rising", "anchor": "low", "typical": 3.0, "place": "motor", "source": "a test", "side": "lowering",
    }  # fmt: skip
    table = read_tables(Section({"tables": {"t": said}}, "file"))["t"].table
    assert tables_content((tabulated(table),)) == {"t": said}
