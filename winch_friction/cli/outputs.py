"""What the verbs ask of the place they write to, before they work: no input and no other kind of file is lost."""

from collections.abc import Iterable
from pathlib import Path

from winch_friction.physics.errors import InputError

PAGE = (".html", ".htm")
MODEL = (".yaml", ".yml", "")


def refuse_input_as_output(out: Path | None, inputs: Iterable[Path | str | None]) -> None:
    """Raise `InputError` where what is to be written is one of what is read."""
    if out is None:
        return
    for each in inputs:
        if each and Path(each).exists() and Path(each).resolve() == out.resolve():
            raise InputError(f"--out {out}: is an input and would be overwritten; give another name")


def refuse_other_kind(out: Path | None, suffixes: tuple[str, ...], what: str) -> None:
    """Raise `InputError` where a page or a model is to be written under the name of another kind of file."""
    if out is not None and out.suffix.lower() not in suffixes:
        raise InputError(f"--out {out}: {what} is written as {suffixes[0]}; give a name that ends so")
