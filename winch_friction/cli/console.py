"""What the verbs print: tables and progress for people, JSON for machines."""

import json
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence, Sized
from contextlib import contextmanager
from typing import Any, TypeVar

from rich.console import Console
from rich.markup import escape
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    SpinnerColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.table import Table

from winch_friction.cli.modes import Modes
from winch_friction.records.plain import finite as finite

T = TypeVar("T")
PIPED_WIDTH = 140  # columns where nobody says: a file or a pipe has no edge, but people read it later


def _width() -> int | None:
    return None if sys.stdout.isatty() or os.environ.get("COLUMNS") else PIPED_WIDTH


class _Console(Console):
    """A console whose reader may go, as `| head` does: what rich would end with status 1 is the caller's matter."""

    def on_broken_pipe(self) -> None:
        """Rich calls this while it handles the error."""
        raise BrokenPipeError


stdout = _Console(width=_width())
stderr = _Console(stderr=True)


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


def show_warnings(warnings: Iterable[str]) -> None:
    """Warnings on stderr, one line each."""
    for warning in () if Modes.quiet else warnings:
        print(f"warning: {warning}", file=sys.stderr)


def progress(items: Iterable[T], description: str, total: int | None = None) -> Iterator[T]:
    """The items one by one, with a bar on stderr while a person is watching."""
    if total is None and isinstance(items, Sized):
        total = len(items)
    with _bar() as bar:
        yield from bar.track(items, total=total, description=description)


@contextmanager
def stepping(description: str, total: int) -> Iterator[Callable[[str], None]]:
    """A bar that moves by one each time the yielded function is told what begins."""
    with _bar() as bar:
        task = bar.add_task(description, total=total)
        begun = 0

        def tell(what: str) -> None:
            nonlocal begun
            bar.update(task, description=f"{description}: {what}", completed=begun)
            begun += 1

        yield tell


def _bar() -> Progress:
    """What is done of how much, for how long, and how long still; on a terminal only."""
    columns = (
        SpinnerColumn(),
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    watched = stderr.is_terminal and not (Modes.quiet or Modes.plain)
    return Progress(*columns, console=stderr, transient=True, disable=not watched)


def _plain(value: Any) -> str:
    return " ".join((f"{value:.4g}" if isinstance(value, float) else str(value)).split())


def _cell(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, float) else escape(str(value))  # [s] is a unit, no markup
