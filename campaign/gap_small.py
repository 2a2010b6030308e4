"""Whether a small effect is more than the seed model's own uncertainty: the arithmetic, case by case.

    python -m campaign.gap_small RESULTS.jsonl

The trace of an effect is what the same seed gives with it less what it gives without. As long as the base parameters
and the measurement's tolerances, each within two of its prior's standard deviations, can take that trace down to the
noise floor, nobody can call it missing: a seed model that is so far off does the same.
"""

import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import lsq_linear

from campaign.gap_cases import Case
from campaign.rig import make_dataset

PRIOR = 2.0  # standard deviations
LAWS = ("law", "held_out", "drawn_law")
THIN = 10  # samples: a trace has nothing faster than a friction that turns over


def beyond_prior(case: Case, floor: float) -> dict[str, Any]:
    """Rms of the effect's trace in bar of the balancing motors, what of it the prior's two standard deviations cannot
    take, and whether that is more than the noise `floor`, bar. What shows beside the balance (a leak, a ripple,
    a reversal) is not asked here: its trace in the moving samples counts, which may be nothing.
    """
    from campaign.gap import owner_files
    from winch_friction.discrepancy.expansion import meet
    from winch_friction.discrepancy.regressors import base_of, tolerance_columns
    from winch_friction.physics.signals import Run

    crane, model = owner_files(case)
    none = tuple((name, 0.0) for name, _ in case.effects)
    with_it, without = (
        meet(
            [
                Run(f"run_{k + 1:02d}", columns)
                for k, columns in enumerate(make_dataset(case.seed, case.flavour, effects, sigma=case.sigma))
            ],
            crane,
            model,
        ).prepared
        for effects in (case.effects, none)
    )
    base = base_of(model, model)
    traces, columns = [], []
    for run, null in zip(with_it, without, strict=True):
        both = min(len(run.gap), len(null.gap))
        use = np.flatnonzero(run.used[:both] & null.used[:both])[::THIN]
        own = np.column_stack([null.jacobian, tolerance_columns(null)])[use] * base.scale
        traces.append((run.gap[use] - null.gap[use]) / null.unit_torque)
        columns.append(own / null.unit_torque)
    y, x = np.concatenate(traces), np.concatenate(columns)
    low, high = np.maximum(base.lower, -PRIOR), np.minimum(base.upper, PRIOR)
    fit = lsq_linear(x, y, (low, np.maximum(high, low + 1e-9)))
    trace, left = (float(np.sqrt(np.mean(each**2))) for each in (y, y - x @ fit.x))
    return {"trace": trace, "left": left, "exceeds": left > floor}


def counted(kind: str, effects: Sequence[tuple[str, float]]) -> bool:
    """Whether the arithmetic belongs to a kind of case: small effects, and the laws over drawn cranes."""
    return kind in LAWS or (kind == "single" and effects[0][1] < 1.0)


def main() -> None:
    """Add the arithmetic to the results that lack it; the others stay as they are."""
    path = Path(sys.argv[1])
    rows = [json.loads(line) for line in path.read_text().splitlines()]
    for row in rows:
        if counted(row["kind"], row["effects"]) and "error" not in row and "beyond" not in row:
            case = Case(row["kind"], tuple(map(tuple, row["effects"])), row["flavour"], row["seed"])
            row["beyond"] = beyond_prior(case, row["floor"])
            print(f"{row['key']}: {row['beyond']}", flush=True)
    partial = path.with_suffix(".partial")
    partial.write_text("".join(json.dumps(row) + "\n" for row in rows))
    partial.replace(path)


if __name__ == "__main__":
    main()
