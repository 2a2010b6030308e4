"""Thresholds of the gap workflow from null data alone: what they must be so that nothing is found where nothing is.

    python -m campaign.calibrate [--nulls 40] [--processes 2]

Runs the workflow on drawn cranes without an effect and prints the quantiles of what each threshold is compared with.
Seeds start at 900000 and are used by no campaign. What each threshold does to the verdicts: `campaign.thresholds`.
"""

import argparse
import multiprocessing
from collections import Counter
from typing import Any

from campaign.gap import diagnose_or_say
from campaign.gap_cases import Case
from campaign.rig import DRAWN

FIRST_SEED = 900_000


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


def main() -> None:
    """Read the command line, run, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--nulls", type=int, default=40)
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--first-seed", type=int, default=FIRST_SEED)
    chosen = parser.parse_args()
    cases = [Case("drawn_null", (), DRAWN, chosen.first_seed + k) for k in range(chosen.nulls)]
    with multiprocessing.get_context("spawn").Pool(chosen.processes) as pool:
        print(quantiles(pool.map(diagnose_or_say, cases, chunksize=1)))


if __name__ == "__main__":
    main()
