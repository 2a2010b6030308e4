"""`winch-friction bench`: the figures of bench/ as one table."""

import importlib
import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from winch_friction.cli.console import progress, show_json, show_table
from winch_friction.cli.optional import OptionalTexts
from winch_friction.physics.errors import InputError

_SUPPORT = ("pairs", "seas")  # what the benchmarks share


def command(
    names: Annotated[OptionalTexts, typer.Argument(help="Which benchmarks; all without a name.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="The figures as JSON.")] = False,
) -> None:
    """Measure speed as ratios against what one would use instead, side by side in one process.

    Examples:

      winch-friction bench

      winch-friction bench estimator replay --json
    """
    figures = {}
    for name in progress(_chosen(names or []), "measuring"):
        figures.update(importlib.import_module(name).measure())
    rows = {name: value if isinstance(value, dict) else {"value": value} for name, value in figures.items()}
    if as_json:
        show_json(rows)
        return
    columns = ("figure", "value", "unit", "against", "ratio", "wanted")
    show_table("Bench", columns, [[name, *_cells(row)] for name, row in rows.items()])


def _cells(row: dict[str, Any]) -> list[Any]:
    ratio = row.get("ratio")
    shown = f"{ratio:.3g}" if ratio is not None else ""
    return [f"{row['value']:.4g}", row.get("unit", ""), row.get("against", ""), shown, row.get("bar", "")]


def _chosen(names: list[str]) -> list[str]:
    """Modules of bench/, made importable; an unknown name raises `InputError` with those there are."""
    folder = Path(__file__).resolve().parents[2] / "bench"
    if not folder.is_dir():
        raise InputError(
            f"{folder}: not found; the benchmarks are part of the source checkout, not of the installation"
        )
    known = sorted(each.stem for each in folder.glob("*.py") if each.stem not in _SUPPORT)
    unknown = [name for name in names if name not in known]
    if unknown:
        raise InputError(f"benchmark '{unknown[0]}' does not exist; there are {', '.join(known)}")
    if str(folder) not in sys.path:
        sys.path.insert(0, str(folder))
    return names or known
