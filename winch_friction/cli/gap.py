"""`winch-friction gap`: where runs and model disagree, what is missing, the repaired model, and the proof."""

import ctypes
import gc
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import typer

from winch_friction.cli.console import show_json
from winch_friction.cli.gap_output import REPLACED, show_result, write_result
from winch_friction.cli.inputs import (
    bar_of_work,
    progress,
    read_inputs,
    recorded_crane,
    refuse_copies,
    refuse_foreign,
    refuse_implausible,
    refuse_input_as_output,
    run_paths,
    show_warnings,
)
from winch_friction.cli.names import complete_crane, complete_model
from winch_friction.cli.optional import Namespace, OptionalPath, OptionalPaths, Overwrite
from winch_friction.physics.errors import InputError, Problems

HELP = """Find where simulation and measurement disagree, name the missing effect, add it, show the gap shrink.

Writes [bold]gap.json[/bold], [bold]model.yaml[/bold] and [bold]report.html[/bold] into --out. Runs are CSV, Parquet or
rosbag2, in any mixture; some of them are locked away before anything else and used for the proof alone.

Examples:

  [cyan]winch-friction gap runs/*.csv --crane crane_150t --model a6vm215_crane2 --out gap/[/cyan]

  [cyan]winch-friction gap emps.csv --crane emps --model emps_viscous --out gap/[/cyan]

  [cyan]winch-friction gap runs/*.mcap --crane my_crane.yaml --model my_model.yaml --out gap/ --effects mine.py[/cyan]
"""

MODEL = "a6vm215_crane2"  # of the 150 t crane, where none is named
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
    namespace: Namespace = "",
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
    files = (fmu, fmu_map, params_file, overwrite, namespace)
    content, said = run_gap(list(runs or []), crane, model, out, holdout, seed, effects, report, force, *files)
    if as_json:
        show_json(content)
    else:
        show_result(content, out, said)


# -- a bar, and how its process keeps house
@contextmanager
def stepping(description: str, total: int) -> Iterator[Callable[[str], None]]:
    """A bar that moves by one each time the yielded function is told what begins."""
    with bar_of_work() as bar:
        task = bar.add_task(description, total=total)
        begun = 0

        def tell(what: str) -> None:
            nonlocal begun
            give_freed_memory_back()
            bar.update(task, description=f"{description}: {what}", completed=begun)
            begun += 1

        yield tell


# For a process that makes and lets go objects and arrays all the time.
#
# A search takes some 100 000 arrays of 0.1 to 2 MB. glibc gives what is free at the end of its heap back to the system
# at once, and every page that is taken again costs a fault: 240 000 of them in a `gap` of twelve runs, a tenth of its
# processor time. The environment's `MALLOC_..._` variables would do the same, but a process cannot set its own.
#
# Python looks for garbage in cycles after every 700 new objects, and ever again goes through all that SymPy and numba
# hold, which is no garbage: another tenth. What a search lets go has no cycles and is freed without that.

# glibc's malloc.h; bytes
M_TRIM_THRESHOLD, KEPT_FREE = -1, 128 << 20  # a quarter of what a search of an hour holds at its peak
M_TOP_PAD, TAKEN_AHEAD = -2, 16 << 20
M_MMAP_THRESHOLD, ON_THEIR_OWN = -3, 4 << 20  # larger arrays still go back at once: they make the peak
RARELY = (20_000, 10, 20)  # objects more, looks at the youngest, looks at the middle: some twenty looks in a search


@contextmanager
def search_at_hand() -> Iterator[None]:
    """Keep what is freed, and look for garbage rarely until the end."""
    keep_freed_memory()
    before = gc.get_threshold()
    gc.set_threshold(*RARELY)
    try:
        yield
    finally:
        gc.set_threshold(*before)


def keep_freed_memory() -> bool:
    """Let this process keep what it has freed for what it takes next; False where the C library is not glibc."""
    try:
        mallopt = ctypes.CDLL(None).mallopt
    except (OSError, AttributeError, TypeError):
        return False
    pairs = ((M_MMAP_THRESHOLD, ON_THEIR_OWN), (M_TRIM_THRESHOLD, KEPT_FREE), (M_TOP_PAD, TAKEN_AHEAD))
    return {mallopt(option, size) for option, size in pairs} == {1}


