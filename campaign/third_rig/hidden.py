"""Where a hidden effect can enter: the balance of torques, the owner's figures, or the logged channels."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from campaign.third_rig.crane import BAR, GRAVITY, Crane
from campaign.third_rig.motion import Series
from campaign.third_rig.plan import DAY, FIRST_DAY
from campaign.third_rig.runs import Run

Channels = dict[str, Series]  # SI, oil in degC, one value per step of the plant

USUAL_PRESSURE = 200 * BAR
USUAL_SPEED = 200.0  # rad/s


@dataclass(frozen=True)
class Pressed:
    """A group of motors under pressure; per step of the plant, SI."""

    motors: int
    displacement: Series
    drop: Series  # Pa, signed
    port_a: Series
    port_b: Series
    stroke: Series  # displacement as a share of the largest one

    @property
    def pressure(self) -> Series:
        """The drop without its sign, as a share of 200 bar."""
        return np.abs(self.drop) / USUAL_PRESSURE


@dataclass
class State:
    """One run as the plant has it."""

    run: Run
    crane: Crane
    step: float  # s
    radius: Series | float  # m, where the wire really lies
    inertia: Series | float  # kg m^2, as it really is
    mass: Series  # kg, that really hangs
    load_torque: Series = field(default_factory=lambda: np.zeros(0))  # N m at the shaft, with the load's acceleration
    groups: dict[str, Pressed] = field(default_factory=dict)

    @property
    def drum_torque(self) -> Series:
        """N m at the drum, of the hanging mass at rest."""
        return self.mass * GRAVITY * self.radius

    @property
    def speed(self) -> Series:
        """Without its sign, rad/s."""
        return np.abs(self.run.speed)

    @property
    def fast(self) -> Series:
        """Speed as a share of 200 rad/s."""
        return self.speed / USUAL_SPEED

    @property
    def full(self) -> Series:
        """Drum torque as a share of the rated load's on the last layer."""
        return self.drum_torque / (self.crane.rated * 9.81 * self.crane.radii[-1])

    @property
    def motor_torque(self) -> float:
        """Of one motor at 200 bar and full stroke, N m."""
        return self.crane.max_displacement * USUAL_PRESSURE

    @property
    def torque(self) -> float:
        """Of all motors at 200 bar and full stroke, N m."""
        return self.crane.motors * self.motor_torque

    @property
    def days(self) -> Series:
        """Since the first day."""
        return (self.run.started + self.run.time - FIRST_DAY) / DAY

    @property
    def lead(self) -> Pressed:
        """The group that carries what the gas does not."""
        return self.groups[self.run.balancing]

    def of_motors(self, law: Callable[[Pressed], Series]) -> Series:
        """N m of all motors of a law that is 1 at 200 bar and full stroke's torque of one motor."""
        return sum((g.motors * self.motor_torque * law(g) for g in self.groups.values()), np.zeros_like(self.run.speed))


Torque = Callable[[State], Series]  # N m at the shaft, at size 1


@dataclass(frozen=True)
class Effect:
    """A hidden effect; every law grows with its size.

    `names` are the catalogue's that are right, the first its own; none for what is outside the catalogue.
    """

    names: tuple[str, ...]
    law: str  # in words
    opposing: Torque | None = None  # against the motion
    one_way: Torque | None = None  # whatever the motion
    radius: Callable[[Run, Crane], Series | float] | None = None  # m more
    inertia: Callable[[Run, Crane], Series | float] | None = None  # kg m^2 more
    mass: Callable[[Run, Crane], Series | float] | None = None  # kg that hang but are not weighed
    sensed: Callable[[Channels, State, float], None] | None = None  # changes the channels, given the size
    first_size: float = 0.01
    largest_size: float = 1e9
    fixed: bool = False  # it stays at its first size: its trace is not in the balance of torques
    rare: bool = False  # the trace counts in the twentieth of the time where it is largest
    slowest: float = 3.0  # rad/s under which the trace does not count
    options: Mapping[str, Any] = field(default_factory=dict)  # of `Options`: what it takes to show it


Hidden = tuple[tuple[Effect, float], ...]  # with sizes
