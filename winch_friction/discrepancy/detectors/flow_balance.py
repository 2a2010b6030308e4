"""Lost speed: the flow that a commanded speed should have needed against the speed that was reached, on plateaus, or
where there are too few of them wherever the speed follows its command.

Leakage does not touch the torque balance. Where the commanded speed is logged, it shows as speed lost with pressure, in
both directions alike, while a wrong speed scale changes sign with the direction.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.ndimage import minimum_filter1d

from winch_friction.discrepancy.answer import Effect
from winch_friction.discrepancy.candidates.candidate import SOURCE, ParameterEstimate, Untestable
from winch_friction.discrepancy.preparation.prepare import PreparedRun
from winch_friction.discrepancy.preparation.seen import GroupSignals
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics import fluid
from winch_friction.physics.fluid import LEAKAGE_LAWS, REFERENCE_PRESSURE, leakage_per_coefficient
from winch_friction.physics.friction.correction import Correction
from winch_friction.physics.signals import FloatArray, Run

NAME = "slip_leakage"
REFERENCE = "speed_reference"
SYMBOLS = {"slip_leakage": "C_leak", "orifice_leakage": "C_orifice", "opening_gap_leakage": "C_opening"}
EQUATIONS = {
    "slip_leakage": r"C\,\Delta p/(D\,\mu)",
    "orifice_leakage": r"C_o\sqrt{p_0\,\Delta p}/D",
    "opening_gap_leakage": r"C_g\,\Delta p^2/(p_0\,D\,\mu)",
}
SETTLED = 1.5  # s of constant command before a sample counts as a plateau
STEADY_COMMAND = 1.0  # rad/s^2
# rad/s^2 up to which a command is followed where there are too few plateaus: faster, what is late is more than a lag
SLOW_COMMAND = 30.0
SEGMENT = 5.0  # s
# of these, and runs that hold them: two runs say little of how runs differ, which is part of every deviation here
FEWEST_SEGMENTS, FEWEST_RUNS = 20, 3
FEWEST_TO_FLIP = 6  # segments; of five, all with the same sign, one flip in 32 is as good
# speed that leakage may cost at 150 bar, 40 degC and full displacement before it is more than ordinary and left to the
# pump's command, rad/s: what 6e-12 m^3/s/Pa cost a motor of 215 cm^3, and so much of a smaller or larger one
ORDINARY = 2.6
SURE = 3.0  # standard deviations beyond the ordinary
# a second law of leakage beside the first must leave no more than this share of what is lost in other runs
WORTH_A_LAW = 0.8


@dataclass(frozen=True)
class Leakage:
    """Leakage in m^3/s/Pa at 150 bar and 40 degC per driving motor, by law, each with its standard deviation.

    `slip` is what they cost together at full displacement, rad/s, and `slip_std` its deviation. `before` and `after`
    are the rms of the lost speed over segments in rad/s, without and with the leakage, held out by run.
    """

    leakage: Mapping[str, tuple[float, float]]
    slip: float
    slip_std: float
    p_value: float
    before: float
    after: float
    change: float = STEADY_COMMAND  # rad/s^2, largest of the command in what it was found in
    beside: tuple[float, ...] = (0.0,)  # error of the speed's scale, and its lag in s, that go with it
    alone: tuple[float, ...] = (0.0,)  # without it

    @property
    def gain(self) -> float:
        """Share of the lost speed that the leakage explains on runs that it was not fitted to."""
        return 1.0 - self.after / self.before if self.before > 0.0 else 0.0

    @property
    def found(self) -> bool:
        """More than ordinary leakage, surely, and it explains most of what is lost."""
        return self.slip - SURE * self.slip_std > ORDINARY and self.p_value < 0.01 and self.gain > 0.3

    @property
    def parameters(self) -> dict[str, ParameterEstimate]:
        """The leakage as it is reported."""
        return {SYMBOLS[law]: ParameterEstimate(*value, "m^3/s/Pa") for law, value in self.leakage.items()}

    @property
    def effect(self) -> Effect:
        """The leakage as an entry of the result."""
        return Effect(
            NAME, (), "per driving motor at 150 bar and 40 degC", r"\omega_{ref}-\omega = "
            + " + ".join(EQUATIONS[law] for law in self.leakage), self.parameters, self.p_value, self.gain, 1.0,
            "commanded against reached speed", " + ".join(self.leakage),
        )  # fmt: skip

    @property
    def corrections(self) -> tuple[Correction, ...]:
        """The leakage as entries of the model."""
        return tuple(Correction(law, *value, source=SOURCE) for law, value in self.leakage.items())

    def holds_on(self, runs: Sequence[Run], prepared: Sequence[PreparedRun]) -> bool:
        """Whether the leakage also explains the speed that other runs lose."""
        table = _tables(runs, prepared, self.change)
        if not len(table):
            return False
        lost, motion, _, rates = _parts(table, self.change)
        before = lost - motion @ self.alone
        after = lost - motion @ self.beside
        for law, (value, _) in self.leakage.items():
            after = after - value * rates[law]
        if len(table) < FEWEST_TO_FLIP:  # too few for any to be surprising: each must be plainly better
            return len(table) > 1 and bool((np.abs(after) < 0.5 * np.abs(before)).all())
        return sign_flip_p_value(before**2 - after**2) <= LIMITS.proof_p and _rms(after) < _rms(before)


def detect(runs: Sequence[Run], prepared: Sequence[PreparedRun]) -> Leakage | None:
    """Speed lost in proportion to pressure over viscosity, where a command is logged."""
    found = lost_speed(runs, prepared)
    return found if found is not None and found.found else None


def lost_speed(runs: Sequence[Run], prepared: Sequence[PreparedRun]) -> Leakage | None:
    """Leakage from commanded and reached speed, by the law that other runs bear out, or by two where they need both;
    None where no command is logged, or too few stretches follow it.
    """
    changes = [change for change in (STEADY_COMMAND, SLOW_COMMAND) if _enough(_tables(runs, prepared, change))]
    if not changes:
        return None
    lost, motion, of_run, rates = _parts(_tables(runs, prepared, changes[0]), changes[0])
    before = _held_out(motion, lost, of_run)
    singles: list[tuple[str, ...]] = [(law,) for law in LEAKAGE_LAWS]
    fits = {laws: _fitted(laws, motion, rates, lost, of_run) for laws in singles}
    laws = min(fits, key=lambda k: _rms(fits[k][2]))
    for other in [law for law in LEAKAGE_LAWS if law not in laws]:
        pair = (laws[0], other)
        fits[pair] = _fitted(pair, motion, rates, lost, of_run)
    first = motion.shape[1]  # of the laws' own coefficients
    allowed = {k: fit for k, fit in fits.items() if len(k) == 1 or min(fit[0][first:]) > 0.0}
    best = min(allowed, key=lambda k: _rms(allowed[k][2]))
    if len(best) > 1 and _rms(allowed[best][2]) < WORTH_A_LAW * _rms(allowed[laws][2]):
        laws = best
    coefficients, covariance, after = allowed[laws]
    full = REFERENCE_PRESSURE / _full_displacement(prepared)
    std = np.sqrt(np.diag(covariance))
    return Leakage(
        {law: (float(coefficients[k]), float(std[k])) for k, law in enumerate(laws, start=first)},
        float(coefficients[first:].sum()) * full, float(np.sqrt(covariance[first:, first:].sum())) * full,
        sign_flip_p_value(before**2 - after**2), _rms(before), _rms(after), changes[0],
        tuple(map(float, coefficients[:first])), tuple(map(float, _fit(motion, lost)[0])),
    )  # fmt: skip


def untestable(runs: Sequence[Run], prepared: Sequence[PreparedRun]) -> list[Untestable]:
    """Why runs whose command is logged could not show what leaks, if they could not."""
    table = _tables(runs, prepared, SLOW_COMMAND)
    if _enough(table) or not any(REFERENCE in run and own.groups for run, own in zip(runs, prepared, strict=True)):
        return []
    need = f"{FEWEST_SEGMENTS} stretches of {SEGMENT:g} s in {FEWEST_RUNS} runs in which the speed follows its command"
    seen = f"there are {len(table)} in {len(np.unique(table[:, 0]))} runs"
    return [Untestable(NAME, EQUATIONS[NAME], need, f"a lost speed shows only there; {seen}")]


def _enough(table: FloatArray) -> bool:
    return len(table) >= FEWEST_SEGMENTS and len(np.unique(table[:, 0])) >= FEWEST_RUNS


def _full_displacement(prepared: Sequence[PreparedRun]) -> float:
    """Of the driving motors, m^3/rad: the crane file's, or where it has none as far as they were swung out."""
    stated = dict(prepared[0].constants).get("max_displacement", 0.0)
    return stated or max(float(np.max(_driving(p).displacement)) for p in prepared if p.groups)


