"""The torque-loss terms of the models that paper 1 compares (section 3), per motor, with the errata applied.

Terms that are equal share one declaration with MJ4 (`motor.py`): C_e is K4, C_g mu is K1, C_i rho is K2, C_m is K5.
Parameters named C.. are the paper's; `identification.motor_models` composes the models.
"""

import math

import sympy as sp

from winch_friction.physics.channels import BAR, RPM
from winch_friction.physics.friction.symbols import D, X, mu, p, rho, w
from winch_friction.physics.friction.term import Parameter, Scope, Term, register

MAX_SWIVEL_ANGLE = math.radians(25.0)  # bent-axis motors of the A6VM kind swivel to about 25 degrees
NOTCH_SPEED = 400.0 * RPM  # edge of the data; 1/|omega| is written |omega|/(omega^2 + omega_0^2)
PORT_FLOW_SPEED = 2000.0 * RPM  # normalises MJ5's base, so that its factor has one unit for every exponent
HUHTALA_KNEE = 200.0 * BAR  # middle of the supplier's pressure range
_TINY = 1e-9  # keeps log(base) finite at standstill

_ratio = D / X
_notch = w / (w**2 + NOTCH_SPEED**2) * p * sp.sqrt(p / rho)
_swivel = sp.asin(_ratio * math.sin(MAX_SWIVEL_ANGLE))  # displacement of a bent-axis motor goes with the sine
_pacey = (1 - math.tan(MAX_SWIVEL_ANGLE)) / (1 - sp.tan(_swivel))


def _declare(name: str, parameter: Parameter, factor: sp.Expr, source: str, *shape: Parameter, doc: str = "") -> Term:
    equation = parameter.symbol * factor
    return register(Term(name, equation, (parameter, *shape), Scope.MOTOR, source, "motor", doc=doc))


Ca = Parameter("Ca", "1", 0.03, upper=1.0, doc="dry friction per nominal torque at full displacement")
Cb = Parameter("Cb", "1", 5e4, upper=1e7, doc="viscous friction coefficient")
Cc = Parameter("Cc", "Pa", 4e5, upper=1e8, doc="constant loss as a pressure")
Cd = Parameter("Cd", "1", 10.0, upper=1e4, doc="liquid acceleration losses")
Cd_a = Parameter("Cd_a", "1", 40.0, upper=1e4, doc="liquid acceleration losses at full displacement")
Ca_P = Parameter("Ca_P", "1", 0.03, upper=1.0, doc="dry friction per nominal torque at full swivel")
Cb_P = Parameter("Cb_P", "1", 5e4, upper=1e7, doc="viscous friction coefficient at full swivel")
Cf = Parameter("Cf", "m^3/rad", 5e-7, upper=1e-4, doc="pressure-dependent friction of bearings and pistons")
Ci = Parameter("Ci", "m^5", 4e-7, upper=1e-4, doc="port inlet loss and churning")
Ck = Parameter("Ck", "m^2", 1e-6, upper=1e-3, doc="port plate notch loss")
Ck_D = Parameter("Ck_D", "m^2", 1e-6, upper=1e-3, doc="port plate notch loss at full displacement")
Cn_scale = Parameter("Cn_scale", "N*m", 60.0, upper=1e3, doc="port flow loss at 2000 rpm and full displacement")
Cn = Parameter(
    "Cn", "1", 2.0, lower=0.5, upper=3.5, shape=True, doc="exponent of the port flow: 1 laminar, 2 turbulent"
)
Ch = Parameter("Ch", "m^3*s", 2e-9, lower=-1e-5, upper=1e-5, doc="speed and pressure together")
Cj = Parameter("Cj", "N*m", 5.0, lower=-1e3, upper=1e3, doc="displacement setting alone")
Cl = Parameter("Cl", "N*m*s/rad", 0.01, lower=-10.0, upper=10.0, doc="displacement setting and speed together")

