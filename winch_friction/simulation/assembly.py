"""From scenario, crane and plant file to the records that the compiled loop reads."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from winch_friction.physics.channels import GRAVITY
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction.model import FrictionModel
from winch_friction.physics.signals import FloatArray
from winch_friction.physics.winch.crane import Crane
from winch_friction.simulation.control.settings import CONTROL
from winch_friction.simulation.motion.measured import MeasuredHeave, load_heave
from winch_friction.simulation.motion.profile import plateau_points, profile_reference
from winch_friction.simulation.motion.sea import Waves, fade, jonswap_sea, regular_wave
from winch_friction.simulation.plant.parameters import PLANT, PLANT_FIELDS, record
from winch_friction.simulation.plant_file import PlantFile, refuse_others
from winch_friction.simulation.scenario import Jonswap, Measured, Regular, Scenario

WATER_DENSITY = 1025.0  # kg/m^3
# gains of every published comparison: position loop 1/s, speed loop N m s/rad, pressure damping m^3/s/Pa, washout s
PRIMARY_GAINS = {"position_gain": 2.0, "speed_gain": 0.0, "damping": 1.0e-10, "damping_time": 0.5}
SECONDARY_GAINS = {"position_gain": 2.5, "speed_gain": 20.0, "damping": 0.0, "damping_time": 1.0}


@dataclass(frozen=True)
class Motion:
    """Prescribed motion at the control ticks: `tip` (n, 4) height, speed, acceleration, water surface; `reference`
    (n, 4) shaft angle, speed, acceleration and load target; `oil` (n,) degC."""

    tip: FloatArray
    reference: FloatArray
    oil: FloatArray


def driven_group(scenario: Scenario) -> str:
    """The group that the drive feeds."""
    return "active" if scenario.mode == "ahc" else "main"


def passive_displacement(scenario: Scenario, crane: Crane, plant: PlantFile) -> float:
    """Displacement per passive motor that balances the load at the accumulator's pressure, m^3/rad."""
    if scenario.mode != "ahc":
        return crane.max_displacement
    if scenario.passive_displacement is not None:
        return scenario.passive_displacement
    net = plant.accumulator.pressure - plant.accumulator.low_pressure
    torque = crane.drum_torque(scenario.load, scenario.wire_layer) / crane.gear_ratio
    return min(torque / (crane.motor_count("passive") * net), crane.max_displacement)


def plant_record(scenario: Scenario, crane: Crane, plant: PlantFile) -> np.ndarray:
    """The plant as the scenario finds it, without hidden effects but with its mismatch."""
    _check(scenario, crane)
    loop, gas, ahc = plant.active_loop, plant.accumulator, scenario.mode == "ahc"
    radius = crane.drum.radius(scenario.wire_layer)
    passive = float(crane.motor_count("passive")) if ahc else 0.0
    water = scenario.water
    values = {
        "secondary": float(scenario.drive == "secondary"),
        "count": float(crane.motor_count(driven_group(scenario))),
        "displacement": scenario.displacement,
        "passive_count": passive,
        "passive_displacement": passive_displacement(scenario, crane, plant),
        "max_displacement": crane.max_displacement,
        "inertia": crane.inertia,
        "metres_per_radian": radius / crane.gear_ratio,
        "radius": radius,
        "mass": scenario.load,
        "reported_mass": scenario.load,
        "reported_radius": radius,
        "wire_stiffness": crane.wire_stiffness / scenario.wire_out,
        "wire_damping": plant.wire_damping,
        "wire_out": scenario.wire_out,
        "layer": float(scenario.wire_layer),
        "line_volume": loop.volume,
        "bulk_modulus": loop.bulk_modulus,
        "air": loop.air,
        "boost_pressure": loop.boost_pressure,
        "relief_pressure": loop.relief_pressure,
        "valve_gain": loop.valve_gain,
        "leakage": plant.leakage,
        "case_leakage": plant.case_leakage,
        "pump_flow": plant.pump.flow,
        "pump_lag": plant.pump.lag,
        "pump_bandwidth": plant.pump.bandwidth,
        "pump_damping": plant.pump.damping,
        "torque_lag": plant.torque_lag,
        "torque_limit": 400.0e5 * scenario.displacement * crane.motor_count(driven_group(scenario)),
        "gas_pressure": gas.pressure,
        "gas_volume": gas.gas_volume,
        "gas_exponent": gas.exponent,
        "gas_time": gas.thermal_time,
        "gas_start": 1.0,
        "passive_low": gas.low_pressure,
        "make_up": passive * plant.leakage * (gas.pressure - gas.low_pressure),
        "presliding": scenario.presliding or plant.presliding,
        "direction_width": scenario.smooth_sign,
        "buoyancy": water.volume * WATER_DENSITY * GRAVITY if water else 0.0,
        "body_height": water.height if water else 1.0,
        "surface": water.surface if water else 0.0,
        "water_drag": 0.5 * WATER_DENSITY * water.drag_area if water else 0.0,
        "start_time": scenario.start_time,
        "calculated_exponent": 0.0,
        "viscous_reference": 40.0,
        "viscosity_share": float(scenario.viscosity_truth),
    }
    out = record(PLANT, **values)
    _apply_mismatch(out, scenario)
    return out


