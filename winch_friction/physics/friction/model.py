"""The friction model: named terms with parameter values, bounds and covariance; which crane it belongs to, and what it
assumes where it does not say how sure it is."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from winch_friction.physics.channels import CM3_PER_REV
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction.compiled import CompiledTerms, advance_all, compiled
from winch_friction.physics.friction.correction import Correction, check_corrections
from winch_friction.physics.friction.symbols import GROUP_SIGNALS, TIME_INDEX, WINCH_SIGNALS
from winch_friction.physics.friction.term import Parameter, Term, names_at, unique_parameters
from winch_friction.physics.signals import FloatArray
from winch_friction.physics.winch.crane import Crane


@dataclass(frozen=True)
class FrictionModel:
    """A sum of declared terms with values.

    `values` has one entry per parameter in the order of `parameters`, SI; `covariance` is (n, n) or None; `bounds`
    overrides the declared bounds by name; `constants` holds maximum displacement (m^3/rad), density, viscosity, gear
    ratio. `corrections` say what is wrong with the signals, geometry, load and inertia of the machine that it was
    identified on (`physics.corrections` takes it out); `crane` names that crane, empty where it is not known.
    Raises `InputError` for missing, unknown or non-finite values and for a covariance that is not one.

    >>> import numpy as np, winch_friction as wf
    >>> model = wf.load_model("a6vm215_crane2")
    >>> model.value("C3"), model.as_dict()["C3"], model.bounds_of("C3"), float(model.std.min()) > 0.0
    (0.562, 0.562, (0.0, 100.0), True)
    >>> model.parameter_names[:2], model.parameters[0].unit, model.term_names[-1]
    (('K1', 'K2'), 'N*m*s/rad', 'gear_load_loss')
    >>> model.with_values({"C3": 5.0}).value("C3"), model.with_covariance(None).covariance
    (5.0, None)
    >>> model.only("motor").term_names[0], model.subset(["stribeck"]).to_frame().index.tolist()
    ('motor_viscous', ['C1', 'C3', 'C4'])

    Along operating points (here of a run; `wf.torque`, `wf.contributions` and `wf.jacobian` do it in one call):

    >>> from winch_friction.physics.winch.operating_point import run_operating_points
    >>> drive = wf.load_model("emps_symmetric")
    >>> run = wf.from_frame({"time": [0.0, 0.1], "motor_speed": [1.0, -1.0], "motor_torque": [0.0, 0.0]})
    >>> x = run_operating_points(run, wf.load_crane("emps"), drum_torque=np.zeros(2))
    >>> drive.torque(x).round(1).tolist(), drive.contributions(x)["coulomb"].round(1).tolist()
    ([220.7, -227.1], [20.4, -20.4])
    >>> drive.jacobian(x).shape, drive.state_history(x), drive.compile(0).kernel is not None
    ((2, 3), (), True)
    """

    name: str
    terms: tuple[Term, ...]
    values: tuple[float, ...]
    covariance: FloatArray | None = None
    bounds: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    constants: Mapping[str, float] = field(default_factory=dict)
    provenance: Mapping[str, Any] = field(default_factory=dict)
    corrections: tuple[Correction, ...] = ()
    crane: str = ""

    def __post_init__(self) -> None:
        if self.corrections:
            check_corrections(self.corrections)
        names = self.parameter_names
        if len(self.values) != len(names):
            raise InputError(f"model '{self.name}': {len(self.values)} values for {len(names)} parameters {names}")
        for name, value in zip(names, self.values, strict=True):
            lower, upper = self.bounds_of(name)
            if not lower <= value <= upper:
                said = f"parameter {name} = {value:g} is outside {lower:g} ... {upper:g}"
                raise InputError(f"model '{self.name}': {said}")
        if self.covariance is not None:
            _check_covariance(self.name, self.covariance, len(names))

    # -- what it is made of
    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Declared parameters, in order."""
        return unique_parameters(self.terms)

    @property
    def parameter_names(self) -> tuple[str, ...]:
        """Names of the parameters, in order."""
        return tuple(parameter.name for parameter in self.parameters)

    @property
    def term_names(self) -> tuple[str, ...]:
        """Names of the terms, in order."""
        return tuple(term.name for term in self.terms)

    def bounds_of(self, parameter: str) -> tuple[float, float]:
        """Lower and upper bound of a parameter: the model's own, else the declared one."""
        declared = {each.name: (each.lower, each.upper) for each in self.parameters}
        return tuple(self.bounds.get(parameter, declared[parameter]))  # type: ignore[return-value]

    def value(self, parameter: str) -> float:
        """Value of a parameter, SI; raises `InputError` for one that the model does not have."""
        self._refuse_unknown([parameter])
        return self.as_dict()[parameter]

    def as_dict(self) -> dict[str, float]:
        """Values by parameter name, SI."""
        return dict(zip(self.parameter_names, self.values, strict=True))

    @property
    def std(self) -> FloatArray:
        """Standard deviations, zero without covariance."""
        return np.zeros(len(self.values)) if self.covariance is None else np.sqrt(np.diag(self.covariance))

    # -- for people
    def to_frame(self) -> Any:
        """The parameters as a pandas DataFrame: value, std, unit, bounds, term, meaning."""
        from winch_friction.physics.frames import model_frame

        return model_frame(self)

    def __repr__(self) -> str:
        known = "with covariance" if self.covariance is not None else "without covariance"
        return f"FrictionModel '{self.name}': {' + '.join(self.term_names)}; {len(self.values)} parameters, {known}"

    def _repr_html_(self) -> str:
        from winch_friction.physics.frames import html_table

        rows = [(p.name, v, s if self.covariance is not None else "-", p.unit, p.doc)
                for p, v, s in zip(self.parameters, self.values, self.std.tolist(), strict=True)]  # fmt: skip
        return html_table(repr(self).partition(";")[0], ("parameter", "value", "std", "unit", "meaning"), rows)

    # -- variants
    def with_values(self, values: Mapping[str, float] | Sequence[float]) -> "FrictionModel":
        """The same model with other values: all of them, or some by name."""
        if isinstance(values, Mapping):
            self._refuse_unknown(values)
            values = [values.get(name, old) for name, old in self.as_dict().items()]
        return replace(self, values=tuple(float(value) for value in values))

    def _refuse_unknown(self, names: Iterable[str]) -> None:
        if unknown := sorted(set(names) - set(self.parameter_names)):
            has = ", ".join(self.parameter_names)
            raise InputError(f"model '{self.name}' has no parameter {', '.join(unknown)}; it has {has}")

    def with_covariance(self, covariance: FloatArray | None) -> "FrictionModel":
        """The same model with another covariance."""
        return replace(self, covariance=covariance)

    def only(self, *places: str) -> "FrictionModel":
        """The part of the model whose terms belong to these places ('motor', 'gear and drum', ...), and to no other."""
        return self.subset(names_at(self.terms, places))

    def subset(self, term_names: Sequence[str]) -> "FrictionModel":
        """The model with these of its terms, values and covariance carried over."""
        terms = tuple(term for term in self.terms if term.name in term_names)
        keep = [self.parameter_names.index(parameter.name) for parameter in unique_parameters(terms)]
        covariance = None if self.covariance is None else self.covariance[np.ix_(keep, keep)]
        return replace(self, terms=terms, values=tuple(self.values[k] for k in keep), covariance=covariance)

    # -- evaluation
    def compile(self, group_count: int) -> CompiledTerms:
        """The model's functions for a winch with this many motor groups."""
        return compiled(self.terms, group_count, tuple(sorted(self.constants.items())))

    def torque(self, x: Sequence[Any], z: Sequence[Any] | None = None) -> Any:
        """Friction torque in N m at the shaft, over arrays; `x` as from `physics.winch.operating_point`."""
        functions = self.compile(_group_count(x))
        return functions.vector_torque(tuple(x), self.values, self._states(functions, x, z))

    def contributions(self, x: Sequence[Any], z: Sequence[Any] | None = None) -> dict[str, Any]:
        """Torque of every term in N m, by name, over arrays."""
        functions = self.compile(_group_count(x))
        parts = functions.vector_contributions(tuple(x), self.values, self._states(functions, x, z))
        length = np.broadcast(*x)
        return {name: np.broadcast_to(part, length.shape) for name, part in zip(self.term_names, parts, strict=True)}

    def jacobian(self, x: Sequence[Any], z: Sequence[Any] | None = None) -> FloatArray:
        """Partial derivatives of the torque by the parameters, shape (samples, parameters)."""
        functions = self.compile(_group_count(x))
        parts = functions.vector_gradient(tuple(x), self.values, self._states(functions, x, z))
        columns = np.empty((np.broadcast(*x).size, len(parts)))
        for k, part in enumerate(parts):
            columns[:, k] = part  # one that is constant comes back as a scalar
        return columns

    def _states(self, functions: CompiledTerms, x: Sequence[Any], z: Sequence[Any] | None) -> tuple[Any, ...]:
        if z is not None:
            return tuple(z)
        return functions.initial_states if np.broadcast(*x).ndim == 0 else self.state_history(x)

    def state_history(self, x: Sequence[Any]) -> tuple[FloatArray, ...]:
        """The states of the terms with memory along a record, from rest; one array per state."""
        functions = self.compile(_group_count(x))
        if not functions.initial_states:
            return ()
        rows = np.column_stack([np.broadcast_to(column, np.broadcast(*x).shape) for column in x])
        return _state_history(functions, rows, self.values)


