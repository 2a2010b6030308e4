"""Plant and controller together, period after period: the inner loop of both `simulate` and `Simulator.step`."""

import math

from winch_friction.physics.units import GRAVITY
from winch_friction.simulation.compiling import compiled
from winch_friction.simulation.control.controller import control
from winch_friction.simulation.plant.equations import gas_pressure, reported_gas_pressure, stored_energy
from winch_friction.simulation.plant.integrator import integrate_period
from winch_friction.simulation.plant.state import (
    ANGLE,
    DIRECTION,
    DRIVE,
    E_FRICTION,
    E_HEAVE,
    E_IN,
    E_LOST,
    LOAD,
    P_A,
    P_B,
    SPEED,
    TIP,
)

_OIL_REFERENCE = 40.0  # degC


@compiled
def walther_viscosity(celsius):
    """Kinematic viscosity of an ISO VG 46 oil, cSt (Walther, ASTM D341: 134 cSt at 20 and 21 cSt at 60 degC)."""
    a, b = 9.312590724597092, 3.6416751935979934
    return 10.0 ** (10.0 ** (a - b * math.log10(celsius + 273.15))) - 0.7


@compiled
def scale_viscous(p, nominal, viscous, theta, oil):
    """The model's viscous parameters at the oil's temperature."""
    if p.viscosity_share == 0.0:
        return
    ratio = walther_viscosity(oil) / walther_viscosity(p.viscous_reference)
    factor = 1.0 + p.viscosity_share * (ratio - 1.0)
    for k in range(len(theta)):
        theta[k] = nominal[k] * (factor if viscous[k] else 1.0)


@compiled
def sense(p, sensing, state, measured, noise):
    """What the controller reads: encoder counts and pressures (angle, speed, dp, passive dp)."""
    step = sensing[0]
    angle = math.floor(state[ANGLE] / step + 0.5) * step if step > 0.0 else state[ANGLE]
    measured[1] = (angle - measured[0]) / sensing[2] if step > 0.0 else state[SPEED]
    measured[0] = angle
    measured[2] = pressure_difference(p, state) + sensing[1] * noise[0]
    measured[3] = (
        reported_gas_pressure(p, state) - p.passive_low + sensing[1] * noise[1] if p.passive_count > 0.0 else 0.0
    )


@compiled
def pressure_difference(p, state):
    """Pressure drop over the driven group's transducers, Pa."""
    if p.secondary > 0.0:
        flow = p.count * p.displacement * state[SPEED]
        return state[DRIVE] / (p.count * p.displacement) + p.line_resistance * flow * abs(flow)
    return state[P_A] - state[P_B]


@compiled
def run_periods(
    first, count, p, hidden, c, addresses, nominal, viscous, theta, z, gains, memory, x, state, stages, control_memory,
    measured, sensing, noise, schedule, motion, reference, oil, feedforward, history, substeps,
):  # fmt: skip
    """Advance `count` control periods from number `first`.

    `schedule` (periods + 1, 3): displacement, the controller's, boost pressure;
    `motion` (periods + 1, 4): tip height, speed, acceleration, water surface; `reference` (periods + 1, 4): shaft
    angle, speed, acceleration, load target in m; `history` (periods + 1, len(COLUMNS)): filled from row `first + 1`.
    """
    period = c.period
    for k in range(first, first + count):
        time = k * period
        p.displacement, c.drive_displacement, p.boost_pressure = schedule[k, 0], schedule[k, 1], schedule[k, 2]
        scale_viscous(p, nominal, viscous, theta, oil[k])
        sense(p, sensing, state, measured, noise[k])
        command = control(c, control_memory, reference[k], measured, feedforward[k])
        friction, tension, drum, acceleration = integrate_period(
            p, hidden, addresses, theta, z, gains, memory, x, state, stages, time, command, motion[k : k + 2, 1:],
            substeps, period, oil[k],
        )  # fmt: skip
        row = history[k + 1]
        record_row(p, row, state, memory, motion[k + 1], reference[k + 1], friction, tension, drum)
        row[0] = time + period
        row[3] = acceleration
        row[15] = command
        row[19] = oil[k + 1]
        row[22] = feedforward[k]


@compiled
def record_row(p, row, state, memory, motion, reference, friction, tension, drum):
    """One row of the truth, in the order of `state.COLUMNS`."""
    dp = pressure_difference(p, state)
    row[1] = state[ANGLE]
    row[2] = state[SPEED]
    row[4] = state[P_A] if p.secondary == 0.0 else p.boost_pressure + max(dp, 0.0)
    row[5] = state[P_B] if p.secondary == 0.0 else p.boost_pressure + max(-dp, 0.0)
    row[6] = p.displacement
    row[7] = gas_pressure(p, state) if p.passive_count > 0.0 else 0.0
    row[8] = p.passive_low
    row[9] = p.passive_displacement
    row[10] = friction
    row[11] = state[LOAD] - reference[3]
    row[12] = state[TIP]
    row[13] = motion[1]
    row[14] = reference[1]
    row[16] = drum
    paid_out = -p.metres_per_radian * state[ANGLE]
    row[17] = drum / (GRAVITY * p.radius) - (p.mass + p.wire_mass * paid_out - p.reported_mass)
    row[18] = p.wire_out - p.metres_per_radian * state[ANGLE]
    row[20] = tension
    row[21] = memory[DIRECTION]
    row[23] = state[E_IN]
    row[24] = state[E_HEAVE]
    row[25] = state[E_FRICTION]
    row[26] = state[E_LOST]
    row[27] = stored_energy(p, state)
    row[28] = reported_gas_pressure(p, state) if p.passive_count > 0.0 else 0.0
