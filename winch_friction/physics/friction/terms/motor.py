"""Torque losses of a variable displacement axial piston motor, per motor (paper 1; paper 2 eq 1)."""

from winch_friction.physics.friction.symbols import D, p, w
from winch_friction.physics.friction.term import Parameter, Scope, Term, register

K1 = Parameter("K1", "N*m*s/rad", 4.05e-3, upper=0.1, doc="viscous losses of bearings, slippers and barrel")
K2 = Parameter("K2", "N*s^2/m^8", 3.69e10, upper=1e12, doc="turbulent losses of the inlet port plate")
K3 = Parameter("K3", "1", 5.0e-3, upper=0.2, doc="loss proportional to the motor's nominal torque")
K4 = Parameter("K4", "N*m", 14.0, upper=200.0, doc="Coulomb friction of motor and bearings")
K5 = Parameter("K5", "m^5/N", 1.16e-14, upper=1e-12, doc="mixed lubrication at high pressure")

motor_viscous = register(
    Term("motor_viscous", K1.symbol * w, (K1,), Scope.MOTOR, "paper 2 eq 1; paper 1 eq 10, C_g mu", "motor")
)
motor_turbulence = register(
    Term(
        "motor_turbulence", K2.symbol * w**2 * D**3, (K2,), Scope.MOTOR, "paper 2 eq 1; paper 1 eq 10, C_i rho", "motor"
    )
)
motor_load_loss = register(
    Term("motor_load_loss", K3.symbol * p * D, (K3,), Scope.MOTOR, "paper 2 eq 1; paper 1 eq 10, C_f", "motor")
)
motor_coulomb = register(
    Term("motor_coulomb", K4.symbol, (K4,), Scope.MOTOR, "paper 2 eq 1; paper 1 eq 10, C_e", "motor")
)
high_pressure_mixed = register(
    Term("high_pressure_mixed", K5.symbol * p**2, (K5,), Scope.MOTOR, "paper 2 eq 1; paper 1 eq 10, C_m", "motor")
)
