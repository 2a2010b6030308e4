"""Other laws of oil, motors and lines: how thick the oil is at a temperature, and what that does to the Stribeck curve;
exponents that the literature leaves open, one port, one direction.
"""

import sympy as sp

from winch_friction.physics.channels import BAR, RPM
from winch_friction.physics.friction.symbols import (
    ALL_OF_LOAD,
    D,
    T_d,
    X,
    higher_port,
    n,
    oil_temperature,
    p,
    p_sum,
    role,
    s,
    w,
)
from winch_friction.physics.friction.term import Parameter, Scope, Term, register
from winch_friction.physics.friction.terms.effects_winch import NU_40, viscosity

# -- the oil
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
C1_h = Parameter(
    "C1_h", "1", 1.5e-5, upper=ALL_OF_LOAD, doc="Stribeck rise per drum torque whose speed follows the oil"
)
K_vu, K_vd, T_vu = _amount("K_vu"), _amount("K_vd"), _reference("T_vu")
C4_h = Parameter("C4_h", "rad/s", 20.0, lower=0.1, upper=200.0, shape=True, doc="its speed at the reference")


def _vogel(steepness: sp.Expr | float, reference: sp.Symbol) -> sp.Expr:
    return sp.exp(steepness / (oil_temperature + POLE) - steepness / (reference + POLE))


def _declare(name: str, equation: sp.Expr, parameters: tuple[Parameter, ...], source: str) -> Term:
    return register(Term(name, equation, parameters, Scope.SYSTEM, source, "fluid"))


