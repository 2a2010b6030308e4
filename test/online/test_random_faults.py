"""Faults one after the other, in any order: what must hold of everything that is published."""

import math
import random
from collections.abc import Callable

import pytest
from sea import PERIOD, SEED, Fed, check_invariants, swell

from winch_friction.compensation import CompensatorConfig
from winch_friction.physics.signals import Sample

COLUMNS = ("motor_speed", "speed_reference", "hook_load", "active.pressure_a", "passive.displacement", "wire_layer")
VALUES = (math.nan, math.inf, -math.inf, 0.0, 1e12, -1e12, 590.0, -590.0, 1e300, -1.0)
SHIFTS = (-3600.0, -5.0, -1.2, -0.5, -0.05, 0.05, 0.3, 0.6, 2.0, 3600.0)


def _bad(fed: Fed, draw: random.Random) -> None:
    group, _, name = draw.choice(COLUMNS).rpartition(".")
    value, share = draw.choice(VALUES), draw.choice((0.1, 1.0))

    def spoil(sample: Sample) -> None:
        if draw.random() < share:
            setattr(sample.groups[group] if group else sample, name, value)

    fed.run(draw.uniform(0.1, 1.0), spoil)


def _frozen(fed: Fed, draw: random.Random) -> None:
    stamp = fed.now + fed.shift
    fed.run(draw.uniform(0.1, 1.0), lambda sample: setattr(sample, "time", stamp))


def _burst(fed: Fed, draw: random.Random) -> None:
    samples = [swell(fed.now + fed.shift + PERIOD * (k + 1)) for k in range(draw.randint(2, 80))]
    fed.now += len(samples) * PERIOD * draw.choice((1.0, 0.5, 0.1))
    for sample in samples:
        fed.send(sample)


def _disorder(fed: Fed, draw: random.Random) -> None:
    samples = [swell(fed.now + fed.shift + PERIOD * k) for k in range(10) for _ in range(draw.randint(1, 3))]
    draw.shuffle(samples)
    for sample in samples:
        fed.now += 0.5 * PERIOD
        fed.send(sample)
        fed.hear(fed.service.tick(fed.now))


def _end(fed: Fed, draw: random.Random) -> None:
    began = fed.now
    for after, said in fed.service.ending(began):
        fed.now = began + after
        fed.hear(said)
    assert not fed.published or fed.torque == 0.0
    fed.service.reset()


def _model(fed: Fed, draw: random.Random) -> None:
    factor = draw.uniform(0.6, 1.45)
    fed.service.load_model(SEED.with_values({n: SEED.value(n) * factor for n in ("C1", "C5", "C6", "K4")}))


def _settings(fed: Fed, draw: random.Random) -> None:
    fed.config = CompensatorConfig(ramp_time=fed.config.ramp_time, scale=draw.uniform(0.3, 1.3))
    fed.service.configure(fed.config)


def _shift(fed: Fed, draw: random.Random) -> None:
    fed.shift += draw.choice(SHIFTS)


EVENTS: tuple[Callable[[Fed, random.Random], object], ...] = (
    lambda fed, draw: fed.run(draw.uniform(0.05, 1.5)),
    lambda fed, draw: fed.run(draw.uniform(0.5, 1.5)),
    lambda fed, draw: fed.wait(draw.uniform(0.02, 1.5)),
    lambda fed, draw: fed.service.reset(),
    lambda fed, draw: fed.service.set_enabled(draw.random() < 0.6),
    _bad, _frozen, _burst, _disorder, _end, _model, _settings, _shift,
)  # fmt: skip


@pytest.mark.parametrize("first", range(0, 80, 10))
def test_nothing_jumps_and_everything_ends_at_zero(first: int) -> None:
    for seed in range(first, first + 10):
        draw = random.Random(seed)
        fed = Fed(config=CompensatorConfig(ramp_time=draw.choice((0.02, 0.1, 0.5, 1.0)), lead=draw.choice((0.0, 0.05))))
        for _ in range(draw.randint(4, 14)):
            draw.choice(EVENTS)(fed, draw)
        fed.wait(3.0)
        check_invariants(fed)
        assert not fed.published or fed.torque == 0.0
