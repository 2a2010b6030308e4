"""Exports as the programs of plants and laboratories write them: a header of their own, then a run."""
# ruff: noqa: E501

from pathlib import Path

import numpy as np

from campaign.import_writers import BARE, EN, UNITS, Kind, comma, lines, put, stamp, table
from winch_friction.physics.signals import Run

_TAGS = ("MotorSpeed", "PressureA", "PressureB", "Displacement", "HookLoad", "WireOut", "WireLayer")


def kinds() -> list[Kind]:
    """Every program."""
    return [
        Kind("WinCC archive, a row per value", wincc),
        Kind("TIA Portal trace", tia_trace),
        Kind("TwinCAT Scope", twincat),
        Kind("DASYLab", dasylab),
        Kind("LabVIEW measurement file", lvm),
        Kind("MATLAB timetable v7.3", timetable73, ("timetable",)),
        Kind("spreadsheet with two header rows and serial dates", merged),
        Kind("Unicode text of a spreadsheet", lambda run, folder: put([row + "\t" for row in lines(comma(table(run, EN)), "\t")], folder / "log.txt", "utf-16", "\r\n")),
        Kind("spreadsheet of texts", xlsx_of_texts),
        Kind("InfluxDB annotated", influx),
        Kind("Grafana with units in cells", grafana),
        Kind("PlotJuggler", lambda run, folder: put(lines([("__time", [f"{1772359200.0 + t:.6f}" for t in run.time]), *((f"/winch/{h}", c) for h, c in table(run, EN)[1:])]), folder / "log.csv")),
        Kind("HTML under another name", html, ("HTML",)),
        Kind("old spreadsheet", lambda run, folder: _raw(folder / "log.xls", b"\xd0\xcf\x11\xe0" + bytes(600)), (".xlsx",)),
        Kind("JSON lines", lambda run, folder: put(['{"time": 0.0, "speed": 1.0}'] * 50, folder / "log.jsonl"), ("no reader",)),
    ]  # fmt: skip


def _raw(path: Path, content: bytes) -> list[Path]:
    path.write_bytes(content)
    return [path]


def wincc(run: Run, folder: Path) -> list[Path]:
    rows = ["VarName;TimeString;VarValue;Validity;Time_ms"]
    columns = table(run, EN)
    for k, time in enumerate(run.time):
        when, ms = f"{stamp(time):%d.%m.%Y %H:%M:%S}", f"{1e6 * (46082.416 + time / 86400.0):.6f}".replace(".", ",")
        rows += [f'"{tag}";"{when}";{cells[k].replace(".", ",")};1;{ms}' for tag, (_, cells) in zip(_TAGS, columns[1:], strict=False)]  # fmt: skip
    return put([*rows, '"$RT_COUNT$";12;;;'], folder / "log.csv")


def tia_trace(run: Run, folder: Path) -> list[Path]:
    columns = table(run, EN)
    heads = ['"Sample"', '"Time offset [ms]"', *(f'"DB_Winch.{h}"' for h, _ in columns[1:])]
    rows = [";".join(heads)]
    rows += [";".join([str(k), f"{1e3 * t:.1f}", *(c[k] for _, c in columns[1:])]) for k, t in enumerate(run.time)]
    return put(['"Trace";"Winch test";"2026-03-01 10:00:00.000"', '"Device";"PLC_1"', "", *rows], folder / "trace.csv")


def twincat(run: Run, folder: Path) -> list[Path]:
    """A time in ms before each channel, and the properties of each in rows above."""
    columns = table(run, BARE)[1:]
    pair = lambda first, texts: "\t".join(x for text in texts for x in (first, text))
    head = ["Name\tScopeProject1", "File\tC:\\TwinCAT\\Scope\\log.csv", "Starttime of export\t134168328000000000\t10:00:00", "",
            pair("Name", [h for h, _ in columns]), pair("SymbolName", [f"MAIN.{h.replace(' ', '')}" for h, _ in columns]),
            pair("Data-Type", ["REAL64"] * len(columns)), pair("SampleTime[ms]", ["50"] * len(columns)), pair("Unit", UNITS[1:]), ""]  # fmt: skip
    rows = ["\t".join(x for _, c in columns for x in (f"{1e3 * t:.1f}", c[k])) for k, t in enumerate(run.time)]
    return put([*head, *rows], folder / "scope.csv")


def dasylab(run: Run, folder: Path) -> list[Path]:
    columns = comma(table(run, EN))
    head = ["DASYLab - V 13.00.00", "Worksheet name: winch.dsb", "Recording date: 01.03.2026, 10:00:00", "Block length: 1024",
            "Delta: 0,05 sec.", "Number of channels: 7", "Date;" + ";".join(h for h, _ in columns)]  # fmt: skip
    rows = [f"01.03.2026;{';'.join(cells)}" for cells in zip(*(c for _, c in columns), strict=True)]
    return put([*head, *rows], folder / "log.asc", "cp1252")


