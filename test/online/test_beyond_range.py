"""What goes beyond the crane's range with every wave is not believed within it either."""

import math

import pytest
from sea import CRANE, PERIOD, Fed

from winch_friction.physics.signals import Sample
from winch_friction.physics.winch.operating_point import ChannelRanges
from winch_friction.records.beyond import AGAIN, BeyondRange
from winch_friction.records.sample_stream import Plausibility

RPM = 60.0 / (2.0 * math.pi)
WAVE = 6.0  # s


def _in_rpm(sample: Sample) -> None:
    sample.motor_speed *= RPM
    sample.speed_reference *= RPM


def _doubled(sample: Sample) -> None:
    """A converter of another full scale: beyond 600 bar at the crests of a soft accumulator alone."""
    passive = sample.groups["passive"]
    passive.pressure_a += 20e5 * math.sin(2.0 * math.pi * sample.time / WAVE)
    passive.pressure_a, passive.pressure_b = 2.1 * passive.pressure_a, 2.1 * passive.pressure_b


@pytest.mark.parametrize(("change", "what"), [(_in_rpm, "motor_speed"), (_doubled, "passive.pressure_a")])
def test_what_is_refused_at_each_crest_is_not_obeyed_in_the_flanks(change, what):
    """Both of one program in rpm, 2000 N m where 380 are right, came and went with each wave for 20 s and more; passive
    pressures that count double, 594 for 381 N m, for 31 s."""
    fed = Fed()
    fed.run(2.0 * WAVE)
    fed.run(WAVE, change)
    said = fed.run(4.0 * WAVE, change)
    assert {each.friction_torque for each in said if each.time > fed.now - 3.0 * WAVE} <= {0.0}
    assert fed.torque == 0.0
    reasons = set()
    for _ in range(20):
        fed.run(WAVE / 20.0, change)
        reasons |= {each.reason for each in fed.service.inputs.arrivals.values()}
    assert any(each.startswith(what) and "again and again" in each for each in reasons)


@pytest.mark.parametrize("back", [False, True])
def test_it_is_believed_again_once_a_wave_has_passed_within(back):
    """Or where somebody begins anew, who has put it right."""
    fed = Fed()
    fed.run(2.0 * WAVE)
    fed.run(2.0 * WAVE, _in_rpm)
    if back:
        fed.service.reset()
        fed.run(1.0)
    else:
        assert {each.friction_torque for each in fed.run(AGAIN - 0.5 * WAVE - 2.0)} <= {0.0}
        fed.run(0.5 * WAVE + 3.0)
    assert max(abs(each.friction_torque) for each in fed.run(WAVE)) > 300.0


def _refused(readings: list[tuple[float, float]], column: str = "motor_speed") -> list[float]:
    """Stamps, s, of the readings within the range that are refused."""
    ranges = ChannelRanges(CRANE)
    plausible = Plausibility(ranges)
    lower, upper = ranges.range(column)
    return [t for t, value in readings if plausible.refusal(column, t, value) and lower <= value <= upper]


def _sent(seconds: float, *beyond: tuple[float, float], value: float = 1e9) -> list[tuple[float, float]]:
    times = [PERIOD * k for k in range(round(seconds / PERIOD))]
    return [(t, value if any(a <= t < b for a, b in beyond) else 0.0) for t in times]


def test_a_broken_contact_a_spike_and_what_is_rare_are_only_refused():
    assert not _refused(_sent(5.0, (1.0, 3.0)))  # once, however long
    assert not _refused(_sent(60.0, *((t, t + 0.15) for t in range(1, 60))))  # no stretch of 0.2 s
    assert not _refused(_sent(60.0, (1.0, 2.0), (2.5 + AGAIN, 3.0 + AGAIN)))  # a wave and more between
    assert not _refused([(t, 1e9 * (k % 2)) for k, (t, _) in enumerate(_sent(10.0))])  # never two in a row


def test_two_stretches_within_a_wave_tell_and_each_reading_beyond_tells_anew():
    refused = _refused(_sent(60.0, (1.0, 1.5), (4.0, 4.5)))
    assert refused[0] == pytest.approx(4.5, abs=0.03)
    assert refused[-1] == pytest.approx(4.5 + AGAIN, abs=0.05)
    more = _refused(_sent(80.0, (1.0, 1.5), (4.0, 4.5), (20.0, 20.02)))
    assert more[-1] == pytest.approx(20.0 + AGAIN, abs=0.05)


def test_only_a_range_with_a_margin_tells():
    """A feedback that is 6 % off passes the end of its range at each full stroke, and is refused there alone."""
    for column in ("active.displacement", "hook_load", "wire_layer"):
        assert not _refused(_sent(10.0, (1.0, 1.5), (4.0, 4.5)), column)
    for column in ("speed_reference", "active.pressure_b"):
        assert _refused(_sent(10.0, (1.0, 1.5), (4.0, 4.5)), column)


def test_a_sound_machine_keeps_no_account():
    assert not BeyondRange().ways
    fed = Fed()
    fed.run(WAVE)
    assert not fed.service.inputs._plausible._beyond.ways


def test_at_five_hertz_two_readings_are_a_stretch():
    times = [0.2 * k for k in range(300)]
    readings = [(t, 1e9 if 1.0 < t < 1.5 or 4.0 < t < 4.7 else 0.0) for t in times]
    assert _refused(readings)
