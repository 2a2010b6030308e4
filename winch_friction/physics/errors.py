"""The one error that bad input raises, and how several of them are said at once."""

from collections.abc import Iterable
from difflib import get_close_matches
from types import TracebackType


class InputError(ValueError):
    """Bad input, said in one line a problem: what, where (file, row, column, parameter) and what to do.

    `problems` are those lines; as text they stand in one line.

    >>> import winch_friction as wf
    >>> try:
    ...     wf.load_crane("no_such_crane")
    ... except wf.InputError as error:
    ...     print("no_such_crane" in str(error), len(error.problems))
    True 1
    """

    def __init__(self, *problems: str) -> None:
        self.problems = tuple(" ".join(each.split()) for each in problems)
        super().__init__(" | ".join(self.problems))


class Problems:
    """Gathers the `InputError`s of several `with` blocks, so that all of them are said at once.

    >>> problems = Problems()
    >>> with problems:
    ...     raise InputError("no crane")
    >>> problems.found
    ['no crane']
    """

    def __init__(self) -> None:
        self.found: list[str] = []

    def __enter__(self) -> "Problems":
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> bool:
        if not isinstance(error, InputError):
            return False
        self.found += [each for each in error.problems if each not in self.found]
        return True

    def say(self) -> None:
        """Raise `InputError` with whatever was gathered; nothing, where nothing was."""
        if self.found:
            raise InputError(*self.found)


def meant(name: str, known: Iterable[str]) -> str:
    """' did you mean ...?' where a name is nearly a known one, otherwise nothing."""
    near = get_close_matches(name, sorted(set(known)), n=3, cutoff=0.75)
    return f" did you mean {' or '.join(near)}?" if near else ""


def unknown_key(key: str, known: Iterable[str]) -> str:
    """What is said of a key that a file cannot have: what may be meant, or else which keys there are."""
    known = list(known)
    return f"unknown key '{key}';" + (meant(key, known) or f" known keys are {', '.join(known)}")
