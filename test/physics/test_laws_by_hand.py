"""Every declared law against its formula, written down once more from the source that it names, in plain Python.

The same formulas tell the units: a law must come out in N m whatever the units of mass, length and time are, so that
what a parameter's unit says is what its factor is.
"""

import math
from types import SimpleNamespace

import pytest

from winch_friction.physics.channels import dimension_of
from winch_friction.physics.friction import FrictionModel, Parameter, registered_terms
from winch_friction.physics.friction.symbols import CONSTANTS, GROUP_SIGNALS, WINCH_SIGNALS
from winch_friction.physics.winch import operating_point

TERMS = registered_terms()

HOISTING = {
    "direction": 1.0, "speed_magnitude": 120.0, "speed": 120.0, "drum_torque": 8e5, "acceleration": 7.0,
    "oil_temperature": 25.0, "time": 2.1e6, "shaft_angle": 1000.3, "wire_layer": 3.0, "wire_out": 80.0,
    "motor_total": 11.0, "count": 3.0, "pressure": 250e5, "pressure_sum": 310e5, "displacement": 2.0e-5,
    "higher_port": 1.0, "role": 1.0, "max_displacement": 3.42e-5, "density": 880.0, "viscosity": 0.05,
    "gear_ratio": 250.0,
}  # fmt: skip
LOWERING = HOISTING | {
    "direction": -1.0, "speed_magnitude": 15.0, "speed": -15.0, "drum_torque": 3.1e5, "oil_temperature": 55.0,
    "time": 7e5, "shaft_angle": -37.0, "wire_layer": 5.0, "pressure": 165e5, "pressure_sum": 190e5,
    "displacement": 3.0e-5, "higher_port": -1.0, "role": -1.0,
}  # fmt: skip
EARLY = LOWERING | {"time": 3e4, "role": 0.0, "drum_torque": 9e4, "pressure": 90e5, "pressure_sum": 120e5,
                    "speed_magnitude": 0.2, "speed": -0.2}  # fmt: skip
POINTS = {"hoisting": HOISTING, "lowering": LOWERING, "early and light": EARLY}
# what the laws name besides, with its unit: 2000 and 400 rpm, 200 bar, a flow, a load, a speed of rest, a travel
NAMED = {
    "fast": (2000.0 * math.pi / 30.0, "rad/s"), "slow": (400.0 * math.pi / 30.0, "rad/s"), "full": (200e5, "Pa"),
    "flow": (0.02, "m^3/s"), "heavy": (5e5, "N*m"), "rest": (0.5, "rad/s"), "travel": (300.0, "rad"),
}  # fmt: skip
SHORT = {
    "s": "direction", "w": "speed_magnitude", "T": "drum_torque", "oil": "oil_temperature", "t": "time",
    "phi": "shaft_angle", "layer": "wire_layer", "N": "motor_total", "n": "count", "p": "pressure",
    "both": "pressure_sum", "D": "displacement", "port": "higher_port", "role": "role", "X": "max_displacement",
    "rho": "density", "mu": "viscosity", "i": "gear_ratio",
}  # fmt: skip
TYPICAL_TIMES = (1.1, 1.3, 0.9, 1.2, 0.8, 1.15, 0.7)  # so that no two parameters have the same value


def thick(celsius):
    """Walther's line in log log over log, through 134 cSt at 20 degC and 21 cSt at 60 degC; relative to 40 degC."""

    def nu(kelvin):
        low, high = (math.log10(math.log10(each + 0.7)) for each in (134.0, 21.0))
        share = math.log(kelvin / 293.15) / math.log(333.15 / 293.15)
        return 10**10 ** (low + share * (high - low)) - 0.7

    return nu(celsius + 273.15) / nu(313.15)


def vogel(celsius, reference, steepness=826.0):
    return math.exp(steepness / (celsius + 95.0) - steepness / (reference + 95.0))


def way(q, up, down):
    return up if q.s > 0.0 else down


def line_of(side, q, v):
    lost = way(q, v[f"p_l{side[0]}h"], v[f"p_l{side[0]}l"])
    return lost * (q.n * q.D * q.w / q.flow) ** v[f"n_l{side[0]}"] * q.D


