"""Least squares inside a box, solved exactly by active sets: unconverged descent would corrupt held-out losses."""

import numpy as np
from scipy.linalg.lapack import dposv

from winch_friction.discrepancy.engine import FloatArray

_TOLERANCE = 1e-10


def bounded_fit(
    h: FloatArray, g: FloatArray, lower: FloatArray, upper: FloatArray, start: FloatArray | None = None
) -> FloatArray:
    """Minimise b'Hb/2 - g'b for lower <= b <= upper.

    `h` (n, n) positive definite, `g` (n,); `start` is a feasible guess (its active bounds are tried first). Exact up to
    rounding: a primal active-set method with finitely many steps.
    """
    size = len(g)
    beta = np.clip(np.zeros(size) if start is None else start, lower, upper)
    free = (beta > lower) & (beta < upper) if start is not None else np.ones(size, bool)
    with np.errstate(
        divide="ignore", invalid="ignore"
    ):  # of `_longest_step`; once, as the loop is short and runs often
        for _ in range(20 * size + 20):
            index = free.nonzero()[0]
            step = _to_free_optimum(h, g, beta, free, index) - beta
            limit, blocking = _longest_step(beta, step, lower, upper, index)
            beta = beta + limit * step
            if blocking >= 0:
                beta[blocking] = lower[blocking] if step[blocking] < 0 else upper[blocking]
                free[blocking] = False
                continue
            release = _release(h @ beta - g, beta, lower, upper, free)
            if release < 0:
                return beta
            free[release] = True
    return beta


def _to_free_optimum(h, g, beta, free, index):  # type: ignore[no-untyped-def]
    if len(index) == len(g):
        return _solved(h, g)
    target = beta.copy()
    if len(index):
        rows = h[index]
        target[index] = _solved(rows[:, index], g[index] - rows[:, ~free] @ beta[~free])
    return target


def _solved(h, g):  # type: ignore[no-untyped-def]
    _, solution, failed = dposv(h, g)  # at these sizes `np.linalg.solve` takes twice as long to begin
    return np.linalg.solve(h, g) if failed else solution


def _longest_step(beta, step, lower, upper, index):  # type: ignore[no-untyped-def]
    if not len(index):
        return 1.0, -1
    move, at = step[index], beta[index]
    # what does not move has room without end, 0/0 included
    room = np.where(np.abs(move) > 0.0, (np.where(move > 0, upper[index], lower[index]) - at) / move, np.inf)
    k = int(room.argmin())
    return (float(max(room[k], 0.0)), int(index[k])) if room[k] < 1.0 else (1.0, -1)


def _release(gradient, beta, lower, upper, free):  # type: ignore[no-untyped-def]
    if free.all():
        return -1
    wrong = np.where(~free & (beta <= lower), -gradient, np.where(~free, gradient, 0.0))
    wrong = np.where(upper - lower < _TOLERANCE, 0.0, wrong)
    k = int(np.argmax(wrong))
    return k if wrong[k] > _TOLERANCE * (1.0 + np.abs(gradient).max()) else -1
