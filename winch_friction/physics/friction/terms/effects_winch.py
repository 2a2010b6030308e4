"""Effects that the model of gears, drum, wire and oil can lack (docs/discrepancy.md)."""

import sympy as sp

from winch_friction.physics.fluid import REFERENCE, walther
from winch_friction.physics.friction.symbols import T_d, gear_ratio, oil_temperature, s, shaft_angle, time, w
from winch_friction.physics.friction.term import Parameter, Scope, Term, register

e_g = Parameter("e_g", "1", 0.006, lower=-0.1, upper=0.1, doc="difference of gear loss by direction, share of T_d/i")
b_g = Parameter(
    "b_g", "1", 0.5, lower=-1.0, upper=1.0, shape=True, doc="0: half in each direction, 1: hoisting, -1: lowering"
)
c_sh = Parameter(
    "c_sh", "1", 0.03, lower=-0.1, upper=0.5, doc="loss of rope bending and sheave bearings, share of T_d/i"
)
K_v = Parameter("K_v", "N*m*s/rad", 0.0135, lower=-1.0, upper=1.0, doc="viscous friction that follows the viscosity")
C_w = Parameter("C_w", "N*m", 3.0, lower=-100.0, upper=100.0, doc="change of the Coulomb level by run-in and wear")
t_w = Parameter("t_w", "s", 1e5, lower=-1e12, upper=1e12, shape=True, doc="middle of the observed time")
tau_w = Parameter("tau_w", "s", 1e6, lower=1.0, upper=1e12, shape=True, doc="half length of the observed time")
a_r = Parameter("a_r", "1", 0.01, lower=-0.2, upper=0.2, doc="sine amplitude of the torque ripple, share of T_d/i")
b_r = Parameter("b_r", "1", 0.01, lower=-0.2, upper=0.2, doc="cosine amplitude of the torque ripple, share of T_d/i")
k_r = Parameter("k_r", "1", 1.0, lower=1e-3, upper=100.0, shape=True, doc="periods per revolution of the motor shaft")


def viscosity(celsius: sp.Expr | float) -> sp.Expr:
    """Kinematic viscosity in cSt at a temperature in degC."""
    return walther(celsius, lambda kelvin: sp.log(kelvin) / sp.log(10))


NU_40 = float(viscosity(REFERENCE))
_CATALOGUE = "docs/discrepancy.md"

viscosity_temperature = register(
    Term(
        "viscosity_temperature", K_v.symbol * (viscosity(oil_temperature) / NU_40 - 1) * w, (K_v,), Scope.SYSTEM,
        "Walther, ASTM D341", "fluid",
    )
)  # fmt: skip
gear_asymmetry = register(
    Term(
        "gear_asymmetry", e_g.symbol * T_d / gear_ratio * (s**2 + b_g.symbol * s) / 2, (e_g, b_g), Scope.SHAFT,
        f"{_CATALOGUE}, gear efficiency differs hoisting and lowering", "gear and drum", opposing=False,
    )
)  # fmt: skip
sheave_bending = register(
    Term(
        "sheave_bending", c_sh.symbol * T_d / gear_ratio, (c_sh,), Scope.SHAFT,
        f"{_CATALOGUE}, rope bending and sheave bearing loss", "gear and drum",
    )
)  # fmt: skip
wear_drift = register(
    Term(
        "wear_drift", C_w.symbol * (time - t_w.symbol) / tau_w.symbol, (C_w, t_w, tau_w), Scope.SYSTEM,
        f"{_CATALOGUE}, seal run-in and wear", "gear and drum",
    )
)  # fmt: skip
torque_ripple = register(
    Term(
        "torque_ripple",
        (a_r.symbol * sp.sin(k_r.symbol * shaft_angle) + b_r.symbol * sp.cos(k_r.symbol * shaft_angle))
        * T_d
        / gear_ratio, (a_r, b_r, k_r), Scope.SHAFT, f"{_CATALOGUE}, periodic in shaft angle", "motor", opposing=False,
    )
)  # fmt: skip
