"""Scenarios: what happens to the simulated winch, from YAML, checked by pydantic."""

from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, Literal

from winch_friction.physics.errors import InputError
from winch_friction.records.strict_yaml import as_quantity, expect_kind, read_yaml, shipped
from winch_friction.simulation.pydantic_v1 import Field, StrictStr, root_validator, validator
from winch_friction.simulation.quantities import (
    CubicMetres,
    Displacement,
    Kilograms,
    Metres,
    MetresPerSecond,
    Number,
    Pascals,
    Radians,
    RadiansPerSecond,
    Seconds,
    Strict,
    Whole,
    limited,
    validated,
)

Steps = tuple[tuple[float, float], ...]


def _steps(unit: str) -> Callable[[Any], Any]:
    """Reader of [[time, value], ...] with values in `unit`."""

    def read(content: Any) -> Any:
        pairs = isinstance(content, (list, tuple)) and all(
            isinstance(p, (list, tuple)) and len(p) == 2 for p in content
        )
        if not pairs:
            raise ValueError(f"must be a list of [time s, value in {unit}] pairs")
        points = tuple((as_quantity(t, "s", "time"), as_quantity(v, unit, "value")) for t, v in content)
        back = next(((a[0], b[0]) for a, b in pairwise(points) if b[0] < a[0]), None)
        if back:  # between them nobody could say what holds
            raise ValueError(f"times must not go back: {back[1]:g} s stands behind {back[0]:g} s")
        return points

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
    amplitude: Metres = limited(gt=0.0, le=10.0)
    period: Seconds = limited(gt=2.0)


class Jonswap(Strict):
    """An irregular sea; the crane tip follows it by `response` (vessel and crane, [J])."""

    kind: Literal["jonswap"]
    significant_height: Metres = limited(gt=0.0, le=15.0)
    peak_period: Seconds = limited(9.0, gt=2.0)
    gamma: Number = limited(3.3, ge=1.0, le=7.0)
    response: Number = limited(0.6, gt=0.0, le=2.0)
    seed: Whole | None = None


class Measured(Strict):
    """The heave that was measured on a ship, from a file with the columns time [s] and heave [m], from `start` s of it
    on; the crane tip follows it by `response`."""

    kind: Literal["measured"]
    file: StrictStr
    start: Seconds = limited(0.0, ge=0.0)
    response: Number = limited(1.0, gt=0.0, le=2.0)


class Profile(Strict):
    """Shaft speed over time: corner points, or plateaus each hoisted and lowered (paper 2 Fig 6), given
    as speeds or as shares of the pump's flow.
    """

    points: Steps = ()
    plateaus: tuple[float, ...] = ()
    pump_shares: tuple[Annotated[Number, limited(gt=0.0, le=1.0)], ...] = ()
    hold: Seconds = limited(8.0, gt=0.0)
    ramp: Seconds = limited(2.0, gt=0.0)
    rest: Seconds = limited(2.0, ge=0.0)
    _points = validator("points", pre=True, allow_reuse=True)(_steps("rad/s"))
    _plateaus = validator("plateaus", pre=True, allow_reuse=True)(_speeds)


class OilTemperature(Strict):
    """Oil temperature in degC: from start to end with a time constant."""

    start: Number = limited(40.0, ge=-20.0, le=95.0)
    end: Number | None = limited(None, ge=-20.0, le=95.0)
    time_constant: Seconds = limited(600.0, gt=0.0)


class Water(Strict):
    """A body that is lowered through the surface."""

    volume: CubicMetres = limited(gt=0.0)
    height: Metres = limited(gt=0.0)
    surface: Metres
    drag_area: Number = limited(5.0, ge=0.0)
    wave_share: Number = limited(0.3, ge=0.0, le=1.0)


class Sensors(Strict):
    """The PLC's view of the winch. Skew and offsets by channel, channels that are absent; standard deviations in SI."""

    absent: tuple[StrictStr, ...] = ()
    rate: Number = limited(50.0, ge=5.0, le=500.0)
    jitter: Seconds = limited(0.001, ge=0.0)
    delay: Seconds = limited(0.0, ge=0.0, le=0.5)
    skew: dict[str, Seconds] = Field(default_factory=dict)
    noise: bool = True
    quantisation: bool = True
    pressure_noise: Pascals = limited(0.3e5, ge=0.0)
    pressure_step: Pascals = limited(600e5 / 4096, ge=0.0)
    pressure_offset: dict[str, Pascals] = Field(default_factory=dict)
    pressure_scale: dict[str, Number] = Field(default_factory=dict)
    encoder_counts: Number = limited(1024.0, ge=0.0)
    displacement_noise: Number = limited(0.0003, ge=0.0)
    displacement_scale: dict[str, Number] = Field(default_factory=dict)
    displacement_offset: dict[str, Displacement] = Field(default_factory=dict)
    load_noise: Kilograms = limited(10.0, ge=0.0)
    heave_noise: MetresPerSecond = limited(0.003, ge=0.0)
    temperature_noise: Number = limited(0.05, ge=0.0)
    dropout_rate: Number = limited(0.0, ge=0.0, le=1.0)
    dropout_length: Seconds = limited(0.1, gt=0.0)
    dropout: Literal["nan", "missing"] = "nan"


