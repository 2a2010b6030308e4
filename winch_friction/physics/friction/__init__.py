"""A friction model is a list of named terms; each term is one declared equation."""

from winch_friction.physics.friction.model import FrictionModel
from winch_friction.physics.friction.term import Parameter, Scope, State, Term, register, registered_terms, term_named

__all__ = ["FrictionModel", "Parameter", "Scope", "State", "Term", "register", "registered_terms", "term_named"]
