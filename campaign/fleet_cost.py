"""What one recording costs: an hour at 50 Hz as a bag and as Parquet through `winch-friction fleet`, each verb alone.

CPU seconds (user and system), the process's peak memory and the bytes written are the operating system's own figures of
one process that does nothing else, start of the interpreter included.
"""

import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

HOUR = 3600.0  # s
RATE = 50.0  # Hz
VERBS = ("check", "replay")
FORMS = {"mcap": "bag (MCAP)", "parquet": "Parquet"}
CRANES, YEARS = 300, 5
DUTY = 200.0  # h of logged heave compensation per crane and year: an assumption, everything below is proportional to it
CORES = 16
FILES = ("--crane", "crane_150t", "--model", "a6vm215_crane2")


@dataclass(frozen=True)
class Cost:
    """One verb over one hour of recording: CPU s, peak bytes of memory, bytes of the recording and of the results."""

    verb: str
    form: str
    cpu: float
    memory: float
    recording: float
    written: float


def make_hour(folder: Path) -> dict[str, Path]:
    """One hour of heave compensation as the PLC logs it, in each form."""
    from winch_friction.records.crane_file import load_crane
    from winch_friction.records.model_file import load_model
    from winch_friction.records.runs import write_run
    from winch_friction.simulation.scenario import load_scenario
    from winch_friction.simulation.simulator import simulate

    made = {form: folder / form / f"hour.{form}" for form in FORMS}
    if not all(path.exists() for path in made.values()):
        crane, model = load_crane("crane_150t"), load_model("a6vm215_crane2")
        scenario = load_scenario("ahc_irregular").override({"duration": HOUR})
        run = simulate(scenario, crane, model, seed=1).run
        for path in made.values():
            path.parent.mkdir(parents=True, exist_ok=True)
            write_run(run, path)
    return made


def measured(folder: Path) -> list[Cost]:
    """Every verb on every form, one after the other."""
    costs = []
    for form, path in make_hour(folder).items():
        for verb in VERBS:
            out = folder / "results" / form / verb
            cpu, memory = _used(
                [sys.executable, "-m", "winch_friction", "fleet", verb, str(path), *FILES, "--out", str(out),
                 "--workers", "0", "--anew", "--json"]
            )  # fmt: skip
            costs.append(Cost(verb, form, cpu, memory, _bytes(path), _bytes(out)))
    return costs


def _used(command: list[str]) -> tuple[float, float]:
    """CPU s and peak bytes of one process and what it waited for."""
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE) as process:
        said = process.stderr.read() if process.stderr else b""
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        raise SystemExit(f"{' '.join(command)}: {said.decode()[-2000:]}")
    return usage.ru_utime + usage.ru_stime, 1024.0 * usage.ru_maxrss


def _bytes(path: Path) -> float:
    files = [path] if path.is_file() else [each for each in path.rglob("*") if each.is_file()]
    return float(sum(each.stat().st_size for each in files))


def plan(costs: list[Cost]) -> str:
    """The measured table, and the plan that follows from it."""
    rows = "\n".join(
        f"| `fleet {c.verb}` | {FORMS[c.form]} | {c.cpu:.1f} | {c.memory / 1e6:.0f} | {c.recording / 1e6:.1f} | "
        f"{c.written / 1e6:.2f} |"
        for c in costs
    )
    hours = CRANES * YEARS * DUTY
    planned = "\n".join(
        f"| `fleet {c.verb}` | {FORMS[c.form]} | {c.cpu * hours / 3600:.0f} | {c.cpu * hours / 3600 / CORES:.0f} | "
        f"{CORES * c.memory / 1e9:.1f} | {c.recording * hours / 1e12:.2f} | {c.written * hours / 1e9:.0f} |"
        for c in costs
    )
    return f"""## Cost of a recording, and a plan for {CRANES} cranes and {YEARS} years

Measured on one recording of one hour at {RATE:.0f} Hz (two motor groups, {int(HOUR * RATE)} samples), one process on
one core, start of the interpreter included:

| command | recording | CPU s | peak memory MB | recording MB | results MB |
|---|---|---|---|---|---|
{rows}

{CRANES} cranes that each log {DUTY:.0f} h of heave compensation a year (an assumption; everything is proportional
to it) give {hours:.0f} recordings of an hour in {YEARS} years. One pass over all of them, from the rows above:

| command | recording | core hours | hours on {CORES} cores | memory GB, {CORES} workers | storage TB | results GB |
|---|---|---|---|---|---|---|
{planned}

A worker holds one recording at a time, so memory grows with the number of workers and the length of a recording, not
with the fleet. What is done stands in the ledger, so a month's new recordings cost a month's share. The
{hours:.0f} recordings were not run: this is the measured cost of one, multiplied.
"""
