"""`winch-friction list`: what there is by name."""

from typing import Annotated

import typer

from winch_friction.cli.console import show_json, show_table
from winch_friction.cli.names import KINDS, complete_kind
from winch_friction.physics.errors import InputError


def command(
    kind: Annotated[
        str, typer.Argument(help=f"One of {', '.join(KINDS)}; all without.", autocompletion=complete_kind)
    ] = "",
    as_json: Annotated[bool, typer.Option("--json", help="As JSON.")] = False,
) -> None:
    """List models, cranes, scenarios, suppliers' tables, terms, effects and units.

    Examples:

      winch-friction list

      winch-friction list models

      winch-friction list effects --json
    """
    if kind and kind not in KINDS:
        raise InputError(f"list: '{kind}' is not a kind of thing; there are {', '.join(KINDS)}")
    if not kind:
        rows = [{"kind": k.name, "what": k.about, "how many": len(list(k.names()))} for k in KINDS.values()]
    else:
        rows = KINDS[kind].rows()
    if as_json:
        show_json(rows)
        return
    show_table(
        kind or "what there is; list it with: winch-friction list KIND", list(rows[0]), [list(r.values()) for r in rows]
    )
