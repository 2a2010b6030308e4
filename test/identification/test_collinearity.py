"""Which directions the data do not tell apart, by how little they see them, and which parameters act alike."""

from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.identification.collinearity import ties, unseen_directions

NAMES = ("K1", "C5", "C6")
DATA = SimpleNamespace(
    speed=np.array([10.0, 50.0, 90.0]), drop=np.full(3, 1e7), displacement=np.full(3, 3e-5),
    drum_torque=np.full(3, 5e5), motors=11,
)  # fmt: skip


def model(*columns):
    return SimpleNamespace(parameter_names=NAMES, jacobian=lambda points: np.column_stack(columns))


def test_how_much_is_seen_is_a_ratio_of_deviations_and_the_least_seen_comes_first():
    result = SimpleNamespace(information=np.diag([0.25, 4.0, 0.01]), model=SimpleNamespace(parameter_names=NAMES))
    found = unseen_directions(result)
    assert [each.seen for each in found] == pytest.approx([0.1, 0.5])
    assert [str(each) for each in found] == ["1.00 C6", "1.00 K1"]


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_parameters_that_act_alike_or_just_against_each_other_are_tied(sign):
    speed = DATA.speed
    found = ties(model(speed, sign * 3.0 * speed, np.ones(3)), DATA)
    assert [(each.first, each.second) for each in found] == [("K1", "C5")]
    assert found[0].cosine == pytest.approx(sign)
