"""Ways in which sensors and networks break, as functions from good samples to bad ones."""

import copy

import numpy as np

from winch_friction.physics.signals import GroupSample

START, END = 4.0, 5.5  # s; the fault lasts between them
CHANNELS = (
    "motor_speed",
    "speed_reference",
    "hook_load",
    "active.pressure_a",
    "passive.pressure_b",
    "active.displacement",
)


def get(sample, channel):
    group, _, name = channel.rpartition(".")
    return getattr(sample.groups[group] if group else sample, name)


def put(sample, channel, value):
    group, _, name = channel.rpartition(".")
    setattr(sample.groups[group] if group else sample, name, value)


def during(samples, change):
    """Copies of the samples, those within the fault changed."""
    out = copy.deepcopy(samples)
    for k, sample in enumerate(out):
        if START <= sample.time < END:
            change(k, sample)
    return out


def dropout(samples, channel):
    return during(samples, lambda k, s: put(s, channel, np.nan))


def spike(samples, channel):
    """Every tenth value is absurd."""
    absurd = (1e12, -1e12, np.inf, -np.inf, 1e300)
    return during(samples, lambda k, s: put(s, channel, absurd[k % 5]) if k % 10 == 0 else None)


def stuck(samples, channel):
    first = next(get(s, channel) for s in samples if s.time >= START)
    return during(samples, lambda k, s: put(s, channel, first))


def delayed(samples, channel):
    """Two scans late."""
    return during(samples, lambda k, s: put(s, channel, get(samples[k - 2], channel)))


def zero(samples, channel):
    return during(samples, lambda k, s: put(s, channel, 0.0))


def noisy(samples, channel):
    rng = np.random.default_rng(0)
    return during(samples, lambda k, s: put(s, channel, get(s, channel) * (1.0 + rng.normal())))


SENSOR_FAULTS = (dropout, spike, stuck, delayed, zero, noisy)


def reordered(samples):
    out = copy.deepcopy(samples)
    for k in range(len(out) - 1):
        if START <= out[k].time < END and k % 3 == 0:
            out[k], out[k + 1] = out[k + 1], out[k]
    return out


def repeated(samples):
    return [copy.deepcopy(s) for s in samples for _ in range(2 if START <= s.time < END else 1)]


def lost(samples):
    return [copy.deepcopy(s) for s in samples if not START <= s.time < END]


def clock_back(samples):
    return during(samples, lambda k, s: setattr(s, "time", s.time - 100.0))


def clock_ahead(samples):
    return during(samples, lambda k, s: setattr(s, "time", s.time + 3600.0))


def no_time(samples):
    return during(samples, lambda k, s: setattr(s, "time", np.nan if k % 2 else np.inf))


def everything_nan(samples):
    def blank(_, sample):
        sample.motor_speed = sample.speed_reference = sample.hook_load = np.nan
        sample.groups = {name: GroupSample() for name in sample.groups}

    return during(samples, blank)


def no_groups(samples):
    return during(samples, lambda k, s: setattr(s, "groups", {}))


STREAM_FAULTS = (reordered, repeated, lost, clock_back, clock_ahead, no_time, everything_nan, no_groups)
