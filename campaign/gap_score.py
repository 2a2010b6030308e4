"""Judging one diagnosis (the content of gap.json) against what was hidden."""

from typing import Any

from campaign.gap_cases import Case
from campaign.rig import OUTSIDE_SIGNAL, cause_of

LARGEST_SET = 3
ONE_CAUSE = ("single", "law", "held_out", "drawn_law")
# a law of a cause that the package has another name for: a gain of the displacement's feedback is no offset
OWN_NAME = {"swivel_offset:gain": "displacement_scale"}


def score(case: Case, answer: dict[str, Any]) -> dict[str, Any]:
    """What the table needs of one answer: detected, right, wrong single names, gap reduction, signals."""
    truth = {name for effect, _ in case.effects for name in _names_of(effect)}
    sets = [{effect["name"], *effect.get("indistinguishable_from", [])} for effect in answer["effects"]]
    verdict = answer["verdict"]
    named = [each for each in sets if each & truth and len(each) <= LARGEST_SET]
    signals = (answer.get("unexplained") or {}).get("depends_on") or []
    return {
        "verdict": verdict,
        "sets": [sorted(each) for each in sets],
        "detected": verdict != "nothing_missing",
        "right": bool(named) and case.kind in ONE_CAUSE,
        "found": sum(any(_names_of(name) & each for each in sets) for name, _ in case.effects),
        "wrong_single": any(len(each) == 1 and not each & truth for each in sets),
        "wrong_entry": any(not each & truth for each in sets),
        "signals": signals,
        "right_signal": bool(signals) and signals[0] in _right_signals(case),
        "named": verdict in ("missing_effect", "ambiguous"),
        "seed_refuted": bool(answer.get("seed_refuted")) and not sets,
        **_proposed(case, answer),
        **_reduction(answer["gap"]),
    }


def _names_of(effect: str) -> set[str]:
    return {cause_of(effect), OWN_NAME.get(effect, cause_of(effect))}


def _proposed(case: Case, answer: dict[str, Any]) -> dict[str, Any]:
    """The first proposal: whether there is one, on the right signals, and what it closes of the locked gap."""
    proposals = answer.get("proposals") or []
    if not proposals:
        return {"proposed": False, "proposed_right": False, "closed": None}
    reads = {name.rpartition(".")[2] for name in proposals[0]["reads"]}
    right = {name.rpartition(".")[2] for name in _right_signals(case)}
    return {"proposed": True, "proposed_right": bool(reads & right), "closed": proposals[0]["holdout"]["closed"]}


def _right_signals(case: Case) -> tuple[str, ...]:
    return OUTSIDE_SIGNAL[case.effects[0][0]] if case.kind in ("outside", "drawn_outside") else ()


def _reduction(gap: dict[str, Any]) -> dict[str, float | None]:
    held = gap["holdout"]
    before, after, floor = held["before"], held["after"], held["noise_floor"]
    above = before - floor
    return {
        "before": before,
        "after": after,
        "floor": floor,
        "reduction": (before - after) / above if above > 0.02 * floor else None,
    }
