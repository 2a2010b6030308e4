"""Verdicts when one threshold of the gap workflow at a time is halved and doubled.

    python -m campaign.thresholds [--processes 2] [--minutes 90] [--report-only]

Drawn cranes of every kind (nothing hidden, far seeds, laws the package has and has not, an outside effect). Each is
searched once as frozen; where a threshold is first read two processes branch off, which go on with its half and its
double, so that what came before is worked out once. Finished branches are lines of out/thresholds/results.jsonl; a
second call carries on. The table goes to docs/campaign_thresholds.md. Seeds start at 910000 and are used by no other
campaign.
"""

import argparse
import json
import multiprocessing
import os
import time
from collections import Counter
from collections.abc import Callable, Collection, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from campaign.commit import commit
from campaign.gap import diagnose_or_say, rows_of  # before numpy: it gives each process one thread
from campaign.gap_cases import FAR, NEAR, Case
from campaign.rig import DRAWN, LAWS, OUTSIDE

FIRST_SEED = 910_000
RESULTS = Path("out/thresholds/results.jsonl")
TABLE = Path("docs/campaign_thresholds.md")
FACTORS = (0.5, 2.0)
FROZEN = ("", 1.0)
# Of a log that is long and quick enough they decide nothing: what is asked of it before anything is searched ...
ADEQUACY = (
    "shortest_record", "lowest_rate", "least_usable", "least_moving", "least_each_way", "least_locked",
    "least_speed_spread", "swing_told", "least_share_moving", "fewest_to_lock_whole", "fewest_runs",
    "fewest_levels",
)  # fmt: skip
# ... and how finely things are worked out, which is no bar that something passes or not.
SETTINGS = (
    "block_time", "fullest_block", "segments_wanted", "longest_segment", "shortest_segment", "noise_window",
    "noise_order", "noise_quiet", "folds", "flips", "free_knots", "stribeck_knots", "surface_knots", "knots_apart",
    "resolved", "knots", "tuning_rounds", "lock_draws", "lock_cover", "lock_range", "guard_time", "bootstrap_draws",
    "runs_to_redraw", "interval", "polishing", "worth_polishing", "shape_std", "unbounded", "most_regions",
    "smallest_region", "single_condition", "enough_separation",
)  # fmt: skip


def deciding() -> tuple[str, ...]:
    """Thresholds by which a verdict is reached."""
    from winch_friction.discrepancy.thresholds import Thresholds

    return tuple(name for name in Thresholds.__dataclass_fields__ if name not in (*ADEQUACY, *SETTINGS))


def scaled(value: Any, factor: float) -> Any:
    """A threshold times a factor: a count stays one, a share is 1 at most, of a table by size the second figure of each
    row changes."""
    if isinstance(value, tuple):
        return tuple((size, bar * factor) for size, bar in value)
    if isinstance(value, int):
        return max(1, round(value * factor))
    return min(value * factor, 1.0) if value < 1.0 else value * factor


def branched(
    work: Callable[[], Any], names: Collection[str], tell: Callable[[str, float, Any], None], also: bool = True
) -> None:
    """Call `work` as frozen; where it first reads one of `names`, a process for each factor goes on with that value.

    `tell(name, factor, result)` is called in the process that has the result, with `FROZEN` in this one (unless not
    `also`). A threshold that is never read cannot change the result: it is told with the frozen one.
    """
    from winch_friction.discrepancy.thresholds import LIMITS, Thresholds

    waiting = set(names)
    this = FROZEN

    def read(table: Thresholds, name: str) -> Any:
        nonlocal this
        value = object.__getattribute__(table, name)
        if this == FROZEN and name in waiting:
            waiting.discard(name)
            for factor in FACTORS:
                child = os.fork()
                if child == 0:
                    this = (name, factor)
                    object.__setattr__(LIMITS, name, scaled(value, factor))
                    return object.__getattribute__(table, name)
                if os.waitpid(child, 0)[1] != 0:
                    tell(name, factor, {"error": "its process died"})
        return value

    Thresholds.__getattribute__ = read  # type: ignore[method-assign,assignment]
    try:
        result = work()
    except BaseException:
        if this == FROZEN:
            raise
        os._exit(1)
    finally:
        if this == FROZEN:
            del Thresholds.__getattribute__
    if this != FROZEN:
        tell(*this, result)
        os._exit(0)
    for name in waiting:
        for factor in FACTORS:
            tell(name, factor, result)
    if also:
        tell(*FROZEN, result)


