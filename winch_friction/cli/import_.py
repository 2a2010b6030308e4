"""`winch-friction import`: logs of any origin become run files, by a map that is proposed, read and carried out."""

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from winch_friction.cli.console import show_json
from winch_friction.cli.inputs import progress, show_warnings
from winch_friction.cli.names import complete_crane
from winch_friction.importing.mapping import LogMap
from winch_friction.physics.errors import InputError, Problems

HELP = """Bring logs of any origin into run files.

First propose a map: what each column is, in which unit, sign and zone, with reason and confidence. Read it (change it
in an editor, or with --set), then import.
Logs may be .csv .txt .tsv .dat .asc .log .prn .lvm (also .gz, .zip), .xlsx .xlsm .xls .xlsb .ods, .parquet, .mat,
    .h5, .tdms, .mf4 .mdf, .mcap, .db3 or a rosbag2 folder.

Examples:

  [cyan]winch-friction import log.xlsx --propose --crane crane_150t --map log_map.yaml[/cyan]

  [cyan]winch-friction import log.xlsx --map log_map.yaml --out runs/[/cyan]

  [cyan]winch-friction import *.csv --map log_map.yaml --out runs/ --set hook_load.unit=short_ton[/cyan]
"""

app = typer.Typer(add_completion=False, rich_markup_mode="rich")
FORMATS = ("csv", "parquet")


@app.command("import", help=HELP)
def command(
    logs: Annotated[list[Path], typer.Argument(help="Logs of one kind.")],
    map_file: Annotated[Path, typer.Option("--map", help="The map: written with --propose, read without.")],
    propose: Annotated[bool, typer.Option("--propose", help="Look at the logs and write the map.")] = False,
    crane: Annotated[
        str, typer.Option(help="Crane file or shipped name; without it the map's.", autocompletion=complete_crane)
    ] = "",
    out: Annotated[Path, typer.Option(help="Folder for the run files.")] = Path("runs"),
    form: Annotated[str, typer.Option("--format", help="Run files as csv or parquet.")] = "csv",
    settings: Annotated[
        list[str], typer.Option("--set", help="Change the map: CHANNEL.FIELD=VALUE, e.g. hook_load.unit=t; repeatable.")
    ] = [],  # noqa: B006  Typer 0.9 wants a list
    accept: Annotated[bool, typer.Option("--accept", help="Import although questions of the map are open.")] = False,
    force: Annotated[
        bool, typer.Option("--force", help="Import data that contradict the crane; the runs say so.")
    ] = False,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace a map or run files that exist.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Say what was found or written as JSON.")] = False,
) -> None:
    """Propose a map, or import by one."""
    if form not in FORMATS:
        raise InputError(f"--format {form}: use {' or '.join(FORMATS)}")
    _refuse_doubled(logs)
    if propose:
        propose_map(logs, map_file, crane, list(settings), overwrite, as_json)
    else:
        import_logs(logs, map_file, crane, out, form, list(settings), accept, force, overwrite, as_json)


def _refuse_doubled(logs: list[Path]) -> None:
    stems = [_stem(path) for path in logs]
    for stem in stems:
        if stems.count(stem) > 1:
            raise InputError(
                f"{stem}: two logs have this name; a run's identity is its file name, so import them into two folders"
            )


def _stem(path: Path) -> str:
    """The name of the run that a log becomes: `log.csv.gz` and `log.xlsx` become `log`."""
    name = path.name.removesuffix(".gz").removesuffix(".zip")
    return Path(name).stem or path.stem


def propose_map(
    logs: list[Path], map_file: Path, crane: str, settings: list[str], overwrite: bool, as_json: bool
) -> None:
    """Write the proposed map; what keeps it from being imported is an `InputError` after it was written."""
    from winch_friction.cli.inputs import refuse_unwritable
    from winch_friction.importing.map_text import map_text
    from winch_friction.importing.propose import propose
    from winch_friction.importing.reading import read_log
    from winch_friction.records.atomic import taken, write_text
    from winch_friction.records.crane_file import load_crane

    problems, winch = Problems(), None
    with problems:
        if taken(map_file, overwrite) and not overwrite:
            raise InputError(f"{map_file}: exists; give another name, or --overwrite")
        refuse_unwritable(map_file, option="--map")
    with problems:
        winch = load_crane(crane) if crane else None
    if problems.found:
        for log in logs:  # an answer needs all of them: what keeps each from being read is all there is to say
            with problems:
                read_log(log)
    problems.say()
    watched = lambda paths: progress(paths, "reading logs")
    proposal = propose(logs, winch, crane, settings, watched)
    log_map, open_ones = proposal.log_map, list(proposal.problems)
    write_text(map_file, map_text(log_map))
    if as_json:
        show_json(_as_content(log_map, open_ones, proposal.notes, map_file))
    else:
        _show(log_map)
        show_warnings(proposal.notes)
        if log_map.unused:
            print(f"not used: {', '.join(log_map.unused)}")
        print(f"written: {map_file}")
    if open_ones:
        raise InputError(f"{map_file} needs an answer: {' | '.join(open_ones)}")


