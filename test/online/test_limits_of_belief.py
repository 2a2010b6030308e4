"""Where exactly belief ends: stamps, readings, voices, motions, models and silences, at and beside each limit."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from sea import CRANE, SEED, START, TOPICS, Fed, swell

from winch_friction.compensation.safe_output import AGAINST_SPEED, LONGEST_LAG
from winch_friction.online import before_doubt, intake
from winch_friction.online.agreement import (
    Agreement,
    Motions,
    Stamp,
    StampWatch,
    Voices,
)
from winch_friction.online.before_doubt import BeforeDoubt
from winch_friction.online.compensator import (
    CompensatorService,
    ModelSchedule,
    mark,
    read_mark,
    refuse_other_terms,
)
from winch_friction.online.consumer import HeldTorque
from winch_friction.online.estimator import EstimatorService
from winch_friction.online.inertia_balance import InertiaBalance, _Smooth
from winch_friction.online.inputs import ServiceOptions
from winch_friction.online.intake import ModelIntake, parse
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import GroupSample, Sample
from winch_friction.physics.winch.operating_point import Change, ChannelRanges
from winch_friction.records.sample_stream import Plausibility

RANGES = ChannelRanges(CRANE, TOPICS.groups)


# -- stamps
@pytest.mark.parametrize(
    ("gained", "passed", "worth"),
    [
        (-1.0, 1.0, Stamp.LATE),
        (-1.001, 1.0, Stamp.BACK),
        (0.0, 0.0, Stamp.REPEATED),
        (1.5, 1.0, Stamp.GOOD),  # half a second ahead of the clock
        (1.501, 1.0, Stamp.AHEAD),
        (0.025, 0.25, Stamp.GOOD),  # a tenth of the clock's pace
        (0.0249, 0.25, Stamp.REPEATED),
        (0.101, 30.0, Stamp.GOOD),  # of a pause of a second at most
        (0.099, 30.0, Stamp.REPEATED),
        (0.25, -5.0, Stamp.AHEAD),
    ],
)
def test_a_stamp_is_good_between_a_tenth_of_the_clocks_pace_and_half_a_second_ahead_of_it(gained, passed, worth):
    watch = StampWatch()
    assert watch.judge(64.0, 8.0) is Stamp.GOOD
    assert watch.judge(64.0 + gained, 8.0 + passed) is worth
    watch.forget()
    assert watch.judge(64.0 + gained, 8.0 + passed) is Stamp.GOOD


@pytest.mark.parametrize(
    ("period", "arriving", "at"),
    [
        (0.02, 0.02, 5),  # five messages
        (0.01, 0.02, 9),  # 0.08 s by their stamps
        (0.02, 0.005, 11),  # that came over 0.05 s
        (0.02, 0.0, None),  # a burst
    ],
)
def test_a_clock_that_was_set_is_believed_after_messages_time_and_arrivals(period, arriving, at):
    watch = StampWatch()
    watch.judge(100.0, 0.0)
    worths = [watch.judge(5000.0 + period * k, 1.0 + arriving * k) for k in range(30)]
    assert (worths.index(Stamp.JUMP) + 1 if Stamp.JUMP in worths else None) == at


def test_messages_of_a_third_clock_or_that_go_back_begin_the_counting_anew():
    watch = StampWatch()
    watch.judge(100.0, 0.0)
    for shift in (0.0, 0.3):  # more than a quarter of a second apart
        worths = [watch.judge(5000.0 + shift + 0.02 * k, 1.0 + shift / 10 + 0.02 * k) for k in range(4)]
        assert worths == [Stamp.AHEAD] * 4
    assert watch.judge(4999.0, 1.2) is Stamp.AHEAD


# -- single readings
USUAL = Change(per_second=20.0, at_once=0.5)


def plausible(lower=-10.0, upper=10.0, change=USUAL):
    return Plausibility(SimpleNamespace(range=lambda column: (lower, upper), change=lambda column: change))


@pytest.mark.parametrize(
    ("value", "refusal"),
    [(10.0, ""), (-10.0, ""),
     (10.01, "10.01 rad/s is outside -10 ... 10 rad/s: sent in rpm? Inputs are in rad/s"),
     (-96.0, "-96 rad/s is outside -10 ... 10 rad/s"),
     (math.nan, "no number"), (math.inf, "inf rad/s is outside -10 ... 10 rad/s")],
)  # fmt: skip
def test_a_reading_is_believed_within_its_range(value, refusal):
    assert plausible(change=None).refusal("motor_speed", 0.0, value) == refusal


@pytest.mark.parametrize(
    ("passed", "value", "refusal"),
    [
        (0.125, 3.0, ""),
        (0.125, -3.0, ""),
        (0.125, 3.01, "3.01 is 3.01 from the last"),
        (0.125, -3.01, "-3.01 is 3.01 from the last"),
        (-0.1, 0.5, ""),
        (-0.1, 0.51, "0.51 is 0.51 from the last"),
        (0.0, 0.6, "0.6 is 0.6 from the last"),
        (0.999, 9.9, ""),
        (1.0, 9.9, ""),
        (-1.0, 9.9, ""),
        (-0.999, 9.9, "9.9 is 9.9 from the last"),
    ],
)
def test_a_reading_changes_no_faster_than_it_can_unless_a_second_has_passed(passed, value, refusal):
    watch = plausible()
    assert watch.refusal("wire_layer", 100.0, 0.0) == ""
    assert watch.refusal("wire_layer", 100.0 + passed, value) == refusal
    # what was refused is not what the next one is compared with
    assert (watch.refusal("wire_layer", 100.0 + passed, 0.0) == "") is (bool(refusal) or abs(value) <= 0.5)
    watch.forget()
    assert watch.refusal("wire_layer", 100.0 + passed, value) == ""


def test_how_far_a_reading_jumped_is_told_from_the_last():
    watch = plausible()
    watch.refusal("motor_speed", 100.0, 2.0)
    assert watch.refusal("motor_speed", 100.0, 9.0) == "9 rad/s is 7 from the last"
    assert watch.refusal("motor_speed", 100.0, -9.0) == "-9 rad/s is 11 from the last"


def test_a_run_is_believed_where_every_reading_of_it_is():
    """The first row is the first there is; some runs by chance are smooth, some jump, pause or leave the range."""
    rng, outcomes = np.random.default_rng(3), set()
    for _ in range(120):
        time = np.cumsum(rng.choice([0.01, 0.05, 0.9, 1.0, 1.1], 12, p=[0.4, 0.4, 0.05, 0.1, 0.05]))
        values = np.cumsum(rng.choice([0.1, 0.6, -0.4, 1.4, -1.4, 9.0], 12, p=[0.4, 0.2, 0.3, 0.04, 0.04, 0.02]))
        one = plausible()
        told = [one.refusal("wire_layer", t, v) for t, v in zip(time, values, strict=True)]
        assert plausible().believes("wire_layer", time, values) is (not any(told))
        outcomes.add(not any(told))
    assert outcomes == {True, False}
    bare = plausible(change=None)
    assert bare.believes("wire_layer", np.arange(3.0), np.array([-10.0, 10.0, 0.0]))
    assert not bare.believes("wire_layer", np.arange(3.0), np.array([-10.0, 10.1, 0.0]))
    assert not bare.believes("wire_layer", np.arange(3.0), np.array([-10.0, math.nan, 0.0]))
    seen = plausible()
    seen.refusal("wire_layer", 0.0, 0.0)
    assert not seen.believes("wire_layer", np.arange(3.0), np.zeros(3))


# -- one voice, one motion
def said(speed, stamp=10.0):
    seconds = math.floor(stamp)
    at = SimpleNamespace(stamp=SimpleNamespace(sec=seconds, nanosec=round((stamp - seconds) * 1e9)))
    return SimpleNamespace(header=at, name=["winch_motor"], position=[], velocity=[speed], effort=[])


@pytest.mark.parametrize(
    ("one", "other", "stamp", "apart", "doubted"),
    [
        (100.0, 80.0, 10.0, 0.001, False),  # a fifth of the larger
        (100.0, 79.9, 10.0, 0.001, True),
        (-80.0, -100.1, 10.0, 0.001, True),
        (100.0, -100.0, 10.0, 0.005, True),
        (100.0, -100.0, 10.0, 0.0051, False),
        (100.0, -100.0, 10.02, 0.001, False),
    ],
)
def test_copies_of_one_instant_may_differ_by_a_fifth(one, other, stamp, apart, doubted):
    voices, source = Voices(RANGES), TOPICS.inputs[TOPICS.speed_topic]
    assert not voices.contradict(source, said(one), 0.0)
    assert voices.contradict(source, said(other, stamp), apart) is doubted
    assert voices.contradict(source, said(other, 11.0), apart + 0.499) is doubted
    assert not voices.contradict(source, said(other, 12.0), apart + 0.501)


def test_what_is_near_zero_for_its_channel_differs_by_no_share_of_itself():
    near = 0.02 * RANGES.range("motor_speed")[1]
    voices = Voices(RANGES)
    assert not voices._differ({"motor_speed": 0.45 * near}, {"motor_speed": -0.45 * near})
    assert voices._differ({"motor_speed": 0.55 * near}, {"motor_speed": -0.55 * near})
    assert not voices._differ({"motor_speed": 100.0}, {"hook_load": -100.0})  # nothing that both say
    for column in ("active.pressure_a", "oil_temperature", "hook_load"):  # whose range is not as far both ways
        lower, upper = RANGES.range(column)
        assert abs(lower) < upper
        assert voices._reach(column) == upper


@pytest.mark.parametrize(
    ("turns", "every", "columns", "two"),
    [
        (5, 0.1, ("motor_speed", "speed_reference"), True),  # four turns of each
        (4, 0.1, ("motor_speed", "speed_reference"), False),
        (5, 0.4, ("motor_speed", "speed_reference"), False),  # in a second
        (9, 0.1, ("motor_speed",), False),
        (9, 0.1, ("speed_reference", "stamps"), False),
    ],
)
def test_two_motions_are_those_of_which_speed_and_command_turn_to_and_fro(turns, every, columns, two):
    motions, reach = Motions(RANGES), RANGES.speed
    now = 50.0
    for k in range(turns + 1):
        now = 50.0 + every * k
        for column in columns:
            if column == "stamps":
                motions.note(now)
            else:
                motions.hear(column, 0.001 * k, reach * (0.3 if k % 2 else -0.3), now)
    assert motions.two(now) is two
    assert motions.two(now + 0.49) is two
    if two:
        assert not motions.two(now + 5.0)


def test_what_heave_asks_for_between_late_messages_is_no_turn():
    """A fifth of the largest speed in a second, of a tenth of a second at most, besides two hundredths of it."""
    for extra, turned in ((0.99, 0), (1.01, 1)):
        motions, reach = Motions(RANGES), RANGES.speed
        largest = 0.02 + 0.2 * 0.1
        for k in range(3):
            motions.hear("motor_speed", 0.5 * k, 0.5 * extra * largest * reach * (1 if k % 2 else -1), 0.1 * k)
        assert len(motions._turns.get("motor_speed", ())) == turned


# -- the command beside the speed
def agreement():
    return Agreement(CRANE, RANGES)


@pytest.mark.parametrize(
    ("command", "speed", "differ"),
    [(1.0, 1.0, False), (1.0, 0.601, False), (1.0, 0.599, True), (-1.0, -0.599, True), (0.599, 1.0, True),
     (0.05, -0.05, None), (0.1, 0.0, None), (0.101, 0.1, False), (math.nan, 1.0, None)],
)  # fmt: skip
def test_command_and_speed_may_differ_by_three_tenths_and_a_tenth_of_the_largest(command, speed, differ):
    of = RANGES.speed
    assert agreement()._speeds_differ(Sample(1.0, speed * of, command * of)) is differ


@pytest.mark.parametrize(
    ("speed", "command", "against"),
    [(1.1, -0.01, True), (-1.1, 0.01, True), (1.1, 0.01, False), (-1.1, -5.0, False), (0.9, -5.0, None),
     (1.1, 0.0, None), (math.nan, 1.0, None), (2.0, math.nan, None)],
)  # fmt: skip
def test_a_command_turns_against_a_speed_that_has_a_direction(speed, command, against):
    least = AGAINST_SPEED * CRANE.speed_scale
    assert agreement()._turns_against(Sample(1.0, speed * least, command * least)) is against


@pytest.mark.parametrize(("steps", "every", "share", "chatters"), [
    (6, 0.05, 0.11, True), (4, 0.05, 0.11, False), (6, 0.05, 0.09, False), (9, 0.17, 0.11, False),
    (9, 0.16, 0.11, True),
])  # fmt: skip
def test_a_command_chatters_that_jumps_to_and_fro_four_times_in_half_a_second(steps, every, share, chatters):
    own, told = agreement(), False
    for k in range(steps):
        command = share * RANGES.speed * (k % 2)
        told = own._chatters(Sample(10.0 + every * k, 0.0, command))
        assert own._chatters(Sample(10.0 + every * k, 0.0, command)) is told  # held: no jump more
    assert told is chatters


def test_a_command_against_the_speed_is_said_after_its_lead_and_the_longest_lag():
    for lead in (0.0, 0.25):
        own, least = Agreement(CRANE, RANGES, lead=lead), 2.0 * AGAINST_SPEED * CRANE.speed_scale
        told = [bool(own.contradictions(Sample(0.01 * k, least, -least), 0.01 * k)) for k in range(100)]
        assert 0.01 * told.index(True) == pytest.approx(lead + LONGEST_LAG, abs=0.021)


# -- learned models
def dated(at, name="m"):
    return SimpleNamespace(name=name, provenance={} if at is None else {"learned_at": at})


def test_a_model_takes_effect_its_delay_after_its_date_and_the_newest_that_is_due():
    schedule = ModelSchedule(0.5)
    later, first, undated = dated(12.0), dated("10"), dated(None)
    schedule.offer(later), schedule.offer(first)
    assert schedule.due(10.4999) is None
    assert schedule.due(10.5) is first
    assert schedule.due(12.4999) is None
    schedule.offer(undated)
    assert schedule.due(-1e9) is undated
    schedule.offer(first)
    assert schedule.due(13.0) is later
    assert schedule.due(1e9) is None
    schedule.offer(later)
    schedule.clear()
    assert schedule.due(1e9) is None


def test_of_too_many_models_those_furthest_ahead_go():
    schedule = ModelSchedule(0.0)
    models = [dated(float(k)) for k in range(120)]
    for each in models[::-1]:
        schedule.offer(each)
    assert schedule.due(1e9) is models[99]


@pytest.mark.parametrize("at", ["soon", math.nan, math.inf, [1.0]])
def test_a_date_is_a_time(at):
    with pytest.raises(InputError, match=r"^model 'm': learned_at must be a time in s, found"):
        ModelSchedule().offer(dated(at))


def test_other_terms_are_told_by_what_lacks_and_what_is_besides():
    def of(name, *terms, corrections=()):
        return SimpleNamespace(name=name, term_names=terms, corrections=[SimpleNamespace(name=c) for c in corrections])

    refuse_other_terms(of("a", "x", "y"), of("b", "y", "x"))
    with pytest.raises(InputError) as refused:
        refuse_other_terms(of("new", "x", "z", corrections=["delay"]), of("own", "x", "y"))
    assert str(refused.value) == (
        "model 'new' was learned of another one than 'own': it lacks y and it has besides delay, z; start the "
        "estimator on the model_file of 'own'"
    )


@pytest.mark.parametrize(("text", "found"), [
    ("valid 7", (True, 7)), ("invalid 12", (False, 12)), ("invalid", (True, -1)), ("map", (True, -1)), ("", (True, -1)),
    ("valid -3", (True, -1)), ("other 7", (True, -1)), ("invalid 1.5", (True, -1)),
])  # fmt: skip
def test_a_mark_is_read_as_it_is_written_and_other_text_is_none(text, found):
    assert read_mark(text) == found
    if found[1] >= 0:
        assert mark(*found) == text


# -- silence
@pytest.mark.parametrize(("timeout", "period", "paced", "hazard"), [
    (0.1, 0.02, True, False), (0.05, 0.01, True, False), (1.0, 0.02, True, False), (1.1, 0.02, False, True),
])  # fmt: skip
def test_how_often_a_watchdog_looks_and_what_is_real_time(timeout, period, paced, hazard):
    options = ServiceOptions(timeout)
    assert (options.watch_period, options.paced) == (pytest.approx(period), paced)
    assert bool(options.hazard(False)) is hazard
    assert options.hazard(True) == ""


def service(**options):
    return CompensatorService(CRANE, SEED, TOPICS, options=ServiceOptions(**options))


def row(time):
    groups = {name: GroupSample(2e7, 25e5, CRANE.max_displacement) for name in TOPICS.groups}
    return Sample(time, 50.0, 50.0, groups=groups, hook_load=55e3)


def test_a_silence_is_stepped_through_in_watch_periods_after_the_time_out():
    own = service()
    assert own._due_steps(1e9) == 0  # nothing was ever heard
    own.take_row(row(1000.0), 70.0)
    for silence, steps in ((0.0, 0), (0.1, 0), (0.119, 0), (0.121, 1), (0.139, 1), (0.141, 2), (1.101, 50)):
        assert own._due_steps(70.0 + silence) == steps
    assert own.inputs.silence(70.25) == pytest.approx(0.25)
    assert own.inputs.silence(60.0) == 0.0  # a clock that was set back counts from there
    assert own.inputs.silence(60.5) == pytest.approx(0.5)


def test_the_ramp_is_stamped_on_a_grid_from_the_age_limit_on_and_then_beats_now_and_then():
    own = service()
    for k in range(200):
        own.take_row(swell(1000.0 + 0.02 * k), 70.0 + 0.02 * k)
    last, now = 1000.0 + 0.02 * 199, 70.0 + 0.02 * 199
    assert abs(own.law.output.torque) > 50.0
    stamps = [each.time for each in own.catch_up(now + 20.0)]
    assert len(stamps) > 5
    assert stamps == pytest.approx([last + 0.1 + 0.02 * (k + 0.5) for k in range(len(stamps))])
    assert own.law.output.at_rest
    silent = [own.tick(now + 0.1 + 0.02 * steps + 0.001) for steps in range(len(stamps) + 1, 400)]
    beats = [len(stamps) + 1 + k for k, each in enumerate(silent) if each is not None]
    assert np.diff(beats).tolist() == [25] * (len(beats) - 1)  # half a second
    assert all(each % 25 == 0 for each in beats)
    assert len(beats) > 5


def test_settings_are_taken_over_by_everything_that_goes_by_them():
    own = service()
    config = replace(own.law.config, lead=0.05, load=40e3, max_age=0.3, max_ages={"hook_load": 7.0})
    own.configure(config, ServiceOptions(0.2, model_delay=2.0))
    hold = own.inputs.hold
    assert (own.schedule.delay, own._agreement.lead, own._agreement.load) == (2.0, 0.05, 40e3)
    assert (hold.max_age, hold.limit("hook_load"), hold.limit("motor_speed")) == (0.3, 7.0, 0.3)
    own.configure(config)
    assert own.options.watchdog_timeout == 0.2


def test_an_input_may_be_stamped_as_far_ahead_as_the_window_after_the_time_since_the_speed():
    for options, window in (({}, 0.5), ({"watchdog_timeout": 0.9}, 0.9), ({"stamp_window": 2.0}, 2.0)):
        gate = service(**options).inputs
        assert gate._near(1e9, 70.0)  # no speed yet
        assert not gate._near(math.inf, 70.0)
        gate.fill(row(1000.0), 70.0)
        for passed in (0.0, 0.25):
            assert gate._near(1000.0 + passed + window - 1e-3, 70.0 + passed)
            assert not gate._near(1000.0 + passed + window + 1e-3, 70.0 + passed)
        assert not gate._near(1000.0 + window + 1e-3, 69.0)  # a clock that was set back gives no credit


@pytest.mark.parametrize(("ahead", "kept"), [(0.0, True), (0.45, True), (0.55, False), (1e6, False)])
def test_what_came_before_the_first_speed_is_held_unless_it_is_stamped_beyond_the_window(ahead, kept):
    """A stamp of a time to come would lock the input out until then; one that is a little ahead is a sender's clock."""
    fed = Fed()
    messages = dict(fed.messages(row(START)))
    drop = next(topic for topic in messages if TOPICS.inputs[topic].channels[0] == "active.pressure_a")
    early = dict(fed.messages(row(START + ahead)))[drop]
    for topic, message in ((drop, early), (TOPICS.speed_topic, messages[TOPICS.speed_topic])):
        fed.service.take(TOPICS.inputs[topic], message, START, START)
    assert math.isfinite(fed.service.inputs.hold.stamp("active.pressure_a", math.inf)) is kept


