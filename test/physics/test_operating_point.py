"""The operating point knows which port's pressure is the higher: what is lost with one port's is that port's; and when
a motion turns."""

import math

import numpy as np
import pytest

from winch_friction.physics.friction import FrictionModel, term_named
from winch_friction.physics.friction.symbols import GROUP_SIGNALS, WINCH_SIGNALS
from winch_friction.physics.signals import GroupSample, Run, Sample
from winch_friction.physics.winch import operating_point, run_operating_points, sample_operating_point
from winch_friction.physics.winch.operating_point import (
    PredictedSpeed,
    smooth_sign,
    smooth_signs,
    time_to_reversal,
)

K_A, K_B = 1e-6, 3e-6
A, B = np.array([120e5, 25e5, 70e5]), np.array([25e5, 90e5, 70e5])  # A higher, B higher, equal
SPEED = 40.0


@pytest.fixture(scope="module")
def ports():
    return FrictionModel("ports", (term_named("case_ports"),), (K_A, K_B))


@pytest.fixture(scope="module")
def lost(crane_150t):
    """N m at the shaft."""
    return crane_150t.motor_count("active") * (K_A * A + K_B * B)


def test_a_run_and_its_samples_lose_what_each_port_loses(ports, lost, crane_150t):
    size = len(A)
    columns = {"active.pressure_a": A, "active.pressure_b": B, "active.displacement": np.full(size, 3e-5)}
    run = Run("ports", {"time": np.arange(size) * 0.1, "motor_speed": np.full(size, SPEED), **columns})
    x = run_operating_points(run, crane_150t, drum_torque=np.zeros(size))
    np.testing.assert_allclose(ports.torque(x), lost, rtol=1e-12)
    functions = ports.compile(1)
    for k, torque in enumerate(lost):
        sample = Sample(time=0.1 * k, motor_speed=SPEED, groups={"active": GroupSample(A[k], B[k], 3e-5)})
        point = sample_operating_point(sample, crane_150t, drum_torque=0.0, speed=SPEED)
        assert point[len(WINCH_SIGNALS) :] == tuple(float(each[k]) for each in x[len(WINCH_SIGNALS) :])
        assert functions.scalar_torque(point, ports.values, ()) == pytest.approx(torque, rel=1e-12)


@pytest.mark.parametrize(
    ("names", "roles"), [("main", [0]), ("active passive", [1, -1]), ("passive active", [-1, 1]), ("passive", [0])]
)
def test_a_sample_and_a_run_say_which_of_the_groups_drives(names, roles, crane_150t):
    names, size = names.split(), len(A)
    columns = {f"{name}.{of}": x for name in names
               for of, x in (("pressure_a", A), ("pressure_b", B), ("displacement", np.full(size, 3e-5)))}  # fmt: skip
    run = Run("roles", {"time": np.arange(size) * 0.1, "motor_speed": np.full(size, SPEED), **columns})
    sample = Sample(time=0.0, motor_speed=SPEED, groups={name: GroupSample(1e7, 2e6, 3e-5) for name in names})
    own = [each.name for each in GROUP_SIGNALS]
    at = [len(WINCH_SIGNALS) + len(own) * k + own.index("role") for k in range(len(names))]
    one = sample_operating_point(sample, crane_150t, drum_torque=0.0, speed=SPEED)
    whole = run_operating_points(run, crane_150t, drum_torque=np.zeros(size))
    order = [run.groups.index(name) for name in names]
    assert [one[k] for k in at] == roles == [float(whole[at[k]][-1]) for k in order]


def test_a_loss_with_one_port_has_no_step_where_the_pressures_are_equal(ports):
    def torque(drop):
        port = -1.0 if drop < 0.0 else 1.0
        point = operating_point(
            direction=1.0, speed=SPEED, drum_torque=0.0, motor_total=3, groups=[(3, abs(drop), 140e5, 3e-5, port)]
        )
        return float(ports.torque(point))

    assert torque(-1.0) == pytest.approx(torque(1.0), abs=1e-4)


def test_port_a_is_the_higher_where_nobody_says():
    common = {"direction": 1.0, "speed": SPEED, "drum_torque": 0.0, "motor_total": 3}
    four = (3, 95e5, 145e5, 3e-5)
    assert operating_point(**common, groups=[four, four]) == operating_point(**common, groups=[(*four, 1.0, 0.0)] * 2)
    for group in (four[:3], (*four, 1.0, 1.0, 1.0)):
        with pytest.raises(TypeError, match=f"not {len(group)} values"):
            operating_point(**common, groups=[group])


POWERS = ("port_turbulence", "port_power", "port_one_way", "mj5_port_flow", "line_pressure_power", "line_each_motor",
          "line_active")  # fmt: skip


