"""The campaign on a third independent winch, through the command line alone.

    python -m campaign.third [--only KEY] [--minutes M] [--processes 1] [--draw 8] [--report-only]
                             [--results PATH] [--table PATH]

Every data set of `campaign/third_rig` is written as CSV files with a crane and a model file into a temporary folder,
`winch-friction gap` runs on it as a process of its own, and its gap.json is judged; where it named or proposed
something the runs that came after are searched with the model it wrote. Every finished case is one line of
out/campaign_third/results.jsonl; a second call carries on where the first ended, and a partial run gives a table that
says so. The table goes to docs/campaign_third.md. Draws 0 to 6 and two thirds of draw 7 were seen in development.
"""

import os
import subprocess
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(threads, "1")

from campaign.gap import finished  # noqa: E402
from campaign.second import arguments, gap, run  # noqa: E402
from campaign.third_report import write_table  # noqa: E402
from campaign.third_rig import SETS, Set, Truth, write_set  # noqa: E402
from campaign.third_rig.sets import NULL, OUTSIDE, PAIR  # noqa: E402

RESULTS = Path("out/campaign_third/results.jsonl")
TABLE = Path("docs/campaign_third.md")
FIRST_DRAW = 8
LARGEST_SET = 3

Row = dict[str, Any]


def diagnose(chosen: Set, draw: int) -> Row:
    """Write one data set, search it, search its fresh runs with the model that was written; judged."""
    row: Row = {"key": f"{chosen.key}/{draw}", "set": chosen.key, "kind": chosen.kind, "draw": draw}
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        try:
            row |= drawn(write_set(folder, chosen, draw))
        except ValueError as error:
            return row | {"outcome": "not drawn", "error": str(error)}
        started = time.perf_counter()
        try:
            answer = gap(folder, "out")
        except (RuntimeError, subprocess.TimeoutExpired) as error:
            return row | failed(error)
        row |= judged(chosen, answer)
        row["seconds"] = time.perf_counter() - started
        return row | again(folder, answer)


def drawn(truth: Truth) -> Row:
    """What of the truth a table tells; traces in floors of the balance."""
    options, sized = truth.plan.options, truth.sized
    return {
        "rate": options.rate, "runs": len(truth.runs), "modes": options.modes, "elastic": options.elastic,
        "sizes": [each.size for each in sized], "traces": [each.trace for each in sized],
        "beyond": [each.beyond for each in sized], "tightening": truth.tightening, "expected_floor": truth.floor,
    }  # fmt: skip


def failed(error: Exception) -> Row:
    """A command that refused the files (exit 2), broke or took too long."""
    return {
        "outcome": "refused" if str(error).startswith("exit 2:") else "error",
        "error": f"{type(error).__name__}: {error}",
    }


def again(folder: Path, answer: Row) -> Row:
    """Verdict and names on the fresh runs, with the model of what was named or else of the first proposal."""
    proposals = answer.get("proposals") or []
    if not answer["effects"] and not proposals:
        return {}
    model, options = "model.yaml", []
    if not answer["effects"]:
        model = Path(proposals[0]["model_file"]).name
        terms = proposals[0].get("terms_file")
        options = ["--effects", str(folder / "out" / Path(terms).name)] if terms else []
    try:
        found = gap(folder / "fresh", "out", f"../out/{model}", options)
    except (RuntimeError, subprocess.TimeoutExpired) as error:
        return {"again": failed(error)["outcome"], "again_error": str(error)}
    return {"again": found["verdict"], "again_sets": named(found)}


def named(answer: Row) -> list[list[str]]:
    """The sets of names, each with what cannot be told from it."""
    return [[effect["name"], *effect.get("indistinguishable_from", [])] for effect in answer["effects"]]


def judged(chosen: Set, answer: Row) -> Row:
    """Verdict, names, locked gap, and the outcome of one answer.

    Outcomes: quiet, alarm (a null); right (one effect), both, one (of a pair), wrong (no set of at most three names has
    a cause), missed, unexplained; `+extra` where other names stand beside the right ones; named, proposal, unexplained,
    missed (outside); insufficient.
    """
    sets, proposals = named(answer), answer.get("proposals") or []
    held = (answer.get("gap") or {}).get("holdout") or {}
    return {
        "verdict": answer["verdict"], "sets": sets,
        "outcome": _outcome(chosen, answer["verdict"], sets, bool(proposals)),
        "wrong_single": any(len(each) == 1 and not _right(chosen, each) for each in sets),
        "proposed": proposals[0].get("sentence", "") if proposals else "",
        "before": held.get("before"), "after": held.get("after"), "floor": held.get("noise_floor"),
    }  # fmt: skip


def _outcome(chosen: Set, verdict: str, sets: Sequence[Sequence[str]], proposal: bool) -> str:
    if verdict == "insufficient":
        return verdict
    if chosen.kind == NULL:
        return "quiet" if verdict == "nothing_missing" else "alarm"
    if not sets:
        unnamed = "proposal" if chosen.kind == OUTSIDE and proposal else "unexplained"
        return "missed" if verdict == "nothing_missing" else unnamed
    if chosen.kind == OUTSIDE:
        return "named"
    found = sum(any(_finds(each, cause) for each in sets) for cause in chosen.causes)
    if not found:
        return "wrong"
    known = "right" if chosen.kind != PAIR else "both" if found == len(chosen.causes) else "one"
    return known if all(_right(chosen, each) for each in sets) else f"{known}+extra"


def _finds(names: Sequence[str], cause: frozenset[str]) -> bool:
    return bool(set(names) & cause) and len(names) <= LARGEST_SET


def _right(chosen: Set, names: Sequence[str]) -> bool:
    return any(_finds(names, cause) for cause in chosen.causes)


def main() -> None:
    """Read the command line, run, write the table."""
    chosen = arguments(__doc__ or "", RESULTS, TABLE, FIRST_DRAW)
    sets = [each for each in SETS.values() if not chosen.only or chosen.only in each.key]
    if not chosen.report_only:
        run(sets, chosen.draw, chosen.processes, chosen.results, time.time() + 60 * chosen.minutes, diagnose)
    rows = [row for row in finished(chosen.results).values() if row["draw"] == chosen.draw]
    write_table(chosen.table, rows, chosen.draw, chosen.note)


if __name__ == "__main__":
    main()
