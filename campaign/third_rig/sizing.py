"""A size for every hidden effect: a trace of 3 to 10 noise floors of which the seed's own claim swallows not too much.

The trace is what an effect changes in the documented balance with the true parameters.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from campaign.third_rig.crane import BAR, PARAMETERS, STRIBECK
from campaign.third_rig.hidden import Channels, Effect
from campaign.third_rig.motion import Series
from campaign.third_rig.plan import Options, Plan
from campaign.third_rig.plant import residual, solve
from campaign.third_rig.runs import Run

BLOCK = 0.2  # s over which noise is averaged
PRESSURE_STEP = 0.15  # bar, of a transducer
MODEL_FLOOR = 0.05  # bar
LARGEST_TRACE = 10.0  # floors
FAIR = 2.0  # floors beyond what the seed may claim
NEARLY_FAIR = 1.8
TIGHTENINGS = (1.0, 0.5, 0.25)  # of the seed's standard deviations, until the effect is fair
FREEDOM = 1.5  # standard deviations that the seed may move


@dataclass(frozen=True)
class Sized:
    """An effect's size and its trace in floors: where it counts, everywhere, and beyond the seed's claim."""

    size: float
    trace: float | None = None
    everywhere: float | None = None
    beyond: float | None = None


@dataclass(frozen=True)
class _Base:
    """The runs without effects."""

    plan: Plan
    runs: Sequence[Run]
    channels: list[Channels]
    residuals: list[Series]
    floor: float


def noise_floor(options: Options) -> float:
    """Of the balance in blocks of 0.2 s, bar."""
    count = 1 if options.rate <= 5 else max(1, options.rate * BLOCK)
    return float(np.sqrt(2 * (options.pressure_noise**2 + PRESSURE_STEP**2 / 12) / count + MODEL_FLOOR**2))


def fairly_sized(
    plan: Plan, runs: Sequence[Run], effects: Sequence[Effect], targets: Sequence[float]
) -> tuple[Plan, list[Sized], float]:
    """Effects with a trace near the targets (floors), a seed better known if need be, and by how much it is.

    Raises ValueError if an effect leaves no trace.
    """
    for tightening in TIGHTENINGS:
        known = _tightened(plan, tightening)
        base = _base(known, runs)
        found = [_sized(base, effect, target) for effect, target in zip(effects, targets, strict=True)]
        wanted = [_wanted(each.beyond, target) for each, target in zip(found, targets, strict=True)]
        if all(_fair(*each) for each in zip(found, wanted, targets, strict=True)):
            break
    return known, [_sized(base, effect, target) for effect, target in zip(effects, wanted, strict=True)], tightening


def _tightened(plan: Plan, share: float) -> Plan:
    figures = plan.figures.tightened(share)
    return replace(plan, figures=figures if plan.options.stribeck else figures.without_stribeck())


def _base(plan: Plan, runs: Sequence[Run]) -> _Base:
    channels = [solve(plan, run) for run in runs]
    residuals = [residual(plan, run, each) for run, each in zip(runs, channels, strict=True)]
    return _Base(plan, runs, channels, residuals, noise_floor(plan.options))


def _wanted(beyond: float | None, target: float) -> float:
    """A larger trace if too little of it is left beyond the seed."""
    return target if beyond is None or beyond >= FAIR else min(LARGEST_TRACE, target * FAIR / max(beyond, 0.01))


def _fair(found: Sized, wanted: float, target: float) -> bool:
    return found.beyond is None or found.beyond * wanted / target >= NEARLY_FAIR


def _sized(base: _Base, effect: Effect, target: float) -> Sized:
    if effect.fixed:
        return Sized(effect.first_size)
    size = effect.first_size
    for _ in range(4):
        reached = _rms(_trace(base, effect, size), effect.rare) / base.floor
        if not np.isfinite(reached) or reached == 0:
            raise ValueError(f"{base.plan.key}: no trace")
        if abs(reached / target - 1) < 0.03:
            break
        size = min(size * target / reached, effect.largest_size)
    trace = _trace(base, effect, size)
    beyond = _beyond_seed(base, trace) / base.floor
    return Sized(float(size), _rms(trace, effect.rare) / base.floor, _rms(trace, False) / base.floor, beyond)


def _trace(base: _Base, effect: Effect, size: float) -> list[Series]:
    """Bar, by run; not a number where it does not count."""
    traces = []
    for run, without in zip(base.runs, base.residuals, strict=True):
        channels = solve(base.plan, run, ((effect, size),))
        trace = (residual(base.plan, run, channels) - without) / BAR
        trace[np.abs(run.speed) < effect.slowest] = np.nan
        traces.append(trace)
    return traces


def _rms(traces: Sequence[Series], rare: bool) -> float:
    trace = np.concatenate(traces)
    trace = trace[np.isfinite(trace)]
    if rare:
        trace = np.sort(np.abs(trace))[-max(20, len(trace) // 20) :]
    return float(np.sqrt(np.mean(trace**2)))


def _beyond_seed(base: _Base, traces: Sequence[Series]) -> float:
    """Bar that stay when the seed's parameters move within their standard deviations: a ridge on blocks of 0.2 s."""
    stride = max(1, int(BLOCK / base.plan.step))
    shown = [np.flatnonzero(np.isfinite(trace))[::stride] for trace in traces]
    columns = np.vstack([_moved(base, k)[index] for k, index in enumerate(shown)])
    trace = np.concatenate([trace[index] for trace, index in zip(traces, shown, strict=True)])
    weight = columns.T @ columns / base.floor**2 + np.eye(columns.shape[1]) / FREEDOM**2
    moved = np.linalg.solve(weight, columns.T @ trace / base.floor**2)
    return float(np.sqrt(np.mean((trace - columns @ moved) ** 2)))


def _moved(base: _Base, number: int) -> Series:
    """Bar per standard deviation of each parameter of the seed, in one run."""
    plan, run, channels = base.plan, base.runs[number], base.channels[number]
    figures = plan.figures
    names = [name for name in PARAMETERS if plan.options.stribeck or name not in STRIBECK]
    columns = []
    for name in names:
        true = figures.true | {name: figures.true[name] + 0.1 * figures.deviation[name]}
        columns.append((base.residuals[number] - residual(plan, run, channels, true)) / BAR / 0.1)
    return np.array(columns).T
