"""Effects with memory (docs/discrepancy.md): their states follow the shaft's travel and the time at rest."""

import sympy as sp

from winch_friction.physics.friction.symbols import ALL_OF_LOAD, T_d, s, w
from winch_friction.physics.friction.term import Parameter, Scope, State, Term, register

REST_SPEED = 0.5  # rad/s; below it a contact ages

F_z = Parameter("F_z", "N*m", 25.0, upper=500.0, doc="friction carried by the bristles, without load")
c_z = Parameter("c_z", "1", 3.2e-5, upper=ALL_OF_LOAD, doc="friction carried by the bristles, per drum torque")
d_z = Parameter("d_z", "rad", 0.03, lower=1e-3, upper=10.0, shape=True, doc="shaft travel of one e-fold")
F_dw = Parameter("F_dw", "N*m", 5.0, upper=200.0, doc="growth of the break-away torque, without load")
c_dw = Parameter("c_dw", "1", 8.0e-6, upper=ALL_OF_LOAD, doc="growth of the break-away torque, per drum torque")
g_dw = Parameter("g_dw", "1/s", 0.3, lower=1e-3, upper=10.0, shape=True, doc="rate of growth at rest")
d_dw = Parameter("d_dw", "rad", 5.0, lower=0.1, upper=1e3, shape=True, doc="sliding that rejuvenates the contact")

_z = sp.Symbol("z_bristle", real=True)
_h = sp.Symbol("z_dwell", real=True)
_rest = sp.exp(-w / REST_SPEED)

# what the sign of the speed has too much: the bristles turn over within some travel after each reversal
presliding = register(
    Term(
        "presliding", (F_z.symbol + c_z.symbol * T_d) * (_z - s), (F_z, c_z, d_z), Scope.SYSTEM,
        "Dahl 1968: dz/dt = omega - |omega| z, z per e-fold of travel", "gear and drum", opposing=False,
        state=State(_z, gain=w * s / d_z.symbol, decay=w / d_z.symbol, doc="bristle deflection, -1 ... 1"),
    )
)  # fmt: skip
dwell_stiction = register(
    Term(
        "dwell_stiction", (F_dw.symbol + c_dw.symbol * T_d) * _h, (F_dw, c_dw, g_dw, d_dw),
        Scope.SYSTEM, "Kato 1972: F_s - (F_s - F_c) exp(-gamma t), after Stribeck's rise", "gear and drum",
        state=State(
            _h, gain=g_dw.symbol * _rest, decay=g_dw.symbol * _rest + w / d_dw.symbol, doc="age of the contact, 0 ... 1"
        ),
    )
)  # fmt: skip
