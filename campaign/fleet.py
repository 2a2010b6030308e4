"""The fleet campaign (`make campaign-fleet`): a simulated fleet over two years, and what the fleet view finds in it.

    python -m campaign.fleet [--cranes 40] [--months 24] [--seconds 60] [--verb check] [--seed 0] [--folder out/fleet]

Every crane has its own friction, its own slow wear, and every month its own load and sea. Some cranes get new seals in
one month (Coulomb friction changes at once), some a new transducer (its zero changes), half of them nothing.
`winch-friction fleet` then goes over all recordings, and its steps are compared with the truth. What one hour of
recording costs is measured beside it, for the plan of a larger fleet.
"""

import argparse
import json
import multiprocessing
import os
import shutil
import subprocess
import sys
import time
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(threads, "1")  # before numpy: one process per core, not several threads in each

import numpy as np  # noqa: E402

from campaign.commit import commit  # noqa: E402
from campaign.fleet_cost import Cost, measured, plan  # noqa: E402
from winch_friction.fleet.drift import month_of, month_text  # noqa: E402

MONTH = 30.44 * 86400.0  # s
START = 1_704_884_400.0  # 10 January 2024, Unix s
SEALS, TRANSDUCER, NOTHING = "seals", "transducer", "nothing"
COULOMB = ("C6", "K3", "K4")  # what seals and bearings carry: load-proportional and constant friction
OUT = Path("docs/campaign_fleet.md")
BARS = (0.9, 0.02)  # dates found within a month; false steps per crane
EDGE = 3  # months at either end without a change: there a step and noise are the same


@dataclass(frozen=True)
class Life:
    """What happens to one crane: its own friction and wear, and one event."""

    name: str
    friction: float  # of the seed's Coulomb parameters
    wear: float  # per year
    event: str
    month: int
    size: float  # share of the Coulomb friction, or bar


def draw_lives(cranes: int, months: int, seed: int) -> list[Life]:
    """The fleet's truth."""
    rng = np.random.default_rng(seed)
    lives = []
    for k in range(cranes):
        event = (SEALS, TRANSDUCER, NOTHING, NOTHING)[k % 4]
        sign = float(rng.choice((-1.0, 1.0)))
        size = sign * rng.uniform(0.15, 0.30) if event == SEALS else sign * rng.uniform(1.0, 2.0)
        own = float(np.clip(rng.normal(1.0, 0.05), 0.85, 1.15))
        month = int(rng.integers(EDGE, months - EDGE))
        lives.append(Life(f"crane_{k:03d}", own, float(rng.uniform(-0.03, 0.08)), event, month, size))
    return lives


def record(life: Life, month: int, seconds: float, seed: int, folder: Path) -> None:
    """One recording of one month."""
    from winch_friction.records.crane_file import load_crane
    from winch_friction.records.model_file import load_model
    from winch_friction.records.runs import write_run
    from winch_friction.simulation.scenario import load_scenario
    from winch_friction.simulation.simulator import simulate

    path = folder / life.name / f"month_{month:02d}.parquet"
    if path.exists():
        return
    rng = np.random.default_rng([seed, int(life.name[-3:]), month])
    crane, model = load_crane("crane_150t"), load_model("a6vm215_crane2")
    after = month >= life.month
    factor = life.friction + life.wear * month / 12.0
    factor += life.size if after and life.event == SEALS else 0.0
    values = {name: factor * model.value(name) for name in COULOMB if name in model.parameter_names}
    offset = life.size if after and life.event == TRANSDUCER else 0.0
    load = float(rng.uniform(15.0, 90.0))
    scenario = load_scenario("ahc_irregular").override(
        {"duration": seconds, "load": {"value": load, "unit": "t"},
         "sea": {"kind": "jonswap", "significant_height": float(rng.uniform(1.0, 2.5)),
                 "peak_period": float(rng.uniform(7.0, 12.0))}}
    )  # fmt: skip
    hidden = [("pressure_offset", offset / 1.5)] if offset else []
    run = simulate(scenario, crane, model.with_values(values), int(rng.integers(2**31)), hidden).run
    dated = {**run.columns, "time": run.time - run.time[0] + START + month * MONTH}
    path.parent.mkdir(parents=True, exist_ok=True)
    write_run(type(run)(path.stem, dated), path)


def _record(item: tuple[Life, int], seconds: float, seed: int, folder: Path) -> None:
    record(*item, seconds, seed, folder)


def make_fleet(lives: list[Life], months: int, seconds: float, seed: int, folder: Path, processes: int) -> None:
    """All recordings."""
    items = [(life, month) for life in lives for month in range(months)]
    work = partial(_record, seconds=seconds, seed=seed, folder=folder)
    with multiprocessing.get_context("spawn").Pool(processes) as pool:
        for k, _ in enumerate(pool.imap_unordered(work, items, chunksize=8)):
            if k % 48 == 47:
                print(f"{k + 1}/{len(items)} recordings", flush=True)


