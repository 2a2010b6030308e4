"""What the verbs print, where they may write, and how their process keeps house.

Tables and progress are for people, JSON for machines. Before a verb works, it makes sure that no input and no other
kind of file is lost.
"""

import ctypes
import gc
import json
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence, Sized
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryFile
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

from winch_friction.cli import Modes
from winch_friction.physics.errors import InputError
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
    # rich 13.7 (Ubuntu 24.04's) ends a bar that is not drawn with an empty line
    console = stderr if watched else Console(quiet=True)
    return Progress(*columns, console=console, transient=True, disable=not watched)


def _plain(value: Any) -> str:
    return " ".join((f"{value:.4g}" if isinstance(value, float) else str(value)).split())


def _cell(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, float) else escape(str(value))  # [s] is a unit, no markup


# -- where they write to
_HEAD = 1 << 16  # bytes of a file, within which it says its schema or title
PAGE = (".html", ".htm")
MODEL = (".yaml", ".yml", "")


def refuse_input_as_output(out: Path | None, inputs: Iterable[Path | str | None]) -> None:
    """Raise `InputError` where what is to be written is one of what is read."""
    if out is None:
        return
    refuse_unwritable(out)
    for each in inputs:
        if each and Path(each).exists() and Path(each).resolve() == out.resolve():
            raise InputError(f"--out {out}: is an input and would be overwritten; give another name")


def refuse_other_kind(out: Path | None, suffixes: tuple[str, ...], what: str) -> None:
    """Raise `InputError` where a page or a model is to be written under the name of another kind of file."""
    if out is not None and out.suffix.lower() not in suffixes:
        raise InputError(f"--out {out}: {what} is written as {suffixes[0]}; give a name that ends so")
    refuse_unwritable(out)


def refuse_existing(overwrite: bool, *places: Path | None) -> None:
    """Raise `InputError` where one of these is there already: before the work. A bag is never overwritten."""
    for place in places:
        if place is None or not place.exists():
            continue
        if place.is_dir() or place.suffix in (".mcap", ".db3"):
            raise InputError(f"--out {place}: exists already, and a folder or bag is never replaced; give another name")
        if not overwrite:
            raise InputError(f"--out {place}: exists already; give another name, or --overwrite to replace it")


def refuse_foreign(out: Path | None, names: Sequence[str], mark: str, schema: str = "", overwrite: bool = True) -> None:
    """Raise `InputError` where a folder holds files that a verb writes, and they are not those of an earlier call.

    An earlier call has left `mark`, which says `schema`; the names may be patterns. Without `overwrite` an earlier
    result is refused as well. So is a folder that is to be made under the name of a file.
    """
    if out is not None and not out.exists() and out.suffix.lower() in (*PAGE, *MODEL[:2], ".json", ".csv"):
        raise InputError(f"--out {out}: this verb writes a folder of files; give a name without {out.suffix}")
    if out is None or not out.is_dir():
        return
    made = out / mark
    if made.is_file() and schema.encode() in made.read_bytes()[:_HEAD]:
        if overwrite:
            return
        raise InputError(
            f"--out {out}: holds an earlier result ({mark}); give another folder, or --overwrite to replace it"
        )
    there = sorted(each.name for name in names for each in out.glob(name))
    if there:
        raise InputError(
            f"--out {out}: holds {', '.join(there)}, no result of this verb: give a folder of its own, or move what is "
            "there"
        )


def refuse_unwritable(*places: Path | None, option: str = "--out") -> None:
    """Raise `InputError` where one of these files, given by `option`, cannot be written: before the work, not after."""
    for place in places:
        if place is None:
            continue
        folder = next(each for each in (place.absolute().parent, *place.absolute().parents) if each.exists())
        if not folder.is_dir():
            raise InputError(f"{option} {place}: {folder} is a file, no folder; give another place")
        try:
            with TemporaryFile(dir=folder):
                pass
        except OSError as error:
            raise InputError(f"{option} {place}: cannot be written ({error.strerror}); give another place") from None


# -- how their process keeps house
# How a verb's process keeps house, for one that makes and lets go objects and arrays all the time.
#
# A search takes some 100 000 arrays of 0.1 to 2 MB. glibc gives what is free at the end of its heap back to the system
# at once, and every page that is taken again costs a fault: 240 000 of them in a `gap` of twelve runs, a tenth of its
# processor time. The environment's `MALLOC_..._` variables would do the same, but a process cannot set its own.
#
# Python looks for garbage in cycles after every 700 new objects, and ever again goes through all that SymPy and numba
# hold, which is no garbage: another tenth. What a search lets go has no cycles and is freed without that.

# glibc's malloc.h; bytes
M_TRIM_THRESHOLD, KEPT_FREE = -1, 128 << 20  # a quarter of what a search of an hour holds at its peak
M_TOP_PAD, TAKEN_AHEAD = -2, 16 << 20
M_MMAP_THRESHOLD, ON_THEIR_OWN = -3, 4 << 20  # larger arrays still go back at once: they make the peak
RARELY = (20_000, 10, 20)  # objects more, looks at the youngest, looks at the middle: some twenty looks in a search


@contextmanager
def search_at_hand() -> Iterator[None]:
    """Keep what is freed, and look for garbage rarely until the end."""
    keep_freed_memory()
    before = gc.get_threshold()
    gc.set_threshold(*RARELY)
    try:
        yield
    finally:
        gc.set_threshold(*before)


def keep_freed_memory() -> bool:
    """Let this process keep what it has freed for what it takes next; False where the C library is not glibc."""
    try:
        mallopt = ctypes.CDLL(None).mallopt
    except (OSError, AttributeError, TypeError):
        return False
    pairs = ((M_MMAP_THRESHOLD, ON_THEIR_OWN), (M_TRIM_THRESHOLD, KEPT_FREE), (M_TOP_PAD, TAKEN_AHEAD))
    return {mallopt(option, size) for option, size in pairs} == {1}
