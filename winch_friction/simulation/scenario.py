"""Scenarios: what happens to the simulated winch, from YAML, checked by pydantic."""

from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, model_validator

from winch_friction.physics.errors import InputError
from winch_friction.records.paths import shipped
from winch_friction.records.strict_yaml import as_quantity, read_yaml
from winch_friction.simulation.quantities import (
    CubicMetres,
    Displacement,
    Kilograms,
    Metres,
    MetresPerSecond,
    Pascals,
    Radians,
    RadiansPerSecond,
    Seconds,
    Strict,
    validated,
)

SCHEMA = "winch_friction.scenario/1"
Steps = tuple[tuple[float, float], ...]


def _steps(unit: str) -> Callable[[Any], Any]:
    """Reader of [[time, value], ...] with values in `unit`."""

    def read(content: Any) -> Any:
        pairs = isinstance(content, (list, tuple)) and all(
            isinstance(p, (list, tuple)) and len(p) == 2 for p in content
        )
        if not pairs:
            raise ValueError(f"must be a list of [time s, value in {unit}] pairs")
        return tuple((as_quantity(t, "s", "time"), as_quantity(v, unit, "value")) for t, v in content)

    return read


def _speeds(content: Any) -> Any:
    if not isinstance(content, (list, tuple)):
        raise ValueError("must be a list of speeds")
    return tuple(as_quantity(each, "rad/s", "speed") for each in content)


class Still(Strict):
    """The crane stands still."""

    kind: Literal["still"] = "still"


class Regular(Strict):
    """One harmonic of crane tip heave."""

    kind: Literal["regular"]
    amplitude: Metres = Field(gt=0.0, le=10.0)
    period: Seconds = Field(gt=2.0)


class Jonswap(Strict):
    """An irregular sea; the crane tip follows it by `response` (vessel and crane, [J])."""

    kind: Literal["jonswap"]
    significant_height: Metres = Field(gt=0.0, le=15.0)
    peak_period: Seconds = Field(default=9.0, gt=2.0)
    gamma: float = Field(default=3.3, ge=1.0, le=7.0)
    response: float = Field(default=0.6, gt=0.0, le=2.0)
    seed: int | None = None


class Profile(Strict):
    """Shaft speed over time: corner points, or plateaus each hoisted and lowered (paper 2 Fig 6), given
    as speeds or as shares of the pump's flow.
    """

    points: Annotated[Steps, BeforeValidator(_steps("rad/s"))] = ()
    plateaus: Annotated[tuple[float, ...], BeforeValidator(_speeds)] = ()
    pump_shares: tuple[Annotated[float, Field(gt=0.0, le=1.0)], ...] = ()
    hold: Seconds = Field(default=8.0, gt=0.0)
    ramp: Seconds = Field(default=2.0, gt=0.0)
    rest: Seconds = Field(default=2.0, ge=0.0)


class OilTemperature(Strict):
    """Oil temperature in degC: from start to end with a time constant."""

    start: float = Field(default=40.0, ge=-20.0, le=95.0)
    end: float | None = Field(default=None, ge=-20.0, le=95.0)
    time_constant: Seconds = Field(default=600.0, gt=0.0)


class Water(Strict):
    """A body that is lowered through the surface."""

    volume: CubicMetres = Field(gt=0.0)
    height: Metres = Field(gt=0.0)
    surface: Metres
    drag_area: float = Field(default=5.0, ge=0.0)
    wave_share: float = Field(default=0.3, ge=0.0, le=1.0)


class Sensors(Strict):
    """The PLC's view of the winch. Skew and offsets by channel, channels that are absent; standard deviations in SI."""

    absent: tuple[str, ...] = ()
    rate: float = Field(default=50.0, ge=5.0, le=500.0)
    jitter: Seconds = Field(default=0.001, ge=0.0)
    delay: Seconds = Field(default=0.0, ge=0.0, le=0.5)
    skew: dict[str, Seconds] = Field(default_factory=dict)
    noise: bool = True
    quantisation: bool = True
    pressure_noise: Pascals = Field(default=0.3e5, ge=0.0)
    pressure_step: Pascals = Field(default=600e5 / 4096, ge=0.0)
    pressure_offset: dict[str, Pascals] = Field(default_factory=dict)
    pressure_scale: dict[str, float] = Field(default_factory=dict)
    encoder_counts: float = Field(default=1024.0, ge=0.0)
    displacement_noise: float = Field(default=0.0003, ge=0.0)
    displacement_scale: dict[str, float] = Field(default_factory=dict)
    displacement_offset: dict[str, Displacement] = Field(default_factory=dict)
    load_noise: Kilograms = Field(default=10.0, ge=0.0)
    heave_noise: MetresPerSecond = Field(default=0.003, ge=0.0)
    temperature_noise: float = Field(default=0.05, ge=0.0)
    dropout_rate: float = Field(default=0.0, ge=0.0, le=1.0)
    dropout_length: Seconds = Field(default=0.1, gt=0.0)
    dropout: Literal["nan", "missing"] = "nan"


