"""Numbers of the plant in one record that the compiled equations read by name."""

import numpy as np

# name -> unit; the record's fields, all float64
PLANT_FIELDS = {
    "secondary": "1, the drive is commanded in torque",
    "count": "1, motors of the driven group",
    "displacement": "m^3/rad, true, per motor of the driven group",
    "passive_count": "1",
    "passive_displacement": "m^3/rad, true, per passive motor",
    "max_displacement": "m^3/rad",
    "inertia": "kg m^2 at the motor shaft, without the load",
    "metres_per_radian": "m of wire per rad of the motor shaft, true layer",
    "radius": "m, true rope radius",
    "mass": "kg, hanging",
    "reported_mass": "kg, what the load cell knows",
    "reported_radius": "m, of the layer that the log names",
    "wire_stiffness": "N/m",
    "wire_damping": "N s/m",
    "wire_out": "m at the start",
    "wire_mass": "kg/m that hangs with the load",
    "layer": "1",
    "line_volume": "m^3 per side",
    "bulk_modulus": "Pa",
    "air": "1, volume fraction at atmospheric pressure",
    "boost_pressure": "Pa",
    "relief_pressure": "Pa",
    "valve_gain": "m^3/s/Pa",
    "leakage": "m^3/s/Pa per motor, across",
    "case_leakage": "m^3/s/Pa per motor and side, to the case",
    "line_resistance": "Pa/(m^3/s)^2 between transducers and motors",
    "pump_flow": "m^3/s, largest",
    "pump_lag": "s",
    "pump_bandwidth": "rad/s, of a second-order pump; 0: first order",
    "pump_damping": "1",
    "torque_lag": "s, of the torque-commanded drive",
    "torque_limit": "N m, of the driven group",
    "gas_pressure": "Pa, at gas_volume and wall temperature",
    "gas_volume": "m^3",
    "gas_exponent": "1",
    "gas_time": "s, thermal time constant to the wall; 0: none",
    "gas_start": "1, gas temperature at the start relative to the wall",
    "passive_low": "Pa",
    "make_up": "m^3/s",
    "presliding": "rad, e-fold of the bristle",
    "direction_width": "rad/s, smooth sign instead of the bristle; 0: bristle",
    "buoyancy": "N, of the whole body",
    "body_height": "m",
    "surface": "m, still water above the load's start",
    "water_drag": "N s^2/m^2",
    "start_time": "s, Unix",
    "viscous_reference": "degC at which the model's viscous terms hold",
    "calculated_exponent": "1, the PLC calculates the passive pressure with this exponent; 0: measures it",
    "viscosity_share": "1, how much of Walther's change the viscous terms follow",
}

PLANT = np.dtype([(name, np.float64) for name in PLANT_FIELDS])


def record(dtype: np.dtype, **values: float) -> np.ndarray:
    """A record array of length one; every field not given is zero."""
    unknown = set(values) - set(dtype.names or ())
    if unknown:
        raise KeyError(f"no such field: {sorted(unknown)}")
    out = np.zeros(1, dtype)
    for name, value in values.items():
        out[name] = value
    return out
