"""One evaluation of the plant, one step and one period in numbers by hand; Python runs what is compiled elsewhere."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.physics.channels import GRAVITY
from winch_friction.simulation.plant import equations, integrator, loop, start
from winch_friction.simulation.plant import state as places
from winch_friction.simulation.plant.friction_kernel import Terms
from winch_friction.simulation.plant.parameters import PLANT, PLANT_FIELDS, record
from winch_friction.simulation.plant.point import POINT_LENGTH, X_ACCELERATION, Point
from winch_friction.simulation.plant.state import ROW, STATES, State

FRICTION = 310.0  # N m of the model


@pytest.fixture(autouse=True)
def interpreted(monkeypatch):
    """All that is compiled as Python has it: numba takes seconds, one evaluation microseconds."""
    for module in (equations, integrator, loop, start):
        for name, each in list(vars(module).items()):
            if hasattr(each, "py_func"):
                monkeypatch.setattr(module, name, each.py_func)
    monkeypatch.setattr(equations, "friction_torque", lambda address, x, theta, z: FRICTION)
    monkeypatch.setattr(integrator, "tuple_of", lambda array, count: tuple(array[:count].tolist()))


def at(**values):
    state = np.zeros(len(STATES))
    for place, value in values.items():
        state[getattr(places, place)] = value
    return state


def winch(**more):
    """A plant in which no two numbers that could be taken for each other are alike."""
    known = {
        **dict.fromkeys(PLANT_FIELDS, 0.0),
        "count": 3.0, "displacement": 3e-5, "passive_count": 8.0, "passive_displacement": 1e-5,
        "max_displacement": 3.4e-5, "inertia": 2.5, "metres_per_radian": 0.004, "radius": 1.2, "mass": 1e4,
        "reported_mass": 9e3, "wire_stiffness": 1e6, "wire_damping": 1e3, "wire_out": 50.0, "wire_mass": 20.0,
        "layer": 4.0, "line_volume": 0.06, "bulk_modulus": 1e9, "boost_pressure": 25e5, "relief_pressure": 90e5,
        "valve_gain": 1e-8, "leakage": 1e-11, "case_leakage": 2e-12, "line_resistance": 1e9, "pump_lag": 0.1,
        "pump_damping": 0.7, "torque_lag": 0.05, "gas_pressure": 300e5, "gas_volume": 1.6, "gas_exponent": 1.2,
        "gas_time": 60.0, "gas_start": 1.02, "passive_low": 24e5, "make_up": 3e-3, "presliding": 0.01,
        "body_height": 2.0, "water_drag": 2e3, "start_time": 1e9, "viscous_reference": 40.0,
    }  # fmt: skip
    return SimpleNamespace(**{**known, **more})


TURNING = {"SPEED": 50.0, "P_A": 100e5, "P_B": 20e5, "DRIVE": 0.02, "DRIVE_RATE": 0.3, "GAS_V": 1.5, "GAS_T": 1.05,
           "ANGLE": -100.0, "TIP": 0.3, "LOAD": -0.15, "LOAD_SPEED": 0.3}  # fmt: skip


# -- the parts
def test_what_flows_into_a_line_is_the_pumps_less_motors_leaks_and_relief():
    """Motors 4.5e-3, across 2.4e-4, cases 6e-5 and 1.2e-5, boost 5e-3 into B, relief 1e-2 out of A; m^3/s."""
    dp, rate_a, rate_b, drive, pull, power, lost = equations.closed_loop(winch(), at(**TURNING), 0.05)
    into_a, into_b = 0.02 - 4.5e-3 - 2.4e-4 - 6e-5 - 1e-2, -0.02 + 4.5e-3 + 2.4e-4 - 1.2e-5 + 5e-3
    assert (rate_a, rate_b) == pytest.approx((into_a / 6e-11, into_b / 6e-11))
    assert dp == pytest.approx(80e5 - 1e9 * 4.5e-3**2)
    assert (drive, pull) == pytest.approx((0.3, 0.0))
    assert power == pytest.approx(0.02 * 80e5 + 5e-3 * 25e5)
    assert power - lost == pytest.approx(100e5 * into_a + 20e5 * into_b + dp * 4.5e-3)  # stored, and at the shaft


def test_a_pump_of_second_order_swings_as_its_damping_says():
    found = equations.closed_loop(winch(pump_bandwidth=40.0), at(**TURNING), 0.05)
    assert found[3:5] == pytest.approx((0.3, 1600.0 * 0.03 - 2.0 * 0.7 * 40.0 * 0.3))


@pytest.mark.parametrize("speed", [50.0, -50.0])
def test_passive_motors_press_with_their_gas_less_the_line(speed):
    p, state = winch(line_resistance=1e10), at(**TURNING | {"SPEED": speed})
    torque, dp, both, volume, warming, power, lost = equations.passive_side(p, state)
    pressure, flow = 300e5 * 1.6 / 1.5 * 1.05, 8e-5 * speed
    net = pressure - 24e5
    drop = 1e10 * flow * abs(flow)
    assert (dp, torque, both) == pytest.approx((net - drop, 8e-5 * (net - drop), pressure + 24e5))
    assert volume == pytest.approx(flow + 8e-11 * net - 3e-3)
    heat = -0.05 / 60.0
    assert warming == pytest.approx(-0.2 * 1.05 * volume / 1.5 + heat)
    stored = 300e5 * 1.6 / 0.2 * warming
    assert power - lost == pytest.approx(stored + torque * speed)
    assert power == pytest.approx(3e-3 * net - 24e5 * volume)
    assert equations.passive_side(winch(passive_count=0.0), state) == (0.0,) * 7
    assert equations.passive_side(winch(gas_time=0.0), state)[4] == pytest.approx(-0.2 * 1.05 * volume / 1.5)


@pytest.mark.parametrize("secondary", [0.0, 1.0])
def test_what_is_stored_is_in_motion_height_wire_oil_and_gas(secondary):
    p, state = winch(secondary=secondary), at(**TURNING)
    stretch = 1e4 * GRAVITY / 1e6 + 0.3 - 0.4 + 0.15
    expected = 1.25 * 50.0**2 + 5e3 * 0.09 - 1e4 * GRAVITY * 0.15 + 0.5e6 * stretch**2 + 300e5 * 1.6 / 0.2 * 1.05
    oil = 0.03 / 1e9 * (100e5**2 + 20e5**2)
    assert equations.stored_energy(p, state) == pytest.approx(expected + (0.0 if secondary else oil))
    bare = equations.stored_energy(winch(secondary=secondary, passive_count=0.0), state)
    assert equations.stored_energy(p, state) - bare == pytest.approx(300e5 * 1.6 / 0.2 * 1.05)
    slack = at(**TURNING | {"LOAD": 1.0})
    assert equations.stored_energy(winch(wire_stiffness=2e6), slack) == pytest.approx(
        equations.stored_energy(winch(), slack)
    )


def test_a_smooth_direction_stands_in_place_of_the_bristle():
    assert equations.motion_direction(winch(), 0.3, -5.0) == 0.3
    assert equations.motion_direction(winch(direction_width=2.0), 0.3, -1.0) == pytest.approx(-math.tanh(0.5))


# -- friction that the model does not know
def test_each_hidden_loss_is_given_its_own_part_of_the_winch(monkeypatch):
    given = {"group": []}

    def shaft(*arguments):
        given["shaft"] = arguments
        return 7.0

    def group(*arguments):
        given["group"].append(arguments)
        return 11.0 * len(given["group"])

    def fixed(*arguments):
        given["fixed"] = arguments
        return 1.5

    for name, stub in (("shaft_loss", shaft), ("group_loss", group), ("fixed_torque", fixed)):
        monkeypatch.setattr(equations, name, stub)
    hidden = SimpleNamespace(dwell_share=0.15, present=1.0)
    x = Point(*(float(k) for k in range(1, POINT_LENGTH + 1)))._replace(direction=-1.0)
    found = equations.hidden_torque(winch(), hidden, x, 0.5, 200.0, 9e4)
    assert found == pytest.approx(-(7.0 + 11.0 + 22.0) + 200.0 * 0.15 * 0.5 + 1.5)
    gear = 1.2 / 0.004
    assert given["shaft"] == (hidden, x.motor_total, x.speed_magnitude, x.drum_torque, pytest.approx(gear),
                              pytest.approx(360.0), x.time)  # fmt: skip
    assert given["fixed"] == (hidden, -1.0, x.shaft_angle, x.drum_torque, pytest.approx(gear))
    assert given["group"] == [
        (hidden, x.count_driven, x.pressure_driven, x.pressure_sum_driven, x.displacement_driven, 3.4e-5,
         x.speed_magnitude),
        (hidden, x.count_passive, x.pressure_passive, x.pressure_sum_passive, x.displacement_passive, 3.4e-5,
         x.speed_magnitude),
    ]  # fmt: skip
    terms = Terms(0, 0, 0, 0, 0)
    assert equations.total_friction(winch(), hidden, terms, x, 0.5, 9e4) == pytest.approx(
        FRICTION - 11.0 * (3 + 4) - 7.0 + FRICTION * 0.075 + 1.5
    )
    assert equations.total_friction(winch(), SimpleNamespace(present=0.0), terms, x, 0.5, 9e4) == FRICTION


# -- all together
def rates_of(p, state, heave=0.4, surface=0.0):
    terms, hidden = Terms(0, 0, 0, 0, 0), SimpleNamespace(present=0.0)
    return equations.rates(p, hidden, terms, 0.8, 0.5, 3.0, state, 2.0, 0.05, heave, surface, 41.0)


@pytest.mark.parametrize("secondary", [0.0, 1.0])
@pytest.mark.parametrize("buoyancy", [0.0, 3e4])
def test_every_torque_and_force_acts_its_own_way(secondary, buoyancy):
    p, state = winch(secondary=secondary, buoyancy=buoyancy, surface=0.85), at(**TURNING)
    slope, x, friction, tension, drum = rates_of(p, state)
    drive = equations.torque_drive(p, state, 0.05) if secondary else equations.closed_loop(p, state, 0.05)
    passive = equations.passive_side(p, state)
    stretch, opens = 1e4 * GRAVITY / 1e6 + 0.3 - 0.4 + 0.15, 0.4 + 0.2 - 0.3
    assert tension == pytest.approx(1e6 * stretch + 1e3 * opens)
    share = 0.5 if buoyancy else 0.0  # (0.85 + 0.15) m of 2 m
    hangs = 20.0 * 0.4 * GRAVITY  # 0.4 m of wire more than at the start
    assert drum == pytest.approx((1e4 * GRAVITY + hangs - share * buoyancy) * 1.2)
    torque = 9e-5 * drive[0] + passive[0] - (tension + hangs) * 0.004 - FRICTION
    water = share * (buoyancy - 2e3 * 0.09)
    named = slope._asdict()
    lost = named.pop("energy_lost")
    assert named == pytest.approx({
        "shaft_angle": 50.0, "shaft_speed": torque / 2.5, "tip": 0.4, "load": 0.3,
        "load_speed": (tension + water) / 1e4 - GRAVITY, "pressure_a": drive[1], "pressure_b": drive[2],
        "drive": drive[3], "drive_rate": drive[4], "gas_volume": passive[3], "gas_temperature": passive[4],
        "energy_in": drive[5] + passive[5], "energy_heave": tension * 0.4, "energy_friction": FRICTION * 50.0,
    })  # fmt: skip
    damped = 1e3 * opens**2
    assert lost == pytest.approx(drive[6] + passive[6] + damped - water * 0.3 + hangs * 0.004 * 50.0)
    assert friction == FRICTION
    assert (x.direction, x.acceleration, x.oil_temperature, x.time) == (0.8, 3.0, 41.0, 1e9 + 2.0)
    assert (x.shaft_angle, x.wire_layer, x.wire_out) == pytest.approx((-100.0, 4.0, 50.4))
    assert (x.pressure_driven, x.pressure_passive) == pytest.approx((abs(drive[0]), passive[1]))
    assert x.pressure_sum_passive == pytest.approx(passive[2])


@pytest.mark.parametrize("secondary", [0.0, 1.0])
def test_energy_is_balanced_at_any_instant(secondary):
    """d(stored)/dt = in + heave - friction - lost, by a small step along the rates."""
    p, state, step = winch(secondary=secondary, buoyancy=3e4, surface=0.85, wire_mass=0.0), at(**TURNING), 1e-7
    slope = rates_of(p, state)[0]
    moved = [np.array(state) + sign * step * np.array(slope) for sign in (1.0, -1.0)]
    stored = (equations.stored_energy(p, moved[0]) - equations.stored_energy(p, moved[1])) / (2.0 * step)
    taken = slope.energy_in + slope.energy_heave - slope.energy_friction - slope.energy_lost
    assert stored == pytest.approx(taken, rel=1e-5)


# -- what is sensed and recorded
def sensed(p, state, step=0.5, spread=1e4, before=-98.0):
    measured = np.array([before, 9.0, 9.0, 9.0])
    loop.sense(p, np.array([step, spread, 0.01]), state, measured, np.array([2.0, -3.0]))
    return measured


def test_an_encoder_counts_to_the_nearest_and_each_pressure_has_its_own_noise():
    state = at(**TURNING | {"ANGLE": -100.2})
    gas = 300e5 * 1.6 / 1.5 * 1.05
    assert sensed(winch(), state) == pytest.approx([-100.0, -200.0, 80e5 + 2e4, gas - 24e5 - 3e4])
    assert sensed(winch(), at(**TURNING | {"ANGLE": -100.3}))[0] == -100.5
    assert sensed(winch(), state, step=0.0)[:2] == pytest.approx([-100.2, 50.0])
    assert sensed(winch(passive_count=0.0), state)[3] == 0.0
    assert sensed(winch(passive_count=1.0), state)[3] == pytest.approx(gas - 24e5 - 3e4)  # whatever takes it


@pytest.mark.parametrize(("secondary", "torque"), [(0.0, 0.0), (1.0, 900.0), (1.0, -900.0)])
def test_a_period_is_recorded_as_it_was(secondary, torque):
    p = winch(secondary=secondary, calculated_exponent=1.3, line_resistance=0.0)
    state = at(**TURNING | {"DRIVE": torque or 0.02, "E_IN": 1.0, "E_HEAVE": 2.0, "E_FRICTION": 3.0, "E_LOST": 4.0})
    row = np.zeros(1, ROW).view(np.recarray)
    loop.record_row(p, row[0], state, np.array([-0.7, 0.2]), np.array([0.31, 0.4, 0.5, 0.6]),
                    np.array([-99.0, 51.0, 2.0, -0.2]), 310.0, 9e4, 1.2e5)  # fmt: skip
    found = {name: float(row[0][name]) for name in ROW.names}
    dp = torque / 9e-5
    ports = (25e5 + max(dp, 0.0), 25e5 + max(-dp, 0.0)) if secondary else (100e5, 20e5)
    assert found == pytest.approx({
        "time": 0.0, "acceleration": 0.0, "command": 0.0, "oil_temperature": 0.0, "friction_feedforward": 0.0,
        "shaft_angle": -100.0, "motor_speed": 50.0, "pressure_a": ports[0], "pressure_b": ports[1],
        "displacement": 3e-5, "passive_pressure_a": 300e5 * 1.6 / 1.5 * 1.05, "passive_pressure_b": 24e5,
        "passive_displacement": 1e-5, "passive_reported": 300e5 * (1.6 / (1.6 - 8e-5 * 100.0)) ** 1.3,
        "friction_torque": 310.0, "position_error": -0.15 + 0.2, "heave": 0.3, "heave_velocity": 0.4,
        "speed_reference": 51.0, "drum_torque": 1.2e5,
        "hook_load": 1.2e5 / (GRAVITY * 1.2) - (1e4 + 20.0 * 0.4 - 9e3), "wire_out": 50.4, "tension": 9e4,
        "direction": -0.7, "energy_in": 1.0, "energy_heave": 2.0, "energy_friction": 3.0, "energy_lost": 4.0,
        "energy_stored": equations.stored_energy(p, state),
    })  # fmt: skip


def test_without_passive_motors_no_pressure_of_theirs_is_recorded():
    row = np.zeros(1, ROW).view(np.recarray)
    loop.record_row(winch(passive_count=0.0), row[0], at(**TURNING), np.zeros(2), np.zeros(4), np.zeros(4), 0, 0, 0)
    assert (row[0].passive_pressure_a, row[0].passive_reported) == (0.0, 0.0)


@pytest.mark.parametrize("secondary", [0.0, 1.0])
def test_at_the_start_the_drive_holds_what_the_passive_side_does_not(secondary, monkeypatch):
    plant = record(PLANT, **vars(winch(secondary=secondary)))
    state, memory = start.equilibrium(plant, np.zeros(1))
    asked = 1e4 * GRAVITY * 0.004 - 8e-5 * (300e5 * 1.02 - 24e5)
    assert state[places.DRIVE] == pytest.approx(asked if secondary else 0.0)
    assert (state[places.P_A], state[places.P_B]) == pytest.approx((25e5, 25e5 - asked / 9e-5))
    assert (state[places.GAS_T], memory.tolist()) == (1.02, [0.0, 1.0])
    given = []
    monkeypatch.setattr(start, "record_row", lambda p, row, *rest: given.extend(rest))
    history = np.zeros((2, len(places.COLUMNS)))
    motion = SimpleNamespace(tip=np.array([[0.1, 0.2], [9.0, 9.0]]), reference=np.array([[1.0, 2.0], [9.0, 9.0]]),
                             oil=np.array([30.0, 50.0]))  # fmt: skip
    start.first_row(plant, state, motion, history)
    assert given[0] is state
    assert [each.tolist() for each in given[1:4]] == [[0.0, 0.0], [0.1, 0.2], [1.0, 2.0]]
    assert given[4:] == pytest.approx([0.0, 1e4 * GRAVITY, 1e4 * GRAVITY * 1.2])
    assert np.flatnonzero(history).tolist() == [places.COLUMNS.index("oil_temperature")]
    assert history.max() == 30.0


# -- between two ticks
def integrate(monkeypatch, rates, state, substeps=4, z=(), term_rates=0, hidden=None, **plant):
    """One period of 0.2 s from 7 s on; what each stage was given, and what came of it."""
    given = []

    def stage(p, hidden, terms, direction, bond, acceleration, trial, time, command, heave, surface, oil):
        given.append((direction, bond, acceleration, trial, time, command, heave, surface, oil))
        slope = State(**{**dict.fromkeys(STATES, 0.0), **rates(trial, time)})
        return slope, Point(*(float(len(given)) + k for k in range(POINT_LENGTH))), *(len(given) + np.arange(3) / 10)

    monkeypatch.setattr(integrator, "rates", stage)
    memory, x, z = np.array([0.5, 0.25]), np.arange(POINT_LENGTH, dtype=float), np.array(z, float)
    gains = np.zeros(2 * len(z))
    x[X_ACCELERATION] = 2.5
    found = integrator.integrate_period(
        winch(**plant), hidden or SimpleNamespace(dwell_share=0.0), Terms(0, term_rates, 0, z, gains), z,
        gains, memory, x, state, np.zeros((5, len(STATES))), 7.0, 0.05,
        np.array([[1.0, 2.0, 10.0], [3.0, -1.0, 14.0]]), substeps, 0.2, 41.0,
    )  # fmt: skip
    return given, found, memory, x, z


def test_a_period_is_stepped_by_the_classical_method(monkeypatch):
    """d omega/dt = -3 omega + t: of fourth order, and exact for a cubic in time."""
    exact = lambda t: (50.0 - (7.0 / 3.0 - 1.0 / 9.0)) * math.exp(-3.0 * (t - 7.0)) + t / 3.0 - 1.0 / 9.0
    errors = []
    for substeps in (2, 4):
        state = at(SPEED=50.0)
        integrate(monkeypatch, lambda s, t: {"shaft_speed": -3.0 * s[places.SPEED] + t}, state, substeps)
        errors.append(abs(state[places.SPEED] - exact(7.2)))
    assert errors[0] < 2e-3
    assert 12.0 < errors[0] / errors[1] < 22.0
    state = at(LOAD=1.0)
    integrate(monkeypatch, lambda s, t: {"load": (t - 7.0) ** 3}, state, 1)
    assert state[places.LOAD] == pytest.approx(1.0 + 0.2**4 / 4.0)


def test_each_stage_is_given_its_own_instant_and_all_of_a_step_one_memory(monkeypatch):
    state = at(SPEED=5.0)
    given, found, memory, x, _ = integrate(
        monkeypatch, lambda s, t: {"shaft_speed": 10.0 * t}, state, 2,
        hidden=SimpleNamespace(dwell_share=0.15, dwell_rate=0.2, dwell_angle=1.0),
    )  # fmt: skip
    directions, bonds, accelerations, _, times, commands, heaves, surfaces, oils = map(list, zip(*given, strict=True))
    assert times == pytest.approx([7.0, 7.05, 7.05, 7.1, 7.1, 7.15, 7.15, 7.2])
    assert surfaces == pytest.approx([10.0, 11.0, 11.0, 12.0, 12.0, 13.0, 13.0, 14.0])
    assert heaves == pytest.approx([integrator.hermite((t - 7.0) / 0.2, 0.2, 1.0, 2.0, 3.0, -1.0) for t in times])
    assert (set(commands), set(oils)) == ({0.05}, {41.0})
    assert accelerations == pytest.approx([2.5] * 4 + [71.0] * 4)  # the last stage's of the step before
    first = integrator.advance_direction(0.5, 5.0, 0.01, 0.1)
    second = integrator.advance_direction(first, 5.0 + 0.1 * 70.5, 0.01, 0.1)
    assert directions == pytest.approx([first] * 4 + [second] * 4)
    assert bonds[0] == pytest.approx(integrator.advance_dwell(0.25, 5.0, SimpleNamespace(
        dwell_share=0.15, dwell_rate=0.2, dwell_angle=1.0), 0.1))  # fmt: skip
    assert memory == pytest.approx([second, bonds[-1]])
    assert found == pytest.approx((8.0, 8.1, 8.2, 72.0))
    assert x[X_ACCELERATION] == pytest.approx(72.0)
    others = np.delete(np.arange(POINT_LENGTH), X_ACCELERATION)
    assert x[others] == pytest.approx(8.0 + others)
    smooth = integrate(monkeypatch, lambda s, t: {}, at(SPEED=5.0), 1, direction_width=0.3)
    assert (smooth[0][0][0], smooth[2][0]) == (0.5, 0.5)  # no bristle: its memory stays


def test_a_terms_memory_goes_to_gain_over_decay_by_the_whole_of_each_step(monkeypatch):
    seen = []

    def term(address, x, theta, z, gains):
        seen.append((address, x.direction))
        gains[:] = [6.0, 3.0, 0.5, 0.0]

    monkeypatch.setattr(integrator, "friction_state_rates", term)
    *_, z = integrate(monkeypatch, lambda s, t: {}, at(), 4, z=(1.0, 1.0), term_rates=77)
    assert z == pytest.approx([2.0 - math.exp(-0.6), 1.0 + 0.5 * 0.2])
    assert seen == [(77, at) for at in (0.0, 4.0, 8.0, 12.0)]  # where the last stage stood


def test_a_period_takes_what_is_switched_and_prescribed_at_its_own_tick(monkeypatch):
    given = []

    def integrated(p, hidden, terms, z, gains, memory, x, state, stages, time, command, heave, substeps, period, oil):
        given.append((p.displacement, p.boost_pressure, time, command, heave.tolist(), substeps, period, oil))
        state[places.ANGLE] += 1.0
        return 300.0 + len(given), 9e4, 1.2e5, 3.0

    def controlled(c, memory, reference, measured, feedforward):
        return c.drive_displacement + reference[1] + feedforward + 1000.0 * measured[places.READ_ANGLE]

    monkeypatch.setattr(loop, "integrate_period", integrated)
    monkeypatch.setattr(loop, "control", controlled)
    p, c = winch(), SimpleNamespace(period=0.01, drive_displacement=0.0)
    ticks = np.arange(6.0)
    motion = np.column_stack([100 * k + ticks for k in range(1, 5)])
    reference = np.column_stack([np.zeros(6), 10.0 * ticks, np.zeros(6), 0.1 * ticks])
    history = np.zeros(6, ROW).view(np.recarray)
    schedule = np.column_stack([3e-5 + 1e-6 * ticks, ticks, 20e5 + 1e5 * ticks])
    loop.run_periods(
        2, 2, [p], [None], [c], [0, 0], np.zeros(1), np.zeros(1, bool), np.zeros(1), np.zeros(1), np.zeros(2),
        np.zeros(2), np.zeros(POINT_LENGTH), at(**TURNING | {"ANGLE": 0.0}), np.zeros((5, 15)), np.zeros(9),
        np.zeros(4), np.array([0.0, 0.0, 0.01]), np.zeros((6, 2)), schedule, motion, reference, 40.0 + ticks,
        0.5 * ticks, history, 7,
    )  # fmt: skip
    commands = [2.0 + 20.0 + 1.0, 3.0 + 30.0 + 1.5 + 1000.0]
    assert given == [
        (pytest.approx(3e-5 + 1e-6 * k), 20e5 + 1e5 * k, pytest.approx(0.01 * k), pytest.approx(command),
         [[200.0 + n, 300.0 + n, 400.0 + n] for n in (k, k + 1)], 7, 0.01, 40.0 + k)
        for k, command in zip((2, 3), commands, strict=True)
    ]  # fmt: skip
    for k, row in zip((3, 4), history[3:5], strict=True):
        assert (row.time, row.oil_temperature, row.friction_feedforward) == pytest.approx(
            (0.01 * k, 40.0 + k, 0.5 * (k - 1))
        )
        assert (row.acceleration, row.command) == pytest.approx((3.0, commands[k - 3]))
        assert (row.friction_torque, row.tension, row.drum_torque) == (298.0 + k, 9e4, 1.2e5)
        assert (row.heave_velocity, row.speed_reference, row.shaft_angle) == (200.0 + k, 10.0 * k, k - 2.0)
        assert row.position_error == pytest.approx(-0.15 - 0.1 * k)
    assert not any(float(history[k].time) for k in (0, 1, 2, 5))
