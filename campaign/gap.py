"""The gap campaign: false alarms, detection and naming on data from a plant that shares nothing with the package.

    python -m campaign.gap [--quick] [--processes 2] [--report-only]

Every finished case is one line of out/campaign_gap/results.jsonl; a second call carries on where the first ended. The
table goes to docs/campaign_gap.md. Seeds start at 100000; development used seeds below 1000.
"""

import argparse
import contextlib
import json
import multiprocessing
import os
import resource
import tempfile
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(threads, "1")  # before numpy: one process per core, not several threads in each

import numpy as np  # noqa: E402

from campaign.commit import commit  # noqa: E402
from campaign.gap_cases import QUICK, Case, Counts, all_cases  # noqa: E402
from campaign.gap_report import write_table  # noqa: E402
from campaign.gap_score import score  # noqa: E402
from campaign.gap_small import beyond_prior, counted  # noqa: E402
from campaign.rig import DRAWN, make_dataset, world_of, write_world  # noqa: E402

FIRST_SEED = 100_000
RESULTS = Path("out/campaign_gap/results.jsonl")
TABLE = Path("docs/campaign_gap.md")


def diagnose(case: Case, cells: float = 0.0) -> dict[str, Any]:
    """Generate one data set, run the workflow on it, judge its answer; the load cell of each run is off by another
    amount, `cells` % of the load (standard deviation).
    """
    from winch_friction.discrepancy.answer import GapOptions
    from winch_friction.discrepancy.workflow import find_gap
    from winch_friction.physics.signals import Run

    data = make_dataset(case.seed, case.flavour, case.effects, sigma=case.sigma)
    crane, model = owner_files(case)
    runs = [Run(f"run_{k + 1:02d}", columns) for k, columns in enumerate(weighed(data, cells, case.seed))]
    started = time.perf_counter()
    result = find_gap(runs, crane, model, GapOptions(plan=False))
    seconds = time.perf_counter() - started
    answer = json.loads(json.dumps(result.content()))
    judged = score(case, answer)
    megabytes = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    if counted(case.kind, case.effects):
        judged["beyond"] = beyond_prior(case, judged["floor"])
    return {
        "key": case.key,
        "kind": case.kind,
        "effects": case.effects,
        "flavour": case.flavour,
        "seed": case.seed,
        "seconds": seconds,
        "megabytes": megabytes,
        "answer": answer,
    } | judged


def weighed(data: Sequence[Mapping[str, Any]], cells: float, seed: int) -> list[Mapping[str, Any]]:
    """Runs by their columns, with load cells that are off by another amount in each, `cells` % of the load."""
    off = 0.01 * cells * np.random.default_rng(seed + 1).standard_normal(len(data))
    return [
        {**run, "hook_load": run["hook_load"] * (1.0 + share)} if "hook_load" in run else run
        for run, share in zip(data, off, strict=True)
    ]


def owner_files(case: Case) -> tuple[Any, Any]:
    """Crane and seed model of a data set, as its owner's files describe them."""
    from winch_friction.records.crane_file import load_crane
    from winch_friction.records.model_file import load_model

    if case.flavour != DRAWN:
        return load_crane("crane_150t"), load_model("a6vm215_crane2")
    with tempfile.TemporaryDirectory() as folder:
        crane, model = write_world(Path(folder), world_of(case.seed, case.flavour))
        return load_crane(str(crane)), load_model(str(model))


def diagnose_or_say(case: Case, cells: float = 0.0) -> dict[str, Any]:
    """As `diagnose`; a defect becomes a result of its own, counted against every bar."""
    try:
        return diagnose(case, cells)
    except Exception as error:
        return {
            "key": case.key,
            "kind": case.kind,
            "effects": case.effects,
            "flavour": case.flavour,
            "seed": case.seed,
            "error": f"{type(error).__name__}: {error}",
        }


def rows_of(path: Path) -> Iterator[dict[str, Any]]:
    """Results, one a line, as they were written; a line cut off by an interruption is dropped."""
    for line in path.read_text().splitlines() if path.is_file() else []:
        with contextlib.suppress(json.JSONDecodeError):
            yield json.loads(line)


def finished(path: Path) -> dict[str, dict[str, Any]]:
    """Results by case."""
    return {row["key"]: row for row in rows_of(path)}


def run(cases: Iterable[Case], processes: int, path: Path, until: float = float("inf"), cells: float = 0.0) -> None:
    """Work through the cases that have no result yet; stop handing out at the Unix time `until`. `cells` % that load
    cells are off by from run to run."""
    done = finished(path)
    waiting = [case for case in cases if case.key not in done]
    path.parent.mkdir(parents=True, exist_ok=True)
    measured = commit()
    with path.open("a") as out, multiprocessing.get_context("spawn").Pool(processes) as pool:
        for k, row in enumerate(pool.imap(partial(diagnose_or_say, cells=cells), waiting)):
            out.write(json.dumps(row | {"commit": measured}) + "\n")
            out.flush()
            print(f"{k + 1}/{len(waiting)} {row['key']}: {row.get('error', row.get('verdict'))}", flush=True)
            if time.time() > until:
                pool.terminate()
                return


def main() -> None:
    """Read the command line, run, write the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--quick", action="store_true", help="a smoke version: every effect once, two nulls")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--first-seed", type=int, default=FIRST_SEED)
    parser.add_argument("--results", type=Path)
    parser.add_argument("--table", type=Path)
    parser.add_argument("--minutes", type=float, default=float("inf"), help="stop after that long; the table says so")
    parser.add_argument("--report-only", action="store_true", help="write the table from the results there are")
    parser.add_argument("--note", default="", help="a line for the head of the table")
    parser.add_argument("--only", help="cases whose key contains this")
    parser.add_argument("--cells", type=float, default=0.0, help="%% of the load by which the cell of each run is off")
    for name, value in vars(Counts()).items():
        parser.add_argument(f"--{name.replace('_', '-')}", type=int, default=None, help=f"full campaign: {value}")
    chosen = parser.parse_args()
    quick = chosen.quick
    results = chosen.results or (RESULTS.with_name("quick.jsonl") if quick else RESULTS)
    table = chosen.table or (results.with_suffix(".md") if quick else TABLE)
    given = {name: getattr(chosen, name) for name in vars(Counts()) if getattr(chosen, name) is not None}
    counts = Counts(**(vars(QUICK if quick else Counts()) | given))
    cases = [case for case in all_cases(counts, chosen.first_seed) if not chosen.only or chosen.only in case.key]
    if not chosen.report_only:
        run(cases, chosen.processes, results, time.time() + 60 * chosen.minutes, chosen.cells)
    write_table(table, list(finished(results).values()), counts, chosen.note)


if __name__ == "__main__":
    main()
