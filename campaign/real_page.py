"""The page of `make campaign-real`: what is expected of each real data set beside what came out."""

from pathlib import Path
from typing import Any

import numpy as np

from campaign.commit import commit
from campaign.real import Outcome, loss_by_cycle, power_error, power_of
from winch_friction.records.crane_file import load_crane

EXPECTED = {
    "winch_100kw": (
        "The 100 kW winch of a kite power station",
        "Least squares with hindsight: inertia 4989 kg at the rope, Coulomb 441 N, viscous 216 N s/m, gain 1.118 (or a "
        "load-proportional loss: the data hardly tell the two apart); power error 0.83 with the rope force alone, 0.25 "
        "with all of it.",
    ),
    "worm_drive": (
        "A worm drive that winds a weight",
        "Published: Coulomb and viscous friction of the supports, thread friction that is load-proportional and "
        "depends on the direction, Stribeck. One load only: an offset and a load-proportional loss cannot be told "
        "apart.",
    ),
    "emps": (
        "EMPS, a ball-screw drive",
        "Published: Coulomb 20.39 N, offset -3.165 N, viscous friction 166.7 N s/m one way and 240.4 the "
        "other (half the difference: -36.9); nothing after that.",
    ),
}


NOTES = {
    "winch_100kw": "Beside what is expected: the inertia lies a few percent low, the losses are named as viscous with "
    "a loss that depends on the load instead of Coulomb and viscous with a gain, and check takes the unknown inertia "
    "for data of another crane.",
    "worm_drive": "Beside what is expected: nothing of the published friction is named, which is missed. The log has "
    "no load, and these runs give the workflow none.",
    "emps": "Beside what is expected: Coulomb, offset and asymmetry are named and nothing else; check refuses the run "
    "all the same.",
}


def page(outcomes: list[Outcome], images: Path) -> str:
    """The page; pictures go to `images`."""
    lines = [
        "# Real winches and drives", "",
        f"`make campaign-real` (commit {commit()}): import, check, gap and replay as a user types them. What is "
        "physically expected stands beside what came out, whatever it is. Sources and licences: `ATTRIBUTION.md` in "
        "the folders of `config/examples`; EMPS: Janot, Gautier, Brunot 2019, whose data are not shipped.", "",
    ]  # fmt: skip
    for outcome in outcomes:
        title, expected = EXPECTED[outcome.study.name]
        lines += [f"## {title}", "", f"Logs: {len(outcome.study.logs)}. Expected: {expected}", "", *_steps(outcome), ""]
        if outcome.gap:
            lines += [*_found(outcome), ""]
            lines += [NOTES[outcome.study.name], ""]
        if outcome.gap and outcome.study.name == "winch_100kw":
            lines += [*_winch(outcome, images), ""]
    lines += [
        "## A ship's heave", "",
        "`config/examples/ship_heave` is imported to a run with `heave_velocity`. A scenario cannot take a measured "
        "motion yet: it has not been sailed by the simulation.", "",
    ]  # fmt: skip
    return "\n".join(lines)


def _steps(outcome: Outcome) -> list[str]:
    rows = [
        f"| {verb} | {status} | {sentence.replace('|', '/') or 'done'} |" for verb, status, sentence in outcome.steps
    ]
    return ["| step | exit | said |", "|---|---|---|", *rows]


def _found(outcome: Outcome) -> list[str]:
    found, locked = outcome.gap, outcome.gap["gap"]["holdout"]
    rows = []
    for each in found["effects"]:
        sizes = ", ".join(f"{k} = {_size(p)} {p.get('unit', '')}" for k, p in each["parameters"].items())
        rivals = ", ".join(str(r) for r in each["indistinguishable_from"]) or "-"
        rows.append(f"| {each['name']} | {sizes} | {rivals} |")
    table = ["| effect | size, 95 % | or |", "|---|---|---|", *rows] if rows else ["No effect was named."]
    unit = found["gap"]["unit"]
    return [
        f"From `{outcome.study.model}`: verdict **{found['verdict']}**. Locked runs: {locked['before']:.3g} -> "
        f"{locked['after']:.3g} {unit} (relative {locked['relative_before']:.3f} -> {locked['relative_after']:.3f}), "
        f"noise floor {locked['noise_floor']:.3g} {unit}.",
        "", *table,
    ]  # fmt: skip


def _size(parameter: dict[str, Any]) -> str:
    value, std = parameter["value"], parameter.get("std")
    return f"{value:.4g}" if not std else f"{value:.4g} ± {1.96 * std:.2g}"


def _winch(outcome: Outcome, images: Path) -> list[str]:
    crane, every = load_crane(outcome.study.crane), outcome.study.every
    others = [path for k, path in enumerate(outcome.runs) if k % every]
    alone, repaired = (power_error(others, crane, model) for model in (outcome.study.model, outcome.written))
    drift = loss_by_cycle(outcome.runs, crane, outcome.written)
    slope = float(np.polyfit(*zip(*drift, strict=True), 1)[0])
    _draw(outcome, others[0], images / "real_winch_100kw.png", drift)
    return [
        f"Relative error of the power on the {len(others)} cycles that the workflow never saw, from the written "
        f"`model.yaml` read back: {alone:.3f} with the rope force alone, {repaired:.3f} repaired (bar 0.26: "
        f"{'reached' if repaired <= 0.26 else 'missed'}).",
        "",
        f"Over {drift[-1][0]:.1f} h the loss beyond that model changes by {slope:+.0f} N per hour. No temperature was "
        "logged: warming oil or bearings and running-in or wear make the same change, so the cause is **undecided "
        "between temperature and wear**. The workflow itself does not report this drift; the campaign does.",
        "", "![power of a cycle that was not used, and the loss over three hours](images/real_winch_100kw.png)",
    ]  # fmt: skip


def _draw(outcome: Outcome, path: Path, target: Path, drift: list[tuple[float, float]]) -> None:
    from matplotlib.figure import Figure

    crane = load_crane(outcome.study.crane)
    figure = Figure(figsize=(9.0, 6.0), layout="constrained")
    above, below = figure.subplots(2, 1)
    run, alone = power_of(path, crane, outcome.study.model)
    time = run.time - run.time[0]
    above.plot(time, 1e-3 * run["mechanical_power"], "k", linewidth=0.8, label="measured")
    above.plot(time, 1e-3 * alone, color="tab:orange", linewidth=0.8, label="rope force alone")
    above.plot(
        time, 1e-3 * power_of(path, crane, outcome.written)[1], color="tab:blue", linewidth=0.8, label="repaired"
    )
    above.set(xlabel="time [s]", ylabel="power [kW]", title=f"{path.stem}, not used for the fit")
    above.legend()
    below.plot(*zip(*drift, strict=True), "o-", color="tab:blue")
    below.set(xlabel="time since the first cycle [h]", ylabel="loss beyond the model [N]")
    target.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(target, dpi=90)
