"""Pressures that cannot be a winch's, where no load cell contradicts them."""

import math
from collections.abc import Callable, Iterator

import pytest
from sea import CRANE, PERIOD, SEED

from winch_friction.estimation.config import EstimatorConfig
from winch_friction.online.agreement import EXCHANGED_SAID, NONE_SAID, SWUNG_SAID, DriveByItself
from winch_friction.online.compensator import CompensatorService
from winch_friction.online.estimator import EstimatorService
from winch_friction.physics.signals import GroupSample, Sample
from winch_friction.physics.winch.operating_point import ChannelRanges
from winch_friction.records.topics import crane_topics

FULL, BOOST = CRANE.max_displacement, 25e5  # m3/rad, Pa
Sensors = Callable[[float, float], tuple[float, float]]  # Pa at the ports -> what is shown
NORMAL = crane_topics(CRANE, ("main",))


def sea(seconds: float, sensors: Sensors, load: float = 15e3, friction: float = 200.0) -> Iterator[Sample]:
    """All motors hoist and lower `load` kg in waves of 10 s, with `friction` N m, no load cell."""
    for k in range(round(seconds / PERIOD)):
        phase = 2.0 * math.pi * k * PERIOD / 10.0
        speed, rising = 150.0 * math.sin(phase), 150.0 * 0.2 * math.pi * math.cos(phase)
        torque = CRANE.drum_torque(load) / CRANE.gear_ratio + CRANE.inertia * rising + math.copysign(friction, speed)
        shown = sensors(torque / (11.0 * FULL) + BOOST, BOOST + 1e3 * math.sin(k))
        yield Sample(k * PERIOD, speed, speed, {"main": GroupSample(*shown, FULL)})


def first_said(samples: Iterator[Sample], topics=NORMAL) -> tuple[float, str]:
    """When the compensator doubts them, s, and why; NaN for never."""
    service = CompensatorService(CRANE, SEED, topics)
    for sample in samples:
        service.take_row(sample)
        if service.contradictions:
            return sample.time, "; ".join(service.contradictions)
    return math.nan, ""


@pytest.mark.parametrize("unit", [1e5, 1e6, 1e3, 6894.76, math.inf], ids=["bar", "MPa", "kPa", "psi", "no supply"])
def test_pressures_in_another_unit_are_no_pressures_of_a_winch_that_hoists(unit):
    """The friction of an empty hook went out for that of 15 t, `valid`, and the state was `active`."""
    when, why = first_said(sea(4.0, lambda a, b: (a / unit, b / unit)))
    assert why == NONE_SAID
    assert when == pytest.approx(1.2, abs=0.2)


def by_stroke(samples: Iterator[Sample], rail: float, dead: bool = False, steady: float = 0.0) -> Iterator[Sample]:
    """The same torque at a pressure of `rail` Pa, set by the stroke; its feedback may be `dead`, about a zero that is
    off by a `steady` share of the largest."""
    for k, each in enumerate(samples):
        own = each.groups["main"]
        needed = own.displacement * (own.pressure_a - own.pressure_b) / rail
        shown = (steady + 0.002 * math.sin(k)) * FULL if dead else needed
        yield Sample(each.time, each.motor_speed, each.speed_reference,
                     {"main": GroupSample(rail + BOOST, BOOST, shown)})  # fmt: skip


def test_motors_that_are_swung_out_hoist_nothing():
    """A feedback without supply gave the friction of an empty hook, `valid`, and an estimator learned of it."""
    when, why = first_said(by_stroke(sea(12.0, lambda a, b: (a, b)), 3e7, dead=True))
    assert why == SWUNG_SAID
    assert when == pytest.approx(10.2, abs=0.2)  # 5 s of hoisting, in waves of 10 s


@pytest.mark.parametrize(("load", "friction"), [(0.0, 60.0), (15e3, 200.0)])
def test_a_stroke_that_passes_through_zero_is_believed(load, friction):
    """At rated pressure and with an empty hook, whose inertia takes more than its friction."""
    assert not first_said(by_stroke(sea(18.0, lambda a, b: (a, b), load, friction), 450e5))[1]


