"""`winch-friction plot`: runs as a page with every channel, and a model's friction beside them."""

from pathlib import Path
from typing import Annotated

import typer

from winch_friction.cli.console import show_json, show_table
from winch_friction.cli.inputs import load_terms, show_warnings
from winch_friction.cli.names import complete_crane, complete_model
from winch_friction.cli.optional import Namespace, OptionalPath, Overwrite


def command(
    runs: Annotated[list[Path], typer.Argument(help="Run files (.csv, .parquet, rosbag2), or folders of them.")],
    out: Annotated[Path, typer.Option(help="Page to write.")] = Path("plot.html"),
    crane: Annotated[
        str, typer.Option(help="Crane: for drum speeds, fractions and a model.", autocompletion=complete_crane)
    ] = "",
    model: Annotated[
        str, typer.Option(help="Model whose friction is drawn beside.", autocompletion=complete_model)
    ] = "",
    terms_file: Annotated[OptionalPath, typer.Option(help="Python file with friction terms of your own.")] = None,
    params_file: Annotated[OptionalPath, typer.Option(help="ROS parameter file: joints and fields of a bag.")] = None,
    namespace: Namespace = "",
    overwrite: Overwrite = False,
    as_json: Annotated[bool, typer.Option("--json", help="Ranges of every channel as JSON.")] = False,
) -> None:
    """Draw runs: every channel in the units people read, zoomed together, data as CSV a click away.

    Examples:

      winch-friction plot runs/*.csv --out runs.html

      winch-friction plot bag/ --crane crane_150t --model a6vm215_crane2
    """
    from winch_friction.cli.inputs import PAGE, read_all, read_inputs, refuse_existing, refuse_other_kind, run_paths
    from winch_friction.physics.errors import InputError, Problems
    from winch_friction.records.input_mapping import bag_options_of
    from winch_friction.report.run_page import channel_rows, write_run_page

    if model and not crane:
        raise InputError("plot: --model needs --crane")
    load_terms(terms_file)
    problems = Problems()
    with problems:
        refuse_other_kind(out, PAGE, "a page")
        refuse_existing(overwrite, out)
    paths = run_paths(runs)
    options = bag_options_of(params_file, namespace)
    if crane:
        read, machine, drawn = read_inputs(paths, crane, model, options, before=problems.found)
    else:
        machine = drawn = None
        with problems:
            read = read_all(paths, None, **options)
        problems.say()
    for run in read:
        show_warnings(run.warnings)
    page = write_run_page(out, read, machine, drawn)
    rows = [row for run in read for row in channel_rows(run)]
    if as_json:
        show_json({"page": str(page), "channels": rows})
        return
    show_table("channels", list(rows[0]), [list(row.values()) for row in rows])
    print(f"wrote {page}")
