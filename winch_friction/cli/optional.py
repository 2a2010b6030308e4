"""Option types that may be absent, as Typer 0.9 (Ubuntu 24.04's) reads them: it does not know `X | None` yet."""

from pathlib import Path
from typing import Optional

OptionalFloat = Optional[float]  # noqa: UP045
OptionalInt = Optional[int]  # noqa: UP045
OptionalPath = Optional[Path]  # noqa: UP045
OptionalPaths = Optional[list[Path]]  # noqa: UP045
OptionalTexts = Optional[list[str]]  # noqa: UP045
