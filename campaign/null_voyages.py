"""`python -m campaign.null_voyages`: drawn voyages without a fault, on which no check while learning may speak.

The friction is drawn around the seed (each parameter by a quarter), the crane file's inertia is wrong by up to 15 %;
all the shipped scenarios in which a winch moves, each long enough for the memory of the checks. Prints a table.
"""

import argparse
from dataclasses import dataclass, replace

import numpy as np

from campaign.commit import commit
from winch_friction.online.estimator import EstimatorService
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model
from winch_friction.records.topics import crane_topics
from winch_friction.simulation.scenario import load_scenario
from winch_friction.simulation.simulator import simulate

SCENARIOS = (
    "ahc_irregular", "ahc_55t_215", "ahc_calming", "ahc_harsh_sensors", "ahc_55t_160", "ahc_measured_heave",
    "ahc_secondary", "ahc_slow_pump", "ahc_swell", "normal_joystick", "warm_up", "splash_zone",
)  # fmt: skip
LENGTHS = (240.0, 400.0, 600.0)  # s
FRICTION, INERTIA = 0.25, 0.15  # relative, largest


@dataclass
class Quiet:
    """A voyage: the largest change of the drive's gain that was seen, and what was said of it with when, s."""

    scenario: str
    seconds: float
    change: float = 0.0
    said: str = ""


def sail(scenario: str, rng: np.random.Generator) -> Quiet:
    """One voyage through the estimator's service."""
    crane, seed = load_crane("crane_150t"), load_model("a6vm215_crane2")
    spread = {name: 1.0 + rng.uniform(-FRICTION, FRICTION) for name in seed.as_dict()}
    truth = seed.with_values(
        {name: float(np.clip(value * spread[name], *seed.bounds_of(name))) for name, value in seed.as_dict().items()}
    )
    real = replace(crane, inertia=crane.inertia * (1.0 + float(rng.uniform(-INERTIA, INERTIA))))
    sea = load_scenario(scenario).override({"duration": float(rng.choice(LENGTHS))})
    run = simulate(sea, real, truth, seed=int(rng.integers(1 << 20))).run
    service = EstimatorService(crane, seed, crane_topics(crane))
    samples = [each for each in run.samples() if each.motor_speed == each.motor_speed]
    quiet = Quiet(scenario, samples[-1].time - samples[0].time)
    for sample in samples:
        service.take_row(sample, sample.time)
        change = service.gain_change
        quiet.change = max(quiet.change, abs(change)) if change == change else quiet.change
        if service.contradiction and not quiet.said:
            quiet.said = f"{sample.time - samples[0].time:.0f} s: {service.contradiction}"
    return quiet


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--voyages", type=int, default=24)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    rng, alarms = np.random.default_rng(options.seed), 0
    print("| scenario | s | largest change of the drive's gain | said |\n|---|---|---|---|")
    for k in range(options.voyages):
        quiet = sail(SCENARIOS[k % len(SCENARIOS)], rng)
        alarms += bool(quiet.said)
        print(f"| {quiet.scenario} | {quiet.seconds:.0f} | {quiet.change:.3f} | {quiet.said or '-'} |", flush=True)
    print(f"\n{alarms} alarms in {options.voyages} voyages; seed {options.seed}, commit {commit()}.")


if __name__ == "__main__":
    main()
