"""Other laws of the oil: how thick it is at a temperature, and what that does to the Stribeck curve."""

import sympy as sp

from winch_friction.physics.friction.registry import register
from winch_friction.physics.friction.symbols import T_d, oil_temperature, w
from winch_friction.physics.friction.term import Parameter, Scope, Term
from winch_friction.physics.friction.terms.effects_winch import walther

POLE = 95.0  # degC below zero of the Vogel-Fulcher-Tammann equation, usual for mineral oils
VOGEL_46 = 826.0  # degC, of an ISO VG 46 oil of viscosity index 95

_VISCOUS = "viscous friction that follows the viscosity"
_REFERENCE = "oil temperature at which the model's viscous terms hold"


def _amount(name: str) -> Parameter:
    return Parameter(name, "N*m*s/rad", 0.02, lower=-1.0, upper=1.0, doc=_VISCOUS)


def _reference(name: str) -> Parameter:
    return Parameter(name, "degC", 40.0, lower=1.0, upper=120.0, shape=True, doc=_REFERENCE)


K_vw, T_vw = _amount("K_vw"), _reference("T_vw")
K_vv, T_vv = _amount("K_vv"), _reference("T_vv")
B_vv = Parameter("B_vv", "K", 800.0, lower=100.0, upper=3000.0, shape=True, doc="steepness of Vogel's law")
K_ve, T_ve = _amount("K_ve"), _reference("T_ve")
b_ve = Parameter("b_ve", "1/K", 0.04, lower=0.005, upper=0.2, shape=True, doc="relative loss of viscosity per degree")
K_vh, T_vh = _amount("K_vh"), _reference("T_vh")
C1_h = Parameter("C1_h", "1", 1.5e-5, upper=1e-3, doc="Stribeck rise per drum torque whose speed follows the oil")
C4_h = Parameter("C4_h", "rad/s", 20.0, lower=1.0, upper=200.0, shape=True, doc="its speed at the reference")


def _vogel(steepness: sp.Expr | float, reference: sp.Symbol) -> sp.Expr:
    return sp.exp(steepness / (oil_temperature + POLE) - steepness / (reference + POLE))


def _declare(name: str, equation: sp.Expr, parameters: tuple[Parameter, ...], source: str) -> Term:
    return register(Term(name, equation, parameters, Scope.SYSTEM, source, "fluid"))


viscosity_reference = _declare(
    "viscosity_reference", K_vw.symbol * (walther(oil_temperature) / walther(T_vw.symbol) - 1) * w, (K_vw, T_vw),
    "Walther, ASTM D341, with a reference temperature of its own",
)  # fmt: skip
viscosity_vogel = _declare(
    "viscosity_vogel", K_vv.symbol * (_vogel(B_vv.symbol, T_vv.symbol) - 1) * w, (K_vv, B_vv, T_vv), "Vogel 1921"
)
viscosity_exponential = _declare(
    "viscosity_exponential", K_ve.symbol * (sp.exp(-b_ve.symbol * (oil_temperature - T_ve.symbol)) - 1) * w,
    (K_ve, b_ve, T_ve), "Reynolds 1886",
)  # fmt: skip
_thick = _vogel(VOGEL_46, T_vh.symbol)
viscosity_hersey = _declare(
    "viscosity_hersey",
    K_vh.symbol * (_thick - 1) * w
    + C1_h.symbol * T_d * (sp.exp(-w * _thick / C4_h.symbol) - sp.exp(-w / C4_h.symbol)), (K_vh, C1_h, T_vh, C4_h),
    "Vogel 1921; Hersey 1914: the curve is one of viscosity times speed over load, so its speed falls in thick oil",
)  # fmt: skip
