"""How fast the simulated crane runs: times real time per core, cold start, and the cost of one step from Python.

python bench/simulator.py [--json]
"""

import json
import sys
import time
from typing import Any

from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model
from winch_friction.simulation import Simulator, load_scenario

REPEATS = 5


def measure() -> dict[str, Any]:
    """Figures of one process; times are of this process's processor, not of the wall clock, medians of five."""
    crane, model = load_crane("crane_150t"), load_model("a6vm215_crane2")
    scenario = load_scenario("ahc_irregular")
    begin = time.process_time()
    Simulator(scenario, crane, model).step(0.0)
    start = time.process_time() - begin
    whole = sorted(_whole_run(scenario, crane, model) for _ in range(REPEATS))[REPEATS // 2]
    step = sorted(_one_step(scenario, crane, model) for _ in range(REPEATS))[REPEATS // 2]
    return {
        "simulator: first step, s": start,
        "simulator: plant and controller, x real time": scenario.duration / whole,
        "simulator: one step from Python, us": 1e6 * step,
        "simulator: closed loop from Python, x real time": scenario.control_period / step,
    }


def _whole_run(scenario: Any, crane: Any, model: Any) -> float:
    simulator = Simulator(scenario, crane, model)
    begin = time.process_time()
    simulator.run()
    return time.process_time() - begin


def _one_step(scenario: Any, crane: Any, model: Any, steps: int = 5000) -> float:
    simulator = Simulator(scenario, crane, model)
    begin = time.process_time()
    for _ in range(steps):
        simulator.step(0.0)
    return (time.process_time() - begin) / steps


if __name__ == "__main__":
    figures = measure()
    if "--json" in sys.argv:
        print(json.dumps(figures))
    else:
        for name, value in figures.items():
            print(f"{name:55s} {value:10.4g}")
