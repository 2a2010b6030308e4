"""Where a rope climbs onto its next layer: at one place of the drum, which a log's `wire_layer` should show."""

from typing import NamedTuple

import numpy as np

from winch_friction.physics.errors import counted
from winch_friction.physics.signals import FloatArray, Run
from winch_friction.physics.winch.crane import Crane

WORTH_SAYING = 0.2  # of a run's samples; a rope that climbs once in a long hoist costs less
MOVING = 1.0  # rad/s of a fast motor; noise of an encoder at rest turns nothing back
CLIMBS = np.pi  # rad of the drum, half a turn, in which a rope is on its next layer, along the flange


def away_from(angle: FloatArray, changes: FloatArray, gear_ratio: float) -> np.ndarray:
    """Samples that are half a turn of the drum and more, by the shaft's angle in rad, away from any change of layer."""
    changes = np.sort(changes)
    if not len(changes):
        return np.ones(len(angle), bool)
    after = np.searchsorted(changes, angle)
    around = (changes[np.clip(after - one, 0, len(changes) - 1)] for one in (0, 1))
    return np.min([np.abs(angle - each) for each in around], axis=0) > CLIMBS * gear_ratio


class LayerChanges(NamedTuple):
    """How often a run's `wire_layer` changes; `near`: the share of its samples within half a turn of the drum of a
    change; `most`: how often it can change, once at each place where a rope climbs before the drum turns back."""

    changes: int = 0
    near: float = 0.0
    most: int = 0


def layer_changes(run: Run, crane: Crane) -> LayerChanges:
    """What the changes of `wire_layer` of a run say beside its `motor_speed`; zeros without a change."""
    if "wire_layer" not in run or "motor_speed" not in run:
        return LayerChanges()
    layer, speed, time = np.rint(run["wire_layer"]), run["motor_speed"], run.time
    known = np.isfinite(layer) & np.isfinite(speed) & np.isfinite(time)
    layer, speed, time = layer[known], speed[known], time[known]
    changed = np.flatnonzero(np.diff(layer)) + 1
    if not len(changed):
        return LayerChanges()
    angle = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(time))])
    near = 1.0 - float(np.mean(away_from(angle, angle[changed], crane.gear_ratio)))
    moving = np.sign(speed[np.abs(speed) > MOVING * crane.speed_scale])
    turns = int(np.count_nonzero(np.diff(moving)))
    return LayerChanges(len(changed), near, (turns + 1) * int(np.ptp(layer)))


def lost_to_layers(run: Run, crane: Crane) -> str:
    """In words, what a run loses by the changes of its `wire_layer`, and whether it can change so often; '' nothing."""
    found = layer_changes(run, crane)
    if not found.changes:
        return ""
    often, flips = counted(found.changes, "time", "times"), ""
    if found.changes > found.most:
        flips = f", where the winch can pass such a place {found.most} times: a counter that flips?"
    return (
        f"{run.name}: wire_layer changes {often}{flips}; "
        f"{found.near:.0%} of the samples lie within half a turn of the drum of a change, and tell gap nothing"
    )
