"""Lost speed: the flow that a commanded speed should have needed against the speed that was reached.

What leaks shows on plateaus, or where there are too few of them wherever the speed follows its command.

Free air in the oil leaves the torque balance closed too. The flow that it takes is missing just where the pressure
passes through low values, whatever the controller does otherwise: the lags of its pump, its position loop, its
compensation of leakage and the oil's own compressibility are linear in what is logged, and taken out of every run
first.
"""

from collections.abc import Container, Iterator, Sequence
from functools import cache

import numpy as np
from scipy.linalg import qr
from scipy.ndimage import gaussian_filter1d, minimum_filter1d

from winch_friction.discrepancy.candidates.candidate import Untestable
from winch_friction.discrepancy.detectors.lost_flow import (
    AIR,
    EQUATIONS,
    LEAK,
    STEADY_COMMAND,
    FreeAir,
    Leakage,
    leakage_of,
)
from winch_friction.discrepancy.engine.chance import sign_flip_p_value
from winch_friction.discrepancy.preparation.grid import lagged
from winch_friction.discrepancy.preparation.motors import GroupSignals
from winch_friction.discrepancy.preparation.prepare import PreparedRun
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics import fluid
from winch_friction.physics.channels import GROUP_CHANNELS
from winch_friction.physics.fluid import LEAKAGE_LAWS, air_compressed, leakage_per_coefficient, path_of_high_side
from winch_friction.physics.friction.declared_correction import DECLARED
from winch_friction.physics.signals import FloatArray, Run

REFERENCE = "speed_reference"
SETTLED = 1.5  # s of constant command before a sample counts as a plateau
# rad/s^2 up to which a command is followed where there are too few plateaus: faster, what is late is more than a lag
SLOW_COMMAND = 30.0
SEGMENT = 5.0  # s
# of these, and runs that hold them: two runs say little of how runs differ, which is part of every deviation here
FEWEST_SEGMENTS, FEWEST_RUNS = 20, 3


def shown_by(
    runs: Sequence[Run], prepared: Sequence[PreparedRun], asked: Container[str]
) -> tuple[tuple[Leakage | FreeAir, ...], list[Untestable]]:
    """What leaks and what air takes, where runs show it; and which of the names that are `asked` for they could not."""
    leakage, air = lost_speed(runs, prepared), free_air(runs, prepared)
    found: list[Leakage | FreeAir] = [leakage] if leakage is not None and leakage.found else []
    found += [air] if air is not None and is_air(air) else []
    unseen = air_untestable(air) if AIR in asked else []
    return tuple(found), unseen + (leak_untestable(runs, prepared) if LEAK in asked else [])


def holds_on(found: Leakage | FreeAir, runs: Sequence[Run], prepared: Sequence[PreparedRun]) -> bool:
    """Whether what was found also explains the speed that other runs lose."""
    if isinstance(found, Leakage):
        return found.explains(stretches(runs, prepared, found.change))
    sums = _all_sums(runs, prepared)
    if not len(sums):
        return False
    gains = _gains(sums, found.volume)
    return bool(gains.sum() > 0.0 and sign_flip_p_value(gains) <= LIMITS.proof_p)


# -- what leaks
def lost_speed(runs: Sequence[Run], prepared: Sequence[PreparedRun]) -> Leakage | None:
    """Speed lost in proportion to pressure over viscosity, or by another law; None where no command is logged, or too
    few stretches follow it."""
    for change in (STEADY_COMMAND, SLOW_COMMAND):
        if _enough(table := stretches(runs, prepared, change)):
            return leakage_of(table, change, _full_displacement(prepared))
    return None


def leak_untestable(runs: Sequence[Run], prepared: Sequence[PreparedRun]) -> list[Untestable]:
    """Why runs whose command is logged could not show what leaks, if they could not."""
    table = stretches(runs, prepared, SLOW_COMMAND)
    if _enough(table) or not any(REFERENCE in run and own.groups for run, own in zip(runs, prepared, strict=True)):
        return []
    need = f"{FEWEST_SEGMENTS} stretches of {SEGMENT:g} s in {FEWEST_RUNS} runs in which the speed follows its command"
    seen = f"there are {len(table)} in {len(np.unique(table[:, 0]))} runs"
    return [Untestable(LEAK, EQUATIONS[LEAK], need, f"a lost speed shows only there; {seen}")]


