"""Equations of motion of winch, hydraulics, wire and payload (docs/simulation.md). SI, hoisting positive.

One function per part; each reads the plant's record, none knows the controller.
"""

import math

from winch_friction.physics.channels import GRAVITY
from winch_friction.simulation.compiling import inlined
from winch_friction.simulation.hidden.torque import fixed_torque, group_loss, shaft_loss
from winch_friction.simulation.plant.friction_kernel import friction_torque
from winch_friction.simulation.plant.point import Point
from winch_friction.simulation.plant.state import (
    ANGLE,
    DRIVE,
    DRIVE_RATE,
    GAS_T,
    GAS_V,
    LOAD,
    LOAD_SPEED,
    P_A,
    P_B,
    SPEED,
    TIP,
    State,
)

_ATMOSPHERE = 1.0e5  # Pa
_AIR_EXPONENT = 1.4


@inlined
def compressibility(p, pressure):
    """dV/dp of one line, m^3/Pa: oil of constant bulk modulus and free air, compressed adiabatically."""
    oil = 1.0 / p.bulk_modulus
    if p.air == 0.0:
        return p.line_volume * oil
    q = max(pressure, 0.2 * _ATMOSPHERE)
    return p.line_volume * (oil + p.air / _AIR_EXPONENT * (_ATMOSPHERE / q) ** (1.0 / _AIR_EXPONENT) / q)


@inlined
def compression_energy(p, pressure):
    """Energy in one line, J: the integral of p dV."""
    energy = 0.5 * pressure * pressure / p.bulk_modulus
    if p.air > 0.0:
        exponent = 1.0 / _AIR_EXPONENT
        energy += p.air * exponent * _ATMOSPHERE**exponent * pressure ** (1.0 - exponent) / (1.0 - exponent)
    return p.line_volume * energy


@inlined
def submerged_share(p, load, surface):
    """Share of the body under the water, 0 ... 1."""
    if p.buoyancy == 0.0:
        return 0.0
    return min(max((p.surface + surface - load) / p.body_height, 0.0), 1.0)


@inlined
def gas_pressure(p, state):
    """Pressure of the passive side's accumulator, Pa."""
    return p.gas_pressure * p.gas_volume / state[GAS_V] * state[GAS_T]


@inlined
def reported_gas_pressure(p, state):
    """What the PLC holds for the accumulator's pressure: measured, or calculated from the wire's motion, Pa."""
    if p.calculated_exponent == 0.0:
        return gas_pressure(p, state)
    volume = p.gas_volume + p.passive_count * p.passive_displacement * state[ANGLE]
    return p.gas_pressure * (p.gas_volume / volume) ** p.calculated_exponent


@inlined
def line_drop(p, flow):
    """Pressure lost between transducers and motors at a flow, Pa."""
    return p.line_resistance * flow * abs(flow)


@inlined
def wire_tension(p, state, heave_rate):
    """Tension of the elastic wire, N; none when it is slack."""
    stretch = p.mass * GRAVITY / p.wire_stiffness + state[TIP] + p.metres_per_radian * state[ANGLE] - state[LOAD]
    rate = heave_rate + p.metres_per_radian * state[SPEED] - state[LOAD_SPEED]
    if stretch <= 0.0:
        return 0.0, 0.0, rate
    elastic = p.wire_stiffness * stretch
    return elastic + p.wire_damping * rate, elastic, rate


@inlined
def drum_torque(p, state, share):
    """Static torque at the drum, m g R less buoyancy, N m; the wire that hangs out counts where it has a mass."""
    paid_out = -p.metres_per_radian * state[ANGLE]
    return ((p.mass + p.wire_mass * paid_out) * GRAVITY - share * p.buoyancy) * p.radius


