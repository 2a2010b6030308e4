"""Plant, controller and sea in numbers by hand, from crane, plant file and scenario."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.physics.channels import BAR, CM3_PER_REV, GRAVITY
from winch_friction.simulation import load_scenario
from winch_friction.simulation.assembly import (
    control_record,
    passive_displacement,
    plant_record,
    prescribed_motion,
    schedule,
)
from winch_friction.simulation.hidden.catalogue import apply_effects
from winch_friction.simulation.hidden.torque import fixed_torque, group_loss, shaft_loss
from winch_friction.simulation.motion.sea import jonswap_sea, jonswap_spectrum
from winch_friction.simulation.plant import equations, loop
from winch_friction.simulation.plant import state as places
from winch_friction.simulation.plant.integrator import advance_direction, advance_dwell, hermite
from winch_friction.simulation.plant.loop import pressure_difference, scale_viscous, walther_viscosity
from winch_friction.simulation.plant.start import equilibrium
from winch_friction.simulation.plant.state import (
    GAS_T,
    GAS_V,
    P_A,
    P_B,
    STATES,
)  # fmt: skip
from winch_friction.simulation.plant_file import load_plant
from winch_friction.simulation.sensors.channels import channels

WATER = {"volume": 20.0, "height": 4.0, "surface": -3.0, "drag_area": 6.0, "wave_share": 0.5}
D_MAX = 215.0 * CM3_PER_REV


@pytest.fixture(scope="module")
def plant():
    return load_plant("winch_150t")


def plain(function):
    """What is compiled, as Python runs it: nothing is compiled for a test of one number."""
    return function.py_func


# -- records
def test_the_plant_is_what_crane_plant_file_and_scenario_say(ahc, crane, plant):
    more = {"wire_out": 400.0, "wire_layer": 2, "water": WATER, "smooth_sign": 0.3, "start_time": 5.0}
    p = plant_record(ahc.override(more), crane, plant)[0]
    radius = 0.867
    expected = {
        "secondary": 0.0, "count": 3.0, "displacement": D_MAX, "passive_count": 8.0, "max_displacement": D_MAX,
        "passive_displacement": 55e3 * GRAVITY * radius / 250.0 / (8 * 275e5),
        "inertia": 1.54, "metres_per_radian": radius / 250.0, "radius": radius, "mass": 55e3, "reported_mass": 55e3,
        "reported_radius": radius, "wire_stiffness": 3e8 / 400.0, "wire_damping": 1.5e5, "wire_out": 400.0,
        "wire_mass": 0.0, "layer": 2.0, "line_volume": 0.06, "bulk_modulus": 1e9, "air": 0.0, "boost_pressure": 25e5,
        "relief_pressure": 350e5, "valve_gain": 1e-8, "leakage": 5e-12, "case_leakage": 5e-13, "line_resistance": 0.0,
        "pump_flow": 0.0445, "pump_lag": 0.1, "pump_bandwidth": 0.0, "pump_damping": 1.0, "torque_lag": 0.05,
        "torque_limit": 3 * D_MAX * 400e5, "gas_pressure": 300e5, "gas_volume": 1.6, "gas_exponent": 1.2,
        "gas_time": 0.0, "gas_start": 1.0, "passive_low": 25e5, "make_up": 8 * 5e-12 * 275e5,
        "presliding": math.radians(0.2), "direction_width": 0.3, "buoyancy": 20.0 * 1025.0 * GRAVITY,
        "body_height": 4.0, "surface": -3.0, "water_drag": 0.5 * 1025.0 * 6.0, "start_time": 5.0,
        "viscous_reference": 40.0, "calculated_exponent": 0.0, "viscosity_share": 0.0,
    }  # fmt: skip
    assert {name: float(p[name]) for name in p.dtype.names} == pytest.approx(expected, abs=0.0)


def test_what_the_scenario_says_otherwise_goes_before(ahc, cycle, crane, plant):
    p = plant_record(ahc.override({"presliding": 0.01, "mismatch": {"leakage": 3.0, "inertia": 0.5}}), crane, plant)[0]
    assert (p["presliding"], p["leakage"], p["inertia"]) == pytest.approx((0.01, 15e-12, 0.77), abs=0.0)
    q = plant_record(cycle, crane, plant)[0]  # normal mode: one group of all motors
    assert (q["count"], q["passive_count"], q["make_up"]) == (11.0, 0.0, 0.0)
    assert (q["buoyancy"], q["water_drag"], q["body_height"]) == (0.0, 0.0, 1.0)
    assert passive_displacement(cycle, crane, plant) == pytest.approx(D_MAX)
    assert passive_displacement(ahc.override({"load": 145e3}), crane, plant) == pytest.approx(
        min(145e3 * GRAVITY * 1.136 / 250.0 / (8 * 275e5), D_MAX)
    )
    assert passive_displacement(ahc.override({"load": 390e3}), crane, plant) == pytest.approx(D_MAX)  # no more swivels
    assert passive_displacement(ahc.override({"passive_displacement": 1e-5}), crane, plant) == 1e-5


@pytest.mark.parametrize("drive", ["primary", "secondary"])
def test_the_controller_knows_the_nominal_plant(drive, ahc, crane, plant):
    scenario = ahc.override({"drive": drive, "control.lead": 0.02, "control.position_gain": 1.7})
    c = control_record(scenario, crane, plant, plant_record(scenario, crane, plant))[0]
    torque = drive == "secondary"
    static = 55e3 * GRAVITY * 1.136 / 250.0
    expected = {
        "mode": 2.0 if torque else 1.0, "period": 0.01, "drive_displacement": 3 * D_MAX,
        "passive_displacement": static / 275e5, "metres_per_radian": 1.136 / 250.0, "static_torque": static,
        "inertia": 1.54, "leakage": 3 * (5e-12 + 0.25e-12), "compressibility": 0.5 * 0.06 / 1e9, "pump_flow": 0.0445,
        "torque_limit": 3 * D_MAX * 400e5, "drive_lag": 0.05 if torque else 0.1, "position_gain": 1.7,
        "speed_gain": 20.0 if torque else 0.0, "damping": 0.0 if torque else 1e-10,
        "damping_time": 1.0 if torque else 0.5, "jerk_filter": 0.05, "lead": 0.02, "feedforward_ticks": 2.0,
    }  # fmt: skip
    assert {name: float(c[name]) for name in c.dtype.names} == pytest.approx(expected, abs=0.0)


def test_in_normal_mode_the_load_is_accelerated_with_the_winch(cycle, crane, plant):
    c = control_record(cycle, crane, plant, plant_record(cycle, crane, plant))[0]
    lever = crane.drum.radius(cycle.wire_layer) / 250.0
    assert (c["mode"], c["inertia"]) == (0.0, pytest.approx(1.54 + cycle.load * lever**2))


@pytest.mark.parametrize(("bandwidth", "lag"), [(0.0, 0.1), (40.0, 2.0 * 0.7 / 40.0)])
def test_of_a_pump_of_second_order_the_first_order_part_is_inverted(bandwidth, lag, ahc, crane, plant):
    """(s^2 / w^2 + 2 d / w s + 1): what goes with s."""
    other = plant.copy(update={"pump": plant.pump.copy(update={"bandwidth": bandwidth, "damping": 0.7})})
    c = control_record(ahc, crane, other, plant_record(ahc, crane, other))[0]
    assert c["drive_lag"] == pytest.approx(lag)
    asked = ahc.override({"control.drive_lag": 0.3})
    assert control_record(asked, crane, other, plant_record(asked, crane, other))[0]["drive_lag"] == 0.3


# -- what is prescribed
def test_oil_goes_to_its_end_with_its_time_constant(ahc, crane):
    time = np.array([0.0, 30.0, 3000.0])
    warming = ahc.override({"oil_temperature": {"start": 20.0, "end": 50.0, "time_constant": 30.0}})
    found = prescribed_motion(warming, crane, time, 1, 100.0).oil
    np.testing.assert_allclose(found, [20.0, 50.0 - 30.0 / math.e, 50.0])
    steady = ahc.override({"oil_temperature": {"start": 33.0}})
    np.testing.assert_allclose(prescribed_motion(steady, crane, time, 1, 100.0).oil, 33.0)


def test_the_winch_pays_out_what_the_tip_rises_and_the_water_follows_its_share(ahc, crane):
    time = np.arange(0.0, 40.0, 0.01)
    found = prescribed_motion(ahc.override({"water": WATER}), crane, time, 1, 100.0)
    later = time > 20.0
    assert found.tip[later, 0].max() == pytest.approx(1.5, rel=1e-4)
    np.testing.assert_allclose(found.reference[:, :3], -found.tip[:, :3] * 250.0 / 1.136)
    np.testing.assert_allclose(found.reference[:, 3], 0.0)
    np.testing.assert_allclose(found.tip[:, 3], 0.5 * found.tip[:, 0])
    assert not prescribed_motion(ahc, crane, time, 1, 100.0).tip[:, 3].any()
    sea = {"kind": "jonswap", "significant_height": 2.0, "response": 0.6}  # of the crane tip, not of the water
    found = prescribed_motion(ahc.override({"water": WATER, "sea": sea}), crane, time, 1, 100.0)
    np.testing.assert_allclose(found.tip[:, 3], 0.5 / 0.6 * found.tip[:, 0])


def test_shares_of_the_pump_are_of_its_full_speed_and_the_load_goes_with_the_winch(cycle, crane):
    shares = cycle.override(
        {"profile": {"pump_shares": [0.25], "hold": 5.0, "ramp": 1.0, "rest": 2.0}, "wire_layer": 6}
    )
    time = np.arange(0.0, 20.0, 0.01)
    found = prescribed_motion(shares, crane, time, 1, 200.0)
    assert found.reference[:, 1].max() == pytest.approx(50.0)
    np.testing.assert_allclose(found.reference[:, 3], found.reference[:, 0] * 1.136 / 250.0)
    assert not found.tip.any()


def test_what_is_switched_goes_along_the_scenarios_points(cycle, crane, plant):
    half = 0.5 * D_MAX
    switched = cycle.override({
        "displacement": D_MAX,
        "displacement_schedule": [[0.0, D_MAX], [10.0, half]],
        "boost_schedule": [[0.0, 20e5], [10.0, 30e5]],
        "mismatch": {"displacement": 0.9},
    })  # fmt: skip
    p = plant_record(switched, crane, plant)
    found = schedule(switched, np.array([0.0, 5.0, 20.0]), p, control_record(switched, crane, plant, p))
    np.testing.assert_allclose(found[:, 0], 0.9 * D_MAX * np.array([1.0, 0.75, 0.5]))
    np.testing.assert_allclose(found[:, 1], 11 * 0.9 * D_MAX * np.array([1.0, 0.75, 0.5]))
    np.testing.assert_allclose(found[:, 2], [20e5, 25e5, 30e5])


@pytest.mark.parametrize("gamma", [1.0, 3.3, 7.0])
def test_a_jonswap_spectrum_is_pierson_moskowitz_with_a_peak(gamma):
    """Hasselmann et al. 1973: the peak is gamma times as high, and narrower (0.07) below it than above (0.09)."""
    peak = 0.7
    one_sigma = peak * np.array([1.0 - 0.07, 1.0, 1.0 + 0.09])
    shape = jonswap_spectrum(one_sigma, peak, gamma) / jonswap_spectrum(one_sigma, peak, 1.0)
    np.testing.assert_allclose(shape, [gamma**0.606530660, gamma, gamma**0.606530660])
    plain_sea = jonswap_spectrum(np.array([peak, 2.0 * peak]), peak, 1.0)
    np.testing.assert_allclose(plain_sea[1] / plain_sea[0], 2.0**-5 * np.exp(-1.25 / 16.0 + 1.25))
    dense = np.linspace(0.5, 3.0, 5001) * peak
    assert dense[jonswap_spectrum(dense, peak, gamma).argmax()] == pytest.approx(peak, rel=1e-3)


@pytest.mark.parametrize("seed", [1, 2])
def test_a_sea_has_its_significant_height_and_repeats_with_its_seed(seed):
    waves = jonswap_sea(3.0, 8.0, 3.3, seed)
    assert 4.0 * math.sqrt(0.5 * float((waves.amplitudes**2).sum())) == pytest.approx(3.0)
    assert len(waves.frequencies) == 80
    assert (np.diff(waves.frequencies) > 0.0).all()  # one in each band
    assert waves.frequencies.min() >= 0.55 * 2.0 * math.pi / 8.0
    assert waves.frequencies.max() <= 3.0 * 2.0 * math.pi / 8.0
    np.testing.assert_array_equal(waves.phases, jonswap_sea(3.0, 8.0, 3.3, seed).phases)
    assert not np.array_equal(waves.phases, jonswap_sea(3.0, 8.0, 3.3, seed + 5).phases)


# -- the plant's equations
def at(**values):
    state = np.zeros(len(STATES))
    for place, value in values.items():
        state[getattr(places, place)] = value
    return state


def of(**more):
    known = {
        "bulk_modulus": 1e9, "line_volume": 0.06, "air": 0.0, "mass": 1e4, "wire_stiffness": 1e6, "wire_damping": 1e3,
        "metres_per_radian": 0.004, "radius": 1.0, "wire_mass": 0.0, "buoyancy": 0.0, "surface": 0.0,
        "body_height": 2.0, "gas_pressure": 300e5, "gas_volume": 1.6, "calculated_exponent": 0.0, "passive_count": 8.0,
        "passive_displacement": 1e-5, "line_resistance": 100.0, "valve_gain": 1e-8, "boost_pressure": 25e5,
        "relief_pressure": 350e5, "torque_lag": 0.05, "count": 3.0, "displacement": 3e-5, "direction_width": 0.0,
        "secondary": 0.0, "water_drag": 2e3,
    }  # fmt: skip
    return SimpleNamespace(**{**known, **more})


@pytest.mark.parametrize("air", [0.0, 0.01])
@pytest.mark.parametrize("pressure", [5e5, 25e5, 200e5])
def test_the_energy_in_a_line_is_the_work_of_pressing_it_in(air, pressure):
    """dE/dp = p dV/dp."""
    p, step = of(air=air), 1e-4 * pressure
    energy, softness = plain(equations.compression_energy), plain(equations.compressibility)
    rate = (energy(p, pressure + step) - energy(p, pressure - step)) / (2.0 * step)
    assert rate == pytest.approx(pressure * softness(p, pressure), rel=1e-6)


def test_a_line_without_air_is_oil_and_air_at_low_pressure_is_soft():
    softness = plain(equations.compressibility)
    assert softness(of(), 25e5) == pytest.approx(0.06 / 1e9)
    assert softness(of(air=0.01), 1e5) == pytest.approx(0.06 * (1e-9 + 0.01 / 1.4 / 1e5))
    assert softness(of(air=0.01), -1e5) == softness(of(air=0.01), 0.2e5)  # below it air is no softer


def test_a_gas_of_half_the_volume_has_twice_the_pressure():
    state = at(GAS_V=0.8, GAS_T=1.1, ANGLE=-1000.0)
    assert plain(equations.gas_pressure)(of(), state) == pytest.approx(660e5)
    calculated = plain(equations.reported_gas_pressure)(of(calculated_exponent=1.2), state)
    assert calculated == pytest.approx(300e5 * (1.6 / (1.6 - 8 * 1e-5 * 1000.0)) ** 1.2)


def test_a_wire_pulls_by_what_tip_and_drum_take_beyond_the_load_and_never_pushes():
    tension = plain(equations.wire_tension)
    hanging = 1e4 * GRAVITY
    assert tension(of(), at(), 0.0)[:2] == pytest.approx((hanging, hanging))
    state = at(TIP=0.02, ANGLE=5.0, LOAD=0.03, SPEED=50.0, LOAD_SPEED=0.1)
    pull, elastic, rate = tension(of(), state, 0.4)
    assert rate == pytest.approx(0.4 + 0.2 - 0.1)
    assert elastic == pytest.approx(hanging + 1e6 * (0.02 + 0.02 - 0.03))
    assert pull == pytest.approx(elastic + 1e3 * rate)
    assert tension(of(), at(LOAD=1.0), 0.4)[:2] == (0.0, 0.0)


def test_the_drums_torque_is_the_weight_with_its_wire_less_what_the_water_bears():
    torque = plain(equations.drum_torque)
    assert torque(of(radius=0.5), at(), 0.0) == pytest.approx(1e4 * GRAVITY * 0.5)
    wired = torque(of(wire_mass=25.0), at(ANGLE=-1000.0), 0.0)  # 4 m more hang out
    assert wired == pytest.approx((1e4 + 100.0) * GRAVITY)
    assert torque(of(buoyancy=2e4), at(), 0.25) == pytest.approx(1e4 * GRAVITY - 5e3)


@pytest.mark.parametrize(("load", "surface", "share"), [(0.0, 1.0, 0.5), (-5.0, 0.0, 1.0), (5.0, 0.0, 0.0),
                                                        (0.5, 1.0, 0.25), (-0.5, 0.0, 0.25)])  # fmt: skip
def test_a_body_is_under_water_by_how_far_it_is_below(load, surface, share):
    assert plain(equations.submerged_share)(of(buoyancy=1.0), load, surface) == pytest.approx(share)
    assert plain(equations.submerged_share)(of(), load, surface) == 0.0


@pytest.mark.parametrize("speed", [0.5, -0.5])
def test_water_bears_and_drags_against_the_motion(speed):
    found = plain(equations.water_force)(of(buoyancy=2e4), at(LOAD_SPEED=speed), 0.5)
    assert found == pytest.approx(0.5 * (2e4 - np.sign(speed) * 2e3 * 0.25))


@pytest.mark.parametrize(
    ("pressure", "flows"), [(20e5, (5e-3, 0.0)), (25e5, (0.0, 0.0)), (350e5, (0.0, 0.0)), (360e5, (0.0, 0.01))]
)
def test_boost_feeds_below_and_relief_lets_go_above(pressure, flows):
    assert plain(equations.valve_flow)(of(), pressure) == pytest.approx(flows)


def test_a_torque_drive_follows_its_command_with_a_lag_and_shows_its_pressure():
    found = plain(equations.torque_drive)(of(), at(DRIVE=900.0, SPEED=10.0), 1000.0)
    assert found == pytest.approx((900.0 / 9e-5, 0.0, 0.0, 100.0 / 0.05, 0.0, 9000.0, 0.0))


@pytest.mark.parametrize("flow", [0.02, -0.02])
def test_a_line_loses_pressure_with_the_square_of_the_flow_against_it(flow):
    assert plain(equations.line_drop)(of(), flow) == pytest.approx(100.0 * flow * abs(flow))
    by_torque = of(secondary=1.0, line_resistance=1e9)
    speed = flow / 9e-5
    found = plain(pressure_difference)(by_torque, at(DRIVE=900.0, SPEED=speed))
    assert found == pytest.approx(900.0 / 9e-5 + 1e9 * flow * abs(flow))
    assert plain(pressure_difference)(of(), at(P_A=100e5, P_B=30e5)) == pytest.approx(70e5)


@pytest.mark.parametrize("load", [55e3, 5e3])
def test_a_winch_starts_where_its_motors_hold_the_load(load, ahc, cycle, crane, plant):
    for scenario in (ahc.override({"load": load, "passive_displacement": 1e-5}), cycle.override({"load": load})):
        record = plant_record(scenario, crane, plant)
        p = record[0]
        state, memory = equilibrium(record, np.zeros(1))
        active = p["count"] * p["displacement"] * (state[P_A] - state[P_B])
        passive = p["passive_count"] * p["passive_displacement"] * (300e5 - 25e5)
        assert active + passive == pytest.approx(load * GRAVITY * p["metres_per_radian"])
        assert min(state[P_A], state[P_B]) == 25e5
        assert (state[GAS_V], state[GAS_T]) == (1.6, 1.0)
        assert memory.tolist() == [0.0, 1.0]  # no direction, and dwelt for long


@pytest.mark.parametrize(
    ("secondary", "dp", "pressure_sum"), [(0.0, 70e5, 130e5), (1.0, 70e5, 120e5), (1.0, -70e5, 120e5)]
)
def test_the_sum_of_a_loops_pressures_has_the_boost_on_both_sides(secondary, dp, pressure_sum):
    p = of(secondary=secondary, start_time=1e9, layer=3.0, wire_out=50.0)
    state = at(P_A=100e5, P_B=30e5, ANGLE=-500.0, SPEED=-7.0)
    x = plain(equations.operating_point)(p, state, -1.0, 0.5, 2.0, 9e3, 40.0, dp, -200e5, 300e5)
    assert (x.pressure_driven, x.pressure_sum_driven, x.higher_port_driven) == (70e5, pressure_sum, np.sign(dp))
    assert (x.pressure_passive, x.pressure_sum_passive, x.higher_port_passive) == (200e5, 300e5, -1.0)
    assert (x.speed, x.speed_magnitude, x.time, x.wire_out) == (-7.0, 7.0, 1e9 + 2.0, 52.0)
    assert (x.motor_total, x.count_driven, x.count_passive) == (11.0, 3.0, 8.0)
    assert (x.role_driven, x.role_passive) == (1.0, -1.0)
    alone = plain(equations.operating_point)(
        of(secondary=secondary, start_time=1e9, layer=3.0, wire_out=50.0, passive_count=0),
        state,
        -1.0,
        0.5,
        2.0,
        9e3,
        40.0,
        dp,
        0.0,
        0.0,
    )
    assert (alone.role_driven, alone.count_passive) == (0.0, 0.0)
    assert (x.displacement_driven, x.displacement_passive, x.drum_torque) == (3e-5, 1e-5, 9e3)


# -- memory between the steps
@pytest.mark.parametrize("speed", [3.0, -3.0])
def test_a_bristle_bends_over_its_angle_and_stays_bent_at_rest(speed):
    bent = plain(advance_direction)(0.0, speed, 0.6, 0.2)
    assert bent == pytest.approx(np.sign(speed) * (1.0 - math.exp(-1.0)))
    assert plain(advance_direction)(bent, 0.0, 0.6, 0.2) == bent
    halves = plain(advance_direction)(plain(advance_direction)(0.0, speed, 0.6, 0.1), speed, 0.6, 0.1)
    assert halves == pytest.approx(bent)


def test_a_bond_grows_with_dwell_and_breaks_by_slip():
    hidden = SimpleNamespace(dwell_share=0.15, dwell_rate=0.2, dwell_angle=1.0)
    assert plain(advance_dwell)(0.0, 0.0, hidden, 5.0) == pytest.approx(1.0 - math.exp(-1.0))
    assert plain(advance_dwell)(1.0, 1.8, hidden, 100.0) == pytest.approx(0.1)
    assert plain(advance_dwell)(1.0, -1.8, hidden, 100.0) == pytest.approx(0.1)


def test_a_cubic_through_two_ends_is_the_cubic():
    cubic = np.polynomial.Polynomial([1.0, -2.0, 3.0, 4.0])
    slope, end = cubic.deriv(), 0.5
    for fraction in (0.0, 0.3, 1.0):
        found = plain(hermite)(fraction, end, cubic(0.0), slope(0.0), cubic(end), slope(end))
        assert found == pytest.approx(cubic(fraction * end))


# -- oil
def test_oil_is_as_thick_as_vg_46_oil_is():
    """ISO VG 46: 46 cSt at 40 degC; the two points that the law goes through."""
    found = [plain(walther_viscosity)(celsius) for celsius in (20.0, 40.0, 60.0)]
    assert found == pytest.approx([134.0, 46.0, 21.0], rel=0.03)


def test_cold_oil_makes_viscous_terms_larger_by_its_share(monkeypatch):
    monkeypatch.setattr(loop, "walther_viscosity", plain(walther_viscosity))
    theta, nominal = np.zeros(2), np.array([10.0, 10.0])
    for share, ratio in ((1.0, 134.0 / 21.0), (0.5, 0.5 + 0.5 * 134.0 / 21.0)):
        p = SimpleNamespace(viscosity_share=share, viscous_reference=60.0)
        plain(scale_viscous)(p, nominal, np.array([True, False]), theta, 20.0)
        assert theta == pytest.approx([10.0 * ratio, 10.0], rel=0.01)


# -- hidden effects, by the sizes that their words say
def hidden(crane, name, size=1.0, scenario="ahc_55t_215"):
    """Plant and sensors with an effect, and its torques."""
    found = load_scenario(scenario)
    record, sensors = plant_record(found, crane, load_plant("winch_150t")), channels(found)
    torque = apply_effects({name: size}, record, sensors, crane.drum.layer_radii)[0]
    fields = SimpleNamespace(**{field: float(torque[field]) for field in torque.dtype.names})
    return record[0], fields, dict(zip(sensors.names, sensors.settings, strict=True))


LOAD_TORQUE = 55e3 * GRAVITY * 1.136  # N m at the drum


@pytest.mark.parametrize(
    ("name", "size", "torque"),
    [
        ("stribeck", 1.0, 111.0 / 11 * math.exp(-1.0)),
        ("gear_load_loss", 1.0, 0.045 * LOAD_TORQUE / 250.0),
        ("gear_load_loss", -2.0, -0.09 * LOAD_TORQUE / 250.0),
        ("sheave_bending", 1.0, 0.03 * 1000.0),
        ("brake_drag", 2.0, 6.0 * 1),
        ("wear_drift", 1.0, 4.0 * 3),
    ],
)
def test_what_a_shaft_loses_is_of_the_size_that_is_said(name, size, torque, crane):
    """One motor at 229 rpm, 1000 N m of the wire's tension at the shaft, three months after the wear began."""
    _, fields, _ = hidden(crane, name, size)
    w = 24.0
    found = plain(shaft_loss)(fields, 1.0, w, LOAD_TORQUE, 250.0, 1000.0, fields.wear_epoch + 3.0 * 2_592_000.0)
    assert found == pytest.approx(torque, rel=5e-3 if name == "stribeck" else 1e-6)
    assert plain(shaft_loss)(SimpleNamespace(**{**vars(fields), "brake": 0.0}), 1.0, 1e6, 0.0, 250.0, 0.0, 0.0) == 0.0