def _state_history(functions: CompiledTerms, rows: FloatArray, theta: tuple[float, ...]) -> tuple[FloatArray, ...]:
    history = np.empty((len(rows), len(functions.initial_states)))
    z: tuple[float, ...] = functions.initial_states
    previous = rows[0, TIME_INDEX]
    for k, row in enumerate(rows.tolist()):
        after = advance_all(functions, row, theta, z, row[TIME_INDEX] - previous)
        if all(map(math.isfinite, after)):  # what happens while a signal is lost is made up for by the next row
            z, previous = after, row[TIME_INDEX]
        history[k] = z
    return tuple(history.T)


def _group_count(x: Sequence[Any]) -> int:
    return (len(x) - len(WINCH_SIGNALS)) // len(GROUP_SIGNALS)


def _check_covariance(name: str, covariance: FloatArray, size: int) -> None:
    if covariance.shape != (size, size):
        raise InputError(f"model '{name}': covariance is {covariance.shape}, expected ({size}, {size})")
    if not size:  # a model without parameters has nothing to be unsure of
        return
    scale = np.sqrt(np.clip(np.diag(covariance), 1e-300, None))
    correlation = covariance / np.outer(scale, scale)
    if not np.isfinite(covariance).all() or np.abs(correlation - correlation.T).max() > 1e-6:
        raise InputError(f"model '{name}': covariance is not finite and symmetric")
    if np.linalg.eigvalsh(correlation).min() < -1e-6:
        raise InputError(f"model '{name}': covariance is not positive semi-definite")


