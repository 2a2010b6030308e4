"""The simulated crane beside the same equations, written by hand, in `scipy.integrate.solve_ivp` at equal accuracy."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numba
import numpy as np
from scipy.integrate import solve_ivp

from bench.measuring import Row, seconds
from winch_friction.physics.channels import GRAVITY
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model
from winch_friction.simulation.scenario import load_scenario
from winch_friction.simulation.simulator import Simulator

DURATION = 20.0  # s
SIGN_WIDTH = 0.5  # rad/s; a bristle's memory would need a state of its own, with a rate of 1e4 1/s
TOLERANCES = (1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9)
REFERENCE = 1e-12
# what counts as large of angle, speed, tip, load, its speed, both pressures, pump flow, gas volume and temperature; SI
SIZES = np.array([1e3, 1e2, 1.0, 1.0, 1.0, 1e7, 1e7, 1e-2, 1.0, 1.0])
NOTE = (
    "sampled control: the command is held over 10 ms, so that solve_ivp is given steps of at most that; the loosest "
    "tolerance whose shaft speed is as near to a reference as ours"
)


@dataclass(frozen=True)
class Case:
    """A simulated heave compensation, and what drives its plant: command, heave velocity and acceleration per tick."""

    simulator: Simulator
    command: Any
    heave: Any

    @property
    def speeds(self) -> Any:
        """Our shaft speed at every tick, rad/s."""
        return self.simulator.history[:, list(self.simulator.result().truth.columns).index("motor_speed")]


def case(duration: float) -> Case:
    """The sea of `ahc_irregular`, with a smooth sign, run by the package."""
    scenario = load_scenario("ahc_irregular").override({"duration": duration, "smooth_sign": SIGN_WIDTH})
    each = Simulator(scenario, load_crane("crane_150t"), load_model("a6vm215_crane2"))
    truth = each.run().truth
    return Case(each, truth["command"][1:].copy(), np.ascontiguousarray(each.motion.tip[:, 1:3]))


def equations(simulator: Simulator) -> Callable[..., Any]:
    """Right-hand side of ten states, as one would write it for this crane and this model: closed loop, accumulator,
    elastic wire. Its constants are the plant's."""
    p = simulator._plant[0]

    def constants(names: str) -> list[float]:
        return [float(p[name]) for name in names.split()]

    count, disp, n_gas, d_gas = constants("count displacement passive_count passive_displacement")
    k_wire, d_wire, wire_mass, mass, inertia = constants("wire_stiffness wire_damping wire_mass mass inertia")
    r, radius, volume_of_line, bulk_modulus, lag = constants(
        "metres_per_radian radius line_volume bulk_modulus pump_lag"
    )
    boost, relief, gain, leak, case_leak = constants("boost_pressure relief_pressure valve_gain leakage case_leakage")
    p_gas, v_gas, exponent, t_gas = constants("gas_pressure gas_volume gas_exponent gas_time")
    low, make_up, line = constants("passive_low make_up line_resistance")
    k1, k2, k3, k4, k5, c1, c3, c4, c5, c6 = simulator.model.values
    g, width, n_all, stiffness = GRAVITY, SIGN_WIDTH, count + n_gas, volume_of_line / bulk_modulus
    warm = 1.0 / t_gas if t_gas > 0.0 else 0.0

    def rates(y: Any, command: float, heave: float, out: Any) -> None:
        angle, speed, tip, load, load_speed, a, b, flow, volume, warmth = y
        w, s = abs(speed), math.tanh(speed / width)
        stretch, rate = mass * g / k_wire + tip + r * angle - load, heave + r * speed - load_speed
        tension = k_wire * stretch + d_wire * rate if stretch > 0.0 else 0.0
        gas = p_gas * v_gas / volume * warmth
        motor_flow, gas_flow = count * disp * speed, n_gas * d_gas * speed
        dp, net = a - b - line * motor_flow * abs(motor_flow), gas - low
        dp_gas = net - line * gas_flow * abs(gas_flow)
        drum = (mass - wire_mass * r * angle) * g * radius
        loss = k3 * (count * abs(dp) * disp + n_gas * abs(dp_gas) * d_gas) + k4 * n_all + k1 * w * n_all
        loss += k2 * w * w * (count * disp**3 + n_gas * d_gas**3) + k5 * (count * dp * dp + n_gas * dp_gas * dp_gas)
        loss += n_all * ((c1 * drum + c3) * math.exp(-w / c4) + c5 * w + c6 * drum)
        torque = count * disp * dp + n_gas * d_gas * dp_gas - (tension - wire_mass * r * angle * g) * r - s * loss
        across = count * leak * (a - b)
        inflow = flow - motor_flow - across
        volume_rate = gas_flow + n_gas * leak * net - make_up
        out[0], out[1], out[2], out[3] = speed, torque / inertia, heave, load_speed
        out[4] = tension / mass - g
        out[5] = (inflow - count * case_leak * a + gain * (max(boost - a, 0.0) - max(a - relief, 0.0))) / stiffness
        out[6] = (-inflow - count * case_leak * b + gain * (max(boost - b, 0.0) - max(b - relief, 0.0))) / stiffness
        out[7] = (command - flow) / lag
        out[8], out[9] = volume_rate, -(exponent - 1.0) * warmth * volume_rate / volume + (1.0 - warmth) * warm

    return rates


