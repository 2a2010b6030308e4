"""The words of a proposed law: signals that an equation may read, and the functions of one signal that it may hold.

Each function stands once as text (for a file of terms and, evaluated by SymPy, for the term itself) and once over the
samples of a run, and its means over the blocks of all runs (for the search).
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.engine.blocks import block_means
from winch_friction.discrepancy.engine.grammar import Factor
from winch_friction.discrepancy.preparation.grid import lagged
from winch_friction.discrepancy.preparation.motors import GroupSignals
from winch_friction.discrepancy.preparation.prepare import PreparedRun
from winch_friction.discrepancy.regressors import block_size

QUANTILES = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9)
LAGS = (3.0, 10.0, 30.0, 90.0)  # s
FADES = (15.0, 45.0, 140.0)  # s
SEEN = 2.0  # times, what is to be called periodic: a period of all the wire that came and went is any curve over it
PERIODS = tuple(float(x) for x in np.geomspace(0.6, 60.0, 41))  # m of wire, from a groove to a layer
SECTORS, WIDTHS = 12, (0.15, 0.3, 0.5)  # of a turn


@dataclass(frozen=True)
class Word:
    """A signal: its symbol in equations, its unit, and how to read it from a run or a motor group."""

    name: str
    symbol: str
    unit: str
    reads: str  # the run column
    of_run: Callable[[PreparedRun], FloatArray] | None = None
    of_group: Callable[[GroupSignals], FloatArray] | None = None
    needs: str = ""  # column that the runs must have
    whole: bool = False  # a count: its constants are whole numbers, and no fit moves them
    kinds: tuple[str, ...] = ("linear", "root", "square", "about", "step", "above", "below")


PICKING = ("about", "step", "above", "below")  # of a signal that a run has one value of, these pick some of the runs
UNLIKE_A_CURVE = ("lag", "hump", "wave", "sector")  # what no monotone function of a signal's present value draws
RISING, FALLING = ("linear", "root", "square", "about", "step", "above"), ("below", "fade")  # with the signal
_SHAPES = ("linear", "root", "square", "about", "step", "above", "below", "hump", "fade", "lag")
WORDS = (
    Word("motor_speed", "w", "rad/s", "motor_speed", lambda r: np.abs(r.speed), kinds=_SHAPES),
    Word("drum_torque", "T_d", "N*m", "hook_load", lambda r: r.drum_torque, kinds=("linear", "root", "square", "lag")),
    Word("acceleration", "sp.Abs(acceleration)", "rad/s^2", "acceleration", lambda r: np.abs(r.acceleration),
         kinds=("linear", "root", "square", "lag")),
    Word("oil_temperature", "oil_temperature", "degC", "oil_temperature", lambda r: r.channels["oil_temperature"],
         needs="oil_temperature", kinds=("about", "step", "above", "below")),
    Word("wire_out", "wire_out", "m", "wire_out", lambda r: r.channels["wire_out"], needs="wire_out",
         kinds=("linear", "root", "square", "about", "step", "above", "below", "wave")),
    Word("wire_layer", "wire_layer", "1", "wire_layer", lambda r: r.channels["wire_layer"], needs="wire_layer",
         whole=True, kinds=("linear", "about")),
    Word("run_time", "run_time", "s", "time", lambda r: r.time, kinds=("fade",)),
    Word("drum_angle", "(shaft_angle / gear_ratio)", "rad", "shaft_angle", lambda r: r.angle / r.gear_ratio,
         kinds=("sector",)),
    Word("displacement", "D", "m^3/rad", "displacement", of_group=lambda g: g.displacement,
         kinds=("linear", "square", "about", "step", "above", "below")),
    Word("pressure", "p", "Pa", "pressure", of_group=lambda g: np.abs(g.pressure),
         kinds=("linear", "root", "square", "above", "step", "lag")),
)  # fmt: skip
BY_NAME = {word.name: word for word in WORDS}

# text of each function: {x} the signal, {c}, {h} its constants; a state equation where it has memory
TEXTS: Mapping[str, str] = {
    "linear": "{x}",
    "root": "sp.sqrt({x})",
    "square": "({x})**2",
    "about": "({x} - {c})",
    "step": "sp.Piecewise((0.0, {x} <= {c}), (1.0, True))",
    "above": "sp.Piecewise((0.0, {x} <= {c}), ({x} - {c}, True))",
    "below": "sp.Piecewise(({c} - {x}, {x} <= {c}), (0.0, True))",
    "hump": "sp.exp(-((({x} - {c}) / {h})**2) / 2)",
    "fade": "sp.exp(-{x} / {c})",
    "grow": "(1 - {z})",
    "lag": "{z}",
    "wave": "(1 + sp.sin(2 * sp.pi * ({x} - {h}) / {c})) / 2",
    "sector": "sp.Piecewise((1.0, sp.Mod({x} / (2 * sp.pi) - {c}, 1) < {h}), (0.0, True))",
}
# powers of the signal's unit that a function has; none: it is a pure number
POWERS = {"linear": 1.0, "root": 0.5, "square": 2.0, "about": 1.0, "above": 1.0, "below": 1.0, "lag": 1.0}
CONSTANT_UNITS = {"lag": {"c": "s"}, "sector": {"c": "1", "h": "1"}}


def shape(kind: str, x: FloatArray, constants: Mapping[str, float], dt: float) -> FloatArray:
    """A function over the samples of one run."""
    c, h = constants.get("c", 0.0), constants.get("h", 1.0)
    if kind == "lag":
        return lagged(x, dt, c)
    made: dict[str, Callable[[], FloatArray]] = {
        "linear": lambda: x,
        "root": lambda: np.sqrt(np.maximum(x, 0.0)),
        "square": lambda: x**2,
        "about": lambda: x - c,
        "step": lambda: (x > c).astype(float),
        "above": lambda: np.maximum(x - c, 0.0),
        "below": lambda: np.maximum(c - x, 0.0),
        "hump": lambda: np.exp(-(((x - c) / h) ** 2) / 2),
        "fade": lambda: np.exp(-x / c),
        "grow": lambda: 1.0 - np.exp(-x / c),
        "wave": lambda: (1.0 + np.sin(2 * np.pi * (x - h) / c)) / 2,
        "sector": lambda: (np.mod(x / (2 * np.pi) - c, 1.0) < h).astype(float),
    }
    return made[kind]()


def span_of(covered: FloatArray) -> float:
    """Over how much a signal was seen; 0 where it stayed the same but for rounding."""
    span = float(np.ptp(covered)) if len(covered) else 0.0
    return span if span > 1e-6 * float(np.abs(covered).max(initial=1e-12)) else 0.0


def factors(word: Word, covered: FloatArray) -> Iterator[Factor]:
    """Every function of a signal that the data could tell, its constants on a grid over what was covered."""
    if not (span := span_of(covered)):
        return
    quantiles = (float(f"{q:.3g}") for q in np.quantile(covered, QUANTILES))
    knots = _counts(covered) if word.whole else list(dict.fromkeys(quantiles))
    for kind in word.kinds:
        for constants in _constants(kind, word, knots, span):
            if 0.0 in constants.values():  # a constant of no size has no scale to be fitted on
                continue
            yield Factor(kind, word.name, tuple(constants.items()))


def _counts(covered: FloatArray) -> list[float]:
    """The whole numbers that were seen, and 1, where counting begins."""
    return sorted({1.0, *np.unique(np.round(covered)).tolist()})


def _constants(kind: str, word: Word, knots: Sequence[float], span: float) -> list[dict[str, float]]:
    if kind in ("linear", "root", "square"):
        return [{}]
    if kind == "about" and not word.whole:
        return [{"c": c} for c in dict.fromkeys((knots[0], knots[len(knots) // 2], knots[-1]))]
    if kind == "hump":
        return [{"c": c, "h": width * span} for c in knots for width in (0.05, 0.12)]
    if kind == "fade":
        return [{"c": c} for c in (FADES if word.unit == "s" else (0.1 * span, 0.3 * span))]
    if kind == "lag":
        return [{"c": c} for c in LAGS]
    if kind == "wave":
        periods = [p for p in PERIODS if SEEN * p <= span]
        return [{"c": p, "h": share * p} for p in periods for share in (0.125, 0.375, 0.625, 0.875)]
    if kind == "sector":
        return [{"c": (k + 0.5) / SECTORS, "h": width} for k in range(SECTORS) for width in WIDTHS]
    return [{"c": c} for c in knots]


# -- over runs
def covered(word: Word, runs: Sequence[PreparedRun]) -> FloatArray:
    """What the moving samples have seen of a signal; empty where a run lacks it."""
    if word.needs and any(word.needs not in run.channels for run in runs):
        return np.array([])
    parts = [np.mean(signals(word, run), axis=0)[run.used] for run in runs if word.of_run or run.groups]
    return np.concatenate(parts) if parts else np.array([])


def signals(word: Word, run: PreparedRun) -> FloatArray:
    """The signal per member, (members, samples), or (1, samples) where it is the same for all."""
    if word.of_run is not None:
        return np.atleast_2d(np.broadcast_to(word.of_run(run), run.time.shape))
    assert word.of_group is not None
    own = [np.broadcast_to(word.of_group(group), run.time.shape) for group in run.groups]
    return np.array(own) if own else np.zeros((1, len(run.time)))


def _columns(single: Sequence[Factor], grouped: Sequence[Factor], run: PreparedRun, most: int) -> Iterator[FloatArray]:
    """One factor after the other along a run, those of the motor groups once for each of `most` groups."""
    known = {name: signals(BY_NAME[name], run) for name in {f.signal for f in (*single, *grouped)}}
    for f in single:
        yield shape(f.kind, known[f.signal][0], dict(f.constants), run.dt)
    for f in grouped:
        own = known[f.signal]
        for row in own:
            yield shape(f.kind, row, dict(f.constants), run.dt)
        for _ in range(most - len(own)):
            yield np.zeros(len(run.time))


def evaluated(wanted: Sequence[Factor], runs: Sequence[PreparedRun], most: int) -> dict[Factor, FloatArray]:
    """Block means of factors over all runs, aligned with the problem's blocks."""
    single = [f for f in wanted if BY_NAME[f.signal].of_run is not None]
    grouped = [f for f in wanted if BY_NAME[f.signal].of_run is None]
    if not runs or not (single or (grouped and most)):
        return {}
    tables = []
    for run in runs:
        means_of = block_means(run.used, block_size(run))
        tables.append([means_of(each) for each in _columns(single, grouped, run, most)])
    x = np.concatenate(tables, axis=1)
    found = {f: x[k : k + 1] for k, f in enumerate(single)}
    at = len(single)
    return found | {f: x[at + most * k : at + most * (k + 1)] for k, f in enumerate(grouped)}
