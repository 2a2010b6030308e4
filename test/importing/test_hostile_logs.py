"""Logs that mean harm, or look like it: one line, quickly, without filling the memory."""

import gzip
import time
import tracemalloc
import zipfile

import pytest
from importing.logs import example, rows_of, write_text, write_workbook

from winch_friction.importing.mapping import load_map
from winch_friction.importing.propose import propose
from winch_friction.importing.reading import read_log
from winch_friction.physics.errors import InputError

QUICK = 2.0  # s of the processor
LARGEST = 500 << 20  # bytes


def huge_cell(path):
    path.write_text("time,speed\n0,1\n0.1," + "9" * 3_000_000 + "\n0.2,3\n")


def zero_bytes(path):
    path.write_bytes(b"time,speed\n0,1\n0.1,\x00\x00\n0.2,3\n")


def gzip_bomb(path):
    with gzip.open(path, "wb", compresslevel=1) as stream:
        for _ in range(300):
            stream.write(bytes(1 << 20))


def zip_bomb(path):
    with (
        zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive,
        archive.open("log.csv", "w") as stream,
    ):
        for _ in range(300):
            stream.write(b"0" * (1 << 20))


def workbook_bomb(path):
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        archive.writestr("[Content_Types].xml", "<Types/>")
        with archive.open("xl/worksheets/sheet1.xml", "w") as stream:
            for _ in range(300):
                stream.write(b" " * (1 << 20))


def no_line_end(path):
    path.write_bytes(b"1;2;" * (1 << 20))


def letters(path):
    path.write_text("a poem\nof two lines\n")


HOSTILE = {
    "cell.csv": huge_cell, "zeros.csv": zero_bytes, "bomb.csv.gz": gzip_bomb, "bomb.zip": zip_bomb,
    "bomb.xlsx": workbook_bomb, "line.csv": no_line_end,
    "poem.txt": letters, "empty.csv": lambda path: path.write_bytes(b""),
}  # fmt: skip


@pytest.mark.parametrize("name", HOSTILE)
def test_it_is_refused_in_one_line(tmp_path, name):
    HOSTILE[name](tmp_path / name)
    tracemalloc.start()
    began = time.process_time()
    with pytest.raises(InputError) as refused:
        read_log(tmp_path / name)
    assert time.process_time() - began < QUICK
    assert tracemalloc.get_traced_memory()[1] < LARGEST
    tracemalloc.stop()
    assert len(str(refused.value)) < 500
    assert "\n" not in str(refused.value)


MAPS = {
    "deep": "schema: winch_friction.map/1\ncolumns: " + "[" * 5000 + "]" * 5000,
    "large": "a: b\n" * 100_000,
    "aliases": "a: &a [x,x,x,x,x,x,x]\nb: &b [*a,*a,*a,*a,*a,*a]\nc: &c [*b,*b,*b,*b,*b]\nschema: [*c,*c,*c]\n",
    "list": "- 1\n- 2\n",
    "unknown key": "schema: winch_friction.map/1\ncolumns: {motor_speed: {from: n, colour: red}}\n",
    "no columns": "schema: winch_friction.map/1\ncolumns: {}\n",
    "sign": "schema: winch_friction.map/1\ncolumns: {motor_speed: {from: n, sign: 2}}\n",
    "tag": "schema: !!python/object/apply:os.system ['true']\n",
}


@pytest.mark.parametrize("name", MAPS)
def test_a_hostile_map_is_refused_in_one_line(tmp_path, name):
    path = tmp_path / "map.yaml"
    path.write_text(MAPS[name])
    began = time.process_time()
    with pytest.raises(InputError) as refused:
        load_map(path)
    assert time.process_time() - began < QUICK
    assert "\n" not in str(refused.value)


def test_a_cell_of_1e30_is_named_and_missing(tmp_path, crane_150t):
    from winch_friction.importing.carry_out import import_log

    rows = rows_of(example("test_02"), decimal=".")
    rows[100][2] = "1e30"
    log = write_text(tmp_path / "log.csv", rows)
    found = propose([log], crane_150t, "crane_150t")
    assert found.problems == ()
    run = import_log(log, found.log_map, crane_150t)
    assert any("line 101" in said and "no sensor gives" in said for said in run.warnings)


def test_formulas_without_stored_values_are_said(tmp_path, crane_150t):
    rows = [list(row) for row in rows_of(example("test_02"))]
    for k, row in enumerate(rows[1:], 2):
        row[2] = f"=B{k}*2"
    log = write_workbook(tmp_path / "log.xlsx", rows)
    assert any("formula without a stored value" in note for note in read_log(log).notes)


@pytest.mark.parametrize(
    ("names", "encoding", "noted"),
    [
        ("Время;Обороты двигателя;Давление А", "cp1251", True),
        ("時間;モーター速度;圧力A", "cp932", True),
        ("Zeit;Öltemperatur;Seillänge ausgelegt", "cp1252", False),
        ("Время;Обороты двигателя;Давление А", "utf-8", False),
    ],
)
def test_names_in_an_encoding_that_is_not_told_are_noted(tmp_path, names, encoding, noted):
    """They were Àáâ without a word, and one of them a channel."""
    rows = [names, *(f"{0.02 * k:.2f};{k};{100 + k}" for k in range(50))]
    (tmp_path / "log.csv").write_bytes("\n".join(rows).encode(encoding))
    assert any("save it as UTF-8" in each for each in read_log(tmp_path / "log.csv").notes) == noted


@pytest.mark.parametrize("rows", [2, 3, 9])
def test_a_log_of_few_rows_is_no_defect(tmp_path, crane_150t, rows):
    """Fewer rows than the speed is smoothed over: `np.gradient` met a record of another length."""
    log = write_text(tmp_path / "log.csv", rows_of(example("test_02"))[: rows + 1])
    found = propose([log], crane_150t, "crane_150t")
    assert "motor_speed" in found.log_map.columns
