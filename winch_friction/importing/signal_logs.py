"""Logs of measuring programs: Parquet, MATLAB .mat (v5 and v7.3), HDF5, LabVIEW .tdms, ASAM .mf4 / .mdf."""

import gc
import sys
import traceback
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from winch_friction.importing.hdf5_log import matlab_arrays, plain_arrays
from winch_friction.importing.log import Log, LogColumn, listed
from winch_friction.importing.one_clock import Signal, of_one_length, on_one_clock
from winch_friction.importing.optional import library
from winch_friction.importing.own_clocks import with_times_of_their_structs
from winch_friction.physics.errors import InputError
from winch_friction.records.parquet_units import said_units

_LABELLED = {"values", "label"}  # a signal of a structure with time
_DEEPEST = 6  # structs within structs of a .mat file
_OBJECTS = (
    "{}, which MATLAB alone can open; save its columns: s = table2struct(timetable2table(TT), 'ToScalar', true); "
    "save log.mat -struct s, or writetimetable(TT, 'log.csv')"
)
_HDF5, _HDF5_AT = b"\x89HDF\r\n\x1a\n", (0, 512, 1024, 2048)  # signature, and bytes behind which it may stand
_MOST = 50_000_000  # values of one signal: ten days at 50 Hz


@dataclass(frozen=True)
class Found:
    """What a file holds: its signals, what it says of itself, and what is to be said of it."""

    signals: list[Signal]
    metadata: Mapping[str, Any] = field(default_factory=dict)
    notes: tuple[str, ...] = ()


def read_signal_log(path: Path, settings: Mapping[str, Any] | None = None) -> Log:
    """A log of signals by the file's ending; raises `InputError` in one line for what cannot be read."""
    kind = "bag" if path.is_dir() else path.suffix.lower()
    try:
        found = _READERS[kind](path)
    except InputError:
        raise
    except Exception as error:  # every one of these libraries raises what its parser meets
        said = (str(error) or type(error).__name__).splitlines()[0][:100]
        raise InputError(f"{path}: not a readable {kind} file ({said})") from error
    signals = [each for each in found.signals if np.ndim(each.values) == 1 and len(each.values) > 1]
    try:
        columns, notes = _aligned(path, signals)
    except InputError as error:  # what is lost may be why
        raise InputError(*error.problems, *(f"{path}: {note}" for note in found.notes)) from None
    return Log(
        path, tuple(columns), {"kind": kind.lstrip(".")}, lambda row: f"sample {row + 1}", (*found.notes, *notes),
        found.metadata,
    )  # fmt: skip


def _aligned(path: Path, signals: list[Signal]) -> tuple[list[LogColumn], list[str]]:
    if not signals:
        raise InputError(f"{path}: holds no signal of more than one value")
    timed = [each for each in signals if each.times is not None and len(each.times) == len(each.values)]
    left = [each.name for each in signals if all(each is not one for one in timed)]  # two may bear one name
    if not timed:
        timed, left = with_times_of_their_structs(signals)
    if not timed:
        return of_one_length(signals)
    columns, notes = on_one_clock(timed)
    return columns, notes + ([f"signals without times left out: {listed(left)}"] if left else [])


def _parquet(path: Path) -> Found:
    table = library("pyarrow.parquet", "Parquet logs").ParquetFile(path).read()
    units = said_units(table.schema)
    values = {name: table.column(name).to_numpy(zero_copy_only=False) for name in table.column_names}
    return Found([Signal(name, each, units.get(name, "")) for name, each in values.items()])


def _mat(path: Path) -> Found:
    if _is_bare_hdf5(path):
        return _hdf5(path)
    from scipy.io import loadmat
    from scipy.io.matlab import MatlabOpaque

    try:
        content = loadmat(path, squeeze_me=True, struct_as_record=False, simplify_cells=True)
    except NotImplementedError:  # version 7.3 is HDF5
        arrays = matlab_arrays(path, _MOST, _OBJECTS)
        return Found([each for name, array in arrays for each in _arrays(name, array, 0)])
    found = [each for name, value in content.items() if not name.startswith("__") for each in _arrays(name, value, 0)]
    if not found and any(isinstance(value, MatlabOpaque) for value in content.values()):
        raise InputError(f"{path}: {_OBJECTS.format('a timetable, table or other object')}")
    return Found(found)


def _is_bare_hdf5(path: Path) -> bool:
    """Whether a .mat file is HDF5 without MATLAB's own head before it, as other programs write it."""
    with path.open("rb") as file:
        head = file.read(_HDF5_AT[-1] + len(_HDF5))
    return not head.startswith(b"MATLAB") and any(head[at:].startswith(_HDF5) for at in _HDF5_AT)