@inlined
def operating_point(p, state, direction, acceleration, time, drum, oil_temperature, dp, dp_passive, passive_sum):
    """The operating point of the friction functions (the order of `physics.friction.compiled.layout`)."""
    speed = state[SPEED]
    pressure_sum = state[P_A] + state[P_B] if p.secondary == 0.0 else 2.0 * p.boost_pressure + abs(dp)
    return Point(
        direction=direction,
        speed_magnitude=abs(speed),
        speed=speed,
        drum_torque=drum,
        acceleration=acceleration,
        oil_temperature=oil_temperature,
        time=p.start_time + time,
        shaft_angle=state[ANGLE],
        wire_layer=p.layer,
        wire_out=p.wire_out - p.metres_per_radian * state[ANGLE],
        motor_total=p.count + p.passive_count,
        count_driven=p.count,
        pressure_driven=abs(dp),
        pressure_sum_driven=pressure_sum,
        displacement_driven=p.displacement,
        higher_port_driven=math.copysign(1.0, dp),
        role_driven=min(1.0 * p.passive_count, 1.0),  # none is a fraction of a motor
        count_passive=p.passive_count,
        pressure_passive=abs(dp_passive),
        pressure_sum_passive=passive_sum,
        displacement_passive=p.passive_displacement,
        higher_port_passive=math.copysign(1.0, dp_passive),
        role_passive=-1.0,
    )


@inlined
def hidden_torque(p, hidden, x, bond, model_torque, tension):
    """Friction of the hidden effects at the shaft, N m against hoisting."""
    gear_ratio = p.radius / p.metres_per_radian
    w = x.speed_magnitude
    level = shaft_loss(hidden, x.motor_total, w, x.drum_torque, gear_ratio, tension * p.metres_per_radian, x.time)
    level += group_loss(
        hidden, x.count_driven, x.pressure_driven, x.pressure_sum_driven, x.displacement_driven, p.max_displacement, w
    )
    level += group_loss(
        hidden, x.count_passive, x.pressure_passive, x.pressure_sum_passive, x.displacement_passive,
        p.max_displacement, w,
    )  # fmt: skip
    dwell = model_torque * hidden.dwell_share * bond
    return x.direction * level + dwell + fixed_torque(hidden, x.direction, x.shaft_angle, x.drum_torque, gear_ratio)


@inlined
def total_friction(p, hidden, terms, x, bond, tension):
    """Friction torque of model and hidden effects, N m against hoisting."""
    torque = friction_torque(terms.torque, x, terms.theta, terms.z)
    if hidden.present > 0.0:
        torque += hidden_torque(p, hidden, x, bond, torque, tension)
    return torque


@inlined
def motion_direction(p, bristle, speed):
    """What multiplies an opposing term: the bristle's deflection, or a smooth sign."""
    if p.direction_width > 0.0:
        return math.tanh(speed / p.direction_width)
    return bristle


@inlined
def valve_flow(p, pressure):
    """Boost inflow and relief outflow of one line, m^3/s."""
    boost = p.valve_gain * max(p.boost_pressure - pressure, 0.0)
    relief = p.valve_gain * max(pressure - p.relief_pressure, 0.0)
    return boost, relief


@inlined
def closed_loop(p, state, command):
    """Pump-controlled active loop: pump, line pressures, leakage, boost and relief.

    Returns the motors' pressure, the rates of both pressures, the drive and its rate, power put in and lost.
    """
    motor_flow = p.count * p.displacement * state[SPEED]
    across = p.count * p.leakage * (state[P_A] - state[P_B])
    boost_a, relief_a = valve_flow(p, state[P_A])
    boost_b, relief_b = valve_flow(p, state[P_B])
    case_a, case_b = p.count * p.case_leakage * state[P_A], p.count * p.case_leakage * state[P_B]
    inflow_a = state[DRIVE] - motor_flow - across - case_a + boost_a - relief_a
    inflow_b = -state[DRIVE] + motor_flow + across - case_b + boost_b - relief_b
    drop = line_drop(p, motor_flow)
    power_in = state[DRIVE] * (state[P_A] - state[P_B]) + (boost_a + boost_b) * p.boost_pressure
    lost = across * (state[P_A] - state[P_B]) + drop * motor_flow
    lost += (case_a + relief_a) * state[P_A] + (case_b + relief_b) * state[P_B]
    lost += boost_a * (p.boost_pressure - state[P_A]) + boost_b * (p.boost_pressure - state[P_B])
    drive, pull = (command - state[DRIVE]) / p.pump_lag, 0.0
    if p.pump_bandwidth > 0.0:
        drive = state[DRIVE_RATE]
        pull = p.pump_bandwidth * (command - state[DRIVE]) - 2.0 * p.pump_damping * state[DRIVE_RATE]
        pull *= p.pump_bandwidth
    rate_a, rate_b = inflow_a / compressibility(p, state[P_A]), inflow_b / compressibility(p, state[P_B])
    return state[P_A] - state[P_B] - drop, rate_a, rate_b, drive, pull, power_in, lost


