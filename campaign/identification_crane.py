"""One seed of the identification campaign: a crane of its own, its logs, and what the practice makes of them."""

from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from scipy.stats import norm

from campaign.practice_logs import AHC, TABLE_2, TABLE_5, SensorErrors, ahc_scenario, drive_tests
from campaign.supplier_generator import LOW_DISPLACEMENT_LOSS, write_supplier_table
from winch_friction.estimation.estimator import FrictionEstimator
from winch_friction.identification.collinearity import identifiable
from winch_friction.identification.fit_data import modelled
from winch_friction.identification.friction_curve import FrictionCurve, curve_data
from winch_friction.identification.motor_identification import identify_motor, motor_seed
from winch_friction.identification.prior import UnitSpread, load_unit_spread
from winch_friction.identification.supplier_file import read_supplier_table
from winch_friction.identification.system_identification import SystemIdentification, identify_system, winch_seed
from winch_friction.identification.verification import LOW_SPEED, pressure_check, test_errors
from winch_friction.physics.channels import BAR, CM3_PER_REV
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.winch import Crane
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model
from winch_friction.simulation.scenario import load_scenario
from winch_friction.simulation.simulator import simulate

_C3_SPREAD = 0.5  # the shipped spread of C3 is 100 %, half of which would lie below zero


@dataclass(frozen=True)
class Case:
    """A crane that exists: its friction's truth, its sensors' errors, its motors' supplier fit."""

    seed: int
    crane: Crane
    truth: FrictionModel
    errors: SensorErrors
    motor: FrictionModel
    spread: UnitSpread


def case(seed: int) -> Case:
    """Crane 2 of paper 2, every parameter moved by the spread between units; sensors with their tolerances."""
    generator = np.random.default_rng([seed, 31])
    spread, crane, nominal = load_unit_spread(), load_crane("crane_150t"), load_model("a6vm215_crane2")
    relative = {**spread.relative_std, "C3": _C3_SPREAD}
    values = {
        name: value * max(1.0 + relative[name] * generator.standard_normal(), 0.1)
        for name, value in nominal.as_dict().items()
    }
    return Case(
        seed=seed,
        crane=crane,
        truth=nominal.with_values(values).with_covariance(None),
        errors=SensorErrors.drawn(generator),
        motor=supplier_motor(crane),
        spread=spread,
    )


def supplier_motor(crane: Crane) -> FrictionModel:
    """MJ4 on the shipped kind of table of the nominal 215 cm^3/rev motor."""
    with TemporaryDirectory() as folder:
        path = write_supplier_table(Path(folder) / "a6vm215.csv", 215, LOW_DISPLACEMENT_LOSS)
        found = identify_motor(read_supplier_table(path, crane.max_displacement), ["mj4"], with_complex=False)
    return motor_seed(found, "a6vm215", {})


def study(seed: int, restarts: int = 3) -> dict[str, Any]:
    """Everything that one seed contributes to the campaign."""
    given = case(seed)
    logs = drive_tests({**TABLE_2, **TABLE_5}, given.crane, given.truth, seed, given.errors)
    runs = {name: result.run for name, result in logs.items()}
    found = identify_system(
        [runs[name] for name in TABLE_2],
        given.crane,
        given.motor,
        given.spread,
        held_out=[runs[name] for name in TABLE_5],
        seed=seed,
        complex_options={"restarts": restarts},
    )
    seed_model = winch_seed(found, given.crane, "seed", {})
    models = {"first loop": found.first_loop, "second loop": found.last_loop, "joint fit": found.joint.model}
    return {
        "seed": seed,
        "held_out": {name: _held_out(model, found, given) for name, model in models.items()},
        "coverage": _coverage(found, given),
        "loops": {"fitted": [loop.cost for loop in found.loops], "held_out": list(found.held_out_costs)},
        "fits": {name: (fit.cost, fit.evaluations) for name, fit in found.fits.items()},
        "ahc": _ahc(models, given, found.joint.sensor_errors["displacement_scale"][0]),
        "consistency": {
            "sensors exact": consistency(seed_model, given, SensorErrors()),
            "sensors calibrated by the joint fit": consistency(seed_model, given, calibrated(given.errors, found)),
            "sensors with errors": consistency(seed_model, given, given.errors),
        },
    }


