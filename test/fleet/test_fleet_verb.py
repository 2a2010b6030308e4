"""`winch-friction fleet` over real recordings: folders, S3 storage, a real scheduler, and a kill in the middle."""

import json
import os
import signal
import socket
import subprocess
import sys
import time
from dataclasses import replace

import numpy as np
import pytest

from winch_friction.cli import main
from winch_friction.physics.errors import InputError
from winch_friction.records.runs import write_run
from winch_friction.simulation.scenario import load_scenario
from winch_friction.simulation.simulator import simulate

FILES = ["--crane", "crane_150t", "--model", "a6vm215_crane2"]
MONTH = 30.4 * 86400.0  # s


@pytest.fixture(scope="module")
def cranes(tmp_path_factory, crane_150t, crane2_model):
    """Two cranes with three dated runs each, and one file that is no run."""
    folder = tmp_path_factory.mktemp("cranes")
    scenario = load_scenario("ahc_irregular").override({"duration": 30.0})
    for k, crane in enumerate(("north", "south")):
        for month in range(3):
            run = simulate(scenario, crane_150t, crane2_model, seed=10 * k + month).run
            dated = replace(run, columns={**run.columns, "time": run.time - run.time[0] + 1.7e9 + month * MONTH})
            write_run(dated, folder / crane / f"month_{month}.parquet")
    (folder / "south" / "bad.csv").write_text("not,a\nrun,file\n")
    return folder


def fleet(capsys, *arguments):
    status = main.run(["fleet", *map(str, arguments), *FILES, "--json"])
    printed = capsys.readouterr()
    assert printed.out, printed.err
    return status, json.loads(printed.out[printed.out.index("{") :])  # a storage's server says hello before it


def test_a_folder_of_cranes_is_searched_and_a_bad_file_stops_nobody(cranes, tmp_path, capsys):
    status, found = fleet(capsys, "replay", cranes, "--out", tmp_path, "--workers", 0, "--option", "no-learn")
    assert status == 2
    by_crane = {(each["crane"], each["recording"].rpartition("/")[2]): each["status"] for each in found["outcomes"]}
    assert by_crane[("south", "bad.csv")] == 2
    assert sum(by_crane.values()) == 2
    assert (tmp_path / "replay" / "north" / "month_0.parquet").is_file()
    assert "north" in (tmp_path / "report.html").read_text()
    from winch_friction.fleet.store import read_store

    store = read_store(tmp_path / "store")
    assert set(store["crane"]) == {"north", "south"}
    assert len(set(store["month"])) == 3
    traits = store[store["kind"] == "trait"]
    assert (traits["std"] > 0.0).all()
    friction = traits[traits["name"] == "friction"]
    assert np.abs(friction["value"]).max() < 10.0  # %: the plant is the model
    assert set(traits["unit"]) == {"%", "N*m"}


def test_what_is_done_is_not_done_again(cranes, tmp_path, capsys, monkeypatch):
    one = cranes / "north"
    fleet(capsys, "check", one, "--out", tmp_path, "--workers", 0)
    first = (tmp_path / "fleet.jsonl").read_text()
    _, again = fleet(capsys, "check", one, "--out", tmp_path, "--workers", 0)
    assert (tmp_path / "fleet.jsonl").read_text() == first
    assert len(again["outcomes"]) == 3
    fleet(capsys, "check", one, "--out", tmp_path, "--workers", 0, "--anew")
    assert len((tmp_path / "fleet.jsonl").read_text().splitlines()) == 6


def test_what_was_refused_is_asked_again(cranes, tmp_path, capsys, monkeypatch):
    """A full disk or a library that was missing is mended, and the recordings are what they were."""

    def lacking():
        raise InputError("Parquet files need pyarrow")

    call = ("check", cranes / "north" / "month_0.parquet", "--out", tmp_path, "--workers", 0)
    with monkeypatch.context() as then:
        then.setattr("winch_friction.records.parquet_file._pyarrow", lacking)
        status, found = fleet(capsys, *call)
        assert (status, found["outcomes"][0]["message"][-26:]) == (2, "Parquet files need pyarrow")
    assert fleet(capsys, *call)[0] == 0


