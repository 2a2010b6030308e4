"""Which reader a log needs, by its ending; what it is called in the map."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from winch_friction.importing.log import Log, without_bad_values
from winch_friction.importing.own_clocks import with_own_clocks
from winch_friction.importing.rows_of_values import with_column_per_signal
from winch_friction.physics.errors import InputError
from winch_friction.records.runs import BAG_SUFFIXES, is_bag

TEXT = (".csv", ".txt", ".tsv", ".dat", ".asc", ".log", ".gz", ".zip", ".prn", ".lvm")
WORKBOOK = (".xlsx", ".xlsm", ".xls", ".xlsb", ".ods")
SIGNALS = (".parquet", ".pq", ".mat", ".h5", ".hdf5", ".hdf", ".tdms", ".mf4", ".mdf")
# what can be done about kinds that no reader is for
_INSTEAD = {
    ".feather": "pandas.read_feather('LOG').to_parquet('log.parquet')",
    ".arrow": "pandas.read_feather('LOG').to_parquet('log.parquet')",
    ".json": "a table in JSON: pandas.read_json('LOG').to_parquet('log.parquet')",
    ".jsonl": "pandas.read_json('LOG', lines=True).to_parquet('log.parquet')",
    ".pkl": "pandas.read_pickle('LOG').to_parquet('log.parquet')",
    ".bag": "a recording of ROS 1: rosbags-convert --src LOG --dst FOLDER",
    ".blf": "a bus log: decode it by its .dbc into .mf4 or .csv",
    ".pdf": "type its table into a .csv",
}


def read_log(path: Path, settings: Mapping[str, Any] | None = None) -> Log:
    """A log of any kind, without the values that it calls bad itself, a column per signal, on one clock.

    Raises `InputError` in one line for what is missing, empty or of no known kind. Without `settings` it is found out
    whether its signals have clocks of their own.
    """
    clocks = "" if settings is None else str(settings.get("clocks", "one"))
    log = without_bad_values(_read(path, settings))
    by_signal = with_column_per_signal(log, clocks)
    return with_own_clocks(log, clocks) if by_signal is log else by_signal


def _read(path: Path, settings: Mapping[str, Any] | None) -> Log:
    path = Path(path)
    if not path.exists():
        raise InputError(f"{path}: no such file")
    if not (path.is_file() or path.is_dir()):  # a pipe would be waited for
        raise InputError(f"{path}: neither a file nor a folder")
    suffix = path.suffix.lower()
    if path.is_dir() and not any(each.suffix.lower() in (*BAG_SUFFIXES, ".yaml") for each in path.iterdir()):
        raise InputError(f"{path}: a folder, and no rosbag2 recording; give the logs themselves, as {path}/*.csv")
    if path.is_file() and path.stat().st_size == 0:
        raise InputError(f"{path}: the file is empty")
    suffix = _by_content(path, suffix)
    if suffix in WORKBOOK:
        from winch_friction.importing.workbook_log import read_workbook_log

        return read_workbook_log(path, settings)
    if suffix in SIGNALS or is_bag(path):
        from winch_friction.importing.signal_logs import read_signal_log

        return read_signal_log(path, settings)
    if suffix in TEXT or not suffix:
        from winch_friction.importing.text_log import read_text_log

        return read_text_log(path, settings)
    instead = f" ({_INSTEAD[suffix].replace('LOG', path.name)})" if suffix in _INSTEAD else ""
    raise InputError(
        f"{path}: no reader for '{suffix}' files{instead}; use {', '.join(TEXT + WORKBOOK + SIGNALS)} or a bag"
    )


def _by_content(path: Path, suffix: str) -> str:
    """The ending that a file's first bytes ask for where two kinds share one: tables of text are often called .xls,
    measurements of ASAM's format .dat.
    """
    if suffix not in (".xls", ".dat") or not path.is_file():
        return suffix
    with path.open("rb") as file:
        first = file.read(8)
    if suffix == ".dat":
        return ".mdf" if first.startswith(b"MDF ") else ".dat"
    return ".xls" if first.startswith((b"\xd0\xcf\x11\xe0", b"PK")) else ".txt"
