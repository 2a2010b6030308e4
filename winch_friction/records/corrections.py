"""The sections of a model file beside its terms: `corrections` and `tables`.

`corrections`: what is wrong with signals, geometry, load and inertia:
`{pressure_offset: {value: 1.5, unit: bar, std: 0.1, source: zero check, groups: [active]}}`; the same correction for
several groups, layers or times is a list under its name. `tables`: tabulated terms, so that the file needs no code
beside it.
"""

from collections.abc import Sequence
from typing import Any

from winch_friction.physics.channels import dimension_of, factor_to_si, product
from winch_friction.physics.errors import InputError, Problems
from winch_friction.physics.friction import registered_terms
from winch_friction.physics.friction.correction import Correction, check_corrections
from winch_friction.physics.friction.declared_correction import declared_correction
from winch_friction.physics.friction.table import FACTORS, Table, tabulated
from winch_friction.physics.friction.term import Scope, Term
from winch_friction.records.strict_yaml import Section, as_quantity, finite
from winch_friction.records.unit_names import conversion_to_si


def read_corrections(top: Section) -> tuple[Correction, ...]:
    """The corrections of a model file in SI; raises `InputError`, naming file and entry, for what is not one."""
    section = top.section("corrections")
    found, problems = list[Correction](), Problems()
    for name in section.content:
        entry = section.get(name)
        entries = entry if isinstance(entry, list) else [entry]
        many = isinstance(entry, list)
        for k, each in enumerate(entries):
            where = f"{section.where}: {name}" + (f"[{k + 1}]" if many else "")
            with problems:
                found.append(_correction(str(name), Section(each, where)))
    try:
        check_corrections(tuple(found))
    except InputError as error:
        with problems:
            raise InputError(f"{top.where}: {error}") from None
    problems.say()
    return tuple(found)


def corrections_content(corrections: Sequence[Correction]) -> dict[str, Any]:
    """Corrections as plain data for a model file."""
    content: dict[str, Any] = {}
    for each in corrections:
        content.setdefault(each.name, []).append(_entry(each))
    return {name: entries[0] if len(entries) == 1 else entries for name, entries in content.items()}


def _correction(name: str, section: Section) -> Correction:
    try:
        declared = declared_correction(name)
    except InputError as error:
        raise InputError(f"{section.where}: {error}") from None
    factor = _factor(section, declared.parameter.unit)

    def number(key: str) -> float | None:
        return finite(section.get(key), f"{section.where}: {key}") * factor if key in section else None

    value, tau = section.number("value") * factor, section.get("time_constant")
    fields = {key: number(key) for key in ("std", "lower", "upper")}
    groups, layers, source = _names(section, "groups", str), _names(section, "layers", int), section.text("source", "")
    during, beyond = _windows(section), section.get("beyond") if "beyond" in section else None
    course = _course(section)
    section.close()
    time_constant = None if tau is None else as_quantity(tau, "s", f"{section.where}: time_constant")
    if beyond is not None:
        beyond = as_quantity(beyond, declared.bends_in or "1", f"{section.where}: beyond")
    try:
        return Correction(
            name, value, source=source, groups=groups, layers=layers, time_constant=time_constant, during=during,
            beyond=beyond, course=course, **fields,
        )  # fmt: skip
    except InputError as error:
        raise InputError(f"{section.where}: {error}") from None


def _factor(section: Section, si_unit: str) -> float:
    """Factor from the entry's unit to SI; a unit that the nodes' own table does not know is left to pint."""
    unit = {"%": "percent"}.get(section.text("unit"), section.text("unit"))
    try:
        return factor_to_si(unit, si_unit, section.where)
    except InputError:
        return conversion_to_si(unit, si_unit, section.where)[0]


def _names(section: Section, key: str, kind: type) -> tuple[Any, ...]:
    if key not in section:
        return ()
    given = section.get(key)
    whole = isinstance(given, list) and all(isinstance(each, kind) and not isinstance(each, bool) for each in given)
    if not whole or not given or len(set(given)) != len(given):
        what = "motor groups" if kind is str else "wire layers, from 1"
        raise InputError(f"{section.where}: {key} must be a list of different {what}, found {given!r}")
    return tuple(given)


def _windows(section: Section) -> tuple[tuple[float, float], ...]:
    """Windows of absolute time in s, `[[from, to], ...]`; the last may be open, `.inf`."""
    given, where = _pairs(section, "during", "windows [from, to] in s", 1), f"{section.where}: during"
    return tuple((finite(w[0], where), w[1] if w[1] == float("inf") else finite(w[1], where)) for w in given)


