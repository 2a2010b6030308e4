"""`winch-friction gap`: where runs and model disagree, what is missing, the repaired model, and the proof."""

import json
from collections.abc import Collection
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import typer

from winch_friction.cli.console import progress, search_at_hand, show_json, show_table, show_warnings, stepping
from winch_friction.cli.names import complete_crane, complete_model
from winch_friction.cli.optional import OptionalPath, OptionalPaths, Overwrite
from winch_friction.physics.errors import InputError

HELP = """Find where simulation and measurement disagree, name the missing effect, add it, show the gap shrink.

Writes [bold]gap.json[/bold], [bold]model.yaml[/bold] and [bold]report.html[/bold] into --out. Runs are CSV, Parquet or
rosbag2, in any mixture; some of them are locked away before anything else and used for the proof alone.

Examples:

  [cyan]winch-friction gap runs/*.csv --crane crane_150t --model a6vm215_crane2 --out gap/[/cyan]

  [cyan]winch-friction gap emps.csv --crane emps --model emps_viscous --out gap/[/cyan]

  [cyan]winch-friction gap runs/*.mcap --crane my_crane.yaml --model my_model.yaml --out gap/ --effects mine.py[/cyan]
"""

MODEL = "a6vm215_crane2"  # of the 150 t crane, where none is named
REPLACED = ("model.yaml", "report.html", "addition.csv", "proposal_*.py", "proposal_*.yaml")
WRITTEN = ("gap.json", *REPLACED, "experiment_*.yaml", "ahc_55t_*.yaml", "test_02.yaml")  # the last: next experiments
app = typer.Typer(add_completion=False, rich_markup_mode="rich")


@app.command("gap", help=HELP)
def command(
    runs: Annotated[OptionalPaths, typer.Argument(help="Run files: .csv, .parquet, rosbag2.")] = None,
    crane: Annotated[
        str, typer.Option(help="Crane file or shipped name; none: the model's.", autocompletion=complete_crane)
    ] = "",
    model: Annotated[
        str,
        typer.Option(
            help="Model file or shipped name; none, for the 150 t crane: a6vm215_crane2.", autocompletion=complete_model
        ),
    ] = "",
    out: Annotated[Path, typer.Option(help="Folder for gap.json, model.yaml and report.html.")] = Path("gap"),
    holdout: Annotated[float, typer.Option(help="Share of the runs that is locked for the proof.")] = 0.25,
    seed: Annotated[int, typer.Option(min=0, help="Seed of every random choice.")] = 0,
    effects: Annotated[
        OptionalPath, typer.Option(help="Python file that registers candidate terms of your own.")
    ] = None,
    fmu: Annotated[OptionalPath, typer.Option(help="FMU of your own simulation, to compare with.")] = None,
    fmu_map: Annotated[OptionalPath, typer.Option(help="Which run columns are which variables of the FMU.")] = None,
    params_file: Annotated[OptionalPath, typer.Option(help="ROS parameter file: joints and fields of a bag.")] = None,
    report: Annotated[bool, typer.Option(help="Write report.html.")] = True,
    force: Annotated[bool, typer.Option(help="Go on with data that contradict the crane; gap.json says so.")] = False,
    overwrite: Overwrite = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print gap.json instead of a table.")] = False,
    blind: Annotated[int, typer.Option(help="No runs: hide an effect N times, search for it, then open the seal.")] = 0,
) -> None:
    """Search runs for what the model lacks."""
    if blind:
        from winch_friction.cli.gap_blind import blind_trials
        from winch_friction.records.model_file import load_model

        model = model or MODEL
        blind_trials(blind, crane or load_model(model).crane, model, out, seed, as_json, overwrite)
        return
    files = (fmu, fmu_map, params_file, overwrite)
    content, said = run_gap(list(runs or []), crane, model, out, holdout, seed, effects, report, force, *files)
    if as_json:
        show_json(content)
    else:
        show_result(content, out, said)


