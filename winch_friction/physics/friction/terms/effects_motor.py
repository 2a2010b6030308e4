"""Effects that a motor model can lack (docs/discrepancy.md), per motor: candidates of the discrepancy workflow."""

import sympy as sp

from winch_friction.physics.channels import RPM
from winch_friction.physics.friction.symbols import D, X, n, p, p_sum, rho, w
from winch_friction.physics.friction.term import Parameter, Scope, Term, register

REFERENCE_SPEED = 2000.0 * RPM  # normalises powers of speed, so that a factor keeps one unit for every exponent
NOTCH_SPEED = (
    400.0 * RPM
)  # edge of the supplier's data: below it 1/|omega| is replaced by |omega|/(omega^2 + omega_0^2)

c_ld = Parameter("c_ld", "m^3/rad", 1.0e-6, upper=1e-4, doc="loss per pressure at zero displacement")
K_n = Parameter("K_n", "N*m", 14.0, lower=-100.0, upper=1e3, doc="port loss at 2000 rpm and full displacement")
n_t = Parameter("n_t", "1", 2.0, lower=1.0, upper=3.5, shape=True, doc="exponent of the port flow")
T_ch = Parameter("T_ch", "N*m", 2.5, upper=100.0, doc="churning loss at 2000 rpm")
n_ch = Parameter("n_ch", "1", 1.9, lower=1.2, upper=3.5, shape=True, doc="exponent of churning")
c_nk = Parameter("c_nk", "m^2", 1.0e-6, upper=1e-3, doc="port plate notch loss at full displacement")
c_case = Parameter("c_case", "m^3/rad", 5.0e-7, lower=-1e-4, upper=1e-4, doc="loss per sum of both port pressures")
R_line = Parameter("R_line", "Pa*s^2/m^6", 3.0e8, upper=1e11, doc="turbulent resistance between transducer and motor")
T_br = Parameter("T_br", "N*m", 3.0, upper=200.0, doc="drag of a brake that is not fully released")

_CATALOGUE = "docs/discrepancy.md"
_TINY = 1e-6  # rad/s; keeps the derivative by an exponent finite at standstill

low_displacement_loss = register(
    Term(
        "low_displacement_loss", c_ld.symbol * p * (1 - D / X), (c_ld,), Scope.MOTOR,
        "paper 2 section 5, motors at 145 against 215 cm^3/rev", "motor",
    )
)  # fmt: skip
port_turbulence = register(
    Term(
        "port_turbulence", K_n.symbol * ((w + _TINY) / REFERENCE_SPEED) ** n_t.symbol * (D / X) ** (n_t.symbol + 1),
        (K_n, n_t), Scope.MOTOR, "paper 1 eq 11 (MJ5's exponent), paper 2 second loop (K2)", "motor",
    )
)  # fmt: skip
churning = register(
    Term(
        "churning", T_ch.symbol * ((w + _TINY) / REFERENCE_SPEED) ** n_ch.symbol, (T_ch, n_ch), Scope.MOTOR,
        "paper 1, churning of the case oil", "motor",
    )
)  # fmt: skip
notch_loss = register(
    Term(
        "notch_loss", c_nk.symbol * D / X * w / (w**2 + NOTCH_SPEED**2) * p * sp.sqrt(p / rho), (c_nk,), Scope.MOTOR,
        "paper 1 eq 6 and 12 (C_k), regularised at standstill", "motor",
    )
)  # fmt: skip
case_pressure = register(
    Term("case_pressure", c_case.symbol * p_sum, (c_case,), Scope.MOTOR, f"{_CATALOGUE}, c (p_A + p_B)", "motor")
)
brake_drag = register(
    Term("brake_drag", T_br.symbol, (T_br,), Scope.SYSTEM, f"{_CATALOGUE}, constant drag per motor", "gear and drum")
)
# a pressure drop R (n D omega)^2 between transducer and motor, as the torque it takes from each motor
line_pressure_drop = register(
    Term(
        "line_pressure_drop", R_line.symbol * n ** 2 * D**3 * w**2, (R_line,), Scope.MOTOR,
        f"{_CATALOGUE}, Darcy-Weisbach with a constant friction factor", "fluid",
    )
)  # fmt: skip