def test_gates_that_begin_anew_hold_nothing_and_believe_any_stamp():
    fed = Fed()
    fed.run(0.1)
    gate = fed.service.inputs
    assert math.isfinite(gate.hold.stamp("active.pressure_a", math.inf))
    assert not gate._near(START + 3600.0, fed.now)
    gate.forget()
    assert math.isnan(gate.hold.stamp("active.pressure_a", math.inf))
    assert gate._near(START + 3600.0, fed.now)


def test_what_is_missing_without_a_speed_is_told_with_the_reason_where_some_still_come():
    gate = service().inputs
    arrivals = gate.arrivals[TOPICS.speed_topic]
    assert gate.without_speed(70.0) == "motor_speed ('inputs' says why)"
    arrivals.arrived = 70.0
    assert gate.without_speed(70.05) == "motor_speed ('inputs' says why)"  # none was refused
    arrivals.reason = "stamp far behind"
    assert gate.without_speed(70.05) == "motor_speed, refused: stamp far behind"
    assert gate.without_speed(70.15) == "motor_speed ('inputs' says why)"


def learner(**attributes):
    """As much of an estimator's service as decides which model goes out, and when."""
    own = EstimatorService.__new__(EstimatorService)
    own.options, own.model_period, own.last = ServiceOptions(), 5.0, None
    own._published = own._published_at = -math.inf
    own.contradiction = ""
    own._load = own._drive = own._balance = own._gain = SimpleNamespace(pending=False)
    own.law = SimpleNamespace(seed=replace(SEED, name="seed"), model=lambda: replace(SEED, name="learned"))
    own._before = SimpleNamespace(believed=SimpleNamespace(model=replace(SEED, name="before")))
    for name, value in attributes.items():
        setattr(own, name, value)
    return own


