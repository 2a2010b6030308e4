"""What the plant loses at an instant: the seed's friction, the hidden effects' laws and flows that go astray."""

from math import exp, log, pi, sin, sqrt

from numba import njit

DENSITY = 870.0
NOTCH_SPEED = 400 * 2 * pi / 60
NOTCH_UNIT = NOTCH_SPEED / (2 * NOTCH_SPEED**2) * 200e5 * sqrt(200e5 / DENSITY)
FULL_SPEED, FULL_PRESSURE = 2000 * 2 * pi / 60, 200e5  # at which amounts are stated


@njit(cache=True)
def _beyond(value, threshold, scale, power):
    """A power of what lies beyond a threshold; 1 for power 0."""
    if power == 0.0:
        return 1.0
    return (max(value - threshold, 0.0) / scale) ** power


@njit(cache=True)
def motor_loss(f, h, r, w, p, p_b, p_sum, d, visc, drift):
    """Torque loss of one motor, N m."""
    x = d / r.max_displacement
    loss = f.K1 * visc * w + f.K2 * w * w * d**3 + f.K3 * p * d + f.K4 * drift + f.K5 * p * p
    loss += h.low_displacement * p * (1.0 - x) + h.mixed * p * p
    loss += h.case * p_sum + h.case_b * p_b + h.case_rest * p_sum * (1.0 - x)
    if h.turbulence != 0.0:
        n = h.turbulence_exponent
        loss += h.turbulence * f.K2 * 209.44**2 * r.max_displacement**3 * (w / 209.44) ** n * x ** (n + 1.0)
    if h.churning != 0.0:
        loss += h.churning * (w / 209.44) ** h.churning_exponent
    if h.notch != 0.0:
        loss += h.notch * x * (w / (w * w + NOTCH_SPEED**2) * p * sqrt(p / DENSITY)) / NOTCH_UNIT
    if h.motor_amount != 0.0:
        more = h.motor_amount * _beyond(w, h.motor_w0, FULL_SPEED, h.motor_w)
        more *= _beyond(p, h.motor_p0, FULL_PRESSURE, h.motor_p) * _beyond(x, 0.0, 1.0, h.motor_x)
        more *= _beyond(1.0 - x, 0.0, 1.0, h.motor_rest) * visc**h.motor_viscosity
        if h.motor_fade > 0.0:
            more *= exp(-w / h.motor_fade)
        loss += more
    return loss


@njit(cache=True)
def _falling(shape, u):
    """What is left of a rise at `u` times its speed."""
    if shape == 1.0:
        return exp(-u * u)
    if shape == 2.0:
        return 1.0 / (1.0 + u * u)
    if shape == 3.0:
        return (1.0 + u) ** -1.5
    if shape == 4.0:
        return max(1.0 - 0.5 * u, 0.0)
    if shape == 5.0:
        return exp(-sqrt(u))
    return exp(-u)


@njit(cache=True)
def system_loss(f, h, w, drum_torque, visc, thick):
    """Loss of gears, drum, wire and sheaves, per motor shaft, N m; `thick` is the oil's own relative viscosity."""
    rise = f.C1 * drum_torque + f.C3
    slow = 1.0 if h.hersey == 0.0 else thick ** (-h.hersey)
    loss = rise * exp(-w / (f.C4 * slow)) + f.C5 * visc * w + f.C6 * drum_torque
    if h.stribeck != 0.0:
        loss += h.stribeck * rise * _falling(h.stribeck_shape, w / h.stribeck_speed)
    return loss


@njit(cache=True)
def extra_loss(h, w, speed, share):
    """A loss of the whole winch that depends on load (as a share of the largest), speed and direction, N m."""
    if h.winch_amount == 0.0 or h.winch_side * speed < 0.0:
        return 0.0
    loss = h.winch_amount * _beyond(share, h.winch_load0, 1.0, h.winch_load) * _beyond(w, 0.0, FULL_SPEED, h.winch_w)
    if h.winch_hill > 0.0:  # an S of the load
        loss /= h.winch_hill**h.winch_load + share**h.winch_load
    return loss * exp(-w / h.winch_fade) if h.winch_fade > 0.0 else loss


