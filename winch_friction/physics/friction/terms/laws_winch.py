"""Other laws of gears, drum, seals and contacts: the shape of a rise, of a drift, of what a rest leaves behind."""

import sympy as sp

from winch_friction.physics.friction.symbols import ALL_OF_LOAD, T_d, gear_ratio, s, shaft_angle, time, w, wire_layer
from winch_friction.physics.friction.term import Parameter, Scope, State, Term, register

REST_SPEED = 0.5  # rad/s; below it a contact ages
SLIDING_TO_FORGET = 300.0  # rad of shaft, some turns of a gear wheel, after which the rest is forgotten
LOAD_SCALE = 5e5  # N m of drum torque, some tens of tonnes: normalises powers of the load

C1_g = Parameter("C1_g", "1", 1e-5, upper=ALL_OF_LOAD, doc="Stribeck rise per drum torque")
C3_g = Parameter("C3_g", "N*m", 1.0, upper=100.0, doc="Stribeck rise without load")
v_g = Parameter("v_g", "rad/s", 20.0, lower=0.1, upper=300.0, shape=True, doc="Stribeck speed")
C1_l = Parameter("C1_l", "1", 1e-5, upper=ALL_OF_LOAD, doc="Stribeck rise per drum torque")
C3_l = Parameter("C3_l", "N*m", 1.0, upper=100.0, doc="Stribeck rise without load")
v_l = Parameter("v_l", "rad/s", 20.0, lower=0.1, upper=300.0, shape=True, doc="Stribeck speed")
F_dv = Parameter("F_dv", "N*m", 5.0, upper=200.0, doc="growth of the break-away torque, without load")
c_dv = Parameter("c_dv", "1", 8e-6, upper=ALL_OF_LOAD, doc="growth of the break-away torque, per drum torque")
g_dv = Parameter("g_dv", "1/s", 0.3, lower=1e-3, upper=10.0, shape=True, doc="rate of growth at rest")
v_dv = Parameter("v_dv", "rad/s", 10.0, lower=0.1, upper=200.0, shape=True, doc="speed of one e-fold of its decay")
C_ws = Parameter("C_ws", "N*m", 3.0, lower=-100.0, upper=100.0, doc="change of the Coulomb level in the end")
t_ws = Parameter("t_ws", "s", 1e5, lower=-1e12, upper=1e12, shape=True, doc="time of the first run")
tau_ws = Parameter("tau_ws", "s", 1e6, lower=1.0, upper=1e12, shape=True, doc="time of one e-fold")
C_wl = Parameter("C_wl", "N*m", 1.0, lower=-100.0, upper=100.0, doc="change of the Coulomb level per e-fold of time")
t_wl = Parameter("t_wl", "s", 1e5, lower=-1e12, upper=1e12, shape=True, doc="time of the first run")
tau_wl = Parameter("tau_wl", "s", 1e5, lower=1.0, upper=1e12, shape=True, doc="time from which on it is logarithmic")
C_wb = Parameter("C_wb", "N*m", 3.0, upper=100.0, doc="what a run-in takes off the Coulomb level in the end")
C_wu = Parameter("C_wu", "N*m", 1.0, upper=100.0, doc="what wear adds to the Coulomb level per e-fold of the run-in")
t_wb = Parameter("t_wb", "s", 1e5, lower=-1e12, upper=1e12, shape=True, doc="time of the first run")
tau_wb = Parameter("tau_wb", "s", 1e6, lower=1.0, upper=1e12, shape=True, doc="time of one e-fold of the run-in")
C_wd = Parameter("C_wd", "N*m", 3.0, lower=-100.0, upper=100.0, doc="change of the Coulomb level")
t_wd = Parameter("t_wd", "s", 1e5, lower=-1e12, upper=1e12, shape=True, doc="time at which it changed")
c_wt = Parameter("c_wt", "1", 0.01, lower=-0.5, upper=0.5, doc="change of the loss by wear, share of T_d/i")
t_wt = Parameter("t_wt", "s", 1e5, lower=-1e12, upper=1e12, shape=True, doc="middle of the observed time")
tau_wt = Parameter("tau_wt", "s", 1e6, lower=1.0, upper=1e12, shape=True, doc="half length of the observed time")
c_wr = Parameter("c_wr", "1", 0.01, lower=-0.5, upper=0.5, doc="what a new winch loses more, share of T_d/i")
t_wr = Parameter("t_wr", "s", 1e5, lower=-1e12, upper=1e12, shape=True, doc="time of the first run")
tau_wr = Parameter("tau_wr", "s", 1e6, lower=1.0, upper=1e12, shape=True, doc="time of one e-fold")
c_we = Parameter("c_we", "1", 0.01, lower=-0.5, upper=0.5, doc="change of the loss all at once, share of T_d/i")
t_we = Parameter("t_we", "s", 1e5, lower=-1e12, upper=1e12, shape=True, doc="time at which it changed")
c_gp = Parameter("c_gp", "N*m", 5.0, upper=200.0, doc="loss per motor at a drum torque of 500 kN m")
n_gp = Parameter("n_gp", "1", 1.5, lower=0.2, upper=4.0, shape=True, doc="exponent of the drum torque")
c_gf = Parameter("c_gf", "N*m", 5.0, upper=200.0, doc="loss per motor at standstill and a drum torque of 500 kN m")
w_gf = Parameter("w_gf", "rad/s", 100.0, lower=1.0, upper=1e3, shape=True, doc="speed over which its film builds up")
c_sp = Parameter("c_sp", "1", 0.02, upper=0.5, doc="loss at a drum torque of 500 kN m, share of T_d/i")
n_sp = Parameter("n_sp", "1", 0.7, lower=0.2, upper=4.0, shape=True, doc="exponent of the drum torque")
c_sf = Parameter("c_sf", "1", 0.01, lower=0.0, upper=0.5, doc="loss at standstill, share of T_d/i")
w_sf = Parameter("w_sf", "rad/s", 100.0, lower=1.0, upper=1000.0, shape=True, doc="motor speed at which a film carries")
c_gs = Parameter("c_gs", "N*m", 5.0, upper=200.0, doc="loss per motor at a large load")
T_gs = Parameter("T_gs", "N*m", 1e5, lower=1e2, upper=1e7, shape=True, doc="drum torque of one e-fold")
c_ss = Parameter("c_ss", "N*m", 20.0, upper=1e3, doc="loss at a large load")
T_ss = Parameter("T_ss", "N*m", 1e5, lower=1e2, upper=1e7, shape=True, doc="drum torque of one e-fold")
c_go = Parameter("c_go", "N*m", 5.0, upper=200.0, doc="loss per motor at 500 kN m beyond the onset")
T_go = Parameter("T_go", "N*m", 1.5e5, lower=1e2, upper=1e8, shape=True, doc="drum torque of the onset")
c_so = Parameter("c_so", "1", 0.02, upper=0.5, doc="loss at 500 kN m beyond the onset, share of T_d/i")
T_so = Parameter("T_so", "N*m", 1.5e5, lower=1e2, upper=1e8, shape=True, doc="drum torque of the onset")
C_bu = Parameter("C_bu", "N*m", 3.0, upper=200.0, doc="drag of a brake that is not fully released, hoisting")
C_bd = Parameter("C_bd", "N*m", 3.0, upper=200.0, doc="drag of a brake that is not fully released, lowering")
C_st = Parameter("C_st", "N*m", 30.0, upper=1e3, doc="loss whatever hangs there, at the shaft")
e_gp = Parameter("e_gp", "1", 0.01, lower=-0.2, upper=0.2, doc="one-way loss at 500 kN m, share of T_d/i")
n_ep = Parameter("n_ep", "1", 1.5, lower=0.2, upper=4.0, shape=True, doc="exponent of the drum torque")
e_gw = Parameter("e_gw", "1", 0.01, lower=-0.2, upper=0.2, doc="half the loss one way at 500 kN m, share of T_d/i")
n_gw = Parameter("n_gw", "1", 1.5, lower=0.2, upper=4.0, shape=True, doc="exponent of the drum torque")
b_gw = Parameter("b_gw", "1", 1.0, lower=-1.0, upper=1.0, shape=True, doc="1: hoisting alone, -1: lowering alone")
e_lb = Parameter("e_lb", "1", 0.01, lower=-0.2, upper=0.2, doc="per layer below, at 500 kN m, share of T_d/i")
n_lb = Parameter("n_lb", "1", 1.5, lower=0.2, upper=4.0, shape=True, doc="exponent of the drum torque")
e_ly = Parameter("e_ly", "1", 0.01, lower=-0.2, upper=0.2, doc="of one layer below, at 500 kN m, share of T_d/i")
n_ly = Parameter("n_ly", "1", 1.5, lower=0.2, upper=4.0, shape=True, doc="exponent of the drum torque")
m_ly = Parameter("m_ly", "1", 0.5, lower=0.2, upper=3.0, shape=True, doc="exponent of the number of layers below")
a_d = Parameter("a_d", "1", 0.01, lower=-0.2, upper=0.2, doc="sine amplitude over the drum's angle, share of T_d/i")
b_d = Parameter("b_d", "1", 0.01, lower=-0.2, upper=0.2, doc="cosine amplitude over the drum's angle, share of T_d/i")
k_d = Parameter("k_d", "1", 1.0, lower=0.5, upper=100.0, shape=True, doc="periods per turn of the drum")
k_dh = Parameter("k_dh", "1", 1.0, lower=0.5, upper=100.0, shape=True, doc="longest periods per turn of the drum")
_HARMONICS = tuple(
    tuple(
        Parameter(f"{own}_d{k}", "1", 0.01, lower=-0.2, upper=0.2, doc=f"{wave} amplitude of harmonic {k}, of T_d/i")
        for own, wave in (("a", "sine"), ("b", "cosine"))
    )
    for k in (1, 2, 3)
)

