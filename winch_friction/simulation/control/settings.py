"""Gains of the controller in one record; the same for every row of a comparison."""

import numpy as np

# name -> unit
CONTROL_FIELDS = {
    "mode": "0 open pump command, 1 pump-controlled heave compensation, 2 torque-commanded",
    "period": "s",
    "drive_displacement": "m^3/rad, all driven motors together",
    "passive_displacement": "m^3/rad, all passive motors together",
    "metres_per_radian": "m/rad, of the reported layer",
    "static_torque": "N m at the shaft, of the reported load",
    "inertia": "kg m^2 that the reference accelerates",
    "leakage": "m^3/s/Pa across the driven loop",
    "compressibility": "m^3/Pa of the loop per pressure difference",
    "pump_flow": "m^3/s, largest",
    "torque_limit": "N m",
    "drive_lag": "s, inverted",
    "position_gain": "1/s",
    "speed_gain": "N m s/rad, torque-commanded drive",
    "damping": "m^3/s/Pa against the pressure's deviation from the expected",
    "damping_time": "s, washout",
    "jerk_filter": "s",
    "lead": "s, reference ahead, beyond the period",
    "feedforward_ticks": "1, periods over which a new friction feedforward is spread",
}
CONTROL = np.dtype([(name, np.float64) for name in CONTROL_FIELDS])

CONTROL_STATES = 24  # six scalars below, then the last friction feedforwards
EXPECTED, DRIVE_MODEL, ACCELERATION, JERK, WASHOUT, TICKS, HISTORY = range(7)
HISTORY_LENGTH = CONTROL_STATES - HISTORY
