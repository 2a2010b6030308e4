"""What sensors and plant do to the learning: the closed-loop study's table of learned friction under errors that
nobody told
the estimator."""

from typing import Any

from campaign.loop_cases import (
    CRANE,
    LEARNING_PERIODS,
    LEARNING_SEED,
    SEAS,
    SEED,
    closed_loop,
    compensator,
    friction_errors,
    scenario,
)
from winch_friction.estimation import FrictionEstimator
from winch_friction.physics.friction import FrictionModel
from winch_friction.simulation.scenario import Scenario

SEA = SEAS[3]  # JONSWAP, Hs 1 m
BOTH = ("active", "passive")
ERRORS: dict[str, dict[str, Any]] = {
    "none": {},
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


def _case(changes: dict[str, Any]) -> Scenario:
    return scenario("primary", 55e3, SEA, LEARNING_PERIODS * SEA.period, **changes)
