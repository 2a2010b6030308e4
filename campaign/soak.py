"""The soak campaign (`make campaign-soak`): a long time, many kills, foreign files, and data that teach wrong things.

    python -m campaign.soak [--hours 24] [--kills 500] [--files 400] [--minutes 30] [--out docs/campaign_soak.md]

`--hours` of simulated time through both services in this process; `--minutes` of real time with three processes over
DDS (0: none). `--kills` of a process that writes checkpoints and tables, at random moments. `--files` files that the
command line is given after random damage. Then sensors that drift and stick while the estimator learns.
"""

import argparse
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Any

for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(threads, "1")

from campaign.commit import commit  # noqa: E402
from campaign.faults.voyages import voyage  # noqa: E402
from campaign.teachers import lessons, table  # noqa: E402
from winch_friction.records.domain import unused_domain  # noqa: E402

OUT = Path("docs/campaign_soak.md")
MOST_GROWTH = 5.0  # MB
WARM = 0.05  # of the time, in which caches fill
LONGEST_ANSWER = 2.0  # s to a damaged file, without starting Python
ORIGIN = 1.7e9  # s


def resident(pid: int | str = "self") -> float:
    """Resident memory of a process, MB."""
    for line in Path(f"/proc/{pid}/status").read_text().splitlines():
        if line.startswith("VmRSS"):
            return float(line.split()[1]) / 1024.0
    return float("nan")


def long_time(hours: float) -> dict[str, Any]:
    """Both services over simulated time: growth of memory after the warm-up, largest torque, steps per second."""
    from winch_friction.online.compensator import CompensatorService
    from winch_friction.online.estimator import EstimatorService

    sea = voyage("ahc_irregular", 1)
    compensator = CompensatorService(sea.crane, sea.model, sea.topics)
    estimator = EstimatorService(sea.crane, sea.model, sea.topics)
    steps = int(hours * 3600.0 * 50.0)
    began, warm, largest, published = time.monotonic(), float("nan"), 0.0, 0
    for k in range(steps):
        sample = sea.samples[k % len(sea.samples)]
        now = ORIGIN + 0.02 * k
        fed = replace(sample, time=now, groups={n: replace(g) for n, g in sample.groups.items()})
        said = compensator.take_row(fed, now)
        learned = replace(sample, time=now, groups={n: replace(g) for n, g in sample.groups.items()})
        estimator.take_row(learned, now)
        model = estimator.model_due(now)
        if model is not None:
            published += 1
            compensator.offer(model)
        largest = max(largest, abs(said.friction_torque))
        if k == int(WARM * steps):
            warm = resident()
    return {
        "steps": steps, "growth": resident() - warm, "largest": largest, "models": published,
        "seconds": time.monotonic() - began, "refused": len(compensator.refused_models),
    }  # fmt: skip


def kills(count: int, seed: int) -> Counter[str]:
    """Children that write are killed at random moments; afterwards every file must be whole and alone."""
    from winch_friction.physics.errors import InputError
    from winch_friction.records.atomic import write_text
    from winch_friction.records.checkpoint import read_checkpoint, write_checkpoint

    rng, found = random.Random(seed), Counter[str]()
    with tempfile.TemporaryDirectory(prefix="kills-") as folder:
        checkpoint, table = Path(folder) / "ck.json", Path(folder) / "model.yaml"
        for k in range(count):
            child = os.fork()
            if child == 0:
                n = 0
                while True:
                    n += 1
                    write_checkpoint(checkpoint, {"n": n, "state": [float(n)] * 300})
                    write_text(table, "".join(f"{n}\n" for _ in range(400)))
            time.sleep(rng.uniform(0.0, 0.02))
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)
            try:
                content = read_checkpoint(checkpoint)
                found["whole checkpoints"] += content is None or content["state"] == [float(content["n"])] * 300
            except InputError:
                found["damaged checkpoints"] += 1
            lines = set(table.read_text().split()) if table.exists() else set()
            found["damaged tables"] += len(lines) > 1
            if k == count - 1:
                write_text(table, "last")
                read_checkpoint(checkpoint)
        left = [each.name for each in Path(folder).iterdir() if each.name not in ("ck.json", "model.yaml")]
        found["litter"] += len(left)
    return found