@inlined
def torque_drive(p, state, command):
    """Torque-commanded drive: the pressure follows the command with a lag. Returns what `closed_loop` does."""
    drive = (command - state[DRIVE]) / p.torque_lag
    return state[DRIVE] / (p.count * p.displacement), 0.0, 0.0, drive, 0.0, state[DRIVE] * state[SPEED], 0.0


@inlined
def passive_side(p, state):
    """Passive motors on the accumulator.

    Returns their torque at the shaft, pressure and pressure sum, the rates of the gas's volume and temperature, power
    put in and lost.
    """
    if p.passive_count == 0.0:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    pressure = gas_pressure(p, state)
    motor_flow = p.passive_count * p.passive_displacement * state[SPEED]
    drop = line_drop(p, motor_flow)
    net = pressure - p.passive_low
    leak = p.passive_count * p.leakage * net
    volume_rate = motor_flow + leak - p.make_up
    heat = (1.0 - state[GAS_T]) / p.gas_time if p.gas_time > 0.0 else 0.0
    warming = -(p.gas_exponent - 1.0) * state[GAS_T] * volume_rate / state[GAS_V] + heat
    power_in = p.make_up * net - p.passive_low * volume_rate
    lost = leak * net + drop * motor_flow - p.gas_pressure * p.gas_volume / (p.gas_exponent - 1.0) * heat
    at_motors = net - drop
    torque = p.passive_count * p.passive_displacement * at_motors
    return torque, at_motors, pressure + p.passive_low, volume_rate, warming, power_in, lost


@inlined
def water_force(p, state, share):
    """Buoyancy and drag on the body, N upwards."""
    if p.buoyancy == 0.0:
        return 0.0
    return share * (p.buoyancy - p.water_drag * state[LOAD_SPEED] * abs(state[LOAD_SPEED]))


@inlined
def rates(p, hidden, terms, direction, bond, acceleration, state, time, command, heave_rate, surface, oil_temperature):
    """Time derivatives of all states, the operating point, friction torque, tension and drum torque.

    The state and what is made of it are tuples: a compiled function counts references to every array that it is given,
    at more than the equations cost.
    """
    dp, rate_a, rate_b, drive, drive_pull, power_in, lost = (
        torque_drive(p, state, command) if p.secondary > 0.0 else closed_loop(p, state, command)
    )
    passive_torque, dp_passive, passive_sum, volume_rate, warming, passive_in, passive_lost = passive_side(p, state)
    tension, elastic, stretch_rate = wire_tension(p, state, heave_rate)
    share = submerged_share(p, state[LOAD], surface)
    drum = drum_torque(p, state, share)
    direction = motion_direction(p, direction, state[SPEED])
    x = operating_point(p, state, direction, acceleration, time, drum, oil_temperature, dp, dp_passive, passive_sum)
    friction = total_friction(p, hidden, terms, x, bond, tension)
    wire_weight = -p.wire_mass * p.metres_per_radian * state[ANGLE] * GRAVITY
    torque = p.count * p.displacement * dp + passive_torque - (tension + wire_weight) * p.metres_per_radian - friction
    water = water_force(p, state, share)
    lost += passive_lost + (tension - elastic) * stretch_rate - water * state[LOAD_SPEED]
    lost += wire_weight * p.metres_per_radian * state[SPEED]
    slope = State(
        shaft_angle=state[SPEED],
        shaft_speed=torque / p.inertia,
        tip=heave_rate,
        load=state[LOAD_SPEED],
        load_speed=(tension + water) / p.mass - GRAVITY,
        pressure_a=rate_a,
        pressure_b=rate_b,
        drive=drive,
        drive_rate=drive_pull,
        gas_volume=volume_rate,
        gas_temperature=warming,
        energy_in=power_in + passive_in,
        energy_heave=tension * heave_rate,
        energy_friction=friction * state[SPEED],
        energy_lost=lost,
    )
    return slope, x, friction, tension, drum


@inlined
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
