"""A log as it was found: columns of numbers or of text, where each cell stands, and what was noticed while reading."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from winch_friction.physics.errors import InputError, counted
from winch_friction.physics.signals import FloatArray

Place = Callable[[int], str]  # index of a row -> how a person finds it in the file
_NUMBERED = re.compile(r" #\d+$")
_LISTED = 60  # columns named in one message


@dataclass(frozen=True)
class LogColumn:
    """One column: `name` as it stands, `unit` from a row of units or the file's own field ('' for none).

    `values`: numbers, NaN where a cell is empty or no number; `text`: the cells as they stand when they are no numbers
    (dates), else None; `bad`: (row, cell) of cells that are neither empty nor numbers; `note`: a description.
    """

    name: str
    values: FloatArray
    unit: str = ""
    text: Any = None
    bad: tuple[tuple[int, str], ...] = ()
    note: str = ""

    @property
    def numeric(self) -> bool:
        """Whether it is a column of numbers."""
        return self.text is None


@dataclass(frozen=True)
class Log:
    """A log: its columns of one length, `settings` that read it again in the same way, `notes` for the person."""

    path: Path
    columns: tuple[LogColumn, ...]
    settings: Mapping[str, Any]
    place: Place
    notes: tuple[str, ...] = ()
    metadata: Mapping[str, Any] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.columns[0].values) if self.columns else 0

    def column(self, name: str) -> LogColumn:
        """A column by name; raises `InputError` that lists what the log has."""
        for each in self.columns:
            if each.name == name:
                return each
        raise InputError(f"{self.path}: no column '{name}'; found {listed(each.name for each in self.columns)}")


def listed(names: Any) -> str:
    """Names in quotes for a message, a long list cut short with its count."""
    every = [f"'{name}'" for name in names]
    more = f" and {len(every) - _LISTED} more" if len(every) > _LISTED else ""
    return ", ".join(every[:_LISTED]) + more if every else "nothing"


def unique_names(names: Sequence[str]) -> list[str]:
    """Names of columns: empty ones are numbered, repeated ones told apart."""
    seen: dict[str, int] = {}
    out = []
    for k, name in enumerate(names):
        plain = " ".join(str(name).split()) or f"(column {k + 1})"
        seen[plain] = seen.get(plain, 0) + 1
        out.append(plain if seen[plain] == 1 else f"{plain} #{seen[plain]}")
    return out


def own_name(name: str) -> str:
    """A column's name as it stands in the log, without the number by which `unique_names` told it from others."""
    return _NUMBERED.sub("", name)


def number_column(name: str, values: Any, unit: str = "", note: str = "") -> LogColumn:
    """A column of an array of numbers."""
    return LogColumn(name, np.asarray(values, dtype=float).ravel(), unit, note=note)


# -- columns that say how good the one before them is, as historians and OPC servers write them
_QUALITY = re.compile(r"(?:^|[^a-zäå])(?:quality|qualität|kvalitet)(?:$|[^a-zäå])", re.IGNORECASE)
_GOOD = ("good", "gut", "god", "ok", "valid", "gültig", "gyldig")
_NOT_GOOD = ("bad", "uncertain", "questionable", "invalid", "stale", "substituted", "schlecht", "unsicher", "ungültig",
             "dårlig", "usikker", "ugyldig")  # fmt: skip
_OPC_GOOD, _OPC_MOST = 192.0, 255.0  # of OPC's byte of quality: from 192 on good, from 64 uncertain, from 0 bad


def without_bad_values(log: Log) -> Log:
    """The log without the values of which the quality that stands behind them says anything but good."""
    columns, notes = list(log.columns), list(log.notes)
    for k in range(1, len(columns)):
        value, quality = columns[k - 1 : k + 1]
        bad = _bad_by(quality)
        lost = np.zeros(0, bool) if bad is None else bad & np.isfinite(value.values)
        if value.numeric and not _QUALITY.search(value.name) and lost.any():
            columns[k - 1] = replace(value, values=np.where(lost, np.nan, value.values))
            notes.append(
                f"{counted(int(lost.sum()), 'value', 'values')} of '{value.name}' not good by '{quality.name}', first "
                f"in {log.place(int(lost.argmax()))}: left out"
            )
    return replace(log, columns=tuple(columns), notes=tuple(notes))


def _bad_by(quality: LogColumn) -> np.ndarray | None:
    """Rows (rows,) that a column of qualities calls other than good; None where it is no such column."""
    if not _QUALITY.search(quality.name):
        return None
    if quality.numeric:
        known = quality.values[np.isfinite(quality.values)]
        of_opc = len(known) and known.min() >= 0.0 and _OPC_GOOD <= known.max() <= _OPC_MOST
        return np.asarray(quality.values < _OPC_GOOD) if of_opc else None
    words = np.array([str(cell).strip().lower() for cell in quality.text])
    if not np.isin(words, ("", *_GOOD, *_NOT_GOOD)).all() or not np.isin(words, _GOOD).any():
        return None
    return np.asarray(np.isin(words, _NOT_GOOD))
