"""The signals that a term's equation may read, as SymPy symbols, in one table.

A model is evaluated at an operating point: a flat tuple of the winch signals followed by the signals of each motor
group, in the order of this table. Everything that builds or reads such a tuple derives it from here.
"""

import math
from dataclasses import dataclass

import sympy as sp

ANY = (-math.inf, math.inf)


@dataclass(frozen=True)
class Signal:
    """One quantity that an equation may read."""

    name: str
    symbol: sp.Symbol
    unit: str
    doc: str
    default: float | None = None  # value where the channel is absent; None: it must be given
    limits: tuple[float, float] = ANY  # between what it lies, SI


def _signal(
    name: str, tex: str, unit: str, doc: str, default: float | None = None, limits: tuple[float, float] = ANY
) -> Signal:
    return Signal(name, sp.Symbol(tex, real=True), unit, doc, default, limits)


WINCH_SIGNALS = (
    _signal("direction", "s", "1", "sign of the shaft speed, smoothed where the caller asks for it"),
    _signal("speed_magnitude", "w", "rad/s", "absolute motor shaft speed"),
    _signal("speed", r"\omega", "rad/s", "motor shaft speed, positive when hoisting"),
    _signal("drum_torque", "T_d", "N*m", "total drum torque m g R"),
    _signal("acceleration", "a", "rad/s^2", "motor shaft acceleration", 0.0),
    _signal("oil_temperature", r"\vartheta", "degC", "oil temperature", 40.0),
    _signal("time", "t", "s", "time of the sample", 0.0),
    _signal("shaft_angle", r"\varphi", "rad", "motor shaft angle", 0.0),
    _signal("wire_layer", "l", "1", "wire layer in use, from 1", 1.0),
    _signal("wire_out", "L", "m", "wire paid out", 0.0),
    _signal("motor_total", "N", "1", "number of motors on the shaft"),
)
GROUP_SIGNALS = (
    _signal("count", "n", "1", "motors in the group"),
    _signal("pressure", "p", "Pa", "absolute pressure drop |p_A - p_B|"),
    _signal("pressure_sum", r"\Sigma p", "Pa", "p_A + p_B", 0.0),
    _signal("displacement", "D", "m^3/rad", "displacement per motor"),
    # a step at p_A = p_B: an equation must multiply it by the pressure, which is zero there; no table may be over it
    _signal("higher_port", "h", "1", "+1 where p_A is the higher pressure, -1 where p_B is", 1.0),
    # which of them it is, not what it does: no table may be over it
    _signal("role", r"\gamma", "1", "+1 of a group that drives beside a passive one, -1 of that, 0 of one alone", 0.0),
)
# what the model file carries as constants of the motor and the oil; a displacement of 0 is none; oils weigh 750 (light)
# to 1450 kg/m^3 (phosphate ester), and are as thin as hot water and as thick as gear oil in frost; twice as much each
# way is a slip of the unit
CONSTANTS = (
    _signal("max_displacement", "X", "m^3/rad", "largest displacement of one motor", 0.0, (0.0, 6e-2)),
    _signal("density", r"\rho", "kg/m^3", "oil density", 870.0, (400.0, 3000.0)),
    _signal("viscosity", r"\mu", "Pa*s", "dynamic viscosity at the reference temperature", 0.04, (1e-4, 100.0)),
    _signal("gear_ratio", "i", "1", "gear ratio motor to drum", 1.0, (1e-3, 1e5)),
)

_BY_NAME = {signal.name: signal.symbol for signal in (*WINCH_SIGNALS, *GROUP_SIGNALS, *CONSTANTS)}

s = _BY_NAME["direction"]
w = _BY_NAME["speed_magnitude"]
omega = _BY_NAME["speed"]
T_d = _BY_NAME["drum_torque"]
acceleration = _BY_NAME["acceleration"]
oil_temperature = _BY_NAME["oil_temperature"]
time = _BY_NAME["time"]
shaft_angle = _BY_NAME["shaft_angle"]
wire_layer = _BY_NAME["wire_layer"]
wire_out = _BY_NAME["wire_out"]
N = _BY_NAME["motor_total"]
n = _BY_NAME["count"]
p = _BY_NAME["pressure"]
p_sum = _BY_NAME["pressure_sum"]
D = _BY_NAME["displacement"]
higher_port = _BY_NAME["higher_port"]
role = _BY_NAME["role"]
X = _BY_NAME["max_displacement"]
rho = _BY_NAME["density"]
mu = _BY_NAME["viscosity"]
gear_ratio = _BY_NAME["gear_ratio"]


def __getattr__(name: str) -> sp.Symbol:
    """A signal by the name that tables and models call it by: `speed_magnitude` is `w`."""
    if name in _BY_NAME:
        return _BY_NAME[name]
    raise AttributeError(f"there is no signal '{name}'; an equation may read {', '.join(_BY_NAME)}")


ALL_OF_LOAD = 1.0  # most that one shaft loses per drum torque: all of it, where one motor turns the drum without a gear

GROUP_SYMBOLS = frozenset(signal.symbol for signal in GROUP_SIGNALS)
SIGNAL_OF_SYMBOL = {signal.symbol: signal for signal in (*WINCH_SIGNALS, *GROUP_SIGNALS, *CONSTANTS)}
TIME_INDEX = [signal.name for signal in WINCH_SIGNALS].index("time")
