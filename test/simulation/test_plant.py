"""The plant against what can be worked out by hand."""

import ctypes
from types import SimpleNamespace

import numpy as np
import pytest
from clean_sensors import CLEAN

from winch_friction.physics.channels import BAR, GRAVITY
from winch_friction.physics.friction.compiled import operating_point
from winch_friction.physics.friction.model import FrictionModel
from winch_friction.physics.friction.term import registered_terms, term_named, unique_parameters
from winch_friction.physics.signals import Run
from winch_friction.physics.winch.crane import run_drive_torque, run_drum_torque
from winch_friction.physics.winch.operating_point import run_operating_points
from winch_friction.simulation import Simulator, simulate
from winch_friction.simulation.plant.equations import operating_point as kernel_point
from winch_friction.simulation.plant.friction_kernel import friction_kernel
from winch_friction.simulation.plant_file import load_plant

CONSTANTS = {"max_displacement": 3.42e-5, "gear_ratio": 250.0}


def position(scenario, crane, model, **changes):
    return simulate(scenario.override({**CLEAN, **changes}), crane, model, seed=3).truth["position_error"]


@pytest.mark.parametrize("drive", ["primary", "secondary"])
def test_the_time_step_converges(drive, ahc, crane, model):
    scenario = ahc.override({"drive": drive, "duration": 40.0})
    exact = position(scenario, crane, model, step=1e-4)
    errors = [np.abs(position(scenario, crane, model, step=s) - exact).max() for s in (2e-3, 1e-3, 5e-4)]
    assert errors[1] < 1e-5  # m at the shipped step
    assert errors[0] > 3.0 * errors[1] > 9.0 * errors[2]


def test_nothing_moves_at_rest(ahc, crane, model):
    still = ahc.override({**CLEAN, "sea": {"kind": "still"}, "duration": 120.0})
    truth = simulate(still, crane, model).truth
    assert np.abs(truth["position_error"]).max() < 1e-4
    assert np.abs(truth["motor_speed"][6000:]).max() < 1e-3


def test_a_held_load_sticks(crane, model, cycle):
    """The pump off, leakage lowers the load until friction carries what the falling pressure does not."""
    held = cycle.override({**CLEAN, "profile": {}, "duration": 20.0})
    truth = simulate(held, crane, model).truth
    assert abs(truth["motor_speed"][-1]) < 3.0
    assert -1.0 <= truth["direction"].min() <= truth["direction"].max() <= 1.0


def test_the_pressures_carry_load_inertia_and_friction(cycle, crane, model):
    """The torque balance of docs/physics.md §1 holds on the logged run at constant speed."""
    run = simulate(cycle.override(CLEAN), crane, model).run
    drum = run_drum_torque(run, crane)
    friction = model.torque(run_operating_points(run, crane, drum_torque=drum))
    steady = (np.abs(np.gradient(run["motor_speed"], run.time)) < 0.5) & (np.abs(run["motor_speed"]) > 3.0)
    residual = run_drive_torque(run, crane) - drum / crane.gear_ratio - friction
    assert steady.sum() > 300
    assert abs(np.median(residual[steady])) < 0.01 * np.abs(friction[steady]).mean()


def test_passive_motors_balance_55_t(ahc, crane, model):
    simulator = Simulator(ahc.override({"passive_displacement": None}), crane, model)
    truth = simulator.truth()
    torque = 8 * truth["passive_displacement"] * 275 * BAR
    assert torque == pytest.approx(55e3 * GRAVITY * 1.136 / 250, rel=1e-9)
    assert truth["passive_displacement"] == pytest.approx(70e-6 / (2 * np.pi), rel=5e-3)


def test_wire_stretches_by_the_tension(ahc, crane, model):
    truth = simulate(ahc.override(CLEAN), crane, model).truth
    stretch = truth["heave"] + truth["shaft_angle"] * 1.136 / 250 - truth["position_error"]
    stiffness = crane.wire_stiffness / 50.0
    static = 55e3 * GRAVITY
    elastic = static + stiffness * stretch
    assert np.corrcoef(elastic, truth["tension"])[0, 1] > 0.9
    assert truth["tension"].mean() == pytest.approx(static, rel=1e-3)