def lvm(run: Run, folder: Path) -> list[Path]:
    columns = table(run, BARE)
    n = len(columns) - 1
    head = ["LabVIEW Measurement\t", "Writer_Version\t2", "Reader_Version\t2", "Separator\tTab", "Decimal_Separator\t.",
            "Multi_Headings\tNo", "X_Columns\tOne", "Time_Pref\tRelative", "Date\t2026/03/01", "Time\t10:00:00.0",
            "***End_of_Header***\t", "", f"Channels\t{n}", "Samples\t" + "\t".join([str(len(run))] * n), "Date\t" + "\t".join(["2026/03/01"] * n),
            "Time\t" + "\t".join(["10:00:00.0"] * n), "Y_Unit_Label\t" + "\t".join(UNITS[1:]), "X_Dimension\t" + "\t".join(["Time"] * n),
            "X0\t" + "\t".join(["0.0"] * n), "Delta_X\t" + "\t".join(["0.05"] * n), "***End_of_Header***\t" + "\t" * n,
            "X_Value\t" + "\t".join(h for h, _ in columns[1:]) + "\tComment"]  # fmt: skip
    return put([*head, *lines(columns, "\t")[1:]], folder / "log.lvm")


def timetable73(run: Run, folder: Path) -> list[Path]:
    import h5py

    with h5py.File(folder / "log.mat", "w", userblock_size=512) as file:
        kept = file.create_dataset("TT", data=np.array([[3707764736, 2, 1, 1, 1, 1]], dtype=np.uint32))
        kept.attrs["MATLAB_class"], kept.attrs["MATLAB_object_decode"] = np.bytes_("timetable"), np.int32(3)
        file.create_group("#refs#").create_dataset("a", data=run["motor_speed"][None, :])
        file.create_group("#subsystem#").create_dataset("MCOS", data=np.zeros((1, 9), np.uint32))
    head = b"MATLAB 7.3 MAT-file, Platform: PCWIN64".ljust(124) + b"\x00\x02IM"
    with (folder / "log.mat").open("r+b") as raw:
        raw.write(head)
    return [folder / "log.mat"]


def merged(run: Run, folder: Path) -> list[Path]:
    """'Pressure' over A and B in merged cells, the units in a third row, dates as plain serial numbers."""
    from openpyxl import Workbook

    book = Workbook(write_only=True)
    sheet = book.create_sheet("Data")
    sheet.append(["Date", "Motor", "Pressure", None, "Motor", "Hook", "Wire", None])
    sheet.append([None, "speed", "A", "B", "displacement", "load", "out", "layer"])
    sheet.append([None, *UNITS[1:]])
    columns = [[float(c) for c in cells] for _, cells in table(run, EN)]
    for time, *cells in zip(*columns, strict=True):
        sheet.append([46082.4166666667 + time / 86400.0, *cells])
    book.save(folder / "log.xlsx")
    return [folder / "log.xlsx"]


def xlsx_of_texts(run: Run, folder: Path) -> list[Path]:
    from openpyxl import Workbook

    book = Workbook(write_only=True)
    sheet = book.create_sheet("Tabelle1")
    columns = comma(table(run, EN))
    sheet.append([h for h, _ in columns])
    for cells in zip(*(c for _, c in columns), strict=True):
        sheet.append(list(cells))
    book.save(folder / "log.xlsx")
    return [folder / "log.xlsx"]


def influx(run: Run, folder: Path) -> list[Path]:
    rows = ["#group,false,false,false,false,true", "#datatype,string,long,dateTime:RFC3339,double,string", "#default,_result,,,,",
            ",result,table,_time,_value,_field"]  # fmt: skip
    for k, (tag, (_, cells)) in enumerate(zip(_TAGS, table(run, EN)[1:], strict=False)):
        rows += [f",,{k},{stamp(t).isoformat(timespec='milliseconds')}Z,{c},{tag}" for t, c in zip(run.time, cells, strict=True)]  # fmt: skip
    return put(rows, folder / "query.csv")


def grafana(run: Run, folder: Path) -> list[Path]:
    columns = table(run, BARE)
    units = ("", " rpm", " bar", " bar", " cm3/rev", " t", " m", "")
    out = [("Time", [f"{stamp(t):%Y-%m-%d %H:%M:%S}.{stamp(t).microsecond // 1000:03d}" for t in run.time])]
    out += [(h, [c + u for c in cells]) for (h, cells), u in zip(columns[1:], units[1:], strict=True)]
    return put([",".join(f'"{x}"' for x in row.split(",")) for row in lines(out)], folder / "panel.csv", "utf-8-sig")


def html(run: Run, folder: Path) -> list[Path]:
    rows = ["".join(f"<td>{c}</td>" for c in row.split(",")) for row in lines(table(run, EN))]
    return put(
        ["<html><body><table>", *(f"<tr>{row}</tr>" for row in rows), "</table></body></html>"], folder / "log.csv"
    )
