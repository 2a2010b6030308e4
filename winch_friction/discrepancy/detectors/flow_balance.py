"""Lost speed: the flow that a commanded speed should have needed against the speed that was reached, on plateaus.

Leakage does not touch the torque balance. Where the commanded speed is logged, it shows as speed lost in proportion to
pressure over viscosity, in both directions alike, while a wrong speed scale changes sign with the direction.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.ndimage import minimum_filter1d

from winch_friction.discrepancy.answer import Effect
from winch_friction.discrepancy.candidates.candidate import SOURCE, ParameterEstimate
from winch_friction.discrepancy.preparation.prepared_run import PreparedRun
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics import viscosity
from winch_friction.physics.friction.correction import Correction
from winch_friction.physics.signals import FloatArray, Run

REFERENCE = "speed_reference"
SETTLED = 1.5  # s of constant command before a sample counts as a plateau
STEADY_COMMAND = 1.0  # rad/s^2
SEGMENT = 5.0  # s
FEWEST_SEGMENTS = 20
# leakage per motor that is ordinary for such motors and left to the pump command, m^3/s/Pa
ORDINARY = 6e-12
SURE = 3.0  # standard deviations beyond the ordinary


@dataclass(frozen=True)
class Leakage:
    """Leakage at 40 degC in m^3/s/Pa per driving motor, with its standard deviation and what it explains.

    `before` and `after` are the rms of the lost speed over segments in rad/s, without and with the leakage, held out by
    run.
    """

    leakage: float
    std: float
    p_value: float
    before: float
    after: float
    scale: float = 0.0  # error of the speed's scale, that goes with it
    scale_alone: float = 0.0  # without it

    @property
    def gain(self) -> float:
        """Share of the lost speed that the leakage explains on runs that it was not fitted to."""
        return 1.0 - self.after / self.before if self.before > 0.0 else 0.0

    @property
    def found(self) -> bool:
        """More than ordinary leakage, surely, and it explains most of what is lost."""
        return self.leakage - SURE * self.std > ORDINARY and self.p_value < 0.01 and self.gain > 0.3

    @property
    def parameters(self) -> dict[str, ParameterEstimate]:
        """The leakage as it is reported."""
        return {"C_leak": ParameterEstimate(self.leakage, self.std, "m^3/s/Pa")}

    @property
    def effect(self) -> Effect:
        """The leakage as an entry of the result."""
        return Effect(
            "slip_leakage", (), "per driving motor at 40 degC", r"\omega_{ref}-\omega = C\,\Delta p/(D\,\mu)",
            self.parameters, self.p_value, self.gain, 1.0, "commanded against reached speed",
        )  # fmt: skip

    @property
    def correction(self) -> Correction:
        """The leakage as an entry of the model."""
        return Correction("slip_leakage", self.leakage, self.std, source=SOURCE)

    def holds_on(self, runs: Sequence[Run], prepared: Sequence[PreparedRun]) -> bool:
        """Whether the leakage also explains the speed that other runs lose."""
        table = _tables(runs, prepared)
        if not len(table):
            return False
        lost, speed, rate = table[:, 0], table[:, 1], table[:, 2]
        before = lost - self.scale_alone * speed
        after = lost - self.scale * speed - self.leakage * rate
        return sign_flip_p_value(before**2 - after**2) <= LIMITS.proof_p and _rms(after) < _rms(before)


def detect(runs: Sequence[Run], prepared: Sequence[PreparedRun]) -> Leakage | None:
    """Speed lost in proportion to pressure over viscosity, where a command is logged."""
    found = lost_speed(runs, prepared)
    return found if found is not None and found.found else None


def lost_speed(runs: Sequence[Run], prepared: Sequence[PreparedRun]) -> Leakage | None:
    """Leakage from commanded and reached speed; None where no command is logged or nothing is steady."""
    table = _tables(runs, prepared)
    if len(table) < FEWEST_SEGMENTS or len(np.unique(table[:, 3])) < 3:
        return None
    lost, x, of_run = table[:, 0], table[:, 1:3], table[:, 3]
    coefficients, std = _fit(x, lost)
    before, after = _held_out(lost, x, of_run)
    alone = float((x[:, 0] @ lost) / max((x[:, 0] ** 2).sum(), 1e-300))
    return Leakage(
        float(coefficients[1]), float(std), sign_flip_p_value(before**2 - after**2), _rms(before), _rms(after),
        float(coefficients[0]), alone,
    )  # fmt: skip


def _tables(runs: Sequence[Run], prepared: Sequence[PreparedRun]) -> FloatArray:
    pairs = [(run, p) for run, p in zip(runs, prepared, strict=True) if REFERENCE in run and p.groups]
    return np.concatenate([np.empty((0, 4)), *(_segments(run, p, k) for k, (run, p) in enumerate(pairs))])


def _segments(run: Run, prepared: PreparedRun, number: int) -> FloatArray:
    """Rows (lost speed, speed, speed lost per unit of leakage, run) of the steady stretches of one run."""
    command = np.interp(prepared.time + prepared.start, run.time, run[REFERENCE])
    constant = np.abs(np.gradient(command, prepared.dt)) < STEADY_COMMAND
    width = max(int(SETTLED / prepared.dt), 1)
    # only the past counts: the plateau must have lasted before the sample
    settled = minimum_filter1d(constant.astype(int), width, origin=(width - 1) // 2) > 0
    use = settled & prepared.used
    regressor = _per_leakage(prepared)
    step = max(int(SEGMENT / prepared.dt), 1)
    rows = []
    for begin in range(0, len(command), step):
        part = np.flatnonzero(use[begin : begin + step]) + begin
        if len(part) > step // 2:
            speed = prepared.speed[part].mean()
            rows.append((command[part].mean() - speed, speed, regressor[part].mean(), number))
    return np.array(rows, dtype=float).reshape(-1, 4)


def _per_leakage(prepared: PreparedRun) -> FloatArray:
    """Speed lost per unit of leakage at 40 degC of one driving motor: dp / (D mu/mu_40), rad/s."""
    driving = next(group for group in prepared.groups if group.balances)
    thinness = np.ones(len(prepared.time))
    if "oil_temperature" in prepared.channels:
        celsius = prepared.channels["oil_temperature"]
        law = 10 ** (10 ** np.interp(celsius, *_table())) - 0.7
        thinness = viscosity.kinematic_viscosity(viscosity.REFERENCE) / law
    return driving.pressure / driving.displacement * thinness


@cache
def _table() -> tuple[FloatArray, FloatArray]:
    """log10 log10 (nu + 0.7) of the reference oil over temperature."""
    celsius = np.linspace(-20.0, 120.0, 71)
    return celsius, np.log10(np.log10(viscosity.kinematic_viscosity(celsius) + 0.7))


def _fit(x: FloatArray, y: FloatArray) -> tuple[FloatArray, float]:
    scale = np.sqrt((x**2).mean(axis=0)) + 1e-300
    z = x / scale
    inverse = np.linalg.pinv(z.T @ z)
    beta = inverse @ z.T @ y
    sigma = np.sqrt(((y - z @ beta) ** 2).sum() / max(len(y) - 2, 1))
    return beta / scale, float(sigma * np.sqrt(inverse[1, 1]) / scale[1])


def _held_out(lost: FloatArray, x: FloatArray, of_run: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Residuals of each run, fitted to the others, with a speed scale alone and with leakage."""
    before, after = np.empty(len(lost)), np.empty(len(lost))
    for run in np.unique(of_run):
        out = of_run == run
        scale_alone = (x[~out, 0] @ lost[~out]) / max((x[~out, 0] ** 2).sum(), 1e-300)
        both, _ = _fit(x[~out], lost[~out])
        before[out] = lost[out] - x[out, 0] * scale_alone
        after[out] = lost[out] - x[out] @ both
    return before, after


def sign_flip_p_value(gains: FloatArray, flips: int = 2000) -> float:
    """Sign-flip p-value of a positive mean gain over segments."""
    signs = np.random.default_rng(0).choice([-1.0, 1.0], size=(flips, len(gains)))
    return float((1 + (signs @ gains >= gains.sum()).sum()) / (1 + flips))


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values**2)))
