"""`make campaign-real`: real winches and drives through the user's verbs; written to docs/real_data.md with pictures.

import --propose, import, check, gap (with its report), replay. A step that refuses is written down as such; where check
refuses, the rest goes on with --force.
"""

import argparse
import contextlib
import io
import json
import tempfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from winch_friction.cli.main import run as command
from winch_friction.discrepancy.preparation.prepare import prepare
from winch_friction.physics.corrections import corrected
from winch_friction.physics.signals import FloatArray, Run
from winch_friction.physics.winch import Crane
from winch_friction.records.model_file import load_model
from winch_friction.records.runs import read_run

ROOT = Path(__file__).parents[1]
SHARED = ROOT.parent / "shared" / "data"
EXAMPLES = ROOT / "config" / "examples"


@dataclass(frozen=True)
class Study:
    """One real data set: where its logs are, and what a person has to say about them."""

    name: str
    crane: str
    model: str
    logs: tuple[Path, ...]
    said: tuple[str, ...] = ()
    every: int = 1  # which logs the gap may see; the rest judges


@dataclass
class Outcome:
    """What each verb answered: (verb, exit status, sentence); and where the files are."""

    study: Study
    folder: Path
    steps: list[tuple[str, int, str]] = field(default_factory=list)
    gap: dict[str, Any] = field(default_factory=dict)

    @property
    def runs(self) -> list[Path]:
        """The imported runs."""
        return sorted((self.folder / "runs").glob("*.csv"))

    @property
    def written(self) -> Path:
        """The repaired model's file."""
        return self.folder / "gap" / "model.yaml"


def studies() -> list[Study]:
    """The data sets that are there: those beside the project, else the shipped examples."""
    kite = sorted((SHARED / "winch_100kw").glob("*.csv")) or sorted((EXAMPLES / "winch_100kw").glob("*.csv"))
    worm = sorted((SHARED / "worm_drive" / "steady_state").glob("*/*.csv")) or sorted(
        (EXAMPLES / "worm_drive").glob("*.csv")
    )
    emps = tuple((SHARED / "emps").glob("*.mat"))
    volts = ("motor_torque.from=vir", "motor_torque.factor=35.1507")
    position = ("motor_speed.from=qm", "motor_speed.unit=rad", "motor_speed.differentiate=100")
    found = [
        Study("winch_100kw", "winch_100kw", "rope_force_alone", tuple(kite), every=2),
        Study(
            "worm_drive",
            "worm_drive",
            "worm_viscous",
            tuple(worm),
            ("motor_torque.of=9.84 mN*m", "hook_load.constant=0.096 kg"),
        ),
        Study("emps", "emps", "emps_viscous", emps, volts + position),
    ]
    return [study for study in found if study.logs]


def carried_through(study: Study, folder: Path) -> Outcome:
    """A data set the whole way, as a user types it."""
    out = Outcome(study, folder)
    mapped, logs = str(folder / "map.yaml"), [str(path) for path in study.logs]
    settings = [each for said in study.said for each in ("--set", said)]
    _step(out, "import --propose", ["import", *logs, "--propose", "--crane", study.crane, "--map", mapped, *settings])
    _step(out, "import", ["import", *logs, "--map", mapped, "--out", str(folder / "runs")])
    named = ["--crane", study.crane, "--model", study.model]
    status = _step(out, "check", ["check", *map(str, out.runs), *named, "--out", str(folder / "check")])
    force = ["--force"] if status else []
    seen = [str(path) for path in out.runs[:: study.every]]
    _step(out, " ".join(["gap", *force]), ["gap", *seen, *named, "--out", str(folder / "gap"), "--overwrite", *force])
    aside = ["--crane", study.crane, "--motor", study.model, "--out", str(folder / "identified.yaml")]
    _step(out, " ".join(["identify system", *force]), ["identify", "system", *seen, *aside, *force])
    if out.written.is_file():
        out.gap = json.loads((folder / "gap" / "gap.json").read_text(encoding="utf-8"))
        asked = ["--crane", study.crane, "--model", str(out.written), "--out", str(folder / "replay.csv"), "--json"]
        _step(out, " ".join(["replay", *force]), ["replay", str(out.runs[-1]), *asked, *force])
    return out


def _step(out: Outcome, verb: str, arguments: list[str]) -> int:
    status, printed, said = said_of(arguments)
    lines = [line for line in said.splitlines() if line and not line.startswith("warning:")]
    if status and not lines:
        lines = printed.splitlines()[:1]
    sentence = lines[-1].replace(str(out.folder) + "/", "") if status and lines else ""
    out.steps.append((verb, status, sentence))
    print(f"{out.study.name}: {verb}: exit {status} {sentence[:160]}", flush=True)
    return status


def said_of(arguments: list[str]) -> tuple[int, str, str]:
    """A command's exit status, and what it wrote to stdout and stderr."""
    said, printed = io.StringIO(), io.StringIO()
    with contextlib.redirect_stderr(said), contextlib.redirect_stdout(printed):
        status = command(arguments)
    return status, printed.getvalue(), said.getvalue()


def power_of(path: Path, crane: Crane, model_file: str | Path) -> tuple[Run, FloatArray]:
    """A run and the mechanical power in W that a model file predicts along it.

    The acceleration is that of the log's own samples, as in the regressions that it is compared with: the search looks
    at both sides of the balance through one smoothing, behind which a raw power must not be put.
    """
    model = load_model(model_file)
    run, right = corrected(read_run(path, crane), crane, model)
    prepared = prepare(run, right, model)
    speed, without = run["motor_speed"], prepared.predicted - right.inertia * prepared.acceleration
    torque = np.interp(run.time - run.time[0], prepared.time - prepared.time[0], without)
    return run, (torque + right.inertia * np.gradient(speed, run.time)) * speed


def power_error(paths: list[Path], crane: Crane, model_file: str | Path) -> float:
    """RMS error of the power over all samples of all runs, relative to the power's own RMS."""
    errors, powers = [], []
    for path in paths:
        run, predicted = power_of(path, crane, model_file)
        good = np.isfinite(predicted) & np.isfinite(run["mechanical_power"])
        errors.append((predicted - run["mechanical_power"])[good])
        powers.append(run["mechanical_power"][good])
    return float(np.sqrt(np.mean(np.concatenate(errors) ** 2) / np.mean(np.concatenate(powers) ** 2)))


def loss_by_cycle(paths: list[Path], crane: Crane, model_file: str | Path) -> list[tuple[float, float]]:
    """Hours since the first cycle, and the loss beyond the model in N (mean of the remainder along the motion)."""
    model, found = load_model(model_file), []
    for path in paths:
        run, right = corrected(read_run(path, crane), crane, model)
        prepared = prepare(run, right, model)
        left = (prepared.gap * np.sign(prepared.speed))[prepared.used]
        found.append((float(run.time[0]) / 3600.0, float(np.median(left))))
    first = found[0][0]
    return [(hour - first, loss) for hour, loss in found]


def main() -> None:
    """The campaign."""
    from campaign.real_page import page

    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "real_data.md")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        outcomes = []
        for study in studies():
            place = Path(folder) / study.name
            place.mkdir()
            outcomes.append(carried_through(study, place))
        options.out.write_text(page(outcomes, options.out.parent / "images"), encoding="utf-8")
    print(f"written {options.out}")


if __name__ == "__main__":
    main()