def since(q, begin, lag):
    return max(q.t - begin, 0.0) / lag


def peak(q, own):
    """1 at its own speed, less on either side."""
    return 2.0 * q.w * own / (q.w**2 + own**2)


def notch(q):
    return q.w / (q.w**2 + q.slow**2) * q.p * math.sqrt(q.p / q.rho)


def pacey(q):
    steepest = math.radians(25.0)
    swivel = math.asin(q.D / q.X * math.sin(steepest))
    return (1.0 - math.tan(steepest)) / (1.0 - math.tan(swivel))


def polynomial(q, v, name, order):
    return sum((v[f"{name}_{k}"] + v[f"{name}_{k}a"] * q.D / q.X) * (q.w / q.fast) ** k for k in range(order + 1))


def beyond(value, onset):
    return max(value - onset, 0.0)


def wave(q, v, a, b, order):
    return v[a] * math.sin(order * q.phi) + v[b] * math.cos(order * q.phi)


# per motor, of the motor's own pressure and displacement
PER_MOTOR = {
    "motor_viscous": lambda q, v: v["K1"] * q.w,
    "motor_turbulence": lambda q, v: v["K2"] * q.w**2 * q.D**3,
    "motor_load_loss": lambda q, v: v["K3"] * q.p * q.D,
    "motor_coulomb": lambda q, v: v["K4"],
    "high_pressure_mixed": lambda q, v: v["K5"] * q.p**2,
    # paper 1
    "wilson_load": lambda q, v: v["Ca"] * q.X * q.p,
    "wilson_viscous": lambda q, v: v["Cb"] * q.mu * q.X * q.w,
    "wilson_constant": lambda q, v: v["Cc"] * q.X,
    "schlosser_inertia": lambda q, v: v["Cd"] * q.X ** (5 / 3) * q.rho * q.w**2,
    "thoma_inertia": lambda q, v: v["Cd_a"] * (q.D / q.X) ** 3 * q.X ** (5 / 3) * q.rho * q.w**2,
    "pacey_load": lambda q, v: v["Ca_P"] * q.X * q.p * pacey(q),
    "pacey_viscous": lambda q, v: v["Cb_P"] * q.mu * q.D * q.w * pacey(q),
    "motor_pressure_loss": lambda q, v: v["Cf"] * q.p,
    "motor_speed_squared": lambda q, v: v["Ci"] * q.rho * q.w**2,
    "jeong_notch": lambda q, v: v["Ck"] * notch(q),
    "mj6_notch": lambda q, v: v["Ck_D"] * q.D / q.X * notch(q),
    "mj5_port_flow": lambda q, v: v["Cn_scale"] * (q.w / q.fast * q.D / q.X) ** v["Cn"] * q.D / q.X,
    "ortwig_speed_pressure": lambda q, v: v["Ch"] * q.w * q.p,
    "ortwig_displacement": lambda q, v: v["Cj"] * q.D / q.X,
    "ortwig_displacement_speed": lambda q, v: v["Cl"] * q.w * q.D / q.X,
    "huhtala_intercept_low": lambda q, v: polynomial(q, v, "A1", 3) if q.p < q.full else 0.0,
    "huhtala_slope_low": lambda q, v: polynomial(q, v, "B1", 2) * q.p / q.full if q.p < q.full else 0.0,
    "huhtala_intercept_high": lambda q, v: polynomial(q, v, "A2", 3) if q.p > q.full else 0.0,
    "huhtala_slope_high": lambda q, v: polynomial(q, v, "B2", 2) * q.p / q.full if q.p > q.full else 0.0,
    # what a motor model can lack
    "low_displacement_loss": lambda q, v: v["c_ld"] * q.p * (1.0 - q.D / q.X),
    "port_turbulence": lambda q, v: v["K_n"] * (q.w / q.fast) ** v["n_t"] * (q.D / q.X) ** (v["n_t"] + 1.0),
    "churning": lambda q, v: v["T_ch"] * (q.w / q.fast) ** v["n_ch"],
    "notch_loss": lambda q, v: v["c_nk"] * q.D / q.X * notch(q),
    "case_pressure": lambda q, v: v["c_case"] * q.both,
    "line_pressure_drop": lambda q, v: v["R_line"] * (q.n * q.D * q.w) ** 2 * q.D,
    # the same with what the literature leaves open
    "low_displacement_power": lambda q, v: v["c_lp"] * (q.p / q.full) ** v["a_lp"] * (1.0 - q.D / q.X) ** v["b_lp"],
    "low_displacement_each_way": lambda q, v: (
        way(q, v["c_lu"], v["c_lo"]) * (q.p / q.full) ** v["a_lu"] * (1.0 - q.D / q.X) ** v["b_lu"]
    ),
    "port_power": lambda q, v: v["K_pp"] * (q.w / q.fast) ** v["n_pp"] * (q.D / q.X) ** v["m_pp"],
    "port_one_way": lambda q, v: (
        v["K_po"] * (q.w / q.fast) ** v["n_po"] * (q.D / q.X) ** v["m_po"] * way(q, 1.0 + v["b_po"], 1.0 - v["b_po"])
    ),
    "churning_viscous": lambda q, v: v["T_cv"] * (q.w / q.fast) ** v["n_cv"] * thick(q.oil) ** 0.25,
    "churning_one_way": lambda q, v: v["T_cw"] * (q.w / q.fast) ** v["n_cw"] * way(q, 1.0 + v["b_cw"], 1.0 - v["b_cw"]),
    "high_pressure_power": lambda q, v: v["K_hp"] * (q.p / q.full) ** v["n_hp"],
    "high_pressure_each_way": lambda q, v: way(q, v["K_hu"], v["K_hd"]) * (q.p / q.full) ** v["n_hu"],
    "high_pressure_film": lambda q, v: v["K_hf"] * (q.p / q.full) ** v["n_hf"] * math.exp(-q.w / v["w_hf"]),
    "high_pressure_onset": lambda q, v: v["K_ho"] * beyond(q.p, v["p_ho"]) / q.full * math.exp(-q.w / v["w_ho"]),
    "notch_power": lambda q, v: v["c_np"] * peak(q, v["w_np"]) * (q.p / q.full) ** v["a_np"] * q.D / q.X,
    "notch_any_stroke": lambda q, v: v["c_na"] * peak(q, v["w_na"]) * (q.p / q.full) ** v["a_na"],
    "line_pressure_power": lambda q, v: (
        v["p_l"] * (q.n * q.D * q.w / q.flow) ** v["n_l"] * q.D * way(q, 1.0 + v["b_l"], 1.0 - v["b_l"])
    ),
    "line_laminar": lambda q, v: v["p_lv"] * q.n * q.D * q.w / q.flow * q.D * thick(q.oil),
    "line_turbulent": lambda q, v: v["p_lt"] * (q.n * q.D * q.w / q.flow) ** v["n_lt"] * q.D * thick(q.oil) ** 0.25,
    "line_each_motor": lambda q, v: (
        v["p_le"] * (q.D / q.X * q.w / q.fast) ** v["n_le"] * q.D * way(q, 1.0 + v["b_le"], 1.0 - v["b_le"])
    ),
    "line_driving": lambda q, v: 0.0 if q.role < 0.0 else line_of("driving", q, v),
    "line_active": lambda q, v: line_of("active", q, v) if q.role > 0.0 else 0.0,
    "line_passive": lambda q, v: line_of("passive", q, v) if q.role < 0.0 else 0.0,
    "case_high_port": lambda q, v: v["c_hi"] * (q.both + q.p) / 2.0,
    "case_ports": lambda q, v: v["K_pA"] * (q.both + q.p * q.port) / 2.0 + v["K_pB"] * (q.both - q.p * q.port) / 2.0,
}
# per motor shaft, the same for all of them
PER_SHAFT = {
    "stribeck": lambda q, v: (v["C1"] * q.T + v["C3"]) * math.exp(-q.w / v["C4"]),
    "coulomb": lambda q, v: v["C2"],
    "viscous": lambda q, v: v["C5"] * q.w,
    "gear_load_loss": lambda q, v: v["C6"] * q.T,
    "brake_drag": lambda q, v: v["T_br"],
    "viscosity_temperature": lambda q, v: v["K_v"] * (thick(q.oil) - 1.0) * q.w,
    "wear_drift": lambda q, v: v["C_w"] * (q.t - v["t_w"]) / v["tau_w"],
    "viscosity_reference": lambda q, v: v["K_vw"] * (thick(q.oil) / thick(v["T_vw"]) - 1.0) * q.w,
    "viscosity_vogel": lambda q, v: v["K_vv"] * (vogel(q.oil, v["T_vv"], v["B_vv"]) - 1.0) * q.w,
    "viscosity_exponential": lambda q, v: v["K_ve"] * (math.exp(v["b_ve"] * (v["T_ve"] - q.oil)) - 1.0) * q.w,
    "viscosity_hersey": lambda q, v: (
        v["K_vh"] * (vogel(q.oil, v["T_vh"]) - 1.0) * q.w
        + v["C1_h"] * q.T * (math.exp(-q.w * vogel(q.oil, v["T_vh"]) / v["C4_h"]) - math.exp(-q.w / v["C4_h"]))
    ),
    "viscosity_each_way": lambda q, v: way(q, v["K_vu"], v["K_vd"]) * (vogel(q.oil, v["T_vu"]) - 1.0) * q.w,
    "stribeck_gauss": lambda q, v: (v["C1_g"] * q.T + v["C3_g"]) * math.exp(-((q.w / v["v_g"]) ** 2)),
    "stribeck_lorentz": lambda q, v: (v["C1_l"] * q.T + v["C3_l"]) / (1.0 + (q.w / v["v_l"]) ** 2),
    "wear_saturating": lambda q, v: v["C_ws"] * (1.0 - math.exp(-since(q, v["t_ws"], v["tau_ws"]))),
    "wear_logarithmic": lambda q, v: v["C_wl"] * math.log(1.0 + since(q, v["t_wl"], v["tau_wl"])),
    "wear_bathtub": lambda q, v: (
        v["C_wb"] * math.exp(-since(q, v["t_wb"], v["tau_wb"])) + v["C_wu"] * since(q, v["t_wb"], v["tau_wb"])
    ),
    "wear_sudden": lambda q, v: v["C_wd"] if q.t > v["t_wd"] else 0.0,
    "gear_load_power": lambda q, v: v["c_gp"] * (q.T / q.heavy) ** v["n_gp"],
    "gear_load_film": lambda q, v: v["c_gf"] * q.T / q.heavy * math.exp(-q.w / v["w_gf"]),
    "gear_load_saturating": lambda q, v: v["c_gs"] * (1.0 - math.exp(-q.T / v["T_gs"])),
    "gear_load_onset": lambda q, v: v["c_go"] * beyond(q.T, v["T_go"]) / q.heavy,
    "brake_each_way": lambda q, v: way(q, v["C_bu"], v["C_bd"]),
    # with memory, which is 0.3 here
    "presliding": lambda q, v: (v["F_z"] + v["c_z"] * q.T) * (0.3 - q.s),
    "dwell_stiction": lambda q, v: (v["F_dw"] + v["c_dw"] * q.T) * 0.3,
    "dwell_by_speed": lambda q, v: (v["F_dv"] + v["c_dv"] * q.T) * 0.3 * math.exp(-q.w / v["v_dv"]),
}
# once, on the common shaft
ONCE = {
    "torque_offset": lambda q, v: v["T_0"],
    "direction_asymmetry": lambda q, v: v["A_v"] * q.w,
    "gear_asymmetry": lambda q, v: v["e_g"] * q.T / q.i * way(q, 1.0 + v["b_g"], 1.0 - v["b_g"]) / 2.0,
    "sheave_bending": lambda q, v: v["c_sh"] * q.T / q.i,
    "torque_ripple": lambda q, v: wave(q, v, "a_r", "b_r", v["k_r"]) * q.T / q.i,
    "wear_under_load": lambda q, v: v["c_wt"] * q.T / q.i * (q.t - v["t_wt"]) / v["tau_wt"],
    "wear_under_load_run_in": lambda q, v: v["c_wr"] * q.T / q.i * math.exp(-since(q, v["t_wr"], v["tau_wr"])),
    "wear_under_load_sudden": lambda q, v: v["c_we"] * q.T / q.i if q.t > v["t_we"] else 0.0,
    "sheave_onset": lambda q, v: v["c_so"] * beyond(q.T, v["T_so"]) / q.i,
    "sheave_saturating": lambda q, v: v["c_ss"] * (1.0 - math.exp(-q.T / v["T_ss"])),
    "sheave_stiffness": lambda q, v: v["C_st"],
    "sheave_power": lambda q, v: v["c_sp"] * q.heavy / q.i * (q.T / q.heavy) ** v["n_sp"],
    "sheave_film": lambda q, v: v["c_sf"] * q.T / q.i * math.exp(-q.w / v["w_sf"]),
    "gear_asymmetry_power": lambda q, v: v["e_gp"] * q.heavy / q.i * (q.T / q.heavy) ** v["n_ep"],
    "gear_one_way": lambda q, v: (
        v["e_gw"] * q.heavy / q.i * (q.T / q.heavy) ** v["n_gw"] * way(q, 1.0 + v["b_gw"], 1.0 - v["b_gw"])
    ),
    "layer_bedding": lambda q, v: v["e_lb"] * q.heavy / q.i * (q.layer - 1.0) * (q.T / q.heavy) ** v["n_lb"],
    "layer_yielding": lambda q, v: (
        v["e_ly"] * q.heavy / q.i * (q.layer - 1.0) ** v["m_ly"] * (q.T / q.heavy) ** v["n_ly"]
    ),
    "drum_ripple": lambda q, v: wave(q, v, "a_d", "b_d", v["k_d"] / q.i) * q.T / q.i,
    "drum_ripple_harmonics": lambda q, v: (
        sum(wave(q, v, f"a_d{k}", f"b_d{k}", k * v["k_dh"] / q.i) for k in (1, 2, 3)) * q.T / q.i
    ),
}
LAWS = PER_MOTOR | PER_SHAFT | ONCE
# torques that do not turn with the motion, or say themselves how they do
AS_WRITTEN = {
    "torque_offset", "direction_asymmetry", "presliding", "gear_asymmetry", "torque_ripple", "gear_asymmetry_power",
    "gear_one_way", "layer_bedding", "layer_yielding", "drum_ripple", "drum_ripple_harmonics",
}  # fmt: skip
STATE = 0.3


