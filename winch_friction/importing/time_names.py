"""What a column's heading says of a time: its name, how well that fits, and its unit."""

import re

from winch_friction.importing.log import LogColumn, own_name
from winch_friction.importing.names import EXACT, name_concepts, name_score
from winch_friction.importing.units import fitting_si_unit, header_readings

_LAST_BRACKET = re.compile(r"[\[(]([^\])]*)[\])]\s*$")
_SURE = 0.5  # how well a name says a time, from which it is one and nothing else


def is_named(column: LogColumn) -> bool:
    """Whether a column bears the name of a time, and not a `t` beside other words."""
    return says_time(time_reading(column)[0]) > _SURE


def says_time(bare: str) -> float:
    """How well a name without its unit says a time, 0 ... 1."""
    return name_score("time", name_concepts(bare))


def is_clock_of(column: LogColumn) -> tuple[bool, str]:
    """Whether a column is named as the time of something (`Pressure A Time [ms]`), and the unit."""
    bare, unit = time_reading(column)
    if says_time(bare) > _SURE:
        return True, unit
    bracket = _LAST_BRACKET.search(own_name(column.name))
    concepts = name_concepts(_LAST_BRACKET.sub("", own_name(column.name)))
    named = bool(concepts) and concepts[-1].get("time", 0.0) >= EXACT
    own = bracket.group(1).strip() if bracket else ""
    return named, own if own and fitting_si_unit("time", own) is not None else unit


def time_reading(column: LogColumn) -> tuple[str, str]:
    """Name and unit of a column, the unit one of time where the header has several readings."""
    readings = [(bare, unit or column.unit) for bare, unit in header_readings(column.name)]
    return next((r for r in readings if not r[1] or fitting_si_unit("time", r[1]) is not None), readings[0])
