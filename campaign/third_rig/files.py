"""A set as its owner has it on disk: crane.yaml, model.yaml, runs/*.csv, and the same in fresh/ for later runs."""

from dataclasses import dataclass
from pathlib import Path

from campaign.third_rig.crane import crane_text, model_text, rng_of
from campaign.third_rig.hidden import Hidden
from campaign.third_rig.plan import Plan, draw_plan
from campaign.third_rig.plant import solve
from campaign.third_rig.runs import Run, draw_runs
from campaign.third_rig.sensors import Columns, logged
from campaign.third_rig.sets import PAIR, Set
from campaign.third_rig.sizing import Sized, fairly_sized, noise_floor


@dataclass(frozen=True)
class Truth:
    """What no owner knows of a set."""

    plan: Plan
    runs: list[Run]
    sized: list[Sized]  # as the set's effects
    floor: float  # bar, of the balance in blocks of 0.2 s
    tightening: float  # of the seed's standard deviations


def write_set(folder: Path, chosen: Set, draw: int) -> Truth:
    """Draw a set, size what is hidden in it and write its files.

    Raises ValueError if a hidden effect leaves no trace in these runs.
    """
    plan = draw_plan(chosen.key, draw, chosen.options)
    runs = draw_runs(plan)
    sized: list[Sized] = []
    tightening = 1.0
    if chosen.effects:
        rng = rng_of("size", draw, chosen.key)
        targets = [float(rng.uniform(4 if chosen.kind == PAIR else 3, 10)) for _ in chosen.effects]
        plan, sized, tightening = fairly_sized(plan, runs, chosen.effects, targets)
    hidden = tuple((effect, each.size) for effect, each in zip(chosen.effects, sized, strict=True))
    _write_folder(folder, plan, hidden, runs, "runs")
    _write_folder(folder / "fresh", plan, hidden, draw_runs(plan, fresh=True), "fresh")
    return Truth(plan, runs, sized, noise_floor(plan.options), tightening)


def _write_folder(folder: Path, plan: Plan, hidden: Hidden, runs: list[Run], name: str) -> None:
    (folder / "runs").mkdir(parents=True, exist_ok=True)
    options = plan.options
    groups = sorted({channel.split(".")[0] for channel in plan.zeros})
    tolerances = dict.fromkeys(groups, options.zero_tolerance)
    (folder / "crane.yaml").write_text(crane_text(plan.key, plan.crane, options.elastic))
    (folder / "model.yaml").write_text(model_text(plan.key, plan.crane, plan.figures, options.stribeck, tolerances))
    for run in runs:
        rng = rng_of("noise", plan.draw, plan.key, name, run.number)
        columns = logged(plan, run, solve(plan, run, hidden), rng)
        _write_csv(folder / "runs" / f"{name}_{run.number:02d}_{run.mode}.csv", columns)


def _write_csv(path: Path, columns: Columns) -> None:
    cells = [map(repr, values.tolist()) for values in columns.values()]
    rows = [",".join(row) for row in zip(*cells, strict=True)]
    path.write_text("\n".join([",".join(columns), *rows]) + "\n")
