"""What leaks, and what air takes, of the flow that a commanded speed should have needed: laws, sizes, entries.

Leakage does not touch the torque balance. Where the commanded speed is logged, it shows as speed lost with pressure, in
both directions alike, while a wrong speed scale changes sign with the direction.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from winch_friction.discrepancy.answer import Effect
from winch_friction.discrepancy.candidates.candidate import SOURCE, ParameterEstimate
from winch_friction.discrepancy.engine.chance import rms, sign_flip_p_value
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.fluid import LEAKAGE_LAWS, REFERENCE_PRESSURE
from winch_friction.physics.friction.correction import Correction
from winch_friction.physics.signals import FloatArray

LEAK, AIR = "slip_leakage", "entrained_air"
SYMBOLS = {
    "slip_leakage": "C_leak",
    "orifice_leakage": "C_orifice",
    "opening_gap_leakage": "C_opening",
    "isoviscous_leakage": "C_iso",
}
EQUATIONS = {
    "slip_leakage": r"C\,\Delta p/(D\,\mu)",
    "orifice_leakage": r"C_o\sqrt{p_0\,\Delta p}/D",
    "opening_gap_leakage": r"C_g\,\Delta p^2/(p_0\,D\,\mu)",
    "isoviscous_leakage": r"C_i\,\Delta p/D",
}
STEADY_COMMAND = 1.0  # rad/s^2
FEWEST_TO_FLIP = 6  # segments; of five, all with the same sign, one flip in 32 is as good
# speed that leakage may cost at 150 bar, 40 degC and full displacement before it is more than ordinary and left to the
# pump's command, rad/s: what 6e-12 m^3/s/Pa cost a motor of 215 cm^3, and so much of a smaller or larger one
ORDINARY = 2.6
SURE = 3.0  # standard deviations beyond the ordinary
CHANCE = 0.01  # that stretches which lose nothing to a leak seem to
MOST = 0.3  # of the lost speed's rms: half of its square
PLAINLY = 0.5  # of what is lost, that a leak may leave of each of so few stretches that none is surprising
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
        return self.slip - SURE * self.slip_std > ORDINARY and self.p_value < CHANCE and self.gain > MOST

    @property
    def parameters(self) -> dict[str, ParameterEstimate]:
        """The leakage as it is reported."""
        return {SYMBOLS[law]: ParameterEstimate(*value, "m^3/s/Pa") for law, value in self.leakage.items()}

    @property
    def effect(self) -> Effect:
        """The leakage as an entry of the result."""
        return Effect(
            LEAK, (), "per driving motor at 150 bar and 40 degC", r"\omega_{ref}-\omega = "
            + " + ".join(EQUATIONS[law] for law in self.leakage), self.parameters, self.p_value, self.gain, 1.0,
            "commanded against reached speed", " + ".join(self.leakage),
        )  # fmt: skip

    @property
    def corrections(self) -> tuple[Correction, ...]:
        """The leakage as entries of the model."""
        return tuple(Correction(law, *value, source=SOURCE) for law, value in self.leakage.items())

    def lost(self, table: FloatArray) -> FloatArray:
        """Speed that is lost in these rows beside what goes with the motion, rad/s."""
        lost, motion, *_ = _parts(table, self.change)
        return np.asarray(lost - motion @ self.alone)

    def explains(self, table: FloatArray) -> bool:
        """Whether the leakage also explains the speed that is lost in these rows, of runs that it was not fitted to."""
        if not len(table):
            return False
        lost, motion, _, rates = _parts(table, self.change)
        before = self.lost(table)
        after = lost - motion @ self.beside
        for law, (value, _) in self.leakage.items():
            after = after - value * rates[law]
        if len(table) < FEWEST_TO_FLIP:  # too few for any to be surprising: each must be plainly better
            return len(table) > 1 and bool((np.abs(after) < PLAINLY * np.abs(before)).all())
        return sign_flip_p_value(before**2 - after**2) <= LIMITS.proof_p and rms(after) < rms(before)


def leakage_of(table: FloatArray, change: float, full_displacement: float) -> Leakage:
    """Leakage from commanded and reached speed on these rows, whose command changes by less than `change`, rad/s^2, by
    the law that other runs bear out, or by two where they need both; `full_displacement` of a driving motor, m^3/rad.
    """
    lost, motion, of_run, rates = _parts(table, change)
    before = _held_out(motion, lost, of_run)
    singles: list[tuple[str, ...]] = [(law,) for law in LEAKAGE_LAWS]
    fits = {laws: _fitted(laws, motion, rates, lost, of_run) for laws in singles}
    laws = min(fits, key=lambda k: rms(fits[k][2]))
    for other in [law for law in LEAKAGE_LAWS if law not in laws]:
        pair = (laws[0], other)
        fits[pair] = _fitted(pair, motion, rates, lost, of_run)
    first = motion.shape[1]  # of the laws' own coefficients
    allowed = {k: fit for k, fit in fits.items() if len(k) == 1 or min(fit[0][first:]) > 0.0}
    best = min(allowed, key=lambda k: rms(allowed[k][2]))
    if len(best) > 1 and rms(allowed[best][2]) < WORTH_A_LAW * rms(allowed[laws][2]):
        laws = best
    coefficients, covariance, after = allowed[laws]
    full = REFERENCE_PRESSURE / full_displacement
    std = np.sqrt(np.diag(covariance))
    return Leakage(
        {law: (float(coefficients[k]), float(std[k])) for k, law in enumerate(laws, start=first)},
        float(coefficients[first:].sum()) * full, float(np.sqrt(covariance[first:, first:].sum())) * full,
        sign_flip_p_value(before**2 - after**2), rms(before), rms(after), change,
        tuple(map(float, coefficients[:first])), tuple(map(float, _fit(motion, lost)[0])),
    )  # fmt: skip


def _parts(table: FloatArray, change: float) -> tuple[FloatArray, FloatArray, FloatArray, dict[str, FloatArray]]:
    """Lost speed, the motion that may have lost it beside a leak (speed, and of a command that changes its
    acceleration), run and what each law loses per unit, of the rows."""
    motion = table[:, 2 : 3 if change <= STEADY_COMMAND else 4]
    return table[:, 1], motion, table[:, 0], dict(zip(LEAKAGE_LAWS, table[:, 4:].T, strict=True))


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


# -- air
@dataclass(frozen=True)
class FreeAir:
    """Volume of the free air of one line, m^3 at atmospheric pressure, its standard deviation, and
    the rms of the lost speed in rad/s that the linear rest leaves, without and with the air, held out by run.
    """

    volume: float
    std: float
    p_value: float
    before: float
    after: float

    @property
    def gain(self) -> float:
        """Share of the lost speed that the air explains on runs that it was not fitted to."""
        return 1.0 - self.after / self.before if self.before > 0.0 else 0.0

    @property
    def effect(self) -> Effect:
        """The air as an entry of the result."""
        return Effect(
            AIR, (), "of one line", r"\omega_{ref}-\omega = V\,\dot v(p)/(n D)",
            {"V_air": ParameterEstimate(self.volume, self.std, "m^3")}, self.p_value, self.gain, 1.0,
            "commanded against reached speed where the pressure passes through low values",
        )  # fmt: skip

    @property
    def corrections(self) -> tuple[Correction, ...]:
        """The air as an entry of the model."""
        return (Correction(AIR, self.volume, self.std, source=SOURCE),)
