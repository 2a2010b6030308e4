"""Can these runs be this crane's? The quick part, which `identify`, `replay` and `gap` ask first.

Every channel by itself, the runs against each other, sensors that are not there, and the single mistakes.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from winch_friction.commissioning.channels import (
    SEVERITIES,
    Finding,
    cell_findings,
    clock_findings,
    first_contradiction,
    frozen_findings,
    group_findings,
    run_words,
    runs_say,
    told_slow_clock,
)
from winch_friction.commissioning.diagnose import Diagnosis, Hypothesis, diagnose
from winch_friction.commissioning.kinematics import CONTRADICTS, Fit, agreements, fit_of
from winch_friction.commissioning.mistakes import LARGEST_TARE, PRESSURE_UNITS
from winch_friction.commissioning.readings import COUNTED, reading_findings
from winch_friction.commissioning.simulated import simulated_findings
from winch_friction.commissioning.view import RunView, views_of
from winch_friction.physics.channels import BAR, GRAVITY, RPM
from winch_friction.physics.corrections import corrected
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import Run
from winch_friction.physics.winch.crane import Crane
from winch_friction.records.crane_file import load_crane
from winch_friction.records.runs import apart
from winch_friction.records.strict_yaml import config_directory, read_yaml

# -- runs against each other
FEWEST = 3  # runs of a motor group, for most of them to say what is usual
ALIKE = 1.25  # times: boost pressures of one machine differ by less, most of the time
EXACT = 0.05  # relative, by which a unit's factor is met


def lone_units(runs: Sequence[Run]) -> Iterator[Finding]:
    """Port B of a motor group, whose pressure is the boost's, off by exactly a unit in some of the runs: too little to
    upset the torque balance, and no friction whatever."""
    channels = dict.fromkeys(name for run in runs for name in run.columns if name.endswith(".pressure_b"))
    for channel in channels:
        own = [run for run in runs if channel in run.columns]
        medians = np.array([float(np.nanmedian(run[channel])) for run in own])
        if len(own) < FEWEST or not np.all(medians > 0.0):
            continue
        usual = float(np.median(medians))
        alike = (medians < ALIKE * usual) & (medians > usual / ALIKE)
        if 2 * alike.sum() <= len(own):
            continue
        for factor, words in PRESSURE_UNITS:
            odd = ~alike & (np.abs(medians * factor / usual - 1.0) < EXACT)
            if odd.any():
                names = tuple(run.name for run, off in zip(own, odd, strict=True) if off)
                said = (
                    f"{', '.join(names)}: {channel} is {np.median(medians[odd]) / BAR:.3g} bar, in the other runs "
                    f"{usual / BAR:.3g}: {words} there?"
                )
                yield Finding("error", "unit", said, channel, names, {"factor": factor, "usual": usual})


# -- channels that nobody measured
WIRE_MOVED = 0.5  # m of wire that came or went while motor_speed stood: five steps of a coarse counter


def dead_findings(runs: Sequence[Run], views: Sequence[RunView]) -> Iterator[Finding]:
    """A speed that stands while the wire runs, a hook load of nothing while the motors hold tonnes, or below nothing.

    `views` are the runs' own, in their order; both of hydraulic winches. Data with either contradict the crane.
    """
    for run, view in zip(runs, views, strict=True):
        yield from _speed(run)
        yield from _load(run, view)


def _speed(run: Run) -> Iterator[Finding]:
    speed = run["motor_speed"][np.isfinite(run["motor_speed"])]
    if not speed.size or np.ptp(speed) > 0.0 or "wire_out" not in run:
        return
    known = run["wire_out"][np.isfinite(run["wire_out"])]
    moved = float(np.ptp(known)) if known.size else 0.0
    if moved > WIRE_MOVED:
        said = (
            f"{run.name}: motor_speed never changes ({speed[0] / RPM:.3g} rpm) though wire_out moves by "
            f"{moved:.3g} m: is the sensor connected?"
        )
        yield Finding("error", "stuck", said, "motor_speed", (run.name,), {"wire_moved": moved})


def _load(run: Run, view: RunView) -> Iterator[Finding]:
    if "hook_load" not in run or not view.groups:
        return
    load, lever = run["hook_load"][np.isfinite(run["hook_load"])], float(np.median(view.lever))
    held = float(np.nanmean(view.drive_torque)) / (GRAVITY * lever)
    least = LARGEST_TARE * view.rated_torque / (GRAVITY * lever)  # what hook, block and wire may weigh
    if load.size and np.ptp(load) == 0.0 and abs(load[0]) < 0.01 * least < held and held > least:
        said = (
            f"{run.name}: hook_load is {load[0] / 1e3:.3g} t throughout though the motors hold about {held / 1e3:.3g} "
            "t: is the load cell connected? (a known load: import --set 'hook_load.constant=... t')"
        )
        yield Finding("error", "cell", said, "hook_load", (run.name,), {"held": held})
    usual = float(np.median(load)) if load.size else 0.0
    if usual < -least:  # swapped ports would close the balance of a mass that is drawn upwards
        said = (
            f"{run.name}: hook_load is {usual / 1e3:.3g} t, and what hangs has no negative mass: turn its sign (import "
            "--set hook_load.sign=-1)"
        )
        yield Finding("error", "sign", said, "hook_load", (run.name,), {"usual": usual})


# -- the quick check
RIVALS = 12.0  # score by which another mistake may be worse and still be told beside the likeliest
MOST_FILES = 40  # crane files of a folder that are looked at


def quick_check(
    runs: Sequence[Run], crane: Crane, model: FrictionModel | None = None, others: Mapping[str, Crane] | None = None
) -> list[Finding]:
    """What speaks against these runs being this crane's, the likeliest mistake first; below a second for a dozen runs.

    `others` are cranes that the runs might be of instead, by name (default: the shipped ones). An empty list, or one
    without an `error`, means that ordinary friction and ordinary sensor errors explain the runs."""
    return diagnosed(apart(runs)[0], crane, model, others)[0]


def diagnosed(
    runs: Sequence[Run], crane: Crane, model: FrictionModel | None, others: Mapping[str, Crane] | None,
    ranked: bool = False,
) -> tuple[list[Finding], Fit]:  # fmt: skip
    """The findings of `quick_check` and how the runs fit: diagnosed where they are doubted or `ranked`."""
    others = shipped_cranes() if others is None else others
    known = {name: each for name, each in others.items() if each != crane}
    clock = [finding for run in runs for finding in clock_findings(run)]
    jumped = {name for finding in clock if finding.contradicts for name in finding.runs}
    usable = [run for run in runs if run.name not in jumped]
    own = model if model is not None and model.corrections else None
    views = views_of([corrected(run, crane, own) if own else (run, crane) for run in usable])
    fit = fit_of(views, model)
    diagnosis = diagnose(fit, views, crane, model, known) if ranked or fit.doubted else None
    told = [{each.channel: each.ratio for each in agreements(view)} for view in views]
    slow = [each for run, ratios in zip(usable, told, strict=True) for each in told_slow_clock(run, ratios)]
    readings = [*reading_findings(runs, crane)]
    findings = [
        *_named_crane(runs, crane, others),
        *(each for each in readings if each.cause == COUNTED),
        *slow,
        *simulated_findings(runs, crane.drive.hydraulic),
        *(dead_findings(usable, views) if crane.drive.hydraulic else ()),
        *(lone_units(usable) if crane.drive.hydraulic else ()),
        *(group_findings(usable, crane, fit.contradicting) if crane.drive.hydraulic else ()),
        *(() if slow or diagnosis is None else _trusted(_mistake(diagnosis, crane), crane)),
        *(each for each in readings if each.cause != COUNTED),
        *(finding for run in runs if crane.drive.hydraulic for finding in frozen_findings(run)),
        *(finding for run in runs for finding in cell_findings(run)),
        *clock,
    ]
    return sorted(findings, key=lambda finding: SEVERITIES.index(finding.severity)), diagnosis or fit


def _trusted(findings: list[Finding], crane: Crane) -> list[Finding]:
    """What the balance says: of a hydraulic winch it is known what friction is ordinary; of another drive, whose
    friction and inertia may be most of its torque, a misfit is worth a word and refutes nothing."""
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
    severity, found = "warning" if harmless else "error", best.mistake
    return [Finding(severity, found.cause, words, found.channel, best.runs, _evidence(diagnosis, best, rivals))]


def _proof(diagnosis: Diagnosis, best: Hypothesis) -> str:
    told = runs_say(best.runs, len(diagnosis.names), "fit")
    worst = max(diagnosis.closures, key=lambda each: each.before if each.before == each.before else -1.0)
    balance = ""
    if worst.before == worst.before:
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
    words = f"{runs_say(names, len(runs), 'say')} that they are of crane '{', '.join(machines)}', not of '{crane.name}'"
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
        except InputError:  # not a crane file that can be read: nothing to compare with
            continue
    return found


def refuse(findings: Sequence[Finding]) -> None:
    """Raise `InputError` with the likeliest mistake where the data contradict the crane."""
    if (finding := first_contradiction(findings)) is not None:
        raise InputError(f"{finding.sentence} (see winch-friction check; --force goes on regardless)")
