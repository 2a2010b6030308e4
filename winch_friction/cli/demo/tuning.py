"""Today's practice at its best: the efficiency factor that leaves the least heave on the voyage's first leg, by search.

The same sea, sensors, plant and compensator as in the demo, in one process: no factor can do better there than the one
that is found.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from winch_friction.cli.demo.measures import SETTLING, rms
from winch_friction.cli.demo.plan import IN_FULL, efficiency_model
from winch_friction.compensation import CompensatorConfig, FeedforwardCompensator
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.winch.crane import Crane
from winch_friction.simulation.scenario import Scenario
from winch_friction.simulation.simulator import Simulator

LOWEST, HIGHEST = 0.5, 0.98  # a winch that loses half, or nothing to speak of
COARSE, FINE = 0.04, 0.01


@dataclass(frozen=True)
class EfficiencySearch:
    """Every factor that was tried and the residual heave RMS in m that it leaves, by growing factor."""

    efficiencies: tuple[float, ...]
    residuals: tuple[float, ...]

    @property
    def best(self) -> float:
        """The factor with the smallest residual."""
        return self.efficiencies[int(np.argmin(self.residuals))]


def search_efficiency(
    crane: Crane, truth: FrictionModel, scenario: Scenario, sea: int, progress: Callable[[float], None] | None = None
) -> EfficiencySearch:
    """The best efficiency factor of a scenario: a coarse grid, then a fine one between the neighbours of its best.

    `progress` hears each factor as it is tried. Raises `InputError` when no factor gives a finite residual.
    """
    found: dict[float, float] = {}
    for efficiency in _grid(found):
        if progress:
            progress(efficiency)
        found[efficiency] = _residual(crane, truth, scenario, sea, efficiency)
    if not np.isfinite(list(found.values())).any():
        raise InputError(f"scenario '{scenario.name}': too short to measure any heave after {SETTLING:g} s")
    ordered = sorted(found)
    return EfficiencySearch(tuple(ordered), tuple(found[each] for each in ordered))


def _grid(found: dict[float, float]) -> Iterator[float]:
    yield from np.round(np.arange(LOWEST, HIGHEST + 1e-9, COARSE), 2).tolist()
    best = min(found, key=lambda each: found[each])
    around = np.round(np.arange(best - COARSE + FINE, best + COARSE - FINE / 2, FINE), 2).tolist()
    yield from (each for each in around if each not in found and LOWEST <= each <= HIGHEST)


def efficiency_compensator(crane: Crane, efficiency: float) -> FeedforwardCompensator:
    """The compensator of the demo's efficiency phases: the factor in full."""
    return FeedforwardCompensator(crane, efficiency_model(crane, efficiency), CompensatorConfig(scale=IN_FULL))


def _residual(crane: Crane, truth: FrictionModel, scenario: Scenario, sea: int, efficiency: float) -> float:
    """Residual heave RMS in m of the closed loop with this factor, its settling left out."""
    compensator = efficiency_compensator(crane, efficiency)
    simulator, torque = Simulator(scenario, crane, truth, seed=sea), 0.0
    while not simulator.finished:
        if simulator.fresh:
            torque = compensator.step(simulator.sample).friction_torque
        simulator.step(torque)
    plant = simulator.result().truth
    return rms(plant["position_error"][plant.time - plant.time[0] >= SETTLING])
