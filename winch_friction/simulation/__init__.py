"""The simulated 150 t crane: plant, sea, controller, sensors, scenarios and hidden effects."""

from winch_friction.simulation.scenario import Scenario, load_scenario
from winch_friction.simulation.simulator import SimulationResult, Simulator, simulate

__all__ = ["Scenario", "SimulationResult", "Simulator", "load_scenario", "simulate"]
