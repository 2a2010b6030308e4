"""One correction of a model: an error's value, how well it is known, and what it is restricted to."""

import itertools
import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from winch_friction.physics.errors import InputError
from winch_friction.physics.friction.declared_correction import DeclaredCorrection, declared_correction

THERMAL_REFERENCE = 40.0  # degC, where thermal errors are zero: the oil of the seed models


@dataclass(frozen=True)
class Correction:
    """One correction of a model, SI: the error's value, its standard deviation (None: unknown), bounds and source.

    `groups` and `layers` restrict it (empty: all); `time_constant` s of those that fade or fill; `during` the windows
    of absolute time, s from and to, in which it was there (empty: always; `inf`: since then) or, one window, in which
    it grew; `beyond` where a bend begins, or an S ends, in its channel's SI unit; `course` of a delay that data have
    drawn the points (s since the run began, share of the value), between which it is straight and beyond which it
    stays. Bounds not given: the declared ones.
    Raises `InputError` for a value, bounds or ties that the declaration does not allow.
    """

    name: str
    value: float
    std: float | None = None
    lower: float | None = None
    upper: float | None = None
    source: str = ""
    groups: tuple[str, ...] = ()
    layers: tuple[int, ...] = ()
    time_constant: float | None = None
    during: tuple[tuple[float, float], ...] = ()
    beyond: float | None = None
    course: tuple[tuple[float, float], ...] = ()

    def __post_init__(self) -> None:
        own = self.declared
        for bound in ("lower", "upper"):
            if getattr(self, bound) is None:
                object.__setattr__(self, bound, getattr(own.parameter, bound))
        self._check_bounds()
        if self.std is not None and not 0.0 <= self.std < float("inf"):
            raise InputError(f"correction '{self.name}': std must be a finite number from 0, found {self.std:g}")
        if self.groups and not own.by_group:
            raise InputError(f"correction '{self.name}' cannot be tied to motor groups")
        if self.layers and not own.by_layer:
            raise InputError(f"correction '{self.name}' cannot be tied to wire layers")
        if own.has_time_constant != (self.time_constant is not None):
            needs = "needs a time_constant in s" if own.has_time_constant else "has no time_constant"
            raise InputError(f"correction '{self.name}' {needs}")
        if self.time_constant is not None and not 0.0 < self.time_constant < float("inf"):
            raise InputError(f"correction '{self.name}': time_constant must be above 0 s, found {self.time_constant:g}")
        if self.time_constant is not None and own.late and max(map(abs, self.bounds)) >= self.time_constant:
            raise InputError(f"correction '{self.name}': time_constant must be above its bounds, or they within it")
        if bool(own.bends_in) != (self.beyond is not None):
            needs = f"needs beyond, in {own.bends_in}" if own.bends_in else "has no beyond"
            raise InputError(f"correction '{self.name}' {needs}")
        if self.beyond is not None and not 0.0 < self.beyond < float("inf"):
            raise InputError(f"correction '{self.name}': beyond must be above 0 {own.bends_in}, found {self.beyond:g}")
        self._check_course()
        if self.during and own.kind not in ("signal", "load"):
            raise InputError(f"correction '{self.name}' cannot be tied to a time: the {own.kind} does not change")
        if not all(begin < end for begin, end in self.during):
            raise InputError(f"correction '{self.name}': during must be windows [from, to] with from before to, in s")
        if own.grows and (len(self.during) != 1 or not all(map(math.isfinite, self.during[0]))):
            raise InputError(f"correction '{self.name}' needs during: one window [from, to] in s, in which it grew")

    @property
    def declared(self) -> DeclaredCorrection:
        """What is said of every correction of this name."""
        return declared_correction(self.name)

    @property
    def bounds(self) -> tuple[float, float]:
        """Lower and upper bound, SI."""
        return self.lower, self.upper  # type: ignore[return-value]

    @property
    def ties(self) -> tuple[tuple[str, ...], tuple[int, ...], tuple[tuple[float, float], ...], float | None]:
        """What it is restricted to: motor groups, wire layers, windows of time, what lies beyond a value."""
        return self.groups, self.layers, self.during, self.beyond

    def holds(self, time: float) -> bool:
        """Whether the error is there at that time, s."""
        return self.declared.grows or not self.during or any(begin <= time <= end for begin, end in self.during)

    def error(self, time: Any, oil: Any) -> Any:
        """The error at times in s and oil temperatures in degC, where they matter to it; in the value's unit."""
        value = self.value
        if "oil_temperature" in self.declared.reads:
            value = value * (oil - THERMAL_REFERENCE) ** self.declared.by_warmth
        if self.declared.grows:
            ((begin, end),) = self.during
            value = value * np.clip((time - begin) / (end - begin), 0.0, 1.0)
        return value

    @property
    def ends(self) -> float:
        """When it is over, s; `inf` for what has no end or, once grown, stays."""
        return float("inf") if self.declared.grows else max((end for _, end in self.during), default=float("inf"))

    def _check_course(self) -> None:
        """A course has points, in turn, between which a delay grows more slowly than time goes by."""
        if (self.declared.course == "drawn") != bool(self.course):
            needs = (
                "has no course" if self.course else "needs course: points [s since the run began, share of the value]"
            )
            raise InputError(f"correction '{self.name}' {needs}")
        if not self.course:
            return
        time, share = zip(*self.course, strict=True)
        least = 2.0 * max(map(abs, self.bounds))
        if time[0] < 0.0 or max(map(abs, share)) > 1.0 or not all(map(math.isfinite, (*time, *share))):
            raise InputError(f"correction '{self.name}': course must have times from 0 s and shares of -1 to 1")
        if any(after - before <= least for before, after in itertools.pairwise(time)):
            apart = f"more than {least:g} s, twice the largest delay"
            raise InputError(f"correction '{self.name}': the points of its course must be in turn and {apart}, apart")

    def _check_bounds(self) -> None:
        own, (lower, upper) = self.declared.parameter, self.bounds
        if not own.lower <= lower <= upper <= own.upper:
            raise InputError(
                f"correction '{self.name}': bounds {lower:g} ... {upper:g} {own.unit} must lie inside "
                f"{own.lower:g} ... {own.upper:g} {own.unit}"
            )
        if not lower <= self.value <= upper:
            unit = "" if own.unit == "1" else f" {own.unit}"
            raise InputError(f"correction '{self.name}': {self.value:g}{unit} is outside {lower:g} ... {upper:g}{unit}")


def check_corrections(corrections: tuple[Correction, ...]) -> None:
    """Raise `InputError` where one correction stands twice for the same groups, layers, times and place to bend."""
    seen = [(each.name, each.ties) for each in corrections]
    for name, ties in seen:
        if seen.count((name, ties)) > 1:
            raise InputError(f"correction '{name}' stands twice for the same motor groups; give one value")
