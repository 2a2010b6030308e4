"""How a mistake is put right in a run's view: the same few changes, times a factor, for every kind of mistake."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from winch_friction.commissioning.view import GroupView, RunView

Repair = Callable[[RunView], RunView]


def speed_times(factor: float) -> Repair:
    """The speed and what follows from it, times a factor."""
    return lambda view: replace(view, speed=view.speed * factor, acceleration=view.acceleration * factor)


def speeds_times(factor: float, *also: str) -> Repair:
    """The speed and other channels that tell it, times a factor: what one logger writes in one unit."""

    def undo(view: RunView) -> RunView:
        rates = {name: rate * factor if name in also else rate for name, rate in view.rates.items()}
        return replace(speed_times(factor)(view), rates=rates)

    return undo


def load_times(factor: float) -> Repair:
    """The load times a factor."""

    def undo(view: RunView) -> RunView:
        torque = None if view.load_torque is None else view.load_torque * factor
        return replace(view, load=view.load * factor, load_torque=torque)

    return undo


def groups_changed(change: Callable[[str, GroupView], GroupView]) -> Repair:
    """Every motor group changed by its name."""
    return lambda view: replace(view, groups={name: change(name, group) for name, group in view.groups.items()})


def drop_times(factor: float, only: str = "") -> Repair:
    """Pressures times a factor, of one group or of all."""

    def change(name: str, group: GroupView) -> GroupView:
        if only and name != only:
            return group
        return replace(group, drop=group.drop * factor, pressure_sum=group.pressure_sum * abs(factor))

    return groups_changed(change)


def port_times(factor: float, port: str) -> Repair:
    """The pressures of one port of all groups, times a factor."""

    def change(_: str, group: GroupView) -> GroupView:
        a, b = 0.5 * (group.pressure_sum + group.drop), 0.5 * (group.pressure_sum - group.drop)
        a, b = (a * factor, b) if port == "a" else (a, b * factor)
        return replace(group, drop=a - b, pressure_sum=a + b)

    return groups_changed(change)


def displacement_times(factor: float, only: str = "") -> Repair:
    """Displacements times a factor, of one group or of all."""

    def change(name: str, group: GroupView) -> GroupView:
        return group if only and name != only else replace(group, displacement=group.displacement * factor)

    return groups_changed(change)


def motor_torque_times(factor: float) -> Repair:
    """The motor torque times a factor."""
    return lambda v: v if v.motor_torque is None else replace(v, motor_torque=v.motor_torque * factor)


def in_falls(number: int) -> Repair:
    """The hook in so many falls of rope: its weight, way and inertia at the drum; a force in the rope is what it is.

    `wire_out` may be the rope paid out or the hook's depth, a part of it: the speed tells which.
    """

    def undo(view: RunView) -> RunView:
        rates = dict(view.rates)
        if "wire_out" in rates:
            told, lever = np.nansum(np.abs(rates["wire_out"])), np.nansum(np.abs(view.speed * view.lever))
            rates["wire_out"] = rates["wire_out"] / (number if told**2 * number > lever**2 else 1)
        return replace(view, radius=view.radius / number, rates=rates, bounce=view.bounce * number)

    return undo
