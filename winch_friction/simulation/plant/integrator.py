"""One control period of the plant: classical Runge-Kutta, the memory of friction advanced exactly in between.

A bristle's sliding rate of 10^4 1/s would break an explicit method, so its equation is solved for the speed frozen over
each step (docs/simulation.md); staggered against the states that is of second order.
"""

import math

from winch_friction.simulation.compiling import compiled
from winch_friction.simulation.plant.equations import rates
from winch_friction.simulation.plant.friction_kernel import friction_state_rates
from winch_friction.simulation.plant.point import X_ACCELERATION
from winch_friction.simulation.plant.state import DIRECTION, DWELL, SPEED, STATES

COUNT = len(STATES)  # a constant, so that the compiler unrolls its loops


@compiled
def advance_direction(z, speed, presliding, dt):
    """Dahl's bristle, dz/dt = (omega - |omega| z)/presliding, exactly for a frozen speed; z in -1 ... 1."""
    if speed == 0.0:
        return z
    target = 1.0 if speed > 0.0 else -1.0
    return target + (z - target) * math.exp(-abs(speed) * dt / presliding)


@compiled
def advance_dwell(bond, speed, hidden, dt):
    """The bond that grows with dwell and breaks by slip, 0 ... 1, exactly for a frozen speed."""
    if hidden.dwell_share == 0.0:
        return 0.0
    breaking = abs(speed) / hidden.dwell_angle
    total = hidden.dwell_rate + breaking
    target = hidden.dwell_rate / total
    return target + (bond - target) * math.exp(-total * dt)


@compiled
def advance_term_states(rates_address, x, theta, z, gains, dt):
    """States of the model's own terms with memory, exactly for frozen signals."""
    if rates_address == 0:
        return
    friction_state_rates(rates_address, x, theta, z, gains)
    for k in range(len(gains) // 2):
        exponent = gains[2 * k + 1] * dt
        weight = -math.expm1(-exponent) / exponent if exponent > 1e-12 else 1.0
        z[k] = z[k] * math.exp(-exponent) + gains[2 * k] * dt * weight


@compiled
def hermite(fraction, period, value, slope, next_value, next_slope):
    """Cubic through two ends with their slopes."""
    f = fraction
    g = 1.0 - f
    return g * g * ((1.0 + 2.0 * f) * value + f * period * slope) + f * f * (
        (1.0 + 2.0 * g) * next_value - g * period * next_slope
    )


@compiled
def integrate_period(
    p, hidden, addresses, theta, z, gains, memory, x, state, stages, time, command, heave, substeps, period, oil
):
    """Advance the state over one control period; `heave` holds (speed, acceleration, surface) at its two ends.

    Returns friction torque N m, tension N, drum torque N m and shaft acceleration rad/s^2 at the last stage.
    """
    dt = period / substeps
    friction = tension = drum = 0.0
    for step in range(substeps):
        if p.direction_width == 0.0:
            memory[DIRECTION] = advance_direction(memory[DIRECTION], state[SPEED], p.presliding, dt)
        memory[DWELL] = advance_dwell(memory[DWELL], state[SPEED], hidden, dt)
        advance_term_states(addresses[1], x, theta, z, gains, dt)
        start = step / substeps
        for stage in range(4):
            offset = 0.0 if stage == 0 else (1.0 if stage == 3 else 0.5)
            at = start + offset / substeps
            trial = stages[4]
            for k in range(COUNT):
                trial[k] = state[k] + (offset * dt * stages[stage - 1, k] if stage > 0 else 0.0)
            speed = hermite(at, period, heave[0, 0], heave[0, 1], heave[1, 0], heave[1, 1])
            surface = heave[0, 2] + at * (heave[1, 2] - heave[0, 2])
            friction, tension, drum = rates(
                p, hidden, addresses[0], theta, z, memory, x, trial, stages[stage], time + at * period, command,
                speed, surface, oil,
            )  # fmt: skip
        for k in range(COUNT):
            state[k] += dt / 6.0 * (stages[0, k] + 2.0 * stages[1, k] + 2.0 * stages[2, k] + stages[3, k])
        x[X_ACCELERATION] = stages[3, SPEED]
    return friction, tension, drum, stages[3, SPEED]