def _check(scenario: Scenario, crane: Crane) -> None:
    refuse_others(crane)
    for value in (scenario.displacement, *(each for _, each in scenario.displacement_schedule)):
        if not 0.02 * crane.max_displacement <= value <= 1.001 * crane.max_displacement:
            raise InputError(
                f"scenario '{scenario.name}': displacement {value:g} m^3/rad is outside the motors' "
                f"{0.02 * crane.max_displacement:g} ... {crane.max_displacement:g}"
            )


def _apply_mismatch(out: np.ndarray, scenario: Scenario) -> None:
    for name, factor in scenario.mismatch.items():
        if name not in PLANT_FIELDS:
            raise InputError(
                f"scenario '{scenario.name}': mismatch.{name} is not a plant parameter; "
                "try leakage, bulk_modulus, line_volume, inertia, pump_lag, torque_lag or wire_stiffness"
            )
        out[name] *= factor


def control_record(scenario: Scenario, crane: Crane, plant: PlantFile, nominal: np.ndarray) -> np.ndarray:
    """The controller, which knows the nominal plant."""
    p = nominal[0]
    ahc = scenario.mode == "ahc"
    secondary = scenario.drive == "secondary"
    gains = dict(SECONDARY_GAINS if secondary else PRIMARY_GAINS)
    asked = scenario.control.dict()
    gains.update({name: asked[name] for name in gains if asked[name] is not None})
    mode = 2.0 if secondary else (1.0 if ahc else 0.0)
    return record(
        CONTROL,
        mode=mode,
        period=scenario.control_period,
        drive_displacement=p["count"] * p["displacement"],
        passive_displacement=p["passive_count"] * p["passive_displacement"],
        metres_per_radian=p["metres_per_radian"],
        static_torque=crane.drum_torque(scenario.load, scenario.wire_layer) / crane.gear_ratio,
        inertia=crane.inertia + (0.0 if ahc else crane.load_inertia(scenario.load, scenario.wire_layer)),
        leakage=p["count"] * (p["leakage"] + 0.5 * p["case_leakage"]),
        compressibility=0.5 * p["line_volume"] / p["bulk_modulus"],
        pump_flow=p["pump_flow"],
        torque_limit=p["torque_limit"],
        drive_lag=scenario.control.drive_lag or (plant.torque_lag if secondary else _pump_lag(plant)),
        jerk_filter=0.05,
        lead=scenario.control.lead,
        feedforward_ticks=round(1.0 / (scenario.sensors.rate * scenario.control_period)),
        **gains,
    )