def scan(case: Case, names: Sequence[str], path: Path) -> str:
    """All branches of one data set, each a line of the results as soon as it has ended."""
    done = {(row["threshold"], row["factor"]) for row in finished(path) if row["key"] == case.key}
    wanted = [name for name in names if any((name, factor) not in done for factor in FACTORS)]
    measured = commit()

    def tell(name: str, factor: float, row: dict[str, Any]) -> None:
        own = {key: value for key, value in row.items() if key not in ("answer", "commit")}
        line = {"key": case.key, "kind": case.kind, "threshold": name, "factor": factor, **own, "commit": measured}
        out = os.open(path, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o644)
        os.write(out, (json.dumps(line) + "\n").encode())  # in one piece: several processes write there
        os.close(out)

    if wanted or FROZEN not in done:
        branched(partial(diagnose_or_say, case), wanted, tell, also=FROZEN not in done)
    return case.key


def finished(path: Path) -> list[dict[str, Any]]:
    """Results, the last of each branch."""
    found = {(row["key"], row["threshold"], row["factor"]): row for row in rows_of(path)}
    return list(found.values())


def all_cases(seed: int) -> list[Case]:
    """An outside effect, nulls, laws and held-out laws of other causes, a far seed; of every kind one before others."""
    causes = list(LAWS)
    held = [(cause, next(law for law in LAWS[cause] if law.held_out)) for cause in causes[:10:9]]
    named = [("law", cause, LAWS[cause][0], 20 + k) for k, cause in enumerate(causes[5::15])]
    named += [("held_out", cause, law, 40 + k) for k, (cause, law) in enumerate(held)]
    laws = [Case(kind, ((f"{c}:{law.name}", 1.0),), DRAWN, seed + k) for kind, c, law, k in named]
    nulls = [Case("drawn_null", (), DRAWN, seed + k, NEAR) for k in range(6)]
    outside = Case("drawn_outside", ((list(OUTSIDE)[2], 1.0),), DRAWN, seed + 60)
    return [
        outside,
        laws[2],
        nulls[0],
        laws[0],
        Case("far_seed", (), DRAWN, seed + 10, FAR),
        laws[1],
        *nulls[1:],
        laws[3],
    ]


COUNTED = (
    ("nulls found", ("drawn_null",), "detected"), ("far seeds refuted", ("far_seed",), "seed_refuted"),
    ("laws right", ("law",), "right"), ("held-out right", ("held_out",), "right"),
    ("wrong single", ("law", "held_out", "drawn_null", "far_seed"), "wrong_single"),
    ("outside named", ("drawn_outside",), "named"), ("proposed", ("drawn_outside",), "proposed"),
)  # fmt: skip


def table(rows: Sequence[dict[str, Any]]) -> str:
    """Markdown, of `whole` data sets: a row for each threshold that changes a verdict or a name, the others named."""
    frozen = {row["key"]: row for row in rows if (row["threshold"], row["factor"]) == FROZEN}
    branches: dict[tuple[str, float], list[dict[str, Any]]] = {}
    for row in rows:
        branches.setdefault((row["threshold"], row["factor"]), []).append(row)
    lines = [
        "| threshold | times | other than as frozen | " + " | ".join(name for name, _, _ in COUNTED) + " |",
        "|---|---|" + "---|" * (len(COUNTED) + 1),
        f"| **as frozen** | 1 | | {' | '.join(_counts(list(frozen.values())))} |",
    ]
    same: list[tuple[str, float]] = []
    errors = 0
    for (name, factor), own in sorted(branches.items()):
        if not name:
            continue
        differ = Counter(_said(row) for row in own if _outcome(row) != _outcome(frozen[row["key"]]))
        errors += sum("error" in row for row in own)
        if differ:
            said = "; ".join(f"{count}× {each}" if count > 1 else each for each, count in differ.items())
            lines.append(f"| `{name}` | {factor:g} | {said} | {' | '.join(_counts(own))} |")
        else:
            same.append((name, factor))
    both = [f"`{name}`" for name, factor in same if factor == FACTORS[0] and (name, FACTORS[1]) in same]
    one = [f"`{name}` × {factor:g}" for name, factor in same if f"`{name}`" not in both]
    lines += ["", f"No verdict and no name changes with {len(both)}, halved or doubled: {', '.join(both)}."]
    lines += ["", f"Nor with {', '.join(one)}."] if one else []
    return "\n".join([*lines, "", f"Ended with an error: {errors}."])


