"""Map files: what is written is read back as it was, the published schema and the reader agree."""

from pathlib import Path

import numpy as np
import pytest
import yaml

from winch_friction.importing import mapping
from winch_friction.importing.carry_out import convert
from winch_friction.importing.log import Log, number_column
from winch_friction.importing.map_schema import map_schema
from winch_friction.importing.map_text import map_text
from winch_friction.importing.mapping import LARGEST, Entry, LogMap, load_map, map_from_content, with_settings
from winch_friction.importing.time_base import TimeBase
from winch_friction.physics.errors import InputError
from winch_friction.records.strict_yaml import config_directory

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
    "schema: winch_friction.map/1\ncolumns: {motor_speed: {from: n, unit: rad, differentiate: -2.0}}",
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


def converted(entry, time, values, channel="motor_speed", crane=None):
    """A channel of a log of one column in SI, and what is wrong with it."""
    log = Log(Path("log.csv"), (number_column("t", time), number_column("x", values)), {}, str)
    done = convert(log, LogMap({channel: entry}, ("t",), TimeBase("seconds")), crane)
    return done.columns.get(channel), done.problems


@pytest.mark.parametrize(
    ("time", "said"),
    [
        (0.02 * np.arange(10), "needs 16 rows or more"),
        (np.repeat(0.04 * np.arange(100), 2), "set time.spread"),
        (np.zeros(200), "set time.spread"),
        (0.02 * np.arange(200) + 5.0 * (np.arange(200) > 100), "a gapless position"),
    ],
    ids=["short", "ticks", "no time", "gap"],
)
def test_a_position_that_gives_no_speed_is_refused_in_one_line(time, said):
    """The filter's own errors came as tracebacks, and a gap was smoothed over."""
    entry = Entry("x", "rad", differentiate=2.0)
    _, problems = converted(entry, time, np.sin(time))
    assert [said in each for each in problems] == [True]
    speed, problems = converted(entry, 0.02 * np.arange(500), np.sin(0.02 * np.arange(500)))
    assert problems == ()
    assert np.abs(speed - np.cos(0.02 * np.arange(500)))[50:-50].max() < 0.01


def test_what_is_measured_at_the_drum_is_taken_to_the_motors(crane_150t):
    """A load's torque at the drum was taken for one at the motor: 250 times too much, without a word."""
    values, time = np.array([2500.0, 5000.0]), np.array([0.0, 1.0])
    found, problems = converted(Entry("x", "N*m", at="drum"), time, values, "load_torque", crane_150t)
    assert (found.tolist(), problems) == ([10.0, 20.0], ())
    _, (said,) = converted(Entry("x", "t", at="drum"), time, values / 1e3, "hook_load", crane_150t)
    assert "at: drum is for motor_speed" in said
    _, (said,) = converted(Entry("x", "%", of="0 cm^3/rev"), time, values, "main.displacement", crane_150t)
    assert "a share is of something above 0" in said


def test_how_a_log_is_read_is_not_set_from_the_command_line():
    with pytest.raises(InputError, match="stands in the map file"):
        with_settings(MAP, ["log.delimiter=;"])


@pytest.mark.parametrize("setting", ["hook_load", "hook_load.unit", "motor_speed.colour=red", "motor_speed.sign=3"])
def test_settings_that_say_nothing_are_refused(setting):
    with pytest.raises(InputError):
        with_settings(MAP, [setting])


def mapped(text):
    """A map of one channel and what else is said in it."""
    return map_from_content(yaml.safe_load(f"schema: winch_friction.map/1\n{text}"), "map")


def test_what_a_map_does_not_say_is_usual():
    """One that a person wrote has no confidence to doubt, and no cell is missing by itself."""
    found = mapped("columns: {motor_speed: {from: n}, wire_layer: {constant: '2'}}")
    assert found == LogMap({"motor_speed": Entry("n"), "wire_layer": Entry("", constant="2")})
    assert (found.time, found.bad_cells, found.time_confidence) == (TimeBase("seconds", unit="s"), "missing", 1.0)
    entry = found.columns["motor_speed"]
    assert (entry.unit, entry.sign, entry.factor, entry.add, entry.at, entry.confidence) == (
        "",
        1,
        1.0,
        0.0,
        "motor",
        1.0,
    )


def test_one_name_needs_no_list_and_a_factor_may_turn_a_channel_round():
    found = mapped(
        "columns: {hook_load: {from: m, factor: -0.5}}\ntime: {from: Uhrzeit}\nunused: Wind\nquestions: why?"
    )
    assert (found.time_from, found.unused, found.questions) == (("Uhrzeit",), ("Wind",), ("why?",))
    assert found.columns["hook_load"].factor == -0.5
    for wrong in ("unused: [1]", "time: {from: {a: b}}"):
        with pytest.raises(InputError, match="must be a list of texts"):
            mapped(f"columns: {{hook_load: {{from: m}}}}\n{wrong}")


@pytest.mark.parametrize("log", ["clocks: many", "decimal: ''", "delimiter: ';;'", "names_row: first"])
def test_how_a_log_is_read_is_one_of_what_there_is(log):
    with pytest.raises(InputError):
        mapped(f"columns: {{hook_load: {{from: m}}}}\nlog: {{{log}}}")
    kept = mapped("columns: {hook_load: {from: m}}\nlog: {clocks: held, thousands: '', sheet: A, names_row: 2.0}").log
    assert kept == {"clocks": "held", "thousands": "", "sheet": "A", "names_row": 2}
    assert isinstance(kept["names_row"], int)


def test_a_log_in_place_of_its_map_is_refused_unread(tmp_path, monkeypatch):
    content = {"schema": "winch_friction.map/1", "columns": {"hook_load": {"from": "m"}}}
    monkeypatch.setattr(mapping, "read_yaml", lambda path: content)
    path = tmp_path / "log.yaml"
    path.write_bytes(b"x" * LARGEST)
    assert load_map(path).columns == {"hook_load": Entry("m")}
    path.write_bytes(b"x" * (LARGEST + 1))
    with pytest.raises(InputError, match=f"log.yaml: {LARGEST >> 10} kB is no map; the largest is {LARGEST >> 10} kB"):
        load_map(path)
    with pytest.raises(InputError, match=r"--propose --crane CRANE --map .*none.yaml"):
        load_map(tmp_path / "none.yaml")


def test_a_map_shows_what_is_to_be_known_of_it_and_nothing_else():
    plain = map_text(LogMap({"motor_speed": Entry("Drehzahl Ö", "1/min", differentiate=0.25)}))
    for key in ("sign", "factor", "add", "of", "at", "constant"):
        assert f"\n    {key}:" not in plain
    assert '    from: "Drehzahl Ö"\n' in plain  # as its writer wrote it
    assert "differentiate: 0.25 " in plain
    for key in ("crane", "questions", "log", "time", "unused"):
        assert f"\n{key}:" not in plain
    assert "columns: {}   # none was found" in map_text(LogMap({}))
    said = map_text(LogMap({"motor_speed": Entry("n")}, ("t",), TimeBase("datetime"), log={"clocks": "held"}))
    assert "  order: ymd " in said
    assert "\n  unit:" not in said
    assert 'clocks: "held"   # held or lines' in said
    assert '\n  zone: ""' in said
    assert "\n  order:" not in map_text(LogMap({"motor_speed": Entry("n")}, ("t",), TimeBase("seconds")))
