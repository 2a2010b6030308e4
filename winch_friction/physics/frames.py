"""Runs and models as the tables people work with (pandas, xarray) and as a few lines for a notebook.

pandas and xarray are imported when they are asked for: the nodes need neither.
"""

from collections.abc import Iterable, Sequence
from html import escape
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np

from winch_friction.physics.errors import InputError

if TYPE_CHECKING:
    from winch_friction.physics.friction.model import FrictionModel
    from winch_friction.physics.signals import Run


def library(name: str, extra: str) -> Any:
    """An optional library; raises `InputError` that names the extra which installs it."""
    try:
        return import_module(name)
    except ModuleNotFoundError as error:
        raise InputError(f"the library '{name}' is not installed: pip install 'winch_friction[{extra}]'") from error


def run_frame(run: "Run", units: dict[str, str]) -> Any:
    """Columns over time; `attrs["units"]` names the SI unit of every column."""
    frame = library("pandas", "desk").DataFrame({name: np.asarray(values) for name, values in run.columns.items()})
    frame.attrs.update({"name": run.name, "units": units})
    return frame.set_index("time") if "time" in frame else frame


def run_dataset(run: "Run", units: dict[str, str]) -> Any:
    """Variables over the coordinate `time`; each carries its SI unit in `attrs["units"]`."""
    xarray = library("xarray", "xarray")
    variables = {name: ("time", np.asarray(v), {"units": units[name]}) for name, v in run.columns.items()}
    time = variables.pop("time")
    return xarray.Dataset(variables, coords={"time": time}, attrs={"name": run.name})


def model_frame(model: "FrictionModel") -> Any:
    """One row per parameter: value, std, unit, bounds, term, meaning."""
    owner = {p.name: term.name for term in model.terms for p in term.parameters}
    rows = [
        {"parameter": p.name, "value": value, "std": std if model.covariance is not None else float("nan"),
         "unit": p.unit, "lower": model.bounds_of(p.name)[0], "upper": model.bounds_of(p.name)[1],
         "term": owner[p.name], "meaning": p.doc}
        for p, value, std in zip(model.parameters, model.values, model.std, strict=True)
    ]  # fmt: skip
    return library("pandas", "desk").DataFrame(rows).set_index("parameter")


def html_table(title: str, columns: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    """A small table for a notebook; everything is escaped, numbers get four significant digits."""
    head = "".join(f"<th>{escape(column)}</th>" for column in columns)
    body = "".join("<tr>" + "".join(f"<td>{escape(shown(cell))}</td>" for cell in row) + "</tr>" for row in rows)
    return f"<p><strong>{escape(title)}</strong></p><table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def shown(value: Any) -> str:
    """A cell for people."""
    return f"{value:.4g}" if isinstance(value, float) else str(value)
