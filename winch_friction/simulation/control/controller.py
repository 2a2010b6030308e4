"""The control law of docs/simulation.md, once per control period.

Pump-controlled: command = D omega_ref + C_leak dp_e + C_h d(dp_e)/dt + position loop, inverted for the pump's lag, with
dp_e the expected pressure (load, inertia and friction feedforward). Torque-commanded: expected torque + both loops.
"""

import math

from winch_friction.simulation.compiling import compiled
from winch_friction.simulation.control.settings import (
    ACCELERATION,
    DRIVE_MODEL,
    EXPECTED,
    HISTORY,
    HISTORY_LENGTH,
    JERK,
    TICKS,
    WASHOUT,
)
from winch_friction.simulation.plant.state import (
    READ_ANGLE,
    READ_DROP,
    READ_PASSIVE,
    READ_SPEED,
    WANTED_ACCELERATION,
    WANTED_ANGLE,
    WANTED_SPEED,
)


@compiled
def spread_feedforward(c, memory, friction):
    """Mean of the last feedforwards: a staircase becomes a ramp, so that its slope is a flow the pump can give."""
    ticks = min(max(int(c.feedforward_ticks), 1), HISTORY_LENGTH)
    slot = int(memory[TICKS]) % ticks
    if memory[TICKS] == 0.0:
        memory[HISTORY:] = friction
    memory[HISTORY + slot] = friction
    return memory[HISTORY : HISTORY + ticks].mean()


@compiled
def extrapolate(c, memory, acceleration):
    """Filtered jerk of the reference; rad/s^3."""
    if memory[TICKS] == 0.0:
        memory[ACCELERATION] = acceleration
    weight = c.period / (c.jerk_filter + c.period)
    memory[JERK] += weight * ((acceleration - memory[ACCELERATION]) / c.period - memory[JERK])
    memory[ACCELERATION] = acceleration
    return memory[JERK]


@compiled
def invert_lag(c, memory, wanted, limit):
    """The command that brings a first-order drive to `wanted` one period on, from where its model stands."""
    keep = math.exp(-c.period / c.drive_lag)
    command = (wanted - keep * memory[DRIVE_MODEL]) / (1.0 - keep)
    command = min(max(command, -limit), limit)
    memory[DRIVE_MODEL] = keep * memory[DRIVE_MODEL] + (1.0 - keep) * command
    return command


@compiled
def pump_command(c, memory, speed_ahead, angle_error, expected, pressure):
    """Flow command of the pump-controlled drive, m^3/s."""
    if memory[TICKS] == 0.0:
        memory[EXPECTED] = expected
    compression = c.compressibility * (expected - memory[EXPECTED]) / c.period
    memory[EXPECTED] = expected
    deviation = pressure - expected
    if memory[TICKS] == 0.0:
        memory[WASHOUT] = deviation
    memory[WASHOUT] += c.period / (c.damping_time + c.period) * (deviation - memory[WASHOUT])
    damping = c.damping * (deviation - memory[WASHOUT])
    flow = c.drive_displacement * (speed_ahead + c.position_gain * angle_error)
    return invert_lag(c, memory, flow + c.leakage * expected + compression - damping, c.pump_flow)


@compiled
def torque_command(c, memory, expected_torque, speed_error, angle_error):
    """Torque command of the torque-commanded drive, N m at the shaft."""
    loop = c.speed_gain * (speed_error + c.position_gain * angle_error)
    wanted = expected_torque + loop
    return min(max(wanted, -c.torque_limit), c.torque_limit)


@compiled
def control(c, memory, reference, measured, friction):
    """One period: reference (angle, speed, acceleration), measured (angle, speed, dp, passive dp), feedforward N m."""
    if c.mode == 0.0:
        memory[TICKS] += 1.0
        return min(max(c.drive_displacement * reference[WANTED_SPEED], -c.pump_flow), c.pump_flow)
    ahead = c.lead + c.period
    jerk = extrapolate(c, memory, reference[WANTED_ACCELERATION])
    speed = reference[WANTED_SPEED] + reference[WANTED_ACCELERATION] * ahead + 0.5 * jerk * ahead * ahead
    acceleration = reference[WANTED_ACCELERATION] + jerk * ahead
    smooth = spread_feedforward(c, memory, friction)
    torque = c.static_torque - c.passive_displacement * measured[READ_PASSIVE] + c.inertia * acceleration + smooth
    angle_error = reference[WANTED_ANGLE] - measured[READ_ANGLE]
    if c.mode == 1.0:
        command = pump_command(c, memory, speed, angle_error, torque / c.drive_displacement, measured[READ_DROP])
    else:
        speed_error = reference[WANTED_SPEED] - measured[READ_SPEED]
        command = torque_command(c, memory, torque, speed_error, angle_error)
    memory[TICKS] += 1.0
    return command
