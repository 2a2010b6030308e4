"""Kinds of logs that strangers bring, and what `import` must make of each.

Beside the drawn variants, which mix a few dialects at random, these are single habits of loggers, countries and people.
"""
# ruff: noqa: E501  one kind a line: a table that is read down

from campaign.import_files import (
    ahc_test,
    mat5_struct,
    mat73,
    mf4_of_two_rates,
    packed,
    parquet_by_dates,
    parquet_of_strings,
    tdms,
    xlsx_offset,
    zipped,
)
from campaign.import_writers import (
    ABBREVIATED_DE,
    ABBREVIATED_NO,
    BARE,
    CAMEL,
    DA,
    DE,
    EN,
    ES,
    FR,
    KG,
    NL,
    NO,
    SV,
    UNDERSCORED,
    UNITS,
    Kind,
    appended,
    as_csv,
    dates,
    days,
    epoch,
    holes,
    of_drum,
    of_line,
    renamed,
    repeated_header,
    rows_of,
    scaled,
    stamp,
    swapped,
    thousands,
    timed,
    two_orders,
    with_columns,
    with_lines,
)


def kinds() -> list[Kind]:
    """Every kind."""
    return [*_languages(), *_clocks(), *_texts(), *_files(), *_units(), *_mistakes()]


def _languages() -> list[Kind]:
    return [
        Kind("Dutch", as_csv(NL, ";", ",")),
        Kind("Danish", as_csv(DA, ";", ",", KG, encoding="cp1252")),
        Kind("French", as_csv(FR, "\t", ",", KG, encoding="cp1252")),
        Kind("Swedish", as_csv(SV, ";", ",", KG)),
        Kind("Spanish", as_csv(ES, ";", ",", KG)),
        Kind("Norwegian", as_csv(NO, ";", ",")),
        Kind("Norwegian, shortened, units behind underscores", as_csv(ABBREVIATED_NO, "\t")),
        Kind("German symbols over units", as_csv(ABBREVIATED_DE, ";", ",")),
        Kind("units behind underscores", as_csv(UNDERSCORED)),
        Kind("camel case with units", as_csv(CAMEL)),
        Kind("upper case", as_csv(tuple(h.upper() for h in UNDERSCORED))),
        Kind(
            "tag names alone",
            as_csv(("t", "ST101", "PT102", "PT103", "ZT104", "WT105", "LT106", "XT107")),
            ("motor_speed", "pressure"),
        ),  # fmt: skip
        Kind(
            "hoist and lower side",
            with_columns(renamed({2: "Pressure hoist side [bar]", 3: "Pressure lower side [bar]"})),
        ),
        Kind("paths of a controller", with_columns(lambda c: [(f"PLC1.Winch.{h}", cells) for h, cells in c])),
        Kind("groups as numbers", ahc_test({"active": "HM1", "passive": "HM2"}), base="ahc_160"),
        Kind(
            "groups as numbers, the passive first",
            ahc_test({"passive": "HM1", "active": "HM2"}),
            ("group",),
            base="ahc_160",
        ),
        Kind("groups as AHC and PHC", ahc_test({"active": "AHC", "passive": "PHC"}), base="ahc_160"),
    ]


def _clocks() -> list[Kind]:
    return [
        Kind("epoch ms", timed("Timestamp", epoch(1e3, 0))),
        Kind("epoch us", timed("Timestamp", epoch(1e6, 0))),
        Kind("epoch ns", timed("Timestamp", epoch(1e9, 0))),
        Kind("Excel serial dates", timed("Date", days(25569.0))),
        Kind("MATLAB datenum", timed("Time", days(719529.0))),
        Kind("day first, two digits of year", timed("Time", dates("%d/%m/%y %H:%M:%S.%f"))),
        Kind("day first with dots", timed("Zeit", dates("%d.%m.%Y %H:%M:%S.%f"))),
        Kind("American with AM", timed("Time", lambda t: [f"{stamp(s):%m/%d/%Y %I:%M:%S}.{stamp(s).microsecond // 1000:03d} AM" for s in t])),
        Kind("month in words", timed("Time", dates("%d-%b-%Y %H:%M:%S.%f"))),
        Kind("ISO with zone", timed("Time", lambda t: [f"{stamp(s).isoformat(timespec='milliseconds')}+01:00" for s in t])),
        Kind("ISO basic", timed("Time", dates("%Y%m%dT%H%M%S.%f"))),
        Kind("time of day with a comma", timed("Uhrzeit", lambda t: [f"{stamp(s):%H:%M:%S},{stamp(s).microsecond // 1000:03d}" for s in t])),
        Kind("hours since the start", timed("Elapsed [h]", lambda t: [f"{s / 3600.0:.9f}" for s in t])),
        Kind("minutes", timed("Time (min)", lambda t: [f"{s / 60.0:.7f}" for s in t])),
        Kind("two starts in one file", with_lines(appended), ("time",)),
    ]  # fmt: skip


