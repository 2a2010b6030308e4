"""`winch-friction bench`: the figures of bench/ as one table."""

import importlib
import subprocess
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import typer

from winch_friction.cli.console import show_json, show_table
from winch_friction.cli.inputs import progress
from winch_friction.cli.optional import OptionalPath, OptionalTexts
from winch_friction.physics.errors import InputError


def command(
    names: Annotated[OptionalTexts, typer.Argument(help="Which benchmarks; all without a name.")] = None,
    smoke: Annotated[bool, typer.Option("--smoke", help="Only show that every benchmark runs.")] = False,
    page: Annotated[OptionalPath, typer.Option("--page", help="Write the table as a Markdown page, too.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="The figures as JSON.")] = False,
) -> None:
    """Measure speed as ratios against what one would use instead, side by side in one process.

    Examples:

      winch-friction bench

      winch-friction bench estimator replay --json
    """
    rows: list[Any] = []
    commit = _commit()  # now: what is measured, whatever is committed meanwhile
    for name in progress(_chosen(names or []), "measuring"):
        rows += importlib.import_module(f"bench.{name}").measure(smoke)
    if page is not None:
        command_line = " ".join(["winch-friction bench", *(names or [])])
        importlib.import_module("bench.page").write_page(page, rows, command_line, commit)
    if as_json:
        show_json({row.name: asdict(row) | {"goal": row.goal, "met": row.met} for row in rows})
        return
    columns = ("figure", "value", "unit", "against", "ratio", "spread", "goal", "met")
    show_table("Bench", columns, [_cells(row) for row in rows])


def _cells(row: Any) -> list[Any]:
    against = f"{row.against}, {row.other:.3g} {row.unit}" if row.other is not None else row.against
    ratio = f"{row.ratio:.3g}" if row.ratio is not None else ""
    spread = f"{row.spread[0]:.3g} ... {row.spread[1]:.3g}" if row.spread else ""
    met = {True: "yes", False: "no", None: ""}[row.met]
    return [row.name, f"{row.value:.4g}", row.unit, against, ratio, spread, row.goal, met]


def _commit() -> str:
    """Short name of the checkout's commit."""
    root = Path(__file__).resolve().parents[2]
    found = subprocess.run(
        ["git", "-C", str(root), "rev-parse", "--short", "HEAD"], capture_output=True, text=True, check=False
    )
    return found.stdout.strip() or "unknown"


def _chosen(names: list[str]) -> list[str]:
    """Modules of bench/, made importable; an unknown name raises `InputError` with those there are."""
    root = Path(__file__).resolve().parents[2]
    if not (root / "bench" / "__init__.py").is_file():
        raise InputError(
            f"{root / 'bench'}: not found; the benchmarks are part of the source checkout, not of the installation"
        )
    if str(root) not in sys.path:
        sys.path.insert(0, str(root))
    known = list(importlib.import_module("bench").NAMES)
    unknown = [name for name in names if name not in known]
    if unknown:
        raise InputError(f"benchmark '{unknown[0]}' does not exist; there are {', '.join(known)}")
    return names or known
