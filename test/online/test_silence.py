"""However the inputs fall silent, the torque goes to zero by a ramp, and comes back without a step."""

import math

import pytest
from sea import CRANE, PERIOD, SEED, TOPICS, Fed, check_invariants, swell

from winch_friction.compensation import CompensatorConfig
from winch_friction.online.compensator import HEARTBEAT
from winch_friction.online.estimator import EstimatorService
from winch_friction.online.inputs import ServiceOptions
from winch_friction.records.bag_write import MESSAGES

SPEED = "winch/joint_states"


@pytest.fixture
def fed() -> Fed:
    """A service that has faded in, at full swing."""
    made = Fed()
    made.run(1.4)
    assert abs(made.torque) > 200.0
    return made


def test_silence_begins_a_ramp_within_a_period_of_the_age_limit_and_ends_at_zero(fed: Fed) -> None:
    last, before = fed.torque, fed.now
    said = fed.wait(1.0)
    moved = [now for now, each in fed.published if now > before and abs(each.friction_torque) < abs(last)]
    assert moved[0] - before <= fed.options.watchdog_timeout + 2.0 * PERIOD + 1e-9
    sizes = [abs(each.friction_torque) for each in said]
    assert sizes == sorted(sizes, reverse=True)
    assert said[-1].friction_torque == 0.0
    assert math.copysign(1.0, said[-1].friction_torque) == 1.0  # 0, not -0
    assert {each.state for each in said} == {"stale"}
    assert not any(each.valid for each in said)
    check_invariants(fed)


def test_frozen_stamps_are_silence_although_messages_come(fed: Fed) -> None:
    frozen = fed.now

    def freeze(sample: object) -> None:
        sample.time = frozen

    said = fed.run(1.5, freeze)
    assert said[-1].friction_torque == 0.0
    assert fed.service.status(fed.now)["state"] == "stale"
    assert fed.service.inputs.arrivals[SPEED].reason == "stamp stands still"
    fed.run(1.5)
    assert abs(fed.torque) > 0.0
    check_invariants(fed)


def test_stamps_that_creep_are_silence(fed: Fed) -> None:
    """A microsecond more at each message: advancing, and no time at all."""
    began = fed.now
    creeping = iter(began + 1e-6 * k for k in range(1, 1000))

    def creep(sample: object) -> None:
        sample.time = next(creeping)

    assert fed.run(1.5, creep)[-1].friction_torque == 0.0
    check_invariants(fed)


def test_frozen_stamps_of_the_speed_alone(fed: Fed) -> None:
    """What was seen: live data, a constant stamp on joint_states, the torque held for ever."""
    frozen = swell(fed.now)
    for _ in range(75):
        fed.now += PERIOD
        live = swell(fed.now)
        fed.send(live, skip=(SPEED,))
        stamped = dict(fed.messages(live)) | {SPEED: dict(fed.messages(frozen))[SPEED]}
        fed.hear(fed.service.take(fed.service.inputs.topics.inputs[SPEED], stamped[SPEED], fed.now, fed.now))
        fed.hear(fed.service.tick(fed.now))
    assert fed.torque == 0.0
    check_invariants(fed)


@pytest.mark.parametrize("step", [-0.5, -30.0, -3600.0, 0.3, 7.8, 3600.0])
def test_a_clock_that_is_set_leads_to_no_jump_and_to_life_again(fed: Fed, step: float) -> None:
    fed.shift += step
    fed.run(4.5)
    assert fed.service.law.status()["state"] == "active"
    check_invariants(fed)


@pytest.mark.parametrize("ahead", [2.0, 3600.0])
@pytest.mark.parametrize("topic", [SPEED, "winch/reference", "winch/active/pressure_a"])
def test_one_stamp_ahead_locks_nothing_out(fed: Fed, topic: str, ahead: float) -> None:
    stray = swell(fed.now)
    stray.time += ahead
    message = dict(fed.messages(stray))[topic]
    fed.hear(fed.service.take(fed.service.inputs.topics.inputs[topic], message, fed.now, fed.now))
    said = fed.run(0.4)
    assert {each.state for each in said} <= {"active", "fading"}
    assert fed.service.inputs.arrivals[topic].refused == 1
    check_invariants(fed)


