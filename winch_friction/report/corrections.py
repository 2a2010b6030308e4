"""What a model says is wrong with its logs and its crane file, as people read it."""

from collections.abc import Iterable
from typing import Any

from winch_friction.physics.friction.correction import Correction
from winch_friction.report.tables import estimate_for_people, for_people, value_for_people

CORRECTIONS = ("correction", "value", "σ", "unit", "where and when", "meaning")


def correction_rows(corrections: Iterable[Correction]) -> list[tuple[Any, ...]]:
    """What a model says is wrong with signals and crane file, under `CORRECTIONS`, as people read it."""
    rows = []
    for each in corrections:
        value, std, unit = estimate_for_people(each.value, each.std or 0.0, each.declared.parameter.unit)
        known = None if each.std is None else std
        rows.append((each.name, value, known, unit, "; ".join(_ties(each)) or "always", each.declared.doc))
    return rows


def _ties(c: Correction) -> list[str]:
    """What a correction is restricted to, in words."""
    said = [f"{', '.join(c.groups)} group{'s' if len(c.groups) > 1 else ''}"] if c.groups else []
    said += [f"layer{'s' if len(c.layers) > 1 else ''} {', '.join(map(str, c.layers))}"] if c.layers else []
    said += [f"over {c.time_constant:.4g} s"] if c.time_constant is not None else []
    if c.beyond is not None:
        unit = c.declared.bends_in
        said.append(f"beyond {value_for_people(c.beyond, unit):.4g} {for_people(unit)}")
    for begin, end in c.during:
        said.append(f"since {_instant(begin)}" if end == float("inf") else f"{_instant(begin)} to {_instant(end)}")
    return said + ([f"by a course of {len(c.course)} points over {c.course[-1][0]:.4g} s"] if c.course else [])


def _instant(time: float) -> str:
    """An instant as its date; of a clock that began with its log the seconds."""
    shown, _, unit = estimate_for_people(time, 0.0, "s")
    return shown if isinstance(shown, str) else f"{shown:.4g} {unit}"
