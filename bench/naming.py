"""`gap` beside two usual selections on the same regressors: how long each takes, and how often it names the cause.

PySINDy's sequentially thresholded least squares and a forward stepwise selection by BIC are given what `gap` itself
puts to its search: the gap of all runs in blocks, weighted by each run's noise, the base parameters with their prior as
further rows, and every candidate in every shape.
"""

import importlib.util
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from statistics import median
from typing import Any

import numpy as np

from bench.measuring import Row, seconds
from campaign.rig import make_dataset
from winch_friction.discrepancy.answer import GapOptions
from winch_friction.discrepancy.candidates.candidate import MOVING
from winch_friction.discrepancy.catalogue import candidates_for, testable
from winch_friction.discrepancy.engine.problem import Problem
from winch_friction.discrepancy.expansion import meet
from winch_friction.discrepancy.regressors import base_of, build_problem, layout_of
from winch_friction.discrepancy.workflow import find_gap
from winch_friction.physics.signals import Run
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model

CAUSES = ("low_displacement_loss", "viscosity_temperature", "pressure_offset", "tare_load", "inertia_error",
          "sheave_bending", "swivel_offset", "churning")  # fmt: skip
NULLS = 2
FIRST_SEED = 700
LENGTH, SMOKE = 0.5, 0.15  # of runs of 170 ... 240 s
LARGEST_SET = 3  # a set of more names is no answer
MOST_NAMES = 8  # the stepwise selection ends there at the latest
THRESHOLDS = np.geomspace(0.003, 0.3, 7)  # of STLSQ, in columns of unit size; BIC chooses
MISSING = "PySINDy is not installed (pip install 'winch-friction[bench]'): its row is left out"
Names = list[str]  # the largest, or the first to be found, first


@dataclass(frozen=True)
class Regression:
    """Weighted rows of all columns (rows, columns) and of the gap (rows,), columns of the base, and each slot's."""

    x: Any
    y: Any
    base: tuple[int, ...]
    slots: tuple[tuple[str, tuple[int, ...]], ...]
    blocks: int


def datasets(smoke: bool) -> list[tuple[str, list[Run]]]:
    """(hidden cause or '', runs) of each data set; a plant that shares nothing with the package."""
    hidden = [*CAUSES, *[""] * NULLS] if not smoke else [CAUSES[0]]
    return [
        (
            cause,
            [
                Run(f"run_{k:02d}", columns)
                for k, columns in enumerate(
                    make_dataset(
                        FIRST_SEED + seed, "quiet", [(cause, 1.0)] if cause else [], length=SMOKE if smoke else LENGTH
                    )[: 3 if smoke else None]
                )
            ],
        )
        for seed, cause in enumerate(hidden)
    ]


def regression(runs: Sequence[Run]) -> Regression:
    """What `gap` searches, as one least-squares problem."""
    crane, model = load_crane("crane_150t"), load_model("a6vm215_crane2")
    prepared = meet(runs, crane, model).prepared
    usable, _ = testable(candidates_for(prepared, model), prepared, model)
    layout = layout_of(base_of(model, model), [each for each in usable if each.regime == MOVING], prepared, model)
    problem: Problem = build_problem(prepared, layout)
    base = problem.base_columns
    prior = np.eye(len(base), problem.blocks.x.shape[1])
    weight = problem.blocks.weight
    return Regression(
        np.vstack([problem.blocks.x * weight[:, None], prior]),
        np.concatenate([problem.blocks.y * weight, -problem.base.shift]),
        base,
        tuple((slot.name, slot.columns) for slot in problem.slots),
        len(weight),
    )


def bic(residual: float, count: int, rows: int) -> float:
    """Schwarz's criterion of a Gaussian fit with `count` coefficients."""
    return rows * float(np.log(residual / rows)) + count * float(np.log(rows))


