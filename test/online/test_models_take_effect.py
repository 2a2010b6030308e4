"""When the service takes a learned model over: after its delay, as that is set now, and never across a jump of time."""

from dataclasses import replace

from sea import SEED, Fed

from winch_friction.online.compensator import LEARNED_AT
from winch_friction.online.inputs import ServiceOptions
from winch_friction.records.model_file import load_model


def learned(at: float):
    return replace(SEED, name="learned", provenance={LEARNED_AT: at})


def test_a_learned_model_takes_effect_after_its_delay() -> None:
    fed = Fed()
    fed.run(0.1)
    fed.service.offer(learned(fed.now))
    fed.run(0.4)
    assert fed.service.law.model is SEED
    fed.run(0.2)
    assert fed.service.law.model.name == "learned"


def test_a_model_that_waits_is_forgotten_when_everything_begins_anew() -> None:
    fed = Fed()
    fed.run(0.1)
    fed.service.offer(learned(fed.now))
    fed.service.reset()
    fed.run(1.0)
    assert fed.service.law.model is SEED


def test_another_delay_counts_from_the_next_model_on() -> None:
    fed = Fed()
    fed.run(0.1)
    fed.service.configure(fed.config, ServiceOptions(model_delay=2.0))
    fed.service.offer(learned(fed.now))
    fed.run(1.0)
    assert fed.service.law.model is SEED
    fed.run(1.2)
    assert fed.service.law.model.name == "learned"


def test_a_refusal_is_told_until_a_learned_model_is_taken_over() -> None:
    fed = Fed()
    fed.run(0.1)
    fed.service.offer(replace(load_model("a6vm215"), provenance={LEARNED_AT: fed.now}))
    fed.run(0.6)
    assert "was learned of another one" in str(fed.service.status(fed.now)["learned_model_refused"])
    fed.service.offer(learned(fed.now))
    fed.run(0.6)
    assert fed.service.status(fed.now)["learned_model_refused"] == ""


def test_the_last_ramp_is_dated_from_the_end_and_not_from_the_last_speed() -> None:
    """Its stamps would lie behind those that the watchdog of a replay gives the same moments."""
    fed = Fed()
    fed.run(2.3)
    last = fed.published[-1][1].time
    fed.now += 0.08
    stamps = [said.time for _, said in fed.service.ending(fed.now)]
    assert stamps[0] > last + 0.08
    assert stamps[0] <= last + 0.08 + 0.021
