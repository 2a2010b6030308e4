"""What the verbs ask of their inputs before they work, which runs, of which crane, and can that be; and what is said
of them beside a result.
"""

import hashlib
import shlex
import subprocess
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np

from winch_friction.cli.console import progress, show_warnings
from winch_friction.fleet.recordings import RUN_SUFFIXES, TRUTH
from winch_friction.physics.errors import InputError, Problems


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
) -> tuple[list[Any], Any, Any]:
    """The runs, their crane and the model (None without a name); whatever is wrong with any of them is said at once.

    `options` are for bags; `remarks` are what is to be told of the model on stderr.
    """
    problems = Problems()
    winch, seed = machine_of(crane, model, paths, problems)
    runs: list[Any] = []
    if seed is not None:
        show_warnings(remarks(seed))
    with problems:
        runs = read_all(paths, winch, complete=winch is not None, **(options or {}))
    problems.say()
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
        content = b"".join(np.ascontiguousarray(run[name], float).tobytes() for name in ("time", "motor_speed"))
        other = seen.setdefault(sha256(content).digest(), run)
        if other is not run:
            raise InputError(
                f"{other.name} and {run.name} hold the same samples{_exchanged(other, run)}: a copy proves nothing; "
                "give each run once"
            )


def _exchanged(one: Any, two: Any) -> str:
    """What is said of a copy in which somebody exchanged the ports of motor groups."""
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
        recorded, by = _crane_of_runs(paths)
    if not recorded:
        raise InputError("which crane? Give --crane with a crane file or a shipped name (winch-friction init crane)")
    try:
        loaded = load_crane(recorded)
    except InputError as error:
        raise InputError(f"{by} is of crane '{recorded}': give its file with --crane ({error})") from None
    show_warnings([f"no --crane: taken as '{recorded}', as {by} says"])
    return loaded


def recorded_crane(paths: Sequence[Path]) -> str:
    """The crane that the first run says it is of; '' where it says nothing."""
    return _crane_of_runs(paths)[0]


def _crane_of_runs(paths: Sequence[Path]) -> tuple[str, str]:
    from winch_friction.records.runs import read_run

    for path in list(paths)[:1]:
        try:
            return str(read_run(path, None, complete=False).metadata.get("crane") or ""), f"run '{path.name}'"
        except InputError:
            break  # whatever is wrong with the run is said when it is read for good
    return "", ""


def folders_of_cranes(near: Sequence[Path]) -> list[Path]:
    """Where the user's other cranes may lie: here, and beside these files."""
    return list(dict.fromkeys([Path.cwd(), *(Path(each).resolve().parent for each in near)]))


def refuse_implausible(
    runs: Sequence[Any], crane: Any, model: Any = None, force: bool = False, near: Sequence[Path] = ()
) -> dict[str, Any]:
    """Refuse runs that cannot be this crane's in one sentence; with `force` only warn.

    `near` are paths beside which the user's other cranes may lie. Returns what a result's provenance is to hold:
    nothing where the data are plausible, `forced` with the sentence where they are not.
    """
    from winch_friction.commissioning.channels import first_contradiction
    from winch_friction.commissioning.check import known_cranes, quick_check, refuse

    findings = quick_check(runs, crane, model, known_cranes(*folders_of_cranes(near)))
    show_warnings(f"{each.sentence}" for each in findings if each.severity == "warning")
    contradiction = first_contradiction(findings)
    if contradiction is None:
        return {}
    if not force:
        refuse(findings)
    show_warnings([f"--force: {contradiction.sentence}"])
    return {"forced": contradiction.sentence}


# -- where a result comes from
def provenance_of(paths: Sequence[Path], crane: str = "", model: str = "", seed: int | None = None) -> dict[str, Any]:
    """What a result was made of: command, version, commit, crane, model, seed, and every file with its hash."""
    from winch_friction import __version__

    return {
        "command": " ".join(["winch-friction", *map(shlex.quote, sys.argv[1:])]), "version": __version__,
        "commit": _commit(), "crane": crane, "model": model, "seed": seed,
        "files": [{"name": path.name, "sha256": _hash(path)} for path in paths],
    }  # fmt: skip


def _hash(path: Path) -> str:
    """Of a file, or of all files of a bag's folder in order."""
    digest = hashlib.sha256()
    for each in sorted(path.rglob("*")) if path.is_dir() else [path]:
        if each.is_file():
            with each.open("rb") as content:
                while chunk := content.read(1 << 20):
                    digest.update(chunk)
    return digest.hexdigest()


def _commit() -> str:
    """Of the package's own repository, '' where it was installed without one."""
    here = Path(__file__).resolve().parents[2]
    if not (here / ".git").exists():
        return ""
    said = subprocess.run(["git", "-C", str(here), "rev-parse", "--short", "HEAD"], capture_output=True, text=True)
    return said.stdout.strip()
