"""A step of the drive's torque that the shaft does not answer is a reading's, whether or not a load cell is there."""

import math
from collections.abc import Callable, Iterator

import numpy as np
import pytest
from sea import CRANE, SEED, TOPICS

from winch_friction.online.doubt import span
from winch_friction.online.estimator import EstimatorService
from winch_friction.online.torque_step import RESTED, TorqueStep
from winch_friction.physics.channels import BAR
from winch_friction.physics.signals import GroupSample, Sample
from winch_friction.physics.winch.operating_point import ChannelRanges

Spoil = Callable[[Sample], None]
INERTIA, FRICTION, PERIOD = 2.7, 400.0, 6.0  # kg m^2 with the load, N m, s
STROKE, WAVE = CRANE.max_displacement, 2.0 * math.pi / PERIOD
ACTIVE = 3 * STROKE  # m^3/rad
FROM, TO = 20.3, 31.7  # s, away from reversals


def winch(
    seconds: float = 40.0, rate: float = 50.0, *, pushed: Callable[[float], float] = lambda _t: 0.0, noise: float = 0.3
) -> Iterator[Sample]:
    """A wave whose torques balance; `pushed` N m more at t s accelerate the shaft, to a speed that fades in 1 s."""
    rng, more, angle = np.random.default_rng(3), 0.0, 0.0
    for k in range(round(seconds * rate)):
        t = k / rate
        more += (pushed(t) / INERTIA - more) / rate
        speed = 150.0 * math.sin(WAVE * t) + more
        angle += speed / rate
        torque = FRICTION * math.tanh(speed / 5.0) + INERTIA * 150.0 * WAVE * math.cos(WAVE * t) + pushed(t)
        drop, (a, b) = torque / ACTIVE, rng.normal(0.0, noise * BAR, 2)
        groups = {
            "active": GroupSample(25 * BAR + max(drop, 0.0) + a, 25 * BAR + max(-drop, 0.0) + b, STROKE),
            "passive": GroupSample(275 * BAR + 0.5 * a - 0.02 * BAR * angle, 25 * BAR, STROKE / 3.0),
        }  # fmt: skip
        yield Sample(t, speed + rng.normal(0.0, 0.05), groups=groups)


def said(
    samples: Iterator[Sample], spoil: Spoil = lambda _: None, begin: float = FROM, end: float = TO
) -> dict[float, str]:
    """What is said when it changes, s; the samples are spoilt from `begin` to `end` s."""
    own, last, found, before = TorqueStep(CRANE, ChannelRanges(CRANE)), math.nan, {}, ""
    for sample in samples:
        if begin <= sample.time < end:
            spoil(sample)
        words = own.contradiction(sample, span(last, sample.time))
        last = sample.time
        if words != before:
            found[last], before = words, words
    return found


def times(group: str, channel: str, share: float) -> Spoil:
    """A reading that shows this share of what is there."""

    def spoil(sample: Sample) -> None:
        setattr(sample.groups[group], channel, share * getattr(sample.groups[group], channel))

    return spoil


@pytest.mark.parametrize("rate", [10.0, 20.0, 50.0, 100.0])
@pytest.mark.parametrize(("channel", "share"), [("pressure_a", 1.1), ("pressure_a", 0.9), ("displacement", 0.9)])
def test_a_gain_is_told_when_it_steps_and_over_when_it_steps_back(rate: float, channel: str, share: float) -> None:
    """Without a load cell nothing watched it, and 30 s of it put K4 24.7 of its sigmas off."""
    (begin, words), (end, over) = said(winch(rate=rate), times("passive", channel, share)).items()
    assert FROM < begin < FROM + 0.7
    assert f"passive.{channel} by {share - 1.0:+.0%}" in words
    assert TO < end < TO + 0.7
    assert over == ""


def test_an_offset_is_over_when_as_much_is_taken_away() -> None:
    def spoil(sample: Sample) -> None:
        sample.groups["active"].pressure_a += 40 * BAR

    hoisting, lowering = 18.6, 34.6  # s; the pressure that it is added to is another one
    (_, words), (end, over) = said(winch(), spoil, hoisting, lowering).items()
    assert "active.pressure_a" in words
    assert lowering < end < lowering + 0.7
    assert over == ""


@pytest.mark.parametrize("group", ["active", "passive"])
@pytest.mark.parametrize("end", [25.6, 31.7, 34.6])
def test_ports_that_were_exchanged_are_right_once_they_are_exchanged_again(group: str, end: float) -> None:
    """By then they show other pressures: neither a share nor what was added is taken back, and it stood for good."""

    def exchange(sample: Sample) -> None:
        own = sample.groups[group]
        own.pressure_a, own.pressure_b = own.pressure_b, own.pressure_a

    (_, words), (over, nothing) = said(winch(), exchange, end=end).items()
    assert f"{group}.pressure_a" in words
    assert f"{group}.pressure_b" in words
    assert end < over < end + 0.7
    assert nothing == ""


def test_ports_that_are_exchanged_do_not_mend_a_gain() -> None:
    def spoil(sample: Sample) -> None:
        own = sample.groups["active"]
        own.pressure_a *= 1.4
        if sample.time >= TO:
            own.pressure_a, own.pressure_b = own.pressure_b, own.pressure_a

    assert list(said(winch(), spoil, end=40.0).values())[-1] != ""