def damaged_files(count: int, seed: int) -> tuple[Counter[str], float, list[str]]:
    """Files with random damage through the command line, in this process: exit status, the slowest answer, defects."""
    import contextlib
    import io

    from winch_friction.cli.main import run
    from winch_friction.records.runs import write_run
    from winch_friction.records.strict_yaml import config_directory
    from winch_friction.simulation.scenario import load_scenario
    from winch_friction.simulation.simulator import simulate

    rng, found, slowest, defects = random.Random(seed), Counter[str](), 0.0, []
    sea = voyage("ahc_irregular", 1)
    log = simulate(load_scenario("ahc_irregular").override({"duration": 6.0}), sea.crane, sea.model, seed=3).run
    with tempfile.TemporaryDirectory(prefix="damaged-") as name:
        folder = Path(name)
        sources = {
            "csv": write_run(log, folder / "log.csv"), "parquet": write_run(log, folder / "log.parquet"),
            "mcap": next((write_run(log, folder / "log.mcap")).rglob("*.mcap"), folder / "log.mcap"),
            "model": config_directory() / "models" / "a6vm215_crane2.yaml",
            "crane": config_directory() / "cranes" / "crane_150t.yaml",
            "scenario": config_directory() / "scenarios" / "ahc_irregular.yaml",
        }  # fmt: skip
        for k in range(count):
            kind = list(sources)[k % len(sources)]
            spoilt = folder / f"spoilt_{k}{sources[kind].suffix}"
            spoilt.write_bytes(damaged(sources[kind].read_bytes(), rng))
            files = {"run": str(sources["csv"]), "crane": "crane_150t", "model": "a6vm215_crane2"}
            files["run" if kind in ("csv", "parquet", "mcap") else kind] = str(spoilt)
            call = ["replay", files["run"], "--crane", files["crane"], "--model", files["model"], "--json"]
            if kind == "scenario":
                call = ["simulate", str(spoilt), "--crane", "crane_150t", "--out", str(folder / f"out_{k}"), "--json"]
            began, complained = time.monotonic(), io.StringIO()
            with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(complained):
                status = run(call)
            took = time.monotonic() - began
            spoilt.unlink()
            found[f"exit {status}"] += 1
            lines = [line for line in complained.getvalue().splitlines() if not line.startswith("warning")]
            if status == 2:
                slowest = max(slowest, took)
            if status not in (0, 2) or "Traceback" in complained.getvalue():
                defects.append(f"{kind} {k}: {' '.join(lines)[:200]}")
    return found, slowest, defects


def damaged(content: bytes, rng: random.Random) -> bytes:
    """Bytes flipped, cut, doubled, or replaced by something absurd."""
    data = bytearray(content)
    for _ in range(rng.randint(1, 6)):
        at = rng.randrange(len(data))
        way = rng.randrange(6)
        if way == 0:
            data[at] = rng.randrange(256)
        elif way == 1:
            del data[at : at + rng.randint(1, 400)]
        elif way == 2:
            data[at:at] = data[at : at + rng.randint(1, 400)]
        elif way == 3:
            data[at:at] = rng.choice(
                (b"1e308", b"nan", b"\x00", b"&a [*a, *a]", b"!!python/object:os.system ", b"- " * 900)
            )
        elif way == 4:
            data = data[: max(at, 1)]
        else:
            data[at:at] = b"[" * 3000
        if not data:
            data = bytearray(b"\n")
    return bytes(data)


