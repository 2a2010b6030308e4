"""`winch-friction demo`: the whole loop on a simulated sea."""

import shutil
import time
from pathlib import Path
from typing import Annotated, Any

import typer

from winch_friction.cli.console import show_json, show_table, stderr
from winch_friction.cli.inputs import refuse_unwritable
from winch_friction.physics.channels import beside
from winch_friction.physics.errors import InputError

PRODUCTS = ("bag", "legs", "estimator.json", "demo.json", "demo.png", "demo.html", "learned_model.yaml")


def command(
    out: Annotated[Path, typer.Option(help="Folder for bag, picture, page and logs.")] = Path("out/demo"),
    scenario: Annotated[
        str, typer.Option(help="First leg: shipped scenario or file; heave compensation.")
    ] = "ahc_irregular",
    duration: Annotated[float, typer.Option(help="Seconds of sea per leg.", min=40.0, max=3600.0)] = 40.0,
    seed: Annotated[int, typer.Option(help="Which sea.", min=0)] = 1,
    friction_factor: Annotated[
        float,
        typer.Option(help="The plant's system friction as a multiple of what the nodes are told.", min=0.5, max=1.5),
    ] = 1.3,
    json: Annotated[bool, typer.Option("--json", help="The figures as JSON on stdout.")] = False,
) -> None:
    """Three real nodes over DDS on a simulated sea: friction is learned, compensated, recorded and replayed.

    Example: winch-friction demo --seed 7 --duration 200
    """
    from winch_friction.cli.demo.legs import voyage_legs

    legs = voyage_legs(scenario)  # a scenario that cannot be sailed is said before anything is touched or started
    _clear(out)
    plan, search = _planned(out.resolve(), scenario, legs, duration, seed, friction_factor)
    started = time.monotonic()
    _play(plan)
    results = _evaluate(plan, search, time.monotonic() - started)
    show_json(results) if json else _show(plan, results)
    if not all(each["equal"] and not each["missing"] for each in results["live_equals_replay"]):
        raise RuntimeError(f"the replay of {plan.bag} differs from the live outputs")


def _planned(out: Path, scenario: str, legs: Any, duration: float, sea: int, factor: float) -> Any:
    """The plan with the efficiency factor that is best on its first leg, and the search for it."""
    from winch_friction.cli.demo.plan import CRANE, SEED, make_plan
    from winch_friction.cli.demo.tuning import search_efficiency
    from winch_friction.physics.friction.scaled import scaled_system
    from winch_friction.records.crane_file import load_crane
    from winch_friction.records.model_file import load_model

    truth = scaled_system(load_model(SEED), factor)
    first = legs[0].scenario.override({"duration": duration})
    with stderr.status("tuning the efficiency factor on the first leg ...") as status:
        say = lambda each: status.update(f"tuning the efficiency factor on the first leg: {each:.2f}")
        search = search_efficiency(load_crane(CRANE), truth, first, sea, say)
    stderr.print(f"best efficiency factor at {legs[0].title}: {search.best:.2f} of {len(search.efficiencies)} tried")
    return make_plan(out, scenario, legs, search.best, duration, sea, factor), search


def _clear(out: Path) -> None:
    """Remove what an earlier demo left; a folder of something else is not touched."""
    if out.exists() and not out.is_dir():
        raise InputError(f"{out}: is a file; give a folder")
    refuse_unwritable(out / "plan.json")
    if out.is_dir() and any(out.iterdir()) and not (out / "plan.json").exists():
        raise InputError(f"{out}: holds other files; give a folder of its own")
    for name in PRODUCTS:
        path = out / name
        shutil.rmtree(path) if path.is_dir() else path.unlink(missing_ok=True)
    out.mkdir(parents=True, exist_ok=True)


def _play(plan: Any) -> None:
    """Nodes and stage, with progress."""
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    from winch_friction.cli.demo.processes import events, running_nodes, running_stage

    parameter_file, plan_file = plan.write()
    logs = plan.out / "logs"
    columns = (
        TextColumn("{task.description:<24}"),
        BarColumn(),
        TextColumn("{task.percentage:>3.0f} %"),
        TimeElapsedColumn(),
    )
    with (
        running_nodes(parameter_file, logs) as nodes,
        running_stage(plan_file, logs) as stage,
        Progress(*columns, console=stderr) as bars,
    ):
        tasks = {phase.name: bars.add_task(phase.title, total=1.0, start=False) for phase in plan.phases}
        bars.console.print("starting simulator, compensator and estimator as processes over DDS ...")
        for event in events(stage, nodes, logs):
            _follow(bars, tasks, event)


