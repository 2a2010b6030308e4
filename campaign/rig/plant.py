"""The winch in time: pressures, motor shaft, contacts with memory and accumulator gas, at 2 ms.

Friction is set-valued (Moreau's time stepping): at rest it is whatever holds the shaft, up to the break-away level.
"""

from math import exp, pi, sin, sqrt

import numpy as np
from numba import njit

from campaign.rig.truth import GEAR, LINE_VOLUME, MAX_DISPLACEMENT

STEP = 0.002  # s
BOOST_VALVE = 1e-8  # m^3/s/Pa
DENSITY = 870.0
NOTCH_SPEED = 400 * 2 * pi / 60
NOTCH_UNIT = NOTCH_SPEED / (2 * NOTCH_SPEED**2) * 200e5 * sqrt(200e5 / DENSITY)
GAS_EXPONENT = 1.3
GAS_VOLUME = 1.6  # m^3 at 300 bar


@njit(cache=True)
def _motor(f, h, w, p, p_sum, d, visc, drift):
    """Torque loss of one motor, N m."""
    x = d / MAX_DISPLACEMENT
    loss = f.K1 * visc * w + f.K2 * w * w * d**3 + f.K3 * p * d + f.K4 * drift + f.K5 * p * p
    loss += h.low_displacement * p * (1.0 - x) + h.mixed * p * p + h.case * p_sum
    if h.turbulence != 0.0:
        n = h.turbulence_exponent
        loss += h.turbulence * f.K2 * 209.44**2 * MAX_DISPLACEMENT**3 * (w / 209.44) ** n * x ** (n + 1.0)
    if h.churning != 0.0:
        loss += h.churning * (w / 209.44) ** h.churning_exponent
    if h.notch != 0.0:
        loss += h.notch * x * (w / (w * w + NOTCH_SPEED**2) * p * sqrt(p / DENSITY)) / NOTCH_UNIT
    return loss + h.brake


@njit(cache=True)
def _system(f, h, w, drum_torque, visc):
    """Loss of gears, drum, wire and sheaves, per motor shaft, N m."""
    rise = f.C1 * drum_torque + f.C3
    loss = rise * exp(-w / f.C4) + f.C5 * visc * w + f.C6 * drum_torque
    if h.stribeck != 0.0:
        loss += h.stribeck * rise * exp(-w / h.stribeck_speed)
    return loss


@njit(cache=True)
def _strange(h, w, a, since_start, wire_out, celsius, memory, drum_angle, layer):
    """Losses that no catalogue knows, whole winch, N m."""
    loss = h.wire_drag * wire_out / 100.0 + h.seal_grip * (celsius - 40.0) / 20.0
    loss += h.run_drift * exp(-since_start / 60.0) + h.pressure_memory * memory / 100e5
    loss += h.root_speed * sqrt(w / 100.0) + h.jerkiness * abs(a) / 10.0 + h.layer_scrub * (6.0 - layer)
    loss += h.speed_bump * exp(-0.5 * ((w - 90.0) / 12.0) ** 2)
    turn = (drum_angle / (2 * pi)) % 1.0
    if turn < 0.3:
        loss += h.sector
    return loss


@njit(cache=True)
def _compliance(h, p, modulus):
    """dV/dp of one side, m^3/Pa: oil, and air that stiffens with pressure (adiabatic)."""
    p = max(p, 1e5)
    return LINE_VOLUME * (1.0 / modulus + h.air / 1.4 * (1e5 / p) ** (1.0 / 1.4) / p)


