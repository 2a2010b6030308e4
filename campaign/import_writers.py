"""How strangers write a run down: dialects of names and units, and what loggers, clocks and people do to a table."""

import datetime as dt
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from winch_friction.physics.signals import FloatArray, Run

START = dt.datetime(2026, 3, 1, 10, 0, 0)
RPM, CM3 = 9.549296585513721, 6283185.307179586
# channel -> factor from SI and digits, as most logs have it
USUAL = {"motor_speed": (RPM, 2), "pressure": (1e-5, 2), "displacement": (CM3, 2), "hook_load": (1e-3, 3),
         "wire_out": (1.0, 3), "wire_layer": (1.0, 0)}  # fmt: skip
CHANNELS = (
    "motor_speed",
    "main.pressure_a",
    "main.pressure_b",
    "main.displacement",
    "hook_load",
    "wire_out",
    "wire_layer",
)
Table = list[tuple[str, list[str]]]  # header -> cells
Writer = Callable[[Run, Path], list[Path]]


@dataclass(frozen=True)
class Kind:
    """`said` empty: must be imported as it was, in every file; else one of these words must be in the first cause.

    `step`: every how many-th row of the run is in the log; `loose`: channels that the log holds less exactly, with the
    share of their largest value; `crane` a shipped name or `wrong`.
    """

    name: str
    write: Writer
    said: tuple[str, ...] = ()
    base: str = "test_02"
    step: int = 1
    loose: Mapping[str, float] = field(default_factory=dict)
    crane: str = "crane_150t"
    settings: tuple[str, ...] = ()


def table(run: Run, heads: Sequence[str], factors: Mapping[str, float] | None = None, digits: int | None = None,
          times: Sequence[str] | None = None) -> Table:  # fmt: skip
    """The usual columns under these headers (the time's first), in the usual units but where `factors` says another."""
    seconds = [f"{t:.3f}" for t in run.time] if times is None else list(times)
    out: Table = [(heads[0], seconds)]
    for name, head in zip(CHANNELS, heads[1:], strict=False):
        short = name.rpartition(".")[2]
        kind = "pressure" if short.startswith("pressure") else short
        factor, places = USUAL[kind]
        factor = (factors or {}).get(kind, factor)
        places = places if digits is None or kind == "wire_layer" else digits
        out.append((head, [f"{v * factor:.{places}f}" for v in run[name]]))
    return out


def lines(columns: Table, delimiter: str = ",", units: Sequence[str] | None = None) -> list[str]:
    """Header, perhaps a row of units, and rows."""
    rows = [delimiter.join(head for head, _ in columns)]
    if units is not None:
        rows.append(delimiter.join(units))
    return rows + [delimiter.join(cells) for cells in zip(*(cells for _, cells in columns), strict=True)]


def comma(columns: Table) -> Table:
    """With a decimal comma."""
    return [(head, [cell.replace(".", ",") for cell in cells]) for head, cells in columns]


def put(rows: Sequence[str], path: Path, encoding: str = "utf-8", end: str = "\n") -> list[Path]:
    """The rows in a file."""
    path.write_bytes((end.join(rows) + end).encode(encoding))
    return [path]


EN = ("Time [s]", "Motor speed [rpm]", "Pressure A [bar]", "Pressure B [bar]", "Displacement [cm3/rev]",
      "Hook load [t]", "Wire out [m]", "Wire layer")  # fmt: skip
DE = ("Zeit [s]", "Motordrehzahl [1/min]", "Druck A [bar]", "Druck B [bar]", "Schluckvolumen [ccm]", "Hakenlast [t]",
      "Seillänge [m]", "Seillage")  # fmt: skip
NL = ("Tijd [s]", "Motortoerental [omw/min]", "Druk A [bar]", "Druk B [bar]", "Slagvolume [cm3/omw]", "Haaklast [t]",
      "Kabellengte [m]", "Kabellaag")  # fmt: skip
DA = ("Tid [s]", "Motoromdrejningstal [omdr/min]", "Tryk A [bar]", "Tryk B [bar]", "Fortrængning [cm3/omdr]",
      "Kroglast [kg]", "Wirelængde [m]", "Wirelag")  # fmt: skip
FR = ("Temps [s]", "Vitesse moteur [tr/min]", "Pression A [bar]", "Pression B [bar]", "Cylindrée [cm3/tr]",
      "Charge au crochet [kg]", "Longueur de câble [m]", "Couche")  # fmt: skip
SV = ("Tid [s]", "Motorvarvtal [varv/min]", "Tryck A [bar]", "Tryck B [bar]", "Deplacement [cm3/varv]", "Kroklast [kg]",
      "Linlängd [m]", "Linlager")  # fmt: skip
NO = ("Tid [s]", "Motorturtall [o/min]", "Trykk A [bar]", "Trykk B [bar]", "Slagvolum [cm3/o]", "Kroklast [t]",
      "Wirelengde [m]", "Wirelag")  # fmt: skip
ES = ("Tiempo [s]", "Velocidad motor [rpm]", "Presión A [bar]", "Presión B [bar]", "Cilindrada [cm3/rev]",
      "Carga gancho [kg]", "Longitud cable [m]", "Capa")  # fmt: skip