def _follow(bars: Any, tasks: dict[str, Any], event: dict[str, Any]) -> None:
    if event["event"] == "phase":
        names = list(tasks)
        for done in names[: names.index(event["name"])]:
            bars.update(tasks[done], completed=1.0)
        bars.start_task(tasks[event["name"]])
    elif event["event"] == "progress":
        bars.update(tasks[event["name"]], completed=event["value"])
    elif event["event"] == "recorded":
        for task in tasks.values():
            bars.update(task, completed=1.0)
        bars.console.print(f"recorded {sum(event['messages'].values())} messages")


def _evaluate(plan: Any, search: Any, elapsed: float) -> dict[str, Any]:
    """Figures, replay, picture and page from the bag."""
    from winch_friction.cli.demo.learned import learned_parameters
    from winch_friction.cli.demo.measures import measure
    from winch_friction.cli.demo.page import sections
    from winch_friction.cli.demo.picture import draw
    from winch_friction.cli.demo.recording import read_recording
    from winch_friction.cli.provenance import provenance_of
    from winch_friction.physics.friction.scaled import scaled_system
    from winch_friction.records.atomic import write_text
    from winch_friction.records.model_file import save_model
    from winch_friction.replay.recording import replay_recording
    from winch_friction.report.base import write_report
    from winch_friction.report.figures import save_figure

    stderr.print("reading the bag and replaying it ...")
    recording = read_recording(plan)
    rows = measure(plan, recording)
    agreements = replay_recording(plan.bag, plan.crane, plan.seed).live
    picture = draw(plan, recording, rows)
    truth = scaled_system(plan.seed, plan.friction_factor)
    save_figure(picture, plan.out / "demo.png")
    save_model(recording.models[-1], plan.out / "learned_model.yaml")
    parameters = learned_parameters(plan.seed, recording.models[-1], truth)
    page = sections(plan, recording, rows, agreements, parameters, search)
    made = provenance_of([plan.bag], plan.crane.name, plan.seed.name, plan.sea)
    write_report(plan.out / "demo.html", "The loop closes", page, f"{plan.scenario}, sea {plan.sea}", made)
    results = _results(plan, rows, agreements, elapsed)
    results["parameters"] = [each.as_dict() for each in parameters]
    results["efficiency"] = {
        "factor": search.best,
        "tuned_at": plan.legs[0].title,
        "tried": dict(zip(map("{:.2f}".format, search.efficiencies), search.residuals, strict=True)),
    }
    write_text(plan.out / "demo.json", _json_text(results))
    return results


def _results(plan: Any, rows: Any, agreements: Any, elapsed: float) -> dict[str, Any]:
    return {
        "schema": "winch_friction.demo/2",
        "scenario": plan.scenario,
        "sea": plan.sea,
        "friction_factor": plan.friction_factor,
        "phases": [row.as_dict() for row in rows],
        "live_equals_replay": [
            {"node": a.node, "compared": a.compared, "missing": a.missing, "largest": a.largest, "equal": a.equal}
            for a in agreements
        ],
        "simulated_seconds": plan.duration * len(plan.phases),
        "elapsed_seconds": elapsed,
        "out": str(plan.out),
    }


def _json_text(results: dict[str, Any]) -> str:
    import json

    return json.dumps(results, indent=1)


def _show(plan: Any, results: dict[str, Any]) -> None:
    phases = results["phases"]
    rows = []
    for leg in plan.legs:
        own = [each for each in phases if (each["load_t"], each["displacement_cm3_per_rev"]) == leg.key]
        rows.append([leg.title, *(_left(each) for each in own)])
    title = f"Left of the heave in mm RMS, and how much less than without: {plan.scenario}, sea {plan.sea}"
    show_table(title, ("leg", *(each.title for each in plan.feedforwards)), rows)
    show_table("Learned", ("parameter", "unit", "seed", "learned", "stated σ", "truth", "off by"), _learned(results))
    worst = max(each["largest"] for each in results["live_equals_replay"])
    speed = results["simulated_seconds"] / results["elapsed_seconds"]
    print(f"live equals replay: largest relative difference {worst:.1e}; sailed at {speed:.1f} x real time")
    print(f"page {plan.out / 'demo.html'}, picture {plan.out / 'demo.png'}, bag {plan.bag}")


def _left(phase: dict[str, Any]) -> str:
    less = f" (-{phase['less_than_without']:.0%})" if phase["feedforward"] != "none" else ""
    return f"{phase['residual_heave_rms_m'] * 1e3:.1f}{less}"


def _learned(results: dict[str, Any]) -> list[list[str]]:
    return [
        [p["name"], p["unit"], f"{p['seed']:.4g}", f"{beside(p['learned'], p['std']):.4g}", f"{p['std']:.4g}",
         f"{p['truth']:.4g}", f"{p['sigmas_from_truth']:+.1f} σ"]
        for p in results["parameters"]
    ]  # fmt: skip
