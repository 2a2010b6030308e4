"""The registry: a name in a model file stands for exactly one declared term."""

import importlib.util
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from winch_friction.physics.errors import InputError, meant
from winch_friction.physics.friction.term import Term

_TERMS: dict[str, Term] = {}
_FILES: dict[Path, tuple[bytes, tuple[Term, ...]]] = {}  # users' files: their text when loaded, the terms they added


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
        raise InputError(
            f"term '{name}' is not known; known terms are {', '.join(sorted(_TERMS))};{meant(name, _TERMS)} "
            "one of your own needs its file (--terms-file; gap: --effects; nodes: terms_file)"
        )
    return _TERMS[name]


def load_file(path: Path | str) -> list[Term]:
    """Run a user's Python file that registers terms of its own; returns those that it added.

    A file that was loaded before is not run again. Raises `InputError` in one line, and adds nothing, for a file that
    is missing, fails, declares no term, or has changed since it was loaded.
    """
    path = Path(path)
    _load_shipped()
    text, own = _text(path), path.resolve()
    if own not in _FILES:
        _FILES[own] = text, _added_by(path)
    loaded, terms = _FILES[own]
    if loaded != text:
        raise InputError(f"{path}: changed since its terms were loaded; start anew to use it")
    return list(terms)


@contextmanager
def known_for_now(term: Term) -> Iterator[None]:
    """Let a term that is only proposed be read from a model's text, and forget it afterwards."""
    _load_shipped()
    own = term.name not in _TERMS
    if own:
        _TERMS[term.name] = term
    try:
        yield
    finally:
        if own:
            del _TERMS[term.name]


def _text(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError:
        raise InputError(f"{path}: not a readable Python file of terms") from None


def _added_by(path: Path) -> tuple[Term, ...]:
    before = set(_TERMS)
    try:
        _run(path)
        added = tuple(_TERMS[name] for name in _TERMS if name not in before)
        if not added:
            raise InputError(f"{path}: declares no term; it needs register(Term(...))")
    except InputError:
        _forget_all_but(before)
        raise
    return added


def _run(path: Path) -> None:
    spec = importlib.util.spec_from_file_location(f"winch_friction_user_{path.stem}", path)
    if spec is None or spec.loader is None:
        raise InputError(f"{path}: not a readable Python file of terms")
    try:
        spec.loader.exec_module(importlib.util.module_from_spec(spec))
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    except Exception as error:
        raise InputError(f"{path}: {type(error).__name__}: {' '.join(str(error).split())}") from error


def _forget_all_but(names: set[str]) -> None:
    for name in set(_TERMS) - names:
        del _TERMS[name]


def _load_shipped() -> None:
    import winch_friction.physics.friction.terms  # noqa: F401  (the declarations register themselves)