def test_two_senders_with_different_clocks_do_not_tear_the_time(fed: Fed) -> None:
    """One of them is followed, the other one refused; before, every message was a new beginning."""
    for k in range(150):
        fed.now += 0.5 * PERIOD
        sample = swell(fed.now)
        sample.time += 7.8 * (k % 2)
        fed.send(sample)
        fed.hear(fed.service.tick(fed.now))
    check_invariants(fed)
    assert fed.service.inputs.arrivals[SPEED].refused >= 70
    assert fed.service.law.status()["state"] == "active"


def test_a_burst_after_a_stall_moves_the_output_by_the_moment_that_it_takes(fed: Fed) -> None:
    """The process was stopped for 1.5 s; then everything comes at once."""
    late = [swell(fed.now + PERIOD * k) for k in range(1, 76)]
    fed.now += 1.5
    before = fed.torque
    for sample in late:
        fed.send(sample)
    outs = [before, *(said.friction_torque for now, said in fed.published if now == fed.now)]
    assert max(abs(b - a) for a, b in zip(outs[:-1], outs[1:], strict=True)) < 0.3 * abs(before) + 1e-9 or outs[1] == 0
    assert abs(outs[-1] - outs[1]) <= fed.config.slew_limit * fed.config.max_age
    fed.run(1.0)
    check_invariants(fed)


def test_a_silence_in_the_middle_of_a_ramp_comes_back_without_a_step(fed: Fed) -> None:
    fed.wait(0.3)
    middle = fed.torque
    assert 0.0 < abs(middle) < 300.0
    (first, *_) = fed.run(0.5)
    assert abs(first.friction_torque - middle) < 0.15 * 400.0  # a reversal's sample has 170
    check_invariants(fed)


def test_reset_goes_on_from_what_is_published(fed: Fed) -> None:
    before = fed.torque
    fed.service.reset()
    (first, *_) = fed.run(0.5)
    assert abs(first.friction_torque - before) < 0.2 * abs(before)
    check_invariants(fed)


def test_reset_and_then_nothing_ends_at_zero(fed: Fed) -> None:
    fed.service.reset()
    assert fed.wait(1.5)[-1].friction_torque == 0.0
    check_invariants(fed)


def test_the_end_is_a_ramp_to_zero_that_is_published(fed: Fed) -> None:
    before = fed.torque
    said = [each for _, each in fed.service.ending(fed.now)]
    fed.published += [(fed.now + after, each) for after, each in zip(_steps(len(said)), said, strict=True)]
    assert said[-1].friction_torque == 0.0
    assert abs(said[0].friction_torque) < abs(before)
    assert len(said) * PERIOD <= fed.config.ramp_time + PERIOD
    check_invariants(fed)


def _steps(count: int) -> list[float]:
    return [PERIOD * (k + 1) for k in range(count)]


def test_the_end_is_over_before_the_motion_turns() -> None:
    fed = Fed(config=CompensatorConfig(ramp_time=5.0))
    fed.run(2.9 - 1000.0 % 6.0 + 6.0 * 1)  # the speed falls towards its reversal
    while not 0.0 < _until_reversal(fed.now) < 0.3:
        fed.run(PERIOD)
    assert abs(fed.torque) > 100.0
    said = [each for _, each in fed.service.ending(fed.now)]
    assert len(said) * PERIOD <= 0.3 + 0.1 + PERIOD


def _until_reversal(now: float) -> float:
    return 3.0 - now % 3.0


def test_a_lost_pressure_fades_and_never_pushes_against_the_motion(fed: Fed) -> None:
    """While the speed is there, what fades out turns with it."""
    service = Fed(config=CompensatorConfig(ramp_time=3.0))
    service.run(5.6)
    wrong = 0.0
    for _ in range(100):
        (said,) = service.run(PERIOD, skip=("winch/active/pressure_a",))[:1]
        speed = swell(service.now).motor_speed
        wrong = wrong + PERIOD if said.friction_torque * speed < 0.0 and abs(speed) > 3.0 else 0.0
        assert wrong <= 0.1
    check_invariants(service)


def test_a_simulation_that_runs_faster_than_the_clock_is_followed_by_its_stamps() -> None:
    fed = Fed(options=ServiceOptions(watchdog_timeout=5.0))
    for k in range(1, 200):
        fed.now += 0.001
        fed.send(swell(1000.0 + PERIOD * k))
    assert fed.published[-1][1].state == "active"


