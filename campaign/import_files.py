"""A run in the files of measuring programs, as people have set them up."""

import gzip
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from campaign.import_writers import (
    BARE,
    CM3,
    DE,
    EN,
    RPM,
    START,
    UNDERSCORED,
    UNITS,
    Table,
    Writer,
    comma,
    lines,
    put,
    stamp,
    table,
)
from winch_friction.physics.signals import FloatArray, Run


def packed(run: Run, folder: Path) -> list[Path]:
    path = folder / "log.txt.gz"
    path.write_bytes(gzip.compress("\n".join(lines(comma(table(run, DE)), "\t")).encode("cp1252")))
    return [path]


def zipped(run: Run, folder: Path) -> list[Path]:
    with zipfile.ZipFile(folder / "log.zip", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("export/log.csv", "\n".join(lines(table(run, EN))))
    return [folder / "log.zip"]


def _numbers(run: Run, heads: Sequence[str]) -> dict[str, FloatArray]:
    return {head: np.array([float(c) for c in cells]) for head, cells in table(run, heads)}


def parquet_by_dates(run: Run, folder: Path) -> list[Path]:
    import pandas as pd

    numbers = _numbers(run, EN)
    numbers.pop("Time [s]")
    index = pd.DatetimeIndex([stamp(t) for t in run.time], tz="Europe/Oslo", name="stamp")
    pd.DataFrame(numbers, index=index).to_parquet(folder / "log.parquet")
    return [folder / "log.parquet"]


def parquet_of_strings(run: Run, folder: Path) -> list[Path]:
    import pandas as pd

    pd.DataFrame(dict(comma(table(run, DE)))).to_parquet(folder / "log.parquet")
    return [folder / "log.parquet"]


def _identifiers(run: Run) -> dict[str, FloatArray]:
    return _numbers(run, UNDERSCORED)


def mat5_struct(run: Run, folder: Path) -> list[Path]:
    from scipy.io import savemat

    savemat(folder / "log.mat", {"data": {k: v[:, None] for k, v in _identifiers(run).items()}, "operator": "NN"})
    return [folder / "log.mat"]


def mat73(run: Run, folder: Path) -> list[Path]:
    import h5py

    with h5py.File(folder / "log.mat", "w", userblock_size=512) as file:
        group = file.create_group("logged")
        for name, values in _identifiers(run).items():
            group.create_dataset(name, data=values[None, :]).attrs["MATLAB_class"] = np.bytes_("double")
    head = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM"
    with (folder / "log.mat").open("r+b") as raw:
        raw.write(head)
    return [folder / "log.mat"]


def tdms(run: Run, folder: Path) -> list[Path]:
    from nptdms import ChannelObject, TdmsWriter

    step = 0.05
    grid = np.arange(0.0, run.time[-1], step)
    with TdmsWriter(str(folder / "log.tdms")) as writer:
        channels = []
        for (head, unit), values in zip(zip(BARE, UNITS, strict=True), _numbers(run, BARE).values(), strict=True):
            if head != "Time":
                even = np.interp(grid, run.time, values)
                timing = {"wf_increment": step, "wf_start_offset": 0.0, "wf_start_time": np.datetime64(START)}
                channels.append(ChannelObject("Log", head, even, {"unit_string": unit, **timing}))
        writer.write_segment(channels)
    return [folder / "log.tdms"]


def mf4_of_two_rates(run: Run, folder: Path) -> list[Path]:
    from asammdf import MDF, Signal

    with MDF(version="4.10") as file:
        for k, (head, unit) in enumerate(zip(BARE, UNITS, strict=True)):
            if k:
                values = list(_numbers(run, BARE).values())[k]
                slow = slice(None, None, 4 if head.startswith(("Hook", "Wire")) else 1)
                file.append([Signal(values[slow], run.time[slow], unit=unit, name=head)])
        file.save(folder / "log.mf4", overwrite=True)
    return [folder / "log.mf4"]


def xlsx_offset(run: Run, folder: Path) -> list[Path]:
    """Dates as spreadsheets hold them, the table from the third row and second column on, another sheet before it."""
    from openpyxl import Workbook

    book = Workbook(write_only=True)
    book.create_sheet("Info").append(["Crane", "Test 2"])
    sheet = book.create_sheet("Messung")
    for row in (["Protokoll"], [], [None, "Datum", *DE[1:]]):
        sheet.append(row)
    for time, *cells in zip(run.time, *list(_numbers(run, DE).values())[1:], strict=True):
        sheet.append([None, stamp(time), *map(float, cells)])
    book.save(folder / "log.xlsx")
    return [folder / "log.xlsx"]


def ahc_test(names: Mapping[str, str]) -> Writer:
    """An AHC test under these names for its groups."""

    def write(run: Run, folder: Path) -> list[Path]:
        columns: Table = [("Time [s]", [f"{t:.3f}" for t in run.time])]
        columns.append(("Motor speed [rpm]", [f"{v * RPM:.2f}" for v in run["motor_speed"]]))
        for group, said in names.items():
            for port in "ab":
                cells = [f"{v * 1e-5:.2f}" for v in run[f"{group}.pressure_{port}"]]
                columns.append((f"{said} pressure {port.upper()} [bar]", cells))
            columns.append((f"{said} displacement [cm3/rev]", [f"{v * CM3:.2f}" for v in run[f"{group}.displacement"]]))
        columns.append(("Hook load [t]", [f"{v * 1e-3:.3f}" for v in run["hook_load"]]))
        columns.append(("Heave velocity [m/s]", [f"{v:.6f}" for v in run["heave_velocity"]]))
        return put(lines(columns), folder / "log.csv")

    return write