def _tables(runs: Sequence[Run], prepared: Sequence[PreparedRun], change: float) -> FloatArray:
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


def _parts(table: FloatArray, change: float) -> tuple[FloatArray, FloatArray, FloatArray, dict[str, FloatArray]]:
    """Lost speed, the motion that may have lost it beside a leak (speed, and of a command that changes its
    acceleration), run and what each law loses per unit, of the rows."""
    motion = table[:, 2 : 3 if change <= STEADY_COMMAND else 4]
    return table[:, 1], motion, table[:, 0], dict(zip(LEAKAGE_LAWS, table[:, 4:].T, strict=True))


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


def _fitted(
    laws: tuple[str, ...], motion: FloatArray, rates: Mapping[str, FloatArray], lost: FloatArray, of_run: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Coefficients of motion and laws, their covariance, and the lost speed that they leave, held out by run."""
    x = np.column_stack([motion, *(rates[law] for law in laws)])
    return *_fit(x, lost), _held_out(x, lost, of_run)


def _fit(x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    scale = np.sqrt((x**2).mean(axis=0)) + 1e-300
    z = x / scale
    inverse = np.linalg.pinv(z.T @ z)
    beta = inverse @ z.T @ y
    variance = ((y - z @ beta) ** 2).sum() / max(len(y) - x.shape[1], 1)
    return beta / scale, variance * inverse / np.outer(scale, scale)


def _held_out(x: FloatArray, lost: FloatArray, of_run: FloatArray) -> FloatArray:
    """What each run keeps of its lost speed, fitted to the others."""
    left = np.empty(len(lost))
    for run in np.unique(of_run):
        out = of_run == run
        left[out] = lost[out] - x[out] @ _fit(x[~out], lost[~out])[0]
    return left


def sign_flip_p_value(gains: FloatArray, flips: int = 2000) -> float:
    """Sign-flip p-value of a positive mean gain over segments."""
    signs = np.random.default_rng(0).choice([-1.0, 1.0], size=(flips, len(gains)))
    return float((1 + (signs @ gains >= gains.sum()).sum()) / (1 + flips))


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values**2)))