def values_of(name) -> dict[str, float]:
    """Values near the typical ones, inside the bounds, no two by the same factor."""
    found = {}
    for k, parameter in enumerate(TERMS[name].parameters):
        value = parameter.typical * TYPICAL_TIMES[k % len(TYPICAL_TIMES)]
        found[parameter.name] = min(max(value, parameter.lower), parameter.upper)
    return found


def size_of(unit, kg, m, s) -> float:
    """What a number in a unit is times where the units of mass, length and time are others."""
    powers = dimension_of(unit)
    return kg ** powers.get("kg", 0.0) * m ** powers.get("m", 0.0) * s ** powers.get("s", 0.0)


def by_hand(name, point, values, units=(1.0, 1.0, 1.0)) -> float:
    """The torque at the shaft, N m, in units of mass, length and time that are so many times smaller."""
    unit = {each.name: each.unit for each in (*WINCH_SIGNALS, *GROUP_SIGNALS, *CONSTANTS)}
    known = {short: point[full] * size_of(unit[full], *units) for short, full in SHORT.items()}
    named = {key: value * size_of(of, *units) for key, (value, of) in NAMED.items()}
    q = SimpleNamespace(**known, **named)
    times = q.n if name in PER_MOTOR else q.N if name in PER_SHAFT else 1.0
    own = {p.name: values[p.name] * size_of(p.unit, *units) for p in TERMS[name].parameters}
    return times * (1.0 if name in AS_WRITTEN else q.s) * LAWS[name](q, own)


