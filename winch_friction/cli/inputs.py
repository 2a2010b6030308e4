"""What the verbs ask before they work: of their inputs, which runs, of which crane, and can that be; of the places that
they write to, that no input and no other kind of file is lost. And what they say meanwhile.
"""

import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence, Sized
from functools import partial
from hashlib import sha256
from pathlib import Path
from tempfile import TemporaryFile
from typing import Any, TypeVar

from rich import progress as drawn
from rich.console import Console

from winch_friction.cli import Modes
from winch_friction.cli.console import stderr
from winch_friction.fleet.recordings import RUN_SUFFIXES, TRUTH
from winch_friction.physics.errors import InputError, Problems
from winch_friction.records.atomic import taken

T = TypeVar("T")


# -- what they say meanwhile
def show_warnings(warnings: Iterable[str]) -> None:
    """Warnings on stderr, one line each."""
    for warning in () if Modes.quiet else warnings:
        print(f"warning: {warning}", file=sys.stderr)


def progress(items: Iterable[T], description: str, total: int | None = None) -> Iterator[T]:
    """The items one by one, with a bar on stderr while a person is watching."""
    if total is None and isinstance(items, Sized):
        total = len(items)
    with bar_of_work() as bar:
        yield from bar.track(items, total=total, description=description)


def bar_of_work() -> drawn.Progress:
    """What is done of how much, for how long, and how long still; on a terminal only."""
    columns = (
        drawn.SpinnerColumn(),
        drawn.TextColumn("{task.description}"),
        drawn.BarColumn(),
        drawn.MofNCompleteColumn(),
        drawn.TimeElapsedColumn(),
        drawn.TextColumn("left"),
        drawn.TimeRemainingColumn(),
    )
    watched = stderr.is_terminal and not (Modes.quiet or Modes.plain)
    # rich 13.7 (Ubuntu 24.04's) ends a bar that is not drawn with an empty line
    console = stderr if watched else Console(quiet=True)
    return drawn.Progress(*columns, console=console, transient=True, disable=not watched)


# -- which runs, of which crane
def run_paths(paths: Sequence[Path]) -> list[Path]:
    """Run files named one by one or by folder; a folder with metadata.yaml is a bag, truth files are no runs."""
    found: list[Path] = []
    for path in map(Path, paths):
        found += _runs_in(path) if path.is_dir() and not (path / "metadata.yaml").is_file() else [path]
    if not found and paths:
        kinds = ", ".join(RUN_SUFFIXES)
        raise InputError(f"{', '.join(map(str, paths))}: no run in there ({kinds} or a rosbag2 folder)")
    return found


def _runs_in(folder: Path) -> list[Path]:
    """A folder's runs; a folder of bag files whose recorder was killed before it wrote metadata.yaml is one bag."""
    inside = [each for each in sorted(folder.iterdir()) if _is_run(each)]
    storage = [each for each in inside if each.suffix.lower() in (".mcap", ".db3")]
    return [folder] if len(storage) == len(inside) == 1 else inside


def _is_run(path: Path) -> bool:
    if path.stem.endswith(TRUTH) or path.name.startswith("."):
        return False
    return path.suffix.lower() in RUN_SUFFIXES if path.is_file() else (path / "metadata.yaml").is_file()


def load_terms(path: Path | None) -> None:
    """Register the friction terms of a user's file, where one is given."""
    if path is not None:
        from winch_friction.physics.friction.term import load_file

        load_file(path)


def read_all(paths: Sequence[Path], crane: Any, **options: Any) -> list[Any]:
    """The runs of these files, with a bar; whatever is wrong with any of them is said at once."""
    from winch_friction.records.runs import read_run

    runs, problems = [], Problems()
    for path in progress(paths, "reading runs"):
        with problems:
            runs.append(read_run(path, crane, **options))
    problems.say()
    return runs


def read_inputs(
    paths: Sequence[Path],
    crane: str,
    model: str,
    options: Mapping[str, Any] | None = None,
    remarks: Callable[[Any], Iterable[str]] = lambda model: (),
    before: Sequence[str] = (),
) -> tuple[list[Any], Any, Any]:
    """The runs, their crane and the model (None without a name); whatever is wrong with any of them is said at once,
    after the problems `before`. `options` are for bags; `remarks` are what is to be told of the model on stderr.
    """
    problems = Problems()
    winch, seed = machine_of(crane, model, paths, problems)
    runs: list[Any] = []
    if seed is not None:
        show_warnings(remarks(seed))
    with problems:
        runs = read_all(paths, winch, complete=winch is not None, **(options or {}))
    problems.say(*before)
    return runs, winch, seed


