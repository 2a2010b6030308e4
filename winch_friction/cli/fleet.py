"""`winch-friction fleet`: the same verbs over many recordings, on Dask."""

import contextlib
import io
import json
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from winch_friction.cli.console import progress, show_json, show_table
from winch_friction.cli.optional import OptionalInt, OptionalTexts
from winch_friction.physics.errors import InputError

# verb -> where its result goes below --out
OUTPUTS = {"replay": "{name}.parquet", "gap": "{name}"}
RUN_SUFFIXES = (".csv", ".parquet", ".mcap", ".db3")


@dataclass(frozen=True)
class Outcome:
    """What one recording gave: exit status, seconds, the verb's own JSON (or its error line)."""

    recording: str
    status: int
    seconds: float
    result: Any
    message: str


def command(
    verb: Annotated[str, typer.Argument(help=f"One of {', '.join(OUTPUTS)}.")],
    recordings: Annotated[
        list[Path], typer.Argument(help="Bags or run files; for gap also folders of a crane's runs.")
    ],
    out: Annotated[Path, typer.Option(help="Folder for the results and fleet.json.")],
    crane: Annotated[str, typer.Option(help="Crane file or shipped name.")],
    model: Annotated[str, typer.Option(help="Model file or shipped name.")],
    option: Annotated[OptionalTexts, typer.Option(help="Option for the verb, NAME=VALUE or NAME; repeatable.")] = None,
    workers: Annotated[
        OptionalInt, typer.Option(min=0, help="Processes; 0: this one. Default: as many as cores.")
    ] = None,
    scheduler: Annotated[str, typer.Option(help="Address of a Dask scheduler; empty: a cluster on this machine.")] = "",
    as_json: Annotated[bool, typer.Option("--json", help="All outcomes as JSON.")] = False,
) -> None:
    """Run a verb over many recordings; one that fails does not stop the others.

    Examples:

      winch-friction fleet replay bags/* --crane crane_150t --model a6vm215_crane2 --out fleet/

      winch-friction fleet gap cranes/* --crane crane_150t --model a6vm215_crane2 --out fleet/ --option holdout=0.3
    """
    if verb not in OUTPUTS:
        raise InputError(f"fleet knows the verbs {', '.join(OUTPUTS)}, not '{verb}'")
    tasks = _tasks(verb, recordings, out, ["--crane", crane, "--model", model, *_flags(option or [])])
    out.mkdir(parents=True, exist_ok=True)
    outcomes = list(progress(_outcomes(tasks, workers, scheduler), "fleet", total=len(tasks)))
    outcomes.sort(key=lambda each: each.recording)
    content = [asdict(each) for each in outcomes]
    (out / "fleet.json").write_text(json.dumps(content, indent=1), encoding="utf-8")
    if as_json:
        show_json(content)
    else:
        rows = [(o.recording, o.status, o.seconds, o.message or "done") for o in outcomes]
        show_table(f"{verb} over {len(outcomes)} recordings", ("recording", "exit", "seconds", "outcome"), rows)
    raise typer.Exit(_status(outcomes))


def carry_out(recording: str, arguments: list[str]) -> Outcome:
    """One verb on one recording, in whichever process this is called."""
    from winch_friction.cli.main import run

    said, complained, begin = io.StringIO(), io.StringIO(), time.monotonic()
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(complained):
        status = run(arguments)
    lines = [line for line in complained.getvalue().splitlines() if line.strip()]
    result = _parsed(said.getvalue()) if status == 0 else None
    message = "" if status == 0 else (lines or ["no message"])[-1]
    return Outcome(recording, status, time.monotonic() - begin, result, message)


def _parsed(text: str) -> Any:
    try:
        return json.loads(text)
    except ValueError:
        return text.strip()


def _tasks(verb: str, recordings: list[Path], out: Path, options: list[str]) -> list[tuple[str, list[str]]]:
    names = [path.name if path.is_dir() else path.stem for path in recordings]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"two recordings are named '{name}': their results would overwrite each other; rename one")
    tasks = []
    for name, path in zip(names, recordings, strict=True):
        target = str(out / OUTPUTS[verb].format(name=name))
        tasks.append((str(path), [verb, *_inputs(verb, path), *options, "--out", target, "--json"]))
    return tasks


def _inputs(verb: str, path: Path) -> list[str]:
    """The recording itself; for gap, a folder that is no bag stands for the runs in it."""
    if verb == "gap" and path.is_dir() and not (path / "metadata.yaml").is_file():
        found = sorted(each for each in path.iterdir() if each.suffix in RUN_SUFFIXES or each.is_dir())
        return [str(each) for each in found]
    return [str(path)]


def _flags(options: list[str]) -> list[str]:
    return [part for each in options for part in f"--{each}".split("=", 1)]


def _outcomes(tasks: list[tuple[str, list[str]]], workers: int | None, scheduler: str) -> Iterator[Outcome]:
    if workers == 0 and not scheduler:
        return (carry_out(*task) for task in tasks)
    return _on_dask(tasks, workers, scheduler)


def _on_dask(tasks: list[tuple[str, list[str]]], workers: int | None, scheduler: str) -> Iterator[Outcome]:
    from dask.distributed import Client, LocalCluster, as_completed

    with contextlib.ExitStack() as stack:
        local = {"n_workers": workers, "threads_per_worker": 1, "dashboard_address": None, "silence_logs": 40}
        cluster = scheduler or stack.enter_context(LocalCluster(**local))
        client = stack.enter_context(Client(cluster))
        for future in as_completed([client.submit(carry_out, *task, pure=False, retries=1) for task in tasks]):
            yield future.result()


def _status(outcomes: list[Outcome]) -> int:
    """1 when any met a defect, 2 when any input was bad, else 0."""
    found = {each.status for each in outcomes}
    return 0 if found <= {0} else 2 if found <= {0, 2} else 1
