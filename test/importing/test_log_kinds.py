"""Every kind of log that the import reads, written here by the library that reads it, comes back as the run it was."""

import gc
import gzip
import zipfile

import numpy as np
import pytest
from importing.logs import GERMAN, example, rows_of, same, write_text

from winch_friction.importing.carry_out import import_log
from winch_friction.importing.propose import propose
from winch_friction.importing.reading import read_log
from winch_friction.physics.errors import InputError

RUN = "test_08"


def named(run):
    """Times and columns under a crane maker's names, in his units."""
    return {GERMAN[c][0]: v * GERMAN[c][1] for c, v in run.columns.items() if c in GERMAN}


def write_mat(path, run):
    from scipy.io import savemat

    names = {"n_motor": "motor_speed", "p_A": "main.pressure_a", "p_B": "main.pressure_b", "Vg": "main.displacement"}
    log = {name: run[channel] * GERMAN[channel][1] for name, channel in names.items()}
    log |= {"t": run.time, "hook_load": run["hook_load"] * 1e-3, "wire_out": run["wire_out"], "gain": 3.0}
    savemat(path, {"log": log})


def write_mat73(path, run):
    h5py = pytest.importorskip("h5py")
    with h5py.File(path, "w", userblock_size=512) as file:
        group = file.create_group("log")
        group["time"] = run.time[None, :]
        for name, channel in {
            "motor_speed_rpm": "motor_speed", "druck_A_bar": "main.pressure_a", "druck_B_bar": "main.pressure_b",
            "verdraengung_ccm": "main.displacement", "last_t": "hook_load", "seillaenge_m": "wire_out",
        }.items():  # fmt: skip
            group[name] = (run[channel] * GERMAN[channel][1])[None, :]
    with path.open("r+b") as stream:
        stream.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM")


def write_tdms(path, run):
    nptdms = pytest.importorskip("nptdms")
    step = float(np.median(np.diff(run.time)))
    with nptdms.TdmsWriter(path) as writer:
        writer.write_segment([
            nptdms.ChannelObject("Winde", "Zeit", run.time, properties={"unit_string": "s"}),
            *(
                nptdms.ChannelObject("Winde", name.partition(" [")[0], values,
                                     properties={"unit_string": name.partition("[")[2].rstrip("]")})
                for name, values in named(run).items()
            ),
        ])  # fmt: skip
    return step


def write_mf4(path, run):
    asammdf = pytest.importorskip("asammdf")
    with asammdf.MDF(version="4.10") as file:
        for name, values in named(run).items():
            bare, _, unit = name.partition(" [")
            slow = slice(None, None, 10) if "last" in name.lower() else slice(None)
            file.append([asammdf.Signal(values[slow], run.time[slow], name=bare, unit=unit.rstrip("]"))])
        file.save(path, overwrite=True)


def write_parquet(path, run):
    import pandas as pd

    pd.DataFrame({"Zeit [s]": run.time, **named(run)}).to_parquet(path)


def write_gz(path, run):
    plain = write_text(path.with_suffix(""), rows_of(run))
    path.write_bytes(gzip.compress(plain.read_bytes()))


def write_zip(path, run):
    plain = write_text(path.with_suffix(".csv"), rows_of(run))
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.write(plain, "export.csv")


KINDS = {
    "v5.mat": write_mat, "v73.mat": write_mat73, "log.tdms": write_tdms, "log.mf4": write_mf4,
    "log.parquet": write_parquet, "log.csv.gz": write_gz, "log.zip": write_zip,
}  # fmt: skip