def give_freed_memory_back() -> bool:
    """Let the system have what one step has freed, before the next takes as much in other pieces: between the arrays
    that stay it is a sixth of the peak. False where the C library is not glibc."""
    try:
        return bool(ctypes.CDLL(None).malloc_trim(0))
    except (OSError, AttributeError, TypeError):
        return False


# -- from files to files
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
    namespace: str = "",
) -> tuple[dict[str, Any], Collection[str]]:
    """The workflow from files to files; returns the content of gap.json, and which of its notes were warnings."""
    from winch_friction.cli.provenance import provenance_of
    from winch_friction.commissioning.check import same_recordings
    from winch_friction.discrepancy.answer import STEPS, GapOptions
    from winch_friction.discrepancy.workflow import find_gap
    from winch_friction.physics.friction.model import unstated
    from winch_friction.physics.friction.term import load_file
    from winch_friction.records.input_mapping import bag_options_of
    from winch_friction.records.model_file import load_model
    from winch_friction.records.runs import refuse_same_names

    if not paths:
        raise InputError("no run given; name at least one run file, or use --blind N")
    paths = run_paths(paths)
    problems = Problems()
    with problems:
        for name in ("model.yaml", "gap.json", "addition.csv"):
            refuse_input_as_output(out / name, [model, *paths])
        refuse_foreign(out, WRITTEN, "gap.json", "winch_friction.gap/", overwrite)
    options = GapOptions(holdout=holdout, seed=seed, effects_file=effects)
    if effects is not None:
        load_file(effects)  # before the model, which may be one that these effects have repaired
    assumed = not (model or crane)
    model = model or _usual_model(crane, paths)
    crane = load_model(MODEL).crane if assumed else crane
    conventions = bag_options_of(params_file, namespace) if params_file or namespace else {}
    read, loaded_crane, seed_model = read_inputs(paths, crane, model, conventions, unstated, problems.found)
    warned = [*(each for run in read for each in run.warnings), *same_recordings(read)]
    show_warnings(warned)
    refuse_same_names(read, paths)
    refuse_copies(read)
    read = _simulated(read, fmu, fmu_map)
    try:
        forced = refuse_implausible(read, loaded_crane, seed_model, force, paths, warned.extend)
    except InputError as error:
        if not assumed:
            raise
        raise InputError(
            f"no --crane and no --model were given, and these runs are not of crane '{loaded_crane.name}', which is "
            f"taken then: name your own ({error})"
        ) from None
    with stepping("comparing with the model", STEPS) as tell:
        result = find_gap(read, loaded_crane, seed_model, replace(options, told=tell))
    made = provenance_of(paths, loaded_crane.name, model, seed) | forced
    noted = replace(result.model, provenance={**result.model.provenance, **forced})
    result = replace(result, provenance=made, model=noted, notes=(*warned, *result.notes))
    content = result.content()
    write_result(out, result, content, read)
    if report:
        from winch_friction.report.gap import write_gap_report

        write_gap_report(out / "report.html", result)
    return content, warned


def _usual_model(crane: str, paths: list[Path]) -> str:
    """The model that is taken where none is named, said on stderr; for a crane that has none, raises `InputError`."""
    from winch_friction.cli.names import models_of
    from winch_friction.records.crane_file import load_crane
    from winch_friction.records.model_file import load_model

    usual = load_model(MODEL)
    named = load_crane(crane).name if crane else recorded_crane(paths)[0]
    if named not in ("", usual.crane):
        shipped = ", ".join(models_of(named))
        has = f"shipped for it: {shipped}" if shipped else "`winch-friction init model` writes one to begin with"
        raise InputError(f"which model of crane '{named}'? Give --model with a model file or a name; {has}")
    taken = f"no --crane and no --model: taken as crane '{usual.crane}' and model '{MODEL}'; name your own if not"
    show_warnings([f"no --model: taken as '{MODEL}', of crane '{usual.crane}'" if named else taken])
    return MODEL


def _simulated(runs: list[Any], fmu: Path | None, fmu_map: Path | None) -> list[Any]:
    """The runs with the columns that a user's FMU simulates for them."""
    if (fmu is None) != (fmu_map is None):
        raise InputError("--fmu and --fmu-map belong together: an FMU, and what of it is which column")
    if fmu is None or fmu_map is None:
        return runs
    from winch_friction.simulation.fmu import load_fmu_map, simulate_fmu

    links = load_fmu_map(fmu_map)
    return [simulate_fmu(fmu, links, run) for run in progress(runs, "simulating by the FMU")]