def _arrays(name: str, value: Any, depth: int) -> Iterator[Signal]:
    """Arrays of numbers in nested structs under dotted names; a matrix gives one signal per column.

    Of an array of structs each is numbered, and what Simulink calls a structure with time gives its signals' labels.
    """
    if isinstance(value, dict) and value.keys() >= _LABELLED and str(value["label"]).strip(" []"):
        value, name = value["values"], str(value["label"]).strip()
    if isinstance(value, dict):
        for key, part in value.items() if depth < _DEEPEST else ():
            yield from _arrays(f"{name}.{key}", part, depth + 1)
        return
    if isinstance(value, (list, np.ndarray)) and len(np.shape(value)) and any(isinstance(v, dict) for v in value):
        for number, part in enumerate(value, 1) if depth < _DEEPEST else ():
            yield from _arrays(f"{name}.{number}", part, depth + 1)
        return
    array = np.asarray(value)
    if array.dtype.kind not in "biufMU" or array.size < 2 or array.size > _MOST or array.ndim > 2:
        return
    if array.ndim == 1:
        yield Signal(name, array)
        return
    tall = array if array.shape[0] >= array.shape[1] else array.T
    if tall.shape[1] <= 100:
        yield from (Signal(f"{name}.{k + 1}" if tall.shape[1] > 1 else name, tall[:, k]) for k in range(tall.shape[1]))


def _tdms(path: Path) -> Found:
    tdms = library("nptdms", "LabVIEW .tdms logs").TdmsFile.read(path)
    channels = [channel for group in tdms.groups() for channel in group.channels() if len(channel)]
    begins = [_begin(channel.properties) for channel in channels if channel.properties.get("wf_increment")]
    dated = all(each is not None for each in begins)
    signals = []
    for channel in channels:
        unit = str(channel.properties.get("unit_string", ""))
        step = channel.properties.get("wf_increment")
        times = None
        if step:
            start = float(channel.properties.get("wf_start_offset", 0.0))
            start += (_begin(channel.properties) or 0.0) if dated else 0.0
            times = np.asarray(start + float(step) * np.arange(len(channel)), dtype=np.float64)
        signals.append(Signal(channel.name, channel[:], unit, times))
    apart = not dated and len(set(begins)) > 1
    notes = ("not every channel says when it began (wf_start_time): all are taken to begin together",) * apart
    return Found(signals, {key: str(value) for key, value in tdms.properties.items()}, notes)


def _begin(properties: Mapping[str, Any]) -> float | None:
    """When a channel's waveform begins, s since 1970; None where it does not say, as LabVIEW's own 1904."""
    said = properties.get("wf_start_time")
    try:
        began = float((np.datetime64(said) - np.datetime64(0, "s")) / np.timedelta64(1, "s"))
    except (TypeError, ValueError):
        return None
    return began if began > 0.0 else None


def _mdf(path: Path) -> Found:
    mdf = _opened_mdf(path)
    try:
        start = mdf.header.start_time.timestamp()
        signals = [
            Signal(
                each.name, each.samples, each.unit or "", np.asarray(each.timestamps, dtype=float), each.comment or ""
            )
            for each in mdf.iter_channels(skip_master=True)
            if np.ndim(each.samples) == 1
        ]
    finally:
        mdf.close()
    return Found(signals, {"start": start})


def _opened_mdf(path: Path) -> Any:
    """A file's object; where there is none, what was made of it goes at once: at its end it stumbles, and that is
    written out as a traceback."""
    made, said, hook = library("asammdf", "ASAM .mf4 logs").MDF, "", sys.unraisablehook
    try:
        return made(path)
    except Exception as error:  # whatever its parser meets
        said = (str(error) or type(error).__name__).splitlines()[0][:100]
        sys.unraisablehook = lambda _: None
        traceback.clear_frames(error.__traceback__)
        gc.collect()
    finally:
        sys.unraisablehook = hook
    raise InputError(f"{path}: not a readable {path.suffix.lower()} file ({said})")


def _hdf5(path: Path) -> Found:
    found = plain_arrays(path, _MOST)
    return Found([replace(each, unit=unit) for name, array, unit in found for each in _arrays(name, array, 0)])


def _bag(path: Path) -> Found:
    from winch_friction.importing.bag_log import bag_signals

    return bag_signals(path)


_READERS = {
    "bag": _bag,
    ".mcap": _bag,
    ".db3": _bag,
    ".parquet": _parquet,
    ".pq": _parquet,
    ".mat": _mat,
    ".h5": _hdf5,
    ".hdf5": _hdf5,
    ".hdf": _hdf5,
    ".tdms": _tdms,
    ".mf4": _mdf,
    ".mdf": _mdf,
    ".dat": _mdf,
}
