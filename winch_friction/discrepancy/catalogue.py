"""All candidates: the shipped ones, a user's own, those that speak of what these runs have covered, and what the
channels at hand cannot show.

Those that repeat with the turns of the drum are made for a crane: an eccentric drum, an oval one, the planets and
wheels of its gear, whole numbers of periods per turn of the drum, a share of the load's torque, whichever way it turns.
They are slower than a block, so that a regression sees them; a ripple of the motor's own turn is too fast for blocks
and has a detector of its own.

No run tells of another which state it was in, as whether a brake hangs; the first half of its own samples does. The
second half, and with locked runs everything that their names are proven on, is judged by one size for all runs and one
yes or no for each.
"""

from collections.abc import Collection, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from winch_friction.discrepancy.candidates.candidate import (
    ANGLE,
    FLOW,
    Candidate,
    Shape,
    Untestable,
    label_of,
    own_group_shapes,
)
from winch_friction.discrepancy.candidates.creep import creeping_candidates, gas_candidates
from winch_friction.discrepancy.candidates.families import free_members, literature
from winch_friction.discrepancy.candidates.feedback import bends_over, feedback_candidates
from winch_friction.discrepancy.candidates.friction import friction_candidate, no_load, shipped_friction
from winch_friction.discrepancy.candidates.geometry import geometry_candidates, layers_apart
from winch_friction.discrepancy.candidates.signals import by_port, signal_candidates
from winch_friction.discrepancy.logged_causes import follows_a_signal
from winch_friction.discrepancy.preparation.grid import overlaps
from winch_friction.discrepancy.preparation.prepare import PreparedRun
from winch_friction.discrepancy.regressors import base_of, build_problem, layout_of
from winch_friction.discrepancy.run_states import BRAKE, WEAR, in_each_run, in_some_runs, levels_of, two_levels
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel, term_named
from winch_friction.physics.friction.term import load_file

# -- turns of the drum
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


# -- all of them
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
        *creeping_candidates(),
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
    own = [*bends_over(runs), *layers_apart(runs), *drum_ripples(runs, model), *free_members(runs, model)]
    return [*all_candidates(effects_file), *own]


def of_one_group(runs: Sequence[PreparedRun]) -> list[Candidate]:
    """Zero and gain errors of one driving group alone, where there are two: whatever hoisting and heave compensation
    differ by looks a little like one, so they are for what nothing else explains."""
    own = own_group_shapes(runs)
    shapes = {"pressure_offset": own, "swivel_offset": own, "pressure_scale": by_port(own)}
    plain = [each for each in (*signal_candidates(), *feedback_candidates()) if not each.law_name]
    return [
        replace(each, law_name="of one driving group", shapes=partial(_given, shapes[each.name]))
        for each in plain
        if shapes.get(each.name)
    ]


def _given(shapes: list[Shape], _: Sequence[PreparedRun]) -> list[Shape]:
    return shapes


ANEW = "the runs' clocks begin anew with each; for a wear, and what only some runs have, give times that go on"


def testable(
    candidates: Sequence[Candidate], runs: Sequence[PreparedRun], model: FrictionModel
) -> tuple[list[Candidate], list[Untestable]]:
    """Split by the channels at hand, by the dates told and by what the model already has."""
    usable: list[Candidate] = []
    blind: list[Untestable] = []
    # two cuts of one recording may overlap, and most share a row at their seam
    anew = 0 < len(runs) - 1 <= 2 * overlaps(((run.start, run.start + float(run.time[-1])) for run in runs), 0.5)
    for each in candidates:
        if each.presumes and not set(each.presumes) & set(model.term_names):
            continue
        reason = each.untestable(runs)
        if reason is None and anew and each.name in (BRAKE, WEAR) and "time" in each.signals:
            reason = Untestable(each.name, each.latex, "time", ANEW)
        if reason is None:
            usable.append(each)
        else:
            blind.append(reason)
    seen = {each.name for each in usable}
    own = {each.name: each for each in reversed(blind) if each.name not in seen}
    return usable, list(reversed(own.values()))


# -- what these runs show in two levels, or by another amount each
SIGNALS = ("pressure_offset", "pressure_scale", "swivel_offset", "signal_delay", "tare_load")


def at_hand(runs: Sequence[PreparedRun], model: FrictionModel, effects_file: Path | None = None) -> list[Candidate]:
    """All that a search of these runs begins with: every candidate, and what they show in two levels."""
    return [*candidates_for(runs, model, effects_file), *run_states(runs, model)]


def run_states(runs: Sequence[PreparedRun], model: FrictionModel) -> list[Candidate]:
    """Candidates for what these runs show in two levels and nothing that was logged tells apart."""
    if len(runs) < LIMITS.fewest_levels:
        return []
    every = [*shipped_friction(), *signal_candidates(), *feedback_candidates(), *geometry_candidates()]
    known = [each for each in every if each.name in (BRAKE, *SIGNALS) and not each.law_name]
    known = [each for each in known if each.untestable(runs) is None]
    known = [each for each in known if not each.presumes or set(each.presumes) & set(model.term_names)]
    layout = layout_of(base_of(model, model), known, runs, model)
    problem = build_problem(runs, layout)
    found = []
    for slot in problem.slots:
        levels, deviations = levels_of(problem, slot, len(runs))
        there = two_levels(levels, deviations, np.array([float(np.median(run.load)) for run in runs]))
        if there is not None:
            found += in_some_runs(slot, runs, levels, there)
    return found


def another_in_each_run(train: Collection[str], runs: Sequence[PreparedRun], model: FrictionModel) -> list[Candidate]:
    """A brake that drags by another amount in every run, that of a locked one told by its first half; none where a
    logged signal tells the amounts. Twelve amounts imitate much: it is for what nothing else explains. Every run has a
    date of its own, so that a wear by whatever law of the date, a seal that was renewed, is the same.
    """
    brake = next(each for each in shipped_friction() if each.name == BRAKE and not each.law_name)
    if len(runs) < LIMITS.fewest_levels or not set(brake.presumes) & set(model.term_names):
        return []
    problem = build_problem(runs, layout_of(base_of(model, model), [brake], runs, model))
    levels, _ = levels_of(problem, problem.slots[0], len(runs), [run.name in train for run in runs])
    known = np.isfinite(levels)  # a run whose torque cannot be closed tells nothing, and needs nothing
    runs, levels = [run for run, has in zip(runs, known, strict=True) if has], levels[known]
    if len(runs) < LIMITS.fewest_levels or levels.max() <= 0.0 or follows_a_signal(runs, levels):
        return []
    return in_each_run(runs, levels)
