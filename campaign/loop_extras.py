"""What the closed-loop study reports without a bar, and its limit-cycle checks."""

import math
from collections.abc import Iterable
from typing import Any

import numpy as np

from campaign.loop_cases import (
    DRIVES,
    SEAS,
    SETTLED,
    SPEED_BINS,
    Learned,
    Sea,
    bins,
    closed_loop,
    compensator,
    learn,
    scenario,
    score,
)
from campaign.loop_learning import consistency, learning_errors, transfer
from winch_friction.compensation import CompensatorConfig
from winch_friction.physics.channels import RPM
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel

SEEDS = (111, 112, 113)
SEA = SEAS[3]  # JONSWAP, Hs 1 m
MISMATCHES: dict[str, dict[str, float]] = {
    "leakage + 30 %": {"leakage": 1.3},
    "leakage - 30 %": {"leakage": 0.7},
    "bulk modulus - 25 %": {"bulk_modulus": 0.75},
    "bulk modulus + 25 %": {"bulk_modulus": 1.25},
    "inertia + 20 %": {"inertia": 1.2},
    "wire stiffness - 30 %": {"wire_stiffness": 0.7},
}
CALM = 60.0  # s of rest or swell that are looked at


def extras(truth: FrictionModel, learned: Iterable[Learned], quick: bool) -> str:
    """Markdown of everything here; `learned` is what the study has learned."""
    seeds = SEEDS[:1] if quick else SEEDS
    model = learn("primary", 55e3, SEA, truth).model
    return "\n\n".join(
        [
            "## What the stated sigma is worth",
            CONSISTENCY,
            _table(["sensor error", "cases", "NEES, mean", "of an honest filter", "within 3 sigma", "worst case"],
                   consistency(learned, truth, quick)),
            "## Learned at 55 t, used at another load (no bar)",
            TRANSFER,
            _table(["drive", "load", "worst friction error of a speed bin", "learned x 0.9", "perfect x 0.9"],
                   transfer(truth, seeds)),
            "## Limit cycles",
            LIMIT_CYCLES,
            _table(["drive", "case", "without, rad/s", "with, rad/s", "ratio", "met"], limit_cycles(truth)),
            measured_speed(),
            "## Plant mismatch and slow pump (no bar)",
            "55 t, Hs 1 m; the controller, the estimator and the compensator know the nominal plant.",
            _table(["plant", "no feedforward, mm", "learned x 0.9, less by"], mismatches(truth, model, seeds)),
            "## Learning under errors of sensors and plant (no bar)",
            "Pump-controlled, 55 t, Hs 1 m, 20 wave periods; nobody told the estimator.",
            _table(
                ["error", "largest friction error of a speed bin", "NIS windows inside"], learning_errors(truth, quick)
            ),
            "## Speed error by bin (no bar)",
            "55 t, Hs 1 m, pump-controlled: RMS of true minus reference speed, rpm.",
            _table(["rpm", "no feedforward", "learned x 0.9"], speed_errors(truth, model, seeds)),
        ]
    )  # fmt: skip


CONSISTENCY = """The squared error of all ten parameters in their stated covariance (NEES), whose mean over honest
filters is 10 (bar: 8 ... 12) where truths are drawn from the prior, and sensor errors from what is considered
(displacements 1 %, the speed's lateness 0.15 of a sample). In the last row they are. In the others the truth is the
same in every case, and so are the sensors, if they have errors at all. An honest filter's mean is another one then,
which the next column says: less, because the covariance holds room for sensor errors, and because a truth that
differs from the seed as a whole is what the data tell best. A mean below that column's is room that this plant does
not use: for a torque of 10 N m that no term explains, and for a load that moves by itself. And the share of all
parameters within three stated sigma of the truth (bar: 90 %), which is about ten of the seed's own sigmas away."""
TRANSFER = """One load tells the sum of constant and load-dependent losses and not their shares, so that what is learned
at one is off at another. Reduction of the position error's RMS in JONSWAP Hs 1 m: since the feedforward is scaled by
0.9, too much friction by 5 % looks better here than the truth, and too little worse."""
LIMIT_CYCLES = """Noise off, bristle (Dahl) friction in the plant, the true model at scale 1.08, reference speed.
*Calming*: a sea of 1.5 m / 10 s that fades to rest; *swell*: 2 cm, 20 s. Speed RMS over the last 60 s; the bar is
1.5 times that without feedforward (a speed below 0.01 rad/s, 0.1 rpm, counts as rest)."""
REST = 0.01  # rad/s