def _course(section: Section) -> tuple[tuple[float, float], ...]:
    """Points of a delay's course, `[[s since the run began, share], ...]`."""
    given, where = _pairs(section, "course", "points [s since the run began, share]", 2), f"{section.where}: course"
    return tuple((finite(p[0], where), finite(p[1], where)) for p in given)


def _pairs(section: Section, key: str, what: str, fewest: int) -> list[list[Any]]:
    """A list of so many pairs or more; empty where the key is not there."""
    if key not in section:
        return []
    given = section.get(key)
    whole = isinstance(given, list) and len(given) >= fewest
    wrong = [each for each in given if not (isinstance(each, list) and len(each) == 2)] if whole else [given]
    if wrong:
        raise InputError(f"{section.where}: {key} must be a list of {what}, found {wrong[0]!r}")
    return list(given)


def _entry(c: Correction) -> dict[str, Any]:
    entry: dict[str, Any] = {"value": float(c.value), "unit": c.declared.parameter.unit}
    if c.std is not None:
        entry["std"] = float(c.std)
    entry |= {"lower": float(c.bounds[0]), "upper": float(c.bounds[1])}
    if c.source:
        entry["source"] = c.source
    if c.groups:
        entry["groups"] = list(c.groups)
    if c.layers:
        entry["layers"] = list(c.layers)
    if c.time_constant is not None:
        entry["time_constant"] = {"value": float(c.time_constant), "unit": "s"}
    if c.beyond is not None:
        entry["beyond"] = {"value": float(c.beyond), "unit": c.declared.bends_in}
    if c.during:
        entry["during"] = [list(window) for window in c.during]
    if c.course:
        entry["course"] = [list(map(float, point)) for point in c.course]
    return entry


# -- tabulated terms
def read_tables(top: Section) -> dict[str, Term]:
    """The tabulated terms of a model file by name; `InputError` says what is wrong with one."""
    section = top.section("tables")
    found = {name: _read(section.section(name), name) for name in map(str, section.content)}
    section.close()
    for name in found.keys() & registered_terms().keys():
        raise InputError(f"{section.where}: a term '{name}' exists already; give the table another name")
    return found


def _read(section: Section, name: str) -> Term:
    knots = section.section("knots")
    table = Table(
        name,
        tuple((signal, _knots(knots, signal)) for signal in map(str, knots.content)),
        section.text("unit"),
        tuple(map(str, section.get("times") or ())),
        _scope(section),
        bool(section.get("opposing", True)),
        section.text("shape", "free"),
        section.text("anchor", "none"),
        float(finite(section.get("typical", 1.0), f"{section.where}: typical")),
        section.text("place", "gear and drum"),
        section.text("source", "tabulated"),
        section.text("side", "both"),
        tuple(finite(each, f"{section.where}: weights") for each in section.get("weights") or ()),
    )
    knots.close()
    section.close()
    factors = [(table.unit, 1.0), *((FACTORS[each][1], 1.0) for each in table.times)]
    if product(*factors) != dimension_of("N*m"):
        raise InputError(f"{section.where}: unit {table.unit} times {', '.join(table.times) or '1'} is not N*m")
    return tabulated(table)


def _knots(section: Section, signal: str) -> tuple[float, ...]:
    values = section.need(signal)
    if not isinstance(values, list):
        raise InputError(
            f"{section.where}: {signal} must be a list of values in {FACTORS[signal][1] if signal in FACTORS else 'SI'}"
        )
    return tuple(finite(value, f"{section.where}: {signal}") for value in values)


def _scope(section: Section) -> Scope:
    text = section.text("scope")
    if text not in [each.value for each in Scope]:
        raise InputError(f"{section.where}: scope '{text}' is none of {', '.join(each.value for each in Scope)}")
    return Scope(text)


def tables_content(terms: tuple[Term, ...]) -> dict[str, Any]:
    """The section's content for a model's terms; empty without tabulated ones."""
    return {term.name: _content(term.table) for term in terms if term.table is not None}


def _content(table: Table) -> dict[str, Any]:
    return {
        "knots": {signal: list(at) for signal, at in table.knots}, "unit": table.unit, "times": list(table.times),
        "scope": table.scope.value, "opposing": table.opposing, "shape": table.shape, "anchor": table.anchor,
        "typical": table.typical, "place": table.place, "source": table.source,
    } | ({"side": table.side} if table.side != "both" else {}) | (
        {"weights": list(table.weights)} if table.weights else {}
    )  # fmt: skip