def look(folder: Path, out: Path, verb: str, workers: int) -> tuple[dict[str, Any], float]:
    """`winch-friction fleet` over the folder: what it wrote, and the s that it took."""
    files = ["--crane", "crane_150t", "--model", "a6vm215_crane2", "--out", str(out), "--workers", str(workers)]
    command = [sys.executable, "-m", "winch_friction", "fleet", verb, str(folder), *files, "--json"]
    began = time.monotonic()
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if not (out / "fleet.json").exists():
        raise SystemExit(done.stderr[-2000:])
    return json.loads((out / "fleet.json").read_text()), time.monotonic() - began


@dataclass(frozen=True)
class Score:
    """Events found within a month, events, false steps, and cranes."""

    found: int
    events: int
    false: int
    cranes: int
    rows: tuple[tuple[str, str, str, str], ...]


def score(lives: list[Life], steps: list[dict[str, Any]]) -> Score:
    """The steps beside the truth; a step that is no event's, within a month, is false."""
    found, rows, true_steps = 0, [], 0
    for life in lives:
        own = [step for step in steps if step["crane"] == life.name]
        when = month_of(START + life.month * MONTH)
        dates = [int(step["month"][:4]) * 12 + int(step["month"][5:]) - 1 for step in own]
        hits = [date for date in dates if life.event != NOTHING and abs(date - when) <= 1]
        found += bool(hits)
        true_steps += len(hits)
        truth = "-" if life.event == NOTHING else f"{life.event} {month_text(when)} ({life.size:+.2f})"
        said = ", ".join(f"{step['trait']} {step['month']} ({step['size']:+.1f} {step['unit']})" for step in own) or "-"
        right = "yes" if (bool(hits) or life.event == NOTHING) and len(hits) == len(own) else "**no**"
        rows.append((life.name, truth, said, right))
    events = sum(life.event != NOTHING for life in lives)
    return Score(found, events, len(steps) - true_steps, len(lives), tuple(rows))


def page(result: Score, options: argparse.Namespace, looked: float, costs: list[Cost]) -> str:
    """The campaign's page."""
    recordings = options.cranes * options.months
    rows = "\n".join("| " + " | ".join(row) + " |" for row in result.rows)
    call = f"--cranes {options.cranes} --months {options.months} --seconds {options.seconds:g} --seed {options.seed}"
    return f"""# A fleet over two years: which crane changed, and when

* Command: `make campaign-fleet` (`python -m campaign.fleet {call} --verb {options.verb}`)
* Commit: {commit()}
* {recordings} recordings of {options.seconds:g} s at 50 Hz, each with its own load (15 to 90 t) and sea; friction of
  each crane within 5 % of the model (one sigma), wear of -3 to 8 % a year. New seals change the Coulomb
  friction by 15 to 30 %, a new transducer the zero by 1 to 2 bar.

| what | bar | measured |
|---|---|---|
| changes dated within a month | >= {100 * BARS[0]:.0f} % | {result.found} of {result.events} |
| false steps | <= {100 * BARS[1]:.0f} % of the cranes | {result.false} of {result.cranes} |

| crane | what happened | what the fleet view says | right |
|---|---|---|---|
{rows}

{recordings} recordings were gone through in {looked:.0f} s with {options.processes} worker(s), on a machine that did
other work besides.

{plan(costs)}"""


def main() -> int:
    """Run the study and write its page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cranes", type=int, default=40)
    parser.add_argument("--months", type=int, default=24)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--verb", default="check")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--folder", type=Path, default=Path("out/campaign_fleet"))
    parser.add_argument("--out", type=Path, default=OUT)
    options = parser.parse_args()
    lives = draw_lives(options.cranes, options.months, options.seed)
    bags = options.folder / f"bags_{options.cranes}_{options.months}_{options.seconds:g}_{options.seed}"
    make_fleet(lives, options.months, options.seconds, options.seed, bags, options.processes)
    (options.folder / "truth.json").write_text(json.dumps([asdict(life) for life in lives], indent=1))
    shutil.rmtree(options.folder / "view", ignore_errors=True)
    content, looked = look(bags, options.folder / "view", options.verb, options.processes)
    result = score(lives, content["steps"])
    options.out.write_text(page(result, options, looked, measured(options.folder / "hour")))
    print(f"{result.found} of {result.events} changes dated within a month, {result.false} false; {options.out}")
    return 0 if result.found >= BARS[0] * result.events and result.false <= BARS[1] * result.cranes else 1


if __name__ == "__main__":
    sys.exit(main())
