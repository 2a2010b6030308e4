"""Ways of testing and logging a winch, drawn: loads, displacements, cycles, seas, sensors and rates."""

import numpy as np

from campaign.rig.effects import NEEDS_CHANNEL
from campaign.rig.flavour import ALL, Flavour
from campaign.rig.laws import cause_of
from campaign.rig.truth import CM3_PER_REV
from campaign.rig.world import World

RATES = (10.0, 20.0, 25.0, 50.0, 50.0, 100.0, 200.0)  # Hz


def draw_flavour(rng: np.random.Generator, world: World, effects: tuple[str, ...] = ()) -> Flavour:
    """A test plan for this crane in which these effects leave a trace."""
    needs = {NEEDS_CHANNEL.get(cause_of(each)) for each in effects}
    full = world.max_displacement / CM3_PER_REV
    cycles = int(rng.integers(4, 7))
    plateaus = np.concatenate([[0.06], rng.uniform(0.08, 0.95, cycles - 2), [1.0]])
    signed = [float(round(sign * p, 3)) for p in rng.permutation(plateaus) for sign in (1.0, -1.0)]
    several = len(world.radii) > 1 and ("several_layers" in needs or rng.random() < 0.4)
    top = len(world.radii)
    low = rng.uniform(18, 34)
    shares = np.append(np.linspace(rng.uniform(0.48, 0.65), 1.0, 6), [1.0, 0.8])
    return Flavour(
        "drawn",
        tuple(float(x) for x in rng.permutation(np.linspace(rng.uniform(2, 12), 107, 8)) * world.capacity),
        tuple(float(x) for x in rng.permutation(shares) * full),
        tuple(signed), float(rng.uniform(2.5, 6.0)), bool(rng.random() < 0.6), float(rng.uniform(1700, 2300)),
        tuple(float(x) for x in rng.uniform(15, 95, 4) * world.capacity),
        tuple(float(x) for x in rng.uniform(0.72, 1.0, 4) * full),
        bool(rng.random() < 0.6), bool(rng.random() < 0.5),
        float(rng.uniform(0.15, 0.5)), float(rng.uniform(0.0, 0.8)), float(rng.choice([0.05, 0.1, 0.15])),
        int(rng.choice([1024, 2048, 4096, 8192])), float(rng.uniform(0.0, 0.15)),
        tuple(float(x) for x in rng.uniform(16, 34, int(rng.integers(1, 4)))),
        (float(low), float(low + rng.uniform(18, 36))),
        float(rng.uniform(20, 120) if "weeks" in needs else rng.uniform(1, 90)),
        tuple(range(top - int(rng.integers(1, min(3, top - 1) + 1)), top + 1)) if several else (top,),
        ALL if "speed_reference" in needs or rng.random() < 0.7 else ALL[1:],
        jitter=float(rng.choice([0.0, 0.002])), uniform_truth=bool(rng.random() < 0.5),
        pump_lag=float(rng.uniform(0.06, 0.15)), gas_pressure=float(rng.uniform(260, 310)),
        gas_is_calculated="gas_is_calculated" in needs or bool(rng.random() < 0.2),
        pressure_is_late=bool(rng.random() < 0.4), wire_damping=float(rng.choice([0.0, 0.0, 0.06])),
        rate=float(rng.choice(RATES)), units=str(rng.choice(["plant", "si"])),
    )  # fmt: skip