def model_of(name, values) -> FrictionModel:
    constants = {each.name: HOISTING[each.name] for each in CONSTANTS}
    return FrictionModel(name, (TERMS[name],), tuple(values.values()), constants=constants)


def point_of(point) -> tuple:
    group = tuple(point[each.name] for each in GROUP_SIGNALS)
    winch = {each.name: point[each.name] for each in WINCH_SIGNALS if each.name != "speed_magnitude"}
    return operating_point(groups=[group], **winch)


def test_every_law_is_written_down():
    assert set(LAWS) == set(TERMS)
    assert len(LAWS) == len(PER_MOTOR) + len(PER_SHAFT) + len(ONCE)
    assert {name for name, term in TERMS.items() if not term.opposing} == AS_WRITTEN


@pytest.mark.parametrize("name", TERMS)
def test_a_law_is_what_its_source_says(name):
    values = values_of(name)
    model = model_of(name, values)
    states = (STATE,) if TERMS[name].state else ()
    for where, point in POINTS.items():
        told = by_hand(name, point, values)
        assert float(model.torque(point_of(point), states)) == pytest.approx(told, rel=1e-4, abs=1e-7), where


@pytest.mark.parametrize("name", TERMS)
def test_a_law_is_a_torque_in_any_units(name):
    values = values_of(name)
    for point in POINTS.values():
        in_si, in_others = by_hand(name, point, values), by_hand(name, point, values, (2.0, 3.0, 5.0))
        assert in_others == pytest.approx(in_si * size_of("N*m", 2.0, 3.0, 5.0), rel=1e-9)


