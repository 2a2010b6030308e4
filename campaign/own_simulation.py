"""`make campaign-own-simulation`: is a hidden effect named as often against a user's simulation as against our model?

The same winch, motion, noise and effect three times: once the measured friction is the built-in model's and `gap`
compares with that model; else it is of laws that the package does not have, and `gap` compares with a column of these
laws, or with an FMU of them (built here with pythonfmu), through the verb. Prints a table in Markdown.
"""

import argparse
import contextlib
import io
import json
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from campaign.commit import commit
from campaign.own_fmu import build
from winch_friction.cli import main as cli
from winch_friction.discrepancy.answer import GapOptions
from winch_friction.discrepancy.workflow import find_gap
from winch_friction.physics.channels import BAR, CM3_PER_REV, GRAVITY
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import FloatArray, Run
from winch_friction.physics.winch import Crane
from winch_friction.physics.winch.crane import run_drum_torque
from winch_friction.physics.winch.operating_point import run_operating_points
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model
from winch_friction.records.runs import write_run

STEP, LENGTH = 0.02, 110.0  # s
LAYER = 6  # the outer one
CYCLES = 8
BIAS = 25.0 * BAR  # of port B
TOP = 209.0  # rad/s, 2000 rpm
Torque = Callable[["Cycle"], FloatArray]


@dataclass(frozen=True)
class Cycle:
    """What one joystick cycle does: rad/s, rad/s^2, kg, m^3/rad, N m of the load at the motor shaft."""

    time: FloatArray
    speed: FloatArray
    acceleration: FloatArray
    load: float
    displacement: float
    lever: float

    @property
    def weight(self) -> float:
        """Torque of the hanging mass at the shaft."""
        return self.load * GRAVITY * self.lever


def _moved(column: str, by: float) -> Callable[[Run], Run]:
    return lambda run: replace(run, columns={**run.columns, column: run[column] + by})


def _late(seconds: float) -> Callable[[Run], Run]:
    def late(run: Run) -> Run:
        speed = np.interp(run.time - seconds, run.time, run["motor_speed"])
        return replace(run, columns={**run.columns, "motor_speed": speed})

    return late


# effect -> torque at the shaft that nobody simulates; each of a size that a fitter or an oil change would leave
TORQUES: dict[str, Torque] = {
    "churning": lambda c: np.sign(c.speed) * 44.0 * (np.abs(c.speed) / TOP) ** 2,
    "gear_asymmetry": lambda c: 0.02 * c.weight * (c.speed > 0.0),
    "inertia_error": lambda c: 0.8 * c.acceleration,
    "torque_ripple": lambda c: 12.0 * np.sin(3.0 * np.cumsum(c.speed) * STEP),
}
# effect -> what it does to the log
SIGNALS: dict[str, Callable[[Run], Run]] = {
    "pressure_offset": _moved("main.pressure_a", 6.0 * BAR),
    "tare_load": _moved("hook_load", -3000.0),
    "swivel_offset": _moved("main.displacement", 4.0 * CM3_PER_REV),
    "signal_delay": _late(0.12),
}
QUICK = "signal_delay, quick cycles"  # a delay shows while the speed changes: in slow cycles it is below the noise
EFFECTS = (*TORQUES, *SIGNALS, QUICK)


def own_friction(c: Cycle) -> FloatArray:
    """N m by laws that the package does not have: tanh instead of a sign, no Stribeck curve."""
    return np.tanh(c.speed / 2.0) * (0.11 * c.weight + 60.0) + 1.9 * c.speed


def drawn(rng: np.random.Generator, crane: Crane, between: float = 12.0) -> Cycle:
    """A joystick cycle; another speed every `between` s."""
    time_ = np.arange(0.0, LENGTH, STEP)
    knots = np.arange(0.0, LENGTH + 50.0, between)
    speed = np.interp(time_, knots, rng.uniform(-190.0, 190.0, len(knots)))
    kernel = np.hanning(75)
    speed = np.convolve(np.pad(speed, 37, mode="edge"), kernel / kernel.sum(), mode="valid")[: len(time_)]
    displacement = float(rng.choice((110.0, 160.0, 215.0))) * CM3_PER_REV
    lever = crane.drum.radius(LAYER) / crane.gear_ratio
    load = float(rng.choice((20e3, 45e3, 80e3)))
    return Cycle(time_, speed, np.gradient(speed, STEP), load, displacement, lever)


