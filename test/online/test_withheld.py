"""A torque that the slew limit could not let go in time is not published, and that is said before it is missed."""

from dataclasses import replace

import pytest
from sea import CRANE, SEED

from winch_friction.compensation import CompensatorConfig, FeedforwardCompensator

LARGE = replace(CRANE, absolute_torque_limit=60e3)  # N m, a winch of 900 t


def test_what_the_slew_limit_withholds_of_what_is_granted_is_said() -> None:
    """Half the friction of a large winch was cut off at 3000 N m, marked valid, and counted only."""
    law = FeedforwardCompensator(LARGE, SEED)
    status = law.status()
    assert status["torque_limit"] == pytest.approx(3000.0)
    assert status["withheld"] == (
        "slew_limit 15000 N*m/s leaves 3000 of 60000 N*m: what cannot be let go within 0.2 s is not published"
    )
    law.configure(CompensatorConfig(slew_limit=3e5))
    assert law.status()["torque_limit"] == 60e3
    assert law.status()["withheld"] == ""


@pytest.mark.parametrize("granted", [3000.0, float("inf")])
def test_nothing_is_withheld_of_what_is_granted_in_full_or_without_a_bound(granted: float) -> None:
    assert FeedforwardCompensator(replace(CRANE, absolute_torque_limit=granted), SEED).status()["withheld"] == ""
