"""The control law's parts."""

import numpy as np
import pytest

from winch_friction.simulation.control.controller import control, invert_lag, spread_feedforward
from winch_friction.simulation.control.settings import CONTROL, CONTROL_STATES, DRIVE_MODEL, TICKS
from winch_friction.simulation.plant.parameters import record


def settings(**changes):
    base = {
        "mode": 1.0, "period": 0.01, "drive_displacement": 1e-4, "metres_per_radian": 0.0045, "inertia": 1.5,
        "leakage": 1.5e-11, "compressibility": 3e-11, "pump_flow": 0.0445, "torque_limit": 4000.0, "drive_lag": 0.1,
        "jerk_filter": 0.05, "damping_time": 0.5, "feedforward_ticks": 2.0,
    }  # fmt: skip
    return record(CONTROL, **{**base, **changes})[0]


def test_the_inverted_lag_reaches_what_is_wanted():
    c, memory, flow = settings(), np.zeros(CONTROL_STATES), 0.0
    wanted = 0.01 * np.sin(np.arange(200) / 30.0)
    reached = []
    for each in wanted:
        command = invert_lag(c, memory, each, 1.0)
        flow += (1.0 - np.exp(-0.1)) * (command - flow)
        reached.append(flow)
    assert np.abs(np.array(reached) - wanted).max() < 1e-12


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_saturated_pump_is_remembered(way):
    c, memory = settings(), np.zeros(CONTROL_STATES)
    assert invert_lag(c, memory, way * 0.04, 0.0445) == way * 0.0445
    assert 0.0 < way * memory[DRIVE_MODEL] < 0.04


def test_the_volume_of_a_friction_step_is_delivered():
    """Whatever the feedforward does, the compression flow adds up to compressibility times pressure."""
    c, memory = settings(leakage=0.0, pump_flow=1.0), np.zeros(CONTROL_STATES)
    flows, model_flow = [], 0.0
    for k in range(400):
        friction = -600.0 if k < 100 else 600.0
        command = control(c, memory, np.zeros(4), np.array([0.0, 0.0, 0.0, 0.0]), friction)
        model_flow += (1.0 - np.exp(-0.1)) * (command - model_flow)
        flows.append(model_flow)
    step = 1200.0 / 1e-4  # Pa
    assert sum(flows) * 0.01 == pytest.approx(3e-11 * step, rel=1e-3)


def test_a_staircase_becomes_a_ramp_without_losing_its_end():
    c, memory, out = settings(feedforward_ticks=4.0), np.zeros(CONTROL_STATES), []
    for value in [0.0] * 8 + [100.0] * 8:
        out.append(spread_feedforward(c, memory, value))
        memory[TICKS] += 1.0
    assert out[7:13] == [0.0, 25.0, 50.0, 75.0, 100.0, 100.0]


def test_open_pump_command_is_the_profile_bounded_by_the_pump():
    c = settings(mode=0.0)
    memory = np.zeros(CONTROL_STATES)
    assert control(c, memory, np.array([0.0, 50.0, 0.0, 0.0]), np.zeros(4), 500.0) == pytest.approx(5e-3)
    assert control(c, memory, np.array([0.0, 1e4, 0.0, 0.0]), np.zeros(4), 0.0) == 0.0445


def test_torque_drive_adds_load_and_friction():
    c = settings(mode=2.0, static_torque=2400.0, passive_displacement=8e-5, speed_gain=20.0, position_gain=2.5)
    measured = np.array([0.0, 0.0, 0.0, 275e5])
    command = control(c, np.zeros(CONTROL_STATES), np.zeros(4), measured, 300.0)
    assert command == pytest.approx(2400.0 - 8e-5 * 275e5 + 300.0)
    assert control(c, np.zeros(CONTROL_STATES), np.zeros(4), measured, 1e6) == 4000.0


def test_the_pump_is_where_a_bending_reference_will_be():
    """With a constant jerk the look-ahead is exact once the jerk is known: without it, or with half of it, the pump
    lags behind every crest."""
    lead, jerk = 0.1, 200.0
    c, memory = settings(leakage=0.0, compressibility=0.0, lead=lead), np.zeros(CONTROL_STATES)
    flow, behind = 0.0, []
    for k in range(100):
        time = 0.01 * k
        reference = np.array([0.0, 0.5 * jerk * time**2, jerk * time])
        command = control(c, memory, reference, np.zeros(4), 0.0)
        flow += (1.0 - np.exp(-0.1)) * (command - flow)
        behind.append(flow / 1e-4 - 0.5 * jerk * (time + lead + 0.01) ** 2)
    assert max(map(abs, behind[60:])) < 1e-3 * 0.5 * jerk
    # known within its filter's time, not at once: the jerk of a quantised command is mostly noise
    share = 1.0 - behind[6] / (-0.5 * jerk * (lead + 0.01) ** 2)
    assert 0.5 < share < 0.9
