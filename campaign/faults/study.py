"""The fault campaign (`make campaign-faults`): faults at random against the services, and over DDS against the nodes.

    python -m campaign.faults [--draws 100000] [--trials 300] [--processes 2] [--seed 0] [--out docs/campaign_faults.md]

In process: voyages of clean data with one fault after the other, and people and nodes that meddle, through the very
services that the nodes run; every published torque is checked. Over DDS (`--trials`): real processes that are killed,
stopped and restarted, with second publishers, late joiners and lossy links.
"""

import argparse
import multiprocessing
import os
import time
from collections import Counter
from collections.abc import Mapping
from functools import partial
from pathlib import Path

for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(threads, "1")  # before numpy: one process per core

from campaign.commit import commit  # noqa: E402
from campaign.faults.trial import Trial  # noqa: E402
from campaign.faults.voyages import SCENARIOS, voyage  # noqa: E402
from campaign.faults.watch import LONGEST_AGAINST, Row  # noqa: E402

SECONDS = 120.0  # of a trial
SEAS = 4  # voyages of each scenario
LEARNING = 8  # every so many trials the estimator takes part
OUT = Path("docs/campaign_faults.md")


def one_trial(k: int, seed: int) -> tuple[dict[str, Row], int, list[str]]:
    """One trial; an exception is a violation like any other."""
    sailing = voyage(SCENARIOS[k % len(SCENARIOS)], 1000 + (k // len(SCENARIOS)) % SEAS)
    trial = Trial(sailing, seed + k, learn=k % LEARNING == 0)
    try:
        trial.run(SECONDS)
    except Exception as error:
        trial.row.violations[f"raised {type(error).__name__}"] += 1
        trial.notes.append(f"trial {seed + k}: {type(error).__name__}: {error}")
    return dict(trial.rows), trial.draws, trial.notes


def merge(total: dict[str, Row], part: Mapping[str, Row]) -> None:
    """Add the rows of one trial."""
    for kind, row in part.items():
        own = total.setdefault(kind, Row())
        own.draws += row.draws
        own.unsafe += row.unsafe
        own.said_active += row.said_active
        own.violations += row.violations
        for name in ("largest", "steepest", "to_zero", "against"):
            setattr(own, name, max(getattr(own, name), getattr(row, name)))


def in_process(draws: int, processes: int, seed: int) -> tuple[dict[str, Row], int, list[str]]:
    """Trials until there were so many draws."""
    total: dict[str, Row] = {}
    done, notes, began = 0, [], time.monotonic()
    with multiprocessing.get_context("spawn").Pool(processes) as pool:
        for k, (rows, drawn, said) in enumerate(pool.imap_unordered(partial(one_trial, seed=seed), range(10**6))):
            merge(total, rows)
            done += drawn
            notes += said
            if k % 20 == 19:
                wrong = sum(sum(row.violations.values()) for row in total.values())
                print(f"{done}/{draws} draws, {wrong} violations, {time.monotonic() - began:.0f} s", flush=True)
            if done >= draws:
                pool.terminate()
                break
    return total, done, notes


def table(rows: Mapping[str, Row]) -> str:
    """One line a kind."""
    head = (
        "| fault | draws | largest N m | steepest, of the slew limit | longest to zero s | longest against the motion "
        "s | violations |\n|---|---|---|---|---|---|---|\n"
    )
    lines = []
    for kind, row in sorted(rows.items()):
        wrong = "; ".join(f"{name} {count}" for name, count in row.violations.items()) or "0"
        lines.append(
            f"| {kind} | {row.draws} | {row.largest:.0f} | {row.steepest:.2f} | {row.to_zero:.2f} | {row.against:.2f} "
            f"| {wrong} |"
        )
    return head + "\n".join(lines)


def page(rows: Mapping[str, Row], draws: int, options: argparse.Namespace, over_dds: str) -> str:
    """The campaign's page."""
    wrong: Counter[str] = Counter()
    for row in rows.values():
        wrong += row.violations
    return f"""# Faults beside a machine: the campaign

* Command: `make campaign-faults` (`python -m campaign.faults --draws {options.draws} --trials {options.trials} --seed
  {options.seed}`)
* Commit: {commit()}

## In process: {draws} draws, {sum(wrong.values())} violations

Voyages of five scenarios (regular, irregular, calming and swell seas, harsh sensors) through `CompensatorService`,
every {LEARNING}th with `EstimatorService` learning beside it, at 50 Hz with jitter; one fault after the other, a
quarter of them two at once, while somebody resets, disables, reconfigures, swaps models (good, far off, hostile) and
deactivates. Ramp time 0.5 s, age limit 0.1 s. A draw is one fault.

Checked at every published torque: finite; within the absolute limit and 1.3 times the seed's friction at the worst
corner of what the crane's channels can show; no faster than the slew limit, resets and the end included; zero within
age limit, ramp and detection once a needed input is gone, frozen or impossible; diagnostics no longer `active` a second
after that; against the motion no longer than the look-ahead and {LONGEST_AGAINST:.2f} s, except where nothing that
arrives shows the motion (delayed, reordered, clock set, different clocks, speed and command wrong at once, and what is
left of these afterwards: timed in the table, no violation); a refused sample leaves the estimator as it was; its
covariance stays positive; nothing raised.

{table(rows)}

{over_dds}
"""


def main() -> int:
    """Run the campaign and write its page; 1 with any violation."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--draws", type=int, default=100_000)
    parser.add_argument("--trials", type=int, default=300, help="over DDS; 0: none")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, default=OUT)
    options = parser.parse_args()
    rows, draws, notes = in_process(options.draws, options.processes, options.seed)
    for note in notes[:50]:
        print(note)
    over_dds, failed = "", 0
    if options.trials:
        from campaign.faults.dds import over_dds_trials

        over_dds, failed = over_dds_trials(options.trials, options.seed)
    options.out.write_text(page(rows, draws, options, over_dds))
    wrong = sum(sum(row.violations.values()) for row in rows.values())
    print(f"{draws} draws: {wrong} violations; over DDS {failed}; {options.out}")
    return 0 if wrong + failed == 0 else 1
