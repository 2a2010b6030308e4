"""How well do runs fit a crane as they stand? Their balance closes, the other channels agree with the speed (angle,
reference, wire length and heave tell it again), and no quantity lies beyond what its machine can do.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from winch_friction.commissioning.balance import Closure, closure, static_torque, top
from winch_friction.commissioning.view import RunView, usable
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import FloatArray, Run
from winch_friction.physics.winch.crane import CURRENT, ELECTRIC, Crane

# channel -> relative error that is ordinary, 1 sigma: an encoder counts, a wire lies on a layer or slips, a sea drifts
ORDINARY = {
    "shaft_angle": 0.03, "drum_speed": 0.03, "speed_reference": 0.12, "wire_out": 0.12, "heave_velocity": 0.15,
}  # fmt: skip
SPEED = "motor_speed"
IN_METRES = ("wire_out", "heave_velocity")  # these tell the wire's speed
FOLLOWS = 0.8  # correlation below which a channel does not tell the speed (heave with the compensation off)
MOST = 150.0  # score of one channel in one run: one flat contradiction suffices
FEWEST = 20  # blocks
LAGS = (2, 3, 5, 8, 12, 20)  # blocks of a fifth of a second that one channel may be late by
LEAST_MISFIT, SHARPER = 0.004, 0.25  # 1 - correlation of ordinary sensors; share of it that a right shift leaves
LATE = 40.0  # score of a channel that fits only when shifted: two of them contradict, one is a hint


@dataclass(frozen=True)
class Agreement:
    """One channel's speed over the logged one: `ratio` (negative: opposite sign), `correlation`, and the `score`."""

    channel: str
    ratio: float
    correlation: float
    score: float


def agreements(view: RunView, must_follow: Sequence[str] = ()) -> list[Agreement]:
    """How each channel that tells the speed agrees with it; channels that do not follow it at all are left out.

    Those that `must_follow` count as contradictions when they do not.
    """
    found = []
    for channel in view.rates:
        told = at_shaft(view, channel)
        ratio, correlation = _compared(view.speed, told)
        if abs(correlation) >= FOLLOWS:
            late = LATE if _is_late(view.speed, told, correlation) else 0.0
            found.append(Agreement(channel, ratio, correlation, _score(ratio, ORDINARY[channel]) + late))
        elif channel in must_follow:
            found.append(Agreement(channel, ratio, correlation, MOST))
    return found


def at_shaft(view: RunView, channel: str) -> FloatArray:
    """What a channel tells of the speed of the motor shaft, rad/s, by this crane's gear and drum."""
    rate = view.rates[channel]
    if channel == "drum_speed":
        return rate * view.gear_ratio
    return rate / view.lever if channel in IN_METRES else rate


def _is_late(speed: FloatArray, told: FloatArray, correlation: float) -> bool:
    """Whether the two agree much better with one of them shifted in time."""
    misfit = 1.0 - abs(correlation)
    if misfit < LEAST_MISFIT:
        return False
    shifted = (_compared(speed[lag:], told[:-lag])[1] for lag in LAGS)
    back = (_compared(speed[:-lag], told[lag:])[1] for lag in LAGS)
    best = max((abs(each) for each in (*shifted, *back)), default=0.0)
    return 1.0 - best < SHARPER * misfit


def ways(run: Run, crane: Crane) -> dict[str, float]:
    """By channel that counts turns or wire: the way that it goes over the way that the speed goes in the run's time.

    The rate of a channel of coarse steps drowns in them where a clock is a thousand times too slow; its sum does not.
    """
    if SPEED not in run:
        return {}
    turned = np.cumsum(np.nan_to_num(usable(SPEED, run[SPEED])) * np.diff(run.time, prepend=run.time[0]))
    lever = float(np.mean(crane.drum.layer_radii)) / crane.gear_ratio
    counted = {name: run[name] / per for name, per in (("shaft_angle", 1.0), ("wire_out", -lever)) if name in run}
    found = {name: _compared(_apart(turned), _apart(way)) for name, way in counted.items()}
    return {name: ratio for name, (ratio, correlation) in found.items() if abs(correlation) >= FOLLOWS}


def _apart(way: FloatArray) -> FloatArray:
    known = way[np.isfinite(way)]
    return way - float(np.mean(known)) if known.size else way


def _compared(speed: FloatArray, told: FloatArray) -> tuple[float, float]:
    good = np.isfinite(speed) & np.isfinite(told)
    if good.sum() < FEWEST:
        return 1.0, 0.0
    a, b = speed[good], told[good]
    aa, bb, ab = (a * a).sum(), (b * b).sum(), (a * b).sum()
    size = float(np.sqrt(aa * bb))
    if size == 0.0:
        return 1.0, 0.0
    return float(np.sqrt(bb / aa) * np.sign(ab)), float(ab) / size


def _score(ratio: float, ordinary: float) -> float:
    if ratio <= 0.0:
        return MOST
    return min(float(np.log(ratio) / ordinary) ** 2, MOST)


# -- what this crane's machine can do

# what no winch of this kind does; generous, so that only a wrong unit or a wrong crane passes them
FASTEST = 650.0  # rad/s at the motor shaft, 6200 rpm: above the limit of any piston motor of this size
HIGHEST = 600e5  # Pa, above any relief valve
LARGEST_DISPLACEMENT = 1.06  # of the crane's largest: the feedback's error
HEAVIEST = 1.5  # of what all motors hold at 450 bar
RATED_TO_LIMIT = 450.0 / 300.0
LOWEST_SUM = 8e5  # Pa: p_A + p_B of any loop in use lies above; the boost alone is several times that
# of the crane's largest, at the run's largest and by the group that is swung in farthest: another may be swung out, and
# its feedback then reads what its zero is off by; where it has another unit, the torque balance does not close
SMALLEST_DISPLACEMENT = 0.03
ROUGHEST = 15.0  # m/s of crane tip
STEEP = 0.1  # a ratio of e^0.1 beyond the limit costs one sigma
MOST_BEYOND = 400.0