def _enough(table: FloatArray) -> bool:
    return len(table) >= FEWEST_SEGMENTS and len(np.unique(table[:, 0])) >= FEWEST_RUNS


def _full_displacement(prepared: Sequence[PreparedRun]) -> float:
    """Of the driving motors, m^3/rad: the crane file's, or where it has none as far as they were swung out."""
    stated = dict(prepared[0].constants).get("max_displacement", 0.0)
    return stated or max(float(np.max(_driving(p).displacement)) for p in prepared if p.groups)


def stretches(runs: Sequence[Run], prepared: Sequence[PreparedRun], change: float) -> FloatArray:
    """Rows of what runs lose, as `Leakage` reads them, where the command changes by less than `change`, rad/s^2."""
    pairs = [(run, p) for run, p in zip(runs, prepared, strict=True) if REFERENCE in run and p.groups]
    none = np.empty((0, 4 + len(LEAKAGE_LAWS)))
    return np.concatenate([none, *(_segments(run, p, k, change) for k, (run, p) in enumerate(pairs))])


def _segments(run: Run, prepared: PreparedRun, number: int, change: float) -> FloatArray:
    """Rows (run, lost speed, speed, acceleration, speed lost per unit of each law's leakage) of the stretches of one
    run in which the command changes by less than `change`, rad/s^2."""
    command = np.interp(prepared.time + prepared.start, run.time, run[REFERENCE])
    constant = np.abs(np.gradient(command, prepared.dt)) < change
    width = max(int(SETTLED / prepared.dt), 1)
    # only the past counts: the plateau must have lasted before the sample
    settled = minimum_filter1d(constant.astype(int), width, origin=(width - 1) // 2) > 0
    use = settled & prepared.used
    rates = _per_leakage(prepared)
    step = max(int(SEGMENT / prepared.dt), 1)
    rows = []
    for begin in range(0, len(command), step):
        part = np.flatnonzero(use[begin : begin + step]) + begin
        if len(part) > step // 2:
            speed = prepared.speed[part].mean()
            moved = prepared.acceleration[part].mean()
            rows.append((number, command[part].mean() - speed, speed, moved, *rates[part].mean(axis=0)))
    return np.array(rows, dtype=float).reshape(-1, 4 + len(LEAKAGE_LAWS))


def _driving(prepared: PreparedRun) -> GroupSignals:
    return next(group for group in prepared.groups if group.balances)


def _per_leakage(prepared: PreparedRun) -> FloatArray:
    """Speed lost per unit of leakage of one driving motor, by each law, (samples, laws), rad/s."""
    driving = _driving(prepared)
    thinness: FloatArray | float = 1.0
    if "oil_temperature" in prepared.channels:
        celsius = prepared.channels["oil_temperature"]
        law = 10 ** (10 ** np.interp(celsius, *_table())) - 0.7
        thinness = fluid.kinematic_viscosity(fluid.REFERENCE) / law
    flows = [leakage_per_coefficient(each, driving.pressure, thinness) for each in LEAKAGE_LAWS]
    return np.column_stack(flows) / driving.displacement[:, None]


@cache
def _table() -> tuple[FloatArray, FloatArray]:
    """log10 log10 (nu + 0.7) of the reference oil over temperature."""
    celsius = np.linspace(-20.0, 120.0, 71)
    return celsius, np.log10(np.log10(fluid.kinematic_viscosity(celsius) + 0.7))


# -- what air takes
FINEST = 0.01  # s; a winch's flow has nothing faster
SMOOTH = 0.07  # s, of a Gaussian: 2 Hz, above a sea's and a load's swing and below the encoder's steps
COMPENSATION = (0.3, 1.0)  # s, lags with which a pump's command may follow the pressure that leaks
EDGE = 3.0  # s at either end of a record where lags and filters have not settled
SHORTEST = 20.0  # s of a record without a gap in its log
HOLE = 0.5  # s between two samples
STEADY_DISPLACEMENT = 0.05  # relative; a motor that swivels follows its command by its displacement, not by its flow
# with every law of leakage taken out, on 30 data sets without air (drawn cranes, causes of every kind) the estimate was
# at most 2.7 deviations above nothing and explained 0.2 %; below nothing, where a zero of a transducer takes it, 12
# deviations and 1.6 %, once 3.6; with air 9 to 124 deviations and 2 to 58 %
SURE_OF_AIR = 6.0  # standard deviations
EXPLAINS = 0.03  # share of the lost speed's rms, on runs that it was not fitted to


def free_air(runs: Sequence[Run], prepared: Sequence[PreparedRun]) -> FreeAir | None:
    """The estimate; None without a command, a hydraulic drive of steady displacement, or enough of a record."""
    sums = _all_sums(runs, prepared)
    numbers = np.unique(sums[:, 0])
    if len(sums) < FEWEST_SEGMENTS or len(numbers) < FEWEST_RUNS:
        return None
    estimates = np.array([_estimate(sums[sums[:, 0] == k]) for k in numbers])
    volume, std = _common(estimates)
    held = np.array([_common(np.delete(estimates, k, axis=0))[0] for k in range(len(numbers))])
    gains = _gains(sums, held[np.searchsorted(numbers, sums[:, 0])])
    before, after = sums[:, 3].sum(), sums[:, 3].sum() - gains.sum()
    size = sums[:, 4].sum()
    return FreeAir(volume, std, sign_flip_p_value(gains), float(np.sqrt(before / size)), float(np.sqrt(after / size)))


def is_air(air: FreeAir) -> bool:
    """Surely more than nothing, and worth its name on runs that it was not fitted to."""
    gain = 1.0 - air.after / air.before if air.before > 0.0 else 0.0
    return air.volume > SURE_OF_AIR * air.std and gain > EXPLAINS and air.p_value < LIMITS.proof_p


def air_untestable(air: FreeAir | None) -> list[Untestable]:
    """Why these runs could not have shown a typical volume of air, if they could not."""
    typical, law = DECLARED[AIR].parameter.typical, r"V\,p^{-1/1.4}"
    if air is None:
        return [Untestable(AIR, law, "runs at a steady displacement", "air shows in the flow of a hydraulic drive")]
    if SURE_OF_AIR * air.std <= typical:
        return []
    least = f"less than {SURE_OF_AIR * air.std:.2g} m^3 would not show beside what the controller does"
    return [Untestable(AIR, law, "light loads and reversals, where the pressure is low", least)]


def _all_sums(runs: Sequence[Run], prepared: Sequence[PreparedRun]) -> FloatArray:
    pairs = [(run, p) for run, p in zip(runs, prepared, strict=True) if REFERENCE in run and p.groups]
    parts = [_sums(run, p, k, piece) for k, (run, p) in enumerate(pairs) for piece in _pieces(run)]
    return np.concatenate([np.empty((0, 5)), *parts])


def _pieces(run: Run) -> Iterator[slice]:
    """The stretches of a record without a hole in its log."""
    ends = np.flatnonzero(np.diff(run.time) > HOLE) + 1
    for begin, end in zip([0, *ends], [*ends, len(run.time)], strict=True):
        if end - begin > 1 and run.time[end - 1] - run.time[begin] >= SHORTEST:
            yield slice(begin, end)


def _sums(run: Run, prepared: PreparedRun, number: int, piece: slice) -> FloatArray:
    """Rows (run, air times lost speed, air squared, lost speed squared, samples) of the segments of one stretch, both
    without what the linear rest explains of them.
    """
    driving, count = next(((group.name, group.count) for group in prepared.groups if group.balances), ("", 0))
    needed = ["motor_speed", *(f"{driving}.{channel}" for channel in GROUP_CHANNELS)]
    if not driving or not all(name in run for name in needed):
        return np.empty((0, 5))
    time = run.time[piece]
    speed, pressure_a, pressure_b, displacement = (run[name][piece] for name in needed)
    known = np.isfinite([run[name][piece] for name in (*needed, REFERENCE)]).all()
    middle = float(np.median(displacement))
    if not known or middle <= 0.0 or float(np.std(displacement)) > STEADY_DISPLACEMENT * middle:
        return np.empty((0, 5))
    swept = count * middle
    dt = max(float(np.median(np.diff(time))), FINEST)
    grid = np.arange(time[0], time[-1], dt)
    wanted, reached, drop, air, oil, side = (
        np.interp(grid, time, each)
        for each in (
            run[REFERENCE][piece], speed, pressure_a - pressure_b,
            air_compressed(pressure_a, pressure_b), path_of_high_side(pressure_a, pressure_b, lambda p: p),
            np.where(pressure_a >= pressure_b, 1.0, -1.0),
        )
    )  # fmt: skip
    rest, lost, taken = _regressors(wanted, reached, drop, air / swept, oil / swept, side, dt)
    inside = slice(int(EDGE / dt), -int(EDGE / dt))
    rest = rest[inside]
    rest /= np.maximum(np.sqrt((rest**2).mean(axis=0)), 1e-300)
    # in its own memory: numpy's takes four times that of a long record, and gives the same
    basis, _ = qr(np.asfortranarray(rest), mode="economic", overwrite_a=True, check_finite=False)
    del rest
    basis = np.ascontiguousarray(basis)
    lost, taken = (y - basis @ (basis.T @ y) for y in (lost[inside], taken[inside]))
    if not taken.any():  # no pressure moved, at rest in a held load: air was neither compressed nor let go
        return np.empty((0, 5))
    step = max(int(SEGMENT / dt), 1)
    starts = range(0, len(lost) - step + 1, step)
    return np.array(
        [
            (number, taken[k : k + step] @ lost[k : k + step], (taken[k : k + step] ** 2).sum(),
             (lost[k : k + step] ** 2).sum(), step)
            for k in starts
        ], dtype=float,
    ).reshape(-1, 5)  # fmt: skip


def _regressors(
    wanted: FloatArray, reached: FloatArray, drop: FloatArray, air: FloatArray, oil: FloatArray, side: FloatArray,
    dt: float,
) -> tuple[FloatArray, FloatArray, FloatArray]:  # fmt: skip
    """What a controller and oil without air make of a command, (samples, columns), the lost speed, what air takes."""
    width = max(SMOOTH / dt, 1.0)

    def smooth(x: FloatArray, derivative: int = 0) -> FloatArray:
        return np.asarray(gaussian_filter1d(x, width, order=derivative, mode="nearest") / dt**derivative)

    behind = np.cumsum(wanted - reached) * dt
    # what leaks, by whatever law, and what the controller makes of it
    leaks = [leakage_per_coefficient(law, drop, 1.0) for law in LEAKAGE_LAWS]
    leaks += [lagged(leak, dt, lag) for leak in leaks for lag in COMPENSATION]
    rest = [
        smooth(wanted, 1), smooth(wanted, 2), smooth(reached), smooth(reached, 1), smooth(reached, 2),
        smooth(behind - behind.mean()), np.ones_like(wanted), *map(smooth, leaks),
        smooth(oil, 1), smooth(oil, 2), smooth(side, 1),  # the last: at what pressure the lines change places
    ]  # fmt: skip
    return np.column_stack(rest), smooth(wanted - reached), smooth(air, 1)


def _estimate(sums: FloatArray) -> tuple[float, float]:
    """Volume and variance from the segments of one run."""
    square = max(float(sums[:, 2].sum()), 1e-300)
    volume = float(sums[:, 1].sum()) / square
    return volume, float(((sums[:, 1] - volume * sums[:, 2]) ** 2).sum()) / square**2 + 1e-300


def _common(estimates: FloatArray) -> tuple[float, float]:
    """Mean of the runs' volumes, weighted, and its deviation, widened by what they differ by."""
    weight = 1.0 / estimates[:, 1]
    mean = float((estimates[:, 0] * weight).sum() / weight.sum())
    spread = float(((estimates[:, 0] - mean) ** 2 * weight).sum()) / max(len(estimates) - 1, 1)
    return mean, float(np.sqrt(max(spread, 1.0) / weight.sum()))


def _gains(sums: FloatArray, volume: FloatArray | float) -> FloatArray:
    """What a volume takes off the squared lost speed of each segment."""
    return np.asarray(2.0 * volume * sums[:, 1] - volume**2 * sums[:, 2])
