"""Channels that nobody measured, told by what the others say: not a unit or a sign, but a sensor that is not there."""

from collections.abc import Iterator, Sequence

import numpy as np

from winch_friction.commissioning.finding import Finding
from winch_friction.commissioning.mistakes import LARGEST_TARE
from winch_friction.commissioning.view import RunView
from winch_friction.physics.signals import Run
from winch_friction.physics.units import GRAVITY, RPM

WIRE_MOVED = 0.5  # m of wire that came or went while motor_speed stood: five steps of a coarse counter


def dead_findings(runs: Sequence[Run], views: Sequence[RunView]) -> Iterator[Finding]:
    """A speed that stands while the wire runs, a hook load of nothing while the motors hold tonnes.

    `views` are the runs' own, in their order; both of hydraulic winches. Data with either contradict the crane.
    """
    for run, view in zip(runs, views, strict=True):
        yield from _speed(run)
        yield from _load(run, view)


def _speed(run: Run) -> Iterator[Finding]:
    speed = run["motor_speed"][np.isfinite(run["motor_speed"])]
    if not speed.size or np.ptp(speed) > 0.0 or "wire_out" not in run:
        return
    known = run["wire_out"][np.isfinite(run["wire_out"])]
    moved = float(np.ptp(known)) if known.size else 0.0
    if moved > WIRE_MOVED:
        said = (
            f"{run.name}: motor_speed never changes ({speed[0] / RPM:.3g} rpm) though wire_out moves by "
            f"{moved:.3g} m: is the sensor connected?"
        )
        yield Finding("error", "stuck", said, "motor_speed", (run.name,), {"wire_moved": moved})


def _load(run: Run, view: RunView) -> Iterator[Finding]:
    if "hook_load" not in run or not view.groups:
        return
    load, lever = run["hook_load"][np.isfinite(run["hook_load"])], float(np.median(view.lever))
    held = float(np.nanmean(view.drive_torque)) / (GRAVITY * lever)
    least = LARGEST_TARE * view.rated_torque / (GRAVITY * lever)  # what hook, block and wire may weigh
    if load.size and np.ptp(load) == 0.0 and abs(load[0]) < 0.01 * least < held and held > least:
        said = (
            f"{run.name}: hook_load is {load[0] / 1e3:.3g} t throughout though the motors hold about {held / 1e3:.3g} "
            "t: is the load cell connected? (a known load: import --set 'hook_load.constant=... t')"
        )
        yield Finding("error", "cell", said, "hook_load", (run.name,), {"held": held})
