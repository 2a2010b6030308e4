"""The PLC: one scan per sensor period.

The speed is the encoder's angle difference over the scan, so every channel is taken, and stamped, in the middle of the
scan; the row is there at the scan's end, plus the transport delay.
"""

from dataclasses import dataclass

import numpy as np

from winch_friction.physics.corrections import s_shape
from winch_friction.physics.signals import FloatArray
from winch_friction.simulation.compiling import compiled, inlined
from winch_friction.simulation.scenario import Scenario
from winch_friction.simulation.sensors.channels import Channels


@dataclass(frozen=True)
class Scans:
    """Everything random about the scans, drawn beforehand: end of each scan in s, normals, which scans are lost."""

    ends: FloatArray
    normals: FloatArray
    lost: np.ndarray


def draw_scans(scenario: Scenario, channels: Channels, generator: np.random.Generator) -> Scans:
    """Scans 0 ... n of a run; scan 0 is the state at the start."""
    sensors = scenario.sensors
    count = int(round(scenario.duration * sensors.rate)) + 1
    ends = np.arange(count) / sensors.rate
    jitter = generator.random(count) * min(sensors.jitter, 0.4 / sensors.rate)
    ends[1:] -= jitter[1:]
    normals = generator.standard_normal((count, len(channels.names)))
    starts = generator.random(count) < sensors.dropout_rate / sensors.rate
    length = max(1, round(sensors.dropout_length * sensors.rate))
    lost = np.convolve(starts, np.ones(length))[:count] > 0
    lost[0] = False
    return Scans(ends, normals, lost)


@compiled
def at_time(history, column, period, time):
    """A column of the history at a time, linear between the control ticks, held before the start."""
    place = max(time, 0.0) / period
    last = len(history) - 1
    k = min(int(place), last - 1)
    return history[k, column] + (place - k) * (history[k + 1, column] - history[k, column])


@compiled
def quantise(value, step):
    """Nearest multiple of a step; no step, no change."""
    return np.floor(value / step + 0.5) * step if step > 0.0 else value


swung = inlined(s_shape)


@compiled
def scan(history, period, settings, ends, normals, j, row):
    """Scan number j into `row` (time, then the channels)."""
    end = ends[j]
    begin = ends[j - 1] if j > 0 else end
    middle = 0.5 * (begin + end)
    row[0] = middle
    for c in range(len(settings)):
        s = settings[c]
        if c == 0:
            first = quantise(at_time(history, s.source, period, begin - s.delay), s.step)
            second = quantise(at_time(history, s.source, period, end - s.delay), s.step)
            row[1] = (second - first) / (end - begin) if j > 0 else 0.0
            continue
        value = at_time(history, s.source, period, middle - s.delay)
        value *= s.scale * (1.0 + s.curvature * s.scale * value)
        if s.swing != 0.0:
            value += s.swing * swung(value / s.stroke)
        for k in range(len(s.bend)):
            if s.bend[k] == 0.0:
                break
            value += s.bend[k] * max(value - s.beyond[k], 0.0)
        value = value * (1.0 + s.relative_noise * normals[j, c]) + s.offset + s.noise * normals[j, c]
        row[c + 1] = quantise(value, s.step)


@compiled
def scan_all(history, period, settings, ends, normals, rows):
    """Every scan of a finished run."""
    for j in range(len(rows)):
        scan(history, period, settings, ends, normals, j, rows[j])
