"""A speed that goes on one way while the wire comes and goes: no unit and no direction makes that of one motion."""

import math
from dataclasses import replace

import pytest
from sea import CRANE

from winch_friction.online.agreement import Agreement
from winch_friction.online.doubt import WireAgainstSpeed
from winch_friction.online.wire_way import WireWay
from winch_friction.physics.signals import Sample
from winch_friction.physics.winch.operating_point import ChannelRanges

LEVER = CRANE.drum.radius(1.0) / CRANE.gear_ratio  # m of wire per radian of a motor
PERIOD = 0.02  # s


def voyage(change=lambda speed, k: speed, shown=lambda wire, k: wire, seconds=70.0, wave=8.0, speed=90.0, haul=0.0):
    """Samples of a sea, s and rad/s; `haul` rad/s besides; `change` of the speed that is sent, `shown` of the wire."""
    omega = 2.0 * math.pi / wave
    for k in range(int(seconds / PERIOD)):
        time = k * PERIOD
        wire = 300.0 - LEVER * (speed / omega * (1.0 - math.cos(omega * time)) + haul * time)
        now = change(speed * math.sin(omega * time) + haul, k)
        yield Sample(time, now, speed_reference=now, wire_out=shown(wire, k), wire_layer=1.0)


def said(samples):
    """When it was said first, s, and in which words."""
    own = WireAgainstSpeed(CRANE, ChannelRanges(CRANE))
    for k, sample in enumerate(samples):
        if words := own.contradiction(sample, PERIOD if k else 0.0):
            return sample.time, words
    return math.inf, ""


def stands_with_noise(_, k):
    """Frozen at 80 rad/s, an analogue value with a noise of a few counts."""
    return 80.0 + 0.16 * math.sin(12.9 * k)


@pytest.mark.parametrize("shown", [
    lambda wire, k: wire,
    lambda wire, k: 0.1 * round(10.0 * wire),  # in steps of 0.1 m
    lambda wire, k: wire + 0.02 * math.sin(7.7 * k),  # with noise
], ids=["smooth", "steps", "noise"])  # fmt: skip
@pytest.mark.parametrize("change", [stands_with_noise, lambda speed, k: speed + 60.0, lambda speed, k: abs(speed)],
                         ids=["frozen", "offset", "without sign"])  # fmt: skip
def test_a_speed_that_goes_on_one_way_contradicts_a_wire_that_comes_and_goes(change, shown):
    """With the command of the same program the friction of one way was fed forward for good: against the motion for
    half of each wave, 22 of 45 s, and nothing said so."""
    first, words = said(voyage(change, shown))
    assert first < 45.0
    assert words.startswith("motor_speed contradicts wire_out: it goes on for ")


def test_it_is_said_among_the_contradictions():
    own = Agreement(CRANE, ChannelRanges(CRANE))
    found = [own.contradictions(sample) for sample in voyage(stands_with_noise, seconds=50.0)]
    assert found[-1][0].startswith("motor_speed contradicts wire_out: it goes on for ")


def filtered(time_constant):
    """A display that follows slowly, s."""
    state = []

    def show(wire, k):
        state.append(wire if not state else state[-1] + PERIOD / time_constant * (wire - state[-1]))
        return state[-1]

    return show


@pytest.mark.parametrize("wave", [5.0, 8.0, 11.0, 18.0])
@pytest.mark.parametrize("haul", [0.0, 30.0])
@pytest.mark.parametrize("counter", [
    lambda: lambda wire, k: wire, lambda: filtered(5.0), lambda: filtered(10.0), lambda: lambda wire, k: 0.85 * wire,
    lambda: lambda wire, k: round(wire), lambda: filtered(0.5),
], ids=["smooth", "5 s", "10 s", "slips", "metres", "0.5 s"])  # fmt: skip
def test_a_sound_winch_is_not_told_from_its_wire(wave, haul, counter):
    assert said(voyage(shown=counter(), wave=wave, haul=haul, speed=300.0))[0] == math.inf


def test_a_dead_counter_tells_nothing():
    """Standing, with the noise of an analogue input, or from some moment on."""
    for shown in (
        lambda wire, k: 300.0,
        lambda wire, k: 300.0 + 0.3 * math.sin(12.9 * k * k),
        lambda wire, k: wire if k < 1000 else 300.0,
        lambda wire, k: 300.0 + 0.2 * math.sin(0.004 * k),  # it wanders
    ):
        assert said(voyage(shown=shown, haul=60.0))[0] == math.inf


