"""Plant and controller together, period after period: the inner loop of both `simulate` and `Simulator.step`."""

import math

from winch_friction.physics.channels import GRAVITY
from winch_friction.simulation.compiling import compiled
from winch_friction.simulation.control.controller import control
from winch_friction.simulation.plant.equations import gas_pressure, reported_gas_pressure, stored_energy
from winch_friction.simulation.plant.friction_kernel import Terms
from winch_friction.simulation.plant.integrator import integrate_period
from winch_friction.simulation.plant.state import (
    ANGLE,
    COUNTED_DISPLACEMENT,
    DIRECTION,
    DRIVE,
    E_FRICTION,
    E_HEAVE,
    E_IN,
    E_LOST,
    ENCODER_STEP,
    LOAD,
    NOISE_OF_DROP,
    NOISE_OF_PASSIVE,
    P_A,
    P_B,
    PERIOD,
    PRESSURE_NOISE,
    READ_ANGLE,
    READ_DROP,
    READ_PASSIVE,
    READ_SPEED,
    SET_BOOST,
    SET_DISPLACEMENT,
    SPEED,
    TIP,
    TIP_SPEED,
    WANTED_LOAD,
    WANTED_SPEED,
)


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
    step, spread = sensing[ENCODER_STEP], sensing[PRESSURE_NOISE]
    angle = math.floor(state[ANGLE] / step + 0.5) * step if step > 0.0 else state[ANGLE]
    measured[READ_SPEED] = (angle - measured[READ_ANGLE]) / sensing[PERIOD] if step > 0.0 else state[SPEED]
    measured[READ_ANGLE] = angle
    measured[READ_DROP] = pressure_difference(p, state) + spread * noise[NOISE_OF_DROP]
    measured[READ_PASSIVE] = 0.0
    if p.passive_count > 0.0:
        measured[READ_PASSIVE] = reported_gas_pressure(p, state) - p.passive_low + spread * noise[NOISE_OF_PASSIVE]


@compiled
def pressure_difference(p, state):
    """Pressure drop over the driven group's transducers, Pa."""
    if p.secondary > 0.0:
        flow = p.count * p.displacement * state[SPEED]
        return state[DRIVE] / (p.count * p.displacement) + p.line_resistance * flow * abs(flow)
    return state[P_A] - state[P_B]


@compiled
def run_periods(
    first, count, plant, effects, controller, addresses, nominal, viscous, theta, z, gains, memory, x, state, stages,
    control_memory, measured, sensing, noise, schedule, motion, reference, oil, feedforward, history, substeps,
):  # fmt: skip
    """Advance `count` control periods from number `first`.

    `plant`, `effects`, `controller`: records in arrays of one, which numba takes in a fifth of a record's time;
    `schedule` (periods + 1, 3): displacement, the controller's, boost pressure;
    `motion` (periods + 1, 4): tip height, speed, acceleration, water surface; `reference` (periods + 1, 4): shaft
    angle, speed, acceleration, load target in m; `history` (periods + 1,): records of `state.ROW`,
    filled from `first + 1`.
    """
    p, hidden, c = plant[0], effects[0], controller[0]
    period = c.period
    terms = Terms(addresses[0], addresses[1], theta.ctypes.data, z.ctypes.data, gains.ctypes.data)
    for k in range(first, first + count):
        time = k * period
        p.displacement, p.boost_pressure = schedule[k, SET_DISPLACEMENT], schedule[k, SET_BOOST]
        c.drive_displacement = schedule[k, COUNTED_DISPLACEMENT]
        scale_viscous(p, nominal, viscous, theta, oil[k])
        sense(p, sensing, state, measured, noise[k])
        command = control(c, control_memory, reference[k], measured, feedforward[k])
        friction, tension, drum, acceleration = integrate_period(
            p, hidden, terms, z, gains, memory, x, state, stages, time, command,
            motion[k : k + 2, TIP_SPEED:], substeps, period, oil[k],
        )  # fmt: skip
        row = history[k + 1]
        record_row(p, row, state, memory, motion[k + 1], reference[k + 1], friction, tension, drum)
        row.time = time + period
        row.acceleration = acceleration
        row.command = command
        row.oil_temperature = oil[k + 1]
        row.friction_feedforward = feedforward[k]


@compiled
def record_row(p, row, state, memory, motion, reference, friction, tension, drum):
    """The record of one period: the truth."""
    dp = pressure_difference(p, state)
    pump_driven = p.secondary == 0.0
    row.shaft_angle = state[ANGLE]
    row.motor_speed = state[SPEED]
    row.pressure_a = state[P_A] if pump_driven else p.boost_pressure + max(dp, 0.0)
    row.pressure_b = state[P_B] if pump_driven else p.boost_pressure + max(-dp, 0.0)
    row.displacement = p.displacement
    row.passive_pressure_a = gas_pressure(p, state) if p.passive_count > 0.0 else 0.0
    row.passive_pressure_b = p.passive_low
    row.passive_displacement = p.passive_displacement
    row.passive_reported = reported_gas_pressure(p, state) if p.passive_count > 0.0 else 0.0
    row.friction_torque = friction
    row.position_error = state[LOAD] - reference[WANTED_LOAD]
    row.heave = state[TIP]
    row.heave_velocity = motion[TIP_SPEED]
    row.speed_reference = reference[WANTED_SPEED]
    row.drum_torque = drum
    paid_out = -p.metres_per_radian * state[ANGLE]
    row.hook_load = drum / (GRAVITY * p.radius) - (p.mass + p.wire_mass * paid_out - p.reported_mass)
    row.wire_out = p.wire_out + paid_out
    row.tension = tension
    row.direction = memory[DIRECTION]
    row.energy_in = state[E_IN]
    row.energy_heave = state[E_HEAVE]
    row.energy_friction = state[E_FRICTION]
    row.energy_lost = state[E_LOST]
    row.energy_stored = stored_energy(p, state)
