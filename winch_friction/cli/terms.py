"""`winch-friction terms`: what friction terms there are."""

from typing import Annotated

import typer

from winch_friction.cli.console import show_json, show_table
from winch_friction.cli.inputs import load_terms
from winch_friction.cli.names import KINDS, complete_term
from winch_friction.cli.optional import OptionalPath


def command(
    name: Annotated[
        str, typer.Argument(help="One term: its equation, parameters, source.", autocompletion=complete_term)
    ] = "",
    markdown: Annotated[bool, typer.Option(help="The whole catalogue as Markdown, as in docs/terms.md.")] = False,
    terms_file: Annotated[OptionalPath, typer.Option(help="Python file with friction terms of your own.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="As JSON.")] = False,
) -> None:
    """List the declared friction terms, or show one with its equation.

    Examples:

      winch-friction terms

      winch-friction terms stribeck

      winch-friction terms mine --terms-file mine.py

      winch-friction terms --markdown > docs/terms.md
    """
    load_terms(terms_file)
    if name:
        from winch_friction.cli.show import show_physics as shown
        from winch_friction.physics.friction import term_named

        term_named(name)  # an unknown name is refused with those there are
        shown(name, None, as_json)
        return
    if markdown:
        from winch_friction.report.term_catalogue import catalogue_markdown

        print(catalogue_markdown())
        return
    rows = KINDS["terms"].rows()
    if as_json:
        show_json(rows)
        return
    show_table("terms", list(rows[0]), [list(row.values()) for row in rows])
