"""An input without a stamp is as old as its arrival says, whenever the speed comes that dates it."""

import math

import pytest
from sea import PERIOD, START, TOPICS, Fed, swell

from winch_friction.online.inputs import ServiceOptions
from winch_friction.physics.channels import SLOW_INPUTS

LOAD = "winch/hook_load"


def loads(fed: Fed, waited: float) -> float:
    """The load in the sample of a speed that comes `waited` s after a load that nothing followed, kg."""
    gate, loads = fed.service.inputs, []
    fed.now += 0.02
    messages = dict(fed.messages(swell(fed.now)))
    gate.take(TOPICS.inputs[LOAD], messages.pop(LOAD), fed.now, fed.now)
    fed.now += waited
    for topic, message in fed.messages(swell(fed.now)):
        if topic != LOAD:
            loads.append(gate.take(TOPICS.inputs[topic], message, fed.now, fed.now))
    return loads[-1].hook_load


@pytest.mark.parametrize(("waited", "there"), [(0.5, True), (0.9, True), (1.1, False), (30.0, False)])
def test_a_load_that_waited_for_a_speed_is_no_younger_for_it(waited: float, there: bool) -> None:
    """It was dated by the speed, as if it had been measured then."""
    fed = Fed()
    fed.run(0.5)
    assert math.isfinite(loads(fed, waited * SLOW_INPUTS["hook_load"])) is there


def test_a_load_that_stopped_stays_lost_while_speeds_go_on() -> None:
    fed = Fed()
    fed.run(0.5)
    assert math.isnan(loads(fed, 1.5 * SLOW_INPUTS["hook_load"]))
    fed.now += 0.02
    samples = [
        fed.service.inputs.take(TOPICS.inputs[topic], message, fed.now, fed.now)
        for topic, message in fed.messages(swell(fed.now))
        if topic != LOAD
    ]
    assert math.isnan(samples[-1].hook_load)


@pytest.mark.parametrize(("timeout", "state"), [(2.0, "fading"), (0.9, "stale")])
def test_a_slow_simulation_makes_no_input_old(timeout: float, state: str) -> None:
    """A pressure in every second scan is 0.02 s old, however long the simulator takes for one."""
    fed = Fed(options=ServiceOptions(watchdog_timeout=timeout))
    for k in range(20):
        fed.now += 0.15
        sample = swell(START + k * PERIOD)
        fed.send(sample, skip=("winch/active/pressure_a",) if k % 2 else ())
    assert fed.published[-1][1].state == state
