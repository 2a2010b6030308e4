"""How fast the simulated crane runs: times real time per core, the first step, and the closed loop from Python."""

import subprocess
import sys
from statistics import median

from bench.measuring import REPEATS, Row, seconds
from bench.startup import as_installed
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model
from winch_friction.simulation.scenario import load_scenario
from winch_friction.simulation.simulator import Simulator

STEPS = 5000
FIRST_NOTE = "most of it is numba's own start: its registries and scipy.linalg, loaded with the first cached function"
FIRST_STEP = """
import time
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model
from winch_friction.simulation import Simulator, load_scenario
crane, model, scenario = load_crane("crane_150t"), load_model("a6vm215_crane2"), load_scenario("ahc_irregular")
begin = time.process_time()
Simulator(scenario, crane, model).step(0.0)
print(time.process_time() - begin)
"""


def measure(smoke: bool = False) -> list[Row]:
    """Processor time, medians; the first step in a process of its own that finds the cache filled."""
    crane, model = load_crane("crane_150t"), load_model("a6vm215_crane2")
    scenario = load_scenario("ahc_irregular").override({"duration": 5.0} if smoke else {})
    Simulator(scenario, crane, model).step(0.0)
    repeats, steps = (1, 50) if smoke else (REPEATS, STEPS)

    def stepping(each: Simulator) -> None:
        for _ in range(steps):
            each.step(0.0)

    whole = median(seconds(Simulator(scenario, crane, model).run) for _ in range(repeats))
    simulators = [Simulator(scenario, crane, model) for _ in range(repeats)]
    step = median(seconds(lambda each=each: stepping(each)) for each in simulators) / steps
    real_time, control = "x real time", scenario.control_period
    return [
        Row("simulator: first step, cache filled", _first_step(1 if smoke else 3), "s", at_most=0.3, note=FIRST_NOTE),
        Row("simulator: plant and controller", scenario.duration / whole, real_time, at_least=2000.0),
        Row("simulator: closed loop from Python", control / step, real_time, at_least=600.0),
    ]


def _first_step(repeats: int) -> float:
    def once() -> float:
        done = subprocess.run([sys.executable, "-c", FIRST_STEP], capture_output=True, check=True, env=as_installed())
        return float(done.stdout)

    if repeats > 1:
        once()  # keeps the bytecode of what is imported
    return median(once() for _ in range(repeats))