@njit(cache=True)
def simulate(f, h, r, reference, heave, heave_acceleration, celsius, viscosity, out):
    """Fill `out` (rows: speed, angle, p_a, p_b, gas pressure; one column per step) for one run `r`."""
    n_total = r.drive_motors + r.passive_motors
    active = r.drive_motors * r.drive_displacement
    passive = r.passive_motors * r.passive_displacement
    drum_torque = (r.load + h.tare + h.tare_wire * 24.5 * r.wire_out) * 9.80665 * r.radius
    static = drum_torque / GEAR
    load_inertia = (r.load + h.tare) * (r.radius / GEAR) ** 2
    mass = r.load + h.tare
    elastic = r.wire_stiffness > 0.0  # else the load is rigidly coupled to the shaft
    inertia = r.inertia + h.inertia + (0.0 if elastic else load_inertia)
    heave_gain = mass * r.radius / GEAR
    stretch, load_speed = 0.0, 0.0  # beyond the static stretch; m/s, up
    drift = 1.0 + h.coulomb_drift * r.date
    speed, angle, a = 0.0, 0.0, 0.0  # a: the acceleration that is asked for
    gas = r.gas_pressure * (1.0 + h.gas_warm)
    warm = 1.0 + h.gas_warm
    volume = GAS_VOLUME * (300e5 / r.gas_pressure)
    volume_start = volume
    start = (static - passive * (r.gas_pressure - r.boost)) / active
    p_a, p_b = max(start, 0.0) + r.boost, max(-start, 0.0) + r.boost
    known = start  # the leakage compensation's filtered pressure
    flow, bristle, age, memory, wanted = 0.0, 0.0, 5.0, abs(start), 0.0
    for k in range(len(reference)):
        t = k * STEP
        wanted += reference[k] * STEP
        if k > 0:
            a += ((reference[k] - reference[k - 1]) / STEP - a) * STEP / 0.1
        command = active * (reference[k] + r.position_gain * (wanted - angle)) + r.leakage * known
        flow += (command - flow) * STEP / r.pump_lag
        dp = p_a - p_b
        known += (dp - known) * STEP / 0.5
        memory += (abs(dp) - memory) * STEP / 30.0
        w = abs(speed)
        visc = 1.0 + h.viscosity * (viscosity[k] - 1.0)
        # the line's loss lies between transducer and motor, so the motor gets less when it drives the load
        motor_flow = active * speed
        line_motor = h.line_drop * motor_flow * abs(motor_flow)
        dp_motor = dp - line_motor
        dp_passive = gas - r.boost - h.line_drop * (passive * speed) * abs(passive * speed)
        wire_out = r.wire_out - angle * r.radius / GEAR
        loss = r.drive_motors * _motor(f, h, w, abs(dp_motor), p_a + p_b, r.drive_displacement, visc, drift)
        if r.passive_motors > 0:
            loss += r.passive_motors * _motor(
                f, h, w, abs(dp_passive), gas + r.boost, r.passive_displacement, visc, drift
            )
        loss += n_total * _system(f, h, w, drum_torque, visc) + (h.load_loss + h.sheave) * static
        loss += _strange(h, w, a, t, wire_out, celsius[k], memory, angle / GEAR, r.layer)
        loss *= 1.0 + h.dwell_gain * (1.0 - exp(-h.dwell_rate * age))
        loss = max(loss, 0.0)
        age = age * exp(-w * STEP / h.dwell_angle) + STEP
        drive = active * dp_motor + passive * dp_passive - static
        if elastic:
            tip = speed * r.radius / GEAR + heave[k]
            dynamic = r.wire_stiffness * stretch + r.wire_damping * (tip - load_speed)
            load_speed += STEP / mass * dynamic
            stretch += STEP * (tip - load_speed)
            drive -= dynamic * r.radius / GEAR
        else:
            drive -= heave_gain * heave_acceleration[k]
        drive -= h.ripple * static * sin(h.ripple_order * angle)
        if h.presliding_angle > 0.0:
            s = 1.0 if speed >= 0.0 else -1.0
            bristle = s + (bristle - s) * exp(-w * STEP / h.presliding_angle)
            speed += STEP / inertia * (drive - loss * bristle - h.asymmetry * static * bristle)
        else:
            free = speed + STEP / inertia * drive
            up = free > 0.0
            hold = max(loss + (h.asymmetry * static if up else -h.asymmetry * static), 0.0) * STEP / inertia
            if abs(free) <= hold:
                speed = 0.0
            elif up:
                speed = free - hold
            else:
                speed = free + hold
        angle += speed * STEP
        # oil: the pump's flow, what the motors swallow, leakage; the low side is tied to boost
        q = flow - active * speed - (r.leakage + h.leakage / viscosity[k]) * dp
        c_a, c_b = _compliance(h, p_a, r.modulus), _compliance(h, p_b, r.modulus)
        if p_a >= p_b:
            p_b = (p_b + STEP / c_b * (BOOST_VALVE * r.boost - q)) / (1.0 + STEP / c_b * BOOST_VALVE)
            p_a += STEP / c_a * q
        else:
            p_a = (p_a + STEP / c_a * (BOOST_VALVE * r.boost + q)) / (1.0 + STEP / c_a * BOOST_VALVE)
            p_b -= STEP / c_b * q
        p_a, p_b = max(p_a, 0.0), max(p_b, 0.0)
        if r.passive_motors > 0:
            volume += passive * speed * STEP
            ratio = (volume_start / volume) ** GAS_EXPONENT
            if h.gas_time > 0.0:
                # p V = m R T: compression heats, the bottle's wall takes the heat away
                warm += -(GAS_EXPONENT - 1.0) * warm * passive * speed * STEP / volume
                warm -= (warm - 1.0) * STEP / h.gas_time
                gas = r.gas_pressure * warm * volume_start / volume
            else:
                gas = r.gas_pressure * ratio
        out[0, k] = speed
        out[1, k] = angle
        out[2, k] = p_a
        out[3, k] = p_b
        out[4, k] = gas
        out[5, k] = r.gas_pressure * (volume_start / volume) ** GAS_EXPONENT


def new_output(steps: int) -> np.ndarray:
    """Room for the six recorded rows."""
    return np.empty((6, steps))
