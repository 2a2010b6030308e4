"""The operating point as the plant fills it; its order is that of the one table of signals."""

from typing import NamedTuple

from winch_friction.physics.friction.symbols import GROUP_SIGNALS, WINCH_SIGNALS

GROUPS = 2  # the driven group and the passive one; a winch without a passive group has it with no motors


class Point(NamedTuple):
    """Winch signals, then those of the driven and of the passive motors; units as in the table."""

    direction: float
    speed_magnitude: float
    speed: float
    drum_torque: float
    acceleration: float
    oil_temperature: float
    time: float
    shaft_angle: float
    wire_layer: float
    wire_out: float
    motor_total: float
    count_driven: float
    pressure_driven: float
    pressure_sum_driven: float
    displacement_driven: float
    higher_port_driven: float
    role_driven: float
    count_passive: float
    pressure_passive: float
    pressure_sum_passive: float
    displacement_passive: float
    higher_port_passive: float
    role_passive: float


POINT_LENGTH = len(Point._fields)
X_ACCELERATION = Point._fields.index("acceleration")

_TABLE = (
    *(signal.name for signal in WINCH_SIGNALS),
    *(f"{signal.name}_{group}" for group in ("driven", "passive") for signal in GROUP_SIGNALS),
)
if Point._fields != _TABLE:
    raise TypeError(f"the plant's operating point is not in the order of physics.friction.symbols: {_TABLE}")