def driven(function: Callable[..., Any], compile_it: bool) -> Callable[..., Any]:
    """f(t, y, command, heave, period, out): the command held, the heave a cubic through each period's ends."""
    right = numba.njit(error_model="numpy")(function) if compile_it else function

    def rates(t: float, y: Any, command: Any, heave: Any, period: float, out: Any) -> Any:
        k = min(int(t / period + 1e-9), len(command) - 1)
        f = t / period - k
        h = 1.0 - f
        tip_speed = h * h * ((1.0 + 2.0 * f) * heave[k, 0] + f * period * heave[k, 1]) + f * f * (
            (1.0 + 2.0 * h) * heave[k + 1, 0] - h * period * heave[k + 1, 1]
        )
        right(y, command[k], tip_speed, out)
        return out

    return numba.njit(error_model="numpy")(rates) if compile_it else rates


def solved(each: Case, rates: Callable[..., Any], tolerance: float, plain: bool = False) -> Any:
    """Shaft speed at every tick by LSODA, rad/s."""
    period = each.simulator.period
    start = Simulator(each.simulator.scenario, each.simulator.crane, each.simulator.model)._state
    first = np.array([start[k] for k in (0, 1, 2, 3, 4, 5, 6, 7, 9, 10)])
    out = [0.0] * 10 if plain else np.zeros(10)
    command, heave = each.command, each.heave

    def function(t: float, y: Any) -> Any:
        return rates(t, y.tolist() if plain else y, command, heave, period, out)

    ticks = np.arange(len(command) + 1) * period
    answer = solve_ivp(
        function, (0.0, ticks[-1]), first, "LSODA", ticks, rtol=tolerance, atol=tolerance * SIZES, max_step=period
    )
    return answer.y[1]


def measure(smoke: bool = False) -> list[Row]:
    """Processor time of one run by ours, and by LSODA with right-hand sides in Python and in numba."""
    each = case(1.0 if smoke else DURATION)
    function = equations(each.simulator)
    compiled, plain = driven(function, True), driven(function, False)
    reference = solved(each, compiled, REFERENCE)
    ours_error = _error(each.speeds, reference)
    near = (t for t in TOLERANCES if _error(solved(each, compiled, t), reference) <= ours_error)
    tolerance = next(near, TOLERANCES[-1])

    assert ours_error < 1e-5, "the hand-written equations are not the plant's"
    rows = []
    for language, rates, goal, repeats in (("Python", plain, 25.0, 2), ("numba", compiled, 8.0, 3)):
        theirs = partial(solved, each, rates, tolerance, language == "Python")
        times = [(seconds(_fresh_run(each)), seconds(theirs)) for _ in range(1 if smoke else repeats)]
        ratios = sorted(b / a for a, b in times)
        error = _error(theirs(), reference)
        rows.append(
            Row(
                f"simulator: a sea of {len(each.command) * each.simulator.period:g} s, {language}",
                min(a for a, _ in times), "s", f"LSODA with its right-hand side in {language}",
                min(b for _, b in times), ratios[len(ratios) // 2], (ratios[0], ratios[-1]), at_least=goal,
                note=f"{NOTE}: {tolerance:g}, error {error:.1e} against {ours_error:.1e}",
            )
        )  # fmt: skip
    return rows


def _fresh_run(each: Case) -> Callable[[], Any]:
    return Simulator(each.simulator.scenario, each.simulator.crane, each.simulator.model).run


def _error(speed: Any, reference: Any) -> float:
    """Root mean square of the difference, relative to the reference's own."""
    return float(np.sqrt(np.mean((speed - reference) ** 2) / np.mean(reference**2)))
