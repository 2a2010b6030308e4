"""A model as a curve: the winch in balance, its pressure carries load and friction, its sigma is one of the torque."""

from dataclasses import replace

import numpy as np
import pytest

from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import term_named
from winch_friction.physics.winch import group_point, operating_point
from winch_friction.physics.winch.model_curve import model_curve, usual_loads
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model

MODEL = load_model("a6vm215_crane2")
SPEED = np.array([-120.0, 40.0, 120.0])


@pytest.fixture(scope="module")
def curve(crane_150t):
    return model_curve(MODEL, crane_150t, load=55e3, speed=SPEED)


def test_the_pressure_carries_the_load_and_the_friction(curve, crane_150t):
    held = curve.pressure * crane_150t.motor_count("main") * crane_150t.max_displacement
    assert held == pytest.approx(crane_150t.drum_torque(55e3) / crane_150t.gear_ratio + curve.torque, rel=1e-6)
    assert sum(curve.parts.values()) == pytest.approx(curve.torque)


def test_its_sigma_is_that_of_a_torque(curve, crane_150t):
    """By a draw of parameters, at the same operating points."""
    count = np.full(3, float(crane_150t.motor_count("main")))
    drum = np.full(3, crane_150t.drum_torque(55e3))
    group = group_point(count, curve.pressure, np.full(3, crane_150t.max_displacement))
    at = operating_point(direction=np.sign(SPEED), speed=SPEED, drum_torque=drum, groups=[group], motor_total=count)
    draws = np.random.default_rng(0).multivariate_normal(MODEL.values, 1e-4 * MODEL.covariance, 400, method="svd")
    torques = [MODEL.with_values(each.tolist()).torque(at) for each in draws]
    assert curve.std == pytest.approx(100.0 * np.std(torques, axis=0), rel=0.15)


@pytest.mark.parametrize("speed", [SPEED, np.array([0.0])])
def test_bristles_have_turned_over_in_a_winch_that_turns_steadily(crane_150t, speed):
    """Presliding is what the sign of the speed has too much just after a reversal, and nothing from then on."""
    term = term_named("presliding")
    values = (*MODEL.values, *(parameter.typical for parameter in term.parameters))
    remembering = replace(MODEL, terms=(*MODEL.terms, term), values=values, covariance=np.diag(np.square(values)))
    found = model_curve(remembering, crane_150t, load=55e3, speed=speed)
    without = model_curve(
        replace(MODEL, covariance=np.diag(np.square(MODEL.values))), crane_150t, load=55e3, speed=speed
    )
    assert found.parts["presliding"] == pytest.approx(0.0, abs=1e-9)
    assert found.torque == pytest.approx(without.torque)
    assert found.std == pytest.approx(without.std)


@pytest.mark.parametrize(
    ("model", "crane", "fastest"),
    [("emps_viscous", "emps", 100.0 / 243.0), ("rope_force_alone", "winch_100kw", 12.0),
     ("worm_viscous", "worm_drive", 209.43951)],
)  # fmt: skip
def test_a_curve_ends_where_its_machine_does(model, crane, fastest):
    """A drive of 100 N was drawn to 209 m/s and 42 kN."""
    machine = load_crane(crane)
    curve = model_curve(load_model(model), machine)
    assert curve.speed[-1] == pytest.approx(fastest, rel=0.25)
    assert 0.0 < curve.speed[0] < 0.01 * curve.speed[-1]
    assert np.abs(curve.torque).max() <= 1.1 * machine.absolute_torque_limit


def test_a_hydraulic_crane_is_drawn_to_the_top_of_the_papers_tests(crane_150t):
    speed = model_curve(MODEL, crane_150t).speed
    assert (speed[0], speed[-1]) == pytest.approx((0.52359878, 209.43951))  # 5 and 2000 rpm


@pytest.mark.parametrize("share", [0.5, 1.0])
def test_a_curve_is_of_the_setting_that_is_asked_for_and_of_either_way(crane_150t, share):
    """At half the displacement the motors hold the same load with about twice the pressure."""
    setting = share * crane_150t.max_displacement
    found = model_curve(MODEL, crane_150t, load=55e3, displacement=setting, speed=SPEED)
    assert found.displacement == setting
    held = found.pressure * crane_150t.motor_count("main") * setting
    assert held == pytest.approx(crane_150t.drum_torque(55e3) / crane_150t.gear_ratio + found.torque, rel=1e-6)
    assert (np.sign(found.torque) == np.sign(SPEED)).all()


@pytest.mark.parametrize(
    ("asked", "said"),
    [({"load": -1.0}, "load -1 kg"), ({"load": np.inf}, "load inf kg"), ({"speed": [np.nan]}, "one finite speed"),
     ({"speed": []}, "one finite speed"), ({"displacement": 1.01}, "outside 0"), ({"displacement": 0.0}, "outside 0")],
)  # fmt: skip
def test_a_curve_of_what_cannot_be_is_refused(crane_150t, asked, said):
    if "displacement" in asked:
        asked = {"displacement": asked["displacement"] * crane_150t.max_displacement}
    with pytest.raises(InputError, match=said):
        model_curve(MODEL, crane_150t, **{"speed": SPEED, **asked})


def test_the_usual_loads_are_shares_of_the_rated_one_or_of_what_the_motors_hold(crane_150t):
    assert usual_loads(crane_150t) == (15e3, 55e3, 100e3)
    assert usual_loads(replace(crane_150t, rated_load=30e3)) == (3e3, 11e3, 20e3)
    bare = replace(crane_150t, rated_load=0.0)
    held = 11 * crane_150t.max_displacement * 300e5 * 250.0 / (9.80665 * 0.8)  # kg
    assert usual_loads(bare) == pytest.approx([0.4 * held * s for s in (0.1, 55.0 / 150.0, 100.0 / 150.0)], rel=0.05)
    worm = replace(load_crane("worm_drive"), rated_load=0.0)
    lever = 9.80665 * worm.drum.layer_radii[0] / worm.gear_ratio
    assert usual_loads(worm)[2] == pytest.approx(0.4 * worm.absolute_torque_limit / lever / 1.5, rel=0.05)
