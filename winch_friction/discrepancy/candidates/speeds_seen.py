"""Whether a law over the speed is, at the speeds that the runs have seen, still that of its cause.

A law whose own speed lies where no run has been keeps its name and loses its shape: what it draws there is another
cause's, and the name would be given for what it does not say.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from winch_friction.discrepancy.candidates.candidate import Possible, Values
from winch_friction.discrepancy.preparation.prepared_run import PreparedRun
from winch_friction.physics.friction.terms.laws_fluid import POLE, VOGEL_46

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


POSSIBLE: Mapping[str, Possible] = {"stribeck": stribeck, "viscosity_temperature": hersey, "notch_loss": notch}
