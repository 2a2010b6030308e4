"""What one recording says of its crane in a few numbers that can be followed over years.

The gap of the torque balance while the shaft turns, measured minus modelled, is split into a share of the model's own
friction, whatever load and speed make it, and a torque that does not change sign with the motion. Seals and wear move
the first, transducers and the weight signal the second. A least-squares fit with the intervals from redrawn stretches
of time.
"""

from dataclasses import dataclass

import numpy as np

from winch_friction.discrepancy.preparation.prepare import prepare
from winch_friction.physics.corrections import corrected
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import FloatArray, Run
from winch_friction.physics.winch import Crane

STRETCH = 5.0  # s; about half a wave, so that neighbouring stretches are nearly independent
DRAWS = 200  # redrawn fits: the intervals' own error is then 5 %
FEWEST_STRETCHES = 4
TRAITS = {"friction": "%", "constant_torque": "N*m"}  # name: unit
PERCENT = 100.0


@dataclass(frozen=True)
class Trait:
    """One number of a recording with its standard deviation, in its unit."""

    name: str
    value: float
    std: float
    unit: str


def fingerprint(run: Run, crane: Crane, model: FrictionModel) -> list[Trait]:
    """The traits of a run: friction beyond the model's in % of it, and constant torque in N m at the shaft.

    Empty when too little of the run moves. Raises `InputError` where the balance lacks a channel.
    """
    run, crane = corrected(run, crane, model)
    prepared = prepare(run, crane, model)
    moving = prepared.used
    if moving.sum() < FEWEST_STRETCHES * STRETCH / prepared.dt:
        return []
    friction = np.broadcast_to(model.torque(prepared.point), prepared.gap.shape)[moving] / PERCENT
    columns = np.column_stack([friction, np.ones(int(moving.sum()))])
    stretch = (prepared.time[moving] // STRETCH).astype(int)
    values, deviations = _fit(columns, prepared.gap[moving], stretch)
    found = zip(TRAITS.items(), values.tolist(), deviations.tolist(), strict=True)
    return [Trait(name, value, std, unit) for (name, unit), value, std in found]


def _fit(columns: FloatArray, gap: FloatArray, stretch: np.ndarray) -> tuple[FloatArray, FloatArray]:
    """Least squares, and its spread over redrawn stretches from their Gram matrices."""
    _, index = np.unique(stretch, return_inverse=True)
    count = int(index.max()) + 1
    grams = np.zeros((count, columns.shape[1], columns.shape[1]))
    moments = np.zeros((count, columns.shape[1]))
    np.add.at(grams, index, columns[:, :, None] * columns[:, None, :])
    np.add.at(moments, index, columns * gap[:, None])
    weights = np.random.default_rng(0).multinomial(count, np.full(count, 1.0 / count), size=DRAWS)
    ridge = 1e-9 * np.trace(grams.sum(0)) * np.eye(columns.shape[1])
    drawn = np.linalg.solve(
        np.einsum("dk,kij->dij", weights, grams) + ridge, np.einsum("dk,ki->di", weights, moments)[:, :, None]
    )[:, :, 0]
    return np.linalg.solve(grams.sum(0) + ridge, moments.sum(0)), drawn.std(0)
