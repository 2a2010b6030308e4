"""Settings that change while the torque is on its way: it moves no faster than before or after, and gets to zero."""

import math
from dataclasses import dataclass, replace

import pytest
from sea import PERIOD, SEED, Fed, check_invariants, swell

from winch_friction.compensation import CompensatorConfig
from winch_friction.compensation.safe_output import SafeOutput
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import Sample

REVERSAL = 1005.0  # s; the swell's speed passes zero there


def sailing(until: float) -> Fed:
    """A service in full swing at `until`."""
    fed = Fed()
    fed.run(until - fed.now)
    assert abs(fed.torque) > 100.0
    return fed


@dataclass
class Against:
    """How long the torque has pushed against the motion at a stretch, s."""

    longest: float = 0.0
    since: float = math.nan

    def look(self, fed: Fed) -> None:
        speed = swell(fed.now).motor_speed
        opposed = fed.torque * speed < 0.0 and abs(fed.torque) > 5.0 and abs(speed) > 5.0
        self.since = math.nan if not opposed else fed.now if math.isnan(self.since) else self.since
        self.longest = max(self.longest, fed.now - self.since if opposed else 0.0)


def test_another_slew_limit_in_the_middle_of_the_ramp_moves_it_no_faster_than_that() -> None:
    """The ramp was computed anew from its beginning, as if the new limit had always held: 0 at once."""
    fed = sailing(REVERSAL + 1.0)
    fed.service.configure(CompensatorConfig(ramp_time=0.5, slew_limit=abs(fed.torque) / 0.2 + 50.0))
    fed.run(PERIOD)
    fed.wait(0.2)
    assert abs(fed.torque) > 100.0
    fed.service.configure(fed.config)
    fed.wait(0.5)
    assert fed.torque == 0.0
    check_invariants(fed)


def test_a_shorter_age_limit_does_not_count_what_the_stamps_fell_behind_under_the_longer_one() -> None:
    """Slow stamps, an age limit of 0.5 s, then 0.1 s again: the difference counted as time that had passed."""
    fed = sailing(REVERSAL + 1.0)
    fed.service.configure(CompensatorConfig(ramp_time=0.5, max_age=0.5))
    for _ in range(50):
        fed.shift -= 0.5 * PERIOD
        fed.run(PERIOD, skip=("winch/reference",))
    fed.service.configure(CompensatorConfig(ramp_time=0.5, slew_limit=2000.0))
    fed.config = CompensatorConfig(ramp_time=0.5, slew_limit=2000.0)
    before = len(fed.published) - 1
    fed.run(0.3, skip=("winch/reference",))
    fed.published = fed.published[before:]
    check_invariants(fed)


def test_a_shorter_age_limit_in_a_silence_does_not_stop_the_ramp() -> None:
    """Its stamps began after the longer one, and waited for the shorter one to reach them."""
    fed = sailing(REVERSAL + 1.0)
    fed.service.configure(CompensatorConfig(ramp_time=0.5, max_age=0.5, slew_limit=2500.0))
    fed.run(2 * PERIOD)
    fed.wait(0.2)
    assert abs(fed.torque) > 100.0
    fed.service.configure(fed.config)
    fed.wait(0.5)
    assert fed.torque == 0.0
    fed.run(1.5)
    assert abs(fed.torque) > 50.0
    check_invariants(fed)


def test_a_shorter_ramp_does_not_raise_what_is_carried_over() -> None:
    """A difference that 60 s were to let go counted a hundredfold when it got 0.5 s."""
    fed = sailing(REVERSAL + 0.5)
    slow = CompensatorConfig(ramp_time=60.0, scale=0.5)
    fed.service.configure(slow)  # carried over: the difference between two scales
    fed.run(0.3)
    fed.run(8 * PERIOD, skip=("winch/reference",))
    before = abs(fed.torque)
    fed.service.configure(CompensatorConfig(ramp_time=0.5, scale=0.5))
    said = fed.run(0.5, skip=("winch/reference",))
    assert max(abs(each.friction_torque) for each in said) <= before
    check_invariants(fed)


def test_a_reversal_that_is_spread_further_does_not_hold_up_what_pushes_against_the_motion() -> None:
    """The slew that such a reversal needs, 560 N m/s, was all that what is published got as well."""
    fed = sailing(REVERSAL - 0.1)
    fed.service.configure(CompensatorConfig(ramp_time=0.5, reversal_time=1.0))
    against = Against()
    for _ in range(60):
        fed.run(PERIOD)
        against.look(fed)
    assert against.longest <= 0.35
    check_invariants(fed)


@pytest.mark.parametrize("silent", [True, False])
def test_nor_where_nothing_carries_it_any_more(silent: bool) -> None:
    fed = sailing(REVERSAL - 0.1)
    fed.service.configure(CompensatorConfig(ramp_time=0.5, reversal_time=1.0))
    fed.run(8 * PERIOD)
    assert fed.torque * swell(fed.now).motor_speed < 0.0
    began = fed.now
    if silent:
        fed.wait(0.6)
    else:
        fed.run(0.6, skip=("winch/reference", "winch/active/pressure_a"))
    late = [
        now - began for now, said in fed.published if now > began and said.friction_torque > 5.0
    ]  # the motion is negative
    assert max(late, default=0.0) <= 0.35
    check_invariants(fed)


