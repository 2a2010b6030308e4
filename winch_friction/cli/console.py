"""What the verbs print when they are done: tables are for people, JSON for machines."""

import json
import os
import sys
from collections.abc import Iterable, Sequence
from typing import Any

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from winch_friction.cli import Modes
from winch_friction.records.plain import finite as finite

PIPED_WIDTH = 140  # columns where nobody says: a file or a pipe has no edge, but people read it later


def _width() -> int | None:
    return None if sys.stdout.isatty() or os.environ.get("COLUMNS") else PIPED_WIDTH


class _Console(Console):
    """A console whose reader may go, as `| head` does: what rich would end with status 1 is the caller's matter."""

    def on_broken_pipe(self) -> None:
        """Rich calls this while it handles the error."""
        raise BrokenPipeError


stdout = _Console(width=_width(), emoji=False)  # a ratio 10:100:20 is no picture
stderr = _Console(stderr=True, emoji=False)


def show_table(title: str, columns: Sequence[str], rows: Iterable[Sequence[Any]]) -> None:
    """A table on stdout; numbers are aligned to the right."""
    rows = [list(row) for row in rows]
    if Modes.plain:
        lines = [title, "\t".join(columns), *("\t".join(_plain(value) for value in row) for row in rows)]
        print("\n".join(lines))
        return
    table = Table(title=escape(title), title_justify="left")
    for k, column in enumerate(columns):
        numeric = all(isinstance(row[k], (int, float)) for row in rows)
        table.add_column(escape(column), justify="right" if numeric else "left", overflow="fold")
    for row in rows:
        table.add_row(*(_cell(value) for value in row))
    stdout.print(table)


def show_json(content: Any) -> None:
    """JSON on stdout; not-a-number becomes null."""
    print(json.dumps(finite(content), indent=2, default=str))


def _plain(value: Any) -> str:
    return " ".join((f"{value:.4g}" if isinstance(value, float) else str(value)).split())


def _cell(value: Any) -> str:
    if isinstance(value, float) and value != value:
        return "–"  # as on the pages: there is none
    return f"{value:.4g}" if isinstance(value, float) else escape(str(value))  # [s] is a unit, no markup
