"""Run files as a plant's historian would export them."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from campaign.rig.truth import BAR, CM3_PER_REV, RPM

_UNITS = {
    "time": ("s", 1.0),
    "motor_speed": ("rpm", RPM),
    "speed_reference": ("rpm", RPM),
    "pressure_a": ("bar", BAR),
    "pressure_b": ("bar", BAR),
    "displacement": ("cm^3/rev", CM3_PER_REV),
    "hook_load": ("t", 1e3),
    "heave_velocity": ("m/s", 1.0),
    "oil_temperature": ("degC", 1.0),
    "wire_out": ("m", 1.0),
    "shaft_angle": ("rad", 1.0),
}


def write_csv(folder: Path, dataset: Sequence[Mapping[str, np.ndarray]], units: str = "plant") -> list[Path]:
    """One CSV file per run; `units` 'plant' writes rpm, bar and cm^3/rev with brackets, 'si' writes bare SI."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = []
    for k, columns in enumerate(dataset):
        header, values, formats = [], [], []
        for name, column in columns.items():
            unit, factor = _UNITS.get(name.rpartition(".")[2], ("", 1.0)) if units == "plant" else ("", 1.0)
            header.append(f"{name} [{unit}]" if unit else name)
            values.append(column / factor)
            formats.append("%.6f" if name == "time" else "%.8g")
        path = folder / f"run_{k + 1:02d}.csv"
        np.savetxt(path, np.column_stack(values), delimiter=",", header=",".join(header), comments="", fmt=formats)
        paths.append(path)
    return paths
