"""Where each signal stands in the operating point, read from the one table that defines it."""

from winch_friction.physics.friction.symbols import GROUP_SIGNALS, WINCH_SIGNALS

GROUPS = 2  # the driven group and the passive one; a winch without a passive group has it with no motors

_WINCH = {signal.name: k for k, signal in enumerate(WINCH_SIGNALS)}
_GROUP = {signal.name: len(WINCH_SIGNALS) + k for k, signal in enumerate(GROUP_SIGNALS)}

POINT_LENGTH = len(WINCH_SIGNALS) + GROUPS * len(GROUP_SIGNALS)
STRIDE = len(GROUP_SIGNALS)

X_DIRECTION = _WINCH["direction"]
X_MAGNITUDE = _WINCH["speed_magnitude"]
X_SPEED = _WINCH["speed"]
X_DRUM = _WINCH["drum_torque"]
X_ACCELERATION = _WINCH["acceleration"]
X_OIL = _WINCH["oil_temperature"]
X_TIME = _WINCH["time"]
X_ANGLE = _WINCH["shaft_angle"]
X_LAYER = _WINCH["wire_layer"]
X_WIRE = _WINCH["wire_out"]
X_MOTORS = _WINCH["motor_total"]
# of the driven group; the passive one's stand STRIDE further
X_COUNT = _GROUP["count"]
X_PRESSURE = _GROUP["pressure"]
X_PRESSURE_SUM = _GROUP["pressure_sum"]
X_DISPLACEMENT = _GROUP["displacement"]
