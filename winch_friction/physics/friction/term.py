"""A friction term: one equation, declared once; everything else is derived from it.

A name in a model file stands for exactly one declared term, by the registry.
"""

import importlib.util
import traceback
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING

import sympy as sp

from winch_friction.physics.channels import dimension_of
from winch_friction.physics.errors import InputError, meant
from winch_friction.physics.friction import symbols

if TYPE_CHECKING:
    from winch_friction.physics.friction.table import Table


class Scope(Enum):
    """Where a term's torque acts, and so how often it is counted at the shaft."""

    MOTOR = "motor"  # once per motor, from its own group's pressure and displacement
    SYSTEM = "system"  # once per motor shaft, the same for all: N times
    SHAFT = "shaft"  # once, on the common shaft


@dataclass(frozen=True)
class Parameter:
    """A parameter of a term, declared once.

    `unit` is SI; `lower` and `upper` bound every fit; `typical` is a value of the expected size (start of a fit, scale
    of a finite difference); `shape` marks a parameter in which the equation is not linear. Raises `InputError` for a
    unit that is none, and for a typical value outside the bounds.
    """

    name: str
    unit: str
    typical: float
    lower: float = 0.0
    upper: float = float("inf")
    shape: bool = False
    doc: str = ""

    def __post_init__(self) -> None:
        try:
            dimension_of(self.unit)
        except InputError as error:
            raise InputError(f"parameter '{self.name}': {error}") from None
        if not self.lower <= self.typical <= self.upper:
            raise InputError(
                f"parameter '{self.name}': typical value {self.typical:g} is outside its bounds "
                f"{self.lower:g} ... {self.upper:g}"
            )

    @property
    def symbol(self) -> sp.Symbol:
        """The SymPy symbol that stands for the parameter in its equation."""
        return sp.Symbol(self.name, real=True)


@dataclass(frozen=True)
class State:
    """Memory of a term, dz/dt = gain - decay z; linear in z, so that a step with frozen signals is exact."""

    symbol: sp.Symbol
    gain: sp.Expr
    decay: sp.Expr
    initial: float = 0.0
    doc: str = ""


@dataclass(frozen=True)
class Term:
    """One declared friction equation.

    `equation` gives the torque in N m, per motor (MOTOR, SYSTEM) or at the shaft (SHAFT). `opposing`: it is multiplied
    by the direction of motion; otherwise it acts as written. `source` cites paper and equation; `place` groups terms
    for reports: motor, gear and drum, fluid, sensor.
    """

    name: str
    equation: sp.Expr
    parameters: tuple[Parameter, ...]
    scope: Scope
    source: str
    place: str
    opposing: bool = True
    state: State | None = None
    doc: str = ""
    table: "Table | None" = None  # of a term that the model file declares (winch_friction.physics.friction.table)

    def __hash__(self) -> int:
        """Of the name, which is its own: at every sample whoever asks for compiled functions hashes all terms."""
        return hash(self.name)

    def __post_init__(self) -> None:
        unknown = self.free_symbols - self.parameter_symbols - set(symbols.SIGNAL_OF_SYMBOL) - self.state_symbols
        if unknown:
            raise InputError(
                f"term '{self.name}': symbols {sorted(map(str, unknown))} are neither signals nor parameters"
            )
        if self.scope is not Scope.MOTOR and self.free_symbols & symbols.GROUP_SYMBOLS:
            raise InputError(f"term '{self.name}': reads a motor group's signals, so its scope must be MOTOR")

    @property
    def torque(self) -> sp.Expr:
        """The equation with its direction: what acts against the hoisting direction, N m."""
        return symbols.s * self.equation if self.opposing else self.equation

    @property
    def reads_groups(self) -> bool:
        """Whether it reads a motor group's pressure or displacement."""
        return bool(self.free_symbols & symbols.GROUP_SYMBOLS)

    @property
    def free_symbols(self) -> set[sp.Basic]:
        """Every symbol of the equation and of its state equation."""
        found = set(self.equation.free_symbols)
        return found | self.state.gain.free_symbols | self.state.decay.free_symbols if self.state else found

    @property
    def parameter_symbols(self) -> set[sp.Basic]:
        """The symbols of the term's own parameters."""
        return {parameter.symbol for parameter in self.parameters}

    @property
    def state_symbols(self) -> set[sp.Basic]:
        """The symbol of the term's memory, if it has one."""
        return {self.state.symbol} if self.state else set()

    @property
    def reads(self) -> tuple[str, ...]:
        """Names of the signals that the equation needs."""
        own = self.parameter_symbols | self.state_symbols
        names = (symbols.SIGNAL_OF_SYMBOL[symbol].name for symbol in self.free_symbols - own)
        return tuple(sorted({*names, "direction"} if self.opposing else set(names)))

    @property
    def latex(self) -> str:
        """The equation in LaTeX, from the same declaration; a table of windows is told in words behind it."""
        return (self.table.latex if self.table is not None else "") or str(sp.latex(self.torque))