def over_dds(minutes: float) -> list[tuple[str, float]]:
    """Growth in MB of the three processes over real time, after the first twentieth."""
    environment = {
        **os.environ,
        "ROS_DOMAIN_ID": str(unused_domain()),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
    }
    names = ("simulator", "compensator", "estimator")
    config = str(Path("config/nodes/ahc_simulation.yaml").resolve())
    processes = {
        name: subprocess.Popen(
            [sys.executable, "-m", f"winch_friction.nodes.{name}", "--ros-args", "--params-file", config],
            env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )
        for name in names
    }  # fmt: skip
    try:
        time.sleep(max(60.0 * minutes * WARM, 20.0))
        before = {name: resident(process.pid) for name, process in processes.items()}
        end = time.monotonic() + 60.0 * minutes
        while time.monotonic() < end:
            time.sleep(min(10.0, max(end - time.monotonic(), 0.0)))
            ended = [name for name, process in processes.items() if process.poll() is not None]
            if ended:
                raise SystemExit(f"{ended[0]} ended by itself")
        return [(name, resident(process.pid) - before[name]) for name, process in processes.items()]
    finally:
        for process in processes.values():
            process.send_signal(signal.SIGINT)
        for process in processes.values():
            try:
                process.wait(10.0)
            except subprocess.TimeoutExpired:
                process.kill()


def page(hours: float, soak: dict[str, Any], killed: Counter[str], kill_count: int, files: Any, taught: Any,
         dds: list[tuple[str, float]], minutes: float, call: str) -> str:  # fmt: skip
    """The campaign's page."""
    found, slowest, defects = files
    statuses = ", ".join(f"{name}: {count}" for name, count in sorted(found.items()))
    grown = "\n".join(f"| {name} | {growth:+.1f} |" for name, growth in dds) or "| not run | |"
    return f"""# Soak, kills, foreign files, wrong teachers

* Command: `make campaign-soak` (`python -m campaign.soak {call}`)
* Commit: {commit()}

## {hours:g} h of simulated time through both services
{soak["steps"]} steps of 20 ms in {soak["seconds"]:.0f} s; memory grew by {soak["growth"]:+.2f} MB after the first
twentieth (bar: below {MOST_GROWTH:g} MB); {soak["models"]} models published and taken over, {soak["refused"]} refused;
largest torque {soak["largest"]:.0f} N m.

## {minutes:g} min over DDS in real time, three processes
| process | growth, MB |
|---|---|
{grown}

## {kill_count} kills of a process that writes
Whole checkpoints {killed["whole checkpoints"]}, damaged {killed["damaged checkpoints"]}, damaged tables
{killed["damaged tables"]}, files left over after the next start {killed["litter"]}.

## {sum(found.values())} damaged files through the command line
{statuses}; slowest refusal {slowest:.2f} s (bar {LONGEST_ANSWER:g} s); defects {len(defects)}.
{chr(10).join("* " + each for each in defects[:10])}

## Wrong teachers
Ten minutes of learning from a sensor that is wrong, from another crane, or from friction far outside the seed's
range, by `EstimatorService`, while a compensator takes over what was learned and another one stays with the seed
(scale 1). Drifts reach the size that the name says after ten minutes. Afterwards `~/reset`, and the seed loaded.

{table(taught)}
"""


def main() -> int:
    """Run the campaign and write its page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--hours", type=float, default=24.0)
    parser.add_argument("--kills", type=int, default=500)
    parser.add_argument("--files", type=int, default=400)
    parser.add_argument("--minutes", type=float, default=30.0)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, default=OUT)
    options = parser.parse_args()
    killed = kills(options.kills, options.seed)
    print(dict(killed), flush=True)
    files = damaged_files(options.files, options.seed)
    print(dict(files[0]), f"{files[1]:.2f} s", *files[2], sep="\n", flush=True)
    taught = lessons()
    print(*taught, sep="\n", flush=True)
    soak = long_time(options.hours)
    print(soak, flush=True)
    dds = over_dds(options.minutes) if options.minutes else []
    call = f"--hours {options.hours:g} --kills {options.kills} --files {options.files} --minutes {options.minutes:g}"
    text = page(options.hours, soak, killed, options.kills, files, taught, dds, options.minutes, call)
    options.out.write_text(text)
    wrong = killed["damaged checkpoints"] + killed["damaged tables"] + killed["litter"] + len(files[2])
    grown = max([soak["growth"], *(growth for _, growth in dds)])
    print(f"{wrong} defects, growth {grown:+.1f} MB; {options.out}")
    return 0 if wrong == 0 and grown < MOST_GROWTH else 1


if __name__ == "__main__":
    sys.exit(main())
