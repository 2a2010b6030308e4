"""Thresholds of the gap workflow from null data alone: what they must be so that nothing is found where nothing is.

    python -m campaign.calibrate [--nulls 40] [--processes 2] [--scan]

Runs the workflow on drawn cranes without an effect and prints the quantiles of what each threshold is compared with;
with `--scan`, verdicts when one threshold at a time is halved and doubled (docs/campaign_thresholds.md). Seeds start at
900000 and are used by no campaign.
"""

import argparse
import json
import multiprocessing
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Any

from campaign.gap_cases import Case
from campaign.rig import DRAWN, LAWS, OUTSIDE

FIRST_SEED = 900_000
TABLE = Path("docs/campaign_thresholds.md")
SCANNED = (
    "prior_weight", "least_inside", "least_unexplained", "left_over", "least_excess", "free_charge", "effect_price",
    "seed_sigma", "proposal_gain",
)  # fmt: skip


def _with(name: str, factor: float) -> None:
    """Change one threshold in this process, in every module that reads the table."""
    import winch_friction.discrepancy.thresholds as table

    changed = replace(table.LIMITS, **{name: getattr(table.LIMITS, name) * factor})
    for key, value in vars(changed).items():
        object.__setattr__(table.LIMITS, key, value)


def judged(job: tuple[Case, str, float]) -> dict[str, Any]:
    """One diagnosis with one threshold changed by a factor (a factor of 1 changes nothing)."""
    from campaign.gap import diagnose_or_say

    case, name, factor = job
    if name:
        _with(name, factor)
    row = diagnose_or_say(case)
    if name:
        _with(name, 1.0 / factor)
    return row | {"threshold": name, "factor": factor}


def quantiles(rows: list[dict[str, Any]]) -> str:
    """What the thresholds are compared with on null data: verdicts, gains and p-values of the best candidate."""
    verdicts = Counter(row.get("verdict", "error") for row in rows)
    best = [
        max(row["answer"]["considered"], key=lambda c: c["cv_gain"], default=None) for row in rows if "answer" in row
    ]
    gains = sorted((c["cv_gain"] for c in best if c), reverse=True)
    refuted = sum(bool(row["answer"].get("seed_refuted")) for row in rows if "answer" in row)
    return f"verdicts {dict(verdicts)}; seed refuted {refuted}; largest held-out gains of any candidate: " + ", ".join(
        f"{100 * gain:.2g} %" for gain in gains[:5]
    )


def scan_cases(seed: int) -> list[Case]:
    """A reduced campaign: nulls, far seeds, a law and a held-out law of some causes, some outside effects."""
    cases = [Case("drawn_null", (), DRAWN, seed + k) for k in range(4)]
    cases += [Case("far_seed", (), DRAWN, seed + 10 + k, (2.0, 3.0)) for k in range(2)]
    for k, cause in enumerate(list(LAWS)[::5]):
        for law in (LAWS[cause][0], LAWS[cause][-1]):
            kind = "held_out" if law.held_out else "law"
            cases.append(Case(kind, ((f"{cause}:{law.name}", 1.0),), DRAWN, seed + 20 + 2 * k + law.held_out))
    cases += [Case("drawn_outside", ((name, 1.0),), DRAWN, seed + 60 + k) for k, name in enumerate(list(OUTSIDE)[::4])]
    return cases


def table(rows: list[dict[str, Any]]) -> str:
    """Markdown: how the verdicts change with each threshold."""
    lines = [
        "| threshold | factor | nulls found | far seeds refuted | laws right | wrong single | outside named |",
        "|---|---|---|---|---|---|---|",
    ]
    for key in dict.fromkeys((row["threshold"], row["factor"]) for row in rows):
        own = [row for row in rows if (row["threshold"], row["factor"]) == key and "verdict" in row]
        laws = [row for row in own if row["kind"] in ("law", "held_out")]
        counts = [
            _count([r for r in own if r["kind"] == "drawn_null"], "detected"),
            _count([r for r in own if r["kind"] == "far_seed"], "seed_refuted"), _count(laws, "right"),
            _count(laws, "wrong_single"), _count([r for r in own if r["kind"] == "drawn_outside"], "named"),
        ]  # fmt: skip
        lines.append(f"| {key[0] or 'as frozen'} | {key[1]:g} | {' | '.join(counts)} |")
    return "\n".join(lines)


def _count(rows: list[dict[str, Any]], key: str) -> str:
    return f"{sum(bool(row[key]) for row in rows)} of {len(rows)}"


def main() -> None:
    """Read the command line, run, print or write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--nulls", type=int, default=40)
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--first-seed", type=int, default=FIRST_SEED)
    parser.add_argument("--scan", action="store_true")
    chosen = parser.parse_args()
    with multiprocessing.get_context("spawn").Pool(chosen.processes) as pool:
        if not chosen.scan:
            cases = [Case("drawn_null", (), DRAWN, chosen.first_seed + k) for k in range(chosen.nulls)]
            print(quantiles(pool.map(judged, [(case, "", 1.0) for case in cases], chunksize=1)))
            return
        cases = scan_cases(chosen.first_seed + 10_000)
        jobs = [(case, "", 1.0) for case in cases]
        jobs += [(case, name, factor) for name in SCANNED for factor in (0.5, 2.0) for case in cases]
        rows = pool.map(judged, jobs, chunksize=1)
    Path("out").mkdir(exist_ok=True)
    Path("out/thresholds.json").write_text(
        json.dumps([{k: v for k, v in row.items() if k != "answer"} for row in rows])
    )
    text = (
        f"# Verdicts when a threshold is halved and doubled\n\n`python -m campaign.calibrate --scan`\n\n{table(rows)}\n"
    )
    TABLE.write_text(text)
    print(text)


if __name__ == "__main__":
    main()
