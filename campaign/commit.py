"""Which commit a campaign measures."""

import os
import subprocess


def commit() -> str:
    """Its short name; a copy of the files without a repository is told by CAMPAIGN_COMMIT."""
    found = subprocess.run(["git", "rev-parse", "--short", "HEAD"], capture_output=True, text=True, check=False)
    return found.stdout.strip() or os.environ.get("CAMPAIGN_COMMIT", "unknown")
