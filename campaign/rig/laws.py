"""Other laws of the catalogue's causes: a plant wears, drags and measures by its own equations, not by a catalogue's.

Every cause has the catalogue's own law (campaign.rig.effects) and at least two more. `held_out` marks those of which
the package has no member: a test fits it all that the package knows of the cause, and requires that it does not fit.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from campaign.rig.effects import CATALOGUE, OUTSIDE, Strengths
from campaign.rig.truth import BAR, CM3_PER_REV, MAX_DISPLACEMENT, RPM, Friction

Draw = Callable[[float, np.random.Generator, Friction], Strengths]
DRAWN_LAW = "drawn"  # of every cause the law whose exponents are drawn
GAUSS, LORENTZ, SLOW, RAMP = 1.0, 2.0, 3.0, 4.0  # stribeck_shape
VOGEL, REYNOLDS, ANDRADE = 1.0, 2.0, 3.0  # oil_law


@dataclass(frozen=True)
class Law:
    """One law of a cause at a size."""

    name: str
    draw: Draw
    held_out: bool = False


def _stribeck(shape: float, low: float, high: float) -> Draw:
    return lambda s, rng, f: {
        "stribeck": s, "stribeck_speed": f.C4 * rng.uniform(low, high), "stribeck_shape": shape
    }  # fmt: skip


def _oil(law: float, hersey: float, power: float = 1.0) -> Draw:
    return lambda s, rng, f: {
        "viscosity": s, "oil_law": law, "oil_reference": rng.uniform(32, 50), "hersey": hersey, "viscosity_power": power
    }  # fmt: skip


def _presliding(degrees: float, kind: float) -> Draw:
    return lambda s, rng, f: {"presliding_angle": np.radians(degrees * s), "presliding_kind": kind}


def _dwell(growth: float, by_speed: bool) -> Draw:
    return lambda s, rng, f: {
        "dwell_gain": 0.22 * s, "dwell_growth": growth, "dwell_rate": rng.uniform(0.15, 0.9),
        "dwell_angle": rng.uniform(0.5, 2.5), "dwell_speed": rng.uniform(6.0, 18.0) if by_speed else 0.0,
    }  # fmt: skip


def _motor(amount: float, **exponents: float) -> Draw:
    return lambda s, rng, f: {"motor_amount": amount * s, **{f"motor_{k}": v for k, v in exponents.items()}}


def _winch(amount: float, **exponents: float) -> Draw:
    return lambda s, rng, f: {"winch_amount": amount * s, **{f"winch_{k}": v for k, v in exponents.items()}}


def _line(power: float, side: float = 0.0) -> Draw:
    return lambda s, rng, f: {"line_drop": 4 * BAR / (1.29 / 60) ** 2 * s, "line_power": power, "line_side": side}


def _own_line(power: float, whose: float, motors: int, **more: float) -> Draw:
    """Of one side's motors alone, as much at their own flow as all motors' line loses at that of all."""
    flow = 1.29 / 60 * motors / 11
    return lambda s, rng, f: {
        "line_drop": 4 * BAR / flow**2 * s, "line_flow": flow, "line_power": power, "line_of": whose, **more,
    }  # fmt: skip


def _leak(power: float, cold: float, **more: float) -> Draw:
    return lambda s, rng, f: {
        "leakage": 50 * RPM * 11 * MAX_DISPLACEMENT / (150 * BAR) * s, "leakage_power": power, "leakage_cold": cold,
        **more,
    }  # fmt: skip


def _drift(law: float, size: float = 0.3) -> Draw:
    return lambda s, rng, f: {"coulomb_drift": size * s, "drift_law": law, "drift_at": rng.uniform(0.3, 0.7)}


def _set(**values: float) -> Draw:
    return lambda s, rng, f: {name: value * s for name, value in values.items()}


def _wave(kind: float, still: bool) -> Draw:
    def draw(s: float, rng: np.random.Generator, f: Friction) -> Strengths:
        amount = {"ripple_still": 14.0 * s} if still else {"ripple": 0.02 * s}
        return {**amount, "ripple_wave": kind, "ripple_order": float(rng.choice([1.0, 0.2, 2.0, 1 / 6]))}

    return draw


OTHER: dict[str, tuple[Law, ...]] = {
    "viscosity_temperature": (
        Law("vogel_hersey", _oil(VOGEL, 1.0)), Law("exponential", _oil(REYNOLDS, 0.0)),
        Law("andrade", _oil(ANDRADE, 0.0)), Law("shear_thinning", _oil(VOGEL, 0.5, power=0.45), held_out=True),
    ),
    "stribeck": (
        Law("gauss", _stribeck(GAUSS, 0.6, 1.5)), Law("hess_soom", _stribeck(LORENTZ, 0.6, 1.5)),
        Law("slow_tail", _stribeck(SLOW, 0.5, 1.0), held_out=True),
        Law("ramp", _stribeck(RAMP, 0.5, 1.2), held_out=True),
    ),
    "presliding": (
        Law("linear", _presliding(7.0, 1.0), held_out=True),
        Law("two_populations", _presliding(8.0, 2.0)),
    ),
    "dwell_stiction": (
        Law("by_speed", _dwell(0.0, True)), Law("logarithmic", _dwell(1.0, False)),
        Law("power_by_speed", _dwell(2.0, True), held_out=True),
    ),
    "gear_asymmetry": (
        Law("hoisting_alone", _winch(45.0, load=1.0, side=1.0)),
        Law("lowering_alone", _winch(45.0, load=1.0, side=-1.0)),
        Law("bends_the_frame", _winch(110.0, load=1.0, load0=0.45, signed=1.0), held_out=True),
    ),
    "gear_load_loss": (
        Law("mixed_film", _winch(150.0, load=1.0, fade=110.0)),
        Law("mesh_bends", _winch(160.0, load=1.0, load0=0.4)),
        Law("mesh_settles", _winch(160.0, load=3.0, hill=0.5), held_out=True),
    ),
    "layer_radius": (
        Law("one_layer", lambda s, rng, f: {"radius_step": -0.04 * s}),
        Law("rope_sinks_in", _set(radius_load=0.03), held_out=True),
    ),
    "sheave_bending": (
        Law("stiff_rope", _winch(70.0, load=0.0)),
        Law("leaves_its_groove", _winch(150.0, load=1.0, load0=0.5)),
        Law("finds_its_groove", _winch(130.0, load=3.0, hill=0.4), held_out=True),
    ),
    "wear_drift": (
        Law("saturating", _drift(1.0)), Law("logarithmic", _drift(2.0)), Law("run_in", _drift(0.0, -0.25)),
        Law("at_once", _drift(3.0)), Law("accelerates", _drift(4.0), held_out=True),
    ),
    "low_displacement_loss": (
        Law("quadratic", _motor(40.0, p=1.0, rest=2.0)),
        Law("reads_displacement_alone", _motor(14.0, rest=1.0)),
        Law("above_a_pressure", _motor(40.0, p=1.0, p0=110 * BAR, rest=1.0), held_out=True),
    ),
    "port_turbulence": (
        Law("orifice", _motor(18.0, w=2.0, x=3.0)), Law("one_port", _motor(16.0, w=2.0, x=2.0)),
        Law("chokes", _motor(40.0, w=2.0, w0=60.0, x=1.5), held_out=True),
    ),
    "notch_loss": (
        Law("linear_in_pressure", _motor(14.0, p=1.0, w=0.5, fade=60.0, x=1.0), held_out=True),
        Law("full_displacement", _motor(14.0, p=1.5, w=0.5, fade=60.0), held_out=True),
    ),
    "churning": (
        Law("power_one_half", _motor(4.0, w=1.5)), Law("thick_oil", _motor(4.0, w=1.75, viscosity=0.25)),
        Law("foams", _motor(8.0, w=1.5, w0=70.0), held_out=True),
    ),
    "high_pressure_mixed": (
        Law("cubic", _motor(3.6, p=3.0)), Law("film_builds_up", _motor(14.0, p=2.0, fade=60.0)),
        Law("film_above_a_pressure", _motor(40.0, p=1.0, p0=90 * BAR, fade=60.0)),
        Law("film_breaks_at_a_pressure", _motor(14.0, p=0.3, p0=110 * BAR, fade=90.0), held_out=True),
    ),
    "slip_leakage": (
        Law("cold_and_warm", _leak(1.0, 0.0)), Law("gap_opens", _leak(2.0, 1.0)),
        Law("orifice", _leak(0.5, 0.0)),
        # a relief valve that seeps: three times as steep, and nothing below its pressure
        Law("valve_seeps", lambda s, rng, f: _leak(1.0, 0.0, leakage_from=100 * BAR)(3.0 * s, rng, f), held_out=True),
    ),
    "line_pressure_drop": (
        Law("blasius", _line(1.75)), Law("check_valve", _line(2.0, 1.0)),
        Law("cracking_valve", _line(0.15, 1.0)),
        Law("driving_side", _own_line(1.75, 1.0, 3)), Law("passive_side", _own_line(2.0, -1.0, 8)),
        Law("opens_late", lambda s, rng, f: {**_line(2.0)(s, rng, f), "line_from": 0.35}, held_out=True),
        Law("driving_side_opens_late", _own_line(2.0, 1.0, 3, line_from=0.5), held_out=True),
    ),
    "case_pressure": (
        Law("port_b", _set(case_b=40 * BAR * MAX_DISPLACEMENT / (150 * BAR))),
        Law("small_swivel", _set(case_rest=14 * BAR * MAX_DISPLACEMENT / (150 * BAR)), held_out=True),
    ),
    "accumulator_thermal": (
        Law("cold_bottle", lambda s, rng, f: {"gas_time": rng.uniform(40, 150), "gas_warm": -0.02 * s}),
        Law("other_exponent", _set(gas_power=-0.15)), Law("real_gas", _set(gas_curve=-0.5), held_out=True),
    ),
    "inertia_error": (
        Law("wire_on_drum", _set(inertia_wire=0.16)), Law("oil_column", _set(inertia_oil=0.6), held_out=True),
    ),
    "pressure_offset": (
        Law("port_b", _set(pressure_offset_b=1.5 * BAR)), Law("passive_side", _set(pressure_offset_passive=2.5 * BAR)),
        Law("warm_electronics", _set(pressure_warm=2.5 * BAR)),
        Law("since_a_date", lambda s, rng, f: {
            "pressure_offset": 2.5 * BAR * s, "pressure_after": rng.uniform(0.3, 0.7)}),
        Law("creeps", _set(pressure_drift=4.0 * BAR)),
        Law("settles", _set(pressure_settles=4.0 * BAR), held_out=True),
    ),
    "pressure_scale": (
        Law("passive_side", _set(pressure_scale_passive=0.012)),
        Law("grows_with_pressure", _set(pressure_curve=0.008)),
        Law("bends_at_150_bar", _set(pressure_bend=0.04)),
        Law("s_shaped", _set(pressure_s=0.02), held_out=True),
    ),
    "signal_delay": (
        Law("longer", _set(delay=0.09)), Law("filtered", _set(speed_filter=0.06)),
        Law("some_runs", lambda s, rng, f: {"delay": 0.08 * s, "delay_every": 0.5}),
        Law("fills_up", lambda s, rng, f: {"delay_swing": 0.15 * s, "delay_fills_in": rng.uniform(8.0, 60.0)}),
        Law("drains", _set(delay_drains=0.2)), Law("settles", _set(delay_settles=0.15)),
        Law("wanders", _set(delay_wanders=0.15), held_out=True),
    ),
    "swivel_offset": (
        Law("gain", _set(swivel_gain=0.02)), Law("play", _set(swivel_play=1.5 * CM3_PER_REV)),
        Law("warm_electronics", _set(swivel_warm=1.5 * CM3_PER_REV)),
        Law("mid_stroke", _set(swivel_mid=2.5 * CM3_PER_REV)),
        Law("s_shaped", _set(swivel_s=2.5 * CM3_PER_REV)),
        Law("stops_short", _set(swivel_stop=5.0 * CM3_PER_REV), held_out=True),
    ),
    "entrained_air": (
        Law("more", _set(air=0.02)), Law("little", _set(air=0.005), held_out=True),
    ),
    "torque_ripple": (
        Law("whatever_the_load", _wave(0.0, True)), Law("triangle", _wave(1.0, False)),
        Law("third_harmonic", _wave(2.0, False), held_out=True),
    ),
    "brake_drag": (
        Law("some_runs", lambda s, rng, f: {"brake": 6.0 * s, "brake_every": 0.5}),
        # one that lets go slowly is a friction that fades as the winch warms up: campaign.rig.effects, OUTSIDE
        Law("differs_by_run", _set(brake=6.0, brake_spread=1.0), held_out=True),
    ),
    "tare_load": (
        Law("rope_paid_out", _set(tare_wire=0.4)), Law("hook_and_rope", _set(tare=1500.0, tare_wire=0.25)),
        Law("rope_beyond_the_boom", lambda s, rng, f: {"tare_wire": 0.6 * s, "tare_beyond": 220.0}, held_out=True),
    ),
}  # fmt: skip


def _among(*draws: Draw) -> Draw:
    """One of several ways, evenly."""
    return lambda s, rng, f: draws[int(rng.integers(len(draws)))](s, rng, f)


def _motor_drawn(amount: float, **ranges: tuple[float, float]) -> Draw:
    return lambda s, rng, f: _motor(amount, **{k: float(rng.uniform(*v)) for k, v in ranges.items()})(s, rng, f)


def _winch_drawn(amount: float, fixed: dict[str, float], **ranges: tuple[float, float]) -> Draw:
    return lambda s, rng, f: _winch(amount, **fixed, **{k: float(rng.uniform(*v)) for k, v in ranges.items()})(
        s, rng, f
    )


def _uniform(**ranges: tuple[float, float]) -> Draw:
    return lambda s, rng, f: {name: s * float(rng.uniform(*limits)) for name, limits in ranges.items()}


# one law per cause whose exponents, thresholds and companions are drawn anew for every data set, from what laws of
# that cause look like: how well a cause is known whatever its law, and nothing that a list of laws could be fitted to
DRAWN_LAWS: dict[str, Draw] = {
    "viscosity_temperature": lambda s, rng, f: _oil(
        float(rng.integers(0, 4)), float(rng.uniform(0, 1)), float(rng.uniform(0.6, 1.2))
    )(s, rng, f),
    "stribeck": lambda s, rng, f: _stribeck(float(rng.integers(0, 6)), 0.5, 1.6)(s, rng, f),
    "presliding": lambda s, rng, f: _presliding(float(rng.uniform(5, 12)), float(rng.integers(0, 3)))(s, rng, f),
    "dwell_stiction": lambda s, rng, f: _dwell(float(rng.integers(0, 3)), bool(rng.random() < 0.5))(s, rng, f),
    "gear_asymmetry": _among(
        _winch_drawn(60.0, {"signed": 1.0}, load=(0.6, 1.8)), _winch_drawn(50.0, {"side": 1.0}, load=(0.8, 1.5)),
        _winch_drawn(50.0, {"side": -1.0}, load=(0.8, 1.5)),
    ),
    "gear_load_loss": _among(_winch_drawn(90.0, {}, load=(0.6, 1.8)), _winch_drawn(140.0, {"load": 1.0}, w=(0.1, 0.5))),
    "layer_radius": _uniform(radius_step=(-0.06, -0.02), radius_load=(0.0, 0.02)),
    "sheave_bending": _winch_drawn(100.0, {}, load=(0.5, 1.6), load0=(0.0, 0.2)),
    "wear_drift": lambda s, rng, f: _drift(float(rng.integers(0, 5)), float(rng.uniform(0.25, 0.5)))(s, rng, f),
    "low_displacement_loss": _motor_drawn(40.0, p=(0.3, 1.6), rest=(0.8, 3.0)),
    "port_turbulence": _motor_drawn(22.0, w=(1.4, 2.6), x=(1.2, 3.5)),
    "notch_loss": _motor_drawn(18.0, p=(0.9, 1.9), w=(0.2, 1.0), fade=(35.0, 120.0), x=(0.5, 1.5)),
    "churning": _motor_drawn(4.5, w=(1.4, 2.8), viscosity=(0.0, 0.6)),
    "high_pressure_mixed": _among(
        _motor_drawn(5.0, p=(1.5, 4.0), viscosity=(-0.4, 0.0)),
        _motor_drawn(16.0, p=(0.8, 1.5), p0=(60 * BAR, 130 * BAR)),
    ),
    "slip_leakage": lambda s, rng, f: _leak(float(rng.uniform(0.5, 2.0)), float(rng.uniform(0.0, 1.2)))(s, rng, f),
    "line_pressure_drop": lambda s, rng, f: _line(float(rng.uniform(0.8, 2.4)), float(rng.integers(-1, 2)))(s, rng, f),
    "case_pressure": _uniform(**dict.fromkeys(("case", "case_b", "case_rest"), (0.0, 15 * MAX_DISPLACEMENT / 150))),
    "accumulator_thermal": lambda s, rng, f: {
        "gas_time": rng.uniform(30, 150), "gas_warm": -0.03 * s * rng.uniform(), "gas_power": -0.1 * s * rng.uniform()
    },
    "inertia_error": _uniform(inertia=(0.0, 0.4), inertia_wire=(0.0, 0.16), inertia_oil=(0.0, 0.3)),
    "pressure_offset": _among(
        _uniform(pressure_offset=(1.0 * BAR, 3.0 * BAR), pressure_offset_b=(-1.5 * BAR, 1.5 * BAR)),
        _uniform(pressure_offset=(0.0, 2.0 * BAR), pressure_warm=(1.0 * BAR, 3.0 * BAR)),
        _uniform(pressure_offset=(0.0, 2.0 * BAR), pressure_drift=(1.5 * BAR, 4.0 * BAR)),
    ),
    "pressure_scale": _uniform(pressure_scale=(-0.012, 0.012), pressure_curve=(-0.012, 0.012)),
    "signal_delay": _uniform(delay=(0.02, 0.09), speed_filter=(0.0, 0.06)),
    "swivel_offset": _uniform(
        swivel=(-1.5 * CM3_PER_REV, 1.5 * CM3_PER_REV), swivel_gain=(-0.01, 0.01),
        swivel_mid=(-1.0 * CM3_PER_REV, 1.0 * CM3_PER_REV), swivel_warm=(0.0, CM3_PER_REV),
    ),
    "entrained_air": _uniform(air=(0.003, 0.03)),
    "torque_ripple": lambda s, rng, f: _wave(float(rng.integers(0, 3)), bool(rng.random() < 0.5))(s, rng, f),
    "brake_drag": lambda s, rng, f: {"brake": s * rng.uniform(4, 9), "brake_every": rng.uniform(0.35, 1.0)},
    "tare_load": _uniform(tare=(-800.0, 2500.0), tare_wire=(0.0, 0.5)),
}  # fmt: skip

LAWS: dict[str, tuple[Law, ...]] = {
    cause: (Law("catalogue", draw), *OTHER.get(cause, ()), Law(DRAWN_LAW, DRAWN_LAWS[cause]))
    for cause, draw in CATALOGUE.items()
}


def law_of(effect: str) -> Draw:
    """The law behind `cause`, `cause:law` or the name of an outside effect; an unknown name raises KeyError."""
    if effect in OUTSIDE:
        return OUTSIDE[effect]
    cause, _, name = effect.partition(":")
    laws = {law.name: law.draw for law in LAWS[cause]}
    return laws[name or "catalogue"]


def cause_of(effect: str) -> str:
    """The name that a right diagnosis gives."""
    return effect.partition(":")[0]
