"""`winch-friction watch`: the running nodes in the terminal."""

import json
from collections.abc import Iterable, Iterator
from itertools import chain, islice
from typing import Annotated, Any

import typer

from winch_friction.cli.console import finite, stdout
from winch_friction.cli.optional import OptionalPath
from winch_friction.physics.channels import beside

DISCOVERY = 25  # frames, 5 s: nodes on a busy machine have found each other by then


def command(
    bag: Annotated[OptionalPath, typer.Option(help="Watch a bag instead of running nodes.")] = None,
    namespace: Annotated[str, typer.Option(help="Namespace of the winch's nodes.")] = "",
    joint: Annotated[str, typer.Option(help="Joint of the speed; none: winch_motor, else the first.")] = "",
    rate: Annotated[float, typer.Option(min=0.0, help="Pace of a bag: 1 as it was, 0 at once.")] = 1.0,
    frames: Annotated[
        int, typer.Option(min=0, help="End after this many frames (5 a second) once nodes are heard; 0: never.")
    ] = 0,
    as_json: Annotated[bool, typer.Option("--json", help="Frames as JSON lines.")] = False,
) -> None:
    """Watch the winch: state, rates and ages of inputs, torque, estimates with sigma and status, faults.

    Examples:

      winch-friction watch

      winch-friction watch --bag out/demo/bag --rate 5
    """
    from rich.live import Live

    from winch_friction.cli.live import frames as source

    found = source(bag, namespace, rate, joint)
    chosen = counted(found, frames) if frames else found
    if as_json:
        for frame in chosen:
            print(json.dumps(finite(frame)), flush=True)
        return
    heard, latest = iter(chosen), dict[str, float]()
    first = list(islice(heard, 1))  # before anything is drawn: what is refused at once is said alone
    try:
        with Live(console=stdout, refresh_per_second=5) as live:
            for frame in chain(first, heard):
                latest.update({name: points[-1][1] for name, points in frame["points"].items()})
                live.update(view(frame, latest))
    finally:
        if not stdout.is_terminal:  # there the last frame ends without one
            print()


def counted(found: Iterable[dict[str, Any]], frames: int) -> Iterator[dict[str, Any]]:
    """So many frames, those not counted in which the nodes have not been found yet."""
    looked = 0
    for frame in found:
        if looked < DISCOVERY and frame["time"] is None and not frame["status"]:
            looked += 1
            continue
        looked, frames = DISCOVERY, frames - 1
        yield frame
        if not frames:
            return


def view(frame: dict[str, Any], latest: dict[str, float]) -> Any:
    """The frame as tables side by side; what is not there yet is said."""
    from rich.console import Group
    from rich.markup import escape

    from winch_friction.records.telemetry import SIGNALS, estimates, faults, inputs, state

    status = frame["status"]
    if frame["time"] is None and not status:
        return "nothing heard yet: are the nodes running, and in this ROS_DOMAIN_ID?"
    wrong = faults(status)
    said = "\n".join(f"[bold red]{escape(each)}[/]" for each in wrong) if wrong else "[green]no fault[/]"
    return Group(
        f"time {frame['time']:.1f} s" if frame["time"] is not None else "no samples yet",
        said,
        _table("state", ("part", "says"), [*state(status), *frame.get("notes", ())]),
        _table("now", ("signal", "value"), [(text, f"{latest[n]:.4g}") for n, text in SIGNALS.items() if n in latest]),
        _table("estimates, SI", ("parameter", "value", "sigma", "status"),
               [(e["parameter"], f"{beside(e['value'], e['std']):.5g}", f"{e['std']:.2g}", e["status"])
                for e in estimates(status)]),
        _table("inputs", ("input", "rate [Hz]", "age [s]"),
               [(e["input"], f"{e['rate']:.1f}", f"{e['age']:.3f}") for e in inputs(status)]),
    )  # fmt: skip


def _table(title: str, columns: tuple[str, ...], rows: list[Any]) -> Any:
    from rich.markup import escape
    from rich.table import Table

    table = Table(title=title, title_justify="left")
    for column in columns:
        table.add_column(escape(column), overflow="fold")
    for row in rows:
        table.add_row(*(escape(str(cell)) for cell in row))
    return table if rows else f"{title}: nothing yet"