def stepwise(runs: Sequence[Run]) -> Names:
    """Forward selection: the candidate that lowers BIC most, until none does."""
    each = regression(runs)
    gram, right, total = each.x.T @ each.x, each.x.T @ each.y, float(each.y @ each.y)

    def score(columns: list[int]) -> float:
        part = gram[np.ix_(columns, columns)]
        part = part + np.diag(1e-9 * np.diag(part) + 1e-12)
        left = total - float(right[columns] @ np.linalg.solve(part, right[columns]))
        return bic(max(left, 1e-9), len(columns), each.blocks)

    columns, names = list(each.base), []
    best = score(columns)
    while len(names) < MOST_NAMES:
        scores = [(score([*columns, *own]), name, own) for name, own in each.slots if not set(own) & set(columns)]
        lowest, name, own = min(scores, key=lambda found: found[0])
        if lowest >= best:
            break
        best, columns = lowest, [*columns, *own]
        names.append(name)
    return list(dict.fromkeys(names))


def sindy(runs: Sequence[Run]) -> Names:
    """PySINDy's STLSQ on columns of unit size; the threshold that BIC prefers."""
    from pysindy import STLSQ

    each = regression(runs)
    size = np.sqrt((each.x**2).mean(axis=0))
    seen = np.flatnonzero(size > 0.0)
    x, spread = each.x[:, seen] / size[seen], float(np.sqrt((each.y**2).mean()))
    fits = []
    for threshold in THRESHOLDS:
        found = STLSQ(threshold=threshold * spread, alpha=1e-6, max_iter=20)
        found.fit(x, each.y)
        coefficients = np.ravel(found.coef_)
        left = float(((each.y - x @ coefficients) ** 2).sum())
        fits.append((bic(left, int((coefficients != 0.0).sum()), each.blocks), coefficients))
    _, coefficients = min(fits, key=lambda fit: fit[0])
    strength = dict(zip(seen.tolist(), np.abs(coefficients).tolist(), strict=True))
    found = [(max(strength.get(column, 0.0) for column in own), name) for name, own in each.slots]
    return list(dict.fromkeys(name for size, name in sorted(found, reverse=True) if size > 0.0))


def ours(runs: Sequence[Run]) -> Names:
    """The names of `gap`, the indistinguishable ones included."""
    result = find_gap(runs, load_crane("crane_150t"), load_model("a6vm215_crane2"), GapOptions(plan=False))
    found: Names = []
    for effect in result.content()["effects"]:
        found += [effect["name"], *effect.get("indistinguishable_from", [])]
    return list(dict.fromkeys(found))


def right(cause: str, names: Names) -> bool:
    """The cause within a set of three at most; nothing where nothing is hidden."""
    return (cause in names and len(names) <= LARGEST_SET) if cause else not names


def measure(smoke: bool = False) -> list[Row]:
    """Seconds per data set of each, reading the same runs, and its share of right answers."""
    methods: dict[str, Callable[[Sequence[Run]], Names]] = {"gap": ours, "stepwise selection by BIC": stepwise}
    if importlib.util.find_spec("pysindy"):
        methods["PySINDy's STLSQ"] = sindy
    times: dict[str, list[float]] = {name: [] for name in methods}
    correct: dict[str, list[bool]] = {name: [] for name in methods}
    first: dict[str, list[bool]] = {name: [] for name in methods}
    for cause, runs in datasets(smoke):
        for name, method in methods.items():
            found: list[Names] = []
            times[name].append(seconds(lambda m=method, r=runs, f=found: f.append(m(r))))
            correct[name].append(right(cause, found[0]))
            first[name].append(found[0][:1] == ([cause] if cause else []))
    missing = "" if "PySINDy's STLSQ" in methods else MISSING
    rows = []
    for name in methods:
        answers = (
            f"{sum(correct[name])} of {len(correct[name])} right (the cause among {LARGEST_SET} names at most, or "
            f"nothing); first or only name right in {sum(first[name])}"
        )
        ratio = median(a / b for a, b in zip(times["gap"], times[name], strict=True)) if name != "gap" else None
        rows.append(Row(f"naming: {name}, per data set", median(times[name]), "s", answers, ratio=ratio, note=missing))
        missing = ""
    return rows