@pytest.mark.parametrize("reversal_time", [0.3, 1.0])
def test_what_nothing_carries_goes_as_quickly_where_a_reversal_is_spread(reversal_time: float) -> None:
    """The slew that a spread reversal needs (1 s: 560 N m/s) was all that a ramp to zero got: 0.7 s blind, while the
    motion may turn. Drawn sequences had pushed against it for up to 0.11 s too long."""
    fed = sailing(REVERSAL + 1.2)
    fed.service.configure(CompensatorConfig(ramp_time=0.5, reversal_time=reversal_time))
    fed.run(PERIOD)
    assert abs(fed.torque) > 350.0
    fed.wait(0.46)  # age limit, 0.3 s blind, three periods of the watchdog
    assert fed.torque == 0.0
    check_invariants(fed)


def test_nor_does_a_short_ramp_take_longer_where_an_input_is_lost() -> None:
    fed = sailing(REVERSAL + 1.2)
    fed.service.configure(CompensatorConfig(ramp_time=0.3, reversal_time=1.0))
    fed.run(PERIOD)
    fed.run(0.1 + 0.3 + 3 * PERIOD, skip=("winch/active/pressure_a",))
    assert fed.torque == 0.0
    check_invariants(fed)


def test_no_more_is_published_than_the_slew_limit_lets_go_in_time() -> None:
    """At 1000 N m/s the 380 N m would have pushed against the motion for 0.4 s at every reversal."""
    fed = Fed(CompensatorConfig(ramp_time=0.5, slew_limit=1000.0))
    fed.run(8.0)
    largest = max(abs(said.friction_torque) for _, said in fed.published)
    assert largest == pytest.approx(200.0)  # N m; 0.2 s of it
    check_invariants(fed)


def test_a_slew_limit_that_is_too_low_for_what_is_published_is_refused_in_one_line_and_changes_nothing() -> None:
    fed = sailing(REVERSAL + 1.2)
    with pytest.raises(
        InputError, match=r"slew_limit 100 N\*m/s cannot let go of the 3.. N\*m.*at least 1..."
    ) as refused:
        fed.service.configure(CompensatorConfig(ramp_time=0.5, slew_limit=100.0))
    assert "\n" not in str(refused.value)
    assert fed.service.law.config == fed.config
    fed.service.set_enabled(False)
    fed.run(1.0)
    fed.service.configure(CompensatorConfig(ramp_time=0.5, slew_limit=100.0))
    check_invariants(fed)


@pytest.mark.parametrize("ages", [{"max_age": 0.51}, {"max_ages": {"speed_reference": 3600.0}},
                                  {"max_ages": {"active.pressure_a": 1.0}}])  # fmt: skip
def test_an_input_that_turns_with_the_waves_cannot_be_declared_fresh_for_long(ages: dict) -> None:
    with pytest.raises(InputError, match=r"max_age.* 0\.5"):
        CompensatorConfig(**ages)


def test_slow_stamps_do_not_hold_up_what_pushes_against_the_motion_where_a_reversal_is_spread() -> None:
    """Its 0.2 s were counted by stamps that went at 0.3 of the clock's pace: 0.5 s against the motion."""
    fed = Fed()
    fed.run(REVERSAL - 0.6 - fed.now)
    fed.service.configure(CompensatorConfig(ramp_time=0.5, reversal_time=1.0))
    against = Against()
    for _ in range(80):
        fed.shift -= 0.7 * PERIOD
        late = fed.now > REVERSAL - 0.3
        fed.run(PERIOD, skip=("winch/reference", "winch/active/pressure_a") if late else ())
        against.look(fed)
    assert against.longest <= 0.3
    check_invariants(fed)


@pytest.mark.parametrize("age", [0.2, 4.0])
def test_an_inputs_own_age_limit_is_the_one_that_was_set_last(age: float) -> None:
    fed = sailing(REVERSAL + 1.0)
    fed.service.configure(CompensatorConfig(ramp_time=0.5, max_age=0.3, max_ages={"hook_load": age}))
    limit = fed.service.inputs.hold.limit
    assert limit("hook_load") == age
    assert limit("wire_layer") == limit("active.pressure_a") == 0.3


@pytest.mark.parametrize(("lead", "doubted"), [(0.0, True), (0.4, False)])
def test_the_command_may_be_ahead_of_the_speed_by_the_lead_that_was_set_last(lead: float, doubted: bool) -> None:
    fed = sailing(REVERSAL + 1.0)
    fed.service.configure(CompensatorConfig(ramp_time=0.5, lead=lead))

    def turned(sample: Sample) -> None:
        sample.speed_reference = -sample.motor_speed

    fed.run(0.3, turned)
    assert ("speed_reference turns against motor_speed" in fed.service.contradictions) is doubted


def test_gains_that_leave_no_friction_leave_no_torque():
    """The slew limit is as steep as the friction that is left: of none it was zero, and the last torque stood."""
    fed = Fed()
    fed.run(5.4)
    assert abs(fed.torque) > 100.0
    fed.service.configure(replace(fed.config, gains=dict.fromkeys(SEED.term_names, 0.0)))
    told = fed.run(1.2)
    assert told[-1].friction_torque == 0.0
    check_invariants(fed)


def test_what_is_more_than_it_may_be_goes_in_time():
    """A load that is set down leaves a small friction, whose reversal is slow: what is beyond its bound is not held."""
    output = SafeOutput(absolute=1000.0, slew=1.5e4, ramp_time=0.5, hold=0.1)
    for k in range(100):
        output.arrive(0.02 * k)
        bound = 400.0 if k < 50 else 20.0
        output.restrict(10.0 * bound / 20.0)
        output.follow(bound, bound, usable=True, enabled=True, motion=50.0)
        if k == 49:
            output.torque = output._held = 400.0
    assert output.torque == pytest.approx(20.0)
