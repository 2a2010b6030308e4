"""`winch-friction convert`: run files from one format to another."""

from pathlib import Path
from typing import Annotated

import typer

from winch_friction.cli.console import show_json
from winch_friction.cli.inputs import refuse_existing, refuse_input_as_output, show_warnings
from winch_friction.cli.names import complete_crane
from winch_friction.cli.optional import Namespace, OptionalPath, Overwrite
from winch_friction.physics.signals import GROUP_CHANNELS, SAMPLE_SCALARS, Run

app = typer.Typer(help="Run files from one format to another.", add_completion=False, rich_markup_mode="rich")
OUT = typer.Argument(help="Where to, one or several: .csv, .parquet, .mcap, .db3, or a folder for a bag.")


@app.command("run")
def run(
    source: Annotated[Path, typer.Argument(help="Run file or bag.")],
    out: Annotated[list[Path], OUT],
    crane: Annotated[
        str, typer.Option(help="Crane: for drum speeds and displacement fractions.", autocompletion=complete_crane)
    ] = "",
    params_file: Annotated[OptionalPath, typer.Option(help="ROS parameter file: joints and fields of a bag.")] = None,
    namespace: Namespace = "",
    overwrite: Overwrite = False,
    as_json: Annotated[bool, typer.Option("--json", help="Say what was written as JSON.")] = False,
) -> None:
    """Convert a run file or bag.

    Example:

      winch-friction convert run log.csv log.parquet log.mcap
    """
    from winch_friction.physics.errors import Problems
    from winch_friction.records.crane_file import load_crane
    from winch_friction.records.input_mapping import bag_options_of
    from winch_friction.records.runs import read_run, refuse_unknown_kind

    problems, winch = Problems(), None
    for each in out:
        with problems:
            refuse_input_as_output(refuse_unknown_kind(each), [source])
            refuse_existing(overwrite, each)
    with problems:
        winch = load_crane(crane) if crane else None
    with problems:
        content = read_run(source, winch, **bag_options_of(params_file, namespace))
    problems.say()
    show_warnings(content.warnings)
    _write(content, out, as_json)


@app.command("emps")
def emps(
    source: Annotated[Path, typer.Argument(help="The benchmark's DATA_EMPS.mat.")],
    out: Annotated[list[Path], OUT],
    causal: Annotated[bool, typer.Option(help="Speed as a drive would have it live, without looking ahead.")] = False,
    overwrite: Overwrite = False,
    as_json: Annotated[bool, typer.Option("--json", help="Say what was written as JSON.")] = False,
) -> None:
    """Convert the EMPS benchmark's measurement into a run for crane 'emps'.

    Example:

      winch-friction convert emps DATA_EMPS.mat emps.csv emps_bag
    """
    from winch_friction.records.emps import read_emps

    refuse_existing(overwrite, *out)
    _write(read_emps(source, causal), out, as_json)


def _write(content: Run, paths: list[Path], as_json: bool) -> None:
    from winch_friction.records.runs import write_run

    show_warnings(f"{path}: a bag has no topic for {', '.join(lost)}: left out" for path in paths
                  if path.suffix not in (".csv", ".parquet", ".pq") and (lost := _without_topic(content)))  # fmt: skip
    written = [str(write_run(content, path)) for path in paths]
    if as_json:
        show_json({"written": written, "samples": len(content), "columns": list(content.columns)})
        return
    for path in written:
        print(f"{path}: {len(content)} samples of {', '.join(content.columns)}")


def _without_topic(content: Run) -> list[str]:
    """The columns of a run that no message of the winch carries."""
    carried = {
        "time",
        *SAMPLE_SCALARS,
        *(f"{group}.{channel}" for group in content.groups for channel in GROUP_CHANNELS),
    }
    return [name for name in (*content.columns, *content.aside) if name not in carried]