def excesses(view: RunView) -> dict[str, float]:
    """By channel: its 99th percentile over the upper limit, or the lower limit over it, where that is above 1."""
    found = {"heave_velocity": top(view.heave) / ROUGHEST if view.heave is not None else 0.0}
    if view.groups:
        found["motor_speed"] = top(view.speed) / FASTEST
        heaviest = HEAVIEST * RATED_TO_LIMIT * view.rated_torque
        found["hook_load"] = top(static_torque(view)) / heaviest if heaviest > 0.0 else 0.0
    widest = max((top(group.displacement) for group in view.groups.values()), default=0.0)
    for name, group in view.groups.items():
        too_low = LOWEST_SUM / max(top(group.pressure_sum), 1e-300)
        found[f"{name}.pressure"] = max(top(group.drop) / HIGHEST, too_low)
        if view.max_displacement > 0.0:
            largest = top(group.displacement)
            too_small = SMALLEST_DISPLACEMENT * view.max_displacement / max(widest, 1e-300)
            too_large = largest / (LARGEST_DISPLACEMENT * view.max_displacement)
            found[f"{name}.displacement"] = max(too_small, too_large)
    return {name: ratio for name, ratio in found.items() if ratio > 1.0}


def range_score(view: RunView) -> float:
    """The excesses as one score."""
    return sum(min((np.log(ratio) / STEEP) ** 2, MOST_BEYOND) for ratio in excesses(view).values())


INERTIAL = 0.02  # of the torque: a wrong unit takes ten times and more off what the inertia of a quick drive asks


def tells_speed(view: RunView, crane: Crane) -> bool:
    """Whether a record tells how large its speed is: by another channel, or by what the inertia asks of the torque.

    A torque that is measured, of a slow drive whose friction is not known beforehand, hardly feels the speed: a wrong
    one only makes room for the friction.
    """
    if crane.drive.kind not in (ELECTRIC, CURRENT) or view.rates:
        return True
    inertial, drive = view.inertia * view.acceleration, view.drive_torque
    return bool(np.nanmean(np.square(inertial)) > INERTIAL**2 * np.nanmean(np.square(drive)))


# -- all of it
# score of a run above which it cannot be the crane's: ordinary friction and twice a catalogue effect stay below 75
CONTRADICTS = 100.0
SURE = 60.0  # a mistake that lowers the score of all runs by this much is named even where each alone would pass


@dataclass(frozen=True)
class Fit:
    """How runs fit as they stand: `score` of all of them, by run, and how the balance of each closes."""

    score: float
    scores: tuple[float, ...]
    closures: tuple[Closure, ...]
    names: tuple[str, ...]

    @property
    def contradicting(self) -> tuple[str, ...]:
        """Runs that cannot be the crane's."""
        return tuple(n for n, s in zip(self.names, self.scores, strict=True) if s > CONTRADICTS)

    @property
    def doubted(self) -> bool:
        """Whether a mistake could be named: one contradicts the crane, or all together leave so much to take away."""
        return bool(self.contradicting) or self.score >= SURE


def fit_of(views: Sequence[RunView], model: FrictionModel | None) -> Fit:
    """Score the runs as they stand."""
    closures = tuple(closure(view, model) for view in views)
    balance = [each.score for each in closures]
    scores = np.array([b + _beside_balance(view) for b, view in zip(balance, views, strict=True)])
    return Fit(float(scores.sum()), tuple(scores.tolist()), closures, tuple(view.name for view in views))


def score_of(view: RunView, model: FrictionModel | None) -> float:
    """How badly a run fits the crane: balance, agreement of its channels, range."""
    return closure(view, model).score + _beside_balance(view)


def _beside_balance(view: RunView) -> float:
    return sum(each.score for each in agreements(view)) + range_score(view)


# -- the motor's speed in another column: exchanged columns are two mistakes to whoever looks at units alone
EXCHANGED = 0.95  # correlation of a speed with its command, or with the rate of its own angle
MAY_BE = ("hook_load", "heave_velocity", "oil_temperature", "wire_out", "motor_torque", "rope_force")


def exchanged_columns(runs: Sequence[Run]) -> Iterator[tuple[str, str, str]]:
    """Of runs whose motor_speed turns as no motor does, while another column goes as the command or the shaft's angle:
    what is said, that column, the run's name."""
    for run in runs:
        speed = run.columns.get("motor_speed")
        if speed is None or not np.nanmedian(np.abs(speed)) > FASTEST:
            continue
        for name in (each for each in MAY_BE if each in run.columns):
            other = run[name]
            if np.nanmax(np.abs(other)) <= FASTEST and any(_goes_as(each, other) for each in _speeds(run)):
                said = (
                    f"{run.name}: motor_speed is {np.nanmedian(np.abs(speed)):.4g} rad/s, and {name} goes as the motor "
                    f"does: are these two columns exchanged?"
                )
                yield said, name, run.name


def _speeds(run: Run) -> Iterator[FloatArray]:
    if "speed_reference" in run.columns:
        yield run["speed_reference"]
    if "shaft_angle" in run.columns:
        yield np.gradient(run["shaft_angle"], run.time)


def _goes_as(speed: FloatArray, told: FloatArray) -> bool:
    return _compared(_apart(speed), _apart(told))[1] >= EXCHANGED
