"""Old and open spreadsheets, several sheets of one run, HDF5 with units, endings of two kinds, and dead ends."""

import zipfile
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from importing.logs import write_workbook

from winch_friction.importing.carry_out import import_log
from winch_friction.importing.propose import propose
from winch_friction.importing.reading import read_log
from winch_friction.physics.errors import InputError

TIME = np.round(0.02 * np.arange(40), 2)
TABLE = {"Time [s]": TIME, "Motor speed [rpm]": 10.0 * TIME, "Pressure A [bar]": 180.0 + TIME}
XML = """<?xml version="1.0"?><office:document-content xmlns:office="urn:oasis:names:tc:opendocument:xmlns:office:1.0"
 xmlns:table="urn:oasis:names:tc:opendocument:xmlns:table:1.0"
 xmlns:text="urn:oasis:names:tc:opendocument:xmlns:text:1.0"
 office:version="1.2"><office:body><office:spreadsheet><table:table table:name="Log">{rows}</table:table>
</office:spreadsheet></office:body></office:document-content>"""

MANIFEST = '<manifest:manifest xmlns:manifest="urn:oasis:names:tc:opendocument:xmlns:manifest:1.0"/>'


def ods(path, table):
    texts = "".join(
        f'<table:table-cell office:value-type="string"><text:p>{t}</text:p></table:table-cell>' for t in table
    )
    cell = '<table:table-cell office:value-type="float" office:value="{0}"><text:p>{0}</text:p></table:table-cell>'
    rows = ["".join(cell.format(value) for value in row) for row in zip(*table.values(), strict=True)]
    body = "".join(f"<table:table-row>{row}</table:table-row>" for row in (texts, *rows))
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("mimetype", "application/vnd.oasis.opendocument.spreadsheet")
        archive.writestr("content.xml", XML.format(rows=body))
        archive.writestr("META-INF/manifest.xml", MANIFEST)
    return path


def values(path):
    return {column.name: (column.unit, column.values.tolist()) for column in read_log(path).columns}


def test_a_sheet_of_libreoffice_and_one_of_old_excel_are_read(tmp_path):
    assert values(ods(tmp_path / "log.ods", TABLE)) == {name: ("", each.tolist()) for name, each in TABLE.items()}
    old = values(Path(__file__).parent / "small.xls")  # written by xlwt 1.3
    assert list(old) == list(TABLE)
    assert old["Pressure A [bar]"][1] == pytest.approx(180.5 + np.arange(12))


@pytest.mark.parametrize("ending", [".ods", ".xlsb"])
def test_what_only_is_called_a_spreadsheet_is_refused_in_a_line(tmp_path, ending):
    (tmp_path / f"log{ending}").write_bytes(b"no table at all")
    with pytest.raises(InputError, match=f"not a readable {ending} file"):
        read_log(tmp_path / f"log{ending}")
    with zipfile.ZipFile(tmp_path / f"log{ending}", "w") as archive:
        archive.writestr("other.txt", "nothing")
    with pytest.raises(InputError, match=f"not a readable {ending} file"):
        read_log(tmp_path / f"log{ending}")


def workbook(path, **sheets):
    with pd.ExcelWriter(path) as writer:
        for name, table in sheets.items():
            pd.DataFrame(table).to_excel(writer, sheet_name=name, index=False)
    return path


SPEEDS = {"Time [s]": TIME, "Motor speed [rpm]": 10.0 * TIME, "Hook load [t]": 55.0 + 0.0 * TIME}
OILS = {"Time [s]": TIME, "Pressure A [bar]": 180.0 + TIME, "Pressure B [bar]": 25.0 + TIME,
        "Displacement [cm3/rev]": 215.0 + 0.0 * TIME}  # fmt: skip


def test_sheets_of_other_signals_at_the_same_times_are_read_side_by_side(tmp_path):
    path = workbook(tmp_path / "log.xlsx", Winch=SPEEDS, Oil=OILS)
    log = read_log(path)
    assert {column.name for column in log.columns} == {*SPEEDS, *OILS}
    assert log.notes == ("sheets 'Oil', 'Winch' hold the same times: read side by side",)
    run = import_log(path, propose([path], None).log_map, None)
    assert run["main.pressure_b"] == pytest.approx(1e5 * OILS["Pressure B [bar]"])
    assert run["hook_load"] == pytest.approx(np.full(len(TIME), 55e3))


