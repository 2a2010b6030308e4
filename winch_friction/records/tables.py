"""Tabulated terms in a model file: section `tables:`, so that the file needs no code beside it."""

from typing import Any

from winch_friction.physics.dimensions import dimension_of, product
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import registered_terms
from winch_friction.physics.friction.table import FACTORS, Table, tabulated
from winch_friction.physics.friction.term import Scope, Term
from winch_friction.records.strict_yaml import Section, finite


def read_tables(top: Section) -> dict[str, Term]:
    """The tabulated terms of a model file by name; `InputError` says what is wrong with one."""
    if "tables" not in top:
        return {}
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
    } | ({"side": table.side} if table.side != "both" else {})  # fmt: skip