@pytest.mark.parametrize(
    ("name", "at_point", "torque"),
    [
        ("low_displacement_loss", (100 * BAR, 0.0, 145.0, 0.0), 0.3256 * 27.4),
        ("port_turbulence", (0.0, 0.0, 215.0, 209.0), 0.22 * 64.9),
        ("port_turbulence", (0.0, 0.0, 107.5, 104.5), 0.22 * 64.9 * 0.5**2.4 * 0.5**3.4),
        ("notch_loss", (200 * BAR, 0.0, 215.0, 42.0), 6.0),
        ("notch_loss", (200 * BAR, 0.0, 107.5, 42.0), 3.0),
        ("churning", (0.0, 0.0, 100.0, 209.0), 3.0),
        ("churning", (0.0, 0.0, 100.0, 104.5), 3.0 * 0.5**1.9),
        ("high_pressure_mixed", (350 * BAR, 0.0, 100.0, 10.0), 14.0),
        ("high_pressure_mixed", (175 * BAR, 0.0, 100.0, 10.0), 3.5),
        ("case_pressure", (0.0, 180 * BAR, 100.0, 10.0), 5 * BAR * 34.2e-6),
    ],
)
def test_what_a_motor_loses_is_of_the_size_that_is_said(name, at_point, torque, crane):
    """Two motors at p, p_A + p_B, cm^3/rev and rad/s."""
    _, fields, _ = hidden(crane, name)
    pressure, pressure_sum, displacement, speed = at_point
    found = plain(group_loss)(fields, 2.0, pressure, pressure_sum, displacement * CM3_PER_REV, D_MAX, speed)
    assert found == pytest.approx(2.0 * torque, rel=0.02)


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_an_asymmetry_does_not_turn_with_the_motion_and_a_ripple_turns_with_the_shaft(direction, crane):
    _, fields, _ = hidden(crane, "gear_asymmetry")
    assert plain(fixed_torque)(fields, direction, 0.7, LOAD_TORQUE, 250.0) == pytest.approx(0.003 * LOAD_TORQUE / 250.0)
    _, fields, _ = hidden(crane, "torque_ripple")
    found = [plain(fixed_torque)(fields, direction, angle, LOAD_TORQUE, 250.0) for angle in (0.5, 0.5 + 2.0 * math.pi)]
    assert found == pytest.approx([0.01 * math.sin(0.5) * LOAD_TORQUE / 250.0] * 2)


