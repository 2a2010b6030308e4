"""The demo's processes: three nodes and the stage, started, listened to, and ended."""

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import IO, Any

from winch_friction.physics.errors import InputError
from winch_friction.records.domain import unused_domain

NODES = ("simulator", "compensator", "estimator")
GRACE = 15.0  # s that a process gets to end


def quiet_environment() -> dict[str, str]:
    """One thread per process, this machine alone, and one domain for all that this process starts unless one is
    given."""
    environment = dict(os.environ)
    environment |= dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"), "1")
    environment.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    environment.setdefault("ROS_DOMAIN_ID", str(_domain()))
    return environment


@cache
def _domain() -> int:
    return unused_domain()  # asked again, it would give another one: in this one the first node is by then


@contextmanager
def running_nodes(parameter_file: Path, logs: Path) -> Iterator[dict[str, subprocess.Popen[Any]]]:
    """The three nodes as processes; their logs go to `logs`/<node>.log."""
    logs.mkdir(parents=True, exist_ok=True)
    processes: dict[str, subprocess.Popen[Any]] = {}
    try:
        for name in NODES:
            arguments = ["--ros-args", "--params-file", str(parameter_file)]
            with (logs / f"{name}.log").open("w") as log:
                processes[name] = _start(f"winch_friction.nodes.{name}", arguments, log)
        yield processes
    finally:
        end(processes.values())


@contextmanager
def running_stage(plan_file: Path, logs: Path) -> Iterator[subprocess.Popen[str]]:
    """The stage; its lines come on stdout, what it complains of goes to `logs`/stage.log."""
    with (logs / "stage.log").open("w") as log:
        stage = _start("winch_friction.nodes.stage", [str(plan_file)], log, subprocess.PIPE)
    try:
        yield stage
    finally:
        end([stage])


def events(
    stage: subprocess.Popen[str], nodes: dict[str, subprocess.Popen[Any]], logs: Path
) -> Iterator[dict[str, Any]]:
    """What the stage says, as it says it; `InputError` when it gives up or a node has died."""
    assert stage.stdout is not None
    for line in stage.stdout:
        event = json.loads(line)
        if event["event"] == "error":
            raise InputError(f"{event['message']}{_dead(nodes, logs)}")
        yield event
        if dead := _dead(nodes, logs):
            raise InputError(f"the demo stopped:{dead}")
    if stage.wait() != 0:
        raise InputError(f"the stage ended with status {stage.returncode}, see {logs}/stage.log{_dead(nodes, logs)}")


def end(processes: Any) -> None:
    """Ask them to end, wait, insist."""
    processes = list(processes)
    for each in processes:
        if each.poll() is None:
            each.send_signal(signal.SIGINT)
    for each in processes:
        try:
            each.wait(GRACE)
        except subprocess.TimeoutExpired:
            each.kill()
            each.wait()


def _start(
    module: str, arguments: Sequence[str], errors: IO[str], output: Any = subprocess.DEVNULL
) -> subprocess.Popen[Any]:
    command = [sys.executable, "-m", module, *arguments]
    return subprocess.Popen(
        command, stdout=output, stderr=errors, stdin=subprocess.DEVNULL, text=True, env=quiet_environment()
    )


def _dead(nodes: dict[str, subprocess.Popen[Any]], logs: Path) -> str:
    dead = [name for name, process in nodes.items() if process.poll() is not None]
    return "".join(f" node '{name}' has ended, see {logs / name}.log" for name in dead)