def logged(number: int, seed: int, effect: str, crane: Crane, model: FrictionModel | None) -> Run:
    """A run with the effect in what was measured; against the model, or, without one, with a simulated column.

    The user's simulation is driven by the log, so that an error of the log's load, speed or displacement is in it too.
    """
    rng = np.random.default_rng((seed, number))
    c = drawn(rng, crane, 4.0) if effect == QUICK else drawn(rng, crane)
    effect = effect.partition(",")[0]
    size = np.ones(len(c.time))
    columns = {
        "time": c.time, "motor_speed": c.speed, "main.pressure_a": 2.0 * BIAS * size, "main.pressure_b": BIAS * size,
        "main.displacement": c.displacement * size, "hook_load": c.load * size, "wire_layer": LAYER * size,
        "shaft_angle": np.cumsum(c.speed) * STEP,
    }  # fmt: skip
    run = Run(f"run_{number}", columns)  # shares the columns that are filled in below
    friction, full = own_friction(c), crane.motor_count("main") * c.displacement
    for _ in range(3 if model is not None else 0):  # the motor losses read the pressure that they raise
        columns["main.pressure_a"] = BIAS + (needed(c, crane) + friction) / full
        friction = model.torque(run_operating_points(run, crane, drum_torque=run_drum_torque(run, crane)))
    torque = needed(c, crane) + friction + (TORQUES[effect](c) if effect in TORQUES else 0.0)
    columns["main.pressure_a"] = BIAS + torque / full + 0.3 * BAR * rng.standard_normal(len(c.time))
    spoilt = SIGNALS.get(effect, lambda same: same)(run)
    if model is None:
        spoilt = replace(
            spoilt, columns={**spoilt.columns, "main.pressure_drop_simulated": simulated(spoilt, c, crane)}
        )
    noisy = spoilt["motor_speed"] + 0.02 * rng.standard_normal(len(c.time))
    return replace(spoilt, columns={**spoilt.columns, "motor_speed": noisy})


def needed(c: Cycle, crane: Crane) -> FloatArray:
    """Torque at the shaft for weight and inertia, N m."""
    return c.weight + (crane.inertia + c.load * c.lever**2) * c.acceleration


def simulated(run: Run, c: Cycle, crane: Crane) -> FloatArray:
    """The user's simulation along a log: Pa."""
    speed = run["motor_speed"]
    told = replace(c, speed=speed, acceleration=np.gradient(speed, STEP), load=float(run["hook_load"][0]))
    full = crane.motor_count("main") * run["main.displacement"]
    return np.asarray((needed(told, crane) + own_friction(told)) / full)


def named(effect: str, seed: int, column: bool, crane: Crane, model: FrictionModel) -> tuple[bool, str]:
    """Whether the effect stands in the answer, alone or in its set; and the answer in words."""
    runs = [logged(k, seed, effect, crane, None if column else model) for k in range(CYCLES)]
    return answered(effect, find_gap(runs, crane, model, GapOptions(plan=False)).content())


def named_by_fmu(effect: str, seed: int, crane: Crane, folder: Path) -> tuple[bool, str]:
    """The same through `gap --fmu`, from run files without a simulated column and the FMU in `folder`."""
    place = folder / f"{effect.replace(', ', '_')}_{seed}"
    for k in range(CYCLES):
        run = logged(k, seed, effect, crane, None)
        bare = {name: values for name, values in run.columns.items() if not name.endswith("_simulated")}
        write_run(replace(run, columns=bare), place / "runs" / f"{run.name}.parquet")
    call = [
        "gap",
        str(place / "runs"),
        "--crane",
        "crane_150t",
        "--model",
        "a6vm215_crane2",
        "--out",
        str(place / "gap"),
        "--overwrite",
    ]
    said, errors = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(errors):
        status = cli.run(
            [
                *call,
                "--fmu",
                str(folder / "OwnWinch.fmu"),
                "--fmu-map",
                str(folder / "map.yaml"),
                "--no-report",
                "--json",
            ]
        )
    if status:
        return False, f"exit {status}: {errors.getvalue().strip().splitlines()[-1]}"
    return answered(effect, json.loads(said.getvalue()))


def answered(effect: str, result: dict[str, Any]) -> tuple[bool, str]:
    """Whether gap.json names the effect, alone or in a set; and what it says."""
    sets = [[each["name"], *each["indistinguishable_from"]] for each in result["effects"]]
    return any(effect.partition(",")[0] in each for each in sets), f"{result['verdict']}: " + (
        ", ".join(map(" or ".join, sets)) or "-"
    )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=1)
    parser.add_argument("--first", type=int, default=9000, help="the first seed")
    parser.add_argument("--effects", default=";".join(EFFECTS), help="separated by ;")
    options = parser.parse_args()
    crane, model, began = load_crane("crane_150t"), load_model("a6vm215_crane2"), time.process_time()
    print("| hidden effect | seed | against the built-in model | against a simulated column | against an FMU |")
    print("|---|---|---|---|---|")
    hits = np.zeros(3, int)
    seeds = range(options.first, options.first + options.seeds)
    cases = [(effect, seed) for effect in options.effects.split(";") for seed in seeds]
    with tempfile.TemporaryDirectory() as place:
        build(Path(place))
        for effect, seed in cases:
            answers = [named(effect, seed, column, crane, model) for column in (False, True)]
            answers.append(named_by_fmu(effect, seed, crane, Path(place)))
            hits += [found for found, _ in answers]
            cells = [f"{'named' if found else 'NOT named'}; {said}" for found, said in answers]
            print(f"| {effect} | {seed} | {' | '.join(cells)} |", flush=True)
    spent = time.process_time() - began
    print(f"\nNamed {', '.join(map(str, hits))} of {len(cases)}; commit {commit()}, {spent:.0f} s of a core.")


if __name__ == "__main__":
    main()
