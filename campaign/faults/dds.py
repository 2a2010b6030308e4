"""Faults over real DDS: processes that are killed, stopped and restarted, and a network that misbehaves.

The test bench's probe publishes a swell, listens to the compensator's process, and applies what it says as a consumer
has to (docs/safety.md).
"""

import math
import random
import signal
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from campaign.faults.network import late_joiner, lossy_relay, mismatch
from campaign.faults.watch import Row

ROOT = Path(__file__).resolve().parents[2]
SLEW, BOUND = 1.5e4, 2000.0  # N m/s, N m: the compensator's own limits
RAMP = 0.3  # s
STARTING = 30.0  # s that a process may take to start on a busy machine
SETTLE = 1.0  # s of healthy sailing before each fault
PER_PROCESS = 12  # trials with one compensator's process
LATENESS = 0.005  # s that a message's arrival may be off by: two of them make a pair


class Probe:
    """A bench with a compensator that runs, and every torque that came with the time at which it came."""

    def __init__(self, folder: Path, seed: int) -> None:
        sys.path.insert(0, str(ROOT / "test" / "ros"))
        from dds_bench import Bench
        from diagnostic_msgs.msg import DiagnosticArray
        from sensor_msgs.msg import JointState

        from winch_friction.nodes.qos import OUTPUT
        from winch_friction.online.consumer import HeldTorque

        self.random = random.Random(seed)
        self.bench = Bench(folder)
        self.torques: list[tuple[float, float, float]] = []  # arrival, stamp, N m
        self.consumer = HeldTorque()
        self.bench.node.create_subscription(JointState, "compensator/friction_torque", self._heard, OUTPUT)
        self.reports: list[Any] = []
        self.bench.node.create_subscription(DiagnosticArray, "/diagnostics", self.reports.append, 50)
        self.start()

    def said(self, part: str) -> str:
        """The latest summary of a node's part in the diagnostics."""
        statuses = (status for message in reversed(self.reports) for status in message.status)
        return next((str(status.message) for status in statuses if status.name.endswith(part)), "")

    def settle_after_pause(self) -> None:
        """The stamps go on where the time is now."""
        self.bench.time = time.time()

    def start(self) -> None:
        """The compensator's process, until it has faded in."""
        self.bench.start("compensator", ramp_time=RAMP, diagnostics_period=0.2)
        self.bench.announce()
        heard, deadline = len(self.torques), time.monotonic() + STARTING
        # a killed process is still counted among the subscribers for a while: only its successor's torque tells
        while time.monotonic() < deadline and not any(torque for *_, torque in self.torques[heard:]):
            self.bench.drive(0.1)
        self.bench.drive(SETTLE)

    def _heard(self, message: Any) -> None:
        from winch_friction.records.topics import stamp_time

        now = time.monotonic()
        self.torques.append((now, stamp_time(message), message.effort[0]))
        self.consumer.take(message.effort[0], now, message.header.frame_id)

    @property
    def alive(self) -> bool:
        """Whether the compensator's process still runs."""
        return self.bench.processes["compensator"].poll() is None

    def judge(self, begin: int, row: Row) -> None:
        """The pairs published since; a new process begins at zero."""
        said = self.torques[max(begin - 1, 0) :]
        for before, after in zip(said[:-1], said[1:], strict=True):
            passed = max(after[0] - before[0], after[1] - before[1], 0.0) + LATENESS
            change = abs(after[2] - before[2])
            row.largest = max(row.largest, abs(after[2]))
            row.steepest = max(row.steepest, change / (SLEW * passed))
            if not math.isfinite(after[2]):
                row.violations["not finite"] += 1
            if abs(after[2]) > BOUND:
                row.violations["beyond the bound"] += 1
            if change > SLEW * passed and after[2] != 0.0:
                row.violations["faster than the slew limit"] += 1


def _zero_after(probe: Probe, seconds: float, row: Row) -> None:
    """Nothing is published, or zero, by then."""
    began = time.monotonic()
    probe.bench.spin(seconds, lambda: bool(probe.torques) and probe.torques[-1][2] == 0.0)
    row.to_zero = max(row.to_zero, time.monotonic() - began)
    if probe.torques and probe.torques[-1][2] != 0.0:
        row.violations["not zero in time"] += 1