def test_an_estimators_models_are_a_period_of_the_samples_and_a_second_of_the_clock_apart():
    own = learner()
    assert own.model_due(70.0) is None
    own.last = SimpleNamespace(time=1000.0)
    assert own.model_due(70.0).provenance["learned_at"] == 1000.0
    for time, now, due in ((1004.9, 80.0, False), (1005.0, 80.0, True), (1010.0, 80.9, False), (1010.0, 81.0, True)):
        own.last = SimpleNamespace(time=time)
        assert (own.model_due(now) is not None) is due
    own.options = ServiceOptions(5.0)  # simulated: as fast as it runs
    own.last = SimpleNamespace(time=1015.0)
    assert own.model_due(81.0) is not None


@pytest.mark.parametrize(("pending", "contradiction", "name"), [
    ((), "", "learned"), (("_load",), "", "before"), (("_balance",), "", "before"), (("_gain",), "", "before"),
    (("_drive",), "", "before"), ((), "a load", "seed"), (("_gain",), "a load", "seed"),
])  # fmt: skip
def test_what_is_published_under_a_doubt_was_known_before_it(pending, contradiction, name):
    own = learner(contradiction=contradiction, last=SimpleNamespace(time=1.0))
    for each in pending:
        setattr(own, each, SimpleNamespace(pending=True))
    assert own.model_due(70.0).name == name


