"""Declare a friction term of your own: one equation, and everything else is derived from it.

The names of `signals` are the quantities an equation may read, as SymPy symbols. A file with such declarations is what
`--effects` of `gap`, `--terms-file` of `replay` and the nodes' parameter `terms_file` load.

>>> import winch_friction as wf
>>> drag = wf.terms.Parameter("T_scraper", "N*m", 5.0, upper=100.0, doc="drag of the drum's rope scraper")
>>> term = wf.terms.Term("rope_scraper", drag.symbol, (drag,), wf.terms.Scope.SHAFT, "own measurement", "gear and drum")
>>> term.reads
('direction',)
>>> "stribeck" in wf.terms.registered_terms()
True
"""

from winch_friction.physics.friction import Parameter, Scope, State, Term, register, registered_terms, term_named
from winch_friction.physics.friction import symbols as signals

__all__ = ["Parameter", "Scope", "State", "Term", "register", "registered_terms", "signals", "term_named"]
