"""Runs for round trips: every column of the contract may be there."""

import numpy as np
from hypothesis import strategies as st

from winch_friction.physics.signals import GROUP_CHANNELS, Run

SIZES = {
    "motor_speed": 200.0, "speed_reference": 200.0, "motor_torque": 500.0, "hook_load": 1e5, "heave_velocity": 3.0,
    "oil_temperature": 80.0, "wire_layer": 6.0, "wire_out": 3000.0, "shaft_angle": 1e4,
    "pressure_a": 3e7, "pressure_b": 3e6, "displacement": 3e-5,
}  # fmt: skip
OPTIONAL = tuple(name for name in SIZES if name not in (*GROUP_CHANNELS, "motor_speed"))


def make_run(name="made.csv", groups=("active",), optional=OPTIONAL, rows=60, seed=0, start=0.0):
    """A run of random numbers in the sizes of a winch, 50 Hz."""
    rng = np.random.default_rng(seed)
    columns = ["motor_speed", *optional, *(f"{g}.{channel}" for g in groups for channel in GROUP_CHANNELS)]
    data = {each: SIZES[each.rpartition(".")[2]] * rng.uniform(0.1, 1.0, rows) for each in columns}
    return Run(name, {"time": start + 0.02 * np.arange(rows), **data})


runs = st.builds(
    make_run,
    groups=st.lists(st.sampled_from(["main", "active", "passive"]), min_size=1, unique=True).map(tuple),
    optional=st.lists(st.sampled_from(OPTIONAL), unique=True).map(tuple),
    rows=st.integers(2, 40),
    seed=st.integers(0, 2**32 - 1),
    start=st.sampled_from([0.0, 12.34, 1_763_000_000.0]),
)


def same(first, second, rel=0.0, names=None):
    """Whether two runs hold the same columns with the same values (NaN equals NaN)."""
    names = set(names or first.columns)
    assert set(second.columns) == names
    for name in names:
        np.testing.assert_allclose(second[name], first[name], rtol=rel, atol=0.0, equal_nan=True, err_msg=name)
    return True