# -- the consumer's hold
def test_a_held_torque_is_let_go_and_taken_up_by_straight_lines():
    held = HeldTorque(hold_time=0.1, fade_time=0.5)
    held.take(0.0, 9.9)
    held.take(400.0, 10.0)
    for now, torque in ((10.1, 400.0), (10.225, 300.0), (10.35, 200.0), (10.6, 0.0), (11.0, 0.0)):
        assert held.value(now) == pytest.approx(torque)
    held.take(200.0, 11.0)
    for k, torque in ((1, 50.0), (2, 100.0), (3, 150.0), (4, 200.0), (5, 200.0)):
        assert held.value(11.0 + 0.05 * k) == pytest.approx(torque)
        held.take(200.0, 11.0 + 0.05 * k)


@pytest.mark.parametrize(("torque", "taken"), [(500.0, True), (-500.0, True), (500.1, False), (-500.1, False)])
def test_the_largest_torque_is_one_still(torque, taken):
    assert HeldTorque(largest=500.0).take(torque, 1.0) is taken


@pytest.mark.parametrize(("number", "later", "taken"), [
    (8, 0.02, True), (7, 0.02, False), (6, 0.02, False), (6, 0.1, False), (6, 0.11, True),
])  # fmt: skip
def test_what_came_before_is_old_until_the_hold_is_over(number, later, taken):
    held = HeldTorque()
    assert held.take(1.0, 0.0, mark(True, 7))
    assert held.take(2.0, later, mark(True, number)) is taken
    held.clear()
    assert held.take(3.0, later, mark(False, 0))