wilson_load = _declare("wilson_load", Ca, X * p, "paper 1 eq 1, 2, 3")
wilson_viscous = _declare("wilson_viscous", Cb, mu * X * w, "paper 1 eq 1, 2, 3")
wilson_constant = _declare("wilson_constant", Cc, X, "paper 1 eq 1")
schlosser_inertia = _declare("schlosser_inertia", Cd, X ** sp.Rational(5, 3) * rho * w**2, "paper 1 eq 2")
thoma_inertia = _declare("thoma_inertia", Cd_a, _ratio**3 * X ** sp.Rational(5, 3) * rho * w**2, "paper 1 eq 3")
pacey_load = _declare("pacey_load", Ca_P, X * p * _pacey, "paper 1 eq 4, with alpha the swivel angle")
pacey_viscous = _declare("pacey_viscous", Cb_P, mu * D * w * _pacey, "paper 1 eq 4, with alpha the swivel angle")
motor_pressure_loss = _declare("motor_pressure_loss", Cf, p, "paper 1 eq 5, 6, 7, 8, 9")
motor_speed_squared = _declare("motor_speed_squared", Ci, rho * w**2, "paper 1 eq 5, 6")
jeong_notch = _declare("jeong_notch", Ck, _notch, "paper 1 eq 6, 7, regularised at standstill")
mj6_notch = _declare("mj6_notch", Ck_D, _ratio * _notch, "paper 1 eq 12, regularised at standstill")
mj5_port_flow = _declare(
    "mj5_port_flow",
    Cn_scale,
    (_TINY + w * _ratio / PORT_FLOW_SPEED) ** Cn.symbol * _ratio,
    "paper 1 eq 11 (eq 14's D^(Cn+2) is an erratum), base normalised",
    Cn,
)
ortwig_speed_pressure = _declare("ortwig_speed_pressure", Ch, w * p, "paper 1 eq 5")
ortwig_displacement = _declare("ortwig_displacement", Cj, _ratio, "paper 1 eq 5")
ortwig_displacement_speed = _declare("ortwig_displacement_speed", Cl, _ratio * w, "paper 1 eq 5")


def _huhtala(name: str, symbol: str, order: int, above: bool, factor: sp.Expr, typical: float, unit: str) -> Term:
    """One of the four polynomials in speed (each coefficient linear in displacement), on one side of the knee."""
    powers = [(k, j) for j in (0, 1) for k in range(order + 1)]
    limit = 1e3 * typical
    parameters = tuple(
        Parameter(
            f"{symbol}_{k}{'a' if j else ''}",
            unit,
            typical if k == 0 else 0.1 * typical,
            lower=-limit,
            upper=limit,
            doc=f"coefficient of (w / 2000 rpm)^{k}" + (" D/X" if j else ""),
        )
        for k, j in powers
    )
    speed = w / PORT_FLOW_SPEED
    polynomial = sum(q.symbol * speed**k * _ratio**j for q, (k, j) in zip(parameters, powers, strict=True))
    inside = p >= HUHTALA_KNEE if above else p < HUHTALA_KNEE
    equation = sp.Piecewise((polynomial * factor, inside), (0.0, True))
    return register(
        Term(
            name,
            equation,
            parameters,
            Scope.MOTOR,
            "paper 1 section 3.5; a reconstruction, the original is not public",
            "motor",
            doc="two lines in pressure whose slope and intercept are polynomials in speed",
        )
    )


huhtala_intercept_low = _huhtala("huhtala_intercept_low", "A1", 3, False, sp.Integer(1), 10.0, "N*m")
huhtala_slope_low = _huhtala("huhtala_slope_low", "B1", 2, False, p / HUHTALA_KNEE, 5.0, "N*m")
huhtala_intercept_high = _huhtala("huhtala_intercept_high", "A2", 3, True, sp.Integer(1), 10.0, "N*m")
huhtala_slope_high = _huhtala("huhtala_slope_high", "B2", 2, True, p / HUHTALA_KNEE, 5.0, "N*m")
