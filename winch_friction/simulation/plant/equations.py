"""Equations of motion of winch, hydraulics, wire and payload (docs/simulation.md). SI, hoisting positive.

One function per part; each reads the plant's record, none knows the controller.
"""

import math

from winch_friction.physics.units import GRAVITY
from winch_friction.simulation.compiling import compiled
from winch_friction.simulation.hidden.torque import fixed_torque, group_loss, shaft_loss
from winch_friction.simulation.plant.friction_kernel import friction_torque
from winch_friction.simulation.plant.point import (
    GROUPS,
    STRIDE,
    X_ANGLE,
    X_COUNT,
    X_DIRECTION,
    X_DISPLACEMENT,
    X_DRUM,
    X_LAYER,
    X_MAGNITUDE,
    X_MOTORS,
    X_OIL,
    X_PRESSURE,
    X_PRESSURE_SUM,
    X_SPEED,
    X_TIME,
    X_WIRE,
)
from winch_friction.simulation.plant.state import (
    ANGLE,
    DIRECTION,
    DRIVE,
    DRIVE_RATE,
    DWELL,
    E_FRICTION,
    E_HEAVE,
    E_IN,
    E_LOST,
    GAS_T,
    GAS_V,
    LOAD,
    LOAD_SPEED,
    P_A,
    P_B,
    SPEED,
    TIP,
)

_ATMOSPHERE = 1.0e5  # Pa
_AIR_EXPONENT = 1.4


@compiled
def compressibility(p, pressure):
    """dV/dp of one line, m^3/Pa: oil of constant bulk modulus and free air, compressed adiabatically."""
    oil = 1.0 / p.bulk_modulus
    if p.air == 0.0:
        return p.line_volume * oil
    q = max(pressure, 0.2 * _ATMOSPHERE)
    return p.line_volume * (oil + p.air / _AIR_EXPONENT * (_ATMOSPHERE / q) ** (1.0 / _AIR_EXPONENT) / q)


@compiled
def compression_energy(p, pressure):
    """Energy in one line, J: the integral of p dV."""
    energy = 0.5 * pressure * pressure / p.bulk_modulus
    if p.air > 0.0:
        exponent = 1.0 / _AIR_EXPONENT
        energy += p.air * exponent * _ATMOSPHERE**exponent * pressure ** (1.0 - exponent) / (1.0 - exponent)
    return p.line_volume * energy


@compiled
def submerged_share(p, load, surface):
    """Share of the body under the water, 0 ... 1."""
    if p.buoyancy == 0.0:
        return 0.0
    return min(max((p.surface + surface - load) / p.body_height, 0.0), 1.0)


@compiled
def gas_pressure(p, state):
    """Pressure of the passive side's accumulator, Pa."""
    return p.gas_pressure * p.gas_volume / state[GAS_V] * state[GAS_T]


@compiled
def reported_gas_pressure(p, state):
    """What the PLC holds for the accumulator's pressure: measured, or calculated from the wire's motion, Pa."""
    if p.calculated_exponent == 0.0:
        return gas_pressure(p, state)
    volume = p.gas_volume + p.passive_count * p.passive_displacement * state[ANGLE]
    return p.gas_pressure * (p.gas_volume / volume) ** p.calculated_exponent


@compiled
def line_drop(p, flow):
    """Pressure lost between transducers and motors at a flow, Pa."""
    return p.line_resistance * flow * abs(flow)


@compiled
def wire_tension(p, state, heave_rate):
    """Tension of the elastic wire, N; none when it is slack."""
    stretch = p.mass * GRAVITY / p.wire_stiffness + state[TIP] + p.metres_per_radian * state[ANGLE] - state[LOAD]
    rate = heave_rate + p.metres_per_radian * state[SPEED] - state[LOAD_SPEED]
    if stretch <= 0.0:
        return 0.0, 0.0, rate
    elastic = p.wire_stiffness * stretch
    return elastic + p.wire_damping * rate, elastic, rate


@compiled
def drum_torque(p, state, share):
    """Static torque at the drum, m g R less buoyancy, N m; the wire that hangs out counts where it has a mass."""
    paid_out = -p.metres_per_radian * state[ANGLE]
    return ((p.mass + p.wire_mass * paid_out) * GRAVITY - share * p.buoyancy) * p.radius