def test_sheets_of_other_times_or_of_the_same_signals_are_not_and_it_is_said(tmp_path):
    late = SPEEDS | {"Time [s]": TIME + 0.007}
    log = read_log(workbook(tmp_path / "late.xlsx", Winch=late, Oil=OILS))
    assert {column.name for column in log.columns} == set(OILS)
    assert "the others are 'Winch'; other signals of this run? join them by time into one sheet" in log.notes[0]
    twice = read_log(workbook(tmp_path / "twice.xlsx", One=OILS, Two=OILS))
    assert {column.name for column in twice.columns} == set(OILS)
    assert "'Two' with the same columns: another run, or the rows that follow?" in twice.notes[0]
    alone = read_log(workbook(tmp_path / "alone.xlsx", Log=OILS, Remarks={"Remark": ["calm sea"]}))
    assert alone.notes == ("read from sheet 'Log'; the others are 'Remarks'",)


def test_plain_hdf5_is_read_with_its_units_and_names(tmp_path):
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "log.h5", "w") as file:
        file["winch/time"] = TIME
        file["winch/speed"] = 10.0 * TIME
        file["winch/speed"].attrs["Units"] = "rpm"
        file["oil/a/pressure"], file["oil/b/pressure"] = 180.0 + TIME, 25.0 + TIME
        file["oil/a/pressure"].attrs["unit"] = np.bytes_("bar")
        file["stamp"] = [f"2026-03-01 10:00:{each:05.2f}" for each in TIME]
        file["version"] = 3
    log = read_log(tmp_path / "log.h5")
    assert {column.name: column.unit for column in log.columns} == {
        "time": "", "speed": "rpm", "oil.a.pressure": "bar", "oil.b.pressure": "", "stamp": "",
    }  # fmt: skip
    assert log.column("stamp").text[1] == "2026-03-01 10:00:00.02"
    with h5py.File(tmp_path / "rows.hdf5", "w") as file:
        file["log"] = pd.DataFrame(TABLE).to_records(index=False)
    assert [column.name for column in read_log(tmp_path / "rows.hdf5").columns] == list(TABLE)


def test_what_pandas_has_cut_up_is_answered_with_what_to_do(tmp_path):
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "log.h5", "w") as file:
        file.create_group("df").attrs["pandas_type"] = "frame"
        file["df/block0_values"] = np.eye(3)
    with pytest.raises(InputError, match=r"pandas.read_hdf\('log.h5'\).to_parquet"):
        read_log(tmp_path / "log.h5")


def test_the_first_bytes_tell_what_an_ending_does_not(tmp_path):
    text = "\t".join(TABLE) + "\n" + "\n".join("\t".join(map(str, row)) for row in zip(*TABLE.values(), strict=True))
    for name in ("log.xls", "log.dat"):
        (tmp_path / name).write_text(text, encoding="utf-8")
        assert list(values(tmp_path / name)) == list(TABLE)
    write_workbook(tmp_path / "log.xlsx", [list(TABLE), *zip(*TABLE.values(), strict=True)]).rename(
        tmp_path / "new.xls"
    )
    assert list(values(tmp_path / "new.xls")) == list(TABLE)
    (tmp_path / "bus.dat").write_bytes(b"MDF     3.30    and nothing behind it")
    with pytest.raises(InputError, match="not a readable .dat file"):
        read_log(tmp_path / "bus.dat")


def test_a_kind_without_a_reader_is_answered_with_a_way(tmp_path):
    (tmp_path / "log.feather").write_bytes(b"ARROW1")
    with pytest.raises(InputError, match=r"pandas.read_feather\('log.feather'\).to_parquet"):
        read_log(tmp_path / "log.feather")


@pytest.mark.parametrize("block", [0, 512])
def test_hdf5_under_matlabs_ending_needs_no_head_of_matlabs(block, tmp_path):
    """h5py, Julia and others write .mat of version 7.3 so; it was called corrupt."""
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "log.mat", "w", userblock_size=block) as file:
        file["time"] = np.arange(5.0)
        file["motor_speed"] = np.arange(5.0)[None] * 10.0
        file["motor_speed"].attrs["unit"] = "rpm"
    log = read_log(tmp_path / "log.mat")
    assert {c.name: c.unit for c in log.columns} == {"time": "", "motor_speed": "rpm"}
    np.testing.assert_array_equal(log.column("motor_speed").values, np.arange(5.0) * 10.0)
