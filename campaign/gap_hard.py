"""The hard gap campaign: logs that are short, sparse, slow or idle, other rates, far seeds, and the file on fresh runs.

    python -m campaign.gap_hard [--quick] [--cases N] [--processes 2] [--minutes M] [--report-only]

Every finished case is one line of out/campaign_gap_hard/results.jsonl; a second call carries on where the first ended,
and a partial run gives a table that says so. The table goes to docs/campaign_gap_hard.md. Seeds start at 300000, or
where `--first-seed` says: give such a draw results of its own.
"""

import argparse
import os
import time
from pathlib import Path
from typing import Any

for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(threads, "1")

from campaign.commit import commit  # noqa: E402
from campaign.gap import finished  # noqa: E402
from campaign.gap_hard_cases import FIRST_SEED, HardCase, all_cases, runs_of  # noqa: E402
from campaign.gap_hard_report import write_table  # noqa: E402

RESULTS = Path("out/campaign_gap_hard/results.jsonl")
TABLE = Path("docs/campaign_gap_hard.md")


def diagnose(case: HardCase) -> dict[str, Any]:
    """One case: the answer of the first search, and for a proof what the written file does on fresh runs."""
    from winch_friction.discrepancy.answer import GapOptions
    from winch_friction.discrepancy.workflow import find_gap
    from winch_friction.physics.errors import InputError
    from winch_friction.records.crane_file import load_crane
    from winch_friction.records.model_file import load_model, model_from_text, model_to_text

    row: dict[str, Any] = {
        "key": case.key, "kind": case.kind, "hidden": case.effect, "flavour": case.flavour, "seed": case.seed,
        "runs": case.runs, "seconds": case.seconds, "rate": case.rate,
    }  # fmt: skip
    crane, model = load_crane("crane_150t"), load_model("a6vm215_crane2")
    started = time.perf_counter()
    try:
        result = find_gap(runs_of(case), crane, model, GapOptions(plan=False))
        row |= {f"first_{key}": value for key, value in _told(result.content()).items()}
        if case.kind == "proof":
            repaired = model_from_text(model_to_text(result.model))
            again = find_gap(runs_of(case, fresh=True), crane, repaired, GapOptions(plan=False))
            row |= {f"again_{key}": value for key, value in _told(again.content()).items()}
    except InputError as error:
        row["refused"] = str(error)
    except Exception as error:
        row["error"] = f"{type(error).__name__}: {error}"
    return row | {"took": time.perf_counter() - started}


def _told(content: dict[str, Any]) -> dict[str, Any]:
    held = content["gap"]["holdout"]
    return {
        "verdict": content["verdict"],
        "sets": [sorted({e["name"], *e["indistinguishable_from"]}) for e in content["effects"]],
        "where": [e["evidence"]["where"] for e in content["effects"]],
        "before": held["before"], "after": held["after"], "floor": held["noise_floor"],
        "before_low": (held["before_ci"] or [None])[0], "reason": content["unexplained"]["reason"],
    }  # fmt: skip


def main() -> None:
    """Read the command line, run, write the table."""
    import json
    import multiprocessing

    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--quick", action="store_true", help="a third of the standard count")
    parser.add_argument("--cases", type=int, help="stop after so many cases, of all kinds in turn")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--minutes", type=float, default=float("inf"), help="stop after that long; the table says so")
    parser.add_argument("--first-seed", type=int, default=FIRST_SEED)
    parser.add_argument("--only", help="cases whose key contains this")
    parser.add_argument("--results", type=Path, default=RESULTS)
    parser.add_argument("--table", type=Path, default=TABLE)
    parser.add_argument("--report-only", action="store_true")
    chosen = parser.parse_args()
    cases = all_cases(chosen.quick, chosen.first_seed)
    cases = [case for case in cases if not chosen.only or chosen.only in case.key]
    cases = cases[: chosen.cases]
    chosen.results.parent.mkdir(parents=True, exist_ok=True)
    if not chosen.report_only:
        done, until = finished(chosen.results), time.time() + 60 * chosen.minutes
        waiting = [case for case in cases if case.key not in done]
        measured = commit()
        with chosen.results.open("a") as out, multiprocessing.get_context("spawn").Pool(chosen.processes) as pool:
            for k, row in enumerate(pool.imap(diagnose, waiting)):
                out.write(json.dumps(row | {"commit": measured}) + "\n")
                out.flush()
                print(f"{k + 1}/{len(waiting)} {row['key']}: {row.get('error', row.get('first_verdict'))}", flush=True)
                if time.time() > until:
                    pool.terminate()
                    break
    write_table(chosen.table, list(finished(chosen.results).values()), len(all_cases(quick=False)))


if __name__ == "__main__":
    main()