def silence(probe: Probe, row: Row) -> None:
    """Every input falls silent."""
    _zero_after(probe, 0.1 + 0.1 + RAMP + 0.4, row)
    probe.bench.spin(probe.random.uniform(0.0, 0.5))
    probe.bench.time = time.time()


def killed(probe: Probe, row: Row) -> None:
    """The compensator is killed: whoever uses its torque lets it go; it comes back without a bump."""
    process = probe.bench.processes["compensator"]
    process.send_signal(signal.SIGKILL)
    process.wait()
    began = time.monotonic()
    while time.monotonic() - began < 1.0 and probe.consumer.value(time.monotonic()) != 0.0:
        probe.bench.drive(0.02)
    row.to_zero = max(row.to_zero, time.monotonic() - began)
    if probe.consumer.value(time.monotonic()) != 0.0:
        row.violations["the consumer holds it for ever"] += 1
    probe.bench.time = time.time()
    probe.start()


def ended(probe: Probe, row: Row) -> None:
    """SIGINT or SIGTERM: the last message is zero."""
    process = probe.bench.processes["compensator"]
    process.send_signal(probe.random.choice((signal.SIGINT, signal.SIGTERM)))
    began = time.monotonic()
    while process.poll() is None and time.monotonic() - began < 6.0:
        probe.bench.drive(0.02)
    probe.bench.spin(0.2)
    row.to_zero = max(row.to_zero, time.monotonic() - began)
    if process.poll() is None:
        row.violations["does not end"] += 1
        process.kill()
    if probe.torques[-1][2] != 0.0:
        row.violations["the last torque is not zero"] += 1
    probe.bench.time = time.time()
    probe.start()


def stopped(probe: Probe, row: Row) -> None:
    """SIGSTOP, and everything that waited at once afterwards."""
    process = probe.bench.processes["compensator"]
    process.send_signal(signal.SIGSTOP)
    probe.bench.drive(probe.random.uniform(0.15, 1.5))
    process.send_signal(signal.SIGCONT)
    probe.bench.drive(0.6)


def second_publisher(probe: Probe, row: Row) -> None:
    """Somebody else commands the opposite."""

    def change(sample: Any) -> None:
        turn["n"] += 1
        if turn["n"] % 2:
            sample.speed_reference = -sample.speed_reference

    turn = {"n": 0}
    probe.bench.drive(probe.random.uniform(0.5, 1.5), change)
    probe.bench.drive(0.6)


def implausible(probe: Probe, row: Row) -> None:
    """A field says what this crane cannot."""
    which = probe.random.choice(("displacement", "pressure_a", "speed_reference", "hook_load", "motor_speed"))

    def change(sample: Any) -> None:
        if which in ("displacement", "pressure_a"):
            setattr(sample.groups["active"], which, {"displacement": 25.0, "pressure_a": 1.9e8}[which])
        else:
            setattr(sample, which, {"speed_reference": -2999.0, "hook_load": 9.9e6, "motor_speed": 2999.0}[which])

    probe.bench.drive(0.1 + RAMP + 0.4, change)
    if which != "hook_load" and probe.torques[-1][2] != 0.0:
        row.violations["obeyed although an input is impossible"] += 1
    probe.bench.time = time.time()


def frozen_stamp(probe: Probe, row: Row) -> None:
    """Live data under one stamp."""
    held = probe.bench.time

    def change(sample: Any) -> None:
        sample.time = held

    probe.bench.drive(0.1 + 0.1 + RAMP + 0.4, change)
    if probe.torques[-1][2] != 0.0:
        row.violations["obeyed under a frozen stamp"] += 1
    probe.bench.time = time.time()


def transitions(probe: Probe, row: Row) -> None:
    """Transitions that the state does not have."""
    from lifecycle_msgs.msg import Transition
    from lifecycle_msgs.srv import ChangeState

    client = probe.bench.node.create_client(ChangeState, "compensator/change_state")
    client.wait_for_service(5.0)
    for number in probe.random.choices((1, 2, 3, 200), k=3):
        asked = client.call_async(ChangeState.Request(transition=Transition(id=number)))
        probe.bench.drive(0.2)
        if asked.done() and asked.result().success:
            row.violations["an illegal transition succeeded"] += 1


