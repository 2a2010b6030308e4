"""What a module imports, by its syntax: a generator must share nothing with what it checks."""

import ast
from pathlib import Path


def imported(path: Path) -> list[str]:
    """Full names of all that a file imports."""
    names: list[str] = []
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom):
            names += [f"{node.module}.{alias.name}" for alias in node.names]
        elif isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
    return names
