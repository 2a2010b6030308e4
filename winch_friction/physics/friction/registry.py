"""The registry: a name in a model file stands for exactly one declared term."""

import importlib.util
from pathlib import Path

from winch_friction.physics.errors import InputError
from winch_friction.physics.friction.term import Term

_TERMS: dict[str, Term] = {}


def register(term: Term) -> Term:
    """Bind a term to its name; a second term of that name raises `InputError`."""
    if term.name in _TERMS:
        raise InputError(f"term '{term.name}' is declared twice; give the second one another name")
    _TERMS[term.name] = term
    return term


def registered_terms() -> dict[str, Term]:
    """All declared terms by name."""
    _load_shipped()
    return dict(_TERMS)


def term_named(name: str) -> Term:
    """The term of that name; an unknown one raises `InputError` with the names there are."""
    _load_shipped()
    if name not in _TERMS:
        raise InputError(f"term '{name}' is not known; known terms are {', '.join(sorted(_TERMS))}")
    return _TERMS[name]


def load_file(path: Path) -> list[Term]:
    """Run a user's Python file that registers terms of its own; returns those that it added."""
    _load_shipped()
    before = set(_TERMS)
    spec = importlib.util.spec_from_file_location(f"winch_friction_user_{path.stem}", path)
    if spec is None or spec.loader is None or not path.is_file():
        raise InputError(f"{path}: not a readable Python file of terms")
    try:
        spec.loader.exec_module(importlib.util.module_from_spec(spec))
    except InputError:
        raise
    except Exception as error:
        raise InputError(f"{path}: {type(error).__name__}: {error}") from error
    return [_TERMS[name] for name in _TERMS if name not in before]


def _load_shipped() -> None:
    import winch_friction.physics.friction.terms  # noqa: F401  (the declarations register themselves)
