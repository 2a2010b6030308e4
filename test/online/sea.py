"""A swell as messages into a service, with faults on the way: what the tests of `online` feed."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

from winch_friction.compensation import CompensatorConfig, Feedforward
from winch_friction.online.compensator import CompensatorService
from winch_friction.online.inputs import ServiceOptions
from winch_friction.physics.signals import GroupSample, Sample
from winch_friction.records.bag_write import MESSAGES
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model
from winch_friction.records.topics import crane_topics

CRANE = load_crane("crane_150t")
SEED = load_model("a6vm215_crane2")
TOPICS = crane_topics(CRANE)
PERIOD = 0.02  # s
START = 1000.0  # s


def swell(now: float, period: float = 6.0, speed: float = 100.0) -> Sample:
    """An instant of heave compensation with 55 t, its pressures in balance with the load."""
    omega = speed * math.sin(2.0 * math.pi * now / period)
    groups = {
        "active": GroupSample(50e5, 25e5, CRANE.max_displacement),
        "passive": GroupSample(275e5, 25e5, CRANE.max_displacement / 3.0),
    }
    return Sample(time=now, motor_speed=omega, speed_reference=omega, hook_load=55e3, groups=groups)


@dataclass
class Fed:
    """A compensator service between a sender and a consumer, with the time that both go by.

    `published` holds (steady time, what was published).
    """

    config: CompensatorConfig = field(default_factory=lambda: CompensatorConfig(ramp_time=0.5))
    options: ServiceOptions = field(default_factory=ServiceOptions)
    now: float = START
    shift: float = 0.0  # of the stamps against the steady clock, s
    published: list[tuple[float, Feedforward]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.service = CompensatorService(CRANE, SEED, TOPICS, self.config, self.options)

    def messages(self, sample: Sample) -> Iterator[tuple[str, Any]]:
        """The messages of a sample by topic."""
        yield from TOPICS.encode(sample, MESSAGES)

    def send(self, sample: Sample, skip: tuple[str, ...] = ()) -> None:
        """One sample as messages at this moment."""
        for topic, message in self.messages(sample):
            if topic not in skip:
                self.hear(self.service.take(TOPICS.inputs[topic], message, self.now, self.now))

    def hear(self, said: Feedforward | None) -> None:
        """Note what was published."""
        if said is not None:
            self.published.append((self.now, said))

    def run(
        self, seconds: float, change: Callable[[Sample], None] = lambda _: None, skip: tuple[str, ...] = ()
    ) -> list[Feedforward]:
        """Send for a while, the watchdog looking in between; what was published meanwhile."""
        before = len(self.published)
        for _ in range(round(seconds / PERIOD)):
            self.now += PERIOD
            sample = swell(self.now)
            sample.time += self.shift
            change(sample)
            self.send(sample, skip)
            self.hear(self.service.tick(self.now))
        return [said for _, said in self.published[before:]]

    def wait(self, seconds: float) -> list[Feedforward]:
        """Nothing is sent; the watchdog looks on."""
        before = len(self.published)
        for _ in range(round(seconds / PERIOD)):
            self.now += PERIOD
            self.hear(self.service.tick(self.now))
        return [said for _, said in self.published[before:]]

    @property
    def torque(self) -> float:
        """What was published last, N m."""
        return self.published[-1][1].friction_torque


def check_invariants(fed: Fed) -> None:
    """What must hold of everything that was ever published: finite, bounded, and moving by steady time and by stamps no
    faster than the slew limit (stamps count their size: a clock that was set back is not a licence)."""
    slew = fed.config.slew_limit
    for (_, before), (_, after) in zip(fed.published[:-1], fed.published[1:], strict=True):
        assert math.isfinite(after.friction_torque)
        assert math.isfinite(after.pressure)
        assert abs(after.friction_torque) <= CRANE.absolute_torque_limit
        change = abs(after.friction_torque - before.friction_torque)
        assert change <= slew * abs(after.time - before.time) + 1e-9
        assert after.sequence == before.sequence + 1
    for (then, before), (now, after) in zip(fed.published[:-1], fed.published[1:], strict=True):
        slack = fed.config.max_age  # s that stamps may have been late, and catch up
        assert abs(after.friction_torque - before.friction_torque) <= slew * (now - then + slack) + 1e-9
