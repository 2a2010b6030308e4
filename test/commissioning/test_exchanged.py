"""Two columns that were exchanged: the motor's speed stands under another name."""

import numpy as np
import pytest

from winch_friction.commissioning.check import quick_check
from winch_friction.commissioning.kinematics import exchanged_columns
from winch_friction.physics.channels import RPM
from winch_friction.physics.signals import Run
from winch_friction.records.model_file import load_model
from winch_friction.simulation import load_scenario, simulate

TIME = np.arange(0.0, 60.0, 0.1)
SPEED = 150.0 * np.sin(TIME)
LOAD = 55e3 + 50.0 * np.cos(7.0 * TIME)


def run_of(**columns):
    return Run("lift", {"time": TIME, **columns})


@pytest.mark.parametrize(
    "told",
    [{"speed_reference": SPEED + 2.0 * np.cos(TIME)}, {"shaft_angle": np.cumsum(SPEED) * 0.1}],
)
def test_a_column_that_goes_as_the_command_or_the_angle_is_the_speed(told):
    """It was two mistakes, of a drum's speed that was not there and of psi."""
    ((said, channel, name),) = exchanged_columns([run_of(motor_speed=LOAD, hook_load=SPEED, **told)])
    assert (channel, name) == ("hook_load", "lift")
    assert said == (
        "lift: motor_speed is 5.5e+04 rad/s, and hook_load goes as the motor does: are these two columns exchanged?"
    )


@pytest.mark.parametrize(
    "columns",
    [
        {"motor_speed": SPEED, "hook_load": LOAD, "speed_reference": SPEED},
        {"motor_speed": SPEED / RPM, "hook_load": LOAD, "speed_reference": SPEED / RPM},  # rpm
        {"motor_speed": LOAD, "hook_load": SPEED},  # nothing tells it
        {"motor_speed": LOAD, "hook_load": LOAD, "speed_reference": SPEED},
        {"motor_speed": LOAD, "hook_load": np.full_like(TIME, 55e3), "speed_reference": SPEED},
        {"motor_speed": SPEED / RPM, "motor_torque": 20.0 * SPEED, "speed_reference": SPEED / RPM},  # rpm beside a drag
        {"motor_speed": LOAD, "hook_load": 100.0 * np.cos(7.0 * TIME), "speed_reference": SPEED},
        {"hook_load": SPEED, "speed_reference": SPEED},
    ],
)
def test_what_is_no_exchange_is_not_told(columns):
    assert list(exchanged_columns([run_of(**columns)])) == []


def test_it_is_said_first_and_nothing_is_guessed_beside_it(crane_150t):
    columns = dict(simulate(load_scenario("ahc_55t_215"), crane_150t, load_model("a6vm215_crane2")).run.columns)
    columns["motor_speed"], columns["hook_load"] = columns["hook_load"], columns["motor_speed"]
    found = quick_check([Run("lift", columns)], crane_150t)
    assert (found[0].severity, found[0].cause, found[0].channel, found[0].runs) == (
        "error", "exchanged", "hook_load", ("lift",))  # fmt: skip
    assert not {"unit", "scale"} & {each.cause for each in found}