def unique_parameters(terms: Sequence[Term]) -> tuple[Parameter, ...]:
    """The parameters of the terms in order, each once."""
    return tuple({parameter.name: parameter for term in terms for parameter in term.parameters}.values())


# channels that a term may read and in whose place nothing can stand: a layer that is not said is the outer one
IRREPLACEABLE = ("oil_temperature", "shaft_angle", "wire_out")


def irreplaceable(reads: Iterable[str]) -> tuple[str, ...]:
    """Those of the signals that terms read."""
    read = set(reads)
    return tuple(name for name in IRREPLACEABLE if name in read)


def needed(terms: Iterable[Term]) -> tuple[str, ...]:
    """The irreplaceable channels that these terms read."""
    return irreplaceable(name for term in terms for name in term.reads)


# -- terms by name
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


def names_at(terms: Sequence[Term], places: Sequence[str]) -> list[str]:
    """Names of those of the terms that belong to these places; raises `InputError` for one where no term belongs."""
    known = sorted({each.place for each in (*registered_terms().values(), *terms)})
    for place in places:
        if place not in known:
            hint = meant(place, known) or f" places are {', '.join(known)}"
            raise InputError(f"'{place}' is no place of a term;{hint}")
    return [term.name for term in terms if term.place in places]


def term_named(name: str) -> Term:
    """The term of that name; an unknown one raises `InputError` with what to do, and those that are nearly it."""
    _load_shipped()
    if name not in _TERMS:
        raise InputError(
            f"term '{name}' is not known;{meant(name, _TERMS)} one of your own needs its file (--terms-file; gap: "
            "--effects; nodes: terms_file); winch-friction list terms names the others"
        )
    return _TERMS[name]


def file_of(term: Term) -> Path | None:
    """The user's file that the term came from; None of the package's own."""
    return next((path for path, (_, added) in _FILES.items() if term in added), None)


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
        for idle in ((t.name, p.name) for t in added for p in t.parameters if p.symbol not in t.free_symbols):
            raise InputError(f"{path}: term '{idle[0]}': its parameter {idle[1]} stands in no equation of it")
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
        raise InputError(f"{path}: {error}{_line(error, path)}") from error
    except (Exception, SystemExit) as error:  # a script that ends would end the verb, as if all were done
        said = " ".join(str(error).split())
        raise InputError(f"{path}: {type(error).__name__}: {said}{_line(error, path)}") from error


def _line(error: BaseException, path: Path) -> str:
    """Which line of a file raised, in words; an error of its syntax says so itself."""
    steps, own = traceback.extract_tb(error.__traceback__), path.resolve()
    lines = [each.lineno for each in steps if Path(each.filename).resolve() == own]
    return f" (line {lines[-1]})" if lines else ""


def _forget_all_but(names: set[str]) -> None:
    for name in set(_TERMS) - names:
        del _TERMS[name]


def _load_shipped() -> None:
    import winch_friction.physics.friction.terms  # noqa: F401  (the declarations register themselves)