@pytest.mark.parametrize("name", POWERS)
@pytest.mark.parametrize("displacement", [0.0, -2e-7])  # the feedback's zero error: 0.6 % of the stroke
def test_a_motor_that_is_swung_out_loses_a_number_by_a_power_of_its_displacement(name, displacement, crane_150t):
    term = term_named(name)
    model = FrictionModel("power", (term,), tuple(each.typical + 0.3 * each.shape for each in term.parameters),
                          constants={"max_displacement": crane_150t.max_displacement})  # fmt: skip
    sample = Sample(time=0.0, motor_speed=SPEED, groups={"passive": GroupSample(120e5, 25e5, displacement)})
    point = sample_operating_point(sample, crane_150t, drum_torque=0.0, speed=SPEED)
    found = model.compile(1).scalar_torque_and_gradient(point, model.values, ())
    assert all(isinstance(each, float) and np.isfinite(each) for each in found)
    assert found[0] == pytest.approx(0.0, abs=1e-2)
    columns = {"passive.pressure_a": A, "passive.pressure_b": B, "passive.displacement": np.full(len(A), displacement)}
    run = Run("swung", {"time": np.arange(len(A)) * 0.1, "motor_speed": np.full(len(A), SPEED), **columns})
    x = run_operating_points(run, crane_150t, drum_torque=np.zeros(len(A)))
    assert model.torque(x) == pytest.approx(0.0, abs=1e-2)
    assert np.isfinite(model.jacobian(x)).all()


def test_layers_further_down_yield_by_a_power_of_their_number(crane_150t):
    """By the first power it is the law of equal layers; the square root of three layers below is 1.73 times one."""
    group = {"main": GroupSample(120e5, 25e5, 3e-5)}

    def torque(name, layer, **shape):
        term = term_named(name)
        model = FrictionModel("layers", (term,), tuple(shape.get(p.name, 0.01) for p in term.parameters))
        sample = Sample(time=0.0, motor_speed=SPEED, groups=group, wire_layer=layer)
        one = sample_operating_point(sample, crane_150t, drum_torque=crane_150t.drum_torque(55e3), speed=SPEED)
        return model.compile(1).scalar_torque(one, model.values, ())

    assert torque("layer_yielding", 4.0, n_ly=1.5, m_ly=1.0) == pytest.approx(torque("layer_bedding", 4.0, n_lb=1.5))
    root = [torque("layer_yielding", layer, n_ly=1.5, m_ly=0.5) for layer in (1.0, 2.0, 4.0)]
    assert root[2] / root[1] == pytest.approx(np.sqrt(3.0), rel=1e-4)
    assert abs(root[0]) < 2e-3 * abs(root[1])


def test_a_layer_that_nobody_says_is_the_outer_one_for_a_term_as_for_the_load(crane_150t):
    term = term_named("layer_bedding")
    model = FrictionModel("layers", (term,), tuple(each.typical for each in term.parameters))
    load = crane_150t.drum_torque(55e3)
    group = {"main": GroupSample(120e5, 25e5, 3e-5)}
    columns = {"time": np.zeros(1), "motor_speed": np.full(1, SPEED), "main.pressure_a": A[:1],
               "main.pressure_b": B[:1], "main.displacement": np.full(1, 3e-5)}  # fmt: skip

    def torques(**layer):
        sample = Sample(time=0.0, motor_speed=SPEED, groups=group, **layer)
        run = Run("layers", columns | {name: np.full(1, value) for name, value in layer.items()})
        one = sample_operating_point(sample, crane_150t, drum_torque=load, speed=SPEED)
        all_of_it = run_operating_points(run, crane_150t, drum_torque=np.full(1, load))
        return model.compile(1).scalar_torque(one, model.values, ()), float(model.torque(all_of_it)[0])

    assert torques() == pytest.approx(torques(wire_layer=6.0))
    assert torques()[0] > 100.0
    assert torques(wire_layer=1.0) == pytest.approx((0.0, 0.0))


@pytest.mark.parametrize(
    ("speed", "acceleration", "seconds"),
    [(10.0, -20.0, 0.5), (-10.0, 20.0, 0.5), (10.0, 20.0, math.inf), (-10.0, -20.0, math.inf), (10.0, 0.0, math.inf)],
)
def test_a_motion_turns_when_what_slows_it_has_brought_it_to_rest(speed, acceleration, seconds):
    assert time_to_reversal(PredictedSpeed(speed, acceleration)) == seconds


@pytest.mark.parametrize("width", [0.0, 3.0])
def test_a_sign_is_smooth_where_it_has_a_width_and_one_without(width):
    speeds = np.array([-6.0, -0.5, 0.0, 0.5, 6.0])
    expected = [math.tanh(v / width) if width else float(np.sign(v)) for v in speeds]
    assert [smooth_sign(v, width) for v in speeds] == pytest.approx(expected)
    assert smooth_signs(speeds, width) == pytest.approx(expected)
    assert smooth_signs(speeds, np.array([0.0, 1.0, 0.0, 1.0, 0.0])) == pytest.approx(
        [-1.0, math.tanh(-0.5), 0.0, math.tanh(0.5), 1.0]
    )
