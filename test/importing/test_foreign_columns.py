"""Columns of a log that are none of the winch: what stands beside its channels was taken for one of them."""

import numpy as np
import pytest
from importing.logs import example, rows_of, write_text, write_workbook

from winch_friction.importing.propose import propose
from winch_friction.importing.units import bare_unit, header_readings, is_foreign

LEAN = ("wire_out", "wire_layer", "oil_temperature", "hook_load")


@pytest.fixture(scope="module")
def lean():
    """Rows of a log with the speed and the hydraulics alone, the load beside them."""
    rows = rows_of(example("test_02"))
    kept = [k for k, cell in enumerate(rows[0]) if not cell.startswith(("Seil", "Lage", "Öl"))]
    return [[row[k] for k in kept] for row in rows]


def proposal(lean, tmp_path, crane_150t, header, values=None):
    """What a column beside the winch's own becomes: its channels, and the proposal."""
    cells = values or [f"{20.0 + 3.0 * np.sin(0.01 * k):.2f}".replace(".", ",") for k in range(len(lean) - 1)]
    log = write_text(tmp_path / "log.csv", [[*row, cell] for row, cell in zip(lean, [header, *cells], strict=True)])
    made = propose([log], crane_150t, "crane_150t")
    return [name for name, entry in made.log_map.columns.items() if entry.source == header], made


@pytest.mark.parametrize(
    ("cell", "unit"),
    [("bar(a)", "bar(a)"), ("[bar(a)]", "bar(a)"), ("(t)", "t"), ("[m]", "m"), ("(a) (b)", "a) (b"), ("", "")],
)
def test_a_row_of_units_may_hold_brackets_inside(cell, unit):
    """`bar(a)` became `bar(a`, and both pressures were not found."""
    assert bare_unit(cell) == unit


@pytest.mark.parametrize("write", [write_text, write_workbook])
@pytest.mark.parametrize("unit", ["bar(a)", "kPa (abs)"])
def test_a_row_of_units_says_that_pressures_are_absolute(write, unit, tmp_path, crane_150t):
    names, *rows = rows_of(example("test_02"))
    bare = [each.partition(" [")[0] for each in names]
    units = [each.partition(" [")[2].rstrip("]") for each in names]
    units = [unit if each == "bar" else each for each in units]
    path = tmp_path / ("log.csv" if write is write_text else "log.xlsx")
    tenfold = lambda row: [
        f"{100 * float(c.replace(',', '.')):.0f}" if u.startswith("kPa") else c for c, u in zip(row, units, strict=True)
    ]
    made = propose([write(path, [bare, units, *map(tenfold, rows)])], crane_150t, "crane_150t")
    assert made.log_map.columns["main.pressure_a"].unit == unit


@pytest.mark.parametrize("unit", ["l/min", "m³/h", "cSt", "V", "kg/m3", "m/s²", "kWh", "mm²/s"])
def test_a_unit_of_what_no_channel_is_is_a_unit(unit):
    assert is_foreign(unit)
    assert header_readings(f"Flow ({unit})")[0] == ("Flow", unit)
    assert header_readings(f"Flow, {unit}")[0] == ("Flow", unit)


@pytest.mark.parametrize("unit", ["bar", "t", "raw", "1/min", "cm3/rev", "A", "PT-101", "m/s"])
def test_other_words_and_units_are_not_foreign(unit):
    assert not is_foreign(unit)


@pytest.mark.parametrize(
    "header",
    ["Flow (l/min)", "Wave height (m)", "Water depth [m]", "Auslegung [m]", "Hook height (m)", "Hakenhöhe [m]",
     "Krokhøyde [m]", "Draft (m)", "Tiefgang [m]", "Air temp (degC)", "Sea temp [°C]", "Cabinet temperature (°C)",
     "Boom angle (deg)", "Slew angle (deg)", "Engine speed (rpm)", "Auxiliary hook load (t)", "Max load (t)",
     "Hilfshub Last [t]"],
)  # fmt: skip
def test_what_is_beside_the_winch_is_no_channel_of_it(header, lean, tmp_path, crane_150t):
    channels, made = proposal(lean, tmp_path, crane_150t, header)
    assert channels == []
    assert header in made.log_map.unused
    assert made.problems == ()


def test_a_limit_of_the_load_is_not_the_load(lean, tmp_path, crane_150t):
    channels, made = proposal(lean, tmp_path, crane_150t, "SWL [t]", ["150"] * (len(lean) - 1))
    assert channels == []
    assert made.log_map.columns["hook_load"].source == "Hakenlast [t]"


def test_a_heave_beside_its_speed_is_no_wire(lean, tmp_path, crane_150t):
    """The unit alone told it, `the name 'Hiv' says nothing known`, although it says heave."""
    rows = [[*row, cell] for row, cell in zip(lean, ["Hiv hastighet [m/s]", *["0,1"] * (len(lean) - 1)], strict=True)]
    channels, made = proposal(rows, tmp_path, crane_150t, "Hiv [m]")
    assert channels == []
    assert made.log_map.columns["heave_velocity"].source == "Hiv hastighet [m/s]"


@pytest.mark.parametrize(
    ("header", "channel"),
    [("Seil raus [m]", "wire_out"), ("Tank temp [°C]", "oil_temperature"), ("Case oil temp [°C]", "oil_temperature"),
     ("Öl 1 [°C]", "oil_temperature"), ("Meter counter X7 [m]", "")],
)  # fmt: skip
def test_what_is_of_the_winch_is_still_found(header, channel, lean, tmp_path, crane_150t):
    rising = [f"{50.0 + 0.001 * k:.3f}".replace(".", ",") for k in range(len(lean) - 1)]
    assert proposal(lean, tmp_path, crane_150t, header, rising if channel == "wire_out" else None)[0] == [
        channel
    ] * bool(channel)


SIZES = {
    "Schluckvolumen [ccm]": (11.0, "2380 ccm is no usual size (4.3 to 247 ccm)"),
    "Windendrehzahl [1/min]": (0.0, "0 1/min is no usual size (9.55 to 4.77e+03 1/min)"),
    "Druck A [bar]": (100.0, "bar is no usual size (5 to 600 bar)"),
}


@pytest.mark.parametrize("header", SIZES)
def test_a_usual_size_is_told_in_the_unit_of_the_log(header, lean, tmp_path, crane_150t):
    """A log in cm^3/rev was answered in m^3/rad."""
    factor, said = SIZES[header]
    place = lean[0].index(header)
    scaled = lambda cell: f"{factor * float(cell.replace(',', '.')):.3f}".replace(".", ",")
    rows = [lean[0], *([*row[:place], scaled(row[place]), *row[place + 1 :]] for row in lean[1:])]
    made = propose([write_text(tmp_path / "log.csv", rows)], crane_150t, "crane_150t")
    assert any(said in each for each in made.problems), made.problems
