"""Spoilt logs: a run written in somebody's dialect, with somebody's names and units, and perhaps somebody's mistake."""

import datetime as dt
import gzip
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from campaign.import_words import GROUPS, HELD_OUT, NAMES, UNITS
from winch_friction.physics.signals import FloatArray, Run

START = dt.datetime(2026, 3, 1, 10, 0, 0)
FORMATS = ("csv", "txt", "csv.gz", "xlsx", "parquet")
TIMES = ("seconds", "ms", "iso", "german", "clock", "unix")
Columns = dict[str, FloatArray]


@dataclass(frozen=True)
class Mistake:
    """A mistake: what it does to the columns before they are written, and what must be said of it (any of the words).

    `said` empty: the log is as good as before and must be imported, `mended` to what it was.
    """

    name: str
    spoil: Callable[[Columns], Columns]
    said: tuple[str, ...] = ()
    labels: dict[str, str] = field(default_factory=dict)  # channel -> unit written although the numbers are in another


def _scaled(channel: str, factor: float) -> Callable[[Columns], Columns]:
    return lambda columns: {k: v * factor if k.rpartition(".")[2] == channel else v for k, v in columns.items()}


def _pressures_scaled(factor: float) -> Callable[[Columns], Columns]:
    return lambda columns: {k: v * factor if ".pressure_" in k else v for k, v in columns.items()}


def _ports(columns: Columns) -> Columns:
    other = {"pressure_a": "pressure_b", "pressure_b": "pressure_a"}
    first = next(k.rpartition(".")[0] for k in reversed(columns) if ".pressure_" in k)  # the group that holds the load
    return {k: columns[f"{first}.{other[k.rpartition('.')[2]]}"] if k.startswith(f"{first}.pressure") else v
            for k, v in columns.items()}  # fmt: skip


def _groups(columns: Columns) -> Columns:
    swap = {"active": "passive", "passive": "active"}
    return {k: columns[f"{swap[k.partition('.')[0]]}.{k.partition('.')[2]}"] if k.partition(".")[0] in swap else v
            for k, v in columns.items()}  # fmt: skip


