"""The measured channels: where each comes from in the plant's history and how its sensor changes it."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from winch_friction.physics.errors import InputError
from winch_friction.simulation.plant.state import COLUMNS
from winch_friction.simulation.scenario import Scenario, Sensors

# channel -> column of the plant's history
GROUP_SOURCES = {"pressure_a": "pressure_a", "pressure_b": "pressure_b", "displacement": "displacement"}
SPEED = "motor_speed"
OPTIONAL = ("wire_layer",)  # besides the plant's own columns

MOST_BENDS = 8  # of one sensor
CHANNEL = np.dtype(
    [("source", np.int64)]
    + [
        (name, np.float64)
        for name in ("delay", "noise", "relative_noise", "step", "scale", "curvature", "offset", "swing", "stroke")
    ]
    + [(name, np.float64, (MOST_BENDS,)) for name in ("bend", "beyond")]
)


@dataclass(frozen=True)
class Channels:
    """Names and settings of the measured channels; the first is the motor speed, taken from the encoder."""

    names: tuple[str, ...]
    settings: np.ndarray


def channels(scenario: Scenario) -> Channels:
    """The channels that a scenario's run has; raises `InputError` for a sensor setting of a channel that it lacks."""
    sources = _sources(scenario)
    settings = np.zeros(len(sources), CHANNEL)
    settings["scale"] = settings["stroke"] = 1.0
    for row, (name, column) in zip(settings, sources.items(), strict=True):
        row["source"] = COLUMNS.index(column)
        _set_sensor(row, name, scenario.sensors)
    _check(scenario, tuple(sources))
    return Channels(tuple(sources), settings)


def _sources(scenario: Scenario) -> dict[str, str]:
    driven = "active" if scenario.mode == "ahc" else "main"
    sources = {SPEED: "shaft_angle", "speed_reference": "speed_reference", "shaft_angle": "shaft_angle"}
    sources |= {f"{driven}.{channel}": column for channel, column in GROUP_SOURCES.items()}
    if scenario.mode == "ahc":
        sources |= {
            "passive.pressure_a": "passive_reported",
            "passive.pressure_b": "passive_pressure_b",
            "passive.displacement": "passive_displacement",
        }
        sources["heave_velocity"] = "heave_velocity"
    sources |= {"hook_load": "hook_load", "oil_temperature": "oil_temperature", "wire_out": "wire_out"}
    return {name: column for name, column in sources.items() if name not in _absent(scenario, tuple(sources))}


def _absent(scenario: Scenario, names: tuple[str, ...]) -> tuple[str, ...]:
    for name in scenario.sensors.absent:
        if name not in (*OPTIONAL, *names) or name == SPEED:
            raise InputError(
                f"scenario '{scenario.name}': sensors.absent names '{name}', which is not an optional channel; "
                f"these are {', '.join(sorted({*OPTIONAL, *names} - {SPEED}))}"
            )
    return scenario.sensors.absent


def _set_sensor(row: Any, name: str, sensors: Sensors) -> None:
    quantity = name.rpartition(".")[2]
    row["delay"] = sensors.skew.get(name, 0.0)
    if quantity in ("pressure_a", "pressure_b"):
        row["noise"], row["step"] = sensors.pressure_noise, sensors.pressure_step
        row["scale"] = sensors.pressure_scale.get(name, 1.0)
        row["offset"] = sensors.pressure_offset.get(name, 0.0)
    elif quantity == "displacement":
        row["relative_noise"] = sensors.displacement_noise
        row["scale"] = sensors.displacement_scale.get(name, 1.0)
        row["offset"] = sensors.displacement_offset.get(name, 0.0)
    elif quantity in ("motor_speed", "shaft_angle"):
        row["step"] = 2.0 * np.pi / sensors.encoder_counts if sensors.encoder_counts else 0.0
    else:
        plain = {
            "hook_load": (sensors.load_noise, 10.0),
            "heave_velocity": (sensors.heave_noise, 0.001),
            "oil_temperature": (sensors.temperature_noise, 0.1),
            "wire_out": (0.0, 0.01),
        }
        row["noise"], row["step"] = plain.get(name, (0.0, 0.0))
    if not sensors.noise:
        row["noise"] = row["relative_noise"] = 0.0
    if not sensors.quantisation:
        row["step"] = 0.0


def _check(scenario: Scenario, names: tuple[str, ...]) -> None:
    sensors = scenario.sensors
    for setting in ("skew", "pressure_offset", "pressure_scale", "displacement_scale", "displacement_offset"):
        for name in getattr(sensors, setting):
            if name not in names:
                raise InputError(
                    f"scenario '{scenario.name}': sensors.{setting} names '{name}', the run has {', '.join(names)}"
                )
