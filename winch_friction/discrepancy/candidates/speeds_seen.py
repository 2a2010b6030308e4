"""Whether a law over the speed is, at the speeds that the runs have seen, still that of its cause.

A law whose own speed lies where no run has been keeps its name and loses its shape: what it draws there is another
cause's, and the name would be given for what it does not say.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from winch_friction.discrepancy.candidates.candidate import Possible, Values
from winch_friction.discrepancy.preparation.prepared_run import PreparedRun
from winch_friction.physics.friction.terms.laws_fluid import POLE, VOGEL_46

CLEAR = 3.0  # times the travel in which the instant of a reversal is uncertain, from where on travel is no timing
BEYOND, MOVING_SPEED = 0.25, 1.0  # s and rad/s: a reversal is real where the shaft turns either way so long about it
WIDEST = 0.5  # of the largest speed, for a curve that falls with it: a wider one is a constant


def _top(runs: Sequence[PreparedRun]) -> float:
    """Largest speed of the runs but for outliers, rad/s."""
    return max((float(np.percentile(np.abs(run.speed), 99)) for run in runs), default=np.inf)


def stribeck(values: Values, runs: Sequence[PreparedRun]) -> bool:
    """A Stribeck speed that the runs go well beyond: a wider curve is a constant, and that is Coulomb friction."""
    return all(v < WIDEST * _top(runs) for name, v in values.items() if name.startswith("v_"))


def hersey(values: Values, runs: Sequence[PreparedRun]) -> bool:
    """The same of the curve whose speed follows the oil, at the oil temperature of the runs: its speed is stated at a
    reference where no oil may have been, and beyond all that was driven it is a loss of the load, not of the oil."""
    if "C4_h" not in values or not runs or not all("oil_temperature" in run.channels for run in runs):
        return True
    oil = float(np.median([np.median(run.channels["oil_temperature"]) for run in runs]))
    thick = float(np.exp(VOGEL_46 / (oil + POLE) - VOGEL_46 / (values["T_vh"] + POLE)))
    return bool(values["C4_h"] / thick < WIDEST * _top(runs))


def notch(values: Values, runs: Sequence[PreparedRun]) -> bool:
    """A maximum over the speed that the runs have reached: below it a notch's loss only rises, as those of flow and of
    power do."""
    return all(v < _top(runs) for name, v in values.items() if name.startswith("w_"))


def blurred_travel(runs: Sequence[PreparedRun]) -> float:
    """Travel of the shaft in rad within three samples of a reversal, median: shorter than that nothing is told from an
    instant that is not known better; 0 without a reversal."""
    travels = []
    for run in runs:
        speed, look = run.speed, max(round(BEYOND / run.dt), 2)
        at = np.flatnonzero(speed[:-1] * speed[1:] < 0.0)
        at = at[(at >= look) & (at < len(speed) - look)]
        real = at[(np.abs(speed[at - look]) > MOVING_SPEED) & (np.abs(speed[at + look]) > MOVING_SPEED)]
        travels += [float(np.abs(speed[k + 1 : k + 4]).sum() * run.dt) for k in real]
    return float(np.median(travels)) if travels else 0.0


def presliding(values: Values, runs: Sequence[PreparedRun]) -> bool:
    """A travel well beyond that in which nobody knows when the shaft turned: shorter ones are looked for just after
    reversals alone (`detectors.reversals`)."""
    return values["d_z"] > CLEAR * blurred_travel(runs)


POSSIBLE: Mapping[str, Possible] = {
    "stribeck": stribeck, "viscosity_temperature": hersey, "notch_loss": notch, "presliding": presliding,
}  # fmt: skip
