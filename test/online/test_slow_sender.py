"""Speeds that come more seldom than the age limit: nothing can be fed forward, and that is said."""

import pytest
from sea import CRANE, SEED, TOPICS, swell

from winch_friction.compensation import CompensatorConfig
from winch_friction.online.compensator import CompensatorService
from winch_friction.online.inputs import ServiceOptions

SLOW = 0.2  # s, a PLC at 5 Hz
SAID = "speeds within max_age 0.1 s: they come 0.2 s apart"


def fed(service: CompensatorService, begin: float, seconds: float, period: float) -> list[float]:
    """What is published in N m while a sea is sent at this period, its last moment at `begin + seconds`."""
    count = round(seconds / period)
    return [service.take_row(swell(begin + (k + 1) * period)).friction_torque for k in range(count)]


@pytest.mark.parametrize("timeout", [0.1, 0.5])
def test_a_sender_too_slow_for_the_age_limit_is_told_as_that(timeout: float) -> None:
    """It was `fading`, all well, with a torque of 0 marked valid, for good."""
    service = CompensatorService(CRANE, SEED, TOPICS, None, ServiceOptions(watchdog_timeout=timeout))
    assert not any(fed(service, 0.0, 5.0, SLOW))
    status = service.status(5.0)
    assert status["state"] == "stale"
    assert status["missing"] == SAID
    assert max(map(abs, fed(service, 5.0, 5.0, 0.02))) > 100.0
    assert service.status(10.0)["state"] == "active"
    assert not service.status(10.0)["missing"]


def test_a_gap_now_and_then_is_no_slow_sender() -> None:
    service = CompensatorService(CRANE, SEED, TOPICS)
    for k in range(5):
        fed(service, k * 1.2, 1.0, 0.02)
        assert not service.status(k * 1.2 + 1.0)["missing"]
        service.take_row(swell((k + 1) * 1.2))
        assert not service.status((k + 1) * 1.2)["missing"]


def test_with_an_age_limit_beyond_its_period_a_slow_sender_is_served() -> None:
    config = CompensatorConfig(max_age=0.3)
    service = CompensatorService(CRANE, SEED, TOPICS, config, ServiceOptions(watchdog_timeout=0.5))
    assert max(map(abs, fed(service, 0.0, 5.0, SLOW))) > 100.0
    assert service.status(5.0)["state"] == "active"


@pytest.mark.parametrize(("late", "told"), [(0, False), (2, False), (3, True), (6, True)])
def test_three_late_samples_in_a_row_are_a_slow_sender(late: int, told: bool) -> None:
    service = CompensatorService(CRANE, SEED, TOPICS, None, ServiceOptions(watchdog_timeout=0.5))
    for k in range(late + 1):
        service.take_row(swell((k + 1) * SLOW))
    assert service.law.status()["missing"] == (SAID if told else "")
    assert (service.law.status()["state"] == "stale") is told
