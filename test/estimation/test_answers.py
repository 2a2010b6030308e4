"""What is said of a parameter: when learning rests, when it stands at the edge of its range, and after how long."""

from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.estimation import EstimatorConfig
from winch_friction.estimation.answers import STATUS_PERIOD, ParameterStatus, ParameterStatuses

DT = 0.02  # s


def statuses(**settings):
    """Of one parameter that is known five times as surely as the seed has it."""
    parameters = SimpleNamespace(
        seed=SimpleNamespace(values=(1.0,)), prior=np.eye(1), free=np.array([0]),
        at_limit=lambda phi: np.abs(phi) >= 1.0,
    )  # fmt: skip
    state = SimpleNamespace(phi=np.zeros(1), considered_variances=np.array([0.04]))
    return ParameterStatuses(EstimatorConfig(**settings), parameters), state


@pytest.mark.parametrize(("learning_every", "text"), [(0, "frozen"), (4, "learned"), (5, "learned")])
def test_a_parameter_is_frozen_only_where_learning_rested_all_the_time(learning_every, text):
    """Learning that goes on now and then, between two looks at the statuses, is learning."""
    each, state = statuses(settle_time=1.0)
    for k in range(round(2.0 / DT)):
        each.step(state, frozen=not learning_every or k % learning_every != 0, dt=DT)
    assert each.texts == [text]


def test_a_look_at_the_statuses_takes_all_of_the_time_since_the_last_one():
    each, state = statuses(settle_time=1.0)
    state.phi[0] = 1.0
    for _ in range(round((1.0 - STATUS_PERIOD) / DT)):
        each.step(state, frozen=False, dt=DT)
    assert each.texts == ["learned"]
    for _ in range(round(2.0 * STATUS_PERIOD / DT)):
        each.step(state, frozen=False, dt=DT)
    assert each.texts == ["invalid"]


def test_without_a_settling_time_frozen_and_invalid_are_said_at_once():
    each = ParameterStatus(EstimatorConfig(settle_time=0.0))
    each.step(0.2, frozen=False, at_limit=False, dt=0.1)
    assert each.text == "learned"
    each.step(0.2, frozen=True, at_limit=False, dt=0.1)
    assert each.text == "frozen"
    each.step(0.2, frozen=True, at_limit=True, dt=0.1)
    assert each.text == "invalid"
    each.step(0.2, frozen=False, at_limit=False, dt=0.1)
    assert each.text == "learned"
