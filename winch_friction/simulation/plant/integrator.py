"""One control period of the plant: classical Runge-Kutta, the memory of friction advanced exactly in between.

A bristle's sliding rate of 10^4 1/s would break an explicit method, so its equation is solved for the speed frozen over
each step (docs/simulation.md); staggered against the states that is of second order.
"""

import math

from winch_friction.simulation.compiling import inlined, tuple_of
from winch_friction.simulation.plant.equations import rates
from winch_friction.simulation.plant.friction_kernel import friction_state_rates
from winch_friction.simulation.plant.point import POINT_LENGTH, X_ACCELERATION, Point
from winch_friction.simulation.plant.state import DIRECTION, DWELL, SPEED, STATES

COUNT = len(STATES)  # a constant, so that the compiler unrolls its loops


@inlined
def advance_direction(z, speed, presliding, dt):
    """Dahl's bristle, dz/dt = (omega - |omega| z)/presliding, exactly for a frozen speed; z in -1 ... 1."""
    if speed == 0.0:
        return z
    target = 1.0 if speed > 0.0 else -1.0
    return target + (z - target) * math.exp(-abs(speed) * dt / presliding)


@inlined
def advance_dwell(bond, speed, hidden, dt):
    """The bond that grows with dwell and breaks by slip, 0 ... 1, exactly for a frozen speed."""
    if hidden.dwell_share == 0.0:
        return 0.0
    breaking = abs(speed) / hidden.dwell_angle
    total = hidden.dwell_rate + breaking
    target = hidden.dwell_rate / total
    return target + (bond - target) * math.exp(-total * dt)


@inlined
def advance_term_states(terms, x, z, gains, dt):
    """States of the model's own terms with memory, exactly for frozen signals."""
    friction_state_rates(terms.rates, x, terms.theta, terms.z, terms.gains)
    for k in range(len(z)):
        exponent = gains[2 * k + 1] * dt
        weight = -math.expm1(-exponent) / exponent if exponent > 1e-12 else 1.0
        z[k] = z[k] * math.exp(-exponent) + gains[2 * k] * dt * weight


@inlined
def hermite(fraction, period, value, slope, next_value, next_slope):
    """Cubic through two ends with their slopes."""
    f = fraction
    g = 1.0 - f
    return g * g * ((1.0 + 2.0 * f) * value + f * period * slope) + f * f * (
        (1.0 + 2.0 * g) * next_value - g * period * next_slope
    )


@inlined
def integrate_period(p, hidden, terms, z, gains, memory, x, state, stages, time, command, heave, substeps, period, oil):
    """Advance the state over one control period; `heave` holds (speed, acceleration, surface) at its two ends.

    `stages` (5, states): slopes of the four stages, and the state that the next of them stands on.
    Returns friction torque N m, tension N, drum torque N m and shaft acceleration rad/s^2 at the last stage.
    """
    dt = period / substeps
    friction = tension = drum = 0.0
    direction, bond, acceleration = memory[DIRECTION], memory[DWELL], x[X_ACCELERATION]
    point = Point(*tuple_of(x, POINT_LENGTH))
    trial = stages[4]
    for step in range(substeps):
        speed = state[SPEED]
        if p.direction_width == 0.0:
            direction = advance_direction(direction, speed, p.presliding, dt)
        bond = advance_dwell(bond, speed, hidden, dt)
        if terms.rates != 0:
            advance_term_states(terms, point, z, gains, dt)
        start = step / substeps
        for stage in range(4):
            offset = 0.0 if stage == 0 else (1.0 if stage == 3 else 0.5)
            at = start + offset / substeps
            for k in range(COUNT):
                trial[k] = state[k] + (offset * dt * stages[stage - 1, k] if stage > 0 else 0.0)
            speed = hermite(at, period, heave[0, 0], heave[0, 1], heave[1, 0], heave[1, 1])
            surface = heave[0, 2] + at * (heave[1, 2] - heave[0, 2])
            slope, point, friction, tension, drum = rates(
                p, hidden, terms, direction, bond, acceleration, tuple_of(trial, COUNT), time + at * period,
                command, speed, surface, oil,
            )  # fmt: skip
            for k in range(COUNT):
                stages[stage, k] = slope[k]
        for k in range(COUNT):
            state[k] += dt / 6.0 * (stages[0, k] + 2.0 * stages[1, k] + 2.0 * stages[2, k] + stages[3, k])
        acceleration = stages[3, SPEED]
    for k in range(POINT_LENGTH):
        x[k] = point[k]
    memory[DIRECTION], memory[DWELL], x[X_ACCELERATION] = direction, bond, acceleration
    return friction, tension, drum, acceleration
