"""A torque that the slew limit could not let go in time is not published, and that is said before it is missed."""

from dataclasses import replace

import pytest
from sea import CRANE, SEED, Fed

from winch_friction.compensation import CompensatorConfig, FeedforwardCompensator
from winch_friction.physics.signals import Sample

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


@pytest.mark.parametrize(
    ("of_floor", "said"),
    [
        (1.0, []),
        (0.5, ["50% of the pressure is fed forward: the displacement of active is below min_displacement (0.2)"]),
        (0.0, ["0% of the pressure is fed forward: the displacement of active is below min_displacement (0.2)"]),
    ],
)
def test_a_pressure_that_is_not_fed_forward_of_a_torque_that_is_has_its_reason(of_floor: float, said: list) -> None:
    """A feedback at zero left 356 N m of torque, `valid`, no pressure and not a word."""
    fed = Fed(CompensatorConfig(ramp_time=0.5, min_displacement=0.2))

    def spoil(sample: Sample) -> None:
        sample.groups["active"].displacement = of_floor * 0.2 * CRANE.max_displacement

    last = fed.run(2.0, spoil)[-1]
    assert last.valid
    assert fed.service.warnings(fed.now) == said
    assert fed.service.warnings(fed.now + 10.0) == [], "of what is stale the silence is said"


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ({"scale": 1.0}, []),
        ({"scale": 0.9, "gains": {"stribeck": 1.0}}, []),
        ({"scale": 0.9, "gains": {"stribeck": 1.5}}, ["135%"]),
        ({"scale": 1.3}, ["130%"]),
        ({"scale": 1.3, "gains": dict.fromkeys(SEED.term_names, 0.7)}, []),
        ({"scale": 0.9, "gains": {"churning": 1.5}}, []),
    ],
)
def test_more_than_the_whole_model_is_compensated_under_a_warning(settings: dict, said: list) -> None:
    warnings = Fed(CompensatorConfig(**settings)).service.warnings(1000.0)
    assert [each.split(" of the model")[0].split()[-1] for each in warnings] == said
