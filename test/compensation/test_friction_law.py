"""One model as the compensator uses it: what its gains leave of the torque and of its bound."""

import math

import pytest

from winch_friction.compensation.parts import FrictionLaw
from winch_friction.physics.friction import FrictionModel, term_named
from winch_friction.physics.signals import GroupSample, Sample
from winch_friction.physics.winch import sample_operating_point
from winch_friction.records.model_file import load_model

SEED = load_model("a6vm215_crane1")


def test_a_term_whose_gain_is_zero_gives_the_bound_no_room(crane_150t):
    sample = Sample(0.0, 5.0, groups={"active": GroupSample(145e5, 25e5, 3.4e-5)})
    point = sample_operating_point(sample, crane_150t, drum_torque=crane_150t.drum_torque(55e3), speed=5.0)
    rest = SEED.subset([name for name in SEED.term_names if name != "stribeck"])
    bound = FrictionLaw(SEED, {"stribeck": 0.0}).magnitude(point, 1)
    assert bound == FrictionLaw(rest, {}).magnitude(point, 1)
    assert bound < 0.9 * FrictionLaw(SEED, {}).magnitude(point, 1)


@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize("share", [0.5, 1.0, 1.2, 1.9, 5.0])
def test_a_bound_is_no_more_than_at_the_fastest_speed_nor_than_at_its_own(crane_150t, way, share):
    """Viscous friction would grow with a command in rpm; what falls with speed is smaller there by itself."""
    fastest, group = 60.0, {"active": GroupSample(145e5, 25e5, 3.4e-5)}

    def point(speed):
        sample = Sample(0.0, speed, groups=group)
        return sample_operating_point(sample, crane_150t, drum_torque=crane_150t.drum_torque(55e3), speed=speed)

    for names in (["motor_viscous", "viscous"], ["stribeck"], list(SEED.term_names)):
        law = FrictionLaw(SEED.subset(names), {})
        own, bound = law.magnitude(point(way * share * fastest), 1), law.magnitude(point(way * fastest), 1)
        expected = min(own, bound) if share > 1.0 else own
        assert law.magnitude(point(way * share * fastest), 1, fastest) == pytest.approx(expected)


def test_a_memory_outlasts_a_motor_group_that_comes_or_goes(crane_150t):
    """Presliding after a reversal: the bristles are on the shaft, whichever motors drive it."""
    term = term_named("presliding")
    model = FrictionModel("bristles", (term,), tuple(each.typical for each in term.parameters))
    both = {"active": GroupSample(145e5, 25e5, 3.4e-5), "passive": GroupSample(145e5, 25e5, 1e-5)}

    def point(groups):
        sample = Sample(0.0, 20.0, groups={name: both[name] for name in groups})
        return sample_operating_point(sample, crane_150t, drum_torque=0.0, speed=20.0)

    law = FrictionLaw(model, {})
    one, two = point(["active"]), point(["active", "passive"])
    fresh = law.torque(one, 1)
    for _ in range(3):
        law.advance(one, 1, 0.02)
    moved = law.torque(one, 1)
    assert moved != pytest.approx(fresh)
    assert law.torque(two, 2) == law.torque(one, 1) == moved
    law.reset()
    assert law.torque(one, 1) == fresh


@pytest.mark.parametrize("error", [OverflowError, ValueError, ZeroDivisionError])
def test_a_law_that_cannot_be_evaluated_is_no_number_and_not_no_friction(crane_150t, monkeypatch, error):
    """Nothing is fed forward from it, and the compensator says so; a zero would be believed."""

    def fails(*_):
        raise error

    sample = Sample(0.0, 5.0, groups={"active": GroupSample(145e5, 25e5, 3.4e-5)})
    point = sample_operating_point(sample, crane_150t, drum_torque=crane_150t.drum_torque(55e3), speed=5.0)
    law = FrictionLaw(SEED, {})
    assert law.torque(point, 1) > 0.0
    monkeypatch.setattr(law, "_contributions", fails)
    assert math.isnan(law.torque(point, 1))
