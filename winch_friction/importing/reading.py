"""Which reader a log needs, by its ending; what it is called in the map."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from winch_friction.importing.log import Log
from winch_friction.physics.errors import InputError
from winch_friction.records.runs import BAG_SUFFIXES, is_bag

TEXT = (".csv", ".txt", ".tsv", ".asc", ".log", ".gz", ".zip", ".prn", ".lvm")
WORKBOOK = (".xlsx", ".xlsm")
SIGNALS = (".parquet", ".pq", ".mat", ".tdms", ".mf4", ".mdf")


def read_log(path: Path, settings: Mapping[str, Any] | None = None) -> Log:
    """A log of any kind; raises `InputError` in one line for what is missing, empty or of no known kind."""
    path = Path(path)
    if not path.exists():
        raise InputError(f"{path}: no such file")
    suffix = path.suffix.lower()
    if path.is_dir() and not any(each.suffix.lower() in (*BAG_SUFFIXES, ".yaml") for each in path.iterdir()):
        raise InputError(f"{path}: a folder, and no rosbag2 recording; give the logs themselves, as {path}/*.csv")
    if path.is_file() and path.stat().st_size == 0:
        raise InputError(f"{path}: the file is empty")
    if suffix in WORKBOOK:
        from winch_friction.importing.workbook_log import read_workbook_log

        return read_workbook_log(path, settings)
    if suffix in SIGNALS or is_bag(path):
        from winch_friction.importing.signal_logs import read_signal_log

        return read_signal_log(path, settings)
    if suffix in TEXT or not suffix:
        from winch_friction.importing.text_log import read_text_log

        return read_text_log(path, settings)
    old = "; save it as .xlsx" if suffix == ".xls" else ""
    raise InputError(
        f"{path}: no reader for '{suffix}' files{old}; use {', '.join(TEXT + WORKBOOK + SIGNALS)} or a bag"
    )
