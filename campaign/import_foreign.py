"""Logs as other makers' programs export them, and habits met after `import_kinds` was mended: a second set."""
# ruff: noqa: E501  one kind a line: a table that is read down

import datetime as dt
from collections.abc import Callable
from pathlib import Path

from campaign.import_writers import (
    BARE,
    EN,
    KG,
    START,
    UNITS,
    Kind,
    Table,
    as_csv,
    lines,
    put,
    scaled,
    stamp,
    table,
    thousands,
    timed,
    with_columns,
    with_lines,
)
from winch_friction.physics.signals import Run

PT = ("Tempo [s]", "Rotação do motor [rpm]", "Pressão A [bar]", "Pressão B [bar]", "Cilindrada [cm3/rot]",
      "Carga no gancho [t]", "Cabo lançado [m]", "Camada")  # fmt: skip
IT = ("Tempo [s]", "Velocità motore [giri/min]", "Pressione A [bar]", "Pressione B [bar]", "Cilindrata [cm3/giro]",
      "Carico al gancio [kg]", "Fune svolta [m]", "Strato")  # fmt: skip
PL = ("Czas [s]", "Obroty silnika [obr/min]", "Ciśnienie A [bar]", "Ciśnienie B [bar]", "Chłonność [cm3/obr]",
      "Ładunek na haku [kg]", "Długość liny [m]", "Warstwa")  # fmt: skip
FI = ("Aika [s]", "Moottorin nopeus [rpm]", "Paine A [bar]", "Paine B [bar]", "Kierrostilavuus [cm3/r]",
      "Koukkukuorma [kg]", "Vaijeria ulkona [m]", "Kerros")  # fmt: skip


def kinds() -> list[Kind]:
    """Every kind of the second set."""
    from campaign.import_programs import kinds as programs

    return [*programs(), *_texts(), *_clocks(), *_words(), *_mistakes()]


def _texts() -> list[Kind]:
    return [
        Kind("index column without a name", with_columns(lambda c: [("", [str(k) for k in range(len(c[0][1]))]), *c])),
        Kind("a column exported twice", with_columns(lambda c: [*c, c[2], c[1]])),
        Kind("decimal commas quoted between commas", with_lines(quoted_commas)),
        Kind("thousands with a narrow blank", with_columns(thousands("\u202f", ","), EN, ";")),
        Kind("minus behind the number", with_columns(lambda c: [c[0], *((h, [x[1:] + "-" if x.startswith("-") else x for x in cells]) for h, cells in c[1:])])),
        Kind("negative numbers in parentheses", with_columns(lambda c: [c[0], *((h, [f"({x[1:]})" if x.startswith("-") else x for x in cells]) for h, cells in c[1:])])),
        Kind("plus signs", with_columns(lambda c: [c[0], *((h, [x if x.startswith("-") else f"+{x}" for x in cells]) for h, cells in c[1:])])),
        Kind("newest row first", with_lines(lambda rows: [rows[0], *rows[:0:-1]]), ("newest",)),
        Kind("slow channels with blanks", with_columns(sparse), loose={"hook_load": 0.02, "wire_out": 0.05}),
        Kind("words for no value in every 25th cell", with_columns(often("Bad"))),
        Kind("I/O Timeout and No Data", with_columns(often("I/O Timeout"))),
        Kind("quality after each value", with_columns(lambda c: [c[0], *(x for h, cells in c[1:] for x in ((h, cells), ("Quality", ["Good"] * len(cells))))], EN, ";")),
        Kind("states in words between numbers", with_columns(lambda c: [*c[:2], ("Brake open", ["TRUE"] * len(c[0][1])), ("Mode", ["AHC"] * len(c[0][1])), *c[2:]])),
        Kind("DOS end of file and padding", with_lines(lambda rows: [*rows, "\x1a"])),
        Kind("zero bytes behind a power cut", zeros),
        Kind("last line cut off", with_lines(lambda rows: [*rows[:-1], rows[-1][:9]])),
        Kind("two tables in one file", with_lines(lambda rows: [*rows, "", "Alarm no,Text,Count,Ack", *(f"{k},pump {k},3,1" for k in range(40))]), ("several recordings",)),
        Kind("channels in rows", transposed, ("row", "transposed")),
        Kind("units in a row above the names", with_lines(lambda rows: [",".join(UNITS), rows[0], *rows[1:]], BARE)),
        Kind("code page 850", as_csv(("Zeit [s]", "Motordrehzahl [1/min]", "Druck A [bar]", "Druck B [bar]", "Schluckvolumen [ccm]", "Hakenlast [t]", "Seillänge [m]", "Seillage"), ";", ",", encoding="cp850")),
    ]  # fmt: skip