def by_address(model, point, states):
    """Torque of the function at the address that the plant calls."""
    double = ctypes.POINTER(ctypes.c_double)
    function = ctypes.CFUNCTYPE(ctypes.c_double, double, double, double)(friction_kernel(model).torque_address)
    arrays = np.asarray(point, float), np.asarray(model.values, float), np.asarray([*states, 0.0], float)
    return function(*(array.ctypes.data_as(double) for array in arrays))


@pytest.mark.slow
def test_the_kernel_is_the_model_for_every_declared_term():
    terms = tuple(registered_terms().values())
    parameters = unique_parameters(terms)
    everything = FrictionModel("everything", terms, tuple(p.typical for p in parameters), constants=CONSTANTS)
    states = everything.compile(2).initial_states
    for speed in (-150.0, -0.3, 0.4, 80.0):
        point = operating_point(
            direction=np.tanh(speed), speed=speed, drum_torque=6e5, motor_total=11.0, acceleration=20.0,
            oil_temperature=31.0, time=1.7e9, shaft_angle=3.3, wire_layer=4.0, wire_out=70.0,
            groups=[(3.0, 60e5, 110e5, 3.4e-5), (8.0, 275e5, 325e5, 1.1e-5)],
        )  # fmt: skip
        assert by_address(everything, point, states) == pytest.approx(everything.torque(point, states), rel=1e-12)


def test_a_winch_without_passive_motors_has_a_group_of_none(model):
    common = {"direction": 1.0, "speed": 50.0, "drum_torque": 6e5, "motor_total": 11.0}
    one = operating_point(**common, groups=[(11.0, 90e5, 140e5, 3.4e-5)])
    two = operating_point(**common, groups=[(11.0, 90e5, 140e5, 3.4e-5), (0.0, 0.0, 0.0, 3.4e-5)])
    assert by_address(model, two, ()) == pytest.approx(float(model.torque(one)), rel=1e-12)


def test_terms_read_the_sum_of_the_passive_sides_pressures(ahc, crane, model):
    """case_pressure is c (p_A + p_B) per motor: what it adds to the friction, from the logged pressures of all."""
    case = term_named("case_pressure")
    with_case = FrictionModel(
        "case", (*model.terms, case), (*model.values, 1e-6), constants=model.constants,
    )  # fmt: skip
    truth = simulate(ahc.override({**CLEAN, "duration": 30.0}), crane, with_case, seed=3).truth
    active = truth["pressure_a"] + truth["pressure_b"]
    passive = truth["passive_pressure_a"] + truth["passive_pressure_b"]
    columns = {"time": truth.time, "motor_speed": truth["motor_speed"], "hook_load": truth["hook_load"]}
    columns |= {"active.pressure_a": truth["pressure_a"], "active.pressure_b": truth["pressure_b"]}
    columns |= {f"passive.{p}": truth[f"passive_{p}"] for p in ("pressure_a", "pressure_b", "displacement")}
    columns["active.displacement"] = truth["displacement"]
    moving = np.abs(truth["motor_speed"]) > 20.0
    x = run_operating_points(Run("x", columns), crane, drum_torque=truth["drum_torque"])
    base = np.asarray(model.torque(x))
    added = truth["direction"] * 1e-6 * (3 * active + 8 * passive)
    assert np.abs(added[moving]).min() > 150.0
    np.testing.assert_allclose((truth["friction_torque"] - base)[moving][5:], added[moving][5:], atol=8.0)


def test_a_term_of_one_port_follows_it_where_either_is_the_higher(ahc, crane, model):
    ports = FrictionModel("ports", (*model.terms, term_named("case_ports")), (*model.values, 0.0, 2e-6),
                          constants=model.constants)  # fmt: skip
    truth = simulate(ahc.override({**CLEAN, "duration": 30.0}), crane, ports, seed=3).truth
    columns = {"time": truth.time, "motor_speed": truth["motor_speed"]}
    columns |= {f"active.{p}": truth[p] for p in ("pressure_a", "pressure_b", "displacement")}
    columns |= {f"passive.{p}": truth[f"passive_{p}"] for p in ("pressure_a", "pressure_b", "displacement")}
    x = run_operating_points(Run("x", columns), crane, drum_torque=truth["drum_torque"])
    moving = np.abs(truth["motor_speed"]) > 20.0
    b_higher = moving & (truth["pressure_b"] > truth["pressure_a"] + 10e5)
    assert b_higher.sum() > 20
    added = truth["direction"] * 2e-6 * (3 * truth["pressure_b"] + 8 * truth["passive_pressure_b"])
    found = truth["friction_torque"] - np.asarray(model.torque(x))
    np.testing.assert_allclose(found[moving][5:], added[moving][5:], atol=8.0)