_h = sp.Symbol("z_held", real=True)
_rest = sp.exp(-w / REST_SPEED)
_tiny = 1e-9  # of the load scale; keeps derivatives by an exponent finite without load
_below = sp.Abs(wire_layer - 1) + _tiny
_load = sp.Abs(T_d) / LOAD_SCALE + _tiny


def _system(name: str, equation: sp.Expr, parameters: tuple[Parameter, ...], source: str, **more: object) -> Term:
    term = Term(name, equation, parameters, Scope.SYSTEM, source, "gear and drum", **more)  # type: ignore[arg-type]
    return register(term)


stribeck_gauss = _system(
    "stribeck_gauss", (C1_g.symbol * T_d + C3_g.symbol) * sp.exp(-((w / v_g.symbol) ** 2)), (C1_g, C3_g, v_g),
    "Bo and Pavelescu 1982, exponent 2; Armstrong-Helouvry 1991",
)  # fmt: skip
stribeck_lorentz = _system(
    "stribeck_lorentz", (C1_l.symbol * T_d + C3_l.symbol) / (1 + (w / v_l.symbol) ** 2), (C1_l, C3_l, v_l),
    "Hess and Soom 1990",
)  # fmt: skip
dwell_by_speed = _system(
    "dwell_by_speed", (F_dv.symbol + c_dv.symbol * T_d) * _h * sp.exp(-w / v_dv.symbol), (F_dv, c_dv, g_dv, v_dv),
    "Kato 1972 for the growth; Armstrong-Helouvry 1991: the grown part follows the Stribeck curve",
    state=State(
        _h, gain=g_dv.symbol * _rest, decay=g_dv.symbol * _rest + w / SLIDING_TO_FORGET,
        doc="age of the contact, 0 ... 1"
    ),
)  # fmt: skip


