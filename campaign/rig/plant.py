"""The winch in time: pressures, motor shaft, contacts with memory and accumulator gas, at 2 ms.

Friction is set-valued (Moreau's time stepping): at rest it is whatever holds the shaft, up to the break-away level.
"""

from math import exp, log

import numpy as np
from numba import njit

from campaign.rig.losses import (
    compliance,
    drifted,
    extra_loss,
    grown,
    line_drop,
    lost_flow,
    motor_loss,
    strange_loss,
    system_loss,
    wave,
)

STEP = 0.002  # s
GAS_EXPONENT = 1.3


@njit(cache=True)
def simulate(f, h, r, reference, heave, heave_acceleration, celsius, viscosity, out):
    """Fill `out` (rows: speed, angle, p_a, p_b, gas pressure; one column per step) for one run `r`."""
    n_total = r.drive_motors + r.passive_motors
    active = r.drive_motors * r.drive_displacement
    passive = r.passive_motors * r.passive_displacement
    drum_torque = (
        (r.load + h.tare + h.tare_wire * r.wire_mass * max(r.wire_out - h.tare_beyond, 0.0)) * 9.80665 * r.radius
    )
    static = drum_torque / r.gear
    load_inertia = (r.load + h.tare) * (r.radius / r.gear) ** 2
    mass = r.load + h.tare
    elastic = r.wire_stiffness > 0.0  # else the load is rigidly coupled to the shaft
    inertia = r.inertia + h.inertia + h.inertia_wire * max(3.0 - r.wire_out / 1000.0, 0.0)
    swept = r.drive_motors * r.drive_displacement**2 + r.passive_motors * r.passive_displacement**2
    inertia += h.inertia_oil * swept / (n_total * r.max_displacement**2) + (0.0 if elastic else load_inertia)
    heave_gain = mass * r.radius / r.gear
    stretch, load_speed = 0.0, 0.0  # beyond the static stretch; m/s, up
    drift = 1.0 + h.coulomb_drift * drifted(h, r.date)
    speed, angle, a = 0.0, 0.0, 0.0  # a: the acceleration that is asked for
    gas = r.gas_pressure * (1.0 + h.gas_warm)
    warm = 1.0 + h.gas_warm
    volume = r.gas_volume * (300e5 / r.gas_pressure)
    volume_start = volume
    start = (static - passive * (r.gas_pressure - r.boost)) / active
    p_a, p_b = max(start, 0.0) + r.boost, max(-start, 0.0) + r.boost
    known = start  # the leakage compensation's filtered pressure
    flow, bristle, second, age, memory, recent, wanted = 0.0, 0.0, 0.0, 5.0, abs(start), 0.0, 0.0
    resting = True
    share = static / r.largest_static
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
        recent += (w - recent) * STEP / 12.0
        thick = 1.0 + h.viscosity * (viscosity[k] - 1.0)
        visc = thick**h.viscosity_power
        # the line's loss lies between transducer and motor, so the motor gets less when it drives the load
        motor_flow = active * speed
        line_motor = line_drop(h, motor_flow, 1.0 if r.passive_motors > 0 else 0.0)
        dp_motor = dp - line_motor
        dp_passive = gas - r.boost - line_drop(h, passive * speed, -1.0)
        wire_out = r.wire_out - angle * r.radius / r.gear
        loss = r.drive_motors * motor_loss(f, h, r, w, abs(dp_motor), p_b, p_a + p_b, r.drive_displacement, visc, drift)
        if r.passive_motors > 0:
            loss += r.passive_motors * motor_loss(
                f, h, r, w, abs(dp_passive), r.boost, gas + r.boost, r.passive_displacement, visc, drift
            )
        loss += n_total * system_loss(f, h, w, drum_torque, visc, thick) + (h.load_loss + h.sheave) * static
        loss += n_total * h.brake * r.brake_hangs
        extra = extra_loss(h, w, speed, share)
        loss += 0.0 if h.winch_signed != 0.0 else extra
        x = r.drive_displacement / r.max_displacement
        loss += strange_loss(h, w, a, t, wire_out, celsius[k], memory, angle / r.gear, r.layer, share, x, recent)
        if h.dwell_speed > 0.0:
            loss *= 1.0 + h.dwell_gain * grown(h, age) * exp(-w / h.dwell_speed)
            if w < 0.3:
                age = age + STEP if resting else STEP
            resting = w < 0.3
        else:
            loss *= 1.0 + h.dwell_gain * grown(h, age)
            age = age * exp(-w * STEP / h.dwell_angle) + STEP
        loss = max(loss, 0.0)
        drive = active * dp_motor + passive * dp_passive - static
        if elastic:
            tip = speed * r.radius / r.gear + heave[k]
            dynamic = r.wire_stiffness * r.wire_out / wire_out * stretch + r.wire_damping * (tip - load_speed)
            load_speed += STEP / mass * dynamic
            stretch += STEP * (tip - load_speed)
            drive -= dynamic * r.radius / r.gear
        else:
            drive -= heave_gain * heave_acceleration[k]
        drive -= (h.ripple * static + h.ripple_still) * wave(h.ripple_wave, h.ripple_order * angle)
        one_way = h.asymmetry * static + (extra if h.winch_signed != 0.0 else 0.0)
        if h.presliding_angle > 0.0:
            s = 1.0 if speed >= 0.0 else -1.0
            if h.presliding_kind == 1.0:
                bristle = min(max(bristle + speed * STEP / h.presliding_angle, -1.0), 1.0)
            else:
                bristle = s + (bristle - s) * exp(-w * STEP / h.presliding_angle)
            held = bristle
            if h.presliding_kind == 2.0:
                second = s + (second - s) * exp(-w * STEP / (0.15 * h.presliding_angle))
                held = 0.5 * (bristle + second)
            speed += STEP / inertia * (drive - loss * held - one_way * (bristle if h.winch_signed == 0.0 else 1.0))
        else:
            free = speed + STEP / inertia * drive
            up = free > 0.0
            hold = max(loss + (one_way if up else -one_way), 0.0) * STEP / inertia
            if abs(free) <= hold:
                speed = 0.0
            elif up:
                speed = free - hold
            else:
                speed = free + hold
        angle += speed * STEP
        # oil: the pump's flow, what the motors swallow, leakage; the low side is tied to boost
        q = flow - active * speed - r.leakage * dp - lost_flow(h, dp, viscosity[k])
        c_a, c_b = compliance(h, p_a, r.modulus, r.line_volume), compliance(h, p_b, r.modulus, r.line_volume)
        if p_a >= p_b:
            p_b = (p_b + STEP / c_b * (r.boost_valve * r.boost - q)) / (1.0 + STEP / c_b * r.boost_valve)
            p_a += STEP / c_a * q
        else:
            p_a = (p_a + STEP / c_a * (r.boost_valve * r.boost + q)) / (1.0 + STEP / c_a * r.boost_valve)
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
        squeezed = log(volume_start / volume)
        out[5, k] = r.gas_pressure * exp((GAS_EXPONENT + h.gas_power) * squeezed + h.gas_curve * squeezed**2)


def new_output(steps: int) -> np.ndarray:
    """Room for the six recorded rows."""
    return np.empty((6, steps))