@compiled
def fill_operating_point(p, state, x, direction, time, drum, layer, oil_temperature, dp, dp_passive, passive_sum):
    """The operating point of the friction functions (the order of `physics.friction.symbols.layout`)."""
    speed = state[SPEED]
    x[X_DIRECTION] = direction
    x[X_MAGNITUDE] = abs(speed)
    x[X_SPEED] = speed
    x[X_DRUM] = drum
    x[X_OIL] = oil_temperature
    x[X_TIME] = p.start_time + time
    x[X_ANGLE] = state[ANGLE]
    x[X_LAYER] = layer
    x[X_WIRE] = p.wire_out - p.metres_per_radian * state[ANGLE]
    x[X_MOTORS] = p.count + p.passive_count
    x[X_COUNT] = p.count
    x[X_PRESSURE] = abs(dp)
    x[X_PRESSURE_SUM] = state[P_A] + state[P_B] if p.secondary == 0.0 else 2.0 * p.boost_pressure + abs(dp)
    x[X_DISPLACEMENT] = p.displacement
    x[X_COUNT + STRIDE] = p.passive_count
    x[X_PRESSURE + STRIDE] = abs(dp_passive)
    x[X_PRESSURE_SUM + STRIDE] = passive_sum
    x[X_DISPLACEMENT + STRIDE] = p.passive_displacement


@compiled
def hidden_torque(p, hidden, state, x, memory, direction, model_torque, tension):
    """Friction of the hidden effects at the shaft, N m against hoisting."""
    gear_ratio = p.radius / p.metres_per_radian
    w = x[X_MAGNITUDE]
    level = shaft_loss(hidden, x[X_MOTORS], w, x[X_DRUM], gear_ratio, tension * p.metres_per_radian, x[X_TIME])
    for group in range(GROUPS):
        at = group * STRIDE
        level += group_loss(
            hidden, x[X_COUNT + at], x[X_PRESSURE + at], x[X_PRESSURE_SUM + at], x[X_DISPLACEMENT + at],
            p.max_displacement, w,
        )  # fmt: skip
    dwell = model_torque * hidden.dwell_share * memory[DWELL]
    return direction * level + dwell + fixed_torque(hidden, direction, state[ANGLE], x[X_DRUM], gear_ratio)


@compiled
def total_friction(p, hidden, address, x, theta, z, memory, state, tension):
    """Friction torque of model and hidden effects, N m against hoisting."""
    torque = friction_torque(address, x, theta, z)
    if hidden.present > 0.0:
        torque += hidden_torque(p, hidden, state, x, memory, x[X_DIRECTION], torque, tension)
    return torque


@compiled
def motion_direction(p, memory, speed):
    """What multiplies an opposing term: the bristle's deflection, or a smooth sign."""
    if p.direction_width > 0.0:
        return math.tanh(speed / p.direction_width)
    return memory[DIRECTION]


@compiled
def valve_flow(p, pressure):
    """Boost inflow and relief outflow of one line, m^3/s."""
    boost = p.valve_gain * max(p.boost_pressure - pressure, 0.0)
    relief = p.valve_gain * max(pressure - p.relief_pressure, 0.0)
    return boost, relief


@compiled
def closed_loop(p, state, rate, command):
    """Pump-controlled active loop: pump, line pressures, leakage, boost and relief. Returns the motors' pressure."""
    motor_flow = p.count * p.displacement * state[SPEED]
    across = p.count * p.leakage * (state[P_A] - state[P_B])
    boost_a, relief_a = valve_flow(p, state[P_A])
    boost_b, relief_b = valve_flow(p, state[P_B])
    case_a, case_b = p.count * p.case_leakage * state[P_A], p.count * p.case_leakage * state[P_B]
    inflow_a = state[DRIVE] - motor_flow - across - case_a + boost_a - relief_a
    inflow_b = -state[DRIVE] + motor_flow + across - case_b + boost_b - relief_b
    rate[P_A] = inflow_a / compressibility(p, state[P_A])
    rate[P_B] = inflow_b / compressibility(p, state[P_B])
    drop = line_drop(p, motor_flow)
    rate[E_IN] += state[DRIVE] * (state[P_A] - state[P_B]) + (boost_a + boost_b) * p.boost_pressure
    rate[E_LOST] += across * (state[P_A] - state[P_B]) + drop * motor_flow
    rate[E_LOST] += (case_a + relief_a) * state[P_A] + (case_b + relief_b) * state[P_B]
    rate[E_LOST] += boost_a * (p.boost_pressure - state[P_A]) + boost_b * (p.boost_pressure - state[P_B])
    if p.pump_bandwidth > 0.0:
        rate[DRIVE] = state[DRIVE_RATE]
        pull = p.pump_bandwidth * (command - state[DRIVE]) - 2.0 * p.pump_damping * state[DRIVE_RATE]
        rate[DRIVE_RATE] = p.pump_bandwidth * pull
    else:
        rate[DRIVE] = (command - state[DRIVE]) / p.pump_lag
        rate[DRIVE_RATE] = 0.0
    return state[P_A] - state[P_B] - drop