def _since(begin: Parameter, lag: Parameter) -> sp.Expr:
    """Time since a date, in lags; none before it."""
    return sp.Piecewise((0.0, time <= begin.symbol), ((time - begin.symbol) / lag.symbol, True))


wear_saturating = _system(
    "wear_saturating",
    C_ws.symbol * (1 - sp.exp(-_since(t_ws, tau_ws))),
    (C_ws, t_ws, tau_ws),
    "run-in of seals: a first-order lag",
)
wear_logarithmic = _system(
    "wear_logarithmic",
    C_wl.symbol * sp.log(1 + _since(t_wl, tau_wl)),
    (C_wl, t_wl, tau_wl),
    "Ludema 1996: logarithmic run-in",
)
_running = _since(t_wb, tau_wb)
wear_bathtub = _system(
    "wear_bathtub", C_wb.symbol * sp.exp(-_running) + C_wu.symbol * _running, (C_wb, C_wu, t_wb, tau_wb),
    "Blau 2009: friction falls while surfaces run in, and grows again as they wear",
)  # fmt: skip
wear_sudden = _system(
    "wear_sudden",
    C_wd.symbol * sp.Piecewise((0.0, time <= t_wd.symbol), (1.0, True)),
    (C_wd, t_wd),
    "a seal or a bearing that was changed or gave way between two runs",
)
wear_under_load = register(
    Term(
        "wear_under_load", c_wt.symbol * T_d / gear_ratio * (time - t_wt.symbol) / tau_wt.symbol, (c_wt, t_wt, tau_wt),
        Scope.SHAFT, "Amontons 1699: of what carries the load, wear changes a coefficient of friction", "gear and drum",
    )
)  # fmt: skip
# one amount alone: with a level of its own in the end it would be a loss in proportion to the load as well
wear_under_load_run_in = register(
    Term(
        "wear_under_load_run_in", c_wr.symbol * T_d / gear_ratio * sp.exp(-_since(t_wr, tau_wr)), (c_wr, t_wr, tau_wr),
        Scope.SHAFT, "run-in of flanks and bushes (Blau 2009), beside a seed of the winch that has run in",
        "gear and drum",
    )
)  # fmt: skip
wear_under_load_sudden = register(
    Term(
        "wear_under_load_sudden",
        c_we.symbol * T_d / gear_ratio * sp.Piecewise((0.0, time <= t_we.symbol), (1.0, True)), (c_we, t_we),
        Scope.SHAFT, "the same, all at once: a bearing of gear, drum or sheave that gave way or was changed",
        "gear and drum",
    )
)  # fmt: skip
gear_load_power = _system(
    "gear_load_power", c_gp.symbol * _load**n_gp.symbol, (c_gp, n_gp), "a power of the load: Hertzian contacts, bending"
)
gear_load_film = _system(
    "gear_load_film",
    c_gf.symbol * _load * sp.exp(-w / w_gf.symbol),
    (c_gf, w_gf),
    "a mesh in mixed film: its friction coefficient falls as the oil is drawn in (Niemann and Winter 2003)",
)
gear_load_saturating = _system(
    "gear_load_saturating",
    c_gs.symbol * (1 - sp.exp(-T_d / T_gs.symbol)),
    (c_gs, T_gs),
    "a contact that the load closes: Greenwood and Williamson 1966, until it is complete",
)


