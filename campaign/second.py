"""The campaign on a second independent winch, through the command line alone.

    python -m campaign.second [--only KEY] [--minutes M] [--processes 1] [--draw 38] [--report-only]

Every data set of `campaign/second_rig` is written as CSV files with a crane and a model file into a temporary folder,
`winch-friction gap` runs on it as a process of its own, and its gap.json is judged; where it named something it runs
again with the model it wrote. Every finished case is one line of out/campaign_second/results.jsonl; a second call
carries on where the first ended, and a partial run gives a table that says so. The table goes to
docs/campaign_second.md. Draws 0 to 3, 27, 31 and 33 to 37 were seen in development.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path
from typing import Any

for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(threads, "1")

from campaign.commit import commit  # noqa: E402
from campaign.gap import finished  # noqa: E402
from campaign.second_report import write_table  # noqa: E402
from campaign.second_rig import SETS, Set, write_set  # noqa: E402
from campaign.second_rig.sets import NULL, OUTSIDE  # noqa: E402

RESULTS = Path("out/campaign_second/results.jsonl")
TABLE = Path("docs/campaign_second.md")
FIRST_DRAW = 38
LONGEST = 1200.0  # s that a command may take
LARGEST_SET = 3


def command(verb: str, folder: Path, *options: str, model: str = "model.yaml") -> subprocess.CompletedProcess[str]:
    """`winch-friction VERB` on the runs, crane and model in a folder."""
    called = [sys.executable, "-m", "winch_friction.cli.main", verb, str(folder / "runs")]
    called += ["--crane", str(folder / "crane.yaml"), "--model", str(folder / model), *options]
    return subprocess.run(called, capture_output=True, text=True, timeout=LONGEST, check=False)


def gap(folder: Path, out: str, model: str = "model.yaml", options: Sequence[str] = ()) -> dict[str, Any]:
    """The content of gap.json after `winch-friction gap` with further options.

    Raises RuntimeError with what the command said if it refuses or fails.
    """
    done = command("gap", folder, "--out", str(folder / out), "--no-report", *options, model=model)
    if done.returncode or "Traceback" in done.stderr:
        raise RuntimeError(f"exit {done.returncode}: {(done.stdout + done.stderr)[-600:]}")
    return json.loads((folder / out / "gap.json").read_text())


def diagnose(chosen: Set, draw: int) -> dict[str, Any]:
    """Write one data set, search it, search it again with the model that was written; judged."""
    row: dict[str, Any] = {
        "key": f"{chosen.key}/{draw}", "set": chosen.key, "kind": chosen.kind, "rate": chosen.options.logging.rate,
        "draw": draw, "seed": chosen.seed(draw),
    }  # fmt: skip
    with tempfile.TemporaryDirectory() as temporary:
        folder = write_set(Path(temporary), chosen, chosen.seed(draw))
        started = time.perf_counter()
        try:
            row |= judged(chosen, gap(folder, "out"))
            row["seconds"] = time.perf_counter() - started
            if row["sets"]:
                row["again"] = gap(folder, "again", model="out/model.yaml")["verdict"]
        except (RuntimeError, subprocess.TimeoutExpired) as error:
            row["error"] = f"{type(error).__name__}: {error}"
    return row


def judged(chosen: Set, answer: dict[str, Any]) -> dict[str, Any]:
    """Verdict, names, locked gap, and the outcome of one answer.

    Outcomes: quiet, alarm (a null); unnamed, named (outside); right (every cause in a set of at most three names, and
    no other name), part, wrong (a set without any cause), unnamed, missed.
    """
    sets = [[effect["name"], *effect["indistinguishable_from"]] for effect in answer["effects"]]
    held = answer["gap"]["holdout"]
    return {
        "verdict": answer["verdict"], "sets": sets, "outcome": _outcome(chosen, answer["verdict"], sets),
        "wrong_single": _wrong_single(chosen, sets),
        "proposed": (answer.get("proposals") or [{}])[0].get("sentence", ""),
        "before": held["before"], "after": held["after"], "floor": held["noise_floor"],
    }  # fmt: skip


def _outcome(chosen: Set, verdict: str, sets: Sequence[Sequence[str]]) -> str:
    if chosen.kind == NULL:
        return "quiet" if verdict == "nothing_missing" else "alarm"
    if chosen.kind == OUTSIDE:
        return "named" if sets else "unnamed"
    if any(not set(each) & set().union(*chosen.causes) for each in sets):
        return "wrong"
    found = sum(any(set(each) & cause and len(each) <= LARGEST_SET for each in sets) for cause in chosen.causes)
    if found:
        return "right" if found == len(chosen.causes) else "part"
    return "missed" if verdict == "nothing_missing" else "unnamed"


def _wrong_single(chosen: Set, sets: Sequence[Sequence[str]]) -> bool:
    return any(len(each) == 1 and not set(each) & set().union(*chosen.causes) for each in sets)


def in_turn(sets: Sequence[Any]) -> list[Any]:
    """All kinds of sets (`key`, `kind`) spread evenly, so that a partial run has some of each."""
    counts = Counter(each.kind for each in sets)
    seen: Counter[str] = Counter()
    place = {}
    for each in sets:
        place[each.key] = (seen[each.kind] + 0.5) / counts[each.kind]
        seen[each.kind] += 1
    return sorted(sets, key=lambda each: place[each.key])


def run(
    sets: Sequence[Any], draw: int, processes: int, path: Path, until: float = float("inf"),
    diagnosed: Callable[[Any, int], dict[str, Any]] = diagnose,
) -> None:  # fmt: skip
    """Work through the sets that have no result yet; none is begun after the Unix time `until`."""
    done = finished(path)
    waiting = [each for each in in_turn(sets) if f"{each.key}/{draw}" not in done]
    path.parent.mkdir(parents=True, exist_ok=True)
    measured = commit()

    def one(chosen: Any) -> dict[str, Any] | None:
        return diagnosed(chosen, draw) if time.time() < until else None

    with path.open("a") as out, ThreadPoolExecutor(processes) as pool:  # a command is a process of its own
        for k, row in enumerate(future.result() for future in as_completed([pool.submit(one, s) for s in waiting])):
            if row is None:
                continue
            out.write(json.dumps(row | {"commit": measured}) + "\n")
            out.flush()
            told = row.get("error") or f"{row['outcome']}, {row['verdict']} {row['sets']}, again {row.get('again')}"
            print(f"{k + 1}/{len(waiting)} {row['key']}: {told}", flush=True)


def arguments(what: str, results: Path, table: Path, draw: int) -> argparse.Namespace:
    """The command line of a campaign with draws; these are its defaults."""
    parser = argparse.ArgumentParser(description=what.splitlines()[0])
    parser.add_argument("--only", help="sets whose key contains this")
    parser.add_argument("--draw", type=int, default=draw, help="which winch of each set")
    parser.add_argument("--minutes", type=float, default=float("inf"), help="stop after that long; the table says so")
    parser.add_argument("--processes", type=int, default=1)
    parser.add_argument("--results", type=Path, default=results)
    parser.add_argument("--table", type=Path, default=table)
    parser.add_argument("--report-only", action="store_true", help="write the table from the results there are")
    parser.add_argument("--note", default="", help="a line for the head of the table")
    return parser.parse_args()


def main() -> None:
    """Read the command line, run, write the table."""
    chosen = arguments(__doc__ or "", RESULTS, TABLE, FIRST_DRAW)
    sets = [each for each in SETS.values() if not chosen.only or chosen.only in each.key]
    if not chosen.report_only:
        run(sets, chosen.draw, chosen.processes, chosen.results, time.time() + 60 * chosen.minutes)
    rows = [row for row in finished(chosen.results).values() if row["draw"] == chosen.draw]
    write_table(chosen.table, rows, chosen.draw, chosen.note)


if __name__ == "__main__":
    main()
