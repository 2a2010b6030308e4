"""A model whose correction no running node can take out: accepted when it is over, refused when it may be there."""

from dataclasses import replace

import pytest
from sea import CRANE, PERIOD, SEED, TOPICS, Fed, check_invariants, swell

from winch_friction.online.estimator import EstimatorService
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction.correction import Correction
from winch_friction.records.bag_write import MESSAGES

INF = float("inf")


def late_speed(*windows):
    return replace(SEED, name="mended", corrections=(Correction("signal_delay", 0.05, during=windows),))


def test_a_delay_that_is_over_is_accepted_and_reported():
    fed = Fed()
    fed.run(2.0)
    model = late_speed((0.0, 500.0), (700.0, fed.now - 1.0))
    fed.service.load_model(model)
    fed.run(1.0)
    status = fed.service.status(fed.now)
    assert status["state"] == "active"
    assert status["model"] == "mended"
    assert status["past_corrections"] == "signal_delay until 1001 s"
    check_invariants(fed)


@pytest.mark.parametrize("window", [(0.0, INF), (1001.0, 1004.0), (1010.0, 1020.0)])
def test_a_delay_that_is_there_or_is_to_come_is_refused_by_name(window):
    fed = Fed()
    fed.run(2.0)
    fed.service.offer(late_speed((0.0, 500.0), window))
    fed.run(1.0)
    assert "signal_delay" in fed.service.refused_models[0]
    assert fed.service.status(fed.now)["model"] == SEED.name
    assert fed.service.status(fed.now)["state"] == "active"


def test_a_clock_that_is_set_back_into_the_window_stops_the_feedforward_by_name():
    fed = Fed()
    fed.run(2.0)
    fed.service.load_model(late_speed((900.0, 950.0)))
    fed.run(1.0)
    fed.shift = -75.0
    fed.run(1.5)
    assert fed.torque == 0.0
    assert "signal_delay cannot be taken out" in fed.service.status(fed.now)["missing"]
    fed.shift = 0.0
    fed.run(1.5)
    assert abs(fed.torque) > 50.0
    check_invariants(fed)


def test_a_seed_is_judged_by_the_clock_at_the_beginning():
    seed = late_speed((900.0, 950.0))
    with pytest.raises(InputError, match="signal_delay"):
        EstimatorService(CRANE, seed, TOPICS)
    service = EstimatorService(CRANE, seed, TOPICS, since=1000.0)
    for k, begin in enumerate((1000.0, 940.0)):
        for tick in range(30):
            now = 1000.0 + PERIOD * (30 * k + tick)
            sample = swell(now)
            sample.time = begin + PERIOD * tick
            for topic, message in TOPICS.encode(sample, MESSAGES):
                service.take(TOPICS.inputs[topic], message, now, now)
        assert service.last.accepted == (k == 0)
    assert service.missing == ("signal_delay cannot be taken out",)
    assert service.status(now)["state"] == "waiting"
    assert service.status(now)["past_corrections"] == "signal_delay until 950 s"
