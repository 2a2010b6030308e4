"""The fleet's numbers as columns: Parquet, partitioned by crane and month, one row per recording and trait."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from winch_friction.fleet.drift import month_of, month_text

COLUMNS = ("crane", "month", "recording", "time", "kind", "name", "value", "std", "unit")


def write_store(folder: Path, rows: Sequence[dict[str, Any]]) -> Path:
    """Write rows with the keys of `COLUMNS` but `month`; earlier files of the same crane and month are replaced."""
    import pandas as pd

    if not rows:
        return folder
    frame = pd.DataFrame([{**row, "month": month_text(month_of(row["time"]))} for row in rows], columns=list(COLUMNS))
    folder.mkdir(parents=True, exist_ok=True)
    frame.to_parquet(
        folder, partition_cols=["crane", "month"], index=False, existing_data_behavior="delete_matching",
        basename_template="part-{i}.parquet",
    )  # fmt: skip
    return folder


def read_store(folder: Path) -> Any:
    """The rows as a pandas frame with the columns of `COLUMNS`."""
    import pandas as pd
    import pyarrow as pa
    from pyarrow.dataset import partitioning

    keys = pa.schema([("crane", pa.string()), ("month", pa.string())])  # or crane 007 would be read as a number
    frame = pd.read_parquet(folder, partitioning=partitioning(keys, flavor="hive"))
    return frame.astype({"crane": str, "month": str})[list(COLUMNS)]
