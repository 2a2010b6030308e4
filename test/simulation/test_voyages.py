"""Voyages stay what they were: the plant's record at four ticks, written before the equations took tuples (fade1e8).

Whoever changes the physics on purpose writes the file anew and says so: `python test/simulation/test_voyages.py`.
"""

import json
from pathlib import Path

import numpy as np
import pytest

from winch_friction.physics.friction.model import FrictionModel
from winch_friction.physics.friction.term import registered_terms
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model
from winch_friction.simulation import load_scenario, simulate
from winch_friction.simulation.hidden.catalogue import effect_names

FILE = Path(__file__).with_name("voyages.json")
DURATION = 24.0  # s
TICKS = (100, 900, 1700, 2400)
EVERYTHING = "everything hidden in ahc_irregular"
MEMORY = "a term with memory in ahc_irregular"
PLAIN = (
    "ahc_irregular", "ahc_secondary", "ahc_slow_pump", "ahc_harsh_sensors", "splash_zone", "normal_joystick", "test_03",
    "experiment_boost_step",
)  # fmt: skip
NAMES = (*PLAIN, EVERYTHING, MEMORY)


def with_memory(model):
    term = next(term for term in registered_terms().values() if term.state is not None)
    values = (*model.values, *(p.typical for p in term.parameters if p.name not in model.parameter_names))
    return FrictionModel("with_memory", (*model.terms, term), values, constants=model.constants)


def voyage(name):
    crane, model = load_crane("crane_150t"), load_model("a6vm215_crane2")
    scenario = load_scenario(name if name in PLAIN else "ahc_irregular").override({"duration": DURATION})
    hidden = [(effect, 1.0) for effect in effect_names()] if name == EVERYTHING else []
    return simulate(scenario, crane, with_memory(model) if name == MEMORY else model, seed=3, hidden=hidden)


def record(result):
    """Largest magnitude of each column of truth and log, and its values at the ticks."""
    columns = {f"truth {name}": column for name, column in result.truth.columns.items()}
    columns |= {f"run {name}": column for name, column in result.run.columns.items()}
    return {name: [float(np.nanmax(np.abs(c))), *(float(v) for v in _places(c))] for name, c in columns.items()}


def _places(column):
    places = np.asarray(TICKS) * (len(column) - 1) // TICKS[-1]
    return np.nan_to_num(column[places], nan=-1e300)


@pytest.mark.parametrize("name", NAMES)
def test_a_voyage_is_what_it_was(name):
    before, now = json.loads(FILE.read_text())[name], record(voyage(name))
    assert set(before) == set(now)
    for column, (largest, *values) in before.items():
        np.testing.assert_allclose(now[column], [largest, *values], rtol=0.0, atol=1e-9 * largest, err_msg=column)


if __name__ == "__main__":
    lines = (f"{json.dumps(name)}: {json.dumps(record(voyage(name)))}" for name in NAMES)
    FILE.write_text("{\n" + ",\n".join(lines) + "\n}\n")
