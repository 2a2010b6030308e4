"""Losses of winch and motor that the seed model lacks, each under a law of its own.

Every law takes crane, truth and the planned voyages and gives what is hidden. Torques scale with the motor's size.
"""

from collections.abc import Callable, Sequence

import numpy as np

from campaign.second_rig.crane import BAR, Crane, Friction
from campaign.second_rig.hidden import Hidden, State, both
from campaign.second_rig.motion import STEP, Series, bristle
from campaign.second_rig.voyages import Voyage

Voyages = Sequence[Voyage]
Law = Callable[[Crane, Friction, Voyages], Hidden]


def null(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """Nothing."""
    return Hidden()


def two(first: Law, second: Law) -> Law:
    """Two laws at once."""
    return lambda crane, truth, voyages: both(first(crane, truth, voyages), second(crane, truth, voyages))


def _of_gear(run: State) -> Series:
    """Drum torque at the motor shaft, N m."""
    return run.drum_torque / run.crane.gear


def _full(run: State) -> Series:
    """Mass as a share of the rated one."""
    return run.mass / run.crane.rated


def wear_step(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """More friction after the longest pause between two dates."""
    dates = sorted(voyage.date for voyage in voyages)
    inner = range(3, len(dates) - 2)
    pause = max(inner, key=lambda k: dates[k] - dates[k - 1])
    since = 0.5 * (dates[pause] + dates[pause - 1])
    return Hidden(winch_friction=lambda run: 5 * crane.size * (run.voyage.date > since))


def wear_sqrt(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """Wear with the root of time."""
    first, last = min(voyage.date for voyage in voyages), max(voyage.date for voyage in voyages)
    return Hidden(
        winch_friction=lambda run: 6 * crane.size * np.sqrt((run.voyage.date + run.time - first) / (last - first))
    )


def viscosity_andrade(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """Viscosity after Andrade, thinning under shear."""

    def friction(run: State) -> Series:
        thicker = np.exp(2900 * (1 / (run.celsius + 273.15) - 1 / 313.15)) - 1
        return 0.0135 * crane.size * run.speed_abs * thicker / (1 + run.speed_abs / 600)

    return Hidden(winch_friction=friction)


def viscosity_power(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """Viscosity with a power of the temperature."""
    return Hidden(winch_friction=lambda run: 0.016 * crane.size * run.speed_abs**0.9 * ((40 / run.celsius) ** 2.1 - 1))


def viscosity_gear_oil(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """Drag of gear oil that falls straight with the temperature."""
    return Hidden(winch_friction=lambda run: 0.02 * crane.size * run.speed_abs * np.clip((50 - run.celsius) / 22, 0, 2))


def brake_on_some(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """A brake that drags in four of the runs."""
    return Hidden(
        winch_friction=lambda run: (
            7 * crane.size * (run.voyage.number in (1, 3, 6, 9)) * (1 - 0.1 * np.clip(_fast(run), 0, 1))
        )
    )


def brake_on_all(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """A brake that always drags."""
    return Hidden(winch_friction=lambda run: 8 * crane.size * (1 - 0.15 * np.clip(_fast(run), 0, 1)))


def _fast(run: State) -> Series:
    """Speed as a share of the top one."""
    return run.speed_abs / run.crane.top_speed


def sheave_load(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """A sheave's loss that grows a little faster than the load."""
    return Hidden(shaft_friction=lambda run: 0.035 * _of_gear(run) * _full(run) ** 0.25)


def sheave_speed(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """A sheave's loss that falls a little with the speed."""
    return Hidden(shaft_friction=lambda run: 0.03 * _of_gear(run) * (1 + 0.15 * np.exp(-run.speed_abs / 40)))


def case_seal(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """A lip seal pressed by the case, which follows both ports."""
    return Hidden(
        motor_friction=lambda run, group: (
            6 * crane.size * ((run.boost * 2 + np.abs(run.pressure[group])) / (300 * BAR)) ** 0.85
        )
    )


def churning_power(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """Churning with a power of the speed."""
    return Hidden(winch_friction=lambda run: 7 * crane.size * _fast(run) ** 1.6)


def churning_onset(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """Churning that sets in around half the top speed."""
    return Hidden(
        winch_friction=lambda run: (
            6 * crane.size * np.log1p(np.exp((run.speed_abs - 0.5 * crane.top_speed) / (0.12 * crane.top_speed))) / 4
        )
    )


def stribeck_root(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """A second Stribeck fall, stretched."""
    return Hidden(
        winch_friction=lambda run: (
            (0.4 * truth["C1"] * run.drum_torque + 4 * crane.size) * np.exp(-np.sqrt(run.speed_abs / 6.0))
        )
    )


def stribeck_slow(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """A second Stribeck fall at creep speed, after a power."""
    return Hidden(winch_friction=lambda run: 0.7 * truth["C1"] * run.drum_torque / (1 + (run.speed_abs / 9.0) ** 1.4))


def presliding_iwan(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """Three contacts in parallel that turn over within 0.02, 0.8 and 2.5 rad of the shaft."""
    contacts = ((0.02, 0.3), (0.8, 0.4), (2.5, 0.3))  # rad, share
    return Hidden(
        turned_over=lambda run: np.sum([bristle(run.speed, slip) * share for slip, share in contacts], axis=0)
    )


def dwell_log(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """Stiction that grows with the logarithm of the rest and is worn off within 8 rad."""

    def friction(run: State) -> Series:
        return _rested(run.speed_abs) * (9 * crane.size + 0.3 * truth["C6"] * run.drum_torque)

    return Hidden(winch_friction=friction)


def _rested(speed: Series) -> Series:
    out = np.empty(len(speed))
    rest, grown, travelled = 0.0, 0.0, 1e9  # s, share, rad
    for k, each in enumerate(speed.tolist()):
        if each < 0.05:
            rest += STEP
            travelled = 0.0
        else:
            if travelled == 0.0:
                grown = np.log1p(rest / 0.8) / 3
                rest = 0.0
            travelled += each * STEP
        out[k] = grown * np.exp(-travelled / 8.0)
    return out


def gear_hoisting(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """A gear that loses more while it hoists."""
    return Hidden(one_way=lambda run: np.where(run.speed > 0, 0.012 * _of_gear(run) * _full(run) ** 0.2, 0))


def low_displacement(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """A loss under pressure of motors that are swung back."""
    return Hidden(
        motor_friction=lambda run, group: (
            11
            * crane.size
            * (np.abs(run.pressure[group]) / (200 * BAR))
            * np.clip(1 - run.displacement[group] / crane.max_displacement, 0, 1) ** 1.4
        )
    )


def turbulence(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """Turbulence with powers of its own."""
    return Hidden(
        motor_friction=lambda run, group: (
            12
            * crane.size
            * (run.displacement[group] / crane.max_displacement) ** 2.7
            * (run.speed_abs / (0.9 * crane.top_speed)) ** 1.75
        )
    )


def high_pressure(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """A loss exponential in the pressure."""
    return Hidden(
        motor_friction=lambda run, group: 2.2 * crane.size * (np.exp(np.abs(run.pressure[group]) / (130 * BAR)) - 1)
    )


def port_notch(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """A loss that peaks at 35 rad/s."""
    return Hidden(
        motor_friction=lambda run, group: (
            6
            * crane.size
            * run.displacement[group]
            / crane.max_displacement
            * (np.abs(run.pressure[group]) / (200 * BAR)) ** 1.3
            * (run.speed_abs / 35)
            * np.exp(1 - run.speed_abs / 35)
        )
    )


def inertia(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """45 % more inertia than stated."""
    return Hidden(inertia=1.45)


def ripple(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """Once and three times per turn of the drum."""

    def torque(run: State) -> Series:
        turned = run.angle / crane.gear
        return _of_gear(run) * (0.012 * np.sin(turned + 0.4) + 0.006 * np.sin(3 * turned))

    return Hidden(one_way=torque)


def ripple_triangle(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """Seven triangles per turn of the drum, from a planet of its gear."""

    def torque(run: State) -> Series:
        turned = 7 * run.angle / crane.gear / (2 * np.pi)
        return _of_gear(run) * 0.012 * (4 * np.abs(turned % 1 - 0.5) - 1)

    return Hidden(one_way=torque)
