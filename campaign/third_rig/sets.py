"""The data sets: what is hidden in each, which names are right, what it takes to show it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from campaign.third_rig.hidden import Effect
from campaign.third_rig.motor_laws import MOTORS
from campaign.third_rig.outside import OUTSIDE_LAWS
from campaign.third_rig.plan import AHC, IRREGULAR, JOYSTICK, MAIN, REGULAR, STEPS
from campaign.third_rig.readings import READINGS
from campaign.third_rig.winch_laws import WINCH

NULL, SINGLE, PAIR, OUTSIDE = "null", "single", "pair", "outside"


@dataclass(frozen=True)
class Set:
    """One data set; `options` stand above what is drawn of `Options`."""

    key: str
    kind: str
    effects: tuple[Effect, ...] = ()
    options: Mapping[str, Any] = field(default_factory=dict)

    @property
    def causes(self) -> tuple[frozenset[str], ...]:
        """For each effect the names that are right; none outside the catalogue."""
        return tuple(frozenset(effect.names) for effect in self.effects if effect.names)

    @property
    def hidden(self) -> str:
        """What is hidden, in words."""
        told = ((effect.names[0] + ": " if effect.names else "") + effect.law for effect in self.effects)
        return "; ".join(told) or "nothing"


_ONLY_MAIN, _ONLY_SEA, _BOTH = {"modes": (MAIN,)}, {"modes": (AHC,)}, {"modes": (MAIN, AHC)}
_RIGID, _ELASTIC = {"elastic": False}, {"elastic": True}
_STEPS = {"kinds": {MAIN: (STEPS,), AHC: (REGULAR, IRREGULAR)}}
_JOYSTICK = {"kinds": {MAIN: (JOYSTICK,), AHC: (REGULAR, IRREGULAR)}}
_IRREGULAR = {"kinds": {MAIN: (STEPS,), AHC: (IRREGULAR,)}}

_NULLS: dict[str, dict[str, Any]] = {
    "null_01": _RIGID | _ONLY_MAIN | _STEPS | {"rate": 50},
    "null_02": _ELASTIC | _ONLY_SEA | {"rate": 50, "pulses": 2048},
    "null_03": _ELASTIC | _BOTH | {"rate": 100},
    "null_04": _ELASTIC | _ONLY_SEA | _IRREGULAR | {"rate": 25, "pulses": 0},
    "null_05": _ELASTIC | _ONLY_MAIN | {"rate": 50, "runs": (4, 4)},
    "null_06": _RIGID | _ONLY_MAIN | {"rate": 5, "pulses": 0, "seconds": (150, 240)},
    "null_07": _RIGID | _BOTH | {"rate": 250, "pulses": 0, "seconds": (25, 40)},
    "null_08": _ELASTIC | {"rate": 50, "seconds": (8, 20), "runs": (8, 12)},
    "null_09": _ELASTIC | _BOTH | {"rate": 50},
    "null_10": _RIGID | _ONLY_SEA | _IRREGULAR | {"rate": 100, "runs": (6, 6)},
    "null_11": _ELASTIC | {"rate": 10, "pulses": 0},
    "null_12": _ELASTIC | _ONLY_MAIN | _JOYSTICK | {"rate": 200},
    "null_13": _RIGID | {"zero_tolerance": 0.8, "rate": 50},
    "null_14": _ELASTIC | _ONLY_MAIN | {"rate": 100, "runs": (5, 6), "boost_steps": 30},
}

_SINGLES = WINCH | MOTORS | READINGS

_PAIRS = (
    ("visc_pow", "poff_some"),
    ("gearasy_hoist", "churn_thr"),
    ("tare_hook", "hp_thr"),
    ("inertia_const", "strib_hyp"),
    ("wear_runin", "lowdisp_pow"),
    ("layer_one", "visc_cold"),
    ("delay_run", "case_b"),
    ("port_lower", "poff_warm"),
)


def _pair(number: int, keys: tuple[str, str]) -> Set:
    first, second = (_SINGLES[key] for key in keys)
    return Set(f"pair_{number}", PAIR, (first, second), dict(first.options) | dict(second.options))


_ALL = (
    *(Set(key, NULL, (), options) for key, options in _NULLS.items()),
    *(Set(key, SINGLE, (effect,), effect.options) for key, effect in _SINGLES.items()),
    *(_pair(number + 1, keys) for number, keys in enumerate(_PAIRS)),
    *(Set(key, OUTSIDE, (effect,), effect.options) for key, effect in OUTSIDE_LAWS.items()),
)

SETS = {each.key: each for each in _ALL}
