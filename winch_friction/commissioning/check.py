"""Can these runs be this crane's? The quick part, which `identify`, `replay` and `gap` ask first."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from winch_friction.commissioning.against import lone_units
from winch_friction.commissioning.channels import cell_findings, clock_findings, frozen_findings
from winch_friction.commissioning.dead import dead_findings
from winch_friction.commissioning.diagnose import CONTRADICTS, Diagnosis, Hypothesis, diagnose
from winch_friction.commissioning.finding import Finding, first_contradiction, run_words
from winch_friction.commissioning.view import views_of
from winch_friction.physics.corrections import corrected
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import Run
from winch_friction.physics.winch.crane import Crane
from winch_friction.records.crane_file import load_crane
from winch_friction.records.paths import config_directory
from winch_friction.records.strict_yaml import read_yaml

RIVALS = 12.0  # score by which another mistake may be worse and still be told beside the likeliest
MOST_FILES = 40  # crane files of a folder that are looked at


def quick_check(
    runs: Sequence[Run], crane: Crane, model: FrictionModel | None = None, others: Mapping[str, Crane] | None = None
) -> list[Finding]:
    """What speaks against these runs being this crane's, the likeliest mistake first; below a second for a dozen runs.

    `others` are cranes that the runs might be of instead, by name (default: the shipped ones). An empty list, or one
    without an `error`, means that ordinary friction and ordinary sensor errors explain the runs.
    """
    return diagnosed(runs, crane, model, others)[0]


def diagnosed(
    runs: Sequence[Run], crane: Crane, model: FrictionModel | None, others: Mapping[str, Crane] | None
) -> tuple[list[Finding], Diagnosis]:
    """The findings of `quick_check` and the diagnosis behind them."""
    others = shipped_cranes() if others is None else others
    known = {name: each for name, each in others.items() if each != crane}
    clock = [finding for run in runs for finding in clock_findings(run)]
    jumped = {name for finding in clock if finding.contradicts for name in finding.runs}
    usable = [run for run in runs if run.name not in jumped]
    views = views_of([corrected(run, crane, model) if model is not None else (run, crane) for run in usable])
    diagnosis = diagnose(views, crane, model, known)
    findings = [
        *_named_crane(runs, crane, others),
        *(dead_findings(usable, views) if crane.drive.hydraulic else ()),
        *(lone_units(usable) if crane.drive.hydraulic else ()),
        *_trusted(_mistake(diagnosis, crane), crane),
        *(finding for run in runs if crane.drive.hydraulic for finding in frozen_findings(run)),
        *(finding for run in runs for finding in cell_findings(run)),
        *clock,
    ]
    order = {"error": 0, "warning": 1, "note": 2}
    return sorted(findings, key=lambda finding: order[finding.severity]), diagnosis


def _trusted(findings: list[Finding], crane: Crane) -> list[Finding]:
    """What the balance says: of a hydraulic winch it is known what friction is ordinary; of another drive, whose
    friction and inertia may be most of its torque, a misfit is worth a word and refutes nothing.
    """
    if crane.drive.hydraulic:
        return findings
    return [replace(each, severity="warning") if each.contradicts else each for each in findings]


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
    return [
        Finding(
            "warning" if harmless else "error",
            best.mistake.cause,
            words,
            best.mistake.channel,
            best.runs,
            _evidence(diagnosis, best, rivals),
        )
    ]


def _proof(diagnosis: Diagnosis, best: Hypothesis) -> str:
    told = run_words(best.runs, len(diagnosis.names))
    worst = max(diagnosis.closures, key=lambda each: each.before if each.before == each.before else -1.0)
    balance = ""
    if worst.before == worst.before:
        balance = f" (the torque balance of {worst.run} is off by {worst.before:.3g} N m RMS)"
    misfit = f"misfit {diagnosis.score:.3g} -> {best.score:.3g}{balance}"
    if max(best.scores) > CONTRADICTS:
        return f"with that put right {told} fit the crane better and not well, so there is more amiss: {misfit}"
    return f"with that put right {told} fit the crane: {misfit}"


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
    if not crane.drive.hydraulic:
        words = (
            f"{runs} leave the torque balance open and no single mistake closes it: {off}; of a drive of kind "
            f"'{crane.drive.kind}' friction and inertia are not known beforehand, so this may be the winch itself: "
            "winch-friction gap says what is missing"
        )
        return Finding("error", "unexplained", words, "", bad, {"misfit_before": diagnosis.score, "limit": CONTRADICTS})
    words = f"{runs} cannot be this crane's and no single mistake explains it: {off}; check crane file, units and signs"
    words += " one by one"
    nearest = diagnosis.hypotheses[0] if diagnosis.hypotheses else None
    if nearest is not None and nearest.score < diagnosis.score:
        words += f"; nearest: {nearest.mistake.words} (misfit {diagnosis.score:.3g} -> {nearest.score:.3g})"
    return Finding("error", "unexplained", words, "", bad, {"misfit_before": diagnosis.score, "limit": CONTRADICTS})


def _named_crane(runs: Sequence[Run], crane: Crane, others: Mapping[str, Crane]) -> list[Finding]:
    """What the runs themselves say of their crane; a differing name alone is no contradiction, another machine is."""
    said = {run.name: str(run.metadata.get("crane") or "") for run in runs}
    foreign = {name: own for name, own in said.items() if own and own != crane.name}
    machines = sorted({own for own in foreign.values() if own in others and not same_machine(others[own], crane)})
    if not machines:
        return []
    names = tuple(name for name, own in foreign.items() if own in machines)
    words = f"{run_words(names, len(runs))} say that they are of crane '{', '.join(machines)}', not of '{crane.name}'"
    return [Finding("error", "crane", words, "", names, {"recorded": machines})]


def same_machine(first: Crane, second: Crane) -> bool:
    """Whether two cranes are one to the torque balance, whatever their names."""
    own = lambda c: (c.gear_ratio, c.drum.layer_radii, dict(c.groups), c.max_displacement, c.drive)
    return own(first) == own(second)


def shipped_cranes() -> dict[str, Crane]:
    """The shipped cranes by name."""
    return _cranes_in(config_directory() / "cranes")


def known_cranes(*places: Path) -> dict[str, Crane]:
    """The shipped cranes and those of crane files in these folders."""
    found = shipped_cranes()
    for place in dict.fromkeys(places):
        found |= _cranes_in(place)
    return found


def _cranes_in(folder: Path) -> dict[str, Crane]:
    found = {}
    for path in sorted(folder.glob("*.yaml"))[:MOST_FILES] if folder.is_dir() else ():
        try:
            content = read_yaml(path)
            if isinstance(content, dict) and str(content.get("schema", "")).startswith("winch_friction.crane/"):
                crane = load_crane(path)
                found[crane.name] = crane
        except InputError:
            continue  # not a crane file that can be read: nothing to compare with
    return found


def refuse(findings: Sequence[Finding]) -> None:
    """Raise `InputError` with the likeliest mistake where the data contradict the crane."""
    finding = first_contradiction(findings)
    if finding is not None:
        raise InputError(f"{finding.sentence} (see winch-friction check; --force goes on regardless)")