@pytest.mark.parametrize(("hole", "over"), [(0.2, True), (0.45, True), (0.6, False)])
@pytest.mark.parametrize("share", [0.0, 0.9, 1.1])
def test_a_reading_may_step_back_where_no_sample_comes(hole: float, over: bool, share: float) -> None:
    """Whoever plugs it in again interrupts it: it was blamed for good though it was right."""
    lost = (each for each in winch() if not TO <= each.time < TO + hole)
    found = said(lost, times("passive", "displacement", share))
    assert (list(found.values())[-1] == "") is over
    assert "passive.displacement" in next(iter(found.values()))


def test_a_step_back_in_a_hole_in_which_the_shaft_reverses_is_not_believed() -> None:
    """Friction steps readings as well then, and nobody has seen which it was."""
    lost = (each for each in winch() if not 29.8 <= each.time < 30.2)
    assert list(said(lost, times("passive", "displacement", 0.9), end=30.0).values())[-1] != ""


def test_a_hole_alone_takes_nothing_back_and_tells_nothing() -> None:
    lost = [each for each in winch(40.0) if not TO <= each.time < TO + 0.4]
    assert said(iter(lost)) == {}
    assert len(said(iter(lost), times("passive", "pressure_a", 1.1), end=40.0)) == 1


@pytest.mark.parametrize("rate", [10.0, 50.0, 200.0])
@pytest.mark.parametrize("noise", [0.1, 2.0])
def test_a_winch_in_a_sea_steps_nothing(rate: float, noise: float) -> None:
    assert said(winch(60.0, rate, noise=noise)) == {}


def test_a_torque_that_accelerates_the_shaft_is_the_drives() -> None:
    """Of an electric or a hydraulic motor, within one sample."""
    assert said(winch(pushed=lambda t: 300.0 if t >= FROM else 0.0)) == {}


@pytest.mark.parametrize(("rate", "late"), [(50.0, 0.1), (50.0, 0.03), (200.0, 0.02), (200.0, 0.01)])
def test_a_load_that_oil_takes_over_within_a_tenth_of_a_second_is_none_of_a_reading(rate: float, late: float) -> None:
    def spoil(sample: Sample) -> None:
        sample.groups["active"].pressure_a += 40 * BAR * (1.0 - math.exp(-(sample.time - FROM) / late))

    assert said(winch(rate=rate), spoil, end=40.0) == {}


def test_one_stray_reading_is_no_step() -> None:
    assert said(winch(), times("passive", "pressure_a", 1.1), end=FROM + 0.02) == {}


def test_the_friction_that_a_feedforward_reverses_is_no_reading() -> None:
    """It steps the driving group's pressure at each reversal, and the shaft turns on as it should."""

    def forward(sample: Sample) -> None:
        drop = 2.0 * FRICTION / ACTIVE * (sample.motor_speed > 0.0)
        sample.groups["active"].pressure_a = 60 * BAR + drop

    assert said(winch(), forward, begin=0.0, end=40.0) == {}


def test_what_steps_at_rest_is_a_brakes_or_a_valves() -> None:
    def rests(sample: Sample) -> None:
        sample.motor_speed *= 0.01
        sample.groups["passive"].pressure_a *= 1.2 if sample.time >= FROM else 1.0

    assert said(winch(), rests, begin=0.0, end=40.0) == {}


def stepped() -> tuple[TorqueStep, Sample]:
    """A watch that tells a step, and the last sample."""
    own = TorqueStep(CRANE, ChannelRanges(CRANE))
    for sample in winch(22.0):
        if sample.time >= FROM:
            times("passive", "pressure_a", 1.1)(sample)
        words = own.contradiction(sample, 0.02)
    assert words
    return own, sample


def test_a_rest_ends_it() -> None:
    own, last = stepped()
    still = Sample(last.time, 0.0, groups=last.groups)
    said = [own.contradiction(still, 0.02) for _ in range(round(RESTED / 0.02) + 5)]
    assert all(said[:-10])
    assert said[-1] == ""


def test_other_motors_end_it_and_a_gap_does_not() -> None:
    own, last = stepped()
    assert own.contradiction(Sample(last.time + 5.0, 50.0, groups=last.groups), 0.1)
    main = {"main": GroupSample(100 * BAR, 25 * BAR, STROKE)}
    assert own.contradiction(Sample(last.time + 5.02, 50.0, groups=main), 0.02) == ""


def test_nothing_is_told_of_a_torque_that_is_missing() -> None:
    own, last = stepped()
    lost = {"active": last.groups["active"], "passive": GroupSample(math.nan, 25 * BAR, STROKE)}
    assert own.contradiction(Sample(last.time + 0.02, 50.0, groups=lost), 0.02)
    assert own.contradiction(Sample(last.time + 0.04, 50.0, groups=last.groups), 0.02)


@pytest.mark.parametrize("cell", [math.nan, 55e3])
def test_the_estimator_takes_back_what_it_learned_beside_a_step(cell: float) -> None:
    service = EstimatorService(CRANE, SEED, TOPICS)
    for sample in winch(34.0):
        sample.hook_load = cell
        if sample.time >= FROM:
            times("passive", "pressure_a", 1.1)(sample)
        service.take_row(sample, sample.time)
    assert "passive.pressure_a by +10%" in service.contradiction
    assert service.law.model().values == SEED.values
    assert service.status(sample.time)["state"] == "contradicted"
    service.reset()
    assert service.contradiction == ""
