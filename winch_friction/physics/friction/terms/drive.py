"""Torques on the common shaft that do not simply oppose the motion."""

from winch_friction.physics.friction.symbols import w
from winch_friction.physics.friction.term import Parameter, Scope, Term, register

T_0 = Parameter("T_0", "N*m", 1.0, lower=-1e4, upper=1e4, doc="constant torque against the hoisting direction")
A_v = Parameter(
    "A_v", "N*m*s/rad", 0.01, lower=-1e4, upper=1e4, doc="half the difference of viscous friction by direction"
)

torque_offset = register(
    Term("torque_offset", T_0.symbol, (T_0,), Scope.SHAFT, "EMPS benchmark, offset", "sensor", opposing=False)
)
direction_asymmetry = register(
    Term(
        "direction_asymmetry",
        A_v.symbol * w,
        (A_v,),
        Scope.SHAFT,
        "EMPS benchmark, asymmetric viscous friction (Fv+ - Fv-)/2",
        "gear and drum",
        opposing=False,
    )
)
