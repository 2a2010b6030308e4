"""`winch-friction compare`: two models against each other, on a grid of speeds and loads or on runs."""

from pathlib import Path
from typing import Annotated, Any

import typer

from winch_friction.cli.console import show_json, show_table
from winch_friction.cli.inputs import PAGE, load_terms, refuse_existing, refuse_other_kind, show_warnings
from winch_friction.cli.names import complete_crane, complete_model
from winch_friction.cli.optional import Namespace, OptionalPath, OptionalPaths, Overwrite
from winch_friction.physics.errors import InputError, Problems

CERTAIN = 2.0  # standard deviations from which a difference is more than what the models do not know of themselves


def command(
    first: Annotated[str, typer.Argument(help="Model: file or shipped name.", autocompletion=complete_model)],
    second: Annotated[str, typer.Argument(help="The model to compare with it.", autocompletion=complete_model)],
    runs: Annotated[
        OptionalPaths, typer.Argument(help="Run files, or folders of them: compare on them instead of a grid.")
    ] = None,
    crane: Annotated[str, typer.Option(help="Crane file or shipped name.", autocompletion=complete_crane)] = "",
    loads: Annotated[
        str, typer.Option(help="Hanging masses of the grid, t; none: this crane's, as 15,55,100 of 150.")
    ] = "",
    out: Annotated[OptionalPath, typer.Option(help="Write a page (.html) with curves and differences.")] = None,
    terms_file: Annotated[OptionalPath, typer.Option(help="Python file with friction terms of your own.")] = None,
    params_file: Annotated[OptionalPath, typer.Option(help="ROS parameter file: joints and fields of a bag.")] = None,
    namespace: Namespace = "",
    overwrite: Overwrite = False,
    as_json: Annotated[bool, typer.Option("--json", help="As JSON.")] = False,
) -> None:
    """Compare two models: curves, sigma, contributions, and where they differ.

    Examples:

      winch-friction compare a6vm215_crane1 a6vm215_crane2 --out compare.html

      winch-friction compare a6vm215_crane2 learned.yaml runs/*.csv --crane crane_150t
    """
    from winch_friction.cli.inputs import run_paths
    from winch_friction.cli.show import curve_crane, say_beyond
    from winch_friction.physics.winch.model_curve import usual_loads
    from winch_friction.records.crane_file import load_crane
    from winch_friction.records.input_mapping import bag_options_of
    from winch_friction.records.model_file import load_model

    load_terms(terms_file)
    problems, models = Problems(), []
    with problems:
        refuse_other_kind(out, PAGE, "a page")
        refuse_existing(overwrite, out)
    for name in (first, second):
        with problems:
            models.append(load_model(name))
    with problems:
        if crane:
            load_crane(crane)
    problems.say()
    one, two = models
    _refuse_two_cranes(one, two)
    machine = curve_crane(one, crane, first)
    if runs:
        if out is not None:
            raise InputError("compare: the page shows the grid; leave out the runs, or leave out --out")
        content = _on_runs(one, two, machine, run_paths(runs), bag_options_of(params_file, namespace))
    else:
        masses = _loads(loads) if loads else [each / 1e3 for each in usual_loads(machine)]
        say_beyond("--loads", masses, machine)
        content = _on_grid(one, two, machine, masses, out)
    if as_json:
        show_json(content)
        return
    print(content["said"])
    rows = [list(row.values()) for row in content["rows"]]
    show_table(f"{two.name} minus {one.name}, {machine.name}", list(content["rows"][0]), rows)
    if content.get("page"):
        print(f"wrote {content['page']}")


def _refuse_two_cranes(one: Any, two: Any) -> None:
    """A difference between two machines says nothing of their models; a motor is not a winch, which is told."""
    if one.crane and two.crane and one.crane != two.crane:
        raise InputError(
            f"compare: '{one.name}' is of crane '{one.crane}', '{two.name}' of crane '{two.crane}': "
            "give two models of one crane"
        )
    scopes = [{term.scope.value for term in model.terms} for model in (one, two)]
    for model, own, others in ((one, *scopes), (two, *reversed(scopes))):
        if own == {"motor"} and others - own:
            show_warnings([f"model '{model.name}' has no losses of gear and drum: part of the difference is those"])


def _loads(text: str) -> list[float]:
    try:
        found = [float(each) for each in text.split(",")]
    except ValueError:
        raise InputError(f"--loads '{text}': give masses in t with commas, e.g. 15,55,100") from None
    if not all(0.0 <= each < float("inf") for each in found):
        raise InputError(f"--loads '{text}': a hanging mass is a number of t from 0 on")
    return found


