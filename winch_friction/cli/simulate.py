"""`winch-friction simulate`: a scenario becomes run files."""

from pathlib import Path
from typing import Annotated, Any

import typer

from winch_friction.cli.inputs import load_terms
from winch_friction.cli.names import complete_crane, complete_model, complete_scenario
from winch_friction.cli.optional import OptionalPath, OptionalTexts
from winch_friction.physics.errors import InputError, Problems, meant

LARGEST_EFFECT = 10.0  # times the typical size: ten times an effect of the catalogue is another machine
FASTEST = 1000.0  # rad/s, 9500 rpm: no motor of a winch turns faster, so the load has run away
TRUTH_FOLDER = "truth"  # below the runs', so that `gap runs/*` meets runs alone


def command(
    scenario: Annotated[
        str,
        typer.Argument(
            help="Scenario file, shipped name, or a set: [bold]gap_campaign[/bold], paper_tests.",
            autocompletion=complete_scenario,
        ),
    ] = "",
    crane: Annotated[
        str,
        typer.Option(
            help="Crane file or shipped name; none: the scenario's or the model's.", autocompletion=complete_crane
        ),
    ] = "",
    model: Annotated[
        str, typer.Option(help="Model file or shipped name: the friction's truth.", autocompletion=complete_model)
    ] = "a6vm215_crane2",
    plant: Annotated[str, typer.Option(help="Plant file or shipped name; none: the scenario's.")] = "",
    out: Annotated[Path, typer.Option(help="Folder for the runs, or the file of a single run.")] = Path("runs"),
    seed: Annotated[int, typer.Option(min=0, help="Seed of sea, sensors and campaign.")] = 0,
    hide: Annotated[
        OptionalTexts, typer.Option(help="Effect to hide in the plant, EFFECT or EFFECT=SIZE (1 = typical).")
    ] = None,
    terms_file: Annotated[OptionalPath, typer.Option(help="Python file with friction terms of your own.")] = None,
    kind: Annotated[
        str, typer.Option("--format", help="csv, parquet, mcap or db3, for a folder of runs; none: csv.")
    ] = "",
    truth: Annotated[bool, typer.Option(help="Write the plant's truth beside each run.")] = False,
    overwrite: Annotated[bool, typer.Option("--overwrite", "--force", help="Replace runs that exist.")] = False,
    effects: Annotated[bool, typer.Option("--effects", help="List the effects that can be hidden, and end.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print what was written as JSON.")] = False,
) -> None:
    """Simulate a scenario, or a set of them, and write what the crane's PLC would have logged.

    Examples:

      winch-friction simulate ahc_55t_215 --out run.csv

      winch-friction simulate gap_campaign --hide brake_drag --seed 7 --out runs/ --truth

      winch-friction simulate ahc_irregular --hide presliding=0.5 --format mcap
    """
    from winch_friction.cli.console import show_json, show_table
    from winch_friction.cli.inputs import machine_of, progress, refuse_unwritable, show_warnings
    from winch_friction.simulation.campaigns import CAMPAIGNS
    from winch_friction.simulation.plant_file import load_plant, refuse_other_plant

    load_terms(terms_file)
    problems, hidden = Problems(), list[tuple[str, float]]()
    for text in hide or []:
        with problems:
            hidden.append(_effect(text))
    if effects:
        _list_effects(as_json)
        return
    if not scenario:
        raise InputError("which scenario? Give a file, a shipped name, gap_campaign or paper_tests")
    plan: Any = []
    with problems:
        plan = _plan(scenario, seed, out, kind)
        targets = [path for _, _, path in plan]
        beside = [_truth_of(path) for path in targets if truth]
        _refuse_overwriting([*targets, *beside], overwrite)
        refuse_unwritable(*targets[:1], *beside[:1])
    winch, friction = machine_of(crane or (plan[0][0].crane if plan else ""), model, [], problems)
    problems.say()
    if plant:
        plan = [(chosen.override({"plant": plant}), run_seed, path) for chosen, run_seed, path in plan]
    if scenario in CAMPAIGNS:
        plan = _of_crane(plan, winch)
    for chosen, _, _ in plan:
        refuse_other_plant(chosen, load_plant(chosen.plant), winch)
    rows: list[dict[str, Any]] = []
    try:
        for chosen, run_seed, path in progress(plan, "simulating", len(plan)):
            rows.append(_simulate_to(path, chosen, winch, friction, run_seed, hidden, truth))
    except (KeyboardInterrupt, InputError):
        if rows:  # whoever finds the folder would take it for the set
            show_warnings([f"{out}: {len(rows)} of {len(plan)} runs were written, which is not the whole set"])
        raise
    if as_json:
        show_json({"runs": rows, "hidden": dict(hidden), "seed": seed})
    else:
        show_table("simulated", list(rows[0]), [list(row.values()) for row in rows])