def _held_out(model: FrictionModel, found: SystemIdentification, given: Case) -> dict[str, float]:
    """Largest |error| on the held-out tests in % of nominal torque: against the measured T_ft and against the truth."""
    curves = [test.curve for test in found.held_out]
    worst: dict[str, float] = {}
    for error, curve in zip(test_errors(model, curves), curves, strict=True):
        against = {"measured": error.error, "truth": error.modelled - true_torque(curve, given)}
        for name, difference in against.items():
            percent = 100.0 * np.abs(difference) / error.nominal
            for side, chosen in (("above", error.speed >= LOW_SPEED), ("below", error.speed < LOW_SPEED)):
                if chosen.any():
                    key = f"{name}, {side}"
                    worst[key] = max(worst.get(key, 0.0), float(percent[chosen].max()))
    return worst


def true_torque(curve: FrictionCurve, given: Case) -> np.ndarray:
    """The crane's own T_ft per motor at the curve's speeds, at true displacement and pressure."""
    single = {**TABLE_2, **TABLE_5}[curve.test][0] * CM3_PER_REV
    pressures = {
        side: (getattr(curve, side) - given.errors.pressure_offset) / given.errors.pressure_scale
        for side in ("pressure_up", "pressure_down")
    }
    return modelled(given.truth, curve_data([replace(curve, displacement=single, **pressures)]))


def _coverage(found: SystemIdentification, given: Case) -> dict[str, float]:
    """(estimate - truth) / sigma of what the tests determine, and of every parameter."""
    model = found.joint.model
    assert model.covariance is not None
    difference = np.array(model.values) - np.array([given.truth.value(name) for name in model.parameter_names])
    rows = identifiable(model, given.crane.gear_ratio, 11)
    rows |= {f"parameter {name}": row for name, row in zip(model.parameter_names, np.eye(len(difference)), strict=True)}
    return {name: float(row @ difference / np.sqrt(row @ model.covariance @ row)) for name, row in rows.items()}


def _ahc(models: dict[str, FrictionModel], given: Case, scale: float) -> dict[str, dict[str, tuple[float, float]]]:
    """RMS of the predicted pressure, turning and over the whole run, bar; `scale` as the joint fit found it."""
    results: dict[str, dict[str, tuple[float, float]]] = {}
    for k, (name, cm3) in enumerate(AHC.items()):
        scenario = ahc_scenario(name, cm3, given.errors)
        run = simulate(scenario, given.crane, given.truth, given.seed * 100 + 50 + k).run
        scales = {"joint fit": scale}
        checks = {
            model: pressure_check(run, given.crane, each, scales.get(model, 0.0)) for model, each in models.items()
        }
        results[name] = {model: (check.moving_rms / BAR, check.rms / BAR) for model, check in checks.items()}
    return results


def consistency(seed_model: FrictionModel, given: Case, errors: SensorErrors) -> dict[str, float]:
    """NIS (mean, share of windows in their band) and NEES of the online estimator from this seed in a heave run."""
    scenario = load_scenario("ahc_55t_215").override(
        {"sensors": {"rate": 50.0, **errors.settings("active", "passive")}}
    )
    run = simulate(scenario, given.crane, given.truth, given.seed * 100 + 70).run
    estimator = FrictionEstimator(given.crane, seed_model)
    values = [estimator.step(sample) for sample in run.samples()]
    nis = np.array([each.nis for each in values if each.accepted and np.isfinite(each.nis)])
    difference = np.array([given.truth.value(name) for name in seed_model.parameter_names])
    return {
        "nis": float(nis[len(nis) // 4 :].mean()),
        "windows_inside": float(estimator.consistency.share_inside),
        "nees_seed": nees(seed_model, difference),
        "nees": nees(estimator.model(), difference),
        "dimension": len(difference),
    }


def calibrated(errors: SensorErrors, found: SystemIdentification) -> SensorErrors:
    """What is left of the sensors' errors when those that the joint fit found are taken out."""
    known = {name: value for name, (value, _) in found.joint.sensor_errors.items()}
    return SensorErrors(
        displacement_scale=errors.displacement_scale / (1.0 + known["displacement_scale"]),
        pressure_scale=errors.pressure_scale / (1.0 + known["pressure_scale"]),
        pressure_offset=errors.pressure_offset - known["pressure_offset"],
    )


def nees(model: FrictionModel, truth: np.ndarray) -> float:
    """Normalised estimation error squared of all parameters."""
    assert model.covariance is not None
    scale = model.std
    correlation = model.covariance / np.outer(scale, scale)
    error = (np.array(model.values) - truth) / scale
    return float(error @ np.linalg.pinv(correlation, rcond=1e-8, hermitian=True) @ error)


NORMAL_95 = float(norm.ppf(0.975))
