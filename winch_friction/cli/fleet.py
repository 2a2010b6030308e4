"""`winch-friction fleet`: the same verbs over many recordings of many cranes, on Dask."""

import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from winch_friction.cli.console import show_json, show_table
from winch_friction.cli.fleet_work import VERBS, Task, carry_out, dated_rows, own_folders, plan
from winch_friction.cli.inputs import progress
from winch_friction.cli.names import complete_crane, complete_model
from winch_friction.cli.optional import OptionalInt, OptionalTexts
from winch_friction.fleet.ledger import Ledger, Outcome, verdict_of
from winch_friction.physics.errors import InputError, Problems

if TYPE_CHECKING:
    from winch_friction.fleet.recordings import Recording


def command(
    verb: Annotated[str, typer.Argument(help=f"One of {', '.join(VERBS)}.")],
    sources: Annotated[
        list[str], typer.Argument(help="Bags, run files, folders of them, or addresses such as s3://bucket/prefix.")
    ],
    out: Annotated[Path, typer.Option(help="Folder for results, fleet.json, the store and the summary page.")],
    crane: Annotated[
        str,
        typer.Option(
            help="Crane file or shipped name; {crane} is the recording's folder.", autocompletion=complete_crane
        ),
    ],
    model: Annotated[
        str,
        typer.Option(
            help="Model file or shipped name (for identify the motor's); {crane} likewise.",
            autocompletion=complete_model,
        ),
    ],
    option: Annotated[OptionalTexts, typer.Option(help="Option for the verb, NAME=VALUE or NAME; repeatable.")] = None,
    storage: Annotated[OptionalTexts, typer.Option(help="Option of the storage, NAME=VALUE; repeatable.")] = None,
    workers: Annotated[
        OptionalInt, typer.Option(min=0, help="Processes; 0: this one. Default: as many as cores.")
    ] = None,
    scheduler: Annotated[str, typer.Option(help="Address of a Dask scheduler; empty: a cluster on this machine.")] = "",
    anew: Annotated[bool, typer.Option("--anew", help="Do again what fleet.jsonl says is done.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="All outcomes as JSON.")] = False,
) -> None:
    """Run a verb over many recordings; one that fails does not stop the others, and a killed run goes on where it was.

    The folder that a recording lies in is its crane. Recordings with Unix time are followed over the months.

    Examples:

      winch-friction fleet replay bags/ --crane crane_150t --model a6vm215_crane2 --out fleet/

      winch-friction fleet gap cranes/ --crane cranes/{crane}.yaml --model seed.yaml --out fleet/ --option holdout=0.3

      winch-friction fleet check s3://logs --crane my.yaml --model seed.yaml --out fleet/ --scheduler tcp://host:8786
    """
    from winch_friction.cli.inputs import refuse_foreign, refuse_unwritable
    from winch_friction.cli.provenance import provenance_of
    from winch_friction.fleet.recordings import find_recordings
    from winch_friction.records.strict_yaml import shipped

    problems = Problems()
    with problems:
        refuse_unwritable(out / "fleet.json")
        refuse_foreign(out, ("fleet.json", "report.html"), "fleet.jsonl")
    options = _storage_options(storage or [])
    with problems:
        recordings, tables = _without_tables(find_recordings(sources, options, own_folders(out)))
    for kind, name in (("cranes", crane), ("models", model)):
        with problems:
            # else each recording's own; what it says the workers read, who have its terms
            if (name or kind == "models") and "{crane}" not in name:
                shipped(kind, name)
    problems.say()
    tasks = plan(verb, recordings, out, crane, model, _flags(option or []), options)
    outcomes = _done(tasks, Ledger(out / "fleet.jsonl"), workers, scheduler, anew)
    content = {"verb": verb, "outcomes": [asdict(each) for each in outcomes], **_over_time(outcomes, out)}
    content["notes"] += [f"{each.address}: a supplier's table and no recording: left out" for each in tables]
    content["provenance"] = provenance_of([], crane, model)  # the recordings' names are below; many, and far away
    _write(out, content, verb, outcomes)
    if as_json:
        show_json(content)
    else:
        rows = [(o.recording, o.status, o.seconds, verdict_of(o)) for o in outcomes]
        show_table(f"{verb} over {len(recordings)} recordings", ("recording", "exit", "seconds", "outcome"), rows)
        _show_changes(content)
    raise typer.Exit(_status(outcomes))


def _without_tables(found: "list[Recording]") -> "tuple[list[Recording], list[Recording]]":
    """The recordings, and the suppliers' tables that lie among them on this machine.

    Raises `InputError` where nothing else is there.
    """
    from winch_friction.identification.supplier_file import is_supplier_table

    tables = [each for each in found if "://" not in each.address and is_supplier_table(Path(each.address))]
    if tables and len(tables) == len(found):
        raise InputError(f"{tables[0].address}: a supplier's table and no recording; 'identify motor' reads it")
    return [each for each in found if each not in tables], tables


def _done(tasks: list[Task], ledger: Ledger, workers: int | None, scheduler: str, anew: bool) -> list[Outcome]:
    """Every task's outcome: from the ledger where it ended well, else worked out now and put there at once.

    A refusal may have been a full disk's or a missing library's, which no name of the work tells.
    """
    from winch_friction.fleet.schedule import on_dask, on_this_process

    known = {} if anew else ledger.latest()
    waiting = [task for task in tasks if known.get(task.key) is None or known[task.key].status != 0]
    pieces = [(task,) for task in waiting]
    local = workers == 0 and not scheduler
    stream = on_this_process(carry_out, pieces) if local else on_dask(carry_out, pieces, workers, scheduler)
    if waiting:
        for outcome in progress(stream, "fleet", total=len(waiting)):
            ledger.add(outcome)
            known[outcome.key] = outcome
    return sorted((known[task.key] for task in tasks), key=lambda each: each.recording)


def _over_time(outcomes: list[Outcome], out: Path) -> dict[str, Any]:
    """What the dated recordings say of the cranes: steps, and who is unlike the others."""
    from winch_friction.fleet.drift import find_steps, find_unlike, month_text, monthly
    from winch_friction.fleet.fingerprint import TRAITS
    from winch_friction.fleet.store import write_store

    rows = dated_rows(outcomes)
    write_store(out / "store", rows)
    series: dict[tuple[str, str], list[tuple[float, float, float]]] = {}
    for row in rows:
        if row["kind"] == "trait":
            series.setdefault((row["crane"], row["name"]), []).append((row["time"], row["value"], row["std"]))
    followed = monthly(series)
    undated = not rows and any(each.status == 0 and each.result["traits"] for each in outcomes)
    return {
        "steps": [
            asdict(step) | {"month": month_text(step.month), "unit": TRAITS[step.trait]}
            for step in find_steps(followed)
        ],
        "unlike": [asdict(each) | {"unit": TRAITS[each.trait]} for each in find_unlike(followed)],
        "notes": ["no recording has a Unix time: nothing can be followed over the months"] if undated else [],
    }


def _write(out: Path, content: dict[str, Any], verb: str, outcomes: list[Outcome]) -> None:
    from winch_friction.records.atomic import write_text
    from winch_friction.report.fleet import write_fleet_report

    write_text(out / "fleet.json", json.dumps(content, indent=1, default=str))
    write_fleet_report(out / "report.html", verb, outcomes, content, out / "store", content["provenance"])


def _show_changes(content: dict[str, Any]) -> None:
    steps = [(s["crane"], s["trait"], s["month"], s["size"], s["unit"], s["p_value"]) for s in content["steps"]]
    if steps:
        show_table("changed", ("crane", "what", "month", "size", "unit", "p"), steps)
    unlike = [(u["crane"], u["trait"], u["level"], u["fleet"], u["unit"], u["score"]) for u in content["unlike"]]
    if unlike:
        show_table("unlike the others", ("crane", "what", "level", "fleet", "unit", "deviations"), unlike)
    for note in content["notes"]:
        print(note)


def _flags(options: list[str]) -> list[str]:
    return [part for each in options for part in f"--{each}".split("=", 1)]


def _storage_options(pairs: list[str]) -> dict[str, Any]:
    wrong = [each for each in pairs if "=" not in each]
    if wrong:
        raise InputError(f"--storage '{wrong[0]}': write NAME=VALUE, e.g. endpoint_url=http://127.0.0.1:9000")
    return dict(each.split("=", 1) for each in pairs)


def _status(outcomes: list[Outcome]) -> int:
    """1 when any met a defect, 2 when any input was bad, else 0."""
    found = {each.status for each in outcomes}
    return 0 if found <= {0} else 2 if found <= {0, 2} else 1
