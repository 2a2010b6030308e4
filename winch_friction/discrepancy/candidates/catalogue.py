"""All candidates: the shipped ones, a user's own, and what the channels at hand cannot show."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from winch_friction.discrepancy.candidates.bends import bends_over
from winch_friction.discrepancy.candidates.candidate import ANGLE, FLOW, Candidate, Untestable
from winch_friction.discrepancy.candidates.drum_turn import drum_ripples
from winch_friction.discrepancy.candidates.families import free_members, literature
from winch_friction.discrepancy.candidates.feedback import feedback_candidates
from winch_friction.discrepancy.candidates.friction import friction_candidate, shipped_friction
from winch_friction.discrepancy.candidates.gas import gas_candidates
from winch_friction.discrepancy.candidates.geometry import geometry_candidates
from winch_friction.discrepancy.candidates.signals import signal_candidates
from winch_friction.discrepancy.preparation.prepared_run import PreparedRun
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.friction.registry import load_file


def _no_command(runs: Sequence[PreparedRun]) -> tuple[str, str] | None:
    known = any("speed_reference" in run.present for run in runs)
    return None if known else ("speed_reference", "lost flow shows only against a commanded speed")


# these leave the torque balance at the motor shaft closed, whatever their size, or vanish in its block means
DETECTED = (
    Candidate("entrained_air", r"V\,p^{-1/1.4}", regime=FLOW, kind="flow", hydraulic=True, blind=_no_command),
    Candidate("slip_leakage", r"C\,p/\mu", regime=FLOW, kind="flow", hydraulic=True, blind=_no_command),
    Candidate("torque_ripple", term=None, regime=ANGLE),
)


def all_candidates(effects_file: Path | None = None) -> list[Candidate]:
    """Every candidate, with those that a user's file registers as terms; a clash of names raises `InputError`."""
    found = [
        *DETECTED,
        *shipped_friction(),
        *signal_candidates(),
        *feedback_candidates(),
        *gas_candidates(),
        *geometry_candidates(),
    ]
    if effects_file is not None:
        found += [replace(friction_candidate(term), own_size=True) for term in load_file(Path(effects_file))]
    found += literature()
    names = [each.name for each in found if not each.law_name]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise InputError(f"{effects_file}: effect '{twice[0]}' exists already; give it another name")
    return found


def candidates_for(
    runs: Sequence[PreparedRun], model: FrictionModel, effects_file: Path | None = None
) -> list[Candidate]:
    """Every candidate, those that speak of what these runs have covered, and of each family the free member."""
    own = [*bends_over(runs), *drum_ripples(runs, model), *free_members(runs, model)]
    return [*all_candidates(effects_file), *own]


def testable(
    candidates: Sequence[Candidate], runs: Sequence[PreparedRun], model: FrictionModel
) -> tuple[list[Candidate], list[Untestable]]:
    """Split by the channels at hand and by what the model already has."""
    usable: list[Candidate] = []
    blind: list[Untestable] = []
    for each in candidates:
        if each.presumes and not set(each.presumes) & set(model.term_names):
            continue
        reason = each.untestable(runs)
        if reason is None:
            usable.append(each)
        else:
            blind.append(reason)
    seen = {each.name for each in usable}
    own = {each.name: each for each in reversed(blind) if each.name not in seen}
    return usable, list(reversed(own.values()))
