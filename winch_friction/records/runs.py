"""Run files in and out by their kind: .csv, .parquet, or a rosbag2 folder (.mcap and .db3 files as well)."""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from winch_friction.physics.errors import InputError, Problems
from winch_friction.physics.signals import Run
from winch_friction.physics.winch.crane import Crane

BAG_SUFFIXES = (".mcap", ".db3")
KINDS = ".csv, .parquet, a rosbag2 folder, .mcap or .db3"


def read_run(path: Path | str, crane: Crane | None = None, *, complete: bool = True, **bag_options: Any) -> Run:
    """A run in SI from a CSV, a Parquet file or a bag.

    The crane is needed where the file speaks of the drum or of displacement fractions; `complete=False` asks for `time`
    alone (truth files); `bag_options` go to `records.bags.read_bag`. What was noticed is in the run's `warnings`.
    Raises `InputError` in one line for whatever cannot be used.
    """
    path = Path(path)
    if not path.exists():
        raise InputError(f"{path}: no such file or folder")
    if path.is_dir() or path.suffix in BAG_SUFFIXES:
        from winch_friction.records.bags import read_bag

        return read_bag(path, crane, complete=complete, **bag_options)
    if path.suffix == ".csv":
        from winch_friction.records.csv_file import read_csv_run

        return read_csv_run(path, crane, complete)
    if path.suffix in (".parquet", ".pq"):
        from winch_friction.records.parquet_file import read_parquet_run

        return read_parquet_run(path, crane, complete)
    raise InputError(f"{path}: not a kind of run file that is known; use {KINDS}")


def read_runs(paths: Iterable[Path | str], crane: Crane | None = None, **options: Any) -> list[Run]:
    """Several runs; two of the same name raise `InputError`, since the name is a run's identity."""
    runs, problems = [], Problems()
    for path in paths:
        with problems:
            runs.append(read_run(path, crane, **options))
    problems.say()
    refuse_same_names(runs)
    return runs


def refuse_same_names(runs: Sequence[Run]) -> None:
    """Raise `InputError` where two runs have the same name."""
    names = [run.name for run in runs]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"{name}: two runs have this name; a run's identity is its file name, so rename one")


def write_run(run: Run, path: Path | str, **bag_options: Any) -> Path:
    """Write a run by suffix: .csv, .parquet, or a rosbag2 folder (.mcap or .db3 in the name choose the storage)."""
    path = Path(path)
    if path.suffix == ".csv":
        from winch_friction.records.csv_file import write_csv_run

        return write_csv_run(run, path)
    if path.suffix in (".parquet", ".pq"):
        from winch_friction.records.parquet_file import write_parquet_run

        return write_parquet_run(run, path)
    if path.suffix in ("", ".bag", *BAG_SUFFIXES):
        from winch_friction.records.bag_write import write_bag

        return write_bag(run, path, **bag_options)
    raise InputError(f"{path}: cannot write this kind of file; use {KINDS}")