@pytest.mark.parametrize("name", TERMS)
def test_a_law_is_linear_in_all_but_its_shapes(name):
    values, shapes = values_of(name), {p.name for p in TERMS[name].parameters if p.shape}
    amounts = set(values) - shapes
    assert amounts

    def at(**changed):
        return by_hand(name, HOISTING, values | changed)

    nothing = dict.fromkeys(amounts, 0.0)
    assert at(**nothing) == 0.0
    each = [at(**nothing | {amount: values[amount]}) for amount in amounts]
    assert sum(each) == pytest.approx(at(), rel=1e-9)
    doubled = at(**{amount: 2.0 * values[amount] for amount in amounts})
    assert doubled == pytest.approx(2.0 * at(), rel=1e-9)
    for shape in shapes:
        assert at(**nothing | {shape: 1.1 * values[shape]}) == 0.0


# -- what a parameter may be
# amounts of which nobody knows beforehand whether they add or take
EITHER_SIGN = {
    "T_0", "A_v", "K_n", "c_case", "c_hi", "e_g", "c_sh", "K_v", "C_w", "a_r", "b_r", "K_vw", "K_vv", "K_ve", "K_vh",
    "K_vu", "K_vd", "C_ws", "C_wl", "C_wd", "c_wt", "c_wr", "c_we", "e_gp", "e_gw", "e_lb", "e_ly", "a_d", "b_d",
    "a_d1", "b_d1", "a_d2", "b_d2", "a_d3", "b_d3", "Ch", "Cj", "Cl",
    *(f"{letter}_{k}{a}" for letter in ("A1", "A2") for k in range(4) for a in ("", "a")),
    *(f"{letter}_{k}{a}" for letter in ("B1", "B2") for k in range(3) for a in ("", "a")),
}  # fmt: skip


