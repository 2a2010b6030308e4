"""The model file: the contract between identification, nodes, simulator and the discrepancy workflow."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from winch_friction.physics.channels import factor_to_si
from winch_friction.physics.errors import InputError, Problems, meant
from winch_friction.physics.friction import FrictionModel, registered_terms, term_named
from winch_friction.physics.friction.symbols import CONSTANTS
from winch_friction.physics.friction.term import Parameter, Term, unique_parameters
from winch_friction.records.atomic import write_text
from winch_friction.records.corrections import corrections_content, read_corrections, read_tables, tables_content
from winch_friction.records.schemas import with_all_problems
from winch_friction.records.strict_yaml import Section, expect_kind, finite, parse_yaml, read_yaml, shipped, spread

SCHEMA = "winch_friction.model/1"
LARGEST_STD = 1e150  # SI: of two, the product is a covariance, and no number of a computer from 1.8e308 on
SYMMETRIC = 1e-6  # what a correlation may miss by that was written with six digits or more


def load_model(name: str | Path) -> FrictionModel:
    """A model by path or shipped name; raises `InputError` for anything that is not a complete model file."""
    path = shipped("models", name)
    content = read_yaml(path)
    expect_kind(content, "model", str(path))
    try:
        return model_from_content(content, str(path))
    except InputError as error:
        raise with_all_problems(error, content, "model", str(path)) from None


def model_from_text(text: str, where: str = "model text") -> FrictionModel:
    """A model from the text that travels on the `friction_model` topic."""
    return model_from_content(parse_yaml(text, where), where)


def save_model(model: FrictionModel, path: Path) -> Path:
    """Write a model file atomically."""
    return write_text(path, model_to_text(model))


def model_to_text(model: FrictionModel) -> str:
    """The model file's text; reading it back gives the same numbers."""
    return yaml.safe_dump(_content(model), sort_keys=False, allow_unicode=True, width=110, default_flow_style=None)


def model_from_content(content: Any, where: str) -> FrictionModel:
    """A model from parsed YAML."""
    top = Section(content, where)
    _check_schema(top)
    tables = read_tables(top) if "tables" in top else {}
    terms = _terms(top, tables)
    entries = _entries(top, terms)
    model = FrictionModel(
        name=top.text("name"),
        terms=terms,
        values=tuple(entry.value for entry in entries),
        covariance=_covariance(top, entries),
        bounds={entry.name: entry.bounds for entry in entries if entry.bounds},
        constants=_constants(top),
        provenance=_provenance(top),
        corrections=read_corrections(top) if "corrections" in top else (),
        crane=top.text("crane", ""),
    )
    top.get("description")
    top.close()
    return model


def _terms(top: Section, tables: Mapping[str, Term]) -> tuple[Term, ...]:
    problems, terms = Problems(), []
    for name in _term_names(top):
        with problems:
            terms.append(tables[name] if name in tables else term_named(name))
    if problems.found:  # whatever else is wrong is told beside the terms that are known
        with problems:
            _entries(top, tuple(terms), complete=False)
        raise InputError(*(each if each.startswith(top.where) else f"{top.where}: {each}" for each in problems.found))
    return tuple(terms)


def _entries(top: Section, terms: tuple[Term, ...], complete: bool = True) -> "list[_Entry]":
    """The parameters of the terms; all that is wrong with them is said at once."""
    section, problems, entries = top.section("parameters"), Problems(), []
    for parameter in unique_parameters(terms):
        with problems:
            entries.append(_Entry(section, parameter))
    # beside an unknown term a parameter may be its own
    known = [parameter.name for parameter in unique_parameters(terms)]
    others = {parameter.name for term in registered_terms().values() for parameter in term.parameters}
    for name in map(str, section.content):
        if not complete and (name in others or not meant(name, known)):
            section.get(name)
    with problems:
        section.close()
    problems.say()
    return entries


class _Entry:
    """One parameter's entry: value, unit, bounds, std."""

    def __init__(self, parent: Section, parameter: Parameter) -> None:
        section = parent.section(parameter.name)
        factor = factor_to_si(str(section.need("unit")), parameter.unit, section.where)
        self.name, self.factor, self.unit = parameter.name, factor, f" {parameter.unit}".removesuffix(" 1")
        self.value = section.number("value") * factor
        lower, upper = section.get("lower"), section.get("upper")
        self.bounds = self._bounds(parameter, lower, upper, section.where)
        self.std = self._std(section)
        self._check_value(parameter, section.where)
        section.close()

    def _std(self, section: Section) -> float | None:
        if "std" not in section:
            return None
        std = spread(section) * self.factor
        if std > LARGEST_STD:
            raise InputError(f"{section.where}: std must be {LARGEST_STD:g}{self.unit} or less, found {std:g}")
        return std

    def _check_value(self, parameter: Parameter, where: str) -> None:
        low, high = self.bounds or (parameter.lower, parameter.upper)
        if not low <= self.value <= high:
            other = "" if self.bounds else "; a machine of another size states its own lower and upper beside it"
            raise InputError(
                f"{where}: value {self.value:g}{self.unit} is outside {low:g} ... {high:g}{self.unit}{other}"
            )

    def _bounds(self, parameter: Parameter, lower: Any, upper: Any, where: str) -> tuple[float, float] | None:
        if lower is None and upper is None:
            return None
        low = parameter.lower if lower is None else finite(lower, f"{where}: lower") * self.factor
        high = parameter.upper if upper is None else finite(upper, f"{where}: upper") * self.factor
        if low > high:
            raise InputError(f"{where}: lower {low:g}{self.unit} is above upper {high:g}{self.unit}")
        return low, high


