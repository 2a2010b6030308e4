"""Map files: what is written is read back as it was, the published schema and the reader agree."""

import json
from pathlib import Path

import pytest
import yaml

from winch_friction.importing.map_schema import map_schema
from winch_friction.importing.map_text import map_text
from winch_friction.importing.mapping import Entry, LogMap, load_map, map_from_content, with_settings
from winch_friction.importing.time_base import TimeBase
from winch_friction.physics.errors import InputError
from winch_friction.records.atomic import config_directory

MAP = LogMap(
    columns={
        "motor_speed": Entry('n "ist" [1/min]', "1/min", sign=-1, confidence=0.9, because="name: 'n'"),
        "main.displacement": Entry("α", "%", of="215 cm^3/rev", confidence=0.5),
        "shaft_angle": Entry("x", "rad", factor=2.5, at="drum", differentiate=20.0),
    },
    time_from=("Datum", "Uhrzeit"),
    time=TimeBase("datetime", order="dmy", zone="Europe/Oslo", spread=True),
    crane="crane_150t",
    log={"kind": "text", "delimiter": "\t", "decimal": ",", "names_row": 3},
    unused=("Wind: m/s",),
    questions=("hook_load: t or kg?",),
)
WRONG = [
    "schema: winch_friction.map/2\ncolumns: {motor_speed: {from: n}}",
    "schema: winch_friction.map/1\ncolumns: {motor_speed: {from: n, sign: 0}}",
    "schema: winch_friction.map/1\ncolumns: {motor_speed: {from: n, at: hook}}",
    "schema: winch_friction.map/1\ncolumns: {motor_speed: {unit: rpm}}",
    "schema: winch_friction.map/1\ncolumns: {}",
    "schema: winch_friction.map/1\ncolumns: {motor_speed: {from: n}}\ntime: {form: sundial}",
    "schema: winch_friction.map/1\ncolumns: {motor_speed: {from: n}}\nbad_cells: ignore",
    "schema: winch_friction.map/1\ncolumns: {motor_speed: {from: n}}\nlog: {delimiter: ';;'}",
    "schema: winch_friction.map/1\ncolumns: {motor_speed: {from: n}}\nlog: {decimal: ''}",
    "schema: winch_friction.map/1\ncolumns: {motor_speed: {from: n}}\ncolour: red",
]


def test_a_map_comes_back_as_it_was(tmp_path):
    (tmp_path / "map.yaml").write_text(map_text(MAP), encoding="utf-8")
    assert load_map(tmp_path / "map.yaml") == MAP


@pytest.mark.parametrize(
    "path", sorted((config_directory() / "examples").glob("*/map.yaml")), ids=lambda p: p.parent.name
)
def test_shipped_maps_follow_the_schema(path: Path):
    jsonschema = pytest.importorskip("jsonschema")
    jsonschema.validate(yaml.safe_load(path.read_text(encoding="utf-8")), map_schema())


@pytest.mark.parametrize("text", WRONG)
def test_the_reader_and_the_schema_refuse_alike(text):
    with pytest.raises(InputError):
        map_from_content(yaml.safe_load(text), "map")
    jsonschema = pytest.importorskip("jsonschema")
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(yaml.safe_load(text), map_schema())


def test_the_published_schema_is_the_codes(tmp_path):
    published = Path(__file__).parents[2] / "docs" / "schemas" / "map.schema.json"
    assert json.loads(published.read_text(encoding="utf-8")) == map_schema()


def test_a_switch_is_set_from_the_command_line():
    """`true` came as a word, and was no."""
    assert not with_settings(MAP, ["time.spread=false"]).time.spread
    assert with_settings(with_settings(MAP, ["time.spread=false"]), ["time.spread=true"]).time.spread
    with pytest.raises(InputError, match="spread must be true or false"):
        with_settings(MAP, ["time.spread=maybe"])


def test_settings_change_a_map_and_answer_its_questions():
    changed = with_settings(MAP, ["hook_load.from=Last", "hook_load.unit=t", "time.zone=UTC", "motor_speed.sign=1"])
    assert changed.columns["hook_load"] == Entry("Last", "t")
    assert (changed.time.zone, changed.columns["motor_speed"].sign, changed.questions) == ("UTC", 1, ())


@pytest.mark.parametrize("setting", ["hook_load", "hook_load.unit", "motor_speed.colour=red", "motor_speed.sign=3"])
def test_settings_that_say_nothing_are_refused(setting):
    with pytest.raises(InputError):
        with_settings(MAP, [setting])
