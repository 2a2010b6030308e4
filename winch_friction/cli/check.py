"""`winch-friction check`: can these runs be this crane's, and which mistake would explain why not?"""

import json
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

from winch_friction.cli.console import show_json, show_table
from winch_friction.cli.inputs import show_warnings
from winch_friction.cli.names import complete_crane, complete_model
from winch_friction.cli.optional import Namespace, OptionalPath

PLAUSIBLE, CONTRADICTED = 0, 2


def command(
    runs: Annotated[list[Path], typer.Argument(help="Run files, bags, or folders of them.")],
    crane: Annotated[str, typer.Option(help="Crane file or shipped name.", autocompletion=complete_crane)] = "",
    model: Annotated[
        str, typer.Option(help="Model file or shipped name: judges more sharply.", autocompletion=complete_model)
    ] = "",
    terms_file: Annotated[OptionalPath, typer.Option(help="Python file with friction terms of your own.")] = None,
    params_file: Annotated[OptionalPath, typer.Option(help="ROS parameter file: joints and fields of a bag.")] = None,
    namespace: Namespace = "",
    out: Annotated[OptionalPath, typer.Option(help="Folder for check.html and check.json.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Findings as JSON.")] = False,
) -> None:
    """Check runs against their crane before anything is learned from them.

    Exit status 0: plausible; 2: not, and the first line names the most likely mistake.

    Examples:

      winch-friction check runs/ --crane my_crane.yaml

      winch-friction check run.csv --crane crane_150t --model a6vm215_crane2 --out check/
    """
    from winch_friction.cli.inputs import (
        load_terms,
        read_inputs,
        refuse_foreign,
        refuse_unwritable,
        run_paths,
    )
    from winch_friction.cli.provenance import provenance_of
    from winch_friction.commissioning.commissioning import check
    from winch_friction.commissioning.other_cranes import cranes_near
    from winch_friction.physics.errors import Problems
    from winch_friction.records.input_mapping import bag_options_of
    from winch_friction.records.runs import refuse_same_names

    load_terms(terms_file)
    paths = run_paths(runs)
    problems = Problems()
    with problems:
        refuse_unwritable(out and out / "check.html")
        refuse_foreign(out, ("check.html", "check.json"), "check.json", "winch_friction.check/")
    options = bag_options_of(params_file, namespace)
    read, winch, seed = read_inputs(paths, crane, model, options, before=problems.found)
    refuse_same_names(read, paths)
    near = [*paths, *([Path(crane)] if crane else [])]
    result = check(read, winch, seed, partial(cranes_near, near))
    content = result.content()
    if out is not None:
        _write(result, content, out, provenance_of(paths, winch.name, model))
    if as_json:
        show_json(content)
    else:
        _show(result, read, out)
    raise typer.Exit(PLAUSIBLE if result.plausible else CONTRADICTED)


def _write(result: Any, content: dict[str, Any], out: Path, provenance: dict[str, Any]) -> None:
    from winch_friction.records.atomic import together, write_text
    from winch_friction.report.check import write_check_report

    with together(out, "check.json") as place:
        write_text(place / "check.json", json.dumps(content, indent=2, allow_nan=False, default=str) + "\n")
        write_check_report(place / "check.html", result, provenance)


def _show(result: Any, runs: list[Any], out: Path | None) -> None:
    print(result.sentence)
    for run in runs:
        show_warnings(run.warnings)
    rest = [each for each in result.findings if each.sentence != result.sentence]
    if rest:
        show_table("findings", ("severity", "finding"), [(each.severity, each.sentence) for each in rest])
    columns = ("run", "misfit", "limit", "as it stands [N*m]", "after ordinary errors [N*m]", "load [N*m]")
    rows = [(b.run, b.score, result.limit, b.before, b.after, b.level) for b in result.balance]
    show_table("torque balance at the motor shaft", columns, rows)
    if result.identifiable:
        head = ("parameter", "model's std [%]", "std with these runs [%]", "these runs tell")
        lessons = [(p.name, 100.0 * p.before, 100.0 * p.after, p.words) for p in result.identifiable]
        show_table("what these runs can teach", head, lessons)
    for line in result.log_next:
        print(f"log next: {line}")
    if out is not None:
        print(f"written: {out / 'check.json'}, {out / 'check.html'}")
