"""Readings that cannot be what their column says: a layer that the drum has not, oil hotter than oil is."""

from collections.abc import Iterator, Sequence

import numpy as np

from winch_friction.commissioning.channels import Finding
from winch_friction.commissioning.view import BROKEN_SHARE, usable
from winch_friction.physics.signals import FloatArray, Run
from winch_friction.physics.winch.crane import Crane

# degC; a hydraulic oil is at the end of its viscosity above, and 40 degC are 104 degF and 313 K
OIL = (-20.0, 95.0)
FREEZING = 273.15  # K
COUNTED = "counted"  # cause of layers counted from 0, which no drum has


def reading_findings(runs: Sequence[Run], crane: Crane) -> Iterator[Finding]:
    """What is wrong with the layers and the oil of runs, by the crane's drum and by what oil is."""
    for run in runs:
        yield from _of_layers(run, crane)
        yield from _of_oil(run)


def _of_layers(run: Run, crane: Crane) -> Iterator[Finding]:
    layers = _known(run, "wire_layer")
    if not len(layers) or (crane.drum.has(layers.min()) and crane.drum.has(layers.max())):
        return
    said = (
        f"{run.name}: wire_layer is {layers.min():g} ... {layers.max():g}, the drum has layers 1 ... "
        f"{len(crane.drum.layer_radii)}"
    )
    from_zero = layers.min() == 0.0 and crane.drum.has(layers.max() + 1.0)
    if from_zero:
        said += ": 1 is the innermost; where the log counts it as 0, add 1"
    off = float(np.mean([not crane.drum.has(each) for each in layers]))
    # few cells are a counter that was not set yet
    severity, cause = "error" if off > BROKEN_SHARE else "warning", COUNTED if from_zero else "range"
    yield Finding(severity, cause, said, "wire_layer", (run.name,), {"share": off})


def _of_oil(run: Run) -> Iterator[Finding]:
    oil = _known(run, "oil_temperature")
    if not len(oil) or (OIL[0] <= oil.min() and oil.max() <= OIL[1]):
        return
    kelvin = OIL[0] <= oil.min() - FREEZING and oil.max() - FREEZING <= OIL[1]
    unit, severity = ("kelvin", "error") if kelvin else ("degF", "warning")
    said = (
        f"{run.name}: oil of {oil.min():.3g} ... {oil.max():.3g} degC: does oil_temperature hold {unit} under [degC]?"
    )
    yield Finding(severity, "range", said, "oil_temperature", (run.name,))


def _known(run: Run, name: str) -> FloatArray:
    values = usable(name, run.column(name))
    return values[np.isfinite(values)]