def test_memory_of_the_models_own_terms_is_carried(ahc, crane, model):
    stateful = [term for term in registered_terms().values() if term.state is not None]
    if not stateful:
        pytest.skip("no term with memory is declared")
    term = stateful[0]
    values = (*model.values, *(p.typical for p in term.parameters if p.name not in model.parameter_names))
    truth = FrictionModel("with_memory", (*model.terms, term), values, constants=model.constants)
    result = simulate(ahc.override({"duration": 30.0}), crane, truth)
    assert np.isfinite(result.truth["friction_torque"]).all()
    plain = simulate(ahc.override({"duration": 30.0}), crane, model)
    assert not np.array_equal(result.truth["friction_torque"], plain.truth["friction_torque"])


def test_displacement_and_boost_can_be_switched_during_a_run(cycle, crane, model):
    full = crane.max_displacement
    points = [[0, 0], [2, 0], [5, 60.0], [40, 60.0]]
    changes = {
        "duration": 40.0,
        "profile": {"points": points},
        "displacement_schedule": [[15, full], [17, 0.6 * full]],
        "boost_schedule": [[28, 25 * BAR], [29, 45 * BAR]],
    }
    truth = simulate(cycle.override({**CLEAN, **changes}), crane, model).truth
    before, small, boosted = (
        np.interp([14.0, 26.0, 39.0], truth.time, truth[c]) for c in ("motor_speed", "pressure_a", "pressure_b")
    )
    assert before[1] == pytest.approx(before[0], rel=0.1)  # the pump gives less, the speed stays
    assert small[1] > 1.5 * small[0]
    assert boosted[2] == pytest.approx(45 * BAR, rel=0.05)
    stored = truth["energy_stored"] - truth["energy_stored"][0]
    moved = truth["energy_in"] + truth["energy_heave"] - truth["energy_friction"] - truth["energy_lost"]
    assert np.abs(stored - moved).max() < 1e-6 * truth["energy_in"].max()


@pytest.mark.parametrize(("key", "narrow", "wide"), [("scenario", 1e-3, 3.0), ("plant", 1e-3, 3.0)])
def test_reversals_are_as_wide_as_scenario_or_plant_says(key, narrow, wide, ahc, crane, model):
    scenario = ahc.override({**CLEAN, "duration": 20.0})

    def transition(width):
        if key == "scenario":
            truth = simulate(scenario.override({"presliding": width}), crane, model).truth
        else:
            plant = load_plant(scenario.plant).copy(update={"presliding": width})
            truth = Simulator(scenario.override({"presliding": None}), crane, model, plant=plant).run().truth
        turning = np.abs(truth["motor_speed"]) > 3.0
        return float(np.mean(np.abs(truth["direction"][turning]) < 0.9))

    assert transition(wide) > 3.0 * transition(narrow)


def test_a_pressure_that_pushes_the_other_way_is_as_large_and_acts_at_the_other_port(ahc, crane, model):
    plant = Simulator(ahc.override(CLEAN), crane, model)._plant[0]
    plant = SimpleNamespace(**dict(zip(plant.dtype.names, plant.tolist(), strict=True)))
    state = np.zeros(16)

    def point(dp):
        return kernel_point.py_func(plant, state, 0.0, 0.0, 0.0, 0.0, 40.0, dp, 0.0, 0.0)

    there, back = point(80e5), point(-80e5)
    assert there.pressure_driven == back.pressure_driven == 80e5
    assert (there.higher_port_driven, back.higher_port_driven) == (1.0, -1.0)
    assert (there.role_driven, there.role_passive) == (1.0, -1.0)
