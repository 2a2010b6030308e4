"""Of a drive whose friction nobody knows a misfit refutes nothing, but a torque that is turned round does."""

from dataclasses import replace

import numpy as np
import pytest

from winch_friction.commissioning.channels import first_contradiction
from winch_friction.commissioning.commissioning import check
from winch_friction.physics.channels import GRAVITY
from winch_friction.physics.signals import Run
from winch_friction.records.crane_file import load_crane

CRANE = """
schema: winch_friction.crane/1
name: lifeboat
drive: electric
gear_ratio: 160
drum: {layer_radii: [0.35]}
groups: {main: 2}
inertia: {value: 0.9, unit: kg*m^2}
absolute_torque_limit: {value: 120, unit: N*m}
rated_load: {value: 15, unit: t}
"""


@pytest.fixture
def crane(tmp_path):
    (tmp_path / "crane.yaml").write_text(CRANE)
    return load_crane(tmp_path / "crane.yaml")


def hoist(name, load, friction=10.0):
    """Two motors hoist and lower a load at three speeds, N m each."""
    rng = np.random.default_rng(len(name) + int(load))
    time = 0.04 * np.arange(2000)
    speed = 120.0 * np.sin(0.25 * time)
    carried = load * GRAVITY * 0.35 / 160.0 + 0.9 * np.gradient(speed, time) + friction * np.sign(speed)
    carried += load * (0.35 / 160.0) ** 2 * np.gradient(speed, time)
    torque = 0.5 * carried + 0.3 * rng.standard_normal(len(time))
    columns = {"time": time, "motor_speed": speed, "motor_torque": torque, "hook_load": np.full(len(time), load)}
    return Run(name, columns)


def runs():
    return [hoist("a", 4e3), hoist("b", 9e3), hoist("c", 14e3)]


def turned(run):
    return replace(run, columns={**run.columns, "motor_torque": -run["motor_torque"]})


def test_a_torque_of_one_run_that_is_turned_round_contradicts_the_crane(crane):
    first, *others = runs()
    assert check([first, *others], crane).plausible
    result = check([first, *others[:-1], turned(others[-1])], crane)
    assert not result.plausible
    assert result.sentence.startswith("the sign of motor_torque is flipped: positive must hold the load")
    found = first_contradiction(result.findings)
    assert found is not None
    assert (found.cause, found.runs) == ("sign", ("c",))


def test_friction_of_its_own_and_what_all_runs_have_refute_nothing(crane):
    assert check([hoist(name, load, friction=150.0) for name, load in (("a", 4e3), ("b", 9e3))], crane).plausible
    assert check([turned(each) for each in runs()], crane).plausible