class Control(Strict):
    """Gains of the controller; defaults are those of every published comparison."""

    position_gain: Number | None = limited(None, ge=0.0)
    speed_gain: Number | None = limited(None, ge=0.0)
    damping: Number | None = limited(None, ge=0.0)
    damping_time: Number | None = limited(None, gt=0.0)
    lead: Number = limited(0.0, ge=-0.1, le=0.5)
    drive_lag: Number | None = limited(None, gt=0.0)


class Scenario(Strict):
    """One run of the simulated winch; SI."""

    schema_: Literal["winch_friction.scenario/1"] = Field("winch_friction.scenario/1", alias="schema")
    name: StrictStr
    crane: StrictStr = ""
    description: StrictStr = ""
    duration: Seconds = limited(gt=0.0, le=14400.0)
    mode: Literal["normal", "ahc"]
    drive: Literal["primary", "secondary"] = "primary"
    load: Kilograms = limited(gt=0.0, le=400000.0)
    displacement: Displacement = limited(gt=0.0)
    displacement_schedule: Steps = ()
    boost_schedule: Steps = ()
    passive_displacement: Displacement | None = None
    wire_layer: Whole = limited(6, ge=1)
    wire_out: Metres = limited(50.0, gt=1.0)
    sea: Still | Regular | Jonswap | Measured = Field(default=Still(), discriminator="kind")
    sea_ramp: Seconds = limited(10.0, gt=0.0)
    calm_at: Seconds | None = None
    calm_time: Seconds = limited(30.0, gt=0.0)
    profile: Profile = Profile()
    oil_temperature: OilTemperature = OilTemperature()
    viscosity_truth: bool = False
    water: Water | None = None
    sensors: Sensors = Sensors()
    control: Control = Control()
    plant: StrictStr = "winch_150t"
    mismatch: dict[str, Number] = Field(default_factory=dict)
    presliding: Radians | None = limited(None, gt=0.0)
    smooth_sign: RadiansPerSecond = limited(0.0, ge=0.0)
    control_period: Seconds = limited(0.01, ge=0.001, le=0.1)
    step: Seconds = limited(0.001, gt=0.0, le=0.005)
    start_time: Number = limited(0.0)
    hidden: dict[str, Number] = Field(default_factory=dict)

    _displacements = validator("displacement_schedule", pre=True, allow_reuse=True)(_steps("m^3/rad"))
    _boosts = validator("boost_schedule", pre=True, allow_reuse=True)(_steps("Pa"))

    @root_validator(skip_on_failure=True)
    def _consistent(cls, values: dict[str, Any]) -> dict[str, Any]:
        rate, period = values["sensors"].rate, values["control_period"]
        if rate * period > 1.0 + 1e-9:
            raise ValueError(f"sensors.rate {rate:g} Hz is above the control rate; lower control_period")
        ratio = 1.0 / (rate * period)
        if abs(ratio - round(ratio)) > 1e-6:
            raise ValueError("the sensors' period must be a whole number of control periods")
        if values["duration"] * rate < 2.0:
            raise ValueError(f"duration {values['duration']:g} s holds no two samples at {rate:g} Hz: no run")
        return values

    def override(self, changes: dict[str, Any]) -> "Scenario":
        """The scenario with other values by dotted key, {'load': 15e3, 'sea.period': 8.0}, checked again."""
        content = self.dict(by_alias=True)
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
    scenario = scenario_from_content(read_yaml(path), str(path))
    # a scenario travels with its plant and its motion
    named = {"plant": scenario.plant}
    if isinstance(scenario.sea, Measured):
        named["sea.file"] = scenario.sea.file
    beside = {key: path.parent / name for key, name in named.items()}
    found = {key: str(own.resolve()) for key, own in beside.items() if own.is_file()}
    return scenario.override(found) if found else scenario


def scenario_from_content(content: Any, where: str = "scenario") -> Scenario:
    """A scenario from parsed YAML."""
    if not isinstance(content, dict):
        raise InputError(f"{where}: expected a mapping of keys (YAML): is this a scenario file?")
    expect_kind(content, "scenario", where)
    return validated(Scenario, content, where)