def limit_cycles(truth: FrictionModel) -> list[list[str]]:
    """One line per drive and case."""
    calming = Sea("calming", 10.0, {"kind": "regular", "amplitude": 1.5, "period": 10.0})
    swell = Sea("swell", 20.0, {"kind": "regular", "amplitude": 0.02, "period": 20.0})
    quiet: dict[str, Any] = {"sensors.noise": False, "sensors.quantisation": False}
    cases: dict[str, tuple[Sea, float, dict[str, Any]]] = {
        "calming": (calming, 130.0, {**quiet, "calm_at": 40.0, "calm_time": 30.0}),
        "swell": (swell, 120.0, quiet),
    }
    lines = []
    for drive in DRIVES:
        for name, (sea, duration, changes) in cases.items():
            without, with_it = (_late_speed(drive, sea, duration, changes, truth, on) for on in (False, True))
            ratio = max(with_it, REST) / max(without, REST)
            met = "yes" if ratio <= 1.5 else "**no**"
            lines.append([DRIVES[drive], name, f"{without:.4f}", f"{with_it:.4f}", f"{ratio:.2f}", met])
    return lines


def _late_speed(
    drive: str, sea: Sea, duration: float, changes: dict[str, Any], truth: FrictionModel, on: bool
) -> float:
    case = scenario(drive, 55e3, sea, duration, **changes)
    record = closed_loop(case, truth, 0, compensator(truth, scale=1.08) if on else None).result().truth
    late = record.time > duration - CALM
    return float(math.sqrt(np.mean(record["motor_speed"][late] ** 2)))


def measured_speed() -> str:
    """What the compensator says to measured speed on the torque-commanded drive."""
    try:
        CompensatorConfig(drive="torque", velocity_source="measured")
    except InputError as error:
        return f"Measured speed as velocity source on the torque-commanded drive is refused: *{error}*."
    return "**Measured speed on the torque-commanded drive was not refused.**"


def mismatches(truth: FrictionModel, model: FrictionModel, seeds: tuple[int, ...]) -> list[list[str]]:
    """Reduction by the learned model on plants that differ from what everybody believes."""
    plants: dict[str, dict[str, Any]] = {"nominal": {}, **{name: {"mismatch": m} for name, m in MISMATCHES.items()}}
    plants["slow pump (second order, 6 rad/s)"] = {"plant": "winch_150t_slow_pump"}
    lines = []
    for drive in DRIVES:
        for name, changes in plants.items():
            if drive == "secondary" and ("pump" in name or "leakage" in name or "bulk" in name):
                continue
            errors = _errors(drive, changes, truth, model, seeds)
            lines.append(
                [f"{DRIVES[drive]}, {name}", f"{1e3 * errors[0]:.1f}", f"{100 * (1 - errors[1] / errors[0]):.0f} %"]
            )
    return lines


def _errors(
    drive: str, changes: dict[str, Any], truth: FrictionModel, model: FrictionModel, seeds: tuple[int, ...]
) -> tuple[float, float]:
    case = scenario(drive, 55e3, SEA, **changes)
    squares = [
        [score(closed_loop(case, truth, seed, each)).overall for each in (None, compensator(model, plant=case.plant))]
        for seed in seeds
    ]
    without, with_it = np.sqrt(np.mean(squares, axis=0))
    return float(without), float(with_it)


def speed_errors(truth: FrictionModel, model: FrictionModel, seeds: tuple[int, ...]) -> list[list[str]]:
    """RMS of the speed error by speed bin, rpm."""
    pooled: list[dict[int, list[float]]] = [{}, {}]
    for seed in seeds:
        for k, each in enumerate((None, compensator(model))):
            record = closed_loop(scenario("primary", 55e3, SEA), truth, seed, each).result().truth
            settled = record.time > SETTLED
            error = (record["motor_speed"] - record["speed_reference"])[settled] / RPM
            for low, inside in bins(record["speed_reference"][settled]).items():
                pooled[k].setdefault(low, []).extend(error[inside])
    edges = dict(zip(SPEED_BINS, SPEED_BINS[1:], strict=False))
    return [
        [f"{low} ... {edges[low]}", *(f"{math.sqrt(np.mean(np.square(each[low]))):.1f}" for each in pooled)]
        for low in pooled[0]
        if len(pooled[0][low]) > 50
    ]


def _table(head: list[str], rows: list[list[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)
