"""The likeliest mistake of a diagnosis as a finding: in words, with what it leaves and what it is hardly told from."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from winch_friction.commissioning.channels import Finding, run_words, runs_say
from winch_friction.commissioning.diagnose import Diagnosis, Hypothesis
from winch_friction.commissioning.kinematics import CONTRADICTS
from winch_friction.physics.winch.crane import Crane

HINTS = 0.8  # of a misfit: a mistake that leaves more of it is no hint, be it the nearest of all
RIVALS = 12.0  # score by which another mistake may be worse and still be told beside the likeliest


def likeliest_mistake(diagnosis: Diagnosis, crane: Crane) -> list[Finding]:
    """What the balance says, or that no single mistake closes it; nothing where the runs fit as they stand.

    Of a hydraulic winch it is known what friction is ordinary; of another drive, whose friction and inertia may be most
    of its torque, a misfit is worth a word and refutes nothing; but neither turns a sign round in some of the runs.
    """
    findings = _mistake(diagnosis, crane)
    if crane.drive.hydraulic or _turned_in_some(diagnosis):
        return findings
    return [replace(each, severity="warning") if each.contradicts else each for each in findings]


def _turned_in_some(diagnosis: Diagnosis) -> bool:
    """Whether a sign is the other way round in some of the runs alone, and all of them fit once it is turned back."""
    best = diagnosis.best
    if best is None or best.mistake.cause != "sign":
        return False
    return len(best.runs) < len(diagnosis.names) and max(best.scores) <= CONTRADICTS


def _mistake(diagnosis: Diagnosis, crane: Crane) -> list[Finding]:
    best, bad = diagnosis.best, diagnosis.contradicting
    if best is None:
        return [_unexplained(diagnosis, crane)] if bad else []
    # a channel that only tells the speed again is not used by the balance: the rest fits without it
    harmless = best.mistake.cause == "companion" and max(best.scores) < CONTRADICTS
    rivals = [
        each
        for each in diagnosis.hypotheses
        if each is not best and each.score < best.score + RIVALS and each.mistake.cause != "companion"
    ]
    words = f"{best.mistake.words}; {_proof(diagnosis, best)}"
    if rivals:
        words += f"; hardly to be told from: {'; '.join(each.mistake.words for each in rivals[:3])}"
    severity, found = "warning" if harmless else "error", best.mistake
    return [Finding(severity, found.cause, words, found.channel, best.runs, _evidence(diagnosis, best, rivals))]


def _proof(diagnosis: Diagnosis, best: Hypothesis) -> str:
    told = runs_say(best.runs, len(diagnosis.names), "fit")
    # of the runs that hold the mistake: sound ones of heave compensation leave more N m, and inertia explains these
    open_ = [each for each in diagnosis.closures if each.run in best.runs and each.before == each.before]
    balance = ""
    if open_:
        worst = max(open_, key=lambda each: each.score)
        balance = f" (the torque balance of {worst.run} is off by {worst.before:.3g} N m RMS)"
    misfit = f"misfit {diagnosis.score:.3g} -> {best.score:.3g}{balance}"
    if max(best.scores) > CONTRADICTS:
        return f"with that put right {told} the crane better and not well, so there is more amiss: {misfit}"
    return f"with that put right {told} the crane: {misfit}"


def _evidence(diagnosis: Diagnosis, best: Hypothesis, rivals: Sequence[Hypothesis]) -> dict[str, object]:
    ranked = [
        {"cause": h.mistake.cause, "channel": h.mistake.channel, "words": h.mistake.words, "misfit": h.score}
        for h in diagnosis.hypotheses[:6]
    ]
    return {
        "misfit_before": diagnosis.score,
        "misfit_after": best.score,
        "factor": best.mistake.factor if best.mistake.factor == best.mistake.factor else None,
        "contradicting_runs": list(diagnosis.contradicting),
        "or": [h.mistake.words for h in rivals],
        "ranking": ranked,
    }


def _unexplained(diagnosis: Diagnosis, crane: Crane) -> Finding:
    bad = diagnosis.contradicting
    worst = max(range(len(diagnosis.scores)), key=lambda k: diagnosis.scores[k])
    closure = diagnosis.closures[worst]
    runs = run_words(bad, len(diagnosis.names))
    off = (
        f"the torque balance of {closure.run} is off by {closure.before:.3g} N m RMS where the load's torque is "
        f"{closure.level:.3g} N m"
    )
    if not np.isfinite(closure.before):
        off = (
            f"{closure.run} does not move long enough for a torque balance, and its values by themselves are beyond "
            f"what the crane can do (misfit {diagnosis.scores[worst]:.3g}, limit {CONTRADICTS:.3g})"
        )
    if not crane.drive.hydraulic:
        words = (
            f"{runs_say(bad, len(diagnosis.names), 'leave')} the torque "
            f"balance open and no single mistake closes it: {off}; of a drive of kind "
            f"'{crane.drive.kind}' friction and inertia are not known beforehand, so this may be the winch itself: "
            "winch-friction gap says what is missing"
        )
        return Finding("error", "unexplained", words, "", bad, {"misfit_before": diagnosis.score, "limit": CONTRADICTS})
    words = f"{runs} cannot be this crane's and no single mistake explains it: {off}; check crane file, units and signs"
    words += " one by one"
    nearest = diagnosis.hypotheses[0] if diagnosis.hypotheses else None
    if nearest is not None and nearest.score < HINTS * diagnosis.score:
        words += f"; nearest: {nearest.mistake.words} (misfit {diagnosis.score:.3g} -> {nearest.score:.3g})"
    return Finding("error", "unexplained", words, "", bad, {"misfit_before": diagnosis.score, "limit": CONTRADICTS})
