"""The catalogue of paper 1's models: equations against independent arithmetic, parameter counts, errata."""

import math

import numpy as np
import pytest

from winch_friction.identification.fit import fit
from winch_friction.identification.motor_models import MOTOR_MODELS, initial_model, motor_model_named
from winch_friction.identification.supplier_table import SupplierTable, motor_points
from winch_friction.physics.channels import CM3_PER_REV
from winch_friction.physics.errors import InputError

X = 280 * CM3_PER_REV
RHO, MU = 870.0, 0.04
W, P, D = 120.0, 1.7e7, 200 * CM3_PER_REV
W0 = 400 * math.pi / 30

# parameters of paper 1's Table 1; MJ6 has 6 (erratum)
COUNTS = {"wilson": 3, "schlosser": 3, "thoma": 3, "pacey": 3, "huhtala": 28, "ortwig": 8, "jeong": 6, "mj1": 6,
          "mj2": 5, "mj3": 4, "mj4": 5, "mj5": 6, "mj6": 6}  # fmt: skip


def notch():
    return P * math.sqrt(P / RHO) * W / (W**2 + W0**2)


def pacey_factor():
    swivel = math.asin(D / X * math.sin(math.radians(25)))
    return (1 - math.tan(math.radians(25))) / (1 - math.tan(swivel))


BY_HAND = {
    "wilson": lambda q: q["Ca"] * X * P + q["Cb"] * MU * X * W + q["Cc"] * X,
    "schlosser": lambda q: q["Ca"] * X * P + q["Cb"] * MU * X * W + q["Cd"] * X ** (5 / 3) * RHO * W**2,
    "thoma": lambda q: q["Ca"] * X * P + q["Cb"] * MU * X * W + q["Cd_a"] * (D / X) ** 3 * X ** (5 / 3) * RHO * W**2,
    "pacey": lambda q: pacey_factor() * (q["Ca_P"] * X * P + q["Cb_P"] * MU * D * W) + q["K4"],
    "ortwig": lambda q: q["K4"] + q["Cf"] * P + q["K1"] * W + q["Ch"] * W * P + q["Ci"] * RHO * W**2
    + q["Cj"] * D / X + q["K3"] * P * D + q["Cl"] * D / X * W,
    "jeong": lambda q: q["K4"] + q["Cf"] * P + q["K1"] * W + q["Ci"] * RHO * W**2 + q["Ck"] * notch() + q["K5"] * P**2,
    "mj1": lambda q: q["K4"] + q["Cf"] * P + q["K1"] * W + q["K5"] * P**2 + q["K2"] * W**2 * D**3 + q["Ck"] * notch(),
    "mj3": lambda q: q["K4"] + q["Cf"] * P + q["K1"] * W + q["K2"] * W**2 * D**3,
    "mj4": lambda q: q["K4"] + q["K3"] * P * D + q["K1"] * W + q["K2"] * W**2 * D**3 + q["K5"] * P**2,
    "mj6": lambda q: q["K4"] + q["K3"] * P * D + q["K1"] * W + q["K2"] * W**2 * D**3 + q["K5"] * P**2
    + q["Ck_D"] * D / X * notch(),
}  # fmt: skip


@pytest.mark.parametrize("name", COUNTS)
def test_number_of_parameters(name):
    assert len(initial_model(MOTOR_MODELS[name], X).values) == COUNTS[name]


def test_all_thirteen():
    assert set(MOTOR_MODELS) == set(COUNTS)


@pytest.mark.parametrize("name", BY_HAND)
def test_equation(name):
    model = initial_model(MOTOR_MODELS[name], X)
    torque = float(model.torque(motor_points(W, P, D)))
    assert torque == pytest.approx(BY_HAND[name](model.as_dict()), rel=1e-9)


def test_mj5_with_exponent_two_is_mj4():
    mj5 = initial_model(MOTOR_MODELS["mj5"], X).with_values({"Cn": 2.0})
    mj4 = initial_model(MOTOR_MODELS["mj4"], X)
    speed = np.linspace(10, 260, 7)
    points = motor_points(speed, np.full(7, P), np.linspace(0.3, 1.0, 7) * X)
    k2 = mj5.value("Cn_scale") / ((2000 * math.pi / 30) ** 2 * X**3)
    np.testing.assert_allclose(mj5.torque(points), mj4.with_values({"K2": k2}).torque(points), rtol=1e-7)


def test_fixed_displacement_models_do_not_read_the_displacement():
    for name, described in MOTOR_MODELS.items():
        model = initial_model(described, X)
        torques = [float(model.torque(motor_points(W, P, part * X))) for part in (0.5, 1.0)]
        expected_fixed = described.displacement == "fixed"
        assert (torques[0] == torques[1]) == expected_fixed or name == "mj1"


def test_huhtala_changes_line_at_the_knee_and_says_that_it_is_a_reconstruction():
    described = MOTOR_MODELS["huhtala"]
    model = initial_model(described, X)
    slopes = [
        float(
            np.diff(model.torque(motor_points(np.full(2, W), np.array(pair), np.full(2, D))))[0] / (pair[1] - pair[0])
        )
        for pair in ((5e6, 9e6), (9e6, 19e6), (21e6, 25e6), (25e6, 34e6))
    ]
    assert slopes[0] == pytest.approx(slopes[1])
    assert slopes[2] == pytest.approx(slopes[3])
    raised = model.with_values({"B2_0": 2 * model.value("B2_0")})
    low, high = (motor_points(W, pressure, D) for pressure in (1e7, 3e7))
    assert float(raised.torque(low)) == float(model.torque(low))
    assert float(raised.torque(high)) > float(model.torque(high))
    assert "reconstruction" in described.note


@pytest.mark.parametrize("name", COUNTS)
def test_finite_at_standstill(name):
    model = initial_model(MOTOR_MODELS[name], X)
    assert np.isfinite(model.torque(motor_points(0.0, P, D)))
    assert np.isfinite(model.jacobian(motor_points(np.zeros(1), np.full(1, P), np.full(1, D)))).all()


def test_unknown_name():
    with pytest.raises(InputError, match=r"motor model 'dorey' is not known; known models are wilson"):
        motor_model_named("dorey")


@pytest.mark.parametrize("cm3", [5, 10, 28, 1000, 5000])
def test_a_motor_of_any_size_has_room_in_the_bounds(cm3):
    """The size that paper 1's three motors give: ports of a small motor choke, a large one's bearings are large."""
    size = cm3 / 215.0
    own = {"K1": 4.05e-3 * size, "K2": 3.69e10 * size ** (-4 / 3), "K3": 5e-3, "K4": 14.0 * size, "K5": 1.16e-14 * size}
    speed, pressure, part = (a.ravel() for a in np.meshgrid((50.0, 150.0, 300.0), (1e7, 2e7, 3e7), (0.4, 0.7, 1.0)))
    displacement = part * cm3 * CM3_PER_REV
    lost = (own["K4"] + own["K3"] * pressure * displacement + own["K1"] * speed + own["K5"] * pressure**2
            + own["K2"] * speed**2 * displacement**3)  # fmt: skip
    table = SupplierTable("own", speed, pressure, displacement, lost, np.ones(len(speed)), cm3 * CM3_PER_REV)
    start = initial_model(MOTOR_MODELS["mj4"], table.max_displacement)
    found = fit(start, table.fit_data())
    assert found.model.as_dict() == pytest.approx(own, rel=1e-3)
    assert not found.at_bound