# -- what was learned before a doubt
def test_what_was_known_is_believed_after_as_long_without_a_doubt():
    """Samples a sixteenth of a second apart, which add up without rounding; the clock is set back before the 300th."""
    knows = [0]
    law = SimpleNamespace(snapshot=lambda: knows[0], model=lambda: knows[0])
    own, told = BeforeDoubt(law), [0]
    assert before_doubt.UNSEEN == 5.0
    for k in range(1, 330):
        knows[0] = k
        own.step(10.0 + k / 16.0 - (3600.0 if k >= 300 else 0.0), doubted=k == 161)
        told.append(own.believed.content)
    assert [told[k] for k in (80, 81, 160, 161, 241, 242, 322, 323)] == [0, 1, 1, 1, 1, 162, 162, 242]
    own.begin()
    assert own.believed.content == own.believed.model == knows[0]


# -- models as text
@pytest.mark.parametrize(("text", "said"), [
    ("x" * (96 * 1024 + 1), "98305 characters are no model"), ("[" * 1001 + "{" * 1000, "nested too deeply"),
    ("a:\n" + " " * 100 + "b: 1", "nested too deeply"),
])  # fmt: skip
def test_a_text_is_no_model_beyond_its_limits(monkeypatch, text, said):
    monkeypatch.setattr(intake, "model_from_text", lambda text, where: ("a model", where))
    with pytest.raises(InputError, match=said):
        parse(text, "here")
    for within in ("x" * (96 * 1024), "[" * 1000 + "{" * 1000, "a:\n" + " " * 99 + "b: 1"):
        assert parse(within, "here") == ("a model", "here")


