"""The documentation of the terms is what the declarations say."""

import subprocess
import sys
from pathlib import Path

import sympy as sp

from winch_friction.discrepancy.catalogue import all_candidates
from winch_friction.physics.friction import registered_terms

ROOT = Path(__file__).resolve().parents[2]


def test_the_committed_catalogue_is_current():
    """In a process of its own: other tests register terms that are not the package's."""
    command = [sys.executable, "-m", "winch_friction", "terms", "--markdown"]
    said = subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT).stdout
    committed = (ROOT / "docs/terms.md").read_text()
    assert committed.strip() == said.strip(), "run: winch-friction terms --markdown > docs/terms.md"


def test_every_cause_and_every_law_stands_in_the_documents():
    """Nothing asked for the rows: a cause with two laws could be added, found and named, and stood in no table."""
    known = all_candidates()
    told = (ROOT / "docs/discrepancy.md").read_text()
    causes = sorted({each.name for each in known if f"`{each.name}`" not in told})
    assert not causes, "a row each in docs/discrepancy.md, The catalogue"
    told = (ROOT / "docs/laws.md").read_text()
    laws = {each.term.name for each in known if each.law_name and each.term is not None and each.term.name != each.name}
    assert not sorted(name for name in laws if f"`{name}`" not in told), "in the row of their cause in docs/laws.md"


def test_no_equation_is_written_in_another_way_by_another_sympy():
    """SymPy 1.12 takes a number out of the root of a sum, 1.14 multiplies the sum by it: docs/terms.md would differ."""
    committed = (ROOT / "docs/terms.md").read_text()
    own = {name: term for name, term in registered_terms().items() if f"### `{name}`" in committed}
    for name, term in own.items():
        for power in term.torque.atoms(sp.Pow):
            if power.exp.is_Rational and not power.exp.is_Integer:
                parts = power.base.args if power.base.is_Add else (power.base,)
                assert any(abs(part.as_coeff_Mul()[0]) == 1 for part in parts), f"{name}: {power}"
