"""Which tests a crane can make, what each would show, and what is not logged at all."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.commissioning import excitation
from winch_friction.commissioning.excitation import DISPLACEMENTS, LOADS, SPEEDS, Taught
from winch_friction.physics.channels import RPM


@pytest.mark.parametrize(("after", "words"), [(0.5, "much"), (0.8, "a little"), (0.95, "nothing"), (1.0, "nothing")])
def test_what_is_taught_is_said_by_what_is_left_of_the_models_own_sigma(after, words):
    assert Taught("C1", 0.2, 0.2 * after).words == words


def test_runs_that_show_nothing_leave_the_models_own_sigma_relative_to_each_value(crane2_model):
    """A standard deviation, in parts of the value that it is of."""
    told, _ = excitation.taught([], crane2_model)
    plain = excitation._with_prior(crane2_model)
    own = {n: s / abs(v) for n, v, s in zip(plain.parameter_names, plain.values, plain.std, strict=True)}
    for each in told:
        assert each.after == each.before == pytest.approx(own[each.name], rel=1e-3)


def test_no_test_is_asked_for_whose_pressure_the_motors_do_not_hold(crane_150t):
    """At half the displacement, half the load; of the grid each other one is there."""
    able = replace(crane_150t, rated_speed=0.0, rated_load=0.0)
    found = set(excitation._tests(able, DISPLACEMENTS))
    assert found == {(s, m, d) for s in SPEEDS for m in LOADS for d in DISPLACEMENTS if m <= d}
    assert all(s <= 400.0 for s, *_ in excitation._tests(replace(able, rated_speed=500.0 * RPM), DISPLACEMENTS))


def test_a_test_at_a_smaller_displacement_shows_a_higher_pressure(crane_150t, crane2_model):
    """Up and down at that speed, on the largest group of motors, with the drum's torque of the load."""
    model, asked = crane2_model, []
    known = SimpleNamespace(jacobian=lambda point: asked.append(point) or np.zeros((2, len(model.values))))
    excitation._test_rows(crane_150t, known, 100.0, 0.3, 0.5)
    (point,) = asked
    motors = max(crane_150t.groups.values())
    torque = 0.3 * motors * crane_150t.max_displacement * 250e5
    values = [np.broadcast_to(each, 2).tolist() for each in point]
    assert [1.0, -1.0] in values
    assert values.count([float(motors)] * 2) == 2  # of the group and on the shaft
    assert any(each == pytest.approx([torque * crane_150t.gear_ratio] * 2) for each in values)
    assert any(each == pytest.approx([150e5] * 2) for each in values)
    assert any(each == pytest.approx([0.5 * crane_150t.max_displacement] * 2) for each in values)


def swung(*shares):
    return SimpleNamespace(groups={"main": SimpleNamespace(displacement=np.array(shares) * 3.4e-5)})


@pytest.mark.parametrize(
    ("views", "settings"),
    [
        ([swung(0.5, 0.5), swung(0.5)], (0.5,)),  # motors of constant displacement, as a bridge says it
        ([swung(1.0 / 3.0, np.mean([1.0 / 3.0] * 7))], (pytest.approx(1.0 / 3.0),)),
        ([swung(0.5, 0.5001)], DISPLACEMENTS),  # a feedback
        ([swung(0.5), swung(1.0)], DISPLACEMENTS),
        ([swung(np.nan, 0.5)], (0.5,)),
        ([swung(0.0, 0.0)], DISPLACEMENTS),
        ([swung(1.3)], DISPLACEMENTS),  # another unit
        ([SimpleNamespace(groups={})], DISPLACEMENTS),
    ],
)
def test_motors_of_constant_displacement_are_asked_for_no_other(views, settings, crane_150t):
    crane = replace(crane_150t, max_displacement=3.4e-5)
    assert excitation._settings(crane, views) == settings


def view(*speeds, **more):
    known = {
        "groups": {},
        "name": "run",
        "load": np.ones(4),
        "load_torque": None,
        "oil": np.ones(4),
        "layer": np.ones(4),
    }
    speed = np.resize(np.array(speeds), 4)
    return SimpleNamespace(**{**known, "speed": speed, "moving": speed != 0.0, **more})


@pytest.mark.parametrize(
    ("views", "said"),
    [
        ([view(1.0, -1.0)], []),
        ([view(1.0), view(1.0, -1.0)], []),  # one of them has both
        ([view(1.0), view(-1.0)], ["both directions"]),
        ([view(1.0, -1.0, load=np.full(4, np.nan))], ["hook_load"]),
        ([view(1.0, -1.0, load=np.full(4, np.nan), load_torque=np.ones(4))], []),
        ([view(1.0, -1.0, oil=None)], ["oil_temperature"]),
        ([view(1.0, -1.0, layer=np.full(4, np.nan)), view(1.0, -1.0)], []),
        ([view(1.0, -1.0, layer=np.full(4, np.nan))], ["wire_layer"]),
    ],
)
def test_what_no_run_has_is_said(views, said):
    assert [line.partition(":")[0] for line in excitation._missing_channels(views)] == said


def test_tests_that_teach_next_to_nothing_are_not_asked_for(monkeypatch, crane_150t, crane2_model):
    """The three that teach most, of those that teach a whole unit of information."""
    gains = iter([0.5, 3.0, 2.0, 0.0] + [0.1] * 1000)
    model = excitation._with_prior(crane2_model)
    information = np.eye(len(model.values))
    sigma = excitation.FIT_NOISE * crane_150t.motor_total(()) * crane_150t.max_displacement * 300e5

    def rows(*_):
        row = np.zeros((1, len(model.values)))
        row[0, 0] = np.sqrt(np.expm1(next(gains)) * 2.0 / excitation.EFFECTIVE) * sigma
        return row

    monkeypatch.setattr(excitation, "_test_rows", rows)
    asked = excitation.log_next(crane_150t, [view(1.0, -1.0)], crane2_model, information)
    assert len(asked) == 2
    assert all(line.startswith("constant") for line in asked)
