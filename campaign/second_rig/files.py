"""A set as its owner has it on disk: crane.yaml, model.yaml, one CSV file per run, in one of four habits of units."""

from collections.abc import Callable
from pathlib import Path

import numpy as np

from campaign.second_rig.crane import (
    BAR,
    CM3_PER_REV,
    RPM,
    crane_text,
    draw_crane,
    draw_supplier,
    draw_truth,
    model_text,
)
from campaign.second_rig.hidden import State
from campaign.second_rig.plant import sail
from campaign.second_rig.sensors import Columns, logged
from campaign.second_rig.sets import Set
from campaign.second_rig.voyages import Logging, Voyage, draw_voyages

# of a channel's last word: unit, SI per unit, format
UNITS: tuple[dict[str, tuple[str, float, str]], ...] = (
    {"pressure": ("bar", BAR, "%.5g"), "speed": ("rpm", RPM, "%.5f"), "displacement": ("cm^3/rev", CM3_PER_REV, "%.6g"),
     "hook_load": ("t", 1e3, "%.6g"), "oil": ("degC", 1.0, "%.2f")},
    {"pressure": ("MPa", 1e6, "%.5g"), "speed": ("rad/s", 1.0, "%.5f"), "displacement": ("m^3/rad", 1.0, "%.6g"),
     "hook_load": ("kg", 1.0, "%.6g"), "oil": ("degC", 1.0, "%.2f")},
    {"pressure": ("kPa", 1e3, "%.1f"), "speed": ("rpm", RPM, "%.5f"), "displacement": ("cm^3/rev", CM3_PER_REV, "%.6g"),
     "hook_load": ("t", 1e3, "%.6g"), "oil": ("degF", 1.0, "%.2f")},
    {"pressure": ("bar", BAR, "%.5g"), "speed": ("rad/s", 1.0, "%.5f"),
     "displacement": ("l/rev", CM3_PER_REV * 1e3, "%.6g"), "hook_load": ("kg", 1.0, "%.6g"),
     "oil": ("degC", 1.0, "%.2f")},
)  # fmt: skip
OTHERS = {
    "time": ("s", 1.0, "%.4f"), "wire_layer": ("", 1.0, "%d"), "wire_out": ("m", 1.0, "%.2f"),
    "shaft_angle": ("rad", 1.0, "%.5f"), "heave_velocity": ("m/s", 1.0, "%.4f"),
}  # fmt: skip
QUANTITY = {"motor_speed": "speed", "speed_reference": "speed", "oil_temperature": "oil", "hook_load": "hook_load"}


def write_set(folder: Path, chosen: Set, seed: int, kept: Callable[[State, Columns], None] | None = None) -> Path:
    """Draw the crane, sail the runs and write `crane.yaml`, `model.yaml` and `runs/*.csv`; returns the folder.

    `kept` is shown every run as the plant had it, beside the columns that were logged.
    """
    rng = np.random.default_rng(seed)
    crane = draw_crane(rng, chosen.options.grouping)
    supplier = draw_supplier(rng, crane)
    truth = draw_truth(rng, supplier)
    (folder / "runs").mkdir(parents=True, exist_ok=True)
    (folder / "crane.yaml").write_text(crane_text(crane))
    (folder / "model.yaml").write_text(model_text(crane, supplier))
    voyages = draw_voyages(rng, crane, chosen.options)
    hidden = chosen.law(crane, truth, voyages)
    for voyage in voyages:
        run = sail(rng, crane, truth, voyage, hidden)
        columns = logged(rng, run, hidden)
        _write(folder / "runs" / _name(voyage), columns, voyage.logging, rng)
        if kept:
            kept(run, columns)
    return folder


def _name(voyage: Voyage) -> str:
    return f"{voyage.number:02d}_{voyage.kind}_{voyage.mass / 1000:.0f}t.csv"


def _written_as(channel: str, style: Logging) -> tuple[str, float, str]:
    if channel in OTHERS:
        return OTHERS[channel]
    quantity = QUANTITY.get(channel, channel.rpartition(".")[2].split("_")[0])
    return UNITS[style.units][quantity]


def _write(path: Path, columns: Columns, style: Logging, rng: np.random.Generator) -> None:
    header, cells = [], []
    for channel, values in columns.items():
        unit, factor, form = _written_as(channel, style)
        shown = values * 1.8 + 32 if unit == "degF" else values / factor
        header.append(f"{channel} [{unit}]" if unit else channel)
        cells.append(np.char.mod(form, shown).astype(object))
    count = len(columns["time"])
    kept = np.ones(count, bool)
    for _ in range(style.gaps):
        start = rng.integers(count // 10, count - count // 10)
        kept[start : start + int(rng.uniform(0.3, 2) * style.rate)] = False
    for _ in range(style.blanks):
        column = rng.integers(1, len(cells))
        start = rng.integers(0, count - 10)
        cells[column][start : start + int(rng.integers(1, 8))] = ""
    rows = [style.separator.join(row) for row in zip(*(each[kept] for each in cells), strict=True)]
    path.write_text("\n".join([style.separator.join(header), *rows]) + "\n")