@pytest.mark.parametrize(("dead", "doubted"), [(False, False), (True, True)])
@pytest.mark.parametrize("steady", [0.0, 0.0025])  # one about zero pulls down every other sample: another doubt
def test_a_stroke_at_zero_is_doubted_before_it_is_said_and_one_that_passes_through_it_is_not(dead, doubted, steady):
    """What an estimator learns of a light load would never be believed, were every wave's passing a doubt."""
    each = DriveByItself(CRANE, ChannelRanges(CRANE, ("main",)))
    samples = by_stroke(sea(4.5, lambda a, b: (a, b), 0.0, 120.0), 3e7, dead, steady)
    said = [(each.contradiction(sample, PERIOD), each.pending) for sample in samples]
    assert not any(words for words, _ in said)
    assert any(pending for _, pending in said) == doubted


@pytest.mark.parametrize(
    ("ports", "stroke"), [((-BOOST, -325e5), FULL), ((BOOST, 325e5), -FULL)], ids=["ports", "stroke"]
)
def test_a_sign_is_no_lack_of_supply(ports, stroke):
    """Ports of which both are shown below zero, or motors past centre: others say what is wrong there."""
    each = DriveByItself(CRANE, ChannelRanges(CRANE, ("main",)))
    sample = Sample(0.0, 100.0, 100.0, {"main": GroupSample(*ports, stroke)})
    assert not {each.contradiction(sample, 0.1) for _ in range(80)} & {NONE_SAID, SWUNG_SAID}


def test_of_motors_that_are_not_all_shown_some_may_be_swung_out():
    active = (
        Sample(each.time, each.motor_speed, each.speed_reference, {"active": each.groups["main"]})
        for each in by_stroke(sea(18.0, lambda a, b: (a, b)), 3e7, dead=True)
    )
    assert not first_said(active, crane_topics(CRANE, ("active",)))[1]


@pytest.mark.parametrize(("share", "doubted"), [(0.035, False), (0.07, True)])
def test_a_pull_down_of_a_twentieth_of_the_rated_load_is_no_hook_s(share, doubted):
    """Zeros of the transducers alone make a little of it."""
    ranges = ChannelRanges(CRANE, ("main",))
    each, load = DriveByItself(CRANE, ranges), share * 0.5 * ranges.load
    said = {each.contradiction(sample, PERIOD) for sample in sea(20.0, lambda a, b: (b, a), load)}
    assert (EXCHANGED_SAID in said) is doubted
    assert said <= {"", EXCHANGED_SAID}


def test_exchanged_ports_would_pull_the_load_down():
    when, why = first_said(sea(30.0, lambda a, b: (b, a)))
    assert why == EXCHANGED_SAID
    assert 11.0 < when < 18.0  # each way was seen for 5 s


@pytest.mark.parametrize(
    ("load", "friction", "sensors"),
    [
        (0.0, 60.0, lambda a, b: (a, b)),  # an empty hook, little friction
        (4.5e3, 200.0, lambda a, b: (a - b, 0.0)),  # the drop alone, about nothing while it lowers
        (3e3, 60.0, lambda a, b: (b, a)),  # exchanged, of hardly any load: inertia and zeros could be as much
        (15e3, 200.0, lambda a, b: (math.nan, b)),  # what is missing is said elsewhere
    ],
)
def test_what_a_winch_may_show_is_believed(load, friction, sensors):
    assert not first_said(sea(18.0, sensors, load, friction))[1]


def test_one_of_two_groups_may_pull_the_load_down():
    """The passive motors hold it, and are not logged."""
    active = [
        Sample(each.time, each.motor_speed, each.speed_reference, {"active": each.groups["main"]})
        for each in sea(18.0, lambda a, b: (b, a), 60e3)
    ]
    assert not first_said(iter(active), crane_topics(CRANE, ("active",)))[1]


def test_an_estimator_learns_nothing_of_them_nor_keeps_what_it_learned_before_it_was_sure():
    service = EstimatorService(CRANE, SEED, NORMAL, EstimatorConfig())
    marks = []
    for sample in sea(18.0, lambda a, b: (b, a)):
        said = service.take_row(sample)
        marks.append((bool(service.contradiction), said.valid, service.valid(said)))
    assert service.contradiction == EXCHANGED_SAID
    assert {(False, True, True), (True, True, False)} <= set(marks)  # a torque of pressures that are not believed
    assert (True, True, True) not in marks
    assert service.model_due(1e9).values == SEED.values
    assert service.snapshot() == EstimatorService(CRANE, SEED, NORMAL).snapshot()