def _on_grid(one: Any, two: Any, crane: Any, loads: list[float], out: Path | None) -> dict[str, Any]:
    import numpy as np

    from winch_friction.physics.channels import RPM
    from winch_friction.physics.winch.model_curve import model_curve, usual_speeds
    from winch_friction.report.curves import joint_std

    speed = usual_speeds(one, crane)
    drawn = lambda each, t: model_curve(each, crane, load=1e3 * t, speed=speed)
    pairs = [(drawn(one, t), drawn(two, t)) for t in loads]
    rows: list[dict[str, Any]] = []
    for a, b in pairs:
        difference, spread = b.torque - a.torque, joint_std(a, b)
        k = int(np.abs(difference).argmax())
        sigma = abs(difference[k]) / spread[k] if np.isfinite(spread[k]) and spread[k] > 0.0 else float("nan")
        parts = {n: b.parts.get(n, 0.0 * a.speed)[k] - a.parts.get(n, 0.0 * a.speed)[k] for n in {*a.parts, *b.parts}}
        leading = max(parts, key=lambda n: abs(parts[n]))
        rows.append(
            {
                "load [t]": a.load / 1e3,
                "largest [N*m]": float(difference[k]),
                "of [N*m]": float(a.torque[k]),
                "at [rpm]": float(a.speed[k] / RPM),
                "in sigmas": float(sigma),
                "RMS [N*m]": float(np.sqrt(np.mean(difference**2))),
                "mostly by": f"{leading} ({parts[leading]:+.3g} N·m)" if abs(parts[leading]) > 0.0 else "-",
            }
        )
    said = _said(one.name, two.name, rows)
    page = None
    if out is not None:
        from winch_friction.cli.provenance import provenance_of
        from winch_friction.report.curves import write_comparison_page

        worst = max(rows, key=lambda row: abs(row["largest [N*m]"]))
        facts = [
            ("Largest difference", f"{worst['largest [N*m]']:+.3g} N·m of {worst['of [N*m]']:.3g}"),
            ("Where", f"{worst['at [rpm]']:.0f} rpm, {worst['load [t]']:g} t"),
            ("Mostly by", worst["mostly by"].replace("*", "·")),
            (
                "In standard deviations",
                f"{worst['in sigmas']:.2g}" if worst["in sigmas"] == worst["in sigmas"] else "unknown",
            ),
        ]
        made = provenance_of([], crane.name, f"{one.name}, {two.name}")
        page = str(write_comparison_page(out, pairs, said, facts, made))
    return {"said": said, "first": one.name, "second": two.name, "crane": crane.name, "rows": rows, "page": page}


def _said(first: str, second: str, rows: list[dict[str, Any]]) -> str:
    worst = max(rows, key=lambda row: abs(row["largest [N*m]"]))
    size, sigma = worst["largest [N*m]"], worst["in sigmas"]
    if size == 0.0:
        return f"{second} and {first} are the same on this grid."
    sure = (
        ""
        if sigma != sigma
        else (", more than" if sigma > CERTAIN else ", within") + " what they do not know of themselves"
    )
    return (
        f"{second} differs from {first} by {size:+.3g} N·m at most, at {worst['at [rpm]']:.0f} rpm and "
        f"{worst['load [t]']:g} t ({100 * abs(size) / max(abs(worst['of [N*m]']), 1e-9):.0f} %){sure}."
    )


def _on_runs(one: Any, two: Any, crane: Any, paths: list[Path], options: dict[str, Any]) -> dict[str, Any]:
    import numpy as np

    from winch_friction.physics.corrections import corrected
    from winch_friction.physics.winch.crane import run_drum_torque
    from winch_friction.physics.winch.operating_point import run_operating_points
    from winch_friction.records.runs import read_runs

    rows: list[dict[str, Any]] = []
    loaded = any("drum_torque" in term.reads for model in (one, two) for term in model.terms)
    for run in read_runs(paths, crane, **options):
        show_warnings(run.warnings)
        if "hook_load" not in run and loaded:
            raise InputError(f"{run.name}: compare needs the column 'hook_load'")
        torques, load = [], float("nan") if loaded else 0.0
        for model in (one, two):
            right, machine = corrected(run, crane, model)
            at = run_operating_points(right, machine, drum_torque=run_drum_torque(right, machine, load))
            torques.append(np.interp(run.time, right.time, np.broadcast_to(model.torque(at), (len(right),))))
        difference = torques[1] - torques[0]
        if not np.isfinite(difference).any():
            raise InputError(f"{run.name}: no row has speed, load and pressures all at once: nothing to compare on")
        k = int(np.nanargmax(np.abs(difference)))
        rows.append(
            {
                "run": run.name,
                "RMS [N*m]": float(np.sqrt(np.nanmean(difference**2))),
                "largest [N*m]": float(difference[k]),
                "at [s]": float(run.time[k] - run.time[0]),
                "at [rpm]": float(run["motor_speed"][k] * 30.0 / np.pi),
                f"RMS of {one.name} [N*m]": float(np.sqrt(np.nanmean(torques[0] ** 2))),
            }
        )
    worst = max(rows, key=lambda row: row["RMS [N*m]"])
    said = f"{two.name} differs from {one.name} by {worst['RMS [N*m]']:.3g} N·m RMS at most, in {worst['run']}."
    return {"said": said, "first": one.name, "second": two.name, "crane": crane.name, "rows": rows}