def test_a_bond_is_as_strong_as_is_said(crane):
    _, fields, _ = hidden(crane, "dwell_stiction", 2.0)
    found = {name: value for name, value in vars(fields).items() if value}
    assert found == pytest.approx({"present": 1.0, "dwell_share": 0.3, "dwell_rate": 0.2, "dwell_angle": 1.0})


def test_what_changes_the_plant_is_of_the_size_that_is_said(crane):
    def changed(name, *fields, size=1.0):
        p, _, _ = hidden(crane, name, size)
        return tuple(float(p[field]) for field in fields)

    assert changed("presliding", "presliding") == pytest.approx((math.radians(0.2 + 2.0),))
    assert changed("layer_radius", "radius", "metres_per_radian") == pytest.approx((1.069, 1.069 / 250.0))
    assert changed("layer_radius", "radius", size=-0.5) == pytest.approx((1.136 + 0.5 * 0.067,))
    assert changed("slip_leakage", "leakage") == pytest.approx((5e-12 + 1.4e-11,), abs=0.0)
    assert changed("line_pressure_drop", "line_resistance")[0] * (1290e-3 / 60.0) ** 2 == pytest.approx(3.5e5)
    assert changed("accumulator_thermal", "calculated_exponent", "gas_exponent", "gas_time", "gas_start") == (
        pytest.approx((1.2, 1.4, 60.0, 1.02))
    )
    assert changed("accumulator_thermal", "gas_exponent", "gas_start", size=0.5) == pytest.approx((1.3, 1.01))
    assert changed("accumulator_thermal", "gas_exponent", "gas_start", size=3.0) == pytest.approx((1.4, 1.06))
    assert changed("inertia_error", "inertia", size=-2.0) == pytest.approx((1.54 * 0.8,))
    assert changed("entrained_air", "air") == pytest.approx((0.01,))
    wire = float(load_scenario("ahc_55t_215").wire_out)
    assert changed("tare_load", "mass", "wire_mass") == pytest.approx((55e3 + 800.0 + 24.5 * wire, 24.5))
    assert changed("viscosity_temperature", "viscosity_share", size=0.5) == (0.5,)


@pytest.mark.parametrize(
    ("name", "field", "change", "sensors"),
    [
        ("pressure_offset", "offset", 1.5 * BAR, ("active.pressure_a",)),
        ("pressure_scale", "scale", 0.005, ("active.pressure_a", "active.pressure_b")),
        ("signal_delay", "delay", 0.05, ("motor_speed", "shaft_angle")),
        ("swivel_offset", "offset", CM3_PER_REV, ("active.displacement",)),
    ],
)
def test_a_sensor_errs_as_is_said_and_no_other_does(name, field, change, sensors, crane):
    _, _, before = hidden(crane, name, 0.0)
    _, _, after = hidden(crane, name, 2.0)
    differ = {channel: float(after[channel][field] - before[channel][field]) for channel in before}
    assert {channel: each for channel, each in differ.items() if each} == pytest.approx(
        dict.fromkeys(sensors, 2 * change)
    )