def test_texts_are_looked_at_a_second_apart_and_of_those_that_wait_the_newest(monkeypatch):
    now = [100.0]

    class AtOnce:
        def __init__(self, target, **_):
            self.start = target

        def is_alive(self):
            return False

    monkeypatch.setattr(intake.threading, "Thread", AtOnce)
    monkeypatch.setattr(intake, "parse", lambda text, where, ready: text)
    own = ModelIntake(clock=lambda: now[0])
    own.offer("a"), own.offer("b")
    assert (own.waiting, own.take(), own.waiting) == (True, ["b"], False)
    own.offer("c")
    for at, found in ((100.9, []), (101.0, ["c"]), (105.0, [])):
        now[0] = at
        assert own.take() == found
        assert own.waiting is (at == 100.9)
    at_once = ModelIntake(beside=False)
    at_once.offer("d")
    assert at_once.take() == ["d"]


# -- the balance of inertia
def test_a_signal_is_smoothed_twice_and_its_change_is_that_of_the_smoothing():
    """Of a ramp that goes on for long, the smoothed value lags by two smoothing times and changes as the ramp does."""
    smooth, dt, time = _Smooth(), 0.001, 0.1
    assert smooth.step(5.0, 0.5) == (5.0, 0.0)
    for k in range(1, 4000):
        value, rate = smooth.step(5.0 + 3.0 * dt * k, dt / (time + dt))
    assert rate / time == pytest.approx(3.0, rel=0.02)
    assert value == pytest.approx(5.0 + 3.0 * dt * 3999 - 3.0 * 2.0 * time, rel=0.01)


@pytest.mark.parametrize(("load", "other"), [(52.6e3, False), (52.4e3 - 300.0, True), (57.6e3, False), (57.9e3, True)])
def test_another_load_is_one_that_differs_by_a_twentieth(load, other):
    balance, sample = InertiaBalance(CRANE), row(0.0)
    assert balance._is_other(55e3, sample)
    balance._mass, balance._groups = 55e3, frozenset(sample.groups)
    assert balance._is_other(load, sample) is other
    sample.groups = {"active": sample.groups["active"]}
    assert balance._is_other(55e3, sample)


def gained(inertia, coulomb, viscous, *, speed=200.0, own=4.0, left=1.0, known=60.0, on=None):
    """A balance that has seen this inertia, friction (N m, and N m s/rad) at this typical speed in rad/s: `own` (N m)^2
    of what accelerates the shaft, and as much `left` that nothing explains; and whether it sees another gain."""
    balance = on or InertiaBalance(CRANE)
    matrix, found = 50.0 * np.diag([1.0, 1.0, speed**2, own]), np.array([30.0, coulomb, viscous, inertia])
    balance._products = np.column_stack([matrix, matrix @ found])
    balance._squares = float(found @ matrix @ found) + 50.0 * left
    balance._known = known
    return balance, balance._look(row(0.0))


@pytest.mark.parametrize(
    ("inertia", "friction", "changed"),
    [
        (0.8, 160.0, True),  # of a friction that was 200 N m
        (1.2, 240.0, True),
        (0.89, 178.0, True),
        (0.91, 182.0, False),
        (1.09, 218.0, False),
        (0.8, 177.0, False),  # the friction by 0.575 of what the inertia shows
        (0.8, 174.0, True),
        (0.8, 137.0, True),
        (0.8, 135.0, False),  # ... by 1.625
        (0.8, 240.0, False),  # the other way
    ],
)
@pytest.mark.parametrize("speed", [100.0, 300.0])
def test_a_gain_is_what_moves_inertia_and_friction_at_the_speed_of_the_beginning_alike(
    inertia, friction, changed, speed
):
    """100 N m of Coulomb's and as much of viscous friction at 200 rad/s; later it may turn faster or slower."""
    balance, first = gained(1.0, 100.0, 0.5)
    assert first is False
    assert balance._first == pytest.approx((1.0, 200.0, 200.0))
    assert gained(inertia, 80.0, (friction - 80.0) / 200.0, speed=speed, on=balance)[1] is changed
    assert balance.change == pytest.approx(inertia - 1.0)