def test_a_counter_that_was_set_begins_anew():
    """What the speed went before is not held against what it shows from then on."""
    own = WireAgainstSpeed(CRANE, ChannelRanges(CRANE))
    for k, sample in enumerate(voyage(seconds=30.0, haul=60.0)):
        own.contradiction(sample, PERIOD if k else 0.0)
    assert own.ways.way.gone != 0.0
    own.contradiction(replace(sample, time=sample.time + 1.1, wire_out=0.0), PERIOD)
    assert own.ways.way.gone == 0.0


def test_it_needs_most_of_its_time():
    way = WireWay()
    words = [way.step(float(k), 0.5, 300.0 + math.sin(0.8 * k)) for k in range(60)]
    assert not any(words[:36])
    assert all(words[36:])


def ramps(shown):
    """A joystick: 40 rad/s, then 92, and back, one way after the other; `shown` of the wire."""
    gone = 0.0
    for k in range(int(120.0 / PERIOD)):
        time = k * PERIOD
        wanted = min(time / 4.0, 1.0) * 40.0 if time < 16.0 else 40.0 + min((time - 16.0) / 4.0, 1.0) * 52.0
        now = wanted if time < 34.0 else max(92.0 - 46.0 * (time - 34.0), -92.0)
        gone -= LEVER * now * PERIOD
        yield Sample(time, now, speed_reference=now, wire_out=shown(300.0 + gone, k), wire_layer=1.0)


@pytest.mark.parametrize("slow", [0.5, 2.0, 5.0, 10.0])
def test_a_slow_display_is_late_and_not_small_while_a_winch_gets_going(slow):
    assert said(ramps(filtered(slow)))[0] == math.inf


def calm(shown, share=1.0, seconds=600.0):
    """A low sea of three waves, whose wire moves a few tenths of a metre."""
    waves = [(2.0 * math.pi / period, size) for period, size in ((6.3, 40.0), (8.9, 50.0), (11.7, 35.0))]
    for k in range(int(seconds / PERIOD)):
        time = k * PERIOD
        wire = 300.0 - LEVER * sum(size / omega * (1.0 - math.cos(omega * time)) for omega, size in waves)
        now = share * sum(size * math.sin(omega * time) for omega, size in waves)
        yield Sample(time, now, speed_reference=now, wire_out=shown(wire, k), wire_layer=1.0)


def steps(step, hold):
    """A counter of steps of so many m, that comes every `hold` samples."""
    last = []

    def show(wire, k):
        if k % hold == 0:
            last[:] = [step * round(wire / step)]
        return last[0]

    return show


@pytest.mark.parametrize("hold", [1, 25, 50, 100])
@pytest.mark.parametrize("step", [0.5, 1.0])
def test_coarse_steps_are_no_way_of_the_wire(step, hold):
    """In low seas a counter in metres, sent twice a second, was told to be of a speed a sixth as large."""
    assert said(calm(steps(step, hold)))[0] == math.inf


def test_fine_steps_tell():
    assert said(calm(steps(0.02, 25), share=2.0, seconds=60.0))[0] < 25.0


@pytest.mark.parametrize(("speed", "off"), [(90.0, 20.0), (200.0, -25.0), (70.0, 18.0)])
@pytest.mark.parametrize("haul", [0.0, -15.0])
def test_a_zero_error_of_the_speed_is_told_though_the_wire_comes_and_goes_as_far(speed, off, haul):
    """Of command and speed alike: it was never said, a parameter was published 5 of its sigmas off, and kept."""
    first, words = said(voyage(lambda true, _: true + off, speed=speed, haul=haul))
    assert first < 45.0
    assert words.endswith("further one way than the wire: a zero error?")
    assert said(voyage(lambda true, _: true + 0.08 * off, speed=speed, haul=haul))[0] == math.inf


@pytest.mark.parametrize("haul", [-60.0, -20.0, 0.0, 40.0])
@pytest.mark.parametrize(("slip", "speed"), [(0.02, 90.0), (-0.04, 90.0), (0.08, 400.0)])
def test_a_counter_that_slips_one_way_is_no_zero_error(haul, slip, speed):
    lost = [0.0, 300.0]

    def slips(wire, _):
        lost[0] += slip * max(wire - lost[1], 0.0)
        lost[1] = wire
        return wire + lost[0]

    assert said(voyage(shown=slips, haul=haul, speed=speed, seconds=100.0))[0] == math.inf


@pytest.mark.parametrize(("astray", "told"), [(0.11, False), (0.14, True)])
def test_an_eighth_of_all_the_way_is_more_than_a_counter_slips(astray, told):
    """Of what the speed goes either way, in each second of waves of 8 s."""
    own, gone, words = WireWay(), 0.0, ""
    for k in range(60):
        wave = math.sin(2.0 * math.pi * k / 8.0)
        gone += wave
        words = own.step(float(k), wave + astray * 2.0 / math.pi, gone)
    assert bool(words) is told