viscosity_reference = _declare(
    "viscosity_reference", K_vw.symbol * (viscosity(oil_temperature) / viscosity(T_vw.symbol) - 1) * w, (K_vw, T_vw),
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

viscosity_each_way = _declare(
    "viscosity_each_way",
    (K_vu.symbol * (1 + s) / 2 + K_vd.symbol * (1 - s) / 2) * (_vogel(VOGEL_46, T_vu.symbol) - 1) * w,
    (K_vu, K_vd, T_vu), "Vogel 1921, of motors that pump one way and drive the other",
)  # fmt: skip


# -- motors and lines
FULL_SPEED, FULL_PRESSURE = 2000.0 * RPM, 200.0 * BAR  # normalise powers: a factor keeps one unit for every exponent
FULL_FLOW = 0.02  # m^3/s, of one group of motors at speed
_TINY, _NONE = 1e-6, 1e-12  # a power of nothing has no slope

c_lp = Parameter("c_lp", "N*m", 10.0, upper=1e3, doc="loss at 200 bar and zero displacement")
a_lp = Parameter("a_lp", "1", 1.0, lower=0.0, upper=3.0, shape=True, doc="exponent of the pressure")
b_lp = Parameter("b_lp", "1", 1.0, lower=1.0, upper=5.0, shape=True, doc="exponent of 1 - D/X")
c_lu = Parameter("c_lu", "N*m", 10.0, upper=1e3, doc="loss at 200 bar and zero displacement, hoisting")
c_lo = Parameter("c_lo", "N*m", 10.0, upper=1e3, doc="loss at 200 bar and zero displacement, lowering")
a_lu = Parameter("a_lu", "1", 1.0, lower=0.0, upper=3.0, shape=True, doc="exponent of the pressure")
b_lu = Parameter("b_lu", "1", 1.0, lower=1.0, upper=5.0, shape=True, doc="exponent of 1 - D/X")
K_pp = Parameter("K_pp", "N*m", 10.0, upper=1e3, doc="port loss at 2000 rpm and full displacement")
n_pp = Parameter("n_pp", "1", 2.0, lower=1.0, upper=4.0, shape=True, doc="exponent of the speed")
m_pp = Parameter("m_pp", "1", 2.0, lower=1.0, upper=5.0, shape=True, doc="exponent of the displacement")
K_po = Parameter("K_po", "N*m", 10.0, upper=1e3, doc="port loss at 2000 rpm and full displacement, mean of both ways")
n_po = Parameter("n_po", "1", 2.0, lower=1.0, upper=4.0, shape=True, doc="exponent of the speed")
m_po = Parameter("m_po", "1", 3.0, lower=1.0, upper=5.0, shape=True, doc="exponent of the displacement")
b_po = Parameter("b_po", "1", 0.5, lower=-1.0, upper=1.0, shape=True, doc="1: hoisting alone, -1: lowering alone")
T_cv = Parameter("T_cv", "N*m", 2.0, upper=100.0, doc="churning loss at 2000 rpm and 40 degC")
n_cv = Parameter("n_cv", "1", 1.75, lower=1.0, upper=3.5, shape=True, doc="exponent of the speed")
T_cw = Parameter("T_cw", "N*m", 2.0, upper=100.0, doc="churning loss at 2000 rpm, mean of both ways")
n_cw = Parameter("n_cw", "1", 2.0, lower=1.0, upper=3.5, shape=True, doc="exponent of the speed")
b_cw = Parameter("b_cw", "1", 0.5, lower=-1.0, upper=1.0, shape=True, doc="1: hoisting alone, -1: lowering alone")
K_hp = Parameter("K_hp", "N*m", 4.0, upper=200.0, doc="loss at 200 bar")
n_hp = Parameter("n_hp", "1", 3.0, lower=1.2, upper=6.0, shape=True, doc="exponent of the pressure")
K_hu = Parameter("K_hu", "N*m", 4.0, upper=200.0, doc="loss at 200 bar hoisting")
K_hd = Parameter("K_hd", "N*m", 4.0, upper=200.0, doc="the same lowering")
n_hu = Parameter("n_hu", "1", 3.0, lower=1.2, upper=6.0, shape=True, doc="exponent of the pressure")
K_hf = Parameter("K_hf", "N*m", 10.0, upper=500.0, doc="mixed loss at 200 bar and standstill")
n_hf = Parameter("n_hf", "1", 2.0, lower=1.2, upper=6.0, shape=True, doc="exponent of the pressure")
w_hf = Parameter("w_hf", "rad/s", 60.0, lower=0.1, upper=500.0, shape=True, doc="speed over which a film builds up")
K_ho = Parameter("K_ho", "N*m", 10.0, upper=500.0, doc="mixed loss 200 bar above the onset and at standstill")
p_ho = Parameter("p_ho", "Pa", 100 * BAR, lower=20 * BAR, upper=500 * BAR, shape=True, doc="pressure of the onset")
w_ho = Parameter("w_ho", "rad/s", 60.0, lower=0.1, upper=5000.0, shape=True, doc="speed over which a film builds up")
c_np = Parameter("c_np", "N*m", 5.0, upper=500.0, doc="notch loss at 200 bar, full displacement and its own speed")
w_np = Parameter("w_np", "rad/s", 40.0, lower=0.1, upper=300.0, shape=True, doc="speed of its maximum")
a_np = Parameter("a_np", "1", 1.0, lower=0.5, upper=2.5, shape=True, doc="exponent of the pressure")
c_na = Parameter("c_na", "N*m", 5.0, upper=500.0, doc="notch loss at 200 bar and its own speed")
w_na = Parameter("w_na", "rad/s", 40.0, lower=0.1, upper=300.0, shape=True, doc="speed of its maximum")
a_na = Parameter("a_na", "1", 1.0, lower=0.5, upper=2.5, shape=True, doc="exponent of the pressure")
p_l = Parameter(  # of a small winch, whose flow never comes near, it is the law carried on to there
    "p_l", "Pa", 2e5, upper=1e9, doc="pressure lost between transducer and motor at 0.02 m^3/s"
)
p_lv = Parameter("p_lv", "Pa", 2e5, upper=1e9, doc="pressure lost at 0.02 m^3/s of oil at 40 degC")
p_lt = Parameter("p_lt", "Pa", 2e5, upper=1e9, doc="pressure lost at 0.02 m^3/s of oil at 40 degC")
n_lt = Parameter("n_lt", "1", 1.75, lower=0.1, upper=3.0, shape=True, doc="exponent of the flow")
n_l = Parameter("n_l", "1", 1.75, lower=0.1, upper=3.0, shape=True, doc="exponent of the flow")
b_l = Parameter(
    "b_l", "1", 0.5, lower=-1.0, upper=1.0, shape=True, doc="1: when hoisting alone, -1: when lowering alone"
)
p_le = Parameter("p_le", "Pa", 2e5, upper=1e9, doc="pressure lost in each motor's own line at 2000 rpm, full stroke")
n_le = Parameter("n_le", "1", 1.75, lower=0.1, upper=3.0, shape=True, doc="exponent of the flow of each motor")
b_le = Parameter(
    "b_le", "1", 0.5, lower=-1.0, upper=1.0, shape=True, doc="1: when hoisting alone, -1: when lowering alone"
)
c_hi = Parameter("c_hi", "m^3/rad", 5e-7, lower=-1e-4, upper=1e-4, doc="loss per pressure at the high port")
K_pA = Parameter("K_pA", "m^3/rad", 5e-7, upper=1e-4, doc="loss per pressure at port A")
K_pB = Parameter("K_pB", "m^3/rad", 5e-7, upper=1e-4, doc="loss per pressure at port B")


def _motor(name: str, equation: sp.Expr, parameters: tuple[Parameter, ...], source: str, place: str = "motor") -> Term:
    return register(Term(name, equation, parameters, Scope.MOTOR, source, place))


_p, _w, _x = p / FULL_PRESSURE + _TINY, w / FULL_SPEED + _TINY, D / X
low_displacement_power = _motor(
    "low_displacement_power", c_lp.symbol * _p**a_lp.symbol * (sp.Abs(1 - _x) + _TINY) ** b_lp.symbol,
    (c_lp, a_lp, b_lp), "paper 2 section 5, with the exponents left open",
)  # fmt: skip
low_displacement_each_way = _motor(
    "low_displacement_each_way",
    (c_lu.symbol * (1 + s) / 2 + c_lo.symbol * (1 - s) / 2)
    * _p**a_lu.symbol * (sp.Abs(1 - _x) + _TINY) ** b_lu.symbol,
    (c_lu, c_lo, a_lu, b_lu), "paper 2 section 5, of motors that pump one way and drive the other",
)  # fmt: skip
port_power = _motor(
    "port_power", K_pp.symbol * _w**n_pp.symbol * _x**m_pp.symbol, (K_pp, n_pp, m_pp),
    "paper 1 eq 11, with the exponents of speed and displacement apart",
)  # fmt: skip
port_one_way = _motor(
    "port_one_way", K_po.symbol * _w**n_po.symbol * _x**m_po.symbol * (1 + b_po.symbol * s), (K_po, n_po, m_po, b_po),
    "paper 1 eq 11, of a port or a valve that oil passes one way",
)  # fmt: skip
# the number stands outside the root: which of the two a number inside goes to differs between versions of SymPy
_SMALL = sp.Rational(1, 4)
_AT_40 = float(NU_40**-_SMALL)
churning_viscous = _motor(
    "churning_viscous",
    _AT_40 * T_cv.symbol * _w**n_cv.symbol * viscosity(oil_temperature) ** _SMALL,
    (T_cv, n_cv), "Changenet and Velex 2007: churning grows with a small power of the viscosity",
)  # fmt: skip
churning_one_way = _motor(
    "churning_one_way", T_cw.symbol * _w**n_cw.symbol * (1 + b_cw.symbol * s), (T_cw, n_cw, b_cw),
    "Changenet and Velex 2007: what a pair of gears churns depends on the sense of rotation",
)  # fmt: skip
high_pressure_power = _motor(
    "high_pressure_power",
    K_hp.symbol * _p**n_hp.symbol,
    (K_hp, n_hp),
    "paper 1 eq 10, C_m, with the exponent left open",
)
high_pressure_each_way = _motor(
    "high_pressure_each_way", (K_hu.symbol * (1 + s) / 2 + K_hd.symbol * (1 - s) / 2) * _p**n_hu.symbol,
    (K_hu, K_hd, n_hu), "paper 1 eq 10, C_m, of motors that pump one way and drive the other (ISO 4409)",
)  # fmt: skip
high_pressure_film = _motor(
    "high_pressure_film", K_hf.symbol * _p**n_hf.symbol * sp.exp(-w / w_hf.symbol), (K_hf, n_hf, w_hf),
    "paper 1 eq 10, C_m, which fades as a film builds up with the speed (Stribeck 1902)",
)  # fmt: skip
high_pressure_onset = _motor(
    "high_pressure_onset",
    K_ho.symbol * sp.Piecewise((0.0, p <= p_ho.symbol), (p - p_ho.symbol, True)) / FULL_PRESSURE
    * sp.exp(-w / w_ho.symbol), (K_ho, p_ho, w_ho),
    "paper 1 eq 10, C_m, of a film that carries up to a pressure, and builds up with the speed (Stribeck 1902)",
)  # fmt: skip
notch_power = _motor(
    "notch_power",
    c_np.symbol * 2 * w * w_np.symbol / (w**2 + w_np.symbol**2) * _p**a_np.symbol * _x, (c_np, w_np, a_np),
    "paper 1 eq 12 (C_k), with speed and exponent left open",
)  # fmt: skip
notch_any_stroke = _motor(
    "notch_any_stroke", c_na.symbol * 2 * w * w_na.symbol / (w**2 + w_na.symbol**2) * _p**a_na.symbol,
    (c_na, w_na, a_na), "paper 1 eq 12 (C_k), of an area that the stroke does not change",
)  # fmt: skip
line_pressure_power = _motor(
    "line_pressure_power", p_l.symbol * D * (n * D * w / FULL_FLOW + _TINY) ** n_l.symbol * (1 + b_l.symbol * s),
    (p_l, n_l, b_l), "Blasius 1913 for 1.75, Hagen-Poiseuille for 1; a check valve opens one way", "fluid",
)  # fmt: skip
line_laminar = _motor(
    "line_laminar", p_lv.symbol * D * (n * D * w / FULL_FLOW) * viscosity(oil_temperature) / NU_40, (p_lv,),
    "Hagen-Poiseuille, of an oil that is as thick as it is cold (Walther, ASTM D341)", "fluid",
)  # fmt: skip
line_turbulent = _motor(
    "line_turbulent",
    _AT_40 * p_lt.symbol * D * (n * D * w / FULL_FLOW + _TINY) ** n_lt.symbol * viscosity(oil_temperature) ** _SMALL,
    (p_lt, n_lt), "Blasius 1913: in a smooth pipe the loss grows with the fourth root of the viscosity", "fluid",
)  # fmt: skip
line_each_motor = _motor(
    "line_each_motor", p_le.symbol * D * (_x * _w + _TINY) ** n_le.symbol * (1 + b_le.symbol * s), (p_le, n_le, b_le),
    "Blasius 1913, Hagen-Poiseuille, of motors that each have a line or a valve of their own", "fluid",
)  # fmt: skip


# the lines of one side alone: a power unit's hoses, or the pipes of an accumulator; polynomials of the role
def _line_of(side: str, own: sp.Expr, motors: str) -> Term:
    up, down = (
        Parameter(
            f"p_l{side[0]}{way[0]}", "Pa", 2e5, upper=1e9, doc=f"lost in the line of {motors} at 0.02 m^3/s, {way}"
        )
        for way in ("hoisting", "lowering")
    )
    flow = Parameter(f"n_l{side[0]}", "1", 1.75, lower=0.1, upper=3.0, shape=True, doc="exponent of the flow")
    lost = up.symbol * (1 + s) / 2 + down.symbol * (1 - s) / 2
    return _motor(
        f"line_{side}", lost * own * D * (n * D * w / FULL_FLOW + _NONE) ** flow.symbol, (up, down, flow),
        "Blasius 1913 for 1.75, Hagen-Poiseuille for 1, of one side's motors alone", "fluid",
    )  # fmt: skip


_passive = role * (role - 1) / 2
line_driving = _line_of("driving", 1 - _passive, "the driving motors")
line_active = _line_of("active", role * (role + 1) / 2, "the motors that drive beside passive ones")
line_passive = _line_of("passive", _passive, "the passive motors")

case_high_port = _motor("case_high_port", c_hi.symbol * (p_sum + p) / 2, (c_hi,), "loss with one port's pressure alone")
# one port is always the same one, which the high port is not where either may be; together they are the sum of both
_drop = higher_port * p
case_ports = _motor(
    "case_ports", K_pA.symbol * (p_sum + _drop) / 2 + K_pB.symbol * (p_sum - _drop) / 2, (K_pA, K_pB),
    "loss with the pressure at port A and at port B, each by its own share of the case's",
)  # fmt: skip
