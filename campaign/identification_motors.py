"""The motor half of the identification campaign: recovery of Table 1, two fitters, ranking of the thirteen models."""

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from campaign.supplier_generator import LOW_DISPLACEMENT_LOSS, TABLE_1, write_supplier_table
from winch_friction.identification.fit import fit
from winch_friction.identification.motor_models import MOTOR_MODELS, initial_model
from winch_friction.identification.selection import score_models
from winch_friction.identification.supplier_file import read_supplier_table
from winch_friction.identification.supplier_table import FitRange, SupplierTable, motor_points
from winch_friction.records.model_file import load_model

LOSSES = {"truth of Table 1": 0.0, "with low-displacement loss": LOW_DISPLACEMENT_LOSS}


def table_of(motor: int, loss: float) -> SupplierTable:
    """A generated table inside the papers' range."""
    with TemporaryDirectory() as folder:
        path = write_supplier_table(Path(folder) / f"a6vm{motor}.csv", motor, loss)
        return FitRange().select(read_supplier_table(path))


def fixed(table: SupplierTable) -> SupplierTable:
    """The rows at full displacement."""
    return table.where(np.isclose(table.displacement, table.max_displacement))


def recovery(motor: int) -> dict[str, Any]:
    """MJ4 on a table whose truth is Table 1: deviations in % and in standard errors, worst error in % of D dp."""
    table, truth = table_of(motor, 0.0), load_model(f"a6vm{motor}")
    model = fit(initial_model(MOTOR_MODELS["mj4"], table.max_displacement), table.fit_data()).model
    points = motor_points(table.speed, table.pressure, table.displacement)
    error = 100.0 * np.abs(model.torque(points) - table.torque_loss) / table.nominal_torque
    high = table.displacement > 150.0 / 280.0 * table.max_displacement
    return {
        "motor": motor,
        "deviation": {n: 100.0 * (model.value(n) / truth.value(n) - 1.0) for n in model.parameter_names},
        "sigmas": {
            n: (v - truth.value(n)) / s for n, v, s in zip(model.parameter_names, model.values, model.std, strict=True)
        },
        "worst_high_displacement": float(error[high].max()),
        "worst": float(error.max()),
    }


def fitters(motor: int, loss_name: str, restarts: int, limit: int) -> list[dict[str, Any]]:
    """Cost and evaluations of both fitters for all models on one motor's table, variable and fixed displacement."""
    table = table_of(motor, LOSSES[loss_name])
    rows = []
    for kind, chosen in (("variable", table), ("fixed", fixed(table))):
        data = chosen.fit_data("equal")  # the papers' cost
        spread = float(np.sum((data.torque - data.torque.mean()) ** 2))
        for name, described in MOTOR_MODELS.items():
            start = initial_model(described, table.max_displacement)
            exact = fit(start, data)
            searched = fit(start, data, "complex", seed=motor, restarts=restarts, max_evaluations=limit)
            rows.append(
                {
                    "motor": motor, "table": loss_name, "kind": kind, "model": name,
                    "parameters": exact.parameter_count, "cost": exact.cost, "cost_complex": searched.cost,
                    "evaluations": exact.evaluations, "evaluations_complex": searched.evaluations,
                    "normalised": exact.cost / spread, "rms": exact.rms,
                }
            )  # fmt: skip
    return rows


def held_out(motor: int) -> dict[str, tuple[float, int]]:
    """Held-out displacement RMS in N m and number of parameters of all models, on the shipped kind of table."""
    scores = score_models(table_of(motor, LOW_DISPLACEMENT_LOSS), list(MOTOR_MODELS), "equal")
    return {score.name: (score.held_out, score.fitted.parameter_count) for score in scores}


MOTORS = tuple(TABLE_1)
