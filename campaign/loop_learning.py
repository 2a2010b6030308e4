"""What sensors and plant do to the learning: the closed-loop study's table of learned friction under errors that
nobody told
the estimator."""

import math
from collections.abc import Iterable, Sequence
from statistics import mean
from typing import Any

import numpy as np

from campaign.loop_cases import (
    CRANE,
    DRIVES,
    LEARNING_PERIODS,
    LEARNING_SEED,
    LOADS,
    SEAS,
    SEED,
    Learned,
    Sea,
    closed_loop,
    compensator,
    friction_errors,
    learn,
    scenario,
    score,
)
from winch_friction.estimation import FrictionEstimator
from winch_friction.physics.friction import FrictionModel
from winch_friction.simulation.scenario import Scenario

SEA = SEAS[3]  # JONSWAP, Hs 1 m
BOTH = ("active", "passive")
DRAWN_FROM = 20  # of the random numbers
ERRORS: dict[str, dict[str, Any]] = {
    "none": {},
    "displacements read 1 % high": {"sensors.displacement_scale": {f"{g}.displacement": 1.01 for g in BOTH}},
    "displacements read 2 % high": {"sensors.displacement_scale": {f"{g}.displacement": 1.02 for g in BOTH}},
    "active pressure offset 1.5 bar": {"sensors.pressure_offset": {"active.pressure_a": 1.5e5}},
    "active pressures 40 ms late": {"sensors.skew": {"active.pressure_a": 0.04, "active.pressure_b": 0.04}},
    "speed 40 ms late": {"sensors.skew": {"motor_speed": 0.04}},
    "heave 40 ms late": {"sensors.skew": {"heave_velocity": 0.04}},
    "drop-outs of 0.2 s, 2 % of the time": {"sensors.dropout_rate": 0.1, "sensors.dropout_length": 0.2},
    "load cell reads 5 % low": {"mismatch": {"reported_mass": 0.95}},
    "inertia + 20 %": {"mismatch": {"inertia": 1.2}},
    "wire stiffness - 30 %": {"mismatch": {"wire_stiffness": 0.7}},
    "wire damping a third": {"mismatch": {"wire_damping": 1.0 / 3.0}},
}


def learning_errors(truth: FrictionModel, quick: bool) -> list[list[str]]:
    """Worst error of the learned friction over the visited speed bins, and the NIS share, by error of sensors or
    plant."""
    clean = closed_loop(_case({}), truth, LEARNING_SEED, None).result().run
    lines = []
    for name, changes in list(ERRORS.items())[: 2 if quick else None]:
        estimator = FrictionEstimator(CRANE, SEED)
        closed_loop(_case(changes), truth, LEARNING_SEED, compensator(SEED), watch=estimator.step)
        errors = friction_errors(clean, truth, estimator.model())
        inside = 100.0 * float(estimator.consistency.share_inside)
        lines.append([name, f"{100.0 * max(map(abs, errors.values())):.1f} %", f"{inside:.0f} %"])
    return lines


def consistency(learned: Iterable[Learned], truth: FrictionModel, quick: bool) -> list[list[str]]:
    """NEES and the share of parameters within three stated sigma: in the cases of the study, with displacements that
    read 1 % too much or too little, and with truth and displacements drawn."""
    cases = [(drive, load, sea) for drive in DRIVES for load in LOADS for sea in SEAS][: 2 if quick else None]
    rows = {"none": list(learned)}
    for scale in (1.01, 0.99):
        rows[f"displacements x {scale:g}"] = [_learn_with(scale, truth, case) for case in cases]
    rng = np.random.default_rng(DRAWN_FROM)
    rows["drawn by 1 %, truth drawn from the seed"] = [
        _learn_with(1.0 + 0.01 * rng.standard_normal(), _drawn(rng), case) for case in cases
    ]
    lines = []
    for name, each in rows.items():
        nees, within = [one.nees for one in each], [one.within for one in each]
        worst = f"{max(nees):.0f}, {100.0 * min(within):.0f} %"
        honest = f"{mean(one.honest for one in each):.1f}"
        lines.append([name, str(len(each)), f"{mean(nees):.1f}", honest, f"{100.0 * mean(within):.0f} %", worst])
    return lines


def _learn_with(scale: float, truth: FrictionModel, case: tuple[str, float, Sea]) -> Learned:
    error = {"sensors.displacement_scale": {f"{group}.displacement": scale for group in BOTH}}
    return learn(*case, truth, {"displacement_scale": scale - 1.0}, **error)


def _drawn(rng: np.random.Generator) -> FrictionModel:
    """A truth of which the seed is an honest belief: as far from it as it says, inside its parameters' bounds."""
    bounds = np.array([SEED.bounds_of(name) for name in SEED.parameter_names])
    values = np.array(SEED.values) + np.linalg.cholesky(SEED.covariance) @ rng.standard_normal(len(SEED.values))
    return SEED.with_values(list(np.clip(values, bounds[:, 0], bounds[:, 1])))


def transfer(truth: FrictionModel, seeds: Sequence[int]) -> list[list[str]]:
    """What is learned at 55 t for other loads: the error of its friction there, and what it gains beside the truth."""
    lines = []
    for drive, name in DRIVES.items():
        model = learn(drive, LOADS[1], SEA, truth).model
        for load in (LOADS[0], LOADS[2]):
            case = scenario(drive, load, SEA)
            errors = [
                math.sqrt(
                    mean(score(closed_loop(case, truth, seed, each and compensator(each))).overall for seed in seeds)
                )
                for each in (None, model, truth)
            ]
            run = closed_loop(case, truth, LEARNING_SEED, None).result().run
            off = max(friction_errors(run, truth, model).values(), key=abs)
            gains = [f"{100.0 * (1.0 - error / errors[0]):.0f} %" for error in errors[1:]]
            lines.append([name, f"{load / 1e3:g} t", f"{100.0 * off:+.1f} %", *gains])
    return lines


def _case(changes: dict[str, Any]) -> Scenario:
    return scenario("primary", 55e3, SEA, LEARNING_PERIODS * SEA.period, **changes)
