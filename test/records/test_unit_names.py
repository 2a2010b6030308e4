"""Units as people write them: every spelling of the table is the unit it stands under, ambiguous ones are refused."""

import time

import pytest

from winch_friction.physics.errors import InputError
from winch_friction.records.runs import read_run
from winch_friction.records.unit_names import AMBIGUOUS, SPELLINGS, conversion_to_si, plain_spelling

# unit, SI unit of the column, what one of it is, what none of it is
KNOWN = [
    ("cm3/rev", "m^3/rad", 1.591549430918953e-07, 0.0),
    ("ccm", "m^3/rad", 1.591549430918953e-07, 0.0),
    ("cm³/U", "m^3/rad", 1.591549430918953e-07, 0.0),
    ("1/min", "rad/s", 0.10471975511965977, 0.0),
    ("min⁻¹", "rad/s", 0.10471975511965977, 0.0),
    ("U / min", "rad/s", 0.10471975511965977, 0.0),
    ("RPM", "rad/s", 0.10471975511965977, 0.0),
    ("te", "kg", 1000.0, 0.0),
    ("short_ton", "kg", 907.18474, 0.0),
    ("barg", "Pa", 1e5, 0.0),
    ("bara", "Pa", 1e5, -101325.0),
    ("°C", "degC", 1.0, 0.0),
    ("K", "degC", 1.0, -273.15),
    ("kN", "N", 1000.0, 0.0),
    ("kg", "N", 9.80665, 0.0),
    ("mm/s", "m/s", 1e-3, 0.0),
    ("%", "1", 0.01, 0.0),
    ("U", "rad", 6.283185307179586, 0.0),
]


@pytest.mark.parametrize(("unit", "si_unit", "scale", "offset"), KNOWN)
def test_a_unit_as_people_write_it(unit, si_unit, scale, offset):
    assert conversion_to_si(unit, si_unit, "here") == (pytest.approx(scale, rel=1e-9), pytest.approx(offset))


@pytest.mark.parametrize("si_unit", SPELLINGS)
def test_no_spelling_stands_for_two_units(si_unit):
    names = SPELLINGS[si_unit].items()
    spelled = [each for name, others in names for each in {plain_spelling(each) for each in (name, *others)}]
    assert sorted(set(spelled)) == sorted(spelled)
    assert not set(spelled) & set(AMBIGUOUS.get(si_unit, ()))


@pytest.mark.parametrize(("unit", "si_unit"), [("ton", "kg"), ("Tons", "kg"), ("1/s", "rad/s"), ("ton", "N")])
def test_an_ambiguous_unit_is_refused_with_its_choices(unit, si_unit):
    with pytest.raises(InputError, match="ambiguous; write"):
        conversion_to_si(unit, si_unit, "here")


def run_text(header: str) -> str:
    return header + "\n0,10,215,20,215,55\n0.02,11,215,20,215,55\n2,12,214,20,215,55\n"


def test_a_run_file_with_a_ton_is_refused(tmp_path):
    path = tmp_path / "run.csv"
    columns = "time [s],motor_speed [rpm],main.pressure_a [bar],main.pressure_b [bar],main.displacement [ccm],"
    path.write_text(run_text(columns + "hook_load [ton]"))
    with pytest.raises(InputError, match="short_ton"):
        read_run(path)
    path.write_text(run_text(columns + "hook_load [te]"))
    assert read_run(path)["hook_load"][0] == 55_000.0


def test_columns_without_a_unit_that_no_sensor_gives_are_refused_all_at_once(tmp_path):
    path = tmp_path / "nounits.csv"
    path.write_text(run_text("time,motor_speed,main.pressure_a,main.pressure_b,main.displacement,hook_load"))
    with pytest.raises(InputError) as refused:
        read_run(path)
    for said in ("main.displacement [cm^3/rev]", "main.pressure_a [bar]", "hook_load [t]"):
        assert said in str(refused.value)


def test_columns_without_a_unit_that_look_like_another_are_remarked(tmp_path):
    path = tmp_path / "nounits.csv"
    path.write_text(run_text("time,motor_speed,main.pressure_a,main.pressure_b,main.displacement [ccm],hook_load"))
    remarks = " ".join(read_run(path).warnings)
    assert "215 Pa at most; if it is bar" in remarks
    assert "hook_load [t]" in remarks


@pytest.mark.parametrize(
    "unit", ["rad/s**9**9**9**9", "10**10**10 rad/s", "9**(9**(9**9)) Pa", "(9**99)**99 bar", "9^9^9^9", "(" * 3000]
)
def test_a_unit_that_is_a_sum_to_work_out_is_refused_at_once(unit):
    """`9**9**9**9` had kept a reader busy for ever."""
    began = time.monotonic()
    with pytest.raises(InputError, match="cannot be read as rad/s"):
        conversion_to_si(unit, "rad/s", "log.csv")
    assert time.monotonic() - began < 2.0


PRESSURES = [("kPa(g)", 1e3, 0.0), ("bar (a)", 1e5, -101325.0), ("bar(Ü)", 1e5, 0.0), ("MPa abs.", 1e6, -101325.0),
             ("bar, abs", 1e5, -101325.0), ("mbar rel", 100.0, 0.0), ("Pa_absolute", 1.0, -101325.0)]  # fmt: skip


@pytest.mark.parametrize(("unit", "scale", "offset"), PRESSURES)
def test_a_pressure_says_from_what_it_counts_in_any_unit(unit, scale, offset):
    assert conversion_to_si(unit, "Pa", "here") == (pytest.approx(scale), pytest.approx(offset))


@pytest.mark.parametrize("unit", ["kg/cm2 abs", "(a)", "abs", "kNabs"])
def test_what_is_no_pressure_from_the_vacuum_is_refused(unit):
    with pytest.raises(InputError, match="cannot be read as Pa"):
        conversion_to_si(unit, "Pa", "here")