@compiled
def torque_drive(p, state, rate, command):
    """Torque-commanded drive: the pressure follows the command with a lag. Returns the motors' pressure."""
    rate[P_A] = 0.0
    rate[P_B] = 0.0
    rate[DRIVE] = (command - state[DRIVE]) / p.torque_lag
    rate[DRIVE_RATE] = 0.0
    rate[E_IN] += state[DRIVE] * state[SPEED]
    return state[DRIVE] / (p.count * p.displacement)


@compiled
def passive_side(p, state, rate):
    """Passive motors on the accumulator. Returns their torque at the shaft, pressure and pressure sum."""
    if p.passive_count == 0.0:
        rate[GAS_V] = 0.0
        rate[GAS_T] = 0.0
        return 0.0, 0.0, 0.0
    pressure = gas_pressure(p, state)
    motor_flow = p.passive_count * p.passive_displacement * state[SPEED]
    drop = line_drop(p, motor_flow)
    net = pressure - p.passive_low
    leak = p.passive_count * p.leakage * net
    volume_rate = motor_flow + leak - p.make_up
    heat = (1.0 - state[GAS_T]) / p.gas_time if p.gas_time > 0.0 else 0.0
    rate[GAS_V] = volume_rate
    rate[GAS_T] = -(p.gas_exponent - 1.0) * state[GAS_T] * volume_rate / state[GAS_V] + heat
    rate[E_IN] += p.make_up * net - p.passive_low * volume_rate
    rate[E_LOST] += leak * net + drop * motor_flow
    rate[E_LOST] -= p.gas_pressure * p.gas_volume / (p.gas_exponent - 1.0) * heat
    at_motors = net - drop
    return p.passive_count * p.passive_displacement * at_motors, at_motors, pressure + p.passive_low


@compiled
def water_force(p, state, share):
    """Buoyancy and drag on the body, N upwards."""
    if p.buoyancy == 0.0:
        return 0.0
    return share * (p.buoyancy - p.water_drag * state[LOAD_SPEED] * abs(state[LOAD_SPEED]))


@compiled
def rates(p, hidden, address, theta, z, memory, x, state, rate, time, command, heave_rate, surface, oil_temperature):
    """Time derivatives of all states into `rate`. Returns friction torque, tension, drum torque."""
    rate[E_IN] = rate[E_LOST] = 0.0  # the only ones that are summed
    dp = torque_drive(p, state, rate, command) if p.secondary > 0.0 else closed_loop(p, state, rate, command)
    passive_torque, dp_passive, passive_sum = passive_side(p, state, rate)
    tension, elastic, stretch_rate = wire_tension(p, state, heave_rate)
    share = submerged_share(p, state[LOAD], surface)
    drum = drum_torque(p, state, share)
    direction = motion_direction(p, memory, state[SPEED])
    fill_operating_point(p, state, x, direction, time, drum, p.layer, oil_temperature, dp, dp_passive, passive_sum)
    friction = total_friction(p, hidden, address, x, theta, z, memory, state, tension)
    wire_weight = -p.wire_mass * p.metres_per_radian * state[ANGLE] * GRAVITY
    torque = p.count * p.displacement * dp + passive_torque - (tension + wire_weight) * p.metres_per_radian - friction
    water = water_force(p, state, share)
    rate[ANGLE] = state[SPEED]
    rate[SPEED] = torque / p.inertia
    rate[TIP] = heave_rate
    rate[LOAD] = state[LOAD_SPEED]
    rate[LOAD_SPEED] = (tension + water) / p.mass - GRAVITY
    rate[E_HEAVE] = tension * heave_rate
    rate[E_FRICTION] = friction * state[SPEED]
    rate[E_LOST] += (tension - elastic) * stretch_rate - water * state[LOAD_SPEED]
    rate[E_LOST] += wire_weight * p.metres_per_radian * state[SPEED]
    return friction, tension, drum


@compiled
def stored_energy(p, state):
    """Kinetic, potential, elastic, hydraulic and gas energy, J."""
    stretch = p.mass * GRAVITY / p.wire_stiffness + state[TIP] + p.metres_per_radian * state[ANGLE] - state[LOAD]
    energy = 0.5 * p.inertia * state[SPEED] ** 2 + 0.5 * p.mass * state[LOAD_SPEED] ** 2
    energy += p.mass * GRAVITY * state[LOAD] + 0.5 * p.wire_stiffness * max(stretch, 0.0) ** 2
    if p.secondary == 0.0:
        energy += compression_energy(p, state[P_A]) + compression_energy(p, state[P_B])
    if p.passive_count > 0.0:
        energy += p.gas_pressure * p.gas_volume / (p.gas_exponent - 1.0) * state[GAS_T]
    return energy
