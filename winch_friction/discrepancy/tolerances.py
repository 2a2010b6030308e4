"""What the making of a log explains: a delay or a zero within it is no name, although it takes something off a gap."""

from collections.abc import Mapping

import numpy as np

from winch_friction.discrepancy.answer import Side
from winch_friction.discrepancy.candidates.candidate import Estimates
from winch_friction.discrepancy.candidates.signals import DELAY, ZERO
from winch_friction.discrepancy.engine.crossfit import CrossFit, Explanation
from winch_friction.discrepancy.thresholds import LIMITS


def within_a_sample(parameters: Mapping[str, Estimates], side: Side) -> str:
    """Why a delay, in s among the parameters by name, is none; empty where it is one, or there is none.

    Signals of one log are in step to half a sample: a counting encoder's mean is as old, and an analogue input waits
    for the next one.
    """
    found = parameters.get(DELAY, {})
    if not found:
        return ""
    step, most = max(run.dt for run in side.runs), max(abs(each.value) for each in found.values())
    if most > LIMITS.in_step * step:
        return ""
    return f"a delay of {1e3 * most:.2g} ms is how a log of a sample every {1e3 * step:.3g} ms is made"


def within_a_step(cross: CrossFit, explanation: Explanation) -> str:
    """Why a zero of transducers is none; empty where it is one, or there is none.

    The step up to which it is off without being wrong is the same whether it stays, creeps or moves with the oil. Its
    size is the root mean square over the blocks of `cross`, in the gap's unit, bar.
    """
    columns = [column for slot in explanation.slots if slot.name == ZERO for column in slot.columns]
    if not columns:
        return ""
    every = cross.problem.columns(explanation.slots)
    torque = cross.problem.blocks.x[:, columns] @ explanation.beta[[every.index(column) for column in columns]]
    size, most = float(np.sqrt(np.mean(torque**2))), LIMITS.step * LIMITS.least_noise
    return f"a zero of {size:.2g} bar is within the {most:g} bar by which a transducer steps" if size <= most else ""


def takes_little(cross: CrossFit, base: Explanation, explanation: Explanation) -> bool:
    """Whether names take less than half of what a refit leaves of the training runs beyond the noise and what no
    balance closes, or nothing is left of these: then they are no more its cause than what the refit has wrong."""
    whole = cross.excess(base)
    return whole <= 0.0 or cross.excess(explanation) > LIMITS.outdone * whole
