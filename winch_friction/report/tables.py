"""Tables and text of a report as HTML, escaped."""

import re
from collections.abc import Iterable, Sequence
from datetime import UTC, datetime
from html import escape
from math import isfinite
from typing import Any

from winch_friction.physics.channels import BAR, CM3_PER_REV, RPM, beside


def table_html(columns: Sequence[str], rows: Iterable[Sequence[Any]], caption: str = "", digits: int = 4) -> str:
    """A table; numbers are aligned to the right with `digits` significant digits, text is escaped."""
    rows = [list(row) for row in rows]
    numeric = [bool(rows) and all(_is_number(row[k]) for row in rows) for k in range(len(columns))]
    head = "".join(f'<th scope="col"{_class(n)}>{escape(name)}</th>' for name, n in zip(columns, numeric, strict=True))
    body = "".join("<tr>" + _cells(row, numeric, digits) + "</tr>" for row in rows)
    # above what scrolls: as the table's own caption it would be as wide as the table, and cut off on a phone
    title = f'<p class="caption">{escape(caption)}</p>' if caption else ""
    table = f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
    label = escape(caption or "table: " + ", ".join(columns), quote=True)
    return f'{title}<div class="scroll" tabindex="0" role="group" aria-label="{label}">{table}</div>'


def paragraph(text: str, kind: str = "") -> str:
    """A paragraph of escaped text; `kind` is a class of the style: faint, good, bad, verdict."""
    return f'<p class="{escape(kind)}">{words_html(text)}</p>' if kind else f"<p>{words_html(text)}</p>"


def words_html(text: str) -> str:
    """Escaped text in which `words` to be typed stand out."""
    return re.sub(r"`([^`]+)`", r"<code>\1</code>", escape(text))


def number(value: float, digits: int = 4) -> str:
    """A number for people: significant digits without an exponent where it stays short, a dash for none."""
    if not isfinite(value):
        return "–"
    size = abs(value)
    if value == 0.0 or 1e-3 <= size < 1e6:
        shown = f"{value:.{digits}g}"
        return f"{value:.0f}" if "e" in shown else shown
    return f"{value:.{digits}g}"


_LONG = 12  # characters from which a word may be folded
_SENTENCE = 40  # characters from which a cell counts as a sentence
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
# the unit that people read a quantity in; one per quantity on every page and in every table
_PEOPLE = {"rad/s": ("rpm", 1.0 / RPM), "Pa": ("bar", 1.0 / BAR), "kg": ("t", 1e-3), "degC": ("°C", 1.0),
           "1": ("–", 1.0),
           "": ("–", 1.0), "m^3/rad": ("cm³/rev", 1.0 / CM3_PER_REV), "m^3/rad/K": ("cm³/rev/K", 1.0 / CM3_PER_REV),
           "Pa/K": ("bar/K", 1.0 / BAR), "Pa/K^2": ("bar/K²", 1.0 / BAR)}  # fmt: skip
_A_DATE = 1e9  # s since 1970; no duration of a winch is 32 years


def for_people(unit: str) -> str:
    """A unit as people read it: rpm, bar, t, °C, with dots and exponents."""
    if unit in _PEOPLE:
        return _PEOPLE[unit][0]
    return re.sub(r"\^(-?\d+)", lambda found: found[1].translate(_RAISED), unit).replace("*", "·")


def value_for_people(value: float, unit: str) -> float:
    """An SI value in the unit of `for_people`."""
    return value * _PEOPLE[unit][1] if unit in _PEOPLE else value


def estimate_for_people(value: float, std: float, unit: str) -> tuple[Any, float, str]:
    """Value, standard deviation and unit as people read them; an instant, s since 1970, as its date, uncertain by h;
    0 for a value that is nothing beside its deviation."""
    if unit == "s" and value > _A_DATE:
        return f"{datetime.fromtimestamp(value, UTC):%Y-%m-%d %H:%M} UTC", std / 3600.0, "h"
    return value_for_people(beside(value, std), unit), value_for_people(std, unit), for_people(unit)


def _cells(row: Sequence[Any], numeric: Sequence[bool], digits: int) -> str:
    return "".join(
        f"<td{_class(n) or _wide(value)}>{_shown(value, digits)}</td>" for value, n in zip(row, numeric, strict=True)
    )


def _wide(value: Any) -> str:
    """Sentences keep a width that can be read, whatever else stands in the row."""
    return ' class="words"' if len(str(value)) > _SENTENCE and " " in str(value) else ""


def _foldable(text: str) -> str:
    """Escaped text whose words of twelve letters and more may break after `_`, `/` and a name's dot, and every 16
    characters of a hash; symbols stay whole, and numbers beside their units, which read as in the headings."""
    text = re.sub(r"(?<=\d )(c?m)\^([23])(?=\W|$)", lambda found: found[1] + "²³"[int(found[2]) - 2], text)
    text = re.sub(r"(?<=\d) (?=%|°|[A-Za-zµ]+[²³]?(?:/[a-z]+)?(?:[,;:)]|$)|c?m[²³])", "\u00a0", text)
    return " ".join(_folded(word) if len(word) >= _LONG else escape(word) for word in text.split(" "))


def _folded(word: str) -> str:
    marked = re.sub(
        r"[0-9A-Za-z]{16}(?=[0-9A-Za-z]{8})|[_/](?=\w{3})|(?<=[a-z]{3})\.(?=[a-z]{3})",
        lambda found: found[0] + "\0",
        word,
    )
    return escape(marked).replace("\0", "<wbr>")


def _shown(value: Any, digits: int) -> str:
    if value is None:
        return "–"
    if isinstance(value, bool) or not _is_number(value):
        return _foldable(str(value))
    return str(value) if isinstance(value, int) else number(float(value), digits)


def _is_number(value: Any) -> bool:
    return value is None or (hasattr(value, "__float__") and not isinstance(value, (str, bool)))


def _class(numeric: bool) -> str:
    return ' class="number"' if numeric else ""