def each_parameter() -> dict[str, Parameter]:
    return {p.name: p for term in TERMS.values() for p in term.parameters}


def test_an_amount_is_a_loss_unless_it_may_have_either_sign():
    amounts = [p for p in each_parameter().values() if not p.shape]
    assert {p.name for p in amounts if p.lower < 0.0} == EITHER_SIGN
    assert all(p.lower == 0.0 for p in amounts if p.name not in EITHER_SIGN)
    assert all(p.lower < p.typical < p.upper for p in amounts)


def test_a_shape_has_room_on_both_sides_and_ends_where_its_meaning_does():
    for p in each_parameter().values():
        if not p.shape:
            continue
        assert math.isfinite(p.lower), p.name
        assert math.isfinite(p.upper), p.name
        if "hoisting alone" in p.doc or "hoisting, -1" in p.doc:  # a share of the mean of both ways
            assert (p.lower, p.upper) == (-1.0, 1.0), p.name
        elif p.unit == "s" and p.name.startswith("t_"):  # a date, before 1970 as well
            assert p.lower == -p.upper, p.name
        elif p.name == "a_lp" or p.name == "a_lu":  # a loss of the stroke alone has no pressure in it
            assert p.lower == 0.0, p.name
        else:
            assert p.lower > 0.0, p.name
        if "exponent" in p.doc:
            assert p.upper <= 6.0, p.name
            assert p.lower <= p.typical <= p.upper, p.name


