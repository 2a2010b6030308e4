"""Models: parsed beside the control thread, the newest kept, no more than one a second, whatever the clocks do."""

import time
from dataclasses import replace

import pytest
from sea import CRANE, PERIOD, SEED, START, TOPICS, swell

from winch_friction.online.compensator import LEARNED_AT, CompensatorService
from winch_friction.online.estimator import EstimatorService
from winch_friction.online.intake import LARGEST, ModelIntake, parse
from winch_friction.physics.errors import InputError
from winch_friction.records.bag_write import MESSAGES
from winch_friction.records.model_file import model_to_text

HOSTILE = {
    "brackets": "[" * 20_000,
    "nested maps": "x: [" * 900,
    "large": "a: b\n" * 400_000,
    "alias of itself": "terms: &a [*a]",
    "dashes": "- " * 5_000,
    "no text": "\0",
    "python": "!!python/object/apply:os.system ['true']",
    "empty": "",
    "lists of lists": "a: &a0 [1,1,1,1]\n"
    + "".join(f"b{k}: &a{k} [{','.join([f'*a{k - 1}'] * 9)}]\n" for k in range(1, 8))
    + "terms: []\ncorrections: *a7\n",  # held every thread for minutes, to show what was found
}


@pytest.mark.parametrize("text", HOSTILE.values(), ids=HOSTILE.keys())
def test_a_hostile_model_is_one_line(text: str) -> None:
    began = time.monotonic()
    with pytest.raises(InputError) as caught:
        parse(text, "friction_model")
    assert len(str(caught.value)) < 400
    assert time.monotonic() - began < 2.0


def test_brackets_without_end_are_refused_before_any_parser_sees_them() -> None:
    for text in ("[" * 20_000, "{" * 3_000, "a:\n" + 200 * " " + "b: 1"):
        with pytest.raises(InputError, match="nested too deeply"):
            parse(text, "friction_model")


def test_a_model_passes_and_is_far_below_the_limit() -> None:
    text = model_to_text(SEED)
    assert len(text) < LARGEST / 4
    assert parse(text, "friction_model").values == SEED.values


def _wait(intake: ModelIntake) -> list:
    deadline = time.monotonic() + 20.0
    while time.monotonic() < deadline:
        done = intake.take()
        if done:
            return done
        time.sleep(0.01)
    raise AssertionError("nothing was parsed")


def test_the_newest_is_kept_and_one_a_second_looked_at() -> None:
    now = [100.0]
    intake = ModelIntake(clock=lambda: now[0])
    for k in range(100):
        intake.offer(model_to_text(SEED.with_values({"C6": SEED.value("C6") * (1.0 + 1e-3 * k)})))
    (model,) = _wait(intake)
    assert model.value("C6") == pytest.approx(SEED.value("C6") * 1.099)
    intake.offer("nonsense")
    assert intake.take() == []  # not yet: a second has to pass
    now[0] += 1.0
    (refused,) = _wait(intake)
    assert isinstance(refused, InputError)


@pytest.mark.parametrize("period", [1.0, 0.05])
@pytest.mark.parametrize("shifts", [(0.0,), (0.0, 7.8), (0.0, -7.8), (0.0, 3600.0, -3600.0)])
def test_models_are_published_once_a_second_whatever_the_clocks(shifts: tuple[float, ...], period: float) -> None:
    """What was seen: two senders with different clocks, 127 models in 5 s."""
    service = EstimatorService(CRANE, SEED, TOPICS, model_period=period)
    published, now = [], START
    for k in range(250):
        now += PERIOD
        sample = swell(now)
        sample.time += shifts[k % len(shifts)]
        for topic, message in TOPICS.encode(sample, MESSAGES):
            service.take(TOPICS.inputs[topic], message, now, now)
        if service.model_due(now) is not None:
            published.append(now)
    assert 1 <= len(published) <= 6
    assert min((b - a for a, b in zip(published[:-1], published[1:], strict=True)), default=1.0) >= 0.999


@pytest.mark.parametrize("date", ["yesterday", ".nan", ".inf", "null", "[1, 2]", "2026-01-01", "9" * 400])
def test_a_model_that_is_dated_by_no_time_is_refused_in_one_line(date: str) -> None:
    text = model_to_text(replace(SEED, provenance={})) + f"provenance: {{{LEARNED_AT}: {date}}}\n"
    service = CompensatorService(CRANE, SEED, TOPICS)
    service.offer(parse(text, "friction_model"))
    assert len(service.refused_models) == 1
    assert f"{LEARNED_AT} must be a time in s, found" in service.refused_models[0]
    assert len(service.refused_models[0]) < 200
    assert service.schedule.due(1e12) is None
