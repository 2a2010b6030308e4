"""The friction model's torque and Jacobian beside the same equations written by hand: scalar, over arrays, compiled."""

import math
from typing import Any

import numba
import numpy as np

from bench.measuring import Row, paired
from winch_friction.records.model_file import load_model

SAMPLES = 1_000_000
NOTE = "what a parameter multiplies is one bracket, which torque and derivatives share; squares and cubes are products"


def by_hand(lib: Any) -> Any:
    """Torque and its derivatives by the ten parameters of a6vm215_crane2, for two groups, as one would write them."""
    exp = lib.exp

    def torque_and_jacobian(x: Any, theta: Any) -> Any:
        s, w, drum, motors = x[0], x[1], x[3], x[10]
        k1, k2, k3, k4, k5, c1, c3, c4, c5, c6 = theta
        count = turbulence = load = mixed = 0.0
        for at in (11, 17):
            n, p, d = x[at], x[at + 1], x[at + 3]
            count += n
            turbulence += n * d * d * d
            load += n * p * d
            mixed += n * p * p
        fall = exp(-w / c4)
        level = c1 * drum + c3
        torque = (
            k1 * w * count + k2 * turbulence * w * w + k3 * load + k4 * count + k5 * mixed
            + motors * (level * fall + c5 * w + c6 * drum)
        )  # fmt: skip
        by_speed = k1 * count + 2.0 * k2 * turbulence * w + motors * (c5 - level * fall / c4)
        m = s * motors
        return (
            s * torque, s * s * by_speed, s * w * count, s * turbulence * w * w, s * load, s * count, s * mixed,
            m * drum * fall, m * fall, m * level * fall * w / (c4 * c4), m * w, m * drum,
        )  # fmt: skip

    return torque_and_jacobian


def measure(smoke: bool = False) -> list[Row]:
    """Times of ours and of the hand-written code, of the same sums over groups and the same eleven outputs."""
    model = load_model("a6vm215_crane2")
    functions, theta = model.compile(2), model.values
    groups = [6, 1e7, 2e7, 3e-5, 1.0, 1.0, 5, 1.5e7, 2e7, 3e-5, 1.0, -1.0]
    point = [0.9, 60.0, 60.0, 5e5, 0.0, 40.0, 0.0, 0.0, 1.0, 50.0, 11.0, *groups]
    count = 1000 if smoke else SAMPLES
    rows = np.tile(np.array(point)[:, None], count)
    rows[1] = np.linspace(1.0, 200.0, count)
    arrays = list(rows)
    plain, wide = by_hand(math), by_hand(np)
    same = np.allclose(functions.scalar_torque_and_gradient(point, theta, ()), plain(point, theta), rtol=1e-12)
    assert same, "the hand-written equations are not the model's"
    repeats = 50 if smoke else 20_000
    ours = functions.scalar_torque_and_gradient

    def compiled(function: Any, more: str) -> Any:
        """A loop of its own for each, so that both are inlined alike; `more` are arguments besides."""
        scope: dict[str, Any] = {"function": numba.njit(function), "numba": numba}
        indices = ", ".join(f"rows[{k}, i]" for k in range(len(point)))
        source = (
            "@numba.njit(error_model='numpy')\ndef loop(rows, theta):\n    total = 0.0\n"
            f"    for i in range(rows.shape[1]):\n        parts = function(({indices}), theta{more})\n"
            "        for part in parts:\n            total += part\n    return total\n"
        )
        exec(source, scope)  # the source is made of indices
        return scope["loop"]

    our_loop, their_loop = compiled(ours, ", ()"), compiled(plain, "")
    our_loop(rows[:, :2], theta), their_loop(rows[:, :2], theta)
    scalar = paired(
        lambda: [ours(point, theta, ()) for _ in range(repeats)],
        lambda: [plain(point, theta) for _ in range(repeats)],
        smoke,
    )
    vector = paired(
        lambda: (functions.vector_torque(arrays, theta, ()), functions.vector_gradient(arrays, theta, ())),
        lambda: wide(arrays, theta),
        smoke,
        5,
    )
    loops = paired(lambda: our_loop(rows, theta), lambda: their_loop(rows, theta), smoke, 5)
    return [
        _row("scalar, in Python", scalar, 1e6 / repeats, "us"),
        _row(f"over arrays of {count:g}", vector, 1e9 / count, "ns"),
        _row("compiled", loops, 1e9 / count, "ns"),
    ]


def _row(name: str, found: Any, factor: float, unit: str) -> Row:
    return Row(
        f"model: torque and Jacobian, {name}", found.ours * factor, unit, "the same by hand", found.theirs * factor,
        found.ratio, found.spread, at_most=1.0, note=NOTE,
    )  # fmt: skip