def _spike(columns: Columns) -> Columns:
    spiked = {k: v.copy() for k, v in columns.items()}
    for k, values in spiked.items():
        if k.endswith("pressure_a"):
            values[len(values) // 2] = 1e35
    return spiked


def _without(*channels: str) -> Callable[[Columns], Columns]:
    return lambda columns: {k: v for k, v in columns.items() if k.rpartition(".")[2] not in channels}


def _delayed(columns: Columns) -> Columns:
    late = np.interp(columns["time"] - 0.1, columns["time"], columns["motor_speed"])
    return {**columns, "motor_speed": late}


def _thinned(columns: Columns) -> Columns:
    return {k: v[::2] for k, v in columns.items()}


MISTAKES = (
    Mistake("none", lambda columns: columns),
    Mistake("load in kg under [t]", _scaled("hook_load", 1e3), ("hook_load",), {"hook_load": "t"}),
    Mistake("load in t under [kg]", _scaled("hook_load", 1e-3), ("hook_load",), {"hook_load": "kg"}),
    Mistake("ton", lambda columns: columns, ("ambiguous",), {"hook_load": "ton"}),
    Mistake("Pa under [bar]", _pressures_scaled(1e5), ("pressure",), {"pressure": "bar"}),
    Mistake("psi under [bar]", _pressures_scaled(14.5038), ("pressure",), {"pressure": "bar"}),
    Mistake("MPa under [bar]", _pressures_scaled(0.1), ("pressure",), {"pressure": "bar"}),
    Mistake("rad/s under [rpm]", _scaled("motor_speed", 0.10471975511965977), ("motor_speed",), {"motor_speed": "rpm"}),
    Mistake("displacement in mm^3", _scaled("displacement", 1e3), ("displacement",), {"displacement": "ccm"}),
    Mistake("speed counts paying out", _scaled("motor_speed", -1.0)),
    Mistake("ports swapped", _ports, ("port", "are swapped")),
    Mistake("groups swapped", _groups, ("group", "displacement")),
    Mistake("pressures doubled", _pressures_scaled(2.0), ("balance", "pressure")),
    Mistake("one cell of 1e30", _spike),
    Mistake("no pressure b", _without("pressure_b"), ("pressure_b",)),
    Mistake("no load", _without("hook_load")),
    Mistake("no wire", _without("wire_out", "wire_layer")),
    Mistake("speed late by 0.1 s", _delayed),
    Mistake("every second row", _thinned),
    Mistake("wrong crane", lambda columns: columns, ("crane",)),
)
# what can be told wrong of a real drive without a load cell at the hook and without pressures
REAL_MISTAKES = tuple(each for each in MISTAKES if each.name in ("none", "every second row"))


@dataclass(frozen=True)
class Variant:
    """One drawn log: how it is written and with which mistake."""

    number: int
    base: str
    language: str
    form: str
    time: str
    decimal: str
    units: str  # 'header', 'row' or 'none'
    held_out: bool
    mistake: Mistake

    def __str__(self) -> str:
        words = "held-out words" if self.held_out else self.language
        written = f"{self.form}, time {self.time}, decimal '{self.decimal}', units in {self.units}"
        return f"{self.base}, {words}, {written}, {self.mistake.name}"


def draw(number: int, bases: Sequence[str], seed: int) -> Variant:
    """The variant of this number."""
    rng = np.random.default_rng([seed, number])
    mistake = MISTAKES[0] if rng.random() < 0.35 else MISTAKES[int(rng.integers(1, len(MISTAKES)))]
    base = str(rng.choice([b for b in bases if mistake.name != "groups swapped" or b.startswith("ahc")]))
    if base.startswith("real/"):
        mistake = REAL_MISTAKES[int(rng.integers(0, len(REAL_MISTAKES)))]
    form = str(rng.choice(FORMATS))
    plain = form == "parquet"
    units = str(
        rng.choice(
            ["header", "row", "none"] if not plain else ["header", "none"],
            p=[0.6, 0.2, 0.2] if not plain else [0.8, 0.2],
        )
    )
    decimal = "." if plain else str(rng.choice([".", ","]))
    return Variant(
        number, base, str(rng.choice(["en", "de", "no"])), form, str(rng.choice(TIMES)), decimal,
        "header" if mistake.labels or base.startswith("real/") else units, bool(rng.random() < 0.25), mistake,
    )  # fmt: skip


def write(variant: Variant, run: Run, folder: Path, seed: int) -> Path:
    """Write the log of a variant; the path's name is the variant's number."""
    rng = np.random.default_rng([seed, variant.number, 1])
    columns = variant.mistake.spoil({k: v for k, v in run.columns.items() if _known(k)})
    heads, units, cells = [], [], []
    chosen: dict[str, tuple[str, float, int]] = {}
    style = int(rng.integers(0, 5))
    names: set[str] = set()
    for channel, values in columns.items():
        kind = _kind(channel)
        if kind == "time":
            heads.append(_name(variant, "time", "", "", rng))
            units.append({"seconds": "s", "ms": "ms"}.get(variant.time, ""))
            cells.append(_times(values, variant))
            continue
        spelling, factor, digits = chosen.setdefault(kind, _unit(kind, variant, rng))
        name = _name(variant, kind, channel.partition(".")[0], channel.rpartition("_")[2].upper(), rng)
        heads.append(name if name not in names else f"{name} 2")
        names.add(name)
        units.append(spelling)
        cells.append([_number(v * factor, digits, variant) for v in values])
    rows = _with_units(heads, units, variant, style)
    return _written(
        folder / f"log_{variant.number:03d}.{variant.form}", rows, list(zip(*cells, strict=True)), variant, rng
    )


def _known(channel: str) -> bool:
    return _kind(channel) in {*UNITS, "time"}


def _kind(channel: str) -> str:
    short = channel.rpartition(".")[2]
    return "pressure" if short.startswith("pressure_") else short


def _unit(kind: str, variant: Variant, rng: np.random.Generator) -> tuple[str, float, int]:
    spelling, factor, digits = UNITS[kind][int(rng.integers(0, len(UNITS[kind])))]
    label = variant.mistake.labels.get(kind)
    if label:  # the numbers are spoilt already: written as if they were in the unit that stands above them
        known = {
            "t": (1e-3, 3),
            "kg": (1.0, 3),
            "ton": (1e-3, 3),
            "bar": (1e-5, 2),
            "rpm": (9.549296585513721, 2),
            "ccm": (6283185.307179586, 2),
        }
        return (label, *known[label])
    return spelling, factor, digits


def _name(variant: Variant, kind: str, group: str, port: str, rng: np.random.Generator) -> str:
    table = HELD_OUT if variant.held_out else NAMES[variant.language]
    index = np.random.default_rng([variant.number, len(kind)]).integers(
        0, 1000
    )  # one way of naming for a kind in a log
    word = table[kind][int(index) % len(table[kind])]
    own = GROUPS[variant.language].get(group, {"": ("",)}.get("", ("",)))
    said = own[int(index) % len(own)] if group in GROUPS[variant.language] else ""
    return word.format(g=said, p=port).strip(" _")


def _with_units(heads: list[str], units: list[str], variant: Variant, style: int) -> list[list[str]]:
    if variant.units == "none":
        return [heads]
    if variant.units == "row":
        return [heads, units]
    shapes = ("{n} [{u}]", "{n} ({u})", "{n} / {u}", "{n} in {u}", "{n}, {u}")
    return [[shapes[style].format(n=n, u=u) if u else n for n, u in zip(heads, units, strict=True)]]


def _times(seconds: FloatArray, variant: Variant) -> list[object]:
    if variant.time in ("seconds", "ms", "unix"):
        shift, factor, digits = {"seconds": (0.0, 1.0, 3), "ms": (0.0, 1e3, 0), "unix": (START.timestamp(), 1.0, 3)}[
            variant.time
        ]
        return [_number((s + shift) * factor, digits, variant) for s in seconds]
    stamps = [START + dt.timedelta(seconds=float(s)) for s in seconds]
    if variant.time == "iso":
        return [s.isoformat(timespec="milliseconds") for s in stamps]
    if variant.time == "german":
        return [s.strftime("%d.%m.%Y %H:%M:%S,%f")[:-3] for s in stamps]
    return [s.strftime("%H:%M:%S.%f")[:-3] for s in stamps]


def _number(value: float, digits: int, variant: Variant) -> object:
    if variant.form == "parquet":
        return float(value)
    text = f"{value:.{digits}f}" if abs(value) < 1e20 else f"{value:.6e}"
    return text.replace(".", variant.decimal)


def _written(
    path: Path, heads: list[list[str]], rows: list[tuple[object, ...]], variant: Variant, rng: np.random.Generator
) -> Path:
    if variant.form == "parquet":
        import pandas as pd

        pd.DataFrame(rows, columns=heads[0]).to_parquet(path)
        return path
    if variant.form == "xlsx":
        from openpyxl import Workbook

        book = Workbook(write_only=True)
        sheet = book.create_sheet("Daten")
        typed = [[float(c) if variant.decimal == "." and _is_float(c) else c for c in row] for row in rows]
        for row in [*heads, *typed]:
            sheet.append(list(row))
        book.save(path)
        return path
    delimiter = str(rng.choice([";", "\t"])) if variant.decimal == "," else str(rng.choice([",", ";", "\t"]))
    preamble = "" if rng.random() < 0.6 else "Log of crane 7\nOperator: NN\n\n"
    quoted = [[f'"{cell}"' if delimiter in str(cell) else str(cell) for cell in row] for row in [*heads, *rows]]
    body = preamble + "\n".join(delimiter.join(row) for row in quoted) + "\n"
    coded = body.encode(str(rng.choice(["utf-8", "utf-8-sig", "cp1252", "utf-16"])), errors="replace")
    path.write_bytes(gzip.compress(coded) if variant.form.endswith("gz") else coded)
    return path


def _is_float(cell: object) -> bool:
    try:
        float(str(cell))
    except ValueError:
        return False
    return True