@pytest.mark.parametrize(("known", "left", "tells"), [
    (60.0, 11.0, True), (59.9, 11.0, False), (60.0, 11.2, False),  # 2 N m of 3.33 are six tenths
])  # fmt: skip
def test_a_gain_is_told_after_a_minute_by_an_inertia_above_what_the_balance_leaves(known, left, tells):
    balance, first = gained(1.0, 100.0, 0.5, known=known, left=left)
    assert first is (False if tells else None)
    assert math.isnan(balance.change) is not tells
    later = gained(0.8, 80.0, 0.4, left=left, on=gained(1.0, 100.0, 0.5)[0])[1]  # what it was counts, not what it is
    assert later is (True if left < 11.1 else None)


@pytest.mark.parametrize(("inertia", "coulomb"), [(-1.0, 100.0), (1.0, -101.0)])
def test_what_is_no_gain_to_begin_with_is_compared_with_nothing(inertia, coulomb):
    balance, first = gained(inertia, coulomb, 0.5)
    assert first is balance._first is None
    assert gained(1.0, 100.0, 0.5, on=balance)[1] is False  # and begins once it is one


def test_a_gain_is_looked_for_once_a_second(monkeypatch):
    balance, looked = InertiaBalance(CRANE), []
    monkeypatch.setattr(balance, "_look", lambda sample: looked.append(round(sample.time, 1)))
    for k in range(36):
        balance.contradiction(row(1000.0 + 0.1 * k))
    assert looked == pytest.approx([1000.0, 1001.0, 1002.0, 1003.0], abs=0.11)


def test_an_estimator_tells_motion_from_rest_at_the_speed_of_its_motors():
    """5 rad/s; of a motor on the drum that is rated for 10 rad/s, a tenth of the 100 of quick ones, half a rad/s."""
    for rated, least in ((10.0, 0.5), (CRANE.rated_speed, 5.0)):
        own = SimpleNamespace(
            law=SimpleNamespace(crane=replace(CRANE, rated_speed=rated)), inputs=SimpleNamespace(ranges=RANGES)
        )
        EstimatorService._watch_loads(own)
        assert [own._balance._moving, own._still._moving] == pytest.approx([least, least])


def test_a_step_of_the_balance_is_what_the_smoothed_signals_do_by_hand():
    """Half of a step of 0.1 s passes the first low-pass of 0.1 s and a quarter the second; 10 rad/s are 50 rad/s^2."""
    balance, lever = InertiaBalance(CRANE), CRANE.drum.radius(math.nan) / CRANE.gear_ratio
    still, moving = row(0.0), row(0.1)
    still.motor_speed, moving.motor_speed, still.heave_velocity, moving.heave_velocity = 40.0, 50.0, 0.0, 0.4
    assert balance.contradiction(still) == balance.contradiction(moving) == ""
    inertial = CRANE.inertia * 50.0 + 55e3 * lever * (lever * 50.0 + 2.0)
    drive = sum(CRANE.motor_count(name) * each.displacement * (each.pressure_a - each.pressure_b)
                for name, each in moving.groups.items())  # fmt: skip
    beyond = drive - CRANE.drum_torque(55e3, math.nan) / CRANE.gear_ratio
    expected = np.array([1.0, 1.0, 42.5, inertial, beyond])
    assert balance._products == pytest.approx(0.1 * np.outer(expected[:4], expected))
    assert (balance._squares, balance._known) == (pytest.approx(0.1 * beyond**2), 0.1)
    balance.contradiction(row(0.2))
    kept = math.exp(-0.1 / 40.0)
    assert balance._products[0, 0] == pytest.approx(0.1 * (1.0 + kept))
    assert balance._known == pytest.approx(0.2)


@pytest.mark.parametrize("time", [-5.0, 0.0, 0.3])
def test_a_stamp_that_stands_goes_back_or_comes_late_begins_the_smoothing_anew(time):
    balance = InertiaBalance(CRANE)
    balance.contradiction(row(0.0))
    again = row(time)
    again.motor_speed = 80.0
    balance.contradiction(again)
    assert (balance._signals["speed"].first, balance._signals["speed"].second, balance._known) == (80.0, 80.0, 0.0)


# -- what the services say of themselves
@pytest.mark.parametrize(
    ("silence", "heard", "missing", "contradiction", "accepted", "state", "lacks"),
    [
        (0.05, True, (), "", True, "steady", ""),
        (0.05, True, (), "", False, "rejected", ""),
        (0.05, True, (), "a load", False, "contradicted", ""),
        (0.05, True, ("a load", "a port"), "a load", True, "waiting", "a load, a port"),
        (0.11, True, (), "a load", True, "waiting", "the speed"),
        (0.05, False, (), "", True, "waiting", "the speed"),
    ],
)
def test_an_estimator_says_true_what_it_does(silence, heard, missing, contradiction, accepted, state, lacks):
    own = learner(contradiction=contradiction, missing=missing, _enabled=False)
    own.law.status, own.law.load_apart = (lambda: {"state": "steady", "lateness": "late"}), 0.25
    own.inputs = SimpleNamespace(silence=lambda now: silence, without_speed=lambda now: "the speed")
    own.law.config = SimpleNamespace(gate=4.0)
    own.last = SimpleNamespace(accepted=accepted, innovation=0.1) if heard else None
    own._balance = SimpleNamespace(suspicion="a load cell")
    found = own.status(70.0)
    assert (found["state"], found["missing"], found["contradictions"]) == (state, lacks, contradiction)
    assert (found["enabled"], found["load_apart"], found["suspicion"]) == (False, 0.25, "a load cell; late")
    own._balance.suspicion = ""
    assert own.status(70.0)["suspicion"] == "late"
    beyond = "motor_speed is more than 4 sigma from what the drive torque makes of it"
    assert found["rejection"] == (beyond if state == "rejected" else "")
    if state == "rejected":
        own.last.innovation = math.nan
        assert own.status(70.0)["rejection"] == "stamp not after that of the last sample"


