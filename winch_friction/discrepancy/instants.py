"""Instants between two training runs at which something changed, placed among the locked runs that lie between."""

from dataclasses import replace

import numpy as np

from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.engine.crossfit import CrossFit, Explanation
from winch_friction.discrepancy.holdout import Split
from winch_friction.discrepancy.search import Search


def placed(search: Search, split: Split) -> Search:
    """The search with each effect that has an instant at the one that the locked runs tell by their first halves.

    The training runs say between which two of them a machine changed, and of the instants between these they cannot
    say more: on them the columns are the same. A locked run between was before the change or after it, as it is in a
    state (`run_states`): the first half of its samples says which, and all of it is what the names are proven on.
    """
    for k, slot in enumerate(search.selection.final.slots):
        if others := _same_on_training(search.cross, slot):
            search = _told(search, k, [slot, *others], split)
    return search


def _same_on_training(cross: CrossFit, slot: Slot) -> list[Slot]:
    """Other shapes of the same law whose columns are the same over the training runs."""
    x = cross.problem.blocks.x
    alike = [each for each in cross.problem.slots if (each.name, each.law) == (slot.name, slot.law)]
    own = x[:, slot.columns]
    return [each for each in alike if each.columns != slot.columns and np.array_equal(x[:, each.columns], own)]


def _told(search: Search, k: int, shapes: list[Slot], split: Split) -> Search:
    """The search with that of the shapes for its effect number `k` that leaves least of the locked runs' first
    halves."""
    selection, final = search.selection, search.selection.final
    sets = [(*final.slots[:k], each, *final.slots[k + 1 :]) for each in shapes]
    locked = search.expansion.cross(split.holdout, final.slots)
    best = min(sets, key=lambda slots: _left_of_first_halves(locked, replace(final, slots=slots)))
    found = [replace(each, slot=best[k]) if each.slot is final.slots[k] else each for each in selection.found]
    return replace(search, selection=replace(selection, final=search.cross.explain(best), found=tuple(found)))


def _left_of_first_halves(locked: CrossFit, explanation: Explanation) -> float:
    """Sum of squares, in units of the noise, that an explanation of the training runs leaves of the first half of every
    locked run."""
    blocks, left = locked.problem.blocks, locked.remainder(explanation)
    runs = range(int(blocks.run.max(initial=-1)) + 1)
    half = np.array([np.median(blocks.position[blocks.run == k]) if (blocks.run == k).any() else 0 for k in runs])
    return float((left[blocks.position <= half[blocks.run]] ** 2).sum()) if len(left) else 0.0
