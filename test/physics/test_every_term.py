"""The contract of a declared term: visited for every term of the registry, whoever adds one."""

import math

import numpy as np
import pytest
import yaml

from winch_friction.physics.friction import FrictionModel, registered_terms
from winch_friction.physics.friction.symbols import GROUP_SIGNALS, WINCH_SIGNALS
from winch_friction.physics.friction.term import Term
from winch_friction.physics.winch import operating_point
from winch_friction.records.model_file import model_from_content, model_to_text

TERMS = registered_terms()
CONSTANTS = {"max_displacement": 3.42e-5, "density": 870.0, "viscosity": 0.04, "gear_ratio": 250.0}
SPEEDS = np.array([-250.0, -40.0, -3.0, 2.0, 30.0, 120.0, 260.0])


def single(term: Term) -> FrictionModel:
    """A model of this term alone, at its typical values."""
    return FrictionModel(term.name, (term,), tuple(p.typical for p in term.parameters), constants=CONSTANTS)


def points(speeds=SPEEDS):
    speeds = np.asarray(speeds, float)
    count = len(speeds)
    groups = [
        (np.full(count, 3.0), np.linspace(2e6, 3e7, count), np.full(count, 3.2e7), np.full(count, 3.4e-5)),
        (np.full(count, 8.0), np.full(count, 2.75e7), np.full(count, 3.3e7), np.linspace(8e-6, 2e-5, count)),
    ]
    return operating_point(
        direction=np.sign(speeds), speed=speeds, drum_torque=np.linspace(2e4, 1.1e6, count), groups=groups,
        motor_total=np.full(count, 11.0), acceleration=np.linspace(-50, 60, count),
        oil_temperature=np.linspace(20, 60, count), time=np.arange(count) * 0.1,
        shaft_angle=np.cumsum(speeds) * 0.1, wire_layer=np.full(count, 5.0), wire_out=np.linspace(10, 200, count),
    )  # fmt: skip


@pytest.mark.parametrize("name", TERMS)
def test_jacobian_against_finite_differences(name):
    model = single(TERMS[name])
    x = points()
    z = model.state_history(x)
    exact = model.jacobian(x, z)
    for k, parameter in enumerate(model.parameters):
        step = 1e-4 * max(abs(parameter.typical), 1e-12)

        def at(offset, k=k):
            values = list(model.values)
            values[k] += offset
            functions = model.compile(2)
            return np.broadcast_to(functions.vector_torque(x, tuple(values), z), SPEEDS.shape)

        numeric = (8 * (at(step) - at(-step)) - (at(2 * step) - at(-2 * step))) / (12 * step)
        scale = np.abs(numeric).max() + 1e-300
        np.testing.assert_allclose(exact[:, k] / scale, numeric / scale, atol=1e-6)


@pytest.mark.parametrize("name", TERMS)
def test_finite_at_zero_speed(name):
    model = single(TERMS[name])
    x = points(np.zeros(7))
    assert np.isfinite(model.torque(x)).all()
    assert np.isfinite(model.jacobian(x)).all()


@pytest.mark.parametrize("name", [n for n, term in TERMS.items() if term.opposing and term.state is None])
def test_an_opposing_term_never_adds_energy(name):
    model = single(TERMS[name])
    if any(parameter.lower < 0.0 for parameter in model.parameters):
        pytest.skip("a correction that may have either sign; the model that contains it is checked instead")
    x = points()
    assert (np.asarray(model.torque(x)) * SPEEDS >= -1e-9).all()


@pytest.mark.parametrize("name", TERMS)
def test_scalar_vector_and_contribution_agree(name):
    model = single(TERMS[name])
    x = points()
    z = model.state_history(x)
    functions = model.compile(2)
    vector = np.broadcast_to(model.torque(x, z), SPEEDS.shape)
    for k in range(len(SPEEDS)):
        row = tuple(float(np.broadcast_to(column, SPEEDS.shape)[k]) for column in x)
        states = tuple(float(column[k]) for column in z)
        scalar = functions.scalar_torque_and_gradient(row, model.values, states)
        assert scalar[0] == pytest.approx(vector[k], rel=1e-12, abs=1e-12)
        assert sum(functions.scalar_contributions(row, model.values, states)) == pytest.approx(scalar[0], rel=1e-12)


@pytest.mark.parametrize("name", TERMS)
def test_yaml_round_trip(name):
    model = single(TERMS[name])
    again = model_from_content(yaml.safe_load(model_to_text(model)), "text")
    assert again.values == model.values
    assert again.term_names == model.term_names
    assert again.constants == model.constants


@pytest.mark.parametrize("name", TERMS)
def test_documented(name):
    term = TERMS[name]
    assert term.source
    assert term.place
    assert term.latex
    assert term.parameters
    for parameter in term.parameters:
        assert parameter.unit
        assert parameter.doc
        assert parameter.lower <= parameter.typical <= parameter.upper


def test_layout_matches_operating_point():
    assert len(points()) == len(WINCH_SIGNALS) + 2 * len(GROUP_SIGNALS)


def test_numba_kernel_equals_the_scalar_function(crane2_model):
    functions = crane2_model.compile(2)
    x = tuple(float(np.broadcast_to(column, SPEEDS.shape)[5]) for column in points())
    assert functions.kernel(x, crane2_model.values, ()) == pytest.approx(
        functions.scalar_torque(x, crane2_model.values, ()), rel=1e-14
    )


def test_speed_derivative(crane2_model):
    functions = crane2_model.compile(2)
    row = [float(np.broadcast_to(column, SPEEDS.shape)[5]) for column in points()]

    def torque(speed):
        moved = [row[0], abs(speed), speed, *row[3:]]
        return functions.scalar_torque(tuple(moved), crane2_model.values, ())

    slope = (torque(row[2] + 1e-3) - torque(row[2] - 1e-3)) / 2e-3
    derivative = functions.scalar_torque_and_gradient(tuple(row), crane2_model.values, ())[1]
    assert derivative == pytest.approx(slope, rel=1e-6)
    assert math.isfinite(derivative)
