"""Runs and messages into rosbag2 recordings, mcap or sqlite3."""

import json
import shutil
from collections.abc import Iterable, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np

from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import Run
from winch_friction.records.atomic import own_folder, put, remove_stale, taken, writing
from winch_friction.records.bags import METADATA_KEY
from winch_friction.records.topics import TopicMap

LATEST = 2.0**31  # s; a stamp's seconds are a whole number of 32 bits
STORAGES = {".mcap": "mcap", ".db3": "sqlite3"}


def write_bag(run: Run, path: Path | str, topics: TopicMap | None = None, storage: str = "") -> Path:
    """Write a run as the messages that its samples came from; NaN stays out.

    A path ending in .mcap or .db3 becomes that single file, any other a rosbag2 folder (`storage`: mcap or sqlite3).
    `topics` chooses the conventions; without it pressures are gauge and displacements m^3/rad. Unknown columns
    (`aside`) have no topic. Raises `InputError` when the path exists.
    """
    topics = topics or TopicMap(groups=run.groups, displacement_unit="m3_per_rad")
    if len(run) and run.time[0] < 0.0:
        raise InputError(f"{run.name}: time starts at {run.time[0]:g} s; a bag cannot hold times before 0")
    with BagWriter(path, storage, dict(run.metadata)) as writer:
        for sample in run.samples():
            for topic, message in topics.encode(sample, MESSAGES):
                writer.write(f"/{topic}", message, sample.time)
    return Path(path)


class RosbagsMessages:
    """Messages of `rosbags`, from plain fields (a `topics.MessageFactory`)."""

    def __init__(self) -> None:
        self._store: Any = None

    @property
    def store(self) -> Any:
        """The types of ROS 2 Jazzy."""
        if self._store is None:
            from rosbags.typesys import Stores, get_typestore

            self._store = get_typestore(Stores.ROS2_JAZZY)
        return self._store

    def make(self, type_name: str, **fields: Any) -> Any:
        """A message of this type."""
        return self.store.types[type_name](**fields)

    def doubles(self, values: Sequence[float]) -> Any:
        """A `float64[]` field."""
        return np.array(values, dtype=np.float64)


MESSAGES = RosbagsMessages()


class BagWriter:
    """Writes a recording beside its place and moves it there when complete: a reader never sees half of it.

    `metadata` (plain types) may be filled until the end; it travels in the folder's metadata.yaml.
    """

    def __init__(self, path: Path | str, storage: str = "", metadata: dict[str, Any] | None = None) -> None:
        self.path = Path(path)
        if taken(self.path):
            raise InputError(f"{self.path}: exists already; remove it or choose another name")
        self._storage = _storage(self.path, storage)
        self.metadata = metadata if metadata is not None else {}
        self._connections: dict[str, Any] = {}

    def __enter__(self) -> "BagWriter":
        from rosbags.rosbag2 import StoragePlugin, Writer

        self.path.parent.mkdir(parents=True, exist_ok=True)
        remove_stale(self.path)
        self._folder = own_folder(self.path)
        plugin = StoragePlugin.MCAP if self._storage == "mcap" else StoragePlugin.SQLITE3
        self._writer = Writer(self._folder / self.path.stem, version=9, storage_plugin=plugin)
        self._writer.open()
        return self

    def write(self, topic: str, message: Any, time: float) -> None:
        """Write one message of `rosbags`, received at `time` s; raises `InputError` where no stamp says this time."""
        if not 0.0 <= time < LATEST:
            raise InputError(
                f"{self.path}: a bag holds times from 0 to {LATEST:.4g} s (of 1970; the year 2038), not {time:.6g} s; "
                "is the column 'time' in s? Shift it, or write .csv or .parquet"
            )
        type_name = message.__msgtype__
        self.write_raw(topic, type_name, MESSAGES.store.serialize_cdr(message, type_name), round(time * 1e9))

    def write_raw(self, topic: str, type_name: str, data: Any, receipt: int) -> None:
        """Write one serialised message, received at `receipt` ns."""
        if topic not in self._connections:
            self._connections[topic] = self._writer.add_connection(topic, type_name, typestore=MESSAGES.store)
        self._writer.write(self._connections[topic], receipt, data)

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            with writing(self.path, str(self._folder)):
                if self.metadata:
                    self._writer.set_custom_data(METADATA_KEY, json.dumps(self.metadata, default=str))
                self._writer.__exit__(kind, error, trace)
                if kind is None:
                    self._move_into_place()
                elif isinstance(error, OSError):
                    raise error
        finally:
            shutil.rmtree(self._folder, ignore_errors=True)

    def _move_into_place(self) -> None:
        made = self._folder / self.path.stem
        if self.path.suffix in STORAGES:
            made = next(iter(_storage_files(made)))
        put(made, self.path, new=True)


def _storage(path: Path, storage: str) -> str:
    own = STORAGES.get(path.suffix, storage or "mcap")
    if own not in STORAGES.values() or (storage and storage != own):
        raise InputError(f"{path}: storage '{storage}' does not fit; use {' or '.join(STORAGES.values())}")
    return own


def _storage_files(folder: Path) -> Iterable[Path]:
    return (each for each in folder.iterdir() if each.suffix in STORAGES)