class Control(Strict):
    """Gains of the controller; defaults are those of every published comparison."""

    position_gain: float | None = Field(default=None, ge=0.0)
    speed_gain: float | None = Field(default=None, ge=0.0)
    damping: float | None = Field(default=None, ge=0.0)
    damping_time: float | None = Field(default=None, gt=0.0)
    lead: float = Field(default=0.0, ge=-0.1, le=0.5)
    drive_lag: float | None = Field(default=None, gt=0.0)


class Scenario(Strict):
    """One run of the simulated winch; SI."""

    schema_: str = Field(default=SCHEMA, alias="schema", pattern=r"^winch_friction\.scenario/1$")
    name: str
    description: str = ""
    duration: Seconds = Field(gt=0.0, le=14400.0)
    mode: Literal["normal", "ahc"]
    drive: Literal["primary", "secondary"] = "primary"
    load: Kilograms = Field(gt=0.0, le=400000.0)
    displacement: Displacement = Field(gt=0.0)
    displacement_schedule: Annotated[Steps, BeforeValidator(_steps("m^3/rad"))] = ()
    boost_schedule: Annotated[Steps, BeforeValidator(_steps("Pa"))] = ()
    passive_displacement: Displacement | None = None
    wire_layer: int = Field(default=6, ge=1)
    wire_out: Metres = Field(default=50.0, gt=1.0)
    sea: Still | Regular | Jonswap = Field(default=Still(), discriminator="kind")
    sea_ramp: Seconds = Field(default=10.0, gt=0.0)
    calm_at: Seconds | None = None
    calm_time: Seconds = Field(default=30.0, gt=0.0)
    profile: Profile = Profile()
    oil_temperature: OilTemperature = OilTemperature()
    viscosity_truth: bool = False
    water: Water | None = None
    sensors: Sensors = Sensors()
    control: Control = Control()
    plant: str = "winch_150t"
    mismatch: dict[str, float] = Field(default_factory=dict)
    presliding: Radians | None = Field(default=None, gt=0.0)
    smooth_sign: RadiansPerSecond = Field(default=0.0, ge=0.0)
    control_period: Seconds = Field(default=0.01, ge=0.001, le=0.1)
    step: Seconds = Field(default=0.001, gt=0.0, le=0.005)
    start_time: float = 0.0
    hidden: dict[str, float] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _consistent(self) -> "Scenario":
        if self.sensors.rate * self.control_period > 1.0 + 1e-9:
            raise ValueError(f"sensors.rate {self.sensors.rate:g} Hz is above the control rate; lower control_period")
        ratio = 1.0 / (self.sensors.rate * self.control_period)
        if abs(ratio - round(ratio)) > 1e-6:
            raise ValueError("the sensors' period must be a whole number of control periods")
        return self

    def override(self, changes: dict[str, Any]) -> "Scenario":
        """The scenario with other values by dotted key, {'load': 15e3, 'sea.period': 8.0}, checked again."""
        content = self.model_dump(by_alias=True, exclude_unset=False)
        for key, value in changes.items():
            _set(content, key.split("."), value)
        return validated(Scenario, content, f"scenario '{self.name}'")


def _set(content: dict[str, Any], path: list[str], value: Any) -> None:
    for part in path[:-1]:
        content[part] = dict(content.get(part) or {})
        content = content[part]
    content[path[-1]] = value


def load_scenario(name: str | Path) -> Scenario:
    """A scenario by path or shipped name; raises `InputError` in one line for anything wrong."""
    path = shipped("scenarios", name)
    return scenario_from_content(read_yaml(path), str(path))


def scenario_from_content(content: Any, where: str = "scenario") -> Scenario:
    """A scenario from parsed YAML."""
    if not isinstance(content, dict):
        raise InputError(f"{where}: expected a mapping of keys")
    return validated(Scenario, content, where)
