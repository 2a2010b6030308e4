"""The documentation of the terms is what the declarations say."""

from pathlib import Path

from winch_friction.report.term_catalogue import catalogue_markdown

ROOT = Path(__file__).resolve().parents[2]


def test_the_committed_catalogue_is_current():
    committed = (ROOT / "docs/terms.md").read_text()
    assert committed.strip() == catalogue_markdown().strip(), "run: winch-friction terms --markdown > docs/terms.md"
