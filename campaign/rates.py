"""The rate campaign (`make campaign-rates`): nodes at 50, 100 and 200 Hz inputs, in real time, for five minutes each.

    python -m campaign.rates [--quick] [--minutes 5] [--out docs/campaign_rates.md]

Simulator, compensator and estimator run as separate processes over DDS with the nodes' default quality of service
(best effort). A fourth process listens. Samples lost: the simulator published them and a node did not count them.
"""

import argparse
import os
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from campaign.commit import commit
from winch_friction.records.domain import unused_domain

RATES = (50, 100, 200)  # Hz
STARTING = 90.0  # s that the nodes get to start
AFTERWARDS = 3.0  # s for the last diagnostics
OUT = Path("docs/campaign_rates.md")
NODES = ("simulator", "compensator", "estimator")


@dataclass(frozen=True)
class Row:
    """What one rate gave; delays in ms from the speed's sending to the answer's, CPU in % of one core."""

    rate: int
    published: int
    lost_by_compensator: int
    lost_by_estimator: int
    answered: int
    median: float
    p99: float
    longest: float
    cpu: dict[str, float]


def measure(rate: int, duration: float, priority: int) -> Row:
    """Run the three nodes at one rate, at this nice value."""
    os.environ |= {"ROS_DOMAIN_ID": str(unused_domain()), "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
    os.environ |= dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"), "1")
    from campaign.rates_listener import Listener

    processes = {name: _start(name, rate, duration, priority) for name in NODES}
    try:
        with Listener() as listener:
            listener.wait_for_nodes(STARTING)
            before = {name: _cpu_seconds(each.pid) for name, each in processes.items()}
            began = time.monotonic()
            listener.listen(duration + 60.0)
            elapsed = time.monotonic() - began
            cpu = {n: 100.0 * (_cpu_seconds(p.pid) - before[n]) / elapsed for n, p in processes.items()}
            listener.listen_on(AFTERWARDS)
            return _row(rate, listener, cpu)
    finally:
        for each in processes.values():
            each.terminate()
        for each in processes.values():
            each.wait(20.0)


def _start(name: str, rate: int, duration: float, priority: int) -> subprocess.Popen[Any]:
    parameters = {
        "simulator": {"scenario": "ahc_irregular", "sensor_rate": float(rate), "duration": duration, "rate": 1.0,
                      "publish_clock": "false", "subscribers": 3},
    }.get(name, {})  # fmt: skip
    overrides = [part for key, value in parameters.items() for part in ("-p", f"{key}:={value}")]
    command = ["nice", "-n", str(priority), sys.executable, "-m", f"winch_friction.nodes.{name}"]
    return subprocess.Popen([*command, "--ros-args", *overrides])


def _cpu_seconds(pid: int) -> float:
    fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def _row(rate: int, listener: Any, cpu: dict[str, float]) -> Row:
    import numpy as np

    published = listener.published
    delays = np.array(listener.delays()) * 1e3
    median, p99, longest = np.percentile(delays, [50, 99, 100])
    lost = {node: published - listener.received(node) for node in ("compensator", "estimator")}
    counts = (published, lost["compensator"], lost["estimator"], len(delays))
    return Row(rate, *counts, float(median), float(p99), float(longest), cpu)


def table(rows: list[Row], minutes: float, priority: int) -> str:
    """Markdown with command and commit."""
    load = ", ".join(f"{each:.1f}" for each in os.getloadavg())
    head = (
        "# Nodes at 50, 100 and 200 Hz\n\n"
        f"`{' '.join(['python -m campaign.rates', *sys.argv[1:]])}`, commit {commit()}, {os.cpu_count()} cores "
        f"(shared: load average at the end {load}; the nodes ran at nice {priority}).\n\n"
        f"{minutes:g} minutes each, real time: simulator, compensator and estimator as processes over Fast DDS, "
        "fourteen input topics, best-effort subscriptions. Lost: published by the simulator, not counted by the node. "
        "Delay: from the sending of a speed to the sending of its feedforward. CPU: share of one core.\n\n"
    )
    columns = (
        "| inputs | samples | lost by compensator | lost by estimator | delay median | 99 % | longest | "
        "CPU simulator | compensator | estimator |\n|" + "--:|" * 10 + "\n"
    )
    body = "".join(
        f"| {r.rate} Hz | {r.published} | {r.lost_by_compensator} | {r.lost_by_estimator} | {r.median:.1f} ms | "
        f"{r.p99:.1f} ms | {r.longest:.0f} ms | " + " | ".join(f"{r.cpu[n]:.0f} %" for n in NODES) + " |\n"
        for r in rows
    )
    return head + columns + body


def main() -> int:
    """Entry point; status 1 when a sample was lost."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="ten seconds each, to the screen only")
    parser.add_argument("--minutes", type=float, default=5.0)
    parser.add_argument("--nice", type=int, default=0, help="priority of the nodes, where the machine is shared")
    parser.add_argument("--out", type=Path, default=OUT)
    options = parser.parse_args()
    minutes = 1.0 / 6.0 if options.quick else options.minutes
    rows = []
    for rate in RATES:
        rows.append(measure(rate, 60.0 * minutes, options.nice))
        print(rows[-1], flush=True)
    text = table(rows, minutes, options.nice)
    print(text)
    if not options.quick:
        from winch_friction.records.atomic import write_text

        write_text(options.out, text)
    return int(any(row.lost_by_compensator or row.lost_by_estimator for row in rows))


if __name__ == "__main__":
    sys.exit(main())