def test_object_storage_gives_what_the_disk_gives(cranes, tmp_path, capsys, monkeypatch):
    pytest.importorskip("s3fs")
    server_module = pytest.importorskip("moto.server")
    import s3fs

    for key, value in {"AWS_ACCESS_KEY_ID": "any", "AWS_SECRET_ACCESS_KEY": "any", "AWS_REGION": "us-east-1"}.items():
        monkeypatch.setenv(key, value)
    server = server_module.ThreadedMotoServer(ip_address="127.0.0.1", port=0)
    server.start()
    try:
        endpoint = "http://{}:{}".format(*server.get_host_and_port())
        store = s3fs.S3FileSystem(endpoint_url=endpoint)
        store.mkdir("logs")
        store.put(str(cranes / "north"), "logs/north", recursive=True)
        options = ["--workers", 0, "--storage", f"endpoint_url={endpoint}"]
        status, there = fleet(capsys, "replay", "s3://logs/north", "--out", tmp_path / "s3", *options)
    finally:
        server.stop()
    _, here = fleet(capsys, "replay", cranes / "north", "--out", tmp_path / "disk", "--workers", 0)
    assert status == 0
    assert [each["result"]["verb"] for each in there["outcomes"]] == [
        each["result"]["verb"] for each in here["outcomes"]
    ]


@pytest.mark.slow
def test_a_real_scheduler_and_worker_and_a_kill_in_the_middle(cranes, tmp_path, capsys):
    """Scheduler and worker are processes of their own; the fleet's process is killed, and its successor goes on."""
    pytest.importorskip("dask.distributed")
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        address = f"tcp://127.0.0.1:{probe.getsockname()[1]}"
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    dask = [sys.executable, "-m", "dask"]
    port = address.rpartition(":")[2]
    quiet = {"env": environment, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    scheduler = subprocess.Popen([*dask, "scheduler", "--host", "127.0.0.1", "--port", port, "--no-dashboard"], **quiet)
    worker = subprocess.Popen(
        [*dask, "worker", address, "--nworkers", "1", "--nthreads", "1", "--no-dashboard"], **quiet
    )
    command = [sys.executable, "-m", "winch_friction", "fleet", "replay", str(cranes / "north"), *FILES]
    command += ["--out", str(tmp_path), "--scheduler", address, "--json"]
    ledger = tmp_path / "fleet.jsonl"
    try:
        first = subprocess.Popen(command, **quiet)
        deadline = time.monotonic() + 90.0
        while time.monotonic() < deadline and not (ledger.exists() and ledger.stat().st_size):
            time.sleep(0.02)
        first.send_signal(signal.SIGKILL)
        first.wait()
        done = len(ledger.read_text().splitlines())
        assert done >= 1
        second = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=120, check=False)
    finally:
        for process in (worker, scheduler):
            process.kill()
            process.wait()
    assert second.returncode == 0, second.stderr
    assert len(ledger.read_text().splitlines()) <= 3 + 1  # at most the line that the kill cut short was done again
    there = [each["result"]["verb"] for each in json.loads(second.stdout)["outcomes"]]
    _, here = fleet(capsys, "replay", cranes / "north", "--out", tmp_path / "here", "--workers", 0)
    assert there == [each["result"]["verb"] for each in here["outcomes"]]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["weld", "."], "knows the verbs"),
        (["replay", "nowhere"], "no such file"),
        (["replay", "."], "no recording there"),
        (["replay", ".", "--storage", "endpoint"], "NAME=VALUE"),
        (["check", "one.csv", "--model", ""], "'' is neither a file nor a shipped name in models"),
        (["check", "one.csv", "--crane", "{ship}.yaml"], "'{ship}.yaml' is neither a file nor a shipped name in cran"),
    ],
)
def test_what_a_fleet_cannot_do_is_said(tmp_path, capsys, monkeypatch, arguments, said):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "notes.txt").write_text("x")
    if arguments[0] == "weld" or "one.csv" in arguments:
        (tmp_path / "one.csv").write_text("time\n")
    assert main.run(["fleet", *arguments[:2], *FILES, *arguments[2:], "--out", str(tmp_path / "out")]) == 2
    assert said in capsys.readouterr().err


def test_recordings_that_would_overwrite_each_other_are_refused(tmp_path, capsys):
    for folder in ("a/north", "b/north"):
        (tmp_path / folder).mkdir(parents=True)
        (tmp_path / folder / "x.csv").write_text("time\n")
    assert main.run(["fleet", "replay", str(tmp_path), *FILES, "--out", str(tmp_path / "out")]) == 2
    assert "rename one" in capsys.readouterr().err
