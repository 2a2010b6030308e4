"""Units as people write them: every spelling of the table is the unit it stands under, ambiguous ones are refused."""

import re
import time

import pytest

from winch_friction.physics.errors import InputError
from winch_friction.records.runs import read_run
from winch_friction.records.unit_names import (
    AMBIGUOUS,
    SPELLINGS,
    conversion_to_si,
    known_spelling,
    pint_name,
    plain_spelling,
)

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


# what people write for a unit, by the column's SI unit: once more beside the table, of which one may slip by a line
WRITTEN = {
    "rad/s": {
        "rpm": "1/min; min-1; /min; U/min; upm; Umdr/min; r/min; rev/min; r.p.m.; o/min; omdr/min; tr/min; giri/min; "
        "rot/min; omw/min; toeren/min; tpm; tr/mn; tours/min; varv/min; v/min; vueltas/min; obr/min; ot/min; d/dak; "
        "dev/dak; об/мин; ob/min; opm",
        "rev/s": "U/s; rps; r/s; rev/s; umdr/s; omdr/s; o/s; rev/sec", "rad/s": "rad/sec; rad/sek; rads; rad s-1",
        "deg/s": "°/s; deg/sec; grad/s; grader/s",
    },
    "Pa": {
        "bar": "barg; bar g; bar(g); bar_g; bar-g; bar ü; bar ue; barü; bar gauge; bar rel; baro; bar overtrykk; bars",
        "bar_absolute": "bara; bar a; bar(a); bar_a; bar-a; bar abs; bar(abs); bar absolute; bar absolut",
        "psi": "psig; psi g; psi(g); lbf/in2; lbf/in^2", "psi_absolute": "psia; psi a; psi(a)",
        "kgf/cm^2": "kp/cm2; kp/cm^2; kgf/cm2; kg/cm2; kg/cm²", "MPa": "N/mm2; N/mm²",
    },
    "m^3/rad": {
        "cm^3/rev": "ccm; ccm/U; ccm/rev; ccm/r; ccm/umdr; ccm/omdr; ccm/o; cc; cc/rev; cc/r; cc/u; cm3/rev; cm3/u; "
        "cm3/r; cm3/o; cm3/omdr; cm³/U; cm^3/r; cm^3/o; cm3/omw; cc/omw; cm3/tr; cc/tr; cm3/varv; cm3/giro; cm3/obr; "
        "cm3/ot; cm3/rot; cm3/dev; см3/об; cm3/ob; ml/rev; ml/u; ml/r; cm3/Umdrehung",
        "l/rev": "l/u; l/r; liter/u; dm3/rev; dm³/rev; l/omdr", "in^3/rev": "in3/rev; cu in/rev; cuin/rev; cir",
        "cm^3/rad": "cm3/rad; ccm/rad; cc/rad", "m^3/rev": "m3/rev; m3/u; m³/U", "m^3/rad": "m3/rad",
    },
    "kg": {
        "metric_ton": "t; te; to; tonne; tonnes; Tonnen; tonn; mt; metric ton; metric t; metrische Tonnen; tonne(s)",
        "pound": "lb; lbs", "gram": "g", "kg": "kgs; kilo; Kilogramm", "long_ton": "long ton; uk ton; imperial ton",
        "short_ton": "short ton; us ton; US tons; ston; sh tn; sh.tn; shtn; sh ton; sht",
    },
    "N": {
        "kgf": "kp; kgf; Kilopond; kg; kgs", "metric_ton * gravity": "tf; t; te; tonnef; to; Mp; tonne; tonn; Tonnen",
        "kN": "kn", "decanewton": "daN", "meganewton": "MN", "lbf": "lbs; lb",
    },
    "N*m": {
        "N*m": "Nm; N_m; N m; N.m; N·m", "kN*m": "kNm; kN m; kN.m", "mN*m": "mNm; mN m; mN.m", "N*cm": "Ncm",
        "lbf*ft": "lb-ft; lbft; ft-lb; ftlb; lbf-ft; ft lbf",
    },
    "degC": {
        "degC": "°C; C; ℃; deg C; Grad C; Grad Celsius; celsius; gr C; oC; grader C", "kelvin": "K",
        "degF": "°F; F; Fahrenheit; deg F",
    },
    "m/s": {"m/s": "mps; m/sec; m/sek; m s-1", "m/min": "m/minute", "mm/s": "mm/sec", "knot": "kn; kt; kts; knop"},
    "s": {
        "s": "sec; secs; sek; Sekunden; sekunder; seconds", "ms": "msec; msek; Millisekunden; millisek",
        "us": "µs; usec",
        "minute": "min; Minuten; minutter; mins", "hour": "h; std; Stunden; timer; hrs; hr", "day": "d; Tage; dager",
        "ns": "nsec",
    },
    "m": {"m": "Meter; metre; mtr", "foot": "ft; feet"},
    "rad": {"deg": "°; Grad; grader; degrees", "rev": "U; Umdr; omdr; turns; revs"},
    "W": {"kW": "kw", "metric_horsepower": "PS; hk", "W": "Watt", "MW": "Megawatt"},
    "A": {"A": "amp; amps; Ampere", "mA": "milliampere"},
    "1": {"percent": "%; pct; Prozent; prosent; procent", "dimensionless": "-; 1; –; none"},
}  # fmt: skip