def machine_of(crane: str, model: str, paths: Sequence[Path], problems: Problems) -> tuple[Any, Any]:
    """The crane and the model (None without a name); what is wrong with them, or speaks against both, is gathered."""
    from winch_friction.physics.friction.model import completed, refuse_other_crane
    from winch_friction.records.model_file import load_model

    seed, winch = None, None
    with problems:
        seed = load_model(model) if model else None
    if crane or not problems.found:  # a model that cannot be read names no crane
        with problems:
            winch = crane_of(crane, seed, paths)
    with problems:
        if seed is not None and winch is not None:
            refuse_other_crane(seed, winch)
            seed = completed(seed, winch)
    return winch, seed


def refuse_copies(runs: Sequence[Any]) -> None:
    """Raise `InputError` where two runs hold the same samples: what a fit has seen would prove it."""
    seen: dict[bytes, Any] = {}
    for run in runs:
        content = b"".join(run[name].astype(float).tobytes() for name in ("time", "motor_speed"))
        other = seen.setdefault(sha256(content).digest(), run)
        if other is not run:
            raise InputError(
                f"{other.name} and {run.name} hold the same samples{_exchanged(other, run)}: a copy proves nothing; "
                "give each run once"
            )


def _exchanged(one: Any, two: Any) -> str:
    """What is said of a copy in which somebody exchanged the ports of motor groups."""
    import numpy as np

    groups = [
        group
        for group in one.groups
        if all(
            np.array_equal(one.column(f"{group}.pressure_{a}"), two.column(f"{group}.pressure_{b}"))
            for a, b in ("ab", "ba")
        )
    ]
    return f", ports A and B of {', '.join(groups)} exchanged in one of them" if groups else ""


def crane_of(crane: str, model: Any = None, paths: Sequence[Path] = ()) -> Any:
    """The crane that is named, else the one that the model or the runs say they are of, which is told on stderr.

    `model` is a loaded model or None. Raises `InputError` where nobody says: no crane is assumed.
    """
    from winch_friction.records.crane_file import load_crane

    if crane:
        return load_crane(crane)
    recorded, by = (model.crane, f"model '{model.name}'") if model is not None and model.crane else ("", "")
    if not recorded:
        recorded, by = recorded_crane(paths)
    if not recorded:
        raise InputError("which crane? Give --crane with a crane file or a shipped name (winch-friction init crane)")
    try:
        loaded = load_crane(recorded)
    except InputError as error:
        raise InputError(f"{by} is of crane '{recorded}': give its file with --crane ({error})") from None
    show_warnings([f"no --crane: taken as '{recorded}', as {by} says"])
    return loaded


def recorded_crane(paths: Sequence[Path]) -> tuple[str, str]:
    """The crane that the first run says it is of, and in words which run that is; '' where it says nothing."""
    from winch_friction.records.runs import read_run

    for path in list(paths)[:1]:
        try:
            return str(read_run(path, None, complete=False).metadata.get("crane") or ""), f"run '{path.name}'"
        except InputError:
            break  # whatever is wrong with the run is said when it is read for good
    return "", ""


def refuse_implausible(
    runs: Sequence[Any], crane: Any, model: Any = None, force: bool = False, near: Sequence[Path] = (),
    told: Callable[[Sequence[str]], object] = lambda _: None,
) -> dict[str, Any]:  # fmt: skip
    """Refuse runs that cannot be this crane's in one sentence; with `force` only warn.

    `near` are paths beside which the user's other cranes may lie; `told` hears what is doubted. Returns what a result's
    provenance is to hold: nothing where the data are plausible, `forced` with the sentence where they are not.
    """
    from winch_friction.commissioning.channels import first_contradiction
    from winch_friction.commissioning.check import quick_check, refuse
    from winch_friction.commissioning.other_cranes import cranes_near

    findings = quick_check(runs, crane, model, partial(cranes_near, near))
    doubts = [each.sentence for each in findings if each.severity == "warning"]
    show_warnings(doubts)
    told(doubts)
    contradiction = first_contradiction(findings)
    if contradiction is None:
        return {}
    if not force:
        refuse(findings)
    show_warnings([f"--force: {contradiction.sentence}"])
    return {"forced": contradiction.sentence}


# -- where they write to
_HEAD = 1 << 16  # bytes of a file, within which it says its schema or title
PAGE = (".html", ".htm")
MODEL = (".yaml", ".yml", "")
FILES = (*PAGE, *MODEL[:2], ".json", ".csv", ".parquet")


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
        if place is None or not taken(place, overwrite):
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
    if out is not None and not taken(out / mark, overwrite) and not out.exists() and out.suffix.lower() in FILES:
        raise InputError(f"--out {out}: this verb writes a folder of files; give a name without {out.suffix}")
    if out is None or not out.is_dir():
        return
    made = out / mark
    if made.is_file() and schema.encode() in made.read_bytes()[:_HEAD]:
        if overwrite:
            return
        raise InputError(f"--out {out}: holds an earlier result ({mark}); give another folder, or use --overwrite")
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