def whole(rows: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """The rows of the data sets of which every threshold has been scanned."""
    counts = Counter(row["key"] for row in rows)
    frozen = {row["key"] for row in rows if (row["threshold"], row["factor"]) == FROZEN}
    return [row for row in rows if row["key"] in frozen and counts[row["key"]] == max(counts.values())]


def _outcome(row: dict[str, Any]) -> tuple[Any, ...]:
    return row.get("verdict", "error"), row.get("sets"), row.get("seed_refuted"), row.get("proposed")


def _said(row: dict[str, Any]) -> str:
    kind, hidden = row["key"].split("/")[:2]
    hidden = {"drawn_null": "a null", "far_seed": "a far seed"}.get(kind, hidden.removesuffix("*1"))
    names = ", ".join("/".join(each) for each in row.get("sets", []))
    also = " and `seed_refuted`" if row.get("seed_refuted") else ""
    proposed = ", proposed" if row.get("proposed") else ""
    return f"{hidden}: `{row.get('verdict', 'error')}`{' ' + names if names else ''}{also}{proposed}"


def _counts(rows: Sequence[dict[str, Any]]) -> list[str]:
    shown = []
    for _, kinds, key in COUNTED:
        own = [row for row in rows if row["kind"] in kinds]
        shown.append(f"{sum(bool(row.get(key)) for row in own)} of {len(own)}")
    return shown


def write_table(path: Path, results: Path) -> None:
    """The page: what was run, and how the verdicts change."""
    rows = whole(finished(results))
    commits = ", ".join(sorted({row["commit"] for row in rows}))
    frozen = sum((row["threshold"], row["factor"]) == FROZEN for row in rows)
    path.write_text(
        "# Verdicts when a threshold is halved and doubled\n\n"
        "One threshold at a time, on drawn cranes that calibrated none of them; all others as frozen.\n\n"
        f"* Command: `make campaign-thresholds` (`python -m campaign.thresholds`; resumable)\n* Commit: {commits}\n"
        f"* {frozen} data sets (seeds from {FIRST_SEED}), {len(deciding())} thresholds, {len(rows) - frozen} verdicts\n"
        "* Not scanned: what is asked of a log before anything is searched (`" + "`, `".join(ADEQUACY) + "`) and how "
        "finely things are worked out (`" + "`, `".join(SETTINGS) + "`)\n"
        "* A count is rounded and at least 1, a share 1 at most; of `significance` and `levels_apart` each row's bar "
        "changes\n\n"
        f"{table(rows)}\n"
    )


def run(cases: Sequence[Case], names: Sequence[str], path: Path, processes: int, until: float) -> None:
    """Scan data sets side by side; say every half minute how far it is, stop at the Unix time `until`."""
    # a process of its own for each data set: what a module reads when it is imported branches too
    with multiprocessing.get_context("spawn").Pool(processes, maxtasksperchild=1) as pool:
        ended, count = pool.imap_unordered(partial(scan, names=names, path=path), cases), 0
        while count < len(cases) and time.time() < until:
            try:
                key = ended.next(timeout=30.0)
            except multiprocessing.TimeoutError:
                print(f"  {len(finished(path))} verdicts", flush=True)
            else:
                count += 1
                print(f"{count}/{len(cases)} {key}", flush=True)


def main() -> None:
    """Read the command line, run, write the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--first-seed", type=int, default=FIRST_SEED)
    parser.add_argument("--minutes", type=float, default=float("inf"), help="stop after that long")
    parser.add_argument("--only", nargs="*", help="these thresholds instead of all that decide")
    parser.add_argument("--results", type=Path, default=RESULTS)
    parser.add_argument("--table", type=Path, default=TABLE)
    parser.add_argument("--report-only", action="store_true")
    chosen = parser.parse_args()
    names = chosen.only or deciding()
    chosen.results.parent.mkdir(parents=True, exist_ok=True)
    if not chosen.report_only:
        run(all_cases(chosen.first_seed), names, chosen.results, chosen.processes, time.time() + 60 * chosen.minutes)
    write_table(chosen.table, chosen.results)


if __name__ == "__main__":
    main()