def test_a_typical_loss_of_a_large_winch_is_neither_nothing_nor_more_than_it_has():
    """A typical value is the size at which a search and a simulator begin; half a N m of the shaft's 7000 is a loss."""
    for name, term in TERMS.items():
        typical = {p.name: p.typical for p in term.parameters}
        slow, fast = (HOISTING | {"speed_magnitude": w, "displacement": d} for w, d in ((20.0, 2e-5), (209.0, 3e-5)))
        own = {"role": -1.0 if name == "line_passive" else 1.0}
        most = max(
            abs(by_hand(name, at | own | {"pressure": p}, typical)) for at in (slow, fast) for p in (150e5, 250e5)
        )
        assert 0.5 < most < 1500.0, (name, most)


# -- memory
def rates(name, point):
    model = model_of(name, values_of(name))
    return model.compile(1).scalar_state_rates(point_of(point), model.values, (STATE,))


def test_bristles_turn_over_within_their_travel():
    """Dahl: dz/dx = (sign - z)/d, whatever the speed."""
    travel = values_of("presliding")["d_z"]
    assert rates("presliding", HOISTING) == pytest.approx((120.0 / travel, 120.0 / travel))
    assert rates("presliding", LOWERING) == pytest.approx((-15.0 / travel, 15.0 / travel))


@pytest.mark.parametrize(
    ("name", "rate", "travel"), [("dwell_stiction", "g_dw", "d_dw"), ("dwell_by_speed", "g_dv", None)]
)
def test_a_contact_ages_at_rest_and_forgets_by_sliding(name, rate, travel):
    """Kato: it grows towards 1 at its rate at rest, an e-fold of which 0.5 rad/s takes; sliding wears it off."""
    values = values_of(name)
    forgets = values[travel] if travel else 300.0
    grows = values[rate]
    assert rates(name, HOISTING | {"speed": 0.0, "speed_magnitude": 0.0}) == pytest.approx((grows, grows))
    aged = grows * math.exp(-0.2 / 0.5)
    assert rates(name, EARLY) == pytest.approx((aged, aged + 0.2 / forgets))
    assert rates(name, HOISTING) == pytest.approx((0.0, 120.0 / forgets), abs=1e-12)


@pytest.mark.parametrize("name", [name for name, term in TERMS.items() if term.state])
def test_a_memory_starts_from_nothing(name):
    assert model_of(name, values_of(name)).compile(1).initial_states == (0.0,)


# -- where it arises
FLUID = {
    "line_pressure_drop", "viscosity_temperature", "viscosity_reference", "viscosity_vogel", "viscosity_exponential",
    "viscosity_hersey", "viscosity_each_way", "line_pressure_power", "line_laminar", "line_each_motor",
    "line_turbulent", "line_driving", "line_active", "line_passive",
}  # fmt: skip


def test_a_law_is_told_where_it_arises():
    """What is scaled for a winch that is harder to turn is of its gear and drum; a motor's page has the motor's."""
    assert {name for name, term in TERMS.items() if term.place == "fluid"} == FLUID
    assert {name for name, term in TERMS.items() if term.place == "sensor"} == {"torque_offset"}
    motor = {name for name, term in TERMS.items() if term.place == "motor"}
    assert motor == (set(PER_MOTOR) - FLUID) | {"torque_ripple"}
    rest = set(TERMS) - motor - FLUID - {"torque_offset"}
    assert {TERMS[name].place for name in rest} == {"gear and drum"}
