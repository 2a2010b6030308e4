"""`winch-friction doctor`: whether this machine has what it takes, each finding with what to do."""

import importlib.util
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from importlib import metadata
from pathlib import Path
from typing import Annotated

import typer

from winch_friction.cli.console import show_json, show_table

GOOD, NOTE, BAD = "ok", "note", "problem"
_NODES = ("numpy", "scipy", "sympy", "filterpy", "PyYAML")
_DESK = (
    "pandas",
    "pyarrow",
    "pint",
    "pydantic",
    "rosbags",
    "scikit-learn",
    "statsmodels",
    "arch",
    "numba",
    "plotly",
    "jinja2",
    "matplotlib",
)
_LEAST_SHARED_MEMORY = 16e6  # bytes; Fast DDS keeps one segment per participant, three nodes need about 2 MB
_LONGEST_TALK = 20.0  # s; starting a node takes a second or two on a busy machine
_BUILT = 1_704_067_200.0  # s, 1 January 2024: a clock before it has lost its battery


@dataclass(frozen=True)
class Finding:
    """One check: its area, what was looked at, how it stands, what was found, what to do."""

    area: str
    what: str
    state: str
    found: str
    do: str = ""


def command(
    dds: Annotated[bool, typer.Option(help="Also start a node and hear it answer over DDS.")] = True,
    as_json: Annotated[bool, typer.Option("--json", help="As JSON.")] = False,
) -> None:
    """Look at environment, libraries, ROS, DDS, permissions, clock and configuration. Exit 2 when something is wrong.

    Example: winch-friction doctor
    """
    findings = [finding for check in _checks(dds) for finding in check()]
    if as_json:
        show_json([asdict(each) for each in findings])
    else:
        rows = [[f.area, f.what, f.state, f.found, f.do] for f in findings]
        show_table("doctor", ("area", "what", "state", "found", "what to do"), rows)
        bad = sum(f.state == BAD for f in findings)
        print("nothing is wrong" if not bad else f"{bad} problem{'s' if bad > 1 else ''}, see above")
    raise typer.Exit(2 if any(f.state == BAD for f in findings) else 0)


def _checks(dds: bool) -> list[Callable[[], Iterator[Finding]]]:
    return [_python, _libraries, _configuration, _permissions, _compiled_code, _clock, _ros, *([_talk] if dds else [])]


def _python() -> Iterator[Finding]:
    version = ".".join(map(str, sys.version_info[:3]))
    fits = (3, 11) <= sys.version_info[:2] <= (3, 12)
    yield Finding(
        "environment",
        "Python",
        GOOD if fits else NOTE,
        version,
        "" if fits else "ROS 2 Jazzy's wheels exist for 3.11 and 3.12: nodes need one of these",
    )


def _libraries() -> Iterator[Finding]:
    for group, names, extra in (("nodes", _NODES, ""), ("desk", _DESK, "[desk]")):
        absent = [name for name in names if _version(name) is None]
        state = GOOD if not absent else (BAD if group == "nodes" else NOTE)
        found = "all there" if not absent else f"missing: {', '.join(absent)}"
        yield Finding("libraries", group, state, found, f"pip install 'winch_friction{extra}'" if absent else "")


def _version(name: str) -> str | None:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return None


def _configuration() -> Iterator[Finding]:
    from winch_friction.cli.names import KINDS
    from winch_friction.physics.errors import InputError

    for kind in ("models", "cranes"):
        try:
            yield Finding("configuration", kind, GOOD, f"{len(KINDS[kind].rows())} can be read")
        except InputError as error:
            yield Finding("configuration", kind, BAD, str(error), "repair the file, or reinstall the package")


def _compiled_code() -> Iterator[Finding]:
    from winch_friction.cli.warming import warmed

    try:
        for name, seconds in warmed():
            yield Finding("compiled code", name, GOOD, f"ready after {seconds:.1f} s; it is kept for the next start")
    except (ImportError, OSError, RuntimeError) as error:
        do = "pip install 'winch_friction[desk]', or set XDG_CACHE_HOME to a folder of yours"
        yield Finding("compiled code", "cache", NOTE, f"works without, slower: {error}", do)