@pytest.mark.filterwarnings("error::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize("name", ["log.csv.gz", "log.zip", "log.mf4"])
def test_a_log_with_other_bytes_in_it_is_refused_in_one_line(tmp_path, name):
    """zlib has an error of its own, and asammdf wrote a traceback of what it had begun."""
    KINDS[name](tmp_path / name, example(RUN))
    content, place = bytearray((tmp_path / name).read_bytes()), 16 if name == "log.mf4" else 200
    content[place : place + 400] = bytes(400)
    (tmp_path / name).write_bytes(content)
    with pytest.raises(InputError, match=rf"{name}: not a readable \.(gz|zip|mf4) file"):
        read_log(tmp_path / name)
    gc.collect()


def test_waveforms_of_a_tdms_file_begin_when_they_say(tmp_path):
    """What began 3 s later was 3 s too early, and the run had no date."""
    nptdms = pytest.importorskip("nptdms")
    began = np.datetime64("2026-03-01T10:00:00.5", "us")

    def written(*starts):
        with nptdms.TdmsWriter(tmp_path / "log.tdms") as writer:
            writer.write_segment([
                nptdms.ChannelObject(f"group {k}", f"signal {k}", np.arange(500.0 - 100 * k),
                                     {"wf_increment": 0.02, **({"wf_start_time": start} if start else {})})
                for k, start in enumerate(starts)
            ])  # fmt: skip
        return read_log(tmp_path / "log.tdms")

    log = written(began, began + np.timedelta64(3, "s"))
    assert log.column("time").values[:2] == pytest.approx([1_772_359_200.5, 1_772_359_200.52], abs=1e-6)
    assert np.isnan(log.column("signal 1").values[149])
    assert log.column("signal 1").values[150:153] == pytest.approx([0.0, 1.0, 2.0], abs=1.0)
    unset = np.datetime64("1904-01-01T00:00:00", "us")
    for other, notes in ((began, 1), (None, 0), (unset, 0)):
        log = written(other, None)
        assert log.column("time").values[0] == log.column("signal 1").values[0] == 0.0
        assert sum("wf_start_time" in note for note in log.notes) == notes


@pytest.mark.parametrize("kind", ["tdms", "mf4"])
def test_channels_of_one_name_in_two_groups_are_two_columns(tmp_path, kind):
    """Each motor's controller logs its `Druck` with times of its own: the import ended in a traceback."""
    time = 0.02 * np.arange(500)
    if kind == "tdms":
        nptdms = pytest.importorskip("nptdms")
        with nptdms.TdmsWriter(tmp_path / "log.tdms") as writer:
            writer.write_segment([
                nptdms.ChannelObject(f"motor {k}", "Druck", time + k, {"wf_increment": 0.02}) for k in range(2)
            ] + [nptdms.ChannelObject("crane", "Druck", time + 9.0)])  # fmt: skip
    else:
        asammdf = pytest.importorskip("asammdf")
        with asammdf.MDF(version="4.10") as file:
            for k in range(2):
                file.append([asammdf.Signal(time + k, time, name="Druck")])
            file.save(tmp_path / "log.mf4", overwrite=True)
    log = read_log(tmp_path / f"log.{kind}")
    assert [column.name for column in log.columns] == ["time", "Druck", "Druck #2"]
    assert log.column("Druck #2").values == pytest.approx(time + 1.0)
    assert sum("without times left out: 'Druck'" in note for note in log.notes) == (kind == "tdms")


@pytest.mark.parametrize("name", KINDS)
def test_a_log_of_this_kind(tmp_path, crane_150t, name):
    run = example(RUN)
    KINDS[name](tmp_path / name, run)
    found = propose([tmp_path / name], crane_150t, "crane_150t")
    assert found.problems == ()
    back = import_log(tmp_path / name, found.log_map, crane_150t)
    assert len(back) == len(run)
    assert same(back, run, [c for c in run.columns if c in back and c not in ("time", "hook_load")])
    assert np.max(np.abs(back["hook_load"] - run["hook_load"])) <= 100.0  # kg; held in .mf4, slowly logged
    assert np.allclose(back.time - back.time[0], run.time - run.time[0], atol=2e-3)


@pytest.mark.parametrize(
    "suffix", [".mat", ".tdms", ".mf4", ".parquet", ".xlsx", ".gz", ".zip", ".csv", ".xls", ".doc"]
)
def test_rubbish_of_this_kind_is_refused_in_one_line(tmp_path, suffix):
    path = tmp_path / f"log{suffix}"
    path.write_bytes(bytes(range(256)) * 40)
    with pytest.raises(InputError) as refused:
        read_log(path)
    assert str(path) in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_library_that_is_absent_is_named_with_its_command(tmp_path, monkeypatch):
    import sys

    monkeypatch.setitem(sys.modules, "nptdms", None)
    (tmp_path / "log.tdms").write_bytes(b"TDSm")
    with pytest.raises(InputError, match=r"pip install 'winch_friction\[import\]', or pip install nptdms"):
        read_log(tmp_path / "log.tdms")
