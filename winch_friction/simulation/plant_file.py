"""Plant files: what a simulation needs beyond the crane file (hydraulics, accumulator, pump), checked by pydantic."""

from pathlib import Path
from typing import Any, Literal

from winch_friction.physics.errors import InputError
from winch_friction.physics.winch.crane import Crane
from winch_friction.records.strict_yaml import expect_kind, read_yaml, shipped
from winch_friction.simulation.pydantic_v1 import Field, StrictStr
from winch_friction.simulation.quantities import (
    CubicMetres,
    CubicMetresPerSecond,
    Number,
    Pascals,
    Radians,
    RadiansPerSecond,
    Seconds,
    Strict,
    limited,
    validated,
)


class Pump(Strict):
    """The active side's pump: first-order lag, or second order where `bandwidth` is given."""

    flow: CubicMetresPerSecond = limited(gt=0.0)
    lag: Seconds = limited(0.1, gt=0.0)
    bandwidth: RadiansPerSecond = limited(0.0, ge=0.0)
    damping: Number = limited(1.0, gt=0.0)


class ActiveLoop(Strict):
    """The closed loop: volume per side, bulk modulus, boost and relief."""

    volume: CubicMetres = limited(gt=0.0)
    bulk_modulus: Pascals = limited(gt=0.0)
    air: Number = limited(0.0, ge=0.0, le=0.2)
    boost_pressure: Pascals = limited(gt=0.0)
    relief_pressure: Pascals = limited(gt=0.0)
    valve_gain: Number = limited(gt=0.0)


class Accumulator(Strict):
    """The passive side's gas."""

    pressure: Pascals = limited(gt=0.0)
    low_pressure: Pascals = limited(gt=0.0)
    gas_volume: CubicMetres = limited(gt=0.0)
    exponent: Number = limited(1.2, gt=1.0, le=1.8)
    thermal_time: Seconds = limited(0.0, ge=0.0)


class PlantFile(Strict):
    """A plant around a crane."""

    schema_: Literal["winch_friction.plant/1"] = Field(alias="schema")
    name: StrictStr
    crane: StrictStr = ""
    description: StrictStr = ""
    pump: Pump
    active_loop: ActiveLoop
    accumulator: Accumulator
    leakage: Number = limited(ge=0.0)
    case_leakage: Number = limited(0.0, ge=0.0)
    torque_lag: Seconds = limited(0.05, gt=0.0)
    wire_damping: Number = limited(ge=0.0)
    presliding: Radians = limited(gt=0.0)


def load_plant(name: str | Path) -> PlantFile:
    """A plant by path or shipped name; raises `InputError` in one line."""
    path = shipped("plants", name)
    content = read_yaml(path)
    expect_kind(content, "plant", str(path))
    return validated(PlantFile, content, str(path))


def refuse_other_plant(scenario: Any, plant: PlantFile, crane: Crane) -> None:
    """Raise `InputError` where a scenario or a plant says that it is of another crane, or cannot hold its load."""
    refuse_others(crane, scenario=scenario, plant=plant)
    _refuse_load(scenario, plant, crane)


def refuse_others(crane: Crane, **named: Any) -> None:
    """Raise `InputError` where the crane is not hydraulic, or one of these (by kind) says that it is of another."""
    if not crane.drive.hydraulic:
        raise InputError(
            f"crane '{crane.name}' has a drive of kind '{crane.drive.kind}'; scenarios simulate hydraulic winches"
        )
    others = {kind: each for kind, each in named.items() if each.crane and each.crane != crane.name}
    if others:
        found = " and ".join(f"{kind} '{each.name}' is of crane '{each.crane}'" for kind, each in others.items())
        raise InputError(
            f"{found}, not of '{crane.name}': give that crane, or a plant of this one "
            "(winch-friction init plant --crane ...; simulate --plant)"
        )


def _refuse_load(scenario: Any, plant: PlantFile, crane: Crane) -> None:
    """Raise `InputError` where the drive cannot hold the load at its relief pressure."""
    gas, loop = plant.accumulator, plant.active_loop
    driven = crane.motor_count("active" if scenario.mode == "ahc" else "main") * scenario.displacement
    holds = driven * (loop.relief_pressure - loop.boost_pressure)
    if scenario.mode == "ahc":
        setting = scenario.passive_displacement or crane.max_displacement
        holds += crane.motor_count("passive") * setting * (gas.pressure - gas.low_pressure)
    needed = crane.drum_torque(scenario.load, scenario.wire_layer) / crane.gear_ratio
    if needed > holds:
        load = scenario.load / 1e3
        raise InputError(
            f"scenario '{scenario.name}': load {load:.4g} t is more than crane '{crane.name}' with plant "
            f"'{plant.name}' holds here, 0 ... {load * holds / needed:.4g} t"
        )
