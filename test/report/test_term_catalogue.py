"""The documentation of the terms is what the declarations say."""

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def test_the_committed_catalogue_is_current():
    """In a process of its own: other tests register terms that are not the package's."""
    command = [sys.executable, "-m", "winch_friction", "terms", "--markdown"]
    said = subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT).stdout
    committed = (ROOT / "docs/terms.md").read_text()
    assert committed.strip() == said.strip(), "run: winch-friction terms --markdown > docs/terms.md"