@search_at_hand()
def run_gap(
    paths: list[Path],
    crane: str,
    model: str,
    out: Path,
    holdout: float,
    seed: int,
    effects: Path | None,
    report: bool,
    force: bool = False,
    fmu: Path | None = None,
    fmu_map: Path | None = None,
    params_file: Path | None = None,
    overwrite: bool = False,
) -> tuple[dict[str, Any], Collection[str]]:
    """The workflow from files to files; returns the content of gap.json, and which of its notes were warnings."""
    from winch_friction.cli.console import refuse_foreign, refuse_input_as_output
    from winch_friction.cli.inputs import read_inputs, refuse_copies, refuse_implausible, run_paths
    from winch_friction.discrepancy.answer import STEPS, GapOptions
    from winch_friction.discrepancy.workflow import find_gap
    from winch_friction.physics.friction.model import unstated
    from winch_friction.physics.friction.term import load_file
    from winch_friction.records.input_mapping import bag_options_of
    from winch_friction.records.model_file import load_model

    if not paths:
        raise InputError("no run given; name at least one run file, or use --blind N")
    paths = run_paths(paths)
    for name in ("model.yaml", "gap.json", "addition.csv"):
        refuse_input_as_output(out / name, [model, *paths])
    refuse_foreign(out, WRITTEN, "gap.json", "winch_friction.gap/", overwrite)
    options = GapOptions(holdout=holdout, seed=seed, effects_file=effects)
    if effects is not None:
        load_file(effects)  # before the model, which may be one that these effects have repaired
    assumed = not (model or crane)
    model = model or _usual_model(crane, paths)
    crane = load_model(MODEL).crane if assumed else crane
    conventions = bag_options_of(params_file) if params_file is not None else {}
    read, loaded_crane, seed_model = read_inputs(paths, crane, model, conventions, unstated)
    warned = [each for run in read for each in run.warnings]
    show_warnings(warned)
    refuse_copies(read)
    read = _simulated(read, fmu, fmu_map)
    try:
        forced = refuse_implausible(read, loaded_crane, seed_model, force, paths)
    except InputError as error:
        if not assumed:
            raise
        raise InputError(
            f"no --crane and no --model were given, and these runs are not of crane '{loaded_crane.name}', which is "
            f"taken then: name your own ({error})"
        ) from None
    with stepping("comparing with the model", STEPS) as tell:
        result = find_gap(read, loaded_crane, seed_model, replace(options, told=tell))
    from winch_friction.cli.inputs import provenance_of

    made = provenance_of(paths, loaded_crane.name, model, seed) | forced
    noted = replace(result.model, provenance={**result.model.provenance, **forced})
    result = replace(result, provenance=made, model=noted, notes=(*warned, *result.notes))
    content = result.content()
    _write(out, result, content, read)
    if report:
        from winch_friction.report.gap import write_gap_report

        write_gap_report(out / "report.html", result)
    return content, warned


def _write(out: Path, result: Any, content: dict[str, Any], runs: list[Any]) -> None:
    """All files but the page, at once; those of an earlier call go: beside new ones they would be read as theirs."""
    from winch_friction.records.atomic import together, write_text
    from winch_friction.records.model_file import save_model

    with together(out, "gap.json") as place:
        _write_addition(place, result, runs)
        save_model(result.model, place / "model.yaml")
        if content["next_experiment"] and result.next_scenario:
            write_text(place / content["next_experiment"]["scenario"], result.next_scenario)
        _write_proposals(place, result)
        write_text(place / "gap.json", json.dumps(content, indent=2, allow_nan=False) + "\n")
        new = {each.name for each in place.iterdir()}
    for old in (each for name in REPLACED for each in out.glob(name) if each.name not in new):
        old.unlink()


def _usual_model(crane: str, paths: list[Path]) -> str:
    """The model that is taken where none is named, said on stderr; for a crane that has none, raises `InputError`."""
    from winch_friction.cli.inputs import recorded_crane
    from winch_friction.cli.names import models_of
    from winch_friction.records.crane_file import load_crane
    from winch_friction.records.model_file import load_model

    usual = load_model(MODEL)
    named = load_crane(crane).name if crane else recorded_crane(paths)
    if named not in ("", usual.crane):
        shipped = ", ".join(models_of(named))
        has = f"shipped for it: {shipped}" if shipped else "`winch-friction init model` writes one to begin with"
        raise InputError(f"which model of crane '{named}'? Give --model with a model file or a name; {has}")
    taken = f"no --crane and no --model: taken as crane '{usual.crane}' and model '{MODEL}'; name your own if not"
    show_warnings([f"no --model: taken as '{MODEL}', of crane '{usual.crane}'" if named else taken])
    return MODEL


def _write_proposals(out: Path, result: Any) -> None:
    """Of each proposed law its file of terms and the model with it."""
    from winch_friction.records.atomic import write_text
    from winch_friction.records.model_file import save_model

    for number, proposal in enumerate(result.proposals, start=1):
        write_text(out / f"proposal_{number}.py", proposal.text)
        save_model(proposal.model, out / f"proposal_{number}.yaml")


