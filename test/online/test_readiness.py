"""What a sample does not wait for: the functions of a model are compiled before it comes."""

import threading
import time

import pytest

from winch_friction.compensation import FeedforwardCompensator
from winch_friction.estimation import FrictionEstimator
from winch_friction.online.intake import ModelIntake
from winch_friction.online.readiness import ANSWERING, LEARNING, make_ready
from winch_friction.physics.friction import FrictionModel, compiled, term_named
from winch_friction.physics.signals import GroupSample, Sample
from winch_friction.records.model_file import model_to_text


@pytest.fixture
def made(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The functions that are made from now on, by name; none is at hand from before."""
    compiled.compiled.cache_clear()
    names: list[str] = []
    make = compiled.CompiledTerms._function

    def noted(self: compiled.CompiledTerms, part: str, dialect: str) -> object:
        names.append(part)
        return make(self, part, dialect)

    monkeypatch.setattr(compiled.CompiledTerms, "_function", noted)
    return names


def sample(crane, time: float, groups: int = 2) -> Sample:
    both = {
        "active": GroupSample(100e5, 25e5, crane.max_displacement),
        "passive": GroupSample(300e5, 25e5, crane.max_displacement / 3.0),
    }
    groups = dict(list(both.items())[:groups])
    speed = 100.0 + time
    return Sample(time=time, motor_speed=speed, speed_reference=speed, hook_load=55e3, groups=groups)


@pytest.fixture
def remembering(crane2_model) -> FrictionModel:
    """The seed beside a term that has a memory."""
    own = term_named("presliding")
    values = (*crane2_model.values, *(each.typical for each in own.parameters))
    return FrictionModel("remembering", (*crane2_model.terms, own), values, constants=crane2_model.constants)


@pytest.mark.parametrize(
    ("law", "parts", "memory", "groups"),
    [
        (FeedforwardCompensator, ANSWERING, False, 2),
        (FrictionEstimator, LEARNING, False, 2),
        (FeedforwardCompensator, ANSWERING, True, 2),
        (FeedforwardCompensator, ANSWERING, False, 1),
    ],
)
def test_nothing_is_compiled_at_the_samples(
    made, crane_150t, crane2_model, remembering, law, parts, memory, groups
) -> None:
    model = remembering if memory else crane2_model
    make_ready(model, crane_150t, groups, parts)
    assert made
    made.clear()
    each = law(crane_150t, model)
    for k in range(5):
        each.step(sample(crane_150t, 0.02 * k, groups))
    assert made == []


def test_a_model_that_is_taken_over_is_ready_before(crane2_model) -> None:
    """A learned model of other terms was compiled at the sample that took it over, 0.1 s by an active compensator."""
    ready: list[FrictionModel] = []
    intake = ModelIntake(ready.append, beside=False)
    intake.offer(model_to_text(crane2_model))
    assert [each.values for each in ready] == [crane2_model.values]
    assert intake.take() == ready


def test_a_model_that_cannot_be_made_ready_is_refused(crane2_model) -> None:
    def fails(model: FrictionModel) -> None:
        raise ZeroDivisionError

    intake = ModelIntake(fails, beside=False)
    intake.offer(model_to_text(crane2_model))
    (refused,) = intake.take()
    assert "not a model (ZeroDivisionError)" in str(refused)


def test_whether_there_is_anything_to_take_is_told_without_a_call(crane2_model):
    """The control thread asks before every torque: of a text that came, of one that is parsed, until it was taken."""
    begun, go_on = threading.Event(), threading.Event()

    def ready(_):
        begun.set()
        go_on.wait(20.0)

    intake = ModelIntake(ready)
    assert not intake.waiting
    intake.offer(model_to_text(crane2_model))
    assert intake.waiting
    assert intake.take() == []
    assert begun.wait(20.0)
    assert intake.take() == []
    assert intake.waiting  # it is being made ready
    go_on.set()
    found, until = [], time.monotonic() + 20.0
    while not found and time.monotonic() < until:
        assert intake.waiting
        found = intake.take()
    assert [each.name for each in found] == [crane2_model.name]
    intake.take()
    assert not intake.waiting