# -- which crane it belongs to
SAME = 1e-3  # relative; a gear ratio or displacement is a nameplate figure, written with three digits or more
# relative sigma of a parameter whose model states none: the largest that paper 1 and 2 leave to a parameter that is
# identified at all (K5 22 %, C5 and K1 20 %)
ASSUMED_STD = 0.2


def refuse_other_crane(model: FrictionModel, crane: Crane) -> None:
    """Raise `InputError`, all contradictions in one line, when a model was made for another crane than this."""
    found = contradictions(model, crane)
    if found:
        raise InputError(
            f"model '{model.name}' does not belong to crane '{crane.name}': {'; '.join(found)}; "
            "give the crane that it was made for, or a model of this crane"
        )


def _of_machine(crane: Crane) -> dict[str, float]:
    """The constants that a crane file states for its models; an electric winch has no displacement."""
    own = {"gear_ratio": crane.gear_ratio, "max_displacement": crane.max_displacement}
    return {name: value for name, value in own.items() if value > 0.0}


def completed(model: FrictionModel, crane: Crane) -> FrictionModel:
    """The model with the constants of the machine that its file does not state, from the crane that it serves: a term
    that reads the gear ratio would else be taken at a ratio of 1."""
    missing = {name: value for name, value in _of_machine(crane).items() if name not in model.constants}
    return replace(model, constants={**model.constants, **missing}) if missing else model


def refuse_other_motor(motor: FrictionModel, crane: Crane) -> None:
    """`refuse_other_crane` for the motors alone, which may have served another winch: what counts is their size."""
    own = {name: value for name, value in motor.constants.items() if name == "max_displacement"}
    refuse_other_crane(replace(motor, crane="", constants=own), crane)


def contradictions(model: FrictionModel, crane: Crane) -> list[str]:
    """What speaks against a model being of this crane, in words; empty where nothing does."""
    found = []
    if model.crane and crane.name and model.crane != crane.name:
        found.append(f"it was made for crane '{model.crane}'")
    names = {"gear_ratio": ("gear ratio", "", 1.0),
             "max_displacement": ("largest displacement", " cm^3/rev", CM3_PER_REV)}  # fmt: skip
    for name, value in _of_machine(crane).items():
        said = model.constants.get(name, value)
        if abs(said - value) > SAME * value:
            words, unit, size = names[name]
            found.append(f"its {words} is {said / size:.5g}{unit}, the crane's {value / size:.5g}{unit}")
    hydraulic = [term.name for term in model.terms if term.reads_groups]
    if hydraulic and not crane.drive.hydraulic:
        found.append(f"its terms {', '.join(hydraulic)} need pressures, the crane's drive is {crane.drive.kind}")
    return found


def with_stated_std(model: FrictionModel, share: float = ASSUMED_STD) -> tuple[FrictionModel, str]:
    """The model with a covariance, and what had to be assumed for it, in words (empty: nothing).

    A model without `std` gets `share` of each value, of a tenth of the typical size where the value is smaller.
    """
    if model.covariance is not None or not model.values:
        return model, ""
    size = [max(abs(v), 0.1 * abs(p.typical)) for v, p in zip(model.values, model.parameters, strict=True)]
    said = (
        f"model '{model.name}' states no std: {100.0 * share:g} % of each value is assumed (1 sigma); "
        "give every parameter its 'std' to say otherwise"
    )
    return replace(model, covariance=np.diag((share * np.array(size)) ** 2)), said


def unstated(model: FrictionModel, share: float = ASSUMED_STD) -> list[str]:
    """What has to be assumed of a model, in words, one entry per assumption; for the verbs to say."""
    said = with_stated_std(model, share)[1]
    return [said] if said else []