def hostile_models(probe: Probe, row: Row) -> None:
    """Texts that are no models."""
    from std_msgs.msg import String

    from winch_friction.nodes.qos import LATCHED

    models = probe.bench.node.create_publisher(String, "friction_model", LATCHED)
    for text in probe.random.sample(("[" * 20000, "x" * 2_000_000, "schema: 1", "", "{a: &b [*b]}"), k=3):
        models.publish(String(data=text))
        probe.bench.drive(0.2)


IN_RANGE = (
    ("lead", 0.05), ("ramp_time", RAMP), ("ramp_time", 0.02), ("ramp_time", 60.0), ("max_age", 0.5),
    ("reversal_time", 1.0), ("slew_limit", 5000.0),
)  # fmt: skip
OUT_OF_RANGE = (("scale", 99.0), ("ramp_time", 0.0), ("slew_limit", 0.0), ("slew_limit", math.inf), ("max_age", 10.0))


def parameters(probe: Probe, row: Row) -> None:
    """Settings change while it works."""
    from winch_friction.physics.errors import InputError

    node = probe.bench.remote("compensator")
    for _ in range(3):
        name, value = probe.random.choice((*IN_RANGE, ("scale", probe.random.uniform(0.0, 1.3)), *OUT_OF_RANGE))
        try:
            node.set({name: value})
            taken = True
        except InputError:
            taken = False
        if taken == ((name, value) in OUT_OF_RANGE):
            row.violations[f"{name} {value:g} was {'taken' if taken else 'refused'}"] += 1
        probe.bench.drive(0.2)
    node.set({"scale": 0.9, "lead": 0.0, "ramp_time": RAMP, "max_age": 0.1, "reversal_time": 0.05, "slew_limit": SLEW})


KINDS: dict[str, Callable[[Probe, Row], None]] = {
    "silence": silence, "SIGKILL and restart": killed, "SIGINT or SIGTERM": ended, "SIGSTOP": stopped,
    "second publisher": second_publisher, "implausible value": implausible, "frozen stamp": frozen_stamp,
    "lossy relay": lossy_relay, "quality of service mismatch": mismatch,
    "illegal transition": transitions, "hostile model": hostile_models,
    "parameters": parameters, "late joiner": late_joiner,
}  # fmt: skip


def over_dds_trials(count: int, seed: int) -> tuple[str, int]:
    """Run so many trials; the page's part, and the number of violations."""
    from campaign.faults.study import table

    rows = {name: Row() for name in KINDS}
    done = 0
    while done < count:
        with tempfile.TemporaryDirectory(prefix="faults-") as folder:
            probe = Probe(Path(folder), seed + done)
            try:
                for _ in range(min(PER_PROCESS, count - done)):
                    name = list(KINDS)[done % len(KINDS)]
                    _one(probe, name, rows[name])
                    done += 1
            finally:
                probe.bench.close()
        failed = sum(sum(row.violations.values()) for row in rows.values())
        print(f"over DDS: {done}/{count} trials, {failed} violations", flush=True)
    failed = sum(sum(row.violations.values()) for row in rows.values())
    allowed = f"{1e3 * LATENESS:.0f} ms"
    text = f"""## Over DDS: {done} trials, {failed} violations

Real processes on this machine; a probe publishes a swell at 50 Hz, listens and applies the torque as a consumer has
to. A pair of messages may come {allowed} closer together than it was sent. A process that is killed has no last
word: there "to zero" is the consumer's.

{table(rows)}"""
    return text, failed


def _one(probe: Probe, name: str, row: Row) -> None:
    row.draws += 1
    begin = len(probe.torques)
    KINDS[name](probe, row)
    if not probe.alive:
        row.violations["the process ended"] += 1
        probe.start()
    before = len(probe.torques)
    probe.bench.drive(SETTLE)
    back = [torque for _, _, torque in probe.torques[before:]]
    if not back or max(map(abs, back)) == 0.0:
        row.violations["did not come back"] += 1
    if name not in ("SIGKILL and restart", "SIGINT or SIGTERM"):
        probe.judge(begin, row)