def _pump_lag(plant: PlantFile) -> float:
    """The first-order part of the pump's inverse, s."""
    pump = plant.pump
    return 2.0 * pump.damping / pump.bandwidth if pump.bandwidth > 0.0 else pump.lag


def prescribed_motion(scenario: Scenario, crane: Crane, time: FloatArray, seed: int, full_speed: float) -> Motion:
    """Sea, profile and oil temperature at the control ticks; `full_speed` rad/s is what the pump's whole flow gives."""
    metres_per_radian = crane.drum.radius(scenario.wire_layer) / crane.gear_ratio
    tip, surface = _tip_motion(scenario, time, seed)
    winch = profile_reference(_profile_points(scenario, full_speed), time)
    compensation = -tip / metres_per_radian if scenario.mode == "ahc" else np.zeros_like(tip)
    reference = np.column_stack([winch + compensation, winch[:, 0] * metres_per_radian])
    return Motion(np.column_stack([tip, surface]), reference, _oil(scenario, time))


def schedule(scenario: Scenario, time: FloatArray, plant: np.ndarray, control: np.ndarray) -> FloatArray:
    """What is switched during the run, at the control ticks: true displacement per driven motor, the displacement that
    the controller counts with (all of them), boost pressure; linear between the scenario's points."""
    p, c = plant[0], control[0]
    asked = _along(scenario.displacement_schedule, scenario.displacement, time) / scenario.displacement
    boost = _along(scenario.boost_schedule, float(p["boost_pressure"]), time)
    return np.column_stack([p["displacement"] * asked, c["drive_displacement"] * asked, boost])


def _along(points: tuple[tuple[float, float], ...], constant: float, time: FloatArray) -> FloatArray:
    if not points:
        return np.full(len(time), constant)
    return np.interp(time, [point[0] for point in points], [point[1] for point in points])


def _profile_points(scenario: Scenario, full_speed: float) -> list[tuple[float, float]]:
    profile = scenario.profile
    if profile.points:
        return list(profile.points)
    speeds = profile.plateaus or tuple(share * full_speed for share in profile.pump_shares)
    return plateau_points(speeds, profile.hold, profile.ramp, profile.rest) if speeds else []


def _waves(scenario: Scenario, seed: int) -> tuple[Waves | MeasuredHeave | None, float]:
    sea = scenario.sea
    if isinstance(sea, Measured):
        return load_heave(Path(sea.file), sea.start), sea.response
    if isinstance(sea, Regular):
        return regular_wave(sea.amplitude, sea.period), 1.0
    if isinstance(sea, Jonswap):
        chosen = seed if sea.seed is None else sea.seed
        return jonswap_sea(sea.significant_height, sea.peak_period, sea.gamma, chosen), sea.response
    return None, 0.0


def _tip_motion(scenario: Scenario, time: FloatArray, seed: int) -> tuple[FloatArray, FloatArray]:
    waves, response = _waves(scenario, seed)
    if waves is None:
        return np.zeros((len(time), 3)), np.zeros(len(time))
    sea = fade(waves.motion(time), time, 0.0, scenario.sea_ramp)
    if scenario.calm_at is not None:
        sea = fade(sea, time, scenario.calm_at, scenario.calm_time, out=True)
    share = scenario.water.wave_share if scenario.water else 0.0
    return response * sea, share * sea[:, 0]


def _oil(scenario: Scenario, time: FloatArray) -> FloatArray:
    oil = scenario.oil_temperature
    end = oil.start if oil.end is None else oil.end
    return end + (oil.start - end) * np.exp(-time / oil.time_constant)


def viscous_parameters(model: FrictionModel) -> np.ndarray:
    """Which of the model's parameters are viscous coefficients: those that multiply a speed, N m s/rad."""
    return np.array([parameter.unit == "N*m*s/rad" for parameter in model.parameters])
