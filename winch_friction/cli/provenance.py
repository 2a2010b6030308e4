"""Where a result comes from: what is said of it beside its numbers."""

import hashlib
import shlex
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any


def provenance_of(paths: Sequence[Path], crane: str = "", model: str = "", seed: int | None = None) -> dict[str, Any]:
    """What a result was made of: command, version, commit, crane, model, seed, and every file with its hash."""
    from winch_friction import __version__

    return {
        "command": " ".join(["winch-friction", *map(shlex.quote, sys.argv[1:])]), "version": __version__,
        "commit": _commit(), "crane": crane, "model": model, "seed": seed,
        "files": [{"name": path.name, "sha256": _hash(path)} for path in paths],
    }  # fmt: skip


def _hash(path: Path) -> str:
    """Of a file, or of all files of a bag's folder in order."""
    digest = hashlib.sha256()
    for each in sorted(path.rglob("*")) if path.is_dir() else [path]:
        if each.is_file():
            with each.open("rb") as content:
                while chunk := content.read(1 << 20):
                    digest.update(chunk)
    return digest.hexdigest()


def _commit() -> str:
    """Of the package's own repository, '' where it was installed without one."""
    here = Path(__file__).resolve().parents[2]
    if not (here / ".git").exists():
        return ""
    said = subprocess.run(["git", "-C", str(here), "rev-parse", "--short", "HEAD"], capture_output=True, text=True)
    return said.stdout.strip()