@njit(cache=True)
def wave(kind, angle):
    """A periodic function of amplitude 1."""
    if kind == 1.0:
        turn = (angle / (2 * pi)) % 1.0
        return 4.0 * abs(turn - 0.5) - 1.0
    if kind == 2.0:
        return 0.8 * sin(angle) + 0.4 * sin(3.0 * angle)
    return sin(angle)


@njit(cache=True)
def grown(h, rest):
    """Relative growth of the break-away level after so long a rest."""
    if h.dwell_growth == 1.0:
        return log(1.0 + h.dwell_rate * rest) / log(1.0 + 20.0 * h.dwell_rate)
    if h.dwell_growth == 2.0:
        return (min(rest, 60.0) / 20.0) ** 0.4
    return 1.0 - exp(-h.dwell_rate * rest)


@njit(cache=True)
def strange_loss(h, w, a, since_start, wire_out, celsius, memory, drum_angle, layer, share, x, recent):
    """Losses that no catalogue knows, whole winch, N m."""
    loss = h.wire_drag * wire_out / 100.0 + h.seal_grip * (celsius - 40.0) / 20.0
    loss += h.run_drift * exp(-since_start / 60.0) + h.pressure_memory * memory / 100e5
    loss += h.root_speed * sqrt(w / 100.0) + h.jerkiness * abs(a) / 10.0 + h.layer_scrub * (6.0 - layer)
    loss += h.speed_bump * exp(-0.5 * ((w - 90.0) / 12.0) ** 2)
    turn = (drum_angle / (2 * pi)) % 1.0
    if turn < 0.3:
        loss += h.sector
    loss += h.power_loss * share * w / 200.0 + h.cold_load * share * max(50.0 - celsius, 0.0) / 20.0
    loss += h.groove * (1.0 + sin(2 * pi * wire_out / 9.0)) / 2.0 + h.speed_memory * recent / 100.0
    if w > 120.0:
        loss += h.fast_step
    if x > 0.8:
        loss += h.swash_step
    return loss


@njit(cache=True)
def compliance(h, p, modulus, volume):
    """dV/dp of one side, m^3/Pa: oil, and air that stiffens with pressure (adiabatic)."""
    p = max(p, 1e5)
    return volume * (1.0 / modulus + h.air / 1.4 * (1e5 / p) ** (1.0 / 1.4) / p)


@njit(cache=True)
def drifted(h, date):
    """Share of a drift that has come by a date between 0 and 1."""
    if h.drift_law == 1.0:
        return (1.0 - exp(-4.0 * date)) / (1.0 - exp(-4.0))
    if h.drift_law == 2.0:
        return log(1.0 + 30.0 * date) / log(31.0)
    if h.drift_law == 3.0:
        return 1.0 if date > h.drift_at else 0.0
    if h.drift_law == 4.0:
        return date**3
    return date


@njit(cache=True)
def line_drop(h, flow, role):
    """Pressure lost between transducer and motor, Pa; `role` is 1 of motors that drive beside passive ones, -1 of
    those, 0 of motors alone."""
    if h.line_drop == 0.0 or h.line_side * flow < 0.0 or (h.line_of != 0.0 and h.line_of != role):
        return 0.0
    if h.line_from > 0.0:
        beyond = max(abs(flow) - h.line_from * h.line_flow, 0.0)
        return h.line_drop * beyond * beyond * (1.0 if flow > 0.0 else -1.0)
    if h.line_power == 2.0:
        return h.line_drop * flow * abs(flow)
    lost = h.line_drop * h.line_flow**2 * (abs(flow) / h.line_flow) ** h.line_power
    return lost if flow > 0.0 else -lost


@njit(cache=True)
def lost_flow(h, dp, viscosity):
    """Flow lost beyond what the controller knows, m^3/s."""
    if h.leakage == 0.0:
        return 0.0
    if h.leakage_power == 1.0 and h.leakage_from == 0.0:
        return h.leakage * dp / viscosity**h.leakage_cold
    lost = (
        h.leakage * 150e5 * (max(abs(dp) - h.leakage_from, 0.0) / 150e5) ** h.leakage_power / viscosity**h.leakage_cold
    )
    return lost if dp > 0.0 else -lost