@pytest.mark.parametrize("si_unit", SPELLINGS)
def test_each_word_for_a_unit_means_that_unit(si_unit):
    found = {name: [pint_name(each, si_unit) for each in words.split("; ")] for name, words in WRITTEN[si_unit].items()}
    assert found == {name: [name] * len(each) for name, each in found.items()}


@pytest.mark.parametrize(
    ("unit", "si_unit", "scale"),
    [("tf", "N", 9806.65), ("t", "N", 9806.65), ("daN", "N", 10.0), ("ft-lb", "N*m", 1.3558179483), ("PS", "W", 735.5)],
)
def test_a_unit_of_force_or_work_has_standard_gravity(unit, si_unit, scale):
    assert conversion_to_si(unit, si_unit, "") == (pytest.approx(scale, rel=2e-6), 0.0)


@pytest.mark.parametrize("spaced", [" abs", " (a)", "(abs)", " absolute"])
@pytest.mark.parametrize(
    ("unit", "scale"),
    [("bar", 1e5), ("psi", 6894.757293168), ("Pa", 1.0), ("hPa", 100.0), ("mbar", 100.0), ("kPa", 1e3), ("MPa", 1e6)],
)
def test_in_a_vacuum_every_unit_of_pressure_shows_an_atmosphere_below_the_air(unit, scale, spaced):
    assert conversion_to_si(unit + spaced, "Pa", "") == (pytest.approx(scale), pytest.approx(-101325.0))


@pytest.mark.parametrize(
    ("unit", "si_unit", "scale", "offset"),
    [
        ("0.1 bar", "Pa", 1e4, 0.0), ("0,1 bar", "Pa", 1e4, 0.0), ("x0.01 m", "m", 0.01, 0.0),
        (".1 t", "kg", 100.0, 0.0),
        ("100 us", "s", 1e-4, 0.0), ("x10 mm", "m", 0.01, 0.0), ("100000 Pa", "Pa", 1e5, 0.0),
        ("0.1 °C", "degC", 0.1, 0.0), ("0.1 K", "degC", 0.1, -273.15), ("0.1 bar abs", "Pa", 1e4, -101325.0),
        ("0.000001 m", "m", 1e-6, 0.0),
    ],
)  # fmt: skip
def test_a_controllers_whole_numbers_are_counted_from_the_units_own_zero(unit, si_unit, scale, offset):
    assert conversion_to_si(unit, si_unit, "") == (pytest.approx(scale), pytest.approx(offset))


@pytest.mark.parametrize(("unit", "plain"), [(" [kN] ", "kn"), ("Umdr.", "umdr"), ("m  /  s", "m/s"), ("cm³", "cm^3"),
                                             ("N·m", "n*m"), ("min⁻¹", "min-1"), ("µs", "us"), ("º", "°")])  # fmt: skip
def test_a_spelling_is_compared_without_what_only_its_writer_meant(unit, plain):
    assert plain_spelling(unit) == plain


@pytest.mark.parametrize(
    ("si_unit", "worth"),
    [("kg", [1000.0, 907.18474, 1016.0469088]), ("N", [9806.65, 8896.443, 9964.016]), ("rad/s", [1.0, 6.2831853])],
)
def test_what_an_ambiguous_unit_may_mean_can_be_written_as_is_said(si_unit, worth):
    for unit, choices in AMBIGUOUS[si_unit].items():
        said = re.findall(r"'([^']+)'", choices)
        assert [conversion_to_si(each, si_unit, "")[0] for each in said] == pytest.approx(worth, rel=1e-6), unit


@pytest.mark.parametrize(("si_unit", "usual"), [("rad", "deg"), ("s", "ms"), ("N*m", "kN*m"), ("Pa", "bar"),
                                                ("kg", "t"), ("rad/s", "rpm"), ("m^3/rad", "cm^3/rev")])  # fmt: skip
def test_who_writes_no_unit_is_shown_the_one_that_people_write(si_unit, usual):
    with pytest.raises(InputError, match=re.escape(f"p: unit 'candela' cannot be read as {si_unit}, e.g. '{usual}'")):
        conversion_to_si("candela", si_unit, "p")


@pytest.mark.parametrize("spelling", ["bar(g)", "kPa (abs)", "psi gauge"])
def test_a_pressure_counted_from_somewhere_is_a_spelling_of_pressures_alone(spelling):
    assert known_spelling(spelling, "Pa")
    assert not any(known_spelling(spelling, other) for other in ("kg", "m", "rad/s", "N*m"))
