"""All candidates: the shipped ones, a user's own, and what the channels at hand cannot show."""

from collections.abc import Sequence
from pathlib import Path

from winch_friction.discrepancy.candidates.accumulator import accumulator_candidates
from winch_friction.discrepancy.candidates.candidate import Candidate, Untestable
from winch_friction.discrepancy.candidates.friction import friction_candidate, shipped_friction
from winch_friction.discrepancy.candidates.geometry import geometry_candidates
from winch_friction.discrepancy.candidates.signals import signal_candidates
from winch_friction.discrepancy.preparation.prepared_run import PreparedRun
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.friction.registry import load_file

# these leave the torque balance at the motor shaft closed, whatever their size
LOST_FLOW = Untestable("slip_leakage", r"C\,p/\mu", "speed_reference", "lost flow shows only against a commanded speed")
SOFT_OIL = Untestable("entrained_air", r"K(p)", "pump flow", "a softer oil column changes the flow, not the torque")
ONE_SIDE = Untestable("accumulator_thermal", r"p V^n", "a passive motor group", "no run has one")


def all_candidates(effects_file: Path | None = None) -> list[Candidate]:
    """Every candidate, with those that a user's file registers as terms; a clash of names raises `InputError`."""
    found = [*shipped_friction(), *signal_candidates(), *accumulator_candidates(), *geometry_candidates()]
    if effects_file is not None:
        found += [friction_candidate(term) for term in load_file(Path(effects_file))]
    names = [each.name for each in found]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise InputError(f"{effects_file}: effect '{twice[0]}' exists already; give it another name")
    return found


def testable(
    candidates: Sequence[Candidate], runs: Sequence[PreparedRun], model: FrictionModel
) -> tuple[list[Candidate], list[Untestable]]:
    """Split by the channels at hand and by what the model already has."""
    present = frozenset.intersection(*(run.present for run in runs))
    hydraulic = any(run.groups for run in runs)
    several = any(len(run.groups) > 1 for run in runs)
    usable: list[Candidate] = []
    blind = [SOFT_OIL] if hydraulic else []
    if hydraulic and not any("speed_reference" in run.present for run in runs):
        blind.append(LOST_FLOW)
    for each in candidates:
        if each.name == ONE_SIDE.name and not several:
            blind += [ONE_SIDE] if hydraulic else []
            continue
        missing = [name for name in each.needs if name not in present]
        if each.presumes and not set(each.presumes) & set(model.term_names):
            continue
        if each.hydraulic and not hydraulic:
            blind.append(Untestable(each.name, each.law, "pressures", "an electric drive has none"))
        elif missing:
            blind.append(Untestable(each.name, each.law, missing[0], f"no run has '{missing[0]}' throughout"))
        else:
            usable.append(each)
    return usable, blind
