"""The page of `make campaign-real`: what is expected of each real data set beside what came out."""

import json
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from campaign.commit import commit
from campaign.real import EXAMPLES, Outcome, loss_by_cycle, power_error, power_of, said_of
from campaign.real_splits import table
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
    "winch_100kw": "Beside what is expected: inertia, Coulomb and viscous friction and a gain are named, and nothing "
    "after them. The gain is a set: rope radius, load cell, or a loss that goes with the load and the direction are "
    "one column here. The values of hindsight, which knew all cycles, lie within the intervals.",
    "worm_drive": "The load is not in the log; the known weight is said (`hook_load.constant=0.096 kg`). Coulomb "
    "friction, load-proportional loss and Stribeck are one set at one load, and so are a torque offset, a tare and a "
    "load-proportional loss that depends on the direction, as expected. Not told apart: Stribeck from the rest, for it "
    "shows hoisting only and the other way round lowering. Torque ripple is named "
    "from the shaft's angle; the paper does not speak of it.",
    "emps": "Beside what is expected: Coulomb, offset and asymmetry are named and nothing else. The published offset "
    "is that of a symmetric fit; with the asymmetry beside it (36.5 N s/m at the mean speed of 0.08 m/s is 3.0 N) the "
    "offset is not told from zero, and is an extra name.",
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
        "`config/examples/ship_heave` is imported to a run with `heave_velocity`, and is the sea of the shipped "
        "scenario `ahc_measured_heave` (`sea: {kind: measured, file: ...}`), which `simulate`, `demo --scenario` and "
        "the closed-loop campaign sail. Simulated for 300 s (seed 0, 55 t, the crane tip follows 0.6 of the heave):",
        "", *_sailed(), "",
        "## Check of every shipped example", "",
        "`winch-friction check` on the examples of `config/examples`, imported by their own `map.yaml`, with nothing "
        "but the crane named. 0: nothing contradicts the crane; 2: something does.", "",
        *_checked(), "",
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
    with tempfile.TemporaryDirectory() as folder:
        split = table(outcome.runs, crane, outcome.study.model, Path(folder))
    return [
        f"Relative error of the power on the {len(others)} cycles that the workflow never saw, from the written "
        f"`model.yaml` read back: {alone:.3f} with the rope force alone, {repaired:.3f} repaired (bar 0.26: "
        f"{'reached' if repaired <= 0.26 else 'missed'}).",
        "",
        f"Over {drift[-1][0]:.1f} h the loss beyond that model changes by {slope:+.0f} N per hour over all cycles. The "
        "workflow says of the cycles that it saw:", "", *_drift_notes(outcome),
        "", "![power of a cycle that was not used, and the loss over three hours](images/real_winch_100kw.png)", "",
        "Other splits: the first six and seven cycles, and draws of three to ten (seed 11). Beside the error of the "
        "repaired file on the cycles that were not used stands the one of least squares of the power by the same four "
        "terms: fitted to the same cycles, which nothing of this form gets below but by chance, and fitted to the "
        "judged cycles themselves. Above the bar of 0.26 is bold.", "", *split, "",
        "After the first cycles alone the bar is out of reach of least squares as well: their losses are higher than "
        "those of the hours after them. Three cycles mostly do not do: what a third or fourth term gains hangs on a "
        "few stretches of time and is not significant, and what two terms leave is too much to be called explained.",
    ]  # fmt: skip


def _drift_notes(outcome: Outcome) -> list[str]:
    """What gap itself says of a loss that changes from run to run."""
    return [f"> {note}" for note in outcome.gap["notes"] if "between temperature and wear" in note] or ["> nothing"]


def _sailed() -> list[str]:
    """The shipped scenario in the measured heave, in the plant's own words."""
    from winch_friction.records.model_file import load_model
    from winch_friction.simulation import load_scenario, simulate

    scenario = load_scenario("ahc_measured_heave")
    done = simulate(scenario, load_crane("crane_150t"), load_model("a6vm215_crane2"), seed=0)
    heave, left = done.run["heave_velocity"], done.truth["position_error"]
    return [
        f"heave speed of the crane tip {np.std(heave):.2f} m/s RMS, at most {np.abs(heave).max():.2f} m/s; left of the "
        f"heave at the load, without friction feedforward: {1e3 * float(np.sqrt(np.mean(left**2))):.1f} mm RMS."
    ]


def _checked() -> list[str]:
    """A row per shipped example: how many runs, what check answers, how much it found."""
    lines = ["| example | runs | exit | said | warnings, notes |", "|---|---|---|---|---|"]
    for name, crane in (("practice_150t", "crane_150t"), ("winch_100kw", "winch_100kw"),
                        ("worm_drive", "worm_drive"), ("ship_heave", "crane_150t")):  # fmt: skip
        runs, status, said, findings = _check_of(EXAMPLES / name, crane)
        count = [sum(each["severity"] == kind for each in findings) for kind in ("warning", "note")]
        lines.append(f"| {name} | {runs} | {status} | {said} | {count[0]}, {count[1]} |")
    return lines


def _check_of(example: Path, crane: str) -> tuple[int, int, str, list[dict[str, Any]]]:
    with tempfile.TemporaryDirectory() as folder:
        runs, mapped = sorted(example.glob("*.parquet")), example / "map.yaml"
        if mapped.is_file():
            logs = sorted(map(str, example.glob("*.csv")))
            said_of(["import", *logs, "--map", str(mapped), "--out", f"{folder}/runs"])
            runs = sorted(Path(folder, "runs").glob("*.csv"))
        arguments = ["check", *map(str, runs), "--crane", crane, "--out", f"{folder}/check"]
        status, printed, errors = said_of(arguments)
        found = Path(folder, "check", "check.json")
        findings = json.loads(found.read_text(encoding="utf-8"))["findings"] if found.is_file() else []
        lines = printed.splitlines() or [each for each in errors.splitlines() if not each.startswith("warning:")]
        return len(runs), status, lines[0].replace("|", "/"), findings


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