def _clocks() -> list[Kind]:
    days = 719162.0 * 86400.0
    unix = START.replace(tzinfo=dt.UTC).timestamp()
    return [
        Kind("h:mm:ss.mmm", timed("Elapsed", lambda t: [f"{int(s // 3600)}:{int(s // 60) % 60:02d}:{s % 60:06.3f}" for s in t])),
        Kind("mm:ss.0 of a spreadsheet", timed("Time", lambda t: [f"{int(s // 60):02d}:{s % 60:06.3f}" for s in t])),
        Kind("Unix ms as 1.77E+12 is no time", timed("Timestamp", lambda t: [f"{1e3 * (unix + s):.4E}" for s in t]), ("time",)),
        Kind(".NET ticks", timed("Ticks", lambda t: [f"{round((days + unix + s) * 1e3) * 10_000}" for s in t])),
        Kind("FILETIME", timed("Timestamp", lambda t: [f"{round((11644473600.0 + unix + s) * 1e3) * 10_000}" for s in t])),
        Kind("date, time and milliseconds apart", lambda run, folder: put(lines([("Date", [f"{stamp(s):%d.%m.%Y}" for s in run.time]), ("Time", [f"{stamp(s):%H:%M:%S}" for s in run.time]), ("ms", [str(stamp(s).microsecond // 1000) for s in run.time]), *table(run, EN)[1:]], ";"), folder / "log.csv")),
        Kind("seconds and nanoseconds apart", lambda run, folder: put(lines([("header.stamp.sec", [str(int(unix + s)) for s in run.time]), ("header.stamp.nanosec", [str(round((s % 1.0) * 1e9)) for s in run.time]), *table(run, EN)[1:]]), folder / "log.csv")),
        Kind("IEC time", timed("Time", lambda t: [f"T#{int(s // 60)}m{int(s % 60)}s{round(1e3 * (s % 1.0)) % 1000}ms" for s in t])),
        Kind("time in 100 us", timed("Time [100us]", lambda t: [str(round(s * 1e4)) for s in t])),
    ]  # fmt: skip


def _words() -> list[Kind]:
    return [
        Kind("Portuguese", as_csv(PT, ";", ",")),
        Kind("Italian", as_csv(IT, ";", ",", KG)),
        Kind("Polish", as_csv(PL, ";", ",", KG)),
        Kind("Finnish", as_csv(FI, ";", ",", KG)),
        Kind("setpoint beside actual", with_columns(lambda c: [c[0], ("Motor speed SP [rpm]", [f"{float(x) * 1.02:.2f}" for x in c[1][1]]), ("Motor speed PV [rpm]", c[1][1]), *c[2:]])),
        Kind("average between minimum and maximum", with_columns(aggregates)),
        Kind("mbar", as_csv((*EN[:2], "Pressure A [mbar]", "Pressure B [mbar]", *EN[4:]), factors={"pressure": 1e-2}, digits=3)),
        Kind("kPa", as_csv((*EN[:2], "Pressure A [kPa]", "Pressure B [kPa]", *EN[4:]), factors={"pressure": 1e-3}, digits=3)),
        Kind("kp/cm2", as_csv((*EN[:2], "Druck A [kp/cm²]", "Druck B [kp/cm²]", *EN[4:]), factors={"pressure": 1.0 / 98066.5}, digits=4)),
        Kind("MT", as_csv((*EN[:5], "Hook load (MT)", *EN[6:]))),
        Kind("tf", as_csv((*EN[:5], "Hook load [tf]", *EN[6:]))),
        Kind("tenths of a bar", as_csv((*EN[:2], "Pressure A [0.1 bar]", "Pressure B [0,1 bar]", *EN[4:]), ";", factors={"pressure": 1e-4}, digits=1)),
        Kind("drum in rev/s", with_columns(scaled(1, 1.0 / 250.0 / 60.0, "Drum speed [rev/s]", 7))),
    ]  # fmt: skip


def _mistakes() -> list[Kind]:
    return [
        Kind("4 to 20 mA", as_csv((*EN[:2], "Pressure A [mA]", "Pressure B [mA]", *EN[4:]), factors={"pressure": 16.0 / 6e7}, digits=4), ("pressure",)),
        Kind("tenths of a bar under bar", as_csv(EN, factors={"pressure": 1e-4}, digits=1), ("pressure",)),
        Kind("displacement negative", with_columns(scaled(4, -1.0))),
        Kind("displacement in degrees", with_columns(scaled(4, 25.0 / 215.0, "Swash angle [deg]")), ("displacement",)),
        Kind("kN under t", as_csv(EN, factors={"hook_load": 9.80665e-3}), ("load",)),
        Kind("klbs under t", as_csv(EN, factors={"hook_load": 2.2046226e-3}), ("load",)),
        Kind("MPa of one port, bar of the other", with_columns(scaled(2, 0.1)), ("pressure",)),
        Kind("rev/s under rpm", with_columns(scaled(1, 1.0 / 60.0, digits=6)), ("speed",)),
        Kind("load of another second", with_columns(lambda c: [*c[:5], (c[5][0], [c[5][1][0]] * len(c[5][1])), *c[6:]])),
    ]  # fmt: skip


def quoted_commas(rows: list[str]) -> list[str]:
    return [rows[0], *(",".join('"' + c.replace(".", ",") + '"' for c in row.split(",")) for row in rows[1:])]


def sparse(columns: Table) -> Table:
    """Load and wire written every tenth row only, as a logger with several rates does."""
    thin = lambda cells: [c if k % 10 == 0 else "" for k, c in enumerate(cells)]
    return [(h, thin(cells) if h.startswith(("Hook", "Wire out")) else cells) for h, cells in columns]


def often(word: str) -> Callable[[Table], Table]:
    """Every 25th cell of a pressure is this word."""
    change = lambda cells: [word if k % 25 == 7 else c for k, c in enumerate(cells)]
    return lambda columns: [*columns[:2], (columns[2][0], change(columns[2][1])), *columns[3:]]


def aggregates(columns: Table) -> Table:
    """A historian's minimum, average and maximum of the pressures."""
    out: Table = []
    for k, (head, cells) in enumerate(columns):
        if k not in (2, 3):
            out.append((head, cells))
            continue
        name = head.removesuffix(" [bar]")
        for word, factor in (("min", 0.97), ("avg", 1.0), ("max", 1.03)):
            out.append((f"{name} {word} [bar]", [f"{float(c) * factor:.2f}" for c in cells]))
    return out


def zeros(run: Run, folder: Path) -> list[Path]:
    put(lines(table(run, EN)), folder / "log.csv")
    with (folder / "log.csv").open("ab") as file:
        file.write(bytes(8192))
    return [folder / "log.csv"]


def transposed(run: Run, folder: Path) -> list[Path]:
    return put([",".join([head, *cells]) for head, cells in table(run, EN)], folder / "log.csv")