ABBREVIATED_NO = ("t_s", "n_mot_rpm", "pA_bar", "pB_bar", "Vg_cm3", "kroklast_t", "wire_ute_m", "lag")
ABBREVIATED_DE = ("t/s", "nMot/min-1", "pA/bar", "pB/bar", "Vg/ccm", "mLast/t", "lSeil/m", "Lage")
UNDERSCORED = ("time_s", "motor_speed_rpm", "p_a_bar", "p_b_bar", "displacement_cc_rev", "hook_load_t", "wire_out_m",
               "layer")  # fmt: skip
CAMEL = (
    "timeS",
    "motorSpeedRpm",
    "pressureABar",
    "pressureBBar",
    "displacementCcm",
    "hookLoadT",
    "wireOutM",
    "wireLayer",
)
BARE = ("Time", "Motor speed", "Pressure A", "Pressure B", "Displacement", "Hook load", "Wire out", "Wire layer")
UNITS = ("s", "rpm", "bar", "bar", "cm3/rev", "t", "m", "-")
KG = {"hook_load": 1.0}


def as_csv(heads: Sequence[str], delimiter: str = ",", decimal: str = ".", factors: Mapping[str, float] | None = None,
         digits: int | None = None, encoding: str = "utf-8", end: str = "\n") -> Writer:  # fmt: skip
    def write(run: Run, folder: Path) -> list[Path]:
        columns = table(run, heads, factors, digits)
        return put(lines(comma(columns) if decimal == "," else columns, delimiter), folder / "log.csv", encoding, end)

    return write


def timed(head: str, times: Callable[[FloatArray], Sequence[str]], delimiter: str = ";") -> Writer:
    def write(run: Run, folder: Path) -> list[Path]:
        return put(lines(table(run, (head, *EN[1:]), times=times(run.time)), delimiter), folder / "log.csv")

    return write


def with_lines(change: Callable[[list[str]], list[str]], heads: Sequence[str] = EN, delimiter: str = ",") -> Writer:
    """The lines of an ordinary log, changed."""
    return lambda run, folder: put(change(lines(table(run, heads), delimiter)), folder / "log.csv")


def with_columns(change: Callable[[Table], Table], heads: Sequence[str] = EN, delimiter: str = ",") -> Writer:
    """The columns of an ordinary log, changed."""
    return lambda run, folder: put(lines(change(table(run, heads)), delimiter), folder / "log.csv")


def dates(form: str) -> Callable[[FloatArray], list[str]]:
    return lambda time: [stamp(t).strftime(form)[: -3 if form.endswith("%f") else None] for t in time]


def stamp(seconds: float) -> dt.datetime:
    return START + dt.timedelta(milliseconds=round(1e3 * float(seconds)))


def epoch(factor: float, digits: int) -> Callable[[FloatArray], list[str]]:
    start = START.replace(tzinfo=dt.UTC).timestamp()
    return lambda time: [f"{round((start + t) * 1e3) * factor / 1e3:.{digits}f}" for t in time]


def days(first: float) -> Callable[[FloatArray], list[str]]:
    start = START.replace(tzinfo=dt.UTC).timestamp() / 86400.0
    return lambda time: [f"{first + start + t / 86400.0:.10f}" for t in time]


def thousands(mark: str, decimal: str) -> Callable[[Table], Table]:
    def cell(text: str) -> str:
        return f"{float(text):,.3f}".replace(",", "\0").replace(".", decimal).replace("\0", mark)

    return lambda columns: [(h, [cell(c) for c in cells]) for h, cells in columns]


def holes(words: Sequence[str]) -> Callable[[Table], Table]:
    """Every 97th cell of a pressure is one of these words."""

    def change(columns: Table) -> Table:
        cells = [words[(k // 97) % len(words)] if k % 97 == 50 else c for k, c in enumerate(columns[2][1])]
        return [*columns[:2], (columns[2][0], cells), *columns[3:]]

    return change


def scaled(index: int, factor: float, head: str = "", digits: int = 4) -> Callable[[Table], Table]:
    def change(columns: Table) -> Table:
        name, cells = columns[index]
        return [
            *columns[:index],
            (head or name, [f"{float(c) * factor:.{digits}f}" for c in cells]),
            *columns[index + 1 :],
        ]

    return change


def renamed(names: Mapping[int, str]) -> Callable[[Table], Table]:
    return lambda columns: [(names.get(k, head), cells) for k, (head, cells) in enumerate(columns)]


def swapped(columns: Table) -> Table:
    return [*columns[:2], (columns[2][0], columns[3][1]), (columns[3][0], columns[2][1]), *columns[4:]]


def of_drum(columns: Table) -> Table:
    return scaled(1, 1.0 / 250.0, "Drum speed [rpm]", 5)(columns)


def of_line(columns: Table) -> Table:  # on the sixth layer of the shipped crane
    return scaled(1, 1.136 / 250.0 * 2.0 * np.pi, "Line speed [m/min]", 4)(columns)


def rows_of(run: Run, rows: slice) -> Run:
    return Run(run.name, {name: values[rows] for name, values in run.columns.items()})


def two_orders(run: Run, folder: Path) -> list[Path]:
    first, second = lines(table(run, EN)), table(run, EN)
    return put(first, folder / "one.csv") + put(lines([second[0], *second[:0:-1]]), folder / "two.csv")


def appended(rows: list[str]) -> list[str]:
    """A logger that was started twice into one file, with its clock from zero."""
    return rows + rows[1:600]


def repeated_header(rows: list[str]) -> list[str]:
    return [*rows[:400], rows[0], *rows[400:900], rows[0], *rows[900:]]
