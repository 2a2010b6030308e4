"""`winch-friction terms`: what friction terms there are."""

from typing import Annotated

import typer


def command(
    markdown: Annotated[bool, typer.Option(help="The whole catalogue as Markdown, as in docs/terms.md.")] = False,
) -> None:
    """List the declared friction terms: name, place, parameters, source.

    Example: winch-friction terms --markdown > docs/terms.md
    """
    from winch_friction.physics.friction import registered_terms
    from winch_friction.report.term_catalogue import catalogue_markdown

    if markdown:
        print(catalogue_markdown())
        return
    from rich.console import Console
    from rich.table import Table

    table = Table("term", "place", "parameters", "source")
    for name, term in sorted(registered_terms().items()):
        table.add_row(name, term.place, ", ".join(p.name for p in term.parameters), term.source)
    Console().print(table)