def _simulated(runs: list[Any], fmu: Path | None, fmu_map: Path | None) -> list[Any]:
    """The runs with the columns that a user's FMU simulates for them."""
    if (fmu is None) != (fmu_map is None):
        raise InputError("--fmu and --fmu-map belong together: an FMU, and what of it is which column")
    if fmu is None or fmu_map is None:
        return runs
    from winch_friction.simulation.fmu import load_fmu_map, simulate_fmu

    links = load_fmu_map(fmu_map)
    return [simulate_fmu(fmu, links, run) for run in progress(runs, "simulating by the FMU")]


def _write_addition(out: Path, result: Any, runs: list[Any]) -> None:
    """For a user's own simulation: what it has to add, as a table."""
    from winch_friction.discrepancy.addition import write_addition
    from winch_friction.discrepancy.preparation.own_simulation import simulated_column

    if runs and simulated_column(runs[0]):
        sides = [*result.train.runs, *result.holdout.runs]
        write_addition(out / "addition.csv", sides, result.seed_model, result.model)


def _parameters(effect: dict[str, Any]) -> str:
    """Values with deviations, in the units that people read them in; of a curve that the data drew only that it is one:
    its rises by themselves say little."""
    from winch_friction.report.tables import estimate_for_people, number

    def amount(found: dict[str, Any]) -> str:
        value, std, unit = estimate_for_people(found["value"], found["std"], found["unit"])
        shown = value if isinstance(value, str) else number(value, 3)
        sure = f" ± {number(std, 2)} {unit}" if std > 0.0 else "" if isinstance(value, str) else f" {unit}"
        return f"{shown}{sure}".removesuffix(" –")

    of_curve = {k for k in effect["parameters"] if effect["law_kind"] == "free" and k.startswith("free_")}
    said = [f"{k} = {amount(found)}" for k, found in effect["parameters"].items() if k not in of_curve]
    return ", ".join([*said, *(["a curve (in the page and in model.yaml)"] if of_curve else [])])


def _found_as(effect: dict[str, Any]) -> str:
    """The name, and in which signals, layers or runs it was found, where no parameter says so."""
    said = [part for part in effect.get("variant", "").split(", ") if part and "=" not in part]
    return f"{effect['name']} ({', '.join(said)})" if said else effect["name"]


def _unexplained(depends_on: list[str], reason: str, **_: Any) -> str:
    return f"it depends on: {', '.join(depends_on)} ({reason})" if depends_on else f"no effect is named: {reason}"


def show_result(content: dict[str, Any], out: Path, said: Collection[str] = ()) -> None:
    """The verdict for a person; what was `said` as a warning is not said again."""
    from winch_friction.discrepancy.adequacy import Check

    gap, unit = content["gap"]["holdout"], content["gap"]["unit"]
    rows = [
        [
            _found_as(effect),
            ", ".join(effect["indistinguishable_from"]) or "-",
            _parameters(effect),
            f"{100 * effect['evidence']['cv_gain']:.0f} %",
        ]
        for effect in content["effects"]
    ]
    print(f"verdict: {content['verdict']}")
    if rows:
        show_table("missing effects", ["effect", "or", "parameters ± σ", "error lower by"], rows)
    if content["verdict"] == "unexplained":
        print(_unexplained(**content["unexplained"]))
    for check in content["adequacy"] if content["verdict"] == "insufficient" else []:
        if not check["met"]:
            print(f"lacking: {Check(**check).sentence}")
    if gap["before"] is not None:
        print(
            f"locked runs: {gap['before']:.3g} {unit} before, {gap['after']:.3g} {unit} after, "
            f"noise floor {gap['noise_floor']:.3g} {unit}"
        )
    for note in content["notes"]:
        if note not in said:
            print(f"note: {note}")
    for proposal in content.get("proposals", ()):
        print(f"proposal: {proposal['sentence']} ({out / proposal['terms_file']}, {out / proposal['model_file']})")
    if plan := content["next_experiment"]:
        far = f" ({plan['note']})" if plan["note"] else ""
        print(f"next experiment: {plan['scenario']}{far}")
    elif content["verdict"] == "ambiguous":
        print("next experiment: no scenario at hand tells these apart; measure what only one of them changes")
    written = [out / name for name in ("gap.json", "model.yaml", "report.html") if (out / name).exists()]
    print("written:", ", ".join(map(str, written)))