def _load_beyond(onset: Parameter) -> sp.Expr:
    return sp.Piecewise((0.0, T_d <= onset.symbol), (T_d - onset.symbol, True)) / LOAD_SCALE


gear_load_onset = _system(
    "gear_load_onset", c_go.symbol * _load_beyond(T_go), (c_go, T_go),
    "a frame that bends from a load on, so that the mesh runs on its edge (Niemann and Winter 2003)",
)  # fmt: skip
sheave_onset = register(
    Term(
        "sheave_onset", c_so.symbol * LOAD_SCALE / gear_ratio * _load_beyond(T_so), (c_so, T_so), Scope.SHAFT,
        "a rope that leaves its groove's ground from a tension on", "gear and drum",
    )
)  # fmt: skip
sheave_saturating = register(
    Term(
        "sheave_saturating", c_ss.symbol * (1 - sp.exp(-T_d / T_ss.symbol)), (c_ss, T_ss), Scope.SHAFT,
        "the same between wires, which slip no more once the rope is taut", "gear and drum",
    )
)  # fmt: skip
brake_each_way = register(
    Term(
        "brake_each_way", C_bu.symbol * (1 + s) / 2 + C_bd.symbol * (1 - s) / 2, (C_bu, C_bd), Scope.SYSTEM,
        "Euler-Eytelwein: a band's pull grows around the drum, so that it drags more one way", "gear and drum",
    )
)  # fmt: skip
sheave_stiffness = register(
    Term(
        "sheave_stiffness", C_st.symbol, (C_st,), Scope.SHAFT,
        "Feyrer 2015: a rope resists bending by a part that its tension has no say in", "gear and drum",
    )
)  # fmt: skip
sheave_power = register(
    Term(
        "sheave_power", c_sp.symbol * LOAD_SCALE / gear_ratio * _load**n_sp.symbol, (c_sp, n_sp), Scope.SHAFT,
        "Feyrer 2015: bending loss of a rope grows less than its tension", "gear and drum",
    )
)  # fmt: skip
sheave_film = register(
    Term(
        "sheave_film", c_sf.symbol * LOAD_SCALE / gear_ratio * _load * sp.exp(-w / w_sf.symbol), (c_sf, w_sf),
        Scope.SHAFT, "greased bushes and wires in mixed film (Stribeck 1902), as the mesh of a gear", "gear and drum",
    )
)  # fmt: skip
gear_asymmetry_power = register(
    Term(
        "gear_asymmetry_power", e_gp.symbol * LOAD_SCALE / gear_ratio * _load**n_ep.symbol, (e_gp, n_ep),
        Scope.SHAFT, "gear efficiency by direction, a power of the load", "gear and drum", opposing=False,
    )
)  # fmt: skip
gear_one_way = register(
    Term(
        "gear_one_way", e_gw.symbol * LOAD_SCALE / gear_ratio * _load**n_gw.symbol * (s**2 + b_gw.symbol * s),
        (e_gw, n_gw, b_gw), Scope.SHAFT, "gear flanks of which one side alone carries more, a power of the load",
        "gear and drum", opposing=False,
    )
)  # fmt: skip