def test_messages_that_are_none(fed: Fed) -> None:
    joint = "sensor_msgs/msg/JointState"
    header = dict(fed.messages(swell(fed.now)))[SPEED].header
    empty = MESSAGES.make(
        joint, header=header, name=[], position=MESSAGES.doubles([]), velocity=MESSAGES.doubles([]),
        effort=MESSAGES.doubles([]),
    )  # fmt: skip
    for topic, source in fed.service.inputs.topics.inputs.items():
        if source.type_name == joint:
            assert fed.service.take(source, empty, fed.now, fed.now) is None, topic
    assert math.isfinite(fed.torque)
    assert fed.service.inputs.arrivals["winch/reference"].refused == 1
    assert CRANE.absolute_torque_limit == 2000.0


def test_zeros_are_repeated_as_long_as_the_silence_lasts(fed: Fed) -> None:
    """Whoever begins to listen during a silence is told that there is nothing, and by fresh stamps."""
    fed.wait(1.0)
    began = len(fed.published)
    said = fed.wait(10.0)
    assert all(each.friction_torque == 0.0 and not each.valid for each in said)
    stamps = [each.time for each in said]
    assert stamps == sorted(set(stamps))
    times = [now for now, _ in fed.published[began:]]
    apart = [after - before for before, after in zip(times, times[1:], strict=False)]
    assert len(times) >= 10
    assert max(apart) <= HEARTBEAT * fed.options.watch_period + PERIOD + 1e-9


def test_a_clock_that_is_set_back_and_then_silence_ends_at_zero(fed: Fed) -> None:
    """As a node does that goes by the recording's clock, when the bag begins again and no speed comes."""
    last = fed.torque
    fed.now -= 1000.0
    fed.service.reset()
    said = fed.wait(1.5)
    assert said[-1].friction_torque == 0.0
    sizes = [abs(each.friction_torque) for each in said]
    assert sizes == sorted(sizes, reverse=True)
    assert sizes[0] > 0.5 * abs(last)  # a ramp, no step


@pytest.mark.parametrize(
    ("timeout", "simulated", "said"), [(5.0, False, True), (5.0, True, False), (1.0, False, False), (0.1, False, False)]
)
def test_a_watchdog_that_takes_time_for_simulated_is_a_hazard_beside_a_machine(timeout, simulated, said):
    """Nothing was said of it, and whoever wanted more patience had data obeyed however late they came."""
    assert ("never beside a machine" in ServiceOptions(watchdog_timeout=timeout).hazard(simulated)) is said


def test_what_waits_for_a_speed_says_what_is_missing_and_where_it_is_told_why(fed: Fed) -> None:
    """A bare 'stale' or 'waiting' told an operator nothing."""
    assert fed.service.status(fed.now)["missing"] == ""
    fed.wait(1.0)
    silent = fed.service.status(fed.now)
    assert (silent["state"], silent["missing"]) == ("stale", "motor_speed ('inputs' says why)")
    fresh = Fed()
    assert fresh.service.status(fresh.now)["missing"] == "motor_speed ('inputs' says why)"


def test_a_speed_that_comes_and_is_not_believed_is_told_with_its_reason(fed: Fed) -> None:
    """Of twenty inputs that two senders share, one line of 'inputs' said it."""
    held = fed.now
    fed.run(1.0, lambda sample: setattr(sample, "time", held))
    assert fed.service.status(fed.now)["missing"] == "motor_speed, refused: stamp stands still"
    fed.wait(0.5)
    assert fed.service.status(fed.now)["missing"] == "motor_speed ('inputs' says why)"


def test_an_estimator_that_waits_for_a_speed_says_what_is_missing() -> None:
    each, now = EstimatorService(CRANE, SEED, TOPICS), 0.0
    assert each.status(now)["state"] == "waiting"
    assert each.status(now)["missing"] == "motor_speed ('inputs' says why)"
    for topic, message in TOPICS.encode(swell(1000.0), MESSAGES):
        each.take(TOPICS.inputs[topic], message, 1000.0, now)
    assert each.status(now)["missing"] == ""
    assert each.status(now + 1.0)["missing"] == "motor_speed ('inputs' says why)"


def test_a_lateness_of_the_speed_stands_beside_what_else_is_suspicious(monkeypatch: pytest.MonkeyPatch) -> None:
    each = EstimatorService(CRANE, SEED, TOPICS)
    monkeypatch.setattr(type(each.law._filter.considered), "lateness", (0.5, 0.01))
    assert each.status(0.0)["suspicion"].startswith("motor_speed seems late by about 0.5")
