"""Option types that several verbs share; what may be absent as Typer 0.9 (Ubuntu 24.04's) reads it, which does not know
`X | None` yet.
"""

from pathlib import Path
from typing import Annotated, Optional

import typer

OptionalFloat = Optional[float]  # noqa: UP045
OptionalInt = Optional[int]  # noqa: UP045
OptionalPath = Optional[Path]  # noqa: UP045
OptionalPaths = Optional[list[Path]]  # noqa: UP045
OptionalTexts = Optional[list[str]]  # noqa: UP045
Namespace = Annotated[str, typer.Option(help="Which winch of a bag or --params-file; /: the one without.")]
Overwrite = Annotated[bool, typer.Option("--overwrite", help="Replace what is there under that name.")]