layer_bedding = register(
    Term(
        "layer_bedding", e_lb.symbol * LOAD_SCALE / gear_ratio * (wire_layer - 1) * _load**n_lb.symbol, (e_lb, n_lb),
        Scope.SHAFT, "Dietz 1972: under the rope's tension each layer yields to those on it", "gear and drum",
        opposing=False,
    )
)  # fmt: skip
layer_yielding = register(
    Term(
        "layer_yielding",
        e_ly.symbol * LOAD_SCALE / gear_ratio * _below**m_ly.symbol * _load**n_ly.symbol,
        (e_ly, n_ly, m_ly), Scope.SHAFT, "the same, where layers further down yield less or more", "gear and drum",
        opposing=False,
    )
)  # fmt: skip


def _over_the_drum(order: sp.Expr, a: Parameter, b: Parameter) -> sp.Expr:
    turned = order * shaft_angle / gear_ratio
    return a.symbol * sp.sin(turned) + b.symbol * sp.cos(turned)


drum_ripple = register(
    Term(
        "drum_ripple", _over_the_drum(k_d.symbol, a_d, b_d) * T_d / gear_ratio, (a_d, b_d, k_d), Scope.SHAFT,
        "docs/discrepancy.md, an eccentric drum or a wheel of its gear", "gear and drum", opposing=False,
    )
)  # fmt: skip
drum_ripple_harmonics = register(
    Term(
        "drum_ripple_harmonics",
        sum(_over_the_drum(k * k_dh.symbol, a, b) for k, (a, b) in enumerate(_HARMONICS, start=1)) * T_d / gear_ratio,
        (*(p for pair in _HARMONICS for p in pair), k_dh), Scope.SHAFT,
        "docs/discrepancy.md, the same with two harmonics", "gear and drum", opposing=False,
    )
)  # fmt: skip
