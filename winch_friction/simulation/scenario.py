"""Scenarios: what happens to the simulated winch, from YAML, checked by pydantic."""

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, model_validator

from winch_friction.physics.errors import InputError
from winch_friction.records.paths import shipped
from winch_friction.records.strict_yaml import as_quantity, read_yaml
from winch_friction.simulation.plant_file import Strict, quantity, validated

SCHEMA = "winch_friction.scenario/1"


def _corners(content: Any) -> Any:
    """Corner points [[time, speed], ...]; the speed may carry a unit."""
    if not isinstance(content, (list, tuple)) or any(not isinstance(p, (list, tuple)) or len(p) != 2 for p in content):
        raise ValueError("must be a list of [time s, speed] pairs")
    return tuple((as_quantity(t, "s", "time"), as_quantity(v, "rad/s", "speed")) for t, v in content)


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
    amplitude: quantity("m") = Field(gt=0.0, le=10.0)
    period: quantity("s") = Field(gt=2.0)


class Jonswap(Strict):
    """An irregular sea; the crane tip follows it by `response` (vessel and crane, [J])."""

    kind: Literal["jonswap"]
    significant_height: quantity("m") = Field(gt=0.0, le=15.0)
    peak_period: quantity("s") = Field(9.0, gt=2.0)
    gamma: float = Field(3.3, ge=1.0, le=7.0)
    response: float = Field(0.6, gt=0.0, le=2.0)
    seed: int | None = None


class Profile(Strict):
    """Shaft speed over time: corner points, or plateaus each hoisted and lowered (paper 2 Fig 6)."""

    points: Annotated[tuple[tuple[float, float], ...], BeforeValidator(_corners)] = ()
    plateaus: Annotated[tuple[float, ...], BeforeValidator(_speeds)] = ()
    hold: quantity("s") = Field(8.0, gt=0.0)
    ramp: quantity("s") = Field(2.0, gt=0.0)
    rest: quantity("s") = Field(2.0, ge=0.0)


class OilTemperature(Strict):
    """Oil temperature in degC: from start to end with a time constant."""

    start: float = Field(40.0, ge=-20.0, le=95.0)
    end: float | None = Field(None, ge=-20.0, le=95.0)
    time_constant: quantity("s") = Field(600.0, gt=0.0)


class Water(Strict):
    """A body that is lowered through the surface."""

    volume: quantity("m^3") = Field(gt=0.0)
    height: quantity("m") = Field(gt=0.0)
    surface: quantity("m")
    drag_area: float = Field(5.0, ge=0.0)
    wave_share: float = Field(0.3, ge=0.0, le=1.0)


class Sensors(Strict):
    """The PLC's view of the winch. Skew and offsets by channel; standard deviations in SI."""

    rate: float = Field(50.0, ge=5.0, le=500.0)
    jitter: quantity("s") = Field(0.001, ge=0.0)
    delay: quantity("s") = Field(0.0, ge=0.0, le=0.5)
    skew: dict[str, quantity("s")] = Field(default_factory=dict)
    noise: bool = True
    quantisation: bool = True
    pressure_noise: quantity("Pa") = Field(0.3e5, ge=0.0)
    pressure_step: quantity("Pa") = Field(600e5 / 4096, ge=0.0)
    pressure_offset: dict[str, quantity("Pa")] = Field(default_factory=dict)
    pressure_scale: dict[str, float] = Field(default_factory=dict)
    encoder_counts: float = Field(1024.0, ge=0.0)
    displacement_noise: float = Field(0.0003, ge=0.0)
    displacement_scale: dict[str, float] = Field(default_factory=dict)
    displacement_offset: dict[str, quantity("m^3/rad")] = Field(default_factory=dict)
    load_noise: quantity("kg") = Field(10.0, ge=0.0)
    heave_noise: quantity("m/s") = Field(0.003, ge=0.0)
    temperature_noise: float = Field(0.05, ge=0.0)
    dropout_rate: float = Field(0.0, ge=0.0, le=1.0)
    dropout_length: quantity("s") = Field(0.1, gt=0.0)
    dropout: Literal["nan", "missing"] = "nan"


class Control(Strict):
    """Gains of the controller; defaults are those of every published comparison."""

    position_gain: float | None = Field(None, ge=0.0)
    speed_gain: float | None = Field(None, ge=0.0)
    damping: float | None = Field(None, ge=0.0)
    damping_time: float | None = Field(None, gt=0.0)
    lead: float = Field(0.0, ge=-0.1, le=0.5)
    drive_lag: float | None = Field(None, gt=0.0)


class Scenario(Strict):
    """One run of the simulated winch; SI."""

    schema_: str = Field(SCHEMA, alias="schema", pattern=r"^winch_friction\.scenario/1$")
    name: str
    description: str = ""
    duration: quantity("s") = Field(gt=0.0, le=36000.0)
    mode: Literal["normal", "ahc"]
    drive: Literal["primary", "secondary"] = "primary"
    load: quantity("kg") = Field(gt=0.0, le=400000.0)
    displacement: quantity("m^3/rad") = Field(gt=0.0)
    passive_displacement: quantity("m^3/rad") | None = None
    wire_layer: int = Field(6, ge=1)
    wire_out: quantity("m") = Field(50.0, gt=1.0)
    sea: Still | Regular | Jonswap = Field(Still(), discriminator="kind")
    sea_ramp: quantity("s") = Field(10.0, gt=0.0)
    calm_at: quantity("s") | None = None
    calm_time: quantity("s") = Field(30.0, gt=0.0)
    profile: Profile = Profile()
    oil_temperature: OilTemperature = OilTemperature()
    viscosity_truth: bool = False
    water: Water | None = None
    sensors: Sensors = Sensors()
    control: Control = Control()
    plant: str = "winch_150t"
    mismatch: dict[str, float] = Field(default_factory=dict)
    smooth_sign: quantity("rad/s") = Field(0.0, ge=0.0)
    control_period: quantity("s") = Field(0.01, ge=0.001, le=0.1)
    step: quantity("s") = Field(0.001, gt=0.0, le=0.005)
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
        """The scenario with other values, by dotted key: {'load': 15e3, 'sea.significant_height': 2.0}; checked again."""
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
