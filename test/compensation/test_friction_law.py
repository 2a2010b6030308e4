"""One model as the compensator uses it: what its gains leave of the torque and of its bound."""

from winch_friction.compensation.parts import FrictionLaw
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