def _check_schema(top: Section) -> None:
    schema = top.text("schema")
    if schema != SCHEMA:
        raise InputError(f"{top.where}: schema '{schema}' is not '{SCHEMA}'")


def _term_names(top: Section) -> list[str]:
    names = top.need("terms")
    if not isinstance(names, list) or len(set(map(str, names))) != len(names):
        raise InputError(f"{top.where}: terms must be a list of different term names, [] for a winch without friction")
    return [str(name) for name in names]


def _covariance(top: Section, entries: list[_Entry]) -> np.ndarray | None:
    stds = np.array([np.nan if entry.std is None else entry.std for entry in entries])
    if np.isnan(stds).all():
        if "correlation" in top:
            raise InputError(f"{top.where}: correlation without deviations: give every parameter a std, or drop it")
        return None
    if np.isnan(stds).any():
        raise InputError(
            f"{top.where}: parameters: {entries[int(np.isnan(stds).argmax())].name} lacks 'std' though others have it"
        )
    return _correlations(top, len(entries)) * np.outer(stds, stds)


def _correlations(top: Section, size: int) -> np.ndarray:
    """The matrix as it stands; ones on its diagonal, or it would change the standard deviations beside it."""
    given = top.get("correlation") or np.eye(size).tolist()
    rows = given if isinstance(given, list) and all(isinstance(row, list) for row in given) else []
    if [len(row) for row in rows] != [size] * size:
        raise InputError(f"{top.where}: correlation must be {size} x {size}, in the order of the parameters")
    where = f"{top.where}: correlation: row"
    matrix = np.array(
        [[finite(x, f"{where} {i}, column {k}") for k, x in enumerate(row, 1)] for i, row in enumerate(rows, 1)]
    ).reshape(size, size)
    problems = [
        f"{where} {i + 1}, column {k + 1} is {matrix[i, k]:g} and its mirror {matrix[k, i]:g}; it must be symmetric"
        for i, k in np.argwhere(np.abs(matrix - matrix.T) > SYMMETRIC)
        if i < k
    ] + [
        f"{where} {k + 1}, column {k + 1} must be 1, found {matrix[k, k]:g}: the size of a deviation belongs into std"
        for k in np.flatnonzero(np.abs(np.diag(matrix) - 1.0) > SYMMETRIC)
    ]
    if problems:
        raise InputError(*problems)
    if size and np.linalg.eigvalsh(matrix).min() < -SYMMETRIC:
        raise InputError(f"{top.where}: correlation is not positive semi-definite: no parameters vary together so")
    return matrix


def _provenance(top: Section) -> dict[str, Any]:
    return dict(top.section("provenance").content) if top.get("provenance") is not None else {}


def _constants(top: Section) -> dict[str, float]:
    if "constants" not in top:
        return {}
    section = top.section("constants")
    for each in CONSTANTS:
        section.get(each.name)  # known, whether this file has it or not
    values = {each.name: section.quantity(each.name, each.unit) for each in CONSTANTS if each.name in section}
    section.close()
    wrong = []
    for each in CONSTANTS:
        low, high = each.limits
        value = values.get(each.name, low)
        if not low <= value <= high:
            shown = f"{each.name} is {value:.4g} {each.unit}".removesuffix(" 1")
            wrong.append(f"{section.where}: {shown}, outside {low:g} ... {high:g}; is the unit right?")
    if wrong:
        raise InputError(*wrong)
    return values


def _content(model: FrictionModel) -> dict[str, Any]:
    content: dict[str, Any] = {"schema": SCHEMA, "name": model.name}
    if model.crane:
        content["crane"] = model.crane
    content["terms"] = list(model.term_names)
    if model.constants:
        units = {each.name: each.unit for each in CONSTANTS}
        content["constants"] = {k: {"value": float(v), "unit": units[k]} for k, v in model.constants.items()}
    if any(term.table is not None for term in model.terms):
        content["tables"] = tables_content(model.terms)
    content["parameters"] = {p.name: _entry_content(model, k, p) for k, p in enumerate(model.parameters)}
    if model.covariance is not None and np.any(model.covariance - np.diag(np.diag(model.covariance))):
        content["correlation"] = _correlation(model.covariance)
    if model.corrections:
        content["corrections"] = corrections_content(model.corrections)
    if model.provenance:
        content["provenance"] = _plain(model.provenance)
    return content


def _entry_content(model: FrictionModel, index: int, parameter: Parameter) -> dict[str, Any]:
    lower, upper = model.bounds_of(parameter.name)
    entry: dict[str, Any] = {"value": float(model.values[index]), "unit": parameter.unit}
    if model.covariance is not None:
        entry["std"] = float(model.std[index])
    if np.isfinite(lower):
        entry["lower"] = float(lower)
    if np.isfinite(upper):
        entry["upper"] = float(upper)
    return entry


def _correlation(covariance: np.ndarray) -> list[list[float]]:
    scale = np.sqrt(np.diag(covariance))
    scale = np.where(scale > 0.0, scale, 1.0)
    correlation = covariance / np.outer(scale, scale)
    np.fill_diagonal(correlation, 1.0)
    return [[float(value) for value in row] for row in correlation]


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(key): _plain(each) for key, each in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(each) for each in value]
    return value.item() if isinstance(value, np.generic) else value
