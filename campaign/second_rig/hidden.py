"""Where a hidden effect can enter the plant and its sensors; by default everywhere as the owner's files say."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from campaign.second_rig.crane import Crane, Friction
from campaign.second_rig.motion import Series, bristle
from campaign.second_rig.voyages import Voyage

SLIP = 0.002  # rad of the shaft within which friction turns over


@dataclass
class State:
    """One run as the plant has it: every series one value per step, SI, oil in degC."""

    crane: Crane
    truth: Friction
    voyage: Voyage
    time: Series  # from 0
    speed: Series
    speed_abs: Series
    acceleration: Series
    angle: Series
    wire_out: Series
    celsius: Series
    mass: Series  # that hangs
    weighed: Series  # kg, what the load cell says
    reference: Series  # rad/s, wanted speed
    heave: Series  # m/s, of the crane's tip
    groups: dict[str, int]  # motors of each
    boost: Series
    radius: float  # m, where the rope really lies
    drum_torque: Series = field(default_factory=lambda: np.zeros(0))  # N m, of the hanging mass at rest
    turned_over: Series = field(default_factory=lambda: np.zeros(0))  # sign of the friction, -1 to 1
    displacement: dict[str, Series] = field(default_factory=dict)  # m^3/rad, of one motor
    pressure: dict[str, Series] = field(default_factory=dict)  # Pa, drop over a motor

    @property
    def lead(self) -> str:
        """The group that carries what the gas does not."""
        return "active" if "active" in self.groups else "main"


def nothing(run: State) -> Series | float:
    """No torque, N m."""
    return 0.0


def nothing_of_group(run: State, group: str) -> Series | float:
    """No torque, N m."""
    return 0.0


def no_drop(run: State, group: str) -> Series | float:
    """No pressure between motor and transducer, Pa."""
    return 0.0


@dataclass(frozen=True)
class Hidden:
    """What differs from the owner's files."""

    winch_friction: Callable[[State], Series | float] = nothing  # N m per motor's shaft, against the motion
    motor_friction: Callable[[State, str], Series | float] = nothing_of_group  # N m per motor of a group, against it
    one_way: Callable[[State], Series | float] = nothing  # N m at the shaft, whatever the motion
    shaft_friction: Callable[[State], Series | float] = nothing  # N m at the shaft, against the motion
    load_force: Callable[[State], Series | float] = nothing  # N, at the load
    line_drop: Callable[[State, str], Series | float] = no_drop  # Pa that the transducer reads more, against the motion
    radius: Callable[[Crane, int, float], float] = lambda crane, layer, mass: crane.radii[layer - 1]  # m
    mass: Callable[[float, Voyage], float] = lambda mass, voyage: mass  # kg, hanging, of the logged one
    turned_over: Callable[[State], Series] = lambda run: bristle(run.speed, SLIP)
    inertia: float = 1.0  # of the stated one
    read_pressure: Callable[[State, str, str, Series], Series] = lambda run, group, side, pressure: pressure
    read_displacement: Callable[[State, str, Series], Series] = lambda run, group, displacement: displacement
    pressure_filter: float = 0.003  # s
    speed_delay: float = 0.0  # s


OWN_CONTACT = Hidden.turned_over


def both(first: Hidden, second: Hidden) -> Hidden:
    """Two effects at once."""
    return Hidden(
        winch_friction=lambda run: first.winch_friction(run) + second.winch_friction(run),
        motor_friction=lambda run, group: first.motor_friction(run, group) + second.motor_friction(run, group),
        one_way=lambda run: first.one_way(run) + second.one_way(run),
        shaft_friction=lambda run: first.shaft_friction(run) + second.shaft_friction(run),
        load_force=lambda run: first.load_force(run) + second.load_force(run),
        line_drop=lambda run, group: first.line_drop(run, group) + second.line_drop(run, group),
        radius=lambda crane, layer, mass: (
            first.radius(crane, layer, mass) + second.radius(crane, layer, mass) - crane.radii[layer - 1]
        ),
        mass=lambda mass, voyage: second.mass(first.mass(mass, voyage), voyage),
        turned_over=first.turned_over if first.turned_over is not OWN_CONTACT else second.turned_over,
        inertia=first.inertia * second.inertia,
        read_pressure=lambda run, group, side, pressure: second.read_pressure(
            run, group, side, first.read_pressure(run, group, side, pressure)
        ),
        read_displacement=lambda run, group, displacement: second.read_displacement(
            run, group, first.read_displacement(run, group, displacement)
        ),
        pressure_filter=max(first.pressure_filter, second.pressure_filter),
        speed_delay=first.speed_delay + second.speed_delay,
    )
