"""What the verbs ask of the place they write to, before they work: no input and no other kind of file is lost."""

from collections.abc import Iterable
from pathlib import Path
from tempfile import TemporaryFile

from winch_friction.physics.errors import InputError

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


def refuse_unwritable(*places: Path | None) -> None:
    """Raise `InputError` where one of these files cannot be written: before the work, not behind it."""
    for place in places:
        if place is None:
            continue
        folder = next(each for each in (place.absolute().parent, *place.absolute().parents) if each.exists())
        if not folder.is_dir():
            raise InputError(f"--out {place}: {folder} is a file, no folder; give another place")
        try:
            with TemporaryFile(dir=folder):
                pass
        except OSError as error:
            raise InputError(f"--out {place}: cannot be written ({error.strerror}); give another place") from None