def _effect(text: str) -> tuple[str, float]:
    from winch_friction.simulation.hidden.catalogue import EFFECTS, effect_names

    name, _, size = text.partition("=")
    if name not in effect_names():
        known = sorted(effect_names())
        raise InputError(f"--hide {name}: not an effect;{meant(name, known)} known effects are {', '.join(known)}")
    try:
        value = float(size) if size else 1.0
    except ValueError:
        raise InputError(f"--hide {text}: '{size}' is not a number; write EFFECT=SIZE, 1 = typical") from None
    if not abs(value) <= LARGEST_EFFECT:
        raise InputError(f"--hide {text}: the size must be {-LARGEST_EFFECT:g} ... {LARGEST_EFFECT:g} (1 = typical)")
    EFFECTS[name].refuse(value, f"--hide {text}")
    return name, value


def _list_effects(as_json: bool) -> None:
    from winch_friction.cli.console import show_json, show_table
    from winch_friction.simulation.hidden.catalogue import EFFECTS, effect_names

    effect_names()  # registers them
    if as_json:
        show_json({name: effect.typical for name, effect in EFFECTS.items()})
    else:
        show_table("effects to hide", ["effect", "size 1"], [[e.name, e.typical] for e in EFFECTS.values()])


def _plan(name: str, seed: int, out: Path, kind: str) -> list[tuple[Any, int, Path]]:
    from winch_friction.records.runs import refuse_unknown_kind
    from winch_friction.simulation import load_scenario
    from winch_friction.simulation.campaigns import CAMPAIGNS

    if kind not in ("", "csv", "parquet", "mcap", "db3"):
        raise InputError(f"--format {kind}: not a kind of run file; use csv, parquet, mcap or db3")
    if kind and out.suffix and out.suffix != f".{kind}":
        raise InputError(f"--format {kind}: --out {out} says another kind; leave one of the two out")
    kind = kind or "csv"
    if name in CAMPAIGNS:
        if out.suffix:
            raise InputError(f"--out {out}: '{name}' is a set of runs and needs a folder")
        return [(s, 1000 * seed + k, out / f"{s.name}.{kind}") for k, s in enumerate(CAMPAIGNS[name](seed), 1)]
    scenario = load_scenario(name)
    return [(scenario, seed, refuse_unknown_kind(out) if out.suffix else out / f"{scenario.name}.{kind}")]


def _of_crane(plan: list[tuple[Any, int, Path]], crane: Any) -> list[tuple[Any, int, Path]]:
    """A set's plan, fitted to the crane; what the crane has no motors for is left out, and said."""
    from winch_friction.cli.inputs import show_warnings
    from winch_friction.simulation.campaigns import fitted
    from winch_friction.simulation.plant_file import load_plant

    own = {s.name: s for s in fitted([chosen for chosen, _, _ in plan], crane, load_plant(plan[0][0].plant))}
    kept = [(own[chosen.name], seed, path) for chosen, seed, path in plan if chosen.name in own]
    if len(kept) < len(plan):
        there = ", ".join(crane.groups) or "none"
        show_warnings(
            [f"{len(plan) - len(kept)} of {len(plan)} runs left out: '{crane.name}' has motor groups {there}"]
        )
    return kept


def _refuse_overwriting(paths: list[Path], overwrite: bool) -> None:
    from winch_friction.records.atomic import taken
    from winch_friction.records.runs import BAG_SUFFIXES

    there = [path for path in paths if taken(path, overwrite)]
    more = f" and {len(there) - 1} more of {len(paths)}" if len(there) > 1 else ""
    for path in there:
        if path.suffix in BAG_SUFFIXES:
            raise InputError(f"{path}: exists already, and a bag is never replaced; give another --out, or remove it")
        if not overwrite:
            raise InputError(f"{path}{more}: exists already; give another --out, or --overwrite to replace it")


def _simulate_to(
    path: Path, scenario: Any, crane: Any, model: Any, seed: int, hidden: list[tuple[str, float]], truth: bool
) -> dict[str, Any]:
    from winch_friction.records.runs import write_run
    from winch_friction.simulation import simulate

    result = simulate(scenario, crane, model, seed, hidden)
    path.parent.mkdir(parents=True, exist_ok=True)
    _refuse_runaway(scenario, result.truth["motor_speed"])
    write_run(result.run, path)
    if truth:
        write_run(result.truth, _truth_of(path))
    time, speed = result.run.time, result.truth["motor_speed"]
    return {
        "run": str(path),
        "duration [s]": float(time[-1] - time[0]),
        "samples": len(result.run),
        "largest speed [rpm]": float(max(abs(speed)) * 30.0 / 3.141592653589793),
        "position error [mm RMS]": float(1e3 * (result.truth["position_error"] ** 2).mean() ** 0.5),
    }


def _truth_of(path: Path) -> Path:
    """Where the truth of a run goes."""
    kind = path.suffix if path.suffix in (".csv", ".parquet") else ".csv"
    return path.parent / TRUTH_FOLDER / f"{path.stem}_truth{kind}"


def _refuse_runaway(scenario: Any, speed: Any) -> None:
    largest = float(max(abs(speed)))
    if not largest <= FASTEST:  # NaN too
        rpm = largest * 30.0 / 3.141592653589793
        raise InputError(
            f"scenario '{scenario.name}': the winch runs away ({rpm:.3g} rpm): the drive "
            "cannot hold this load with these effects; lower the load or the effects' sizes"
        )
