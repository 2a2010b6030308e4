"""The report of the discrepancy workflow."""

from pathlib import Path

from winch_friction.discrepancy.result import GapResult
from winch_friction.report.base import TextSection, write_report


def write_gap_report(path: Path, result: GapResult) -> Path:
    """Write report.html."""
    return write_report(path, "Gap", [TextSection("Verdict", result.verdict)])