def _texts() -> list[Kind]:
    bad = ("NaN", "---", "#N/A", "1.#QNAN", "Bad", "n.a.", "NULL", "No Data", "#DIV/0!", "?")
    return [
        Kind("BOM", as_csv(EN, encoding="utf-8-sig")),
        Kind("UTF-16 without mark", as_csv(DE, "\t", ",", encoding="utf-16-le")),
        Kind("UTF-16 big-endian", as_csv(DE, "\t", ",", encoding="utf-16-be")),
        Kind("old Mac line ends", as_csv(EN, end="\r")),
        Kind("trailing row of units", with_lines(lambda rows: [*rows, ",".join(UNITS)], BARE)),
        Kind("row of units in parentheses", with_lines(lambda rows: [rows[0], ",".join(f"({u})" for u in UNITS), *rows[1:]], BARE)),
        Kind("names, units and descriptions", with_lines(lambda rows: [rows[0], ",".join(UNITS), "x," * 7 + "x", *rows[1:]], BARE)),
        Kind("header twice", with_lines(lambda rows: [rows[0], *rows])),
        Kind("header again in the middle", with_lines(repeated_header)),
        Kind("header behind a #", with_lines(lambda rows: ["# logger 3.1", f"# {rows[0]}", *rows[1:]])),
        Kind("one name twice", with_columns(renamed({2: "Pressure [bar]", 3: "Pressure [bar]"})), ("bear one name",)),
        Kind("a delimiter at every end", with_lines(lambda rows: [row + ";" for row in rows], EN, ";")),
        Kind("every cell quoted", with_lines(lambda rows: [",".join(f'"{c}"' for c in row.split(",")) for row in rows])),
        Kind("blanks around cells", with_lines(lambda rows: [" ; ".join(row.split(";")) for row in rows], EN, ";")),
        Kind("fixed width", with_lines(lambda rows: ["  ".join(f"{c:>14}" for c in row.split(",")) for row in rows], UNDERSCORED)),
        Kind("a long preamble", with_lines(lambda rows: [f"Parameter {k}: {k},{k}" for k in range(40)] + rows, EN, ";")),
        Kind("a summary at the end", with_lines(lambda rows: [*rows, "", "Samples:,1711", "Max:,1700"])),
        Kind("thousands with a point", with_columns(thousands(".", ","), EN, ";")),
        Kind("thousands with a blank", with_columns(thousands("\u00a0", ","), EN, ";")),
        Kind("thousands with an apostrophe", with_columns(thousands("'", "."), EN, ";")),
        Kind("decimal comma with exponent", with_columns(lambda c: [(h, [f"{float(x):.6E}".replace(".", ",") for x in cells]) for h, cells in c], EN, ";")),
        Kind("spellings of no value", with_columns(holes(bad))),
        Kind("-9999 for no value", with_columns(holes(("-9999",))), ("pressure", "-9999")),
        Kind("units inside the cells", with_columns(lambda c: [c[0], *((h, [f"{x} {u}" for x in cells]) for (h, cells), u in zip(c[1:7], UNITS[1:], strict=False))], BARE)),
    ]  # fmt: skip


def _files() -> list[Kind]:
    return [
        Kind("gz, tab, cp1252", packed),
        Kind("zip", zipped),
        Kind("parquet with dates as index", parquet_by_dates),
        Kind("parquet of strings", parquet_of_strings),
        Kind("mat v5, a struct of columns", mat5_struct),
        Kind("mat v7.3", mat73),
        Kind("tdms with waveform timing", tdms, step=0),
        Kind("mf4 of two rates", mf4_of_two_rates, loose={"hook_load": 0.02, "wire_out": 0.05}),
        Kind("xlsx, second sheet, offset", xlsx_offset),
        Kind("two files in other orders", two_orders),
    ]


