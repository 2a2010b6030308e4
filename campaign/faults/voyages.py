"""Clean voyages to spoil: what healthy sensors say in heave compensation, and what the torque may at most be."""

import math
from dataclasses import dataclass
from functools import cache
from types import SimpleNamespace
from typing import Any

from winch_friction.compensation.parts import FrictionLaw
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import Sample
from winch_friction.physics.winch.crane import Crane
from winch_friction.physics.winch.operating_point import ChannelRanges, sample_operating_point
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model
from winch_friction.records.topics import TopicMap, crane_topics
from winch_friction.simulation.scenario import load_scenario
from winch_friction.simulation.simulator import simulate

SCENARIOS = ("ahc_irregular", "ahc_55t_215", "ahc_swell", "ahc_calming", "ahc_harsh_sensors")
PERIOD = 0.02  # s
DURATION = 60.0  # s
ENVELOPE = 1.3  # docs/safety.md


class PlainMessages:
    """Messages as bare fields: the decoders read nothing else, and a hundred thousand draws need them quick."""

    def make(self, type_name: str, **fields: Any) -> Any:
        """A message or a part of one."""
        return SimpleNamespace(**fields)

    def doubles(self, values: Any) -> Any:
        """A float64 array."""
        return list(values)


MESSAGES = PlainMessages()


@dataclass(frozen=True)
class Voyage:
    """One clean voyage of one crane: samples on a steady period, and the largest torque that is ever plausible, N m."""

    name: str
    crane: Crane
    model: FrictionModel
    topics: TopicMap
    samples: tuple[Sample, ...]
    largest: float


@cache
def voyage(scenario: str, seed: int) -> Voyage:
    """A voyage of the 150 t crane."""
    crane, model = load_crane("crane_150t"), load_model("a6vm215_crane2")
    sea = load_scenario(scenario).override({"duration": DURATION})
    run = simulate(sea, crane, model, seed=seed).run
    samples = [s for s in run.samples() if s.motor_speed == s.motor_speed]
    return Voyage(f"{scenario}/{seed}", crane, model, crane_topics(crane), tuple(samples), largest(crane, model))


def largest(crane: Crane, model: FrictionModel) -> float:
    """The seed's friction at the worst corner of what the crane's channels can show, times the envelope, N m.

    The absolute limit where that is less.
    """
    ranges, law = ChannelRanges(crane), FrictionLaw(model, {})
    worst = 0.0
    for speed in (1.0, 20.0, 0.5 * ranges.speed, ranges.speed):
        for share in (0.0, 1.0):
            from winch_friction.physics.signals import GroupSample

            high = share * ranges.pressure
            groups = {g: GroupSample(high, 0.0, 1.05 * crane.max_displacement) for g in ("active", "passive")}
            sample = Sample(time=0.0, motor_speed=speed, speed_reference=speed, hook_load=ranges.load, groups=groups)
            torque = crane.drum_torque(ranges.load)
            x = sample_operating_point(sample, crane, drum_torque=torque, speed=speed, width=1e-6)
            worst = max(worst, law.magnitude(x, 2))
    return min(ENVELOPE * worst, crane.absolute_torque_limit) if math.isfinite(worst) else crane.absolute_torque_limit