def test_that_no_friction_is_known_is_said_once_in_a_silence_and_at_the_end():
    own, silence = learner(_stands=True), [0.05]
    own.inputs = SimpleNamespace(silence=lambda now: silence[0])
    assert own.ending() is None  # nothing was ever said
    own.last = SimpleNamespace(time=12.0)
    assert own.tick(70.0) is None
    silence[0] = 0.11
    said = own.tick(70.0)
    assert (said.time, said.accepted, said.state) == (12.0, False, "waiting")
    assert math.isnan(said.friction_torque)
    assert own.tick(70.0) is own.ending() is None


@pytest.mark.parametrize(("wanted", "contradiction", "learns"), [
    (True, "", True), (False, "", False), (True, "a load", False), (False, "a load", False),
])  # fmt: skip
def test_an_estimator_learns_where_it_is_to_and_nothing_contradicts(wanted, contradiction, learns):
    own, calls = learner(contradiction=contradiction), []
    own.law.set_enabled = calls.append
    own.set_enabled(wanted)
    assert (own._enabled, calls) == (wanted, [learns])


def test_under_a_doubt_what_was_learned_is_invalid_and_what_is_kept_was_known_before():
    known = [SimpleNamespace(name="C3", status="learned"), SimpleNamespace(name="C6", status="seed")]
    own = learner()
    own.law.parameters, own.law.snapshot = (lambda: known), (lambda: "now")
    own._before.believed.content = "before"
    assert (own.parameters(), own.snapshot()) == (known, "now")
    own._gain = SimpleNamespace(pending=True)
    assert (own.parameters(), own.snapshot()) == (known, "before")


@pytest.mark.parametrize(("silence", "state", "missing"), [(0.05, "active", "none"), (0.11, "stale", "the speed")])
def test_a_feedforward_says_true_what_it_does(monkeypatch, silence, state, missing):
    own = service()
    monkeypatch.setattr(own.law, "status", lambda: {"state": "active", "missing": "none"})
    monkeypatch.setattr(own.inputs, "without_speed", lambda now: "the speed")
    assert own.status(70.0)["missing"] == "the speed"  # before the first
    own._last_stamp, own.contradictions = 12.0, ("a load", "a command")
    own.refuse("old")
    monkeypatch.setattr(own.inputs, "silence", lambda now: silence)
    found = own.status(70.0)
    assert (found["state"], found["missing"]) == (state, missing)
    assert (found["contradictions"], found["learned_model_refused"]) == ("a load; a command", "old")
    own.load_model(SEED)
    assert own.status(70.0)["learned_model_refused"] == ""


def test_the_last_ramp_goes_on_from_where_the_torque_is_in_watch_periods():
    own = service()
    assert list(own.ending(70.0)) == []
    for k in range(200):
        own.take_row(swell(1000.0 + 0.02 * k), 70.0 + 0.02 * k)
    last, now, torque = 1000.0 + 0.02 * 199, 70.0 + 0.02 * 199, own.law.output.torque
    assert abs(torque) > 50.0
    ramp = list(own.ending(now + 0.06))
    assert [after for after, _ in ramp] == pytest.approx([0.02 * (k + 1) for k in range(len(ramp))])
    assert [each.time for _, each in ramp] == pytest.approx([last + 0.06 + 0.02 * (k + 1) for k in range(len(ramp))])
    assert {each.state for _, each in ramp} == {"ending"}
    sizes = [abs(torque), *(abs(each.friction_torque) for _, each in ramp)]
    assert sizes == sorted(sizes, reverse=True)
    assert sizes[-1] == 0.0
    assert list(own.ending(now + 1.0)) == []


def test_an_input_that_arrived_too_long_ago_is_lost_whatever_its_stamp_says():
    gate = service().inputs
    gate._came = {"hook_load": 68.1, "active.pressure_a": 69.95, "active.pressure_b": 69.85, "speed_reference": 69.89,
                  "gone.pressure_a": 1.0}  # fmt: skip
    sample = row(1000.0)
    gate._without_stale(sample, 70.0)
    assert (sample.hook_load, sample.motor_speed, sample.groups["active"].pressure_a) == (55e3, 50.0, 2e7)
    assert math.isnan(sample.speed_reference)
    assert math.isnan(sample.groups["active"].pressure_b)
    simulated = row(1000.0)
    gate.options = ServiceOptions(5.0)
    gate._without_stale(simulated, 170.0)
    assert simulated.speed_reference == 50.0


def test_what_is_refused_is_counted_by_its_kind():
    gate = service().inputs
    arrivals = gate.arrivals[TOPICS.speed_topic]
    for reason in ("hook_load: 1 kg is outside", "hook_load: 2 kg is outside", "stamp far behind"):
        gate._refuse(arrivals, reason)
    assert (arrivals.refused, arrivals.reason) == (3, "stamp far behind")
    assert arrivals.reasons == {"hook_load": 2, "stamp far behind": 1}