def _units() -> list[Kind]:
    return [
        Kind("displacement in percent", with_columns(scaled(4, 100.0 / 215.0, "Displacement [%]", 3))),
        Kind("displacement as a share", with_columns(scaled(4, 1.0 / 215.0, "Swash (-)", 5))),
        Kind("displacement in inch", with_columns(scaled(4, 0.0610237, "Displacement [in3/rev]"))),
        Kind("displacement in litres", with_columns(scaled(4, 1e-3, "Displacement [l/rev]", 6))),
        Kind("speed of the drum", with_columns(of_drum)),
        Kind("speed of the rope", with_columns(of_line)),
        Kind("speed in 1/s", with_columns(scaled(1, 1.0 / 60.0, "Motor speed [1/s]")), ("ambiguous",)),
        Kind("speed in degrees", with_columns(scaled(1, 6.0, "Motor speed [deg/s]"))),
        Kind("psi", as_csv((*EN[:2], "Pressure A (psi)", "Pressure B (psi)", *EN[4:]), factors={"pressure": 1.450377e-4})),
        Kind("psig", as_csv((*EN[:2], "PA_PSIG", "PB_PSIG", *EN[4:]), factors={"pressure": 1.450377e-4})),
        Kind("MPa", as_csv((*EN[:2], "p_A_MPa", "p_B_MPa", *EN[4:]), factors={"pressure": 1e-6}, digits=4)),
        Kind("kN", as_csv((*EN[:5], "Hook load [kN]", *EN[6:]), factors={"hook_load": 9.80665e-3})),
        Kind("daN", as_csv((*EN[:5], "Hook load [daN]", *EN[6:]), factors={"hook_load": 0.980665})),
        Kind("lb", as_csv((*EN[:5], "Hook load (lb)", *EN[6:]), factors={"hook_load": 2.2046226})),
        Kind("klbs", as_csv((*EN[:5], "Hook load [klbs]", *EN[6:]), factors={"hook_load": 2.2046226e-3}, digits=4)),
        Kind("kip", as_csv((*EN[:5], "Hook load [kip]", *EN[6:]), factors={"hook_load": 2.2046226e-3}, digits=4)),
        Kind("tons", as_csv((*EN[:5], "Hook load [tons]", *EN[6:])), ("ambiguous",)),
        Kind("feet of wire", as_csv((*EN[:6], "Wire out [ft]", *EN[7:]), factors={"wire_out": 3.2808399})),
        Kind("no units, millimetres of wire", as_csv(BARE, factors={"wire_out": 1e3})),
        Kind("1 Hz", lambda run, folder: as_csv(EN)(rows_of(run, slice(None, None, 20)), folder), step=20),
        Kind("4 Hz", lambda run, folder: as_csv(EN)(rows_of(run, slice(None, None, 5)), folder), step=5),
    ]  # fmt: skip


def _mistakes() -> list[Kind]:
    return [
        Kind("ports swapped", with_columns(swapped), ("port", "swapped")),
        Kind("speed counts lowering", with_columns(scaled(1, -1.0))),
        Kind("pressures counted negative", with_columns(lambda c: scaled(2, -1.0)(scaled(3, -1.0)(c))), ("pressure",)),
        Kind("load counts downwards", with_columns(scaled(5, -1.0))),
        Kind("kPa under bar", with_columns(lambda c: scaled(2, 100.0)(scaled(3, 100.0)(c))), ("pressure",)),
        Kind("rpm of the drum under the motor's name", with_columns(scaled(1, 1.0 / 250.0, digits=5)), ("speed",)),
        Kind("percent under cm3/rev", with_columns(scaled(4, 100.0 / 215.0)), ("displacement", "pressure", "balance")),
        Kind("lb under kg", as_csv((*EN[:5], "Hook load [kg]", *EN[6:]), factors={"hook_load": 2.2046226}), ("load",)),
        Kind("a port is frozen", with_columns(lambda c: [*c[:2], (c[2][0], [c[2][1][0]] * len(c[2][1])), *c[3:]]), ("pressure_a",)),
        Kind("wrong crane", as_csv(EN), ("crane",), crane="wrong"),
        Kind("the other crane's load", with_columns(scaled(5, 0.4)), ("load", "balance")),
        Kind("mm of wire under m", with_columns(scaled(6, 1e3)), ("wire_out",)),
    ]  # fmt: skip
