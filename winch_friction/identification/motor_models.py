"""The thirteen motor-loss models of paper 1 (section 3, Table 1) by name, as compositions of declared terms."""

from collections.abc import Mapping
from dataclasses import dataclass

from winch_friction.physics.channels import CM3_PER_REV
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel, Parameter, term_named
from winch_friction.physics.friction.term import unique_parameters


@dataclass(frozen=True)
class MotorModel:
    """One published model: its terms, and how the paper classes it.

    `displacement` is 'fixed' where the model does not read the displacement setting; `signed`: coefficients of a purely
    numerical interpolation, free in sign.
    """

    name: str
    title: str
    year: int
    kind: str
    displacement: str
    terms: tuple[str, ...]
    signed: bool = False
    note: str = ""


_MJ3 = ("motor_coulomb", "motor_pressure_loss", "motor_viscous", "motor_turbulence")
_MJ4 = ("motor_viscous", "motor_turbulence", "motor_load_loss", "motor_coulomb", "high_pressure_mixed")
_ORTWIG = (
    "motor_coulomb", "motor_pressure_loss", "motor_viscous", "ortwig_speed_pressure", "motor_speed_squared",
    "ortwig_displacement", "motor_load_loss", "ortwig_displacement_speed",
)  # fmt: skip
_HUHTALA = ("huhtala_intercept_low", "huhtala_slope_low", "huhtala_intercept_high", "huhtala_slope_high")
_HUHTALA_NOTE = "a reconstruction: the original polynomials are not public"

_MODELS = (
    MotorModel("wilson", "Wilson", 1948, "physical", "fixed", ("wilson_load", "wilson_viscous", "wilson_constant")),
    MotorModel("schlosser", "Schlösser", 1961, "physical", "fixed",
               ("wilson_load", "wilson_viscous", "schlosser_inertia")),
    MotorModel("thoma", "Thoma", 1969, "physical", "variable", ("wilson_load", "wilson_viscous", "thoma_inertia")),
    MotorModel("pacey", "Pacey", 1979, "physical", "variable", ("pacey_load", "pacey_viscous", "motor_coulomb"),
               note="α read as the swivel angle (at most 25°), not the 0..1 setting"),
    MotorModel("huhtala", "Huhtala", 1997, "numerical", "variable", _HUHTALA, signed=True, note=_HUHTALA_NOTE),
    MotorModel("ortwig", "Ortwig", 2002, "numerical", "variable", _ORTWIG, signed=True),
    MotorModel("jeong", "Jeong", 2007, "physical", "fixed",
               ("motor_coulomb", "motor_pressure_loss", "motor_viscous", "motor_speed_squared", "jeong_notch",
                "high_pressure_mixed")),
    MotorModel("mj1", "MJ1", 2017, "physical", "variable", (*_MJ3, "jeong_notch", "high_pressure_mixed")),
    MotorModel("mj2", "MJ2", 2017, "physical", "variable", (*_MJ3, "high_pressure_mixed")),
    MotorModel("mj3", "MJ3", 2017, "physical", "variable", _MJ3),
    MotorModel("mj4", "MJ4", 2017, "physical and numerical", "variable", _MJ4),
    MotorModel("mj5", "MJ5", 2017, "physical and numerical", "variable",
               ("motor_viscous", "mj5_port_flow", "motor_load_loss", "motor_coulomb", "high_pressure_mixed"),
               note="extends MJ4; base of the power normalised to 2000 rpm and full displacement"),
    MotorModel("mj6", "MJ6", 2017, "physical and numerical", "variable", (*_MJ4, "mj6_notch"),
               note="6 parameters (Table 1 prints 5)"),
)  # fmt: skip

MOTOR_MODELS: Mapping[str, MotorModel] = {model.name: model for model in _MODELS}


def motor_model_named(name: str) -> MotorModel:
    """A model of paper 1 by name (any case); an unknown name raises `InputError`."""
    found = MOTOR_MODELS.get(name.lower())
    if found is None:
        raise InputError(f"motor model '{name}' is not known; known models are {', '.join(MOTOR_MODELS)}")
    return found


# power of a motor's size with which a parameter goes, as in paper 2 Table 1 (170, 215, 280 cm^3/rev) and as of motors
# of one shape: K2's port area grows as the square of the length, and K2 w^2 D^3 is D (w D / area)^2
GROWTH: Mapping[str, float] = {"K1": 1.0, "K2": -4.0 / 3.0, "K4": 1.0, "K5": 1.0}
_DECLARED_FOR = 215.0 * CM3_PER_REV  # m^3/rad; the motor that typical values and bounds are declared for


def grown(parameter: str, max_displacement: float) -> float:
    """How many times as large as with 215 cm^3/rev a parameter of a motor of this m^3/rad is, as a rule."""
    return float((max_displacement / _DECLARED_FOR) ** GROWTH.get(parameter, 0.0))


def room(parameter: Parameter, max_displacement: float) -> tuple[float, float]:
    """Bounds of a parameter: the declared ones, for motors whose parameters are larger as much wider."""
    return parameter.lower, parameter.upper * max(grown(parameter.name, max_displacement), 1.0)


def initial_model(described: MotorModel, max_displacement: float, name: str = "") -> FrictionModel:
    """The model at typical values for a motor of this maximum displacement in m^3/rad: where a fit starts."""
    terms = tuple(term_named(term) for term in described.terms)
    parameters = unique_parameters(terms)
    bounds = {p.name: room(p, max_displacement) for p in parameters if grown(p.name, max_displacement) > 1.0}
    if described.signed:
        bounds = {name: (-upper, upper) for name, upper in ((p.name, room(p, max_displacement)[1]) for p in parameters)}
    return FrictionModel(
        name=name or described.name,
        terms=terms,
        values=tuple(each.typical for each in parameters),
        bounds=bounds,
        constants={"max_displacement": max_displacement},
    )
