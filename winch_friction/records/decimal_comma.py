"""Columns of a CSV file whose numbers have a comma where a point is expected: told once for a file."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from winch_friction.physics.errors import InputError, Problems

MOST_NAMED = 3  # columns


def has_decimal_commas(bad: Sequence[tuple[int, str]], number: Callable[[str], float | None]) -> bool:
    """Whether all cells of a column that are no `number` (row and text) are one with a point for their comma."""
    return all("," in text and number(text.replace(",", ".")) is not None for _, text in bad)


def refuse_decimal_commas(path: Path, shown: Mapping[str, str], problems: Problems) -> None:
    """Raise `InputError` for these columns, each with a cell that shows it, and for what else was found."""
    names = [f"'{name}'" for name in shown]
    more = f" and {len(names) - MOST_NAMED} more" if len(names) > MOST_NAMED else ""
    with problems:
        raise InputError(
            f"{path}: numbers with a decimal comma in {'column' if len(names) == 1 else 'columns'} "
            f"{', '.join(names[:MOST_NAMED])}{more} (as {next(iter(shown.values()))}); winch-friction import reads "
            "such logs, or write them with a point"
        )
    problems.say()
