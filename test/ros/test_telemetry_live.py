"""Watch hears running publishers, in a process of its own."""

import itertools
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from winch_friction.cli.live import Listener, live_frames
from winch_friction.cli.main import run


def test_the_listener_hears_what_is_published(bench, monkeypatch):
    monkeypatch.setenv("ROS_DOMAIN_ID", str(bench.domain))
    frames: list = []
    source = live_frames("")
    listener = threading.Thread(target=lambda: frames.extend(itertools.islice(source, 25)), daemon=True)
    listener.start()
    bench.announce()
    bench.drive(2.0)
    assert bench.spin(30.0, lambda: not listener.is_alive())
    source.close()
    speeds = [value for frame in frames for _, value in frame["points"].get("speed", [])]
    assert speeds
    assert max(map(abs, speeds)) < 1000.0  # rpm; the swell turns at 100 rad/s at most


def _gone(pid: int, patience: float) -> bool:
    """Whether a process has ended, or is only waiting to be asked how."""
    until = time.monotonic() + patience
    while time.monotonic() < until:
        state = Path(f"/proc/{pid}/stat")
        if not state.exists() or state.read_text().rpartition(")")[2].split()[0] == "Z":
            return True
        time.sleep(0.1)
    return False


def test_the_listener_ends_though_nothing_is_ever_heard(bench, monkeypatch):
    monkeypatch.setenv("ROS_DOMAIN_ID", str(bench.domain))
    listener = Listener("", "--raw")
    reader = threading.Thread(target=lambda: list(listener.messages()), daemon=True)
    reader.start()
    time.sleep(1.0)
    listener.close()
    reader.join(5.0)
    assert not reader.is_alive()


@pytest.mark.parametrize("after", [0.0, 3.0], ids=["while it starts", "when it is up"])
def test_the_listener_does_not_outlive_a_killed_reader(bench, monkeypatch, after):
    monkeypatch.setenv("ROS_DOMAIN_ID", str(bench.domain))
    code = (
        "import time; from winch_friction.cli.live import Listener; "
        "print(Listener('', '--raw')._process.pid, flush=True); time.sleep(60)"
    )
    reader = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True)
    pid = int(reader.stdout.readline())
    time.sleep(after)
    reader.kill()
    reader.wait()
    assert _gone(pid, 30.0)


@pytest.mark.parametrize(
    ("namespace", "domain", "said"),
    [("a b", "", "namespace must not contain"), ("", "abc", "ROS_DOMAIN_ID is not"), ("", "999", "the listener ended")],
)
def test_a_namespace_or_domain_that_there_cannot_be_is_one_line(bench, monkeypatch, capfd, namespace, domain, said):
    monkeypatch.setenv("ROS_DOMAIN_ID", domain or str(bench.domain))
    assert run(["watch", "--namespace", namespace, "--json", "--frames", "1"]) == 2
    heard = capfd.readouterr().err.strip().splitlines()
    assert said in heard[-1]
    assert len(heard) == 1
