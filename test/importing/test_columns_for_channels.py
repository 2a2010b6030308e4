"""Which column of a log is taken for which channel: each rule on a few columns, with the scores by hand."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from winch_friction.importing import guess as of_importing
from winch_friction.importing.guess import Match, Slot, group_sets, in_si, matches, plausible_units
from winch_friction.importing.log import Log, LogColumn
from winch_friction.importing.names import name_concepts
from winch_friction.importing.units import CHANNEL_UNITS
from winch_friction.records.crane_file import load_crane

CRANE = load_crane("crane_150t")
WORM = load_crane("worm_drive")


def column(name, *values, unit="", note=""):
    return LogColumn(name, np.array(values or (1.0, 2.0), float), unit, note=note)


def found(*columns, crane=CRANE, taken=()):
    """Channel -> name of the column that was taken for it."""
    log = Log(Path("log.csv"), columns, {}, str)
    return {name: match.column.name for name, match in matches(log, crane, taken).items()}


# -- motor groups
def test_groups_drive_alone_or_those_that_are_not_more_than_the_largest():
    """3 active and 8 passive motors are the 11 of main."""
    assert group_sets(CRANE) == [("main",), ("active",), ("passive",), ("active", "passive")]
    assert group_sets(None) == [("main",), ("active", "passive"), ()]
    assert group_sets(WORM) == [()]
    assert group_sets(replace(WORM, groups={"main": 2})) == [()]  # an electric drive has none, whatever its file says


@pytest.mark.parametrize(
    ("counts", "several"),
    [
        ({"a": 4, "b": 4}, [("a", "b")]),  # none of them is all: those that there are
        ({"a": 4, "b": 2, "c": 1}, [("b", "c")]),
        ({"a": 4, "b": 2, "c": 2}, [("b", "c")]),
        ({"a": 6, "b": 2, "c": 2, "d": 2},
         [("b", "c"), ("b", "d"), ("c", "d"), ("b", "c", "d")]),
        ({"a": 1}, []),
    ],
)  # fmt: skip
def test_together_they_are_at_most_as_many_as_the_largest_group(counts, several):
    assert group_sets(replace(CRANE, groups=counts)) == [*((name,) for name in counts), *several]


@pytest.mark.parametrize(("said", "groups"), [
    (("Druck A", "Druck B", "Schluckvolumen"), {"main"}),
    (("Druck A Aktiv", "Druck B Aktiv", "Schluckvolumen Aktiv"), {"active"}),
    (("Druck A Aktiv", "Druck B Aktiv", "Schluckvolumen Aktiv", "Druck A Passiv", "Druck B Passiv",
      "Schluckvolumen Passiv"), {"active", "passive"}),
])  # fmt: skip
@pytest.mark.parametrize("turned", [False, True])
def test_a_log_is_of_the_groups_that_its_names_say(said, groups, turned):
    sizes = {"Druck A": 200.0, "Druck B": 25.0, "Schluckvolumen": 150.0}
    columns = [column(name, *[next(v for k, v in sizes.items() if name.startswith(k))] * 3) for name in said]
    taken = found(*(columns[::-1] if turned else columns))
    channels = {"Druck A": "pressure_a", "Druck B": "pressure_b", "Schluckvolumen": "displacement"}
    words = {"Aktiv": "active", "Passiv": "passive"}
    expected = {}
    for name in said:
        what = next(k for k in channels if name.startswith(k))
        group = words.get(name.removeprefix(what).strip(), "main")
        expected[f"{group}.{channels[what]}"] = name
    assert taken == expected
    assert {each.partition(".")[0] for each in taken} == groups


@pytest.mark.parametrize(
    ("bare", "group", "groups", "factor"),
    [
        ("torque", "main", 1, 1.0),
        ("torque active", "main", 1, 0.3),
        ("torque main", "main", 1, 1.0),
        ("torque", "active", 1, 0.75),
        ("torque active", "active", 1, 1.0),
        ("torque passive", "active", 1, 0.02),
        ("torque main", "active", 2, 0.02),
        ("torque main", "main", 2, 1.0),
        ("torque", "main", 2, 0.75),
        ("torque act", "passive", 2, 0.5),  # actual, or active
        ("torque act", "active", 2, 1.0),
        ("torque port", "port", 2, 1.0),  # a group of the crane's own
    ],
)
def test_how_well_a_name_fits_a_group(bare, group, groups, factor):
    slot = Slot(f"{group}.displacement", "displacement", group)
    assert of_importing._group_factor(name_concepts(bare), bare, slot, groups) == pytest.approx(factor)


@pytest.mark.parametrize(("bare", "port", "factor"), [
    ("pressure a", "a", 1.0), ("pressure a", "b", 0.02), ("pressure", "a", 0.6), ("pressure", "b", 0.6),
    ("hochdruck", "a", 1.0), ("hochdruck", "b", 0.02), ("niederdruck", "b", 1.0), ("pressure b passive", "b", 0.3),
])  # fmt: skip
def test_how_well_a_name_fits_a_port(bare, port, factor):
    slot = Slot(f"main.pressure_{port}", f"pressure_{port}", "main")
    assert of_importing._group_factor(name_concepts(bare), bare, slot, 1) == pytest.approx(factor)


# -- name and unit
def score(name, unit, channel, crane=CRANE, note=""):
    slot = Slot(channel, channel)
    return of_importing._reading_score(column(name, note=note), name, unit, slot, 1, crane.groups)


@pytest.mark.parametrize(
    ("name", "unit", "channel", "expected", "why"),
    [
        ("motor speed", "rpm", "motor_speed", 1.0, "name 'motor speed', unit 'rpm'"),
        ("motor speed", "", "motor_speed", 0.9, "name 'motor speed'"),
        ("motor speed", "bar", "motor_speed", 0.0, ""),
        ("motor speed", "m/s", "motor_speed", 0.0, ""),  # a speed of the rope has a slot of its own
        ("winch speed", "m/s", "rope_speed", 0.9, "name 'winch speed', unit 'm/s'"),
        ("winch speed", "rpm", "rope_speed", 0.0, ""),
        ("winch speed", "", "rope_speed", 0.0, ""),
        ("rope speed", "", "rope_speed", 0.9 * 0.9, "name 'rope speed'"),
        ("rpm", "bar", "oil_temperature", 0.0, ""),
        ("xyzzy", "degC", "oil_temperature", 0.22, "unit 'degC' alone, the name 'xyzzy' says nothing known"),
        ("valve", "degC", "oil_temperature", 0.0, ""),
        ("xyzzy", "t", "hook_load", 0.22, "unit 't' alone, the name 'xyzzy' says nothing known"),
        ("alarm", "t", "hook_load", 0.0, "name 'alarm', unit 't'"),
        ("energy", "t", "hook_load", 0.0, "name 'energy', unit 't'"),
        ("oil temperature", "t", "hook_load", 0.0, "name 'oil temperature', unit 't'"),  # another channel's name
        ("xyzzy", "%", "motor_speed", 0.0, ""),
        ("motor speed", "%", "motor_speed", 1.0, "name 'motor speed', unit '%'"),
        ("drum speed", "%", "drum_speed", 0.9, "name 'drum speed', unit '%'"),
        ("speed", "%", "drum_speed", 0.0, ""),
        ("motor speed", "1", "motor_speed", 0.0, ""),
        ("T", "", "oil_temperature", 0.0, ""),
        ("T oil", "", "oil_temperature", 0.9 * (0.75 * 0.9 + 0.15 + 0.1), "name 'T oil'"),
        ("hook_load", "kg", "hook_load", 1.2, "the contract's own name"),
        ("hook_load", "kg", "rope_force", 0.0, ""),
        ("speed", "rpm", "speed_reference", 0.0, ""),
        ("swash angle", "deg", "shaft_angle", 0.0, ""),
        ("temperature seawater", "degC", "oil_temperature", 0.0, ""),
    ],
)
def test_how_well_name_and_unit_fit_a_channel(name, unit, channel, expected, why):
    found, said = score(name, unit, channel)
    assert found == pytest.approx(expected)
    assert said == why


def test_a_description_says_less_than_a_name():
    """Nine tenths of what it would be as a name, and only where the name says less."""
    assert score("AI 7", "rpm", "motor_speed", note="motor speed")[0] == pytest.approx(0.9)
    assert score("motor speed", "rpm", "motor_speed", note="valve")[0] == pytest.approx(1.0)


@pytest.mark.parametrize(("unit", "told"), [
    ("t", {"hook_load", "rope_force"}), ("bar", {"pressure_a", "pressure_b"}), ("degC", {"oil_temperature"}),
    ("m/s", {"rope_speed", "heave_velocity"}), ("rpm", {"motor_speed", "drum_speed", "speed_reference"}),
    ("cm3/rev", {"displacement"}), ("kW", {"mechanical_power"}), ("A", {"motor_current"}),
    ("N*m", {"motor_torque", "load_torque"}), ("m", {"wire_out"}),
])  # fmt: skip
def test_a_unit_tells_the_channel_where_few_are_logged_in_it(unit, told):
    found = {channel for channel in CHANNEL_UNITS if of_importing._unit_tells(channel, unit)}
    assert found == told


# -- numbers
@pytest.mark.parametrize(
    ("channel", "unit", "value", "expected"),
    [
        ("motor_speed", "rpm", 60.0, 2.0 * np.pi),
        ("oil_temperature", "kelvin", 313.15, 40.0),
        ("oil_temperature", "degF", 104.0, 40.0),
        ("hook_load", "kN", 9.81, 1000.0),
        ("displacement", "%", 50.0, 0.5 * CRANE.max_displacement),
        ("motor_speed", "%", 50.0, 0.5),
        ("heave_velocity", "cm", 7.0, 7.0),  # a position: its speed has the same size at a ship's periods
        ("heave_velocity", "mm/s", 700.0, 0.7),
        ("wire_out", "bar", 1.0, None),
    ],
)
def test_numbers_become_si(channel, unit, value, expected):
    values = in_si(column("c", value), unit, channel, CRANE)
    assert (values is None) if expected is None else values == pytest.approx([expected], rel=1e-4)


def test_a_share_of_no_crane_is_a_share():
    assert in_si(column("c", 50.0), "%", "displacement", None) == pytest.approx([0.5])


@pytest.mark.parametrize(("value", "units"), [
    (180.0, ["bar", "psi", "0.1 bar"]), (1.8e7, ["Pa"]), (18.0, ["bar", "MPa"]),
    (2500.0, ["psi", "kPa", "0.1 bar"]), (1e9, []),
])  # fmt: skip
def test_a_pressure_without_a_unit_may_be_in_those_that_make_a_pressure_of_it(value, units):
    assert plausible_units(column("p", value, value), "", "pressure_a", CRANE) == units


def test_a_share_is_plausible_whatever_it_is_but_a_displacement_is_looked_at():
    huge = column("c", 1e6, 1e6)
    assert plausible_units(huge, "%", "motor_speed", CRANE) == ["%"]
    assert plausible_units(huge, "%", "displacement", CRANE) == []
    assert plausible_units(column("c", 80.0, 90.0), "%", "displacement", CRANE) == ["%"]
    assert plausible_units(column("c", 200.0, 210.0), "bar", "pressure_a", CRANE) == ["bar"]
    assert plausible_units(column("c", 1e5, 1e5), "bar", "pressure_a", CRANE) == []


@pytest.mark.parametrize(("unit", "value", "factor", "said"), [
    ("bar", 200.0, 1.0, ""), ("", 200.0, 1.0, ""), ("bar", 1e5, 0.4, "; but no usual size in 'bar'"),
    ("", 1e12, 0.4, "; but no usual size in any usual unit"),
])  # fmt: skip
def test_numbers_of_no_usual_size_speak_against_a_column(unit, value, factor, said):
    of = column("p", value, value)
    assert of_importing._with_size(0.8, of, unit, "pressure_a", CRANE) == (pytest.approx(0.8 * factor), said)


# -- one column each
def test_each_column_is_taken_once_and_by_what_fits_best():
    load, other = column("winch load", 55.0, 56.0, unit="t"), column("load", 50.0, 51.0, unit="t")
    assert found(other, load)["hook_load"] == "winch load"
    assert found(load, taken=["winch load"]) == {}
    assert found(column("hook load", np.nan, np.nan, unit="t")) == {}
    text = replace(load, text=np.array(["a", "b"], object))
    assert found(text) == {}
    assert found(column("xyzzy", 1e9, 2e9)) == {}
    assert found(column("xyzzy", 55.0, 56.0, unit="t")) == {"hook_load": "xyzzy"}  # by its unit alone
    assert found(column("winch load", 55.0, np.nan, unit="t")) == {"hook_load": "winch load"}
    assert found() == {}


def test_the_contracts_own_name_is_taken_before_any_other():
    own, other = column("motor_speed", 50.0, 60.0), column("motor speed [rad/s]", 50.0, 60.0)
    assert found(own, other)["motor_speed"] == "motor_speed"


def test_the_confidence_is_a_share_of_certainty():
    slot = Slot("hook_load", "hook_load")
    assert [Match(slot, column("c"), "", each, "").confidence for each in (0.5, 0.99, 1.2)] == [0.5, 0.99, 0.99]


@pytest.mark.parametrize(
    ("pairs", "kept"),
    [
        ([("pressure_a", "P #1", 0.5), ("pressure_b", "P #2", 0.9)], {"pressure_a", "pressure_b"}),
        ([("pressure_a", "P #1", 0.9), ("pressure_b", "P #2", 0.5)], {"pressure_a", "pressure_b"}),
        ([("hook_load", "T #1", 0.5), ("oil_temperature", "T #2", 0.9)], {"oil_temperature"}),
        ([("hook_load", "T #1", 0.9), ("oil_temperature", "T #2", 0.5)], {"hook_load"}),
        ([("hook_load", "T", 0.9), ("oil_temperature", "U", 0.5)], {"hook_load", "oil_temperature"}),
    ],
)
def test_columns_of_one_name_are_of_one_kind(pairs, kept):
    matched = {c: Match(Slot(c, c), column(name), "", worth, "") for c, name, worth in pairs}
    assert set(of_importing._of_one_kind(matched)) == kept
    assert len(matched) == 2


def test_slots_are_those_of_the_drive_and_of_its_groups():
    hydraulic = {each.name: (each.channel, each.group) for each in of_importing._slots(CRANE, ["active"])}
    assert hydraulic["active.pressure_b"] == ("pressure_b", "active")
    assert hydraulic["hook_load"] == ("hook_load", "")
    assert "motor_torque" not in hydraulic
    for crane in (WORM, None):
        names = [each.name for each in of_importing._slots(crane, [])]
        assert {"motor_torque", "mechanical_power", "motor_current", "load_torque", "motor_speed"} <= set(names)


UNITS = {"hook load": ("t", 55.0), "motor speed": ("rpm", 500.0), "pressure a": ("bar", 200.0),
         "pressure b": ("bar", 25.0), "displacement": ("cm3/rev", 150.0), "oil temperature": ("degC", 40.0),
         "wire layer": ("", 2.0), "wire out": ("m", 300.0)}  # fmt: skip
CHANNELS = {"hook load": "hook_load", "motor speed": "motor_speed", "pressure a": "main.pressure_a",
            "pressure b": "main.pressure_b", "displacement": "main.displacement",
            "oil temperature": "oil_temperature", "wire layer": "wire_layer", "wire out": "wire_out"}  # fmt: skip


@pytest.mark.parametrize("drawn", range(4))
def test_a_plain_log_is_read_whatever_order_its_columns_have(drawn):
    rng = np.random.default_rng(drawn)
    columns = [column(name, value, 1.01 * value, unit=unit) for name, (unit, value) in UNITS.items()]
    rng.shuffle(columns)
    assert found(*columns) == {channel: name for name, channel in CHANNELS.items()}


def test_a_group_lacks_what_no_column_shows():
    """Of a motor group one of three says less than no group at all, two say more."""
    one, other = column("Hochdruck", 200.0, 210.0, unit="bar"), column("Niederdruck", 25.0, 26.0, unit="bar")
    assert found(one, crane=None) == {}
    assert found(one, other, crane=None) == {"main.pressure_a": "Hochdruck", "main.pressure_b": "Niederdruck"}


@pytest.mark.parametrize("name", ["Druck A", "Pressure A", "pressure_a"])
def test_a_port_is_no_ampere_where_a_row_of_units_says_another(name):
    """A brake's pressure beside a torque was taken for the motor's current."""
    pressure = column(name, 20.0, 21.0, unit="bar")
    assert found(pressure, crane=WORM) == {}
    assert found(pressure, column("Motor current [A]", 20.0, 21.0), crane=WORM) == {
        "motor_current": "Motor current [A]"
    }


@pytest.mark.parametrize(
    ("header", "row", "unit", "channel"),
    [
        ("winch load [kg]", "", "kg", "hook_load"),
        ("hookload_t", "", "t", "hook_load"),
        ("motor speed [rpm]", "rad/s", "rpm", "motor_speed"),  # what stands at the name itself
        ("motor speed", "rad/s", "rad/s", "motor_speed"),
        ("motor speed", "", "", "motor_speed"),
    ],
)
def test_a_unit_is_that_of_the_header_or_else_of_the_row_of_units(header, row, unit, channel):
    value = 55e3 if unit == "kg" else 55.0
    log = Log(Path("log.csv"), (column(header, value, 1.01 * value, unit=row),), {}, str)
    assert {name: match.unit for name, match in matches(log, CRANE).items()} == {channel: unit}


@pytest.mark.parametrize("names", [("DRUCKA", "DRUCKB"), ("drucka_bar", "druckb_bar"), ("pressurea", "pressureb")])
@pytest.mark.parametrize("turned", [False, True])
def test_a_port_that_is_written_together_with_the_pressure_is_that_port(names, turned):
    """Both were a pressure of some port, and the first of them was A."""
    columns = [column(name, 200.0, 210.0, unit="bar") for name in names]
    taken = found(*(columns[::-1] if turned else columns))
    assert taken == {"main.pressure_a": names[0], "main.pressure_b": names[1]}
