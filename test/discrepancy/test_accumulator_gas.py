"""The gas of an accumulator: warmth that no single time constant follows."""

from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy.candidates.creep import gas_candidates

TIME = np.arange(0.0, 240.0, 0.1)  # s
SWELL = 180e5 + 6e5 * np.sin(0.6 * TIME)  # Pa, of the calculated pressure
PASSIVE = SimpleNamespace(
    balances=False, count=7, displacement=3e-5, pressure_sum=SWELL, logged=SWELL, pressure=SWELL - 20e5
)
RUN = SimpleNamespace(groups=[PASSIVE], time=TIME, dt=0.1)
ONE, TWO = (
    next(each for each in gas_candidates() if each.law_name == law) for law in ("", "a fast part and a slow one")
)


def left(candidate, trace):
    """Share of a trace that the best shape of a law leaves."""
    best = []
    for shape in candidate.shapes([RUN]):
        x = candidate.columns(RUN, shape.values)
        scale = np.abs(x).max(axis=0)
        best.append(np.linalg.norm(trace - x / scale @ np.linalg.lstsq(x / scale, trace, rcond=None)[0]))
    return float(min(best) / np.linalg.norm(trace))


@pytest.mark.parametrize(("power", "one", "two"), [(1.0, 1e-6, 1e-6), (0.6, 0.12, 0.07)])
def test_what_gives_its_heat_to_a_wall_that_warms_fades_in_two_parts(power, one, two):
    """0.6 is what a stretched exponential of a bottle and its rack has: one time constant leaves a tenth of it, which
    looks like a constant of the passive motors."""
    trace = PASSIVE.count * PASSIVE.displacement * SWELL * np.exp(-((TIME / 30.0) ** power))
    assert bool(left(ONE, trace) < one) is (power == 1.0)
    assert left(TWO, trace) < two


def test_both_parts_are_taken_out_of_the_same_pressure():
    estimates = {name: SimpleNamespace(value=0.01, std=1e-3) for name in ("e_T", "g_T", "e_S")}
    shape = TWO.shapes([RUN])[1]
    found = TWO.corrects(estimates, shape, SimpleNamespace(passive=("passive",)))
    assert {each.name: each.time_constant for each in found} == {
        "accumulator_warmth": 60.0, "accumulator_slow_warmth": 300.0, "accumulator_heat": 60.0,
    }  # fmt: skip