def _permissions() -> Iterator[Finding]:
    for name, folder in (("this folder", Path.cwd()), ("ROS logs", Path(os.environ.get("ROS_LOG_DIR", Path.home())))):
        ok = os.access(folder if folder.exists() else folder.parent, os.W_OK)  # the first node makes it
        yield Finding(
            "permissions",
            name,
            GOOD if ok else BAD,
            f"{folder} {'can' if ok else 'cannot'} be written",
            "" if ok else "change to a folder of yours, or set ROS_LOG_DIR",
        )
    shared = Path("/dev/shm")
    if shared.is_dir():
        free = shutil.disk_usage(shared).free
        ok = os.access(shared, os.W_OK) and free > _LEAST_SHARED_MEMORY
        yield Finding(
            "permissions",
            "shared memory",
            GOOD if ok else BAD,
            f"{free / 1e6:.0f} MB free in {shared}",
            "" if ok else "DDS uses it between nodes: in a container run with --shm-size=256m",
        )


def _clock() -> Iterator[Finding]:
    now = time.time()
    ok = now > _BUILT
    yield Finding(
        "clock",
        "date",
        GOOD if ok else BAD,
        time.strftime("%Y-%m-%d %H:%M UTC", time.gmtime(now)),
        "" if ok else "the clock has lost its time: set it, runs are dated by it",
    )
    begin = time.perf_counter()
    time.sleep(0.01)
    late = time.perf_counter() - begin - 0.01
    ok = late < 0.005  # s; a node that sleeps 5 ms too long misses half of a 100 Hz period
    yield Finding(
        "clock",
        "sleep of 10 ms",
        GOOD if ok else NOTE,
        f"{1e3 * late:.2f} ms late",
        "" if ok else "the machine is busy: nodes will answer late",
    )
    if shutil.which("timedatectl"):
        said = subprocess.run(
            ["timedatectl", "show", "-p", "NTPSynchronized", "--value"],
            capture_output=True,
            text=True,
            timeout=5,
            check=False,
        ).stdout.strip()
        if said:
            yield Finding(
                "clock",
                "synchronised",
                GOOD if said == "yes" else NOTE,
                said,
                "" if said == "yes" else "set up NTP or PTP: stamps of crane and nodes must agree",
            )


def _ros() -> Iterator[Finding]:
    try:
        import rclpy  # noqa: F401
    except Exception as error:  # a broken installation raises whatever its loader meets
        yield Finding(
            "ROS",
            "rclpy",
            NOTE,
            f"{type(error).__name__}: {error}"[:120],
            "needed by the nodes alone: source /opt/ros/jazzy/setup.bash, or pip install 'winch_friction[ros]'",
        )
        return
    yield Finding("ROS", "rclpy", GOOD, _version("ros-rclpy") or "of the sourced ROS")
    domain = os.environ.get("ROS_DOMAIN_ID", "0")
    ok = domain.lstrip("0") in ("", *map(str, range(1, 102)))
    yield Finding("ROS", "ROS_DOMAIN_ID", GOOD if ok else BAD, domain, "" if ok else "use 0 ... 101")
    scope = os.environ.get("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET (default)")
    yield Finding(
        "DDS",
        "discovery range",
        GOOD if scope == "LOCALHOST" else NOTE,
        scope,
        "" if scope == "LOCALHOST" else "nodes of the whole network are found; LOCALHOST keeps it to this machine",
    )
    yield Finding("DDS", "middleware", GOOD, os.environ.get("RMW_IMPLEMENTATION", "rmw_fastrtps_cpp (default)"))


def _talk() -> Iterator[Finding]:
    """A publisher and a subscription in a process of their own, over the middleware."""
    if importlib.util.find_spec("rclpy") is None:
        return
    command = [sys.executable, "-m", "winch_friction.nodes.doctor"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=_LONGEST_TALK, check=False)
        heard = float(done.stdout.split()[-1]) if done.returncode == 0 else None
    except (subprocess.TimeoutExpired, ValueError, IndexError):
        heard = None
    yield Finding(
        "DDS",
        "a node hears itself",
        GOOD if heard is not None else BAD,
        f"after {1e3 * heard:.1f} ms" if heard is not None else "nothing",
        "" if heard is not None else "look at firewall, loopback multicast and ROS_AUTOMATIC_DISCOVERY_RANGE",
    )
