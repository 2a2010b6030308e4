"""A command that has nothing to do with a slow motion: in a calm sea no sample of it turns fast enough to tell."""

import math

import pytest
from sea import PERIOD, Fed

from winch_friction.compensation import CompensatorConfig
from winch_friction.online.doubt import SlowWave, span
from winch_friction.physics.signals import Sample

WAVE, SLOW = 9.0, 4.0  # s, rad/s at the motor: a few centimetres of wire
SAID = "speed_reference turns against a slow motor_speed in wave after wave"


class CalmSea(Fed):
    """The same load in a calm sea."""

    def run(self, seconds, change=lambda _: None, skip=()):
        def slowly(sample):
            sample.motor_speed = SLOW * math.sin(2.0 * math.pi * self.now / WAVE)
            sample.speed_reference = sample.motor_speed
            change(sample)

        return super().run(seconds, slowly, skip)


def _stands(sample):
    sample.speed_reference = 4.9


def _offset(sample):
    """A zero error of a sixtieth of the range."""
    sample.speed_reference += 10.0


def _other_sign(sample):
    sample.speed_reference *= -1.0


def _of_another(sample):
    """The command of another winch in another wave."""
    sample.speed_reference = SLOW * math.sin(2.0 * math.pi * sample.time / 13.0)


@pytest.mark.parametrize("change", [_stands, _offset, _other_sign, _of_another])
def test_a_command_that_turns_against_a_slow_motion_in_each_wave_is_let_go(change):
    """367 N m of one direction, where 176 to and fro are right, half the time against the motion, were `valid` for
    good, and nothing said so: below 5 rad/s nothing compared the two."""
    fed = CalmSea()
    fed.run(2.0 * WAVE)
    fed.run(4.0 * WAVE, change)
    assert fed.service.contradictions == (SAID,)
    fed.run(1.0, change)
    assert fed.torque == 0.0
    assert SAID in fed.service.status(fed.now)["contradictions"]
    fed.run(3.0 * WAVE)
    assert fed.service.contradictions == ()
    assert max(abs(each.friction_torque) for each in fed.run(WAVE)) > 100.0


def _late(sample):
    """By half a second."""
    sample.motor_speed = SLOW * math.sin(2.0 * math.pi * (sample.time - 0.5) / WAVE)


def _half(sample):
    sample.motor_speed *= 0.5


def _silent(sample):
    sample.speed_reference = math.nan


def _noise(sample):
    """Of a brake that holds, and of a command near zero."""
    phase = sample.time / PERIOD
    sample.motor_speed, sample.speed_reference = 3.0 * math.sin(12.9 * phase), 0.3 * math.sin(7.7 * phase)


@pytest.mark.parametrize("change", [lambda _: None, _late, _half, _noise])
def test_a_sound_winch_in_a_calm_sea_is_believed(change):
    fed = CalmSea()
    for _ in range(10):
        fed.run(WAVE, change)
        assert fed.service.contradictions == ()


def test_without_a_command_nothing_is_against_it():
    fed = CalmSea(CompensatorConfig(ramp_time=0.5, velocity_source="measured"))
    fed.run(6.0 * WAVE, _silent)
    assert fed.service.contradictions == ()


def _said(samples):
    own, last, said = SlowWave(5.0), math.nan, []
    for sample in samples:
        if own.contradiction(sample, span(last, sample.time)):
            said.append(sample.time)
        last = sample.time
    return said


def _sent(seconds, speed, command):
    for k in range(round(seconds / PERIOD)):
        t = PERIOD * k
        yield Sample(t, speed(t), speed_reference=command(t))


def _wave(size):
    return lambda t: size * math.sin(2.0 * math.pi * t / WAVE)


def test_it_needs_some_motion_and_a_fast_one_begins_anew():
    """The other checks tell of a fast one within a second."""
    assert min(_said(_sent(60.0, _wave(SLOW), _wave(-SLOW)))) == pytest.approx(16.0, abs=4.0)
    assert not _said(_sent(60.0, _wave(0.9), _wave(-0.9)))  # noise
    assert not _said(_sent(60.0, _wave(20.0), _wave(-20.0 / 3.0)))  # each second above 5 rad/s begins anew
    slow, fast = _wave(SLOW), _wave(100.0)
    said = _said(_sent(60.0, lambda t: slow(t) if t < 30.0 else fast(t), lambda t: -slow(t) if t < 30.0 else fast(t)))
    assert max(said) < 34.0


def test_a_reset_begins_anew():
    fed = CalmSea()
    fed.run(6.0 * WAVE, _other_sign)
    assert fed.service.contradictions == (SAID,)
    fed.service.reset()
    fed.run(0.5)
    assert fed.service.contradictions == ()


def test_a_gap_counts_no_more_than_a_tenth():
    """A second of silence is no second of motion."""
    assert not _said(Sample(float(k), SLOW, speed_reference=-SLOW) for k in range(100))
