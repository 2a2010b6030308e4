"""Which recordings a fleet has: folders, patterns or object storage (fsspec), and which crane each belongs to."""

import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path, PurePosixPath
from typing import Any

from winch_friction.physics.errors import InputError, Problems

RUN_SUFFIXES = (".csv", ".parquet", ".pq", ".mcap", ".db3")
BAG_FILE = "metadata.yaml"
TRUTH = "_truth"  # ends the names of what simulate --truth writes beside its runs
LARGEST_LOCAL_COPY = 50e9  # bytes; a bucket's object beyond that is not fetched unasked


@dataclass(frozen=True)
class Recording:
    """One run file or bag folder: its address, its files with their sizes, its crane's name and its own."""

    address: str
    crane: str
    name: str
    files: tuple[tuple[str, int], ...]  # paths within the storage, bytes
    changed: int = 0  # ns, when the last of them was written; 0 in a bucket

    @property
    def size(self) -> int:
        """Bytes."""
        return sum(size for _, size in self.files)

    @property
    def version(self) -> str:
        """What must be the same for an earlier result to stand: the files' names, sizes and times."""
        return ";".join([*(f"{PurePosixPath(path).name}:{size}" for path, size in self.files), str(self.changed)])


def find_recordings(
    sources: Sequence[str], storage: Mapping[str, Any] | None = None, without: Sequence[Path] = ()
) -> list[Recording]:
    """Every recording below the sources, sorted by crane and name.

    A source is a run file, a bag folder, a folder of those (searched to any depth) or an address that fsspec knows,
    such as `s3://bucket/prefix`, with its options in `storage`. The folder that a recording lies in is its crane's
    name. A simulator's truth is no recording, and what lies in folders `without` is none.
    Raises `InputError` for a source without any recording and for two recordings of one crane and name.
    """
    found: dict[str, Recording] = {}
    problems = Problems()
    for source in sources:
        with problems:
            here = [each for each in _below(str(source), dict(storage or {})) if not _lies_in(each, without)]
            if not here:
                raise InputError(f"{source}: no recording there; looked for {', '.join(RUN_SUFFIXES)} and bag folders")
            found |= {each.address: each for each in here}
    problems.say()
    recordings = sorted(found.values(), key=lambda each: (each.crane, each.name))
    _refuse_twins(recordings)
    return recordings


def _below(source: str, storage: dict[str, Any]) -> list[Recording]:
    if "://" not in source:
        return _local(Path(source))
    filesystem, root = _open_storage(source, storage)
    listing = filesystem.find(root, detail=True)
    sizes = {path: int(about.get("size") or 0) for path, about in listing.items()}
    protocol = source.partition("://")[0]
    return _assembled(sizes, lambda path: f"{protocol}://{path}")


def _lies_in(recording: Recording, folders: Sequence[Path]) -> bool:
    if "://" in recording.address:
        return False
    place = Path(recording.address).resolve()
    return any(place.is_relative_to(folder.resolve()) for folder in folders)


def _local(source: Path) -> list[Recording]:
    if not source.exists():
        raise InputError(f"{source}: no such file or folder")
    paths = [source] if source.is_file() else [path for path in sorted(source.rglob("*")) if path.is_file()]
    about = {path.as_posix(): path.stat() for path in paths}
    found = _assembled({path: each.st_size for path, each in about.items()}, str)
    return [replace(each, changed=max(about[path].st_mtime_ns for path, _ in each.files)) for each in found]


def _assembled(sizes: Mapping[str, int], address: Any) -> list[Recording]:
    """Files to recordings: a folder with a bag's metadata is one, every other run file stands for itself."""
    bags = {str(PurePosixPath(path).parent) for path in sizes if PurePosixPath(path).name == BAG_FILE}
    members: dict[str, list[tuple[str, int]]] = {}
    for path, size in sorted(sizes.items()):
        own = PurePosixPath(path)
        if str(own.parent) in bags:
            members.setdefault(str(own.parent), []).append((path, size))
        elif own.suffix.lower() in RUN_SUFFIXES and not own.name.startswith(".") and not own.stem.endswith(TRUTH):
            members[path] = [(path, size)]
    return [
        Recording(address(path), PurePosixPath(path).parent.name or "fleet", PurePosixPath(path).stem, tuple(files))
        for path, files in members.items()
    ]


def _refuse_twins(recordings: Sequence[Recording]) -> None:
    seen: dict[tuple[str, str], str] = {}
    for each in recordings:
        key = (each.crane, each.name)
        if key in seen:
            raise InputError(
                f"two recordings are named '{each.crane}/{each.name}' ({seen[key]}, {each.address}): their results "
                "would overwrite each other; rename one"
            )
        seen[key] = each.address


@contextmanager
def at_hand(recording: Recording, storage: Mapping[str, Any] | None = None) -> Iterator[Path]:
    """The recording as a path on this machine: itself, or a copy that is removed afterwards."""
    if "://" not in recording.address:
        yield Path(recording.address)
        return
    if recording.size > LARGEST_LOCAL_COPY:
        raise InputError(
            f"{recording.address}: {recording.size / 1e9:.0f} GB are too many to fetch; split the recording"
        )
    filesystem, root = _open_storage(recording.address, dict(storage or {}))
    with tempfile.TemporaryDirectory(prefix="recording-") as folder:
        target = Path(folder) / PurePosixPath(root).name
        bag = len(recording.files) > 1 or recording.files[0][0] != root
        for path, _ in recording.files:
            local = target / PurePosixPath(path).relative_to(root) if bag else target
            local.parent.mkdir(parents=True, exist_ok=True)
            filesystem.get_file(path, str(local))
        yield target


def _open_storage(address: str, storage: dict[str, Any]) -> tuple[Any, str]:
    try:
        import fsspec
    except ImportError:
        raise InputError(f"{address}: needs fsspec; pip install 'winch_friction[fleet]'") from None
    try:
        filesystem, root = fsspec.core.url_to_fs(address, **storage)
    except (ImportError, ValueError) as error:
        raise InputError(f"{address}: {error}; pip install 'winch_friction[fleet]' brings S3") from None
    return filesystem, str(root).rstrip("/")
