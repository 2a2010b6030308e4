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


@pytest.mark.parametrize(
    ("before", "share", "level"),
    [
        ("seed", 0.90, "seed"), ("seed", 0.89, "learning"), ("seed", 0.60, "learning"), ("seed", 0.59, "learned"),
        ("learning", 0.94, "learning"), ("learning", 0.96, "seed"), ("learning", 0.61, "learning"),
        ("learning", 0.64, "learning"), ("learning", 0.59, "learned"),
        ("learned", 0.64, "learned"), ("learned", 0.66, "learning"), ("learned", 0.94, "learning"),
        ("learned", 0.96, "seed"),
    ],
)  # fmt: skip
def test_a_level_is_left_a_twentieth_later_than_it_was_reached(before, share, level):
    """... and by what left it alone: what is learning is learned at six tenths, as what was still the seed's."""
    status = ParameterStatus(EstimatorConfig())
    status.level = before
    status.step(share, False, False, 0.1)
    assert status.level == status.text == level


@pytest.mark.parametrize(("period", "at"), [(0.02, 5), (0.05, 2), (0.2, 1)])
def test_the_statuses_are_looked_at_every_tenth_of_a_second(period, at):
    looked, each = [], ParameterStatuses.__new__(ParameterStatuses)
    each._since, each._frozen = 0.0, True
    each._parameters = SimpleNamespace(prior=np.eye(1), at_limit=lambda phi: np.array([False]), free=np.array([0]))
    each._each = [SimpleNamespace(step=lambda *given: looked.append((k, *given)))]
    state = SimpleNamespace(considered_variances=np.array([0.25]), phi=np.zeros(1))
    for k in range(1, 2 * at + 1):
        each.step(state, k <= at, period + 1e-9)
    assert [(k, share, frozen) for k, share, frozen, *_ in looked] == [(at, 0.5, True), (2 * at, 0.5, False)]
    assert [given[-1] for given in looked] == pytest.approx([at * period] * 2)
