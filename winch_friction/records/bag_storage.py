"""What rosbags opens of a recording, and what it reads of one that is damaged."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from winch_friction.physics.errors import InputError

# ending of a storage file: how it begins, and what saves messages from one that is cut or damaged
_REPAIRS = {
    ".mcap": (b"\x89MCAP0\r\n", "'mcap recover {file} -o NEW.mcap'"),
    ".db3": (b"SQLite format 3\0", "'sqlite3 {file} .recover | sqlite3 NEW.db3'"),
}
_DAMAGED = "the file is damaged"


class _Storage(type(Path())):  # type: ignore[misc]
    """A path whose ending is small: rosbags tells by it what a file is, and a logger under Windows writes RUN.MCAP."""

    @property
    def suffix(self) -> str:
        return str(super().suffix.lower())


def storage_of(path: Path) -> Path:
    """What rosbags opens: the folder, or its only storage file when the recorder was killed before metadata.yaml."""
    if not path.is_dir() or (path / "metadata.yaml").is_file():
        return _Storage(path)
    files = _storage_files(path)
    if len(files) != 1:
        raise InputError(f"{path}: not a rosbag2 folder: no metadata.yaml and {len(files)} storage files")
    return files[0]


def _storage_files(path: Path) -> list[Path]:
    inside = path.iterdir() if path.is_dir() else (path,)
    return sorted(each for each in map(_Storage, inside) if each.suffix in _REPAIRS)


def refused(path: Path, error: Exception) -> InputError:
    """What is said of a recording that rosbags does not open, nothing of which is read; it raises whatever it meets."""
    said = (str(error) or type(error).__name__).splitlines()[0][:120]
    repair = ""
    for each in _storage_files(path)[:1]:
        mark, command = _REPAIRS[each.suffix]
        if _begins_with(each, mark):
            repair = f"; if {each.name} was cut short or damaged, {command.format(file=each.name)} saves what is there"
    return InputError(f"{path}: not a readable rosbag2 recording, nothing is read ({said}){repair}")


def _begins_with(path: Path, mark: bytes) -> bool:
    with path.open("rb") as file:
        return file.read(len(mark)) == mark


def lost_of(warnings: Sequence[str]) -> list[str]:
    """Those that say what a damaged file has lost: they may be why something else is missing."""
    return [each for each in warnings if _DAMAGED in each]


def readable(reader: Any, connections: Sequence[Any], name: str, said: list[str]) -> Iterator[tuple[Any, int, Any]]:
    """Connection, receipt in ns and bytes of the messages of rosbags' `connections`, as far as the file is whole.

    At the end `said` holds how many there are by the file's own index and are lost: one that is damaged in its middle
    ends there, with whatever its bytes lead to or without any error.
    """
    came, whole = 0, True
    try:
        for each in reader.messages(connections):
            came += 1
            yield each
    except Exception:  # of rosbags and what it unpacks with; what befalls the reader of this is not raised in here
        whole = False
    counted = sum(each.msgcount or 0 for each in connections)
    lost = f"{name}: {_DAMAGED}: of {counted} messages {came} can be read, the rest is lost; copy it anew"
    if (came < counted or not whole) and lost not in said:
        said.append(lost)
