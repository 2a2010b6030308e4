"""Candidates that repeat with the turns of the drum: slower than a block, so that a regression sees them.

An eccentric drum, an oval one, the planets and wheels of its gear: whole numbers of periods per turn of the drum, a
share of the load's torque, whichever way it turns. A ripple of the motor's own turn is too fast for blocks and has a
detector of its own.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from winch_friction.discrepancy.candidates.candidate import Candidate, Shape, label_of
from winch_friction.discrepancy.candidates.friction import friction_candidate, no_load
from winch_friction.discrepancy.preparation.prepared_run import PreparedRun
from winch_friction.physics.friction import FrictionModel, term_named

CAUSE = "torque_ripple"
ONE, HARMONICS, HIGHEST_HARMONIC = "drum_ripple", "drum_ripple_harmonics", 3
FASTEST = 0.1  # periods per turn of the motor, from where on the spectrum over its angle looks
MOST_ORDERS = 40  # per turn of the drum; what is faster is left to the spectrum over the motor's angle
LEAST_TURN = 1.0  # of the drum, in at least two runs: less is no period
COUNTED = 0.9  # of the way that the speed tells, that the logged angle must have gone: one that wraps has no turns


def drum_ripples(runs: Sequence[PreparedRun], model: FrictionModel) -> list[Candidate]:
    """One wave, and one with its harmonics; none that the model has already."""
    most = min(int(FASTEST * runs[0].gear_ratio), MOST_ORDERS) if runs else 0
    orders = {ONE: ("k_d", most), HARMONICS: ("k_dh", most // HIGHEST_HARMONIC)}
    return [
        replace(
            friction_candidate(
                term_named(name), law_name=name, needs=("shaft_angle",), blind=_no_turns, continuous=(),
                shapes=partial(_whole_orders, order, highest),
            ),
            name=CAUSE,
        )
        for name, (order, highest) in orders.items()
        if highest and name not in model.term_names
    ]  # fmt: skip


def _whole_orders(name: str, highest: int, _: Sequence[PreparedRun]) -> list[Shape]:
    return [Shape(label_of({name: float(k)}), {name: float(k)}) for k in range(1, highest + 1)]


def _no_turns(runs: Sequence[PreparedRun]) -> tuple[str, str] | None:
    """What repeats shows where it has repeated, over an angle that is counted on from turn to turn."""
    if (reason := no_load(runs)) is not None:
        return reason
    turns = [_turned(run) for run in runs]
    if sum(each >= LEAST_TURN for each in turns) >= 2:
        return None
    return "shaft_angle", "no two runs turn the drum once, by an angle that counts its turns"


def _turned(run: PreparedRun) -> float:
    """Turns of the drum that the angle covers; none where it does not follow the speed."""
    covered, told = float(np.ptp(run.angle)), float(np.ptp(np.cumsum(run.speed))) * run.dt
    return covered / run.gear_ratio / (2.0 * np.pi) if covered >= COUNTED * told else 0.0
