"""Dimensions of SI units as people write them here: `N*m*s/rad`, `Pa*s^2/m^6`, `1`; radians and numbers have none.

Small on purpose: equations are checked where pint is not installed, and files hold SI units alone by then.
"""

import re
from collections import Counter
from collections.abc import Mapping

from winch_friction.physics.errors import InputError

Dimension = Mapping[str, float]  # exponents of kg, m, s, K, A; absent: 0
_UNITS: dict[str, dict[str, float]] = {
    "1": {}, "rad": {}, "kg": {"kg": 1}, "m": {"m": 1}, "s": {"s": 1}, "K": {"K": 1}, "degC": {"K": 1},
    "N": {"kg": 1, "m": 1, "s": -2}, "Pa": {"kg": 1, "m": -1, "s": -2}, "J": {"kg": 1, "m": 2, "s": -2},
    "W": {"kg": 1, "m": 2, "s": -3}, "Hz": {"s": -1}, "A": {"A": 1},
}  # fmt: skip
_TOKEN = re.compile(r"([*/]?)([A-Za-z]+|1)(?:\^(-?\d+(?:\.\d+)?))?")


def dimension_of(unit: str) -> dict[str, float]:
    """Exponents of kg, m, s, K and A; `InputError` for what is no SI unit."""
    total: Counter[str] = Counter()
    at = 0
    for token in _TOKEN.finditer(unit):
        if token.start() != at or token[2] not in _UNITS or (token[1] == "") != (at == 0):
            break
        power = float(token[3] or 1.0) * (-1.0 if token[1] == "/" else 1.0)
        for base, exponent in _UNITS[token[2]].items():
            total[base] += exponent * power  # type: ignore[assignment]
        at = token.end()
    if at != len(unit) or not unit:
        raise InputError(f"unit '{unit}' is not a product of SI units such as N*m*s/rad")
    return _without_zeros(total)


def product(*factors: tuple[str, float]) -> dict[str, float]:
    """Dimension of a product of powers of units."""
    total: Counter[str] = Counter()
    for unit, power in factors:
        for base, exponent in dimension_of(unit).items():
            total[base] += exponent * power  # type: ignore[assignment]
    return _without_zeros(total)


def quotient_unit(over: str, *factors: tuple[str, float]) -> str:
    """A readable unit that times the factors gives `over`, such as N*m*s/rad for N*m over rad/s."""
    powers: dict[str, float] = {}
    for unit, power in factors:
        for token in _TOKEN.finditer(unit):
            if token[2] != "1":
                own = float(token[3] or 1.0) * (-1.0 if token[1] == "/" else 1.0)
                powers[token[2]] = powers.get(token[2], 0.0) - own * power
    if over == "N*m" and powers.get("N", 0.0) == powers.get("m", 0.0) == -1.0:  # a torque over a torque
        over, powers = "1", {name: power for name, power in powers.items() if name not in ("N", "m")}
    above = "".join(f"*{_power(n, p)}" for n, p in powers.items() if p > 1e-12)
    below = "".join(f"/{_power(n, -p)}" for n, p in powers.items() if p < -1e-12)
    return f"{over}{above}{below}".removeprefix("1*")


def _power(name: str, power: float) -> str:
    return name if power == 1.0 else f"{name}^{power:g}"


def _without_zeros(total: Mapping[str, float]) -> dict[str, float]:
    return {base: float(exponent) for base, exponent in sorted(total.items()) if abs(exponent) > 1e-12}
