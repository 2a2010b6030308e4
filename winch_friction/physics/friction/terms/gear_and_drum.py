"""Friction of the rest of the winch: gears, drum, wire and sheaves, per motor shaft (paper 2 eq 8 and 10)."""

import sympy as sp

from winch_friction.physics.channels import RPM
from winch_friction.physics.friction.symbols import ALL_OF_LOAD, T_d, w
from winch_friction.physics.friction.term import Parameter, Scope, Term, register

C1 = Parameter("C1", "1", 155e-7, upper=ALL_OF_LOAD, doc="Stribeck rise per drum torque")
C2 = Parameter("C2", "N*m", 5.0, upper=200.0, doc="Coulomb friction")
C3 = Parameter("C3", "N*m", 0.562, upper=100.0, doc="Stribeck rise without load")
C4 = Parameter("C4", "rad/s", 229 * RPM, lower=10 * RPM, upper=2000 * RPM, shape=True, doc="Stribeck speed, one e-fold")
C5 = Parameter("C5", "N*m*s/rad", 0.00943, upper=1e4, doc="viscous friction")
C6 = Parameter("C6", "1", 162e-7, upper=ALL_OF_LOAD, doc="Coulomb friction per drum torque")

_PAPER = "paper 2 eq 8"

stribeck = register(
    Term(
        "stribeck",
        (C1.symbol * T_d + C3.symbol) * sp.exp(-w / C4.symbol),
        (C1, C3, C4),
        Scope.SYSTEM,
        f"{_PAPER} and 10 (C4 is an e-fold in speed, after Tustin)",
        "gear and drum",
    )
)
coulomb = register(Term("coulomb", C2.symbol, (C2,), Scope.SYSTEM, _PAPER, "gear and drum"))
viscous = register(Term("viscous", C5.symbol * w, (C5,), Scope.SYSTEM, f"{_PAPER}, with |omega|", "gear and drum"))
gear_load_loss = register(
    Term("gear_load_loss", C6.symbol * T_d, (C6,), Scope.SYSTEM, f"{_PAPER} and 10", "gear and drum")
)