def _show(log_map: LogMap) -> None:
    """The guesses for a person, one a line."""
    form = f"{log_map.time.form} {log_map.time.unit}" if log_map.time.form in ("seconds", "unix") else log_map.time.form
    said = f"({form}), {log_map.time_confidence:.2f}: {log_map.time_because}"
    print(f"time <- {' + '.join(log_map.time_from)} {said}" if log_map.time_from else "time <- no column found")
    for name, entry in log_map.columns.items():
        if entry.constant:
            print(f"{name} <- {entry.constant}, a constant")
            continue
        unit = ("-1 * " if entry.sign < 0 else "") + (entry.unit or "-")
        print(f"{name} <- {entry.source} ({unit}), {entry.confidence:.2f}: {entry.because}")


def _as_content(log_map: LogMap, problems: list[str], notes: tuple[str, ...], map_file: Path) -> dict[str, object]:
    from dataclasses import asdict

    return {"map": str(map_file), "proposal": asdict(log_map), "problems": problems, "notes": notes}


def import_logs(
    logs: list[Path], map_file: Path, crane: str, out: Path, form: str, settings: list[str], accept: bool, force: bool,
    overwrite: bool, as_json: bool,
) -> None:  # fmt: skip
    """Write one run file per log, all or none."""
    from winch_friction.cli.inputs import refuse_foreign, refuse_unwritable
    from winch_friction.importing.carry_out import import_log
    from winch_friction.importing.contradiction import run_contradictions
    from winch_friction.importing.mapping import load_map, refuse_if_open, with_settings
    from winch_friction.records.crane_file import load_crane
    from winch_friction.records.runs import write_run

    refuse_foreign(out, (), "")  # `simulate --out run.csv` is a file; a folder of that name surprised
    log_map = with_settings(load_map(map_file), settings)
    if not (accept or force):
        refuse_if_open(log_map, str(map_file))
    loaded = load_crane(crane or log_map.crane) if crane or log_map.crane else None
    targets = [out / f"{_stem(path)}.{form}" for path in logs]
    _refuse_existing(logs, targets, overwrite)
    refuse_unwritable(*targets[:1])
    runs, problems = [], []
    for path, target in progress(list(zip(logs, targets, strict=True)), "reading logs"):
        try:
            run = import_log(path, log_map, loaded)
        except InputError as error:
            problems.append(str(error))
            continue
        runs.append(replace(run, name=target.name))
    against = run_contradictions(runs, loaded) if loaded is not None and not problems else []
    if force:
        runs = [replace(run, metadata={**run.metadata, "forced": against}) for run in runs] if against else runs
    else:
        problems += against
    if problems:
        hint = "nothing written"
        if problems == against:
            hint += "; put it right by --set, in map or crane file; --force imports what contradicts the crane"
        raise InputError(f"{' | '.join(problems)} ({hint})")
    written = [str(write_run(run, target)) for run, target in zip(runs, targets, strict=True)]
    for run in runs:
        show_warnings(run.warnings)
    if as_json:
        show_json(
            {"written": written, "samples": [len(run) for run in runs], "warnings": [run.warnings for run in runs]}
        )
        return
    for name, run in zip(written, runs, strict=True):
        print(f"{name}: {len(run)} samples of {', '.join(run.columns)}")


def _refuse_existing(logs: list[Path], targets: list[Path], overwrite: bool) -> None:
    from winch_friction.records.atomic import taken

    for target in targets:
        if target.exists() and any(target.resolve() == log.resolve() for log in logs):
            raise InputError(f"{target}: is the log itself; give another --out")
        if taken(target, overwrite) and not overwrite:
            raise InputError(f"{target}: exists; give another --out, or --overwrite")
