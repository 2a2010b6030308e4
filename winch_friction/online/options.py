"""How the services judge time."""

from dataclasses import dataclass

from winch_friction.physics.options import check, option

LONGEST_REAL_TIME = 1.0  # s; who waits longer for a speed has no real time: a simulation that pauses, or runs fast
WATCH_PERIOD = 0.02  # s between two steps of the ramp that follows a silence
WATCH_SHARE = 0.2  # ... or this share of the time-out, where that is less


@dataclass(frozen=True)
class ServiceOptions:
    """`watchdog_timeout` s of silence are a lost speed; a stamp may lie `stamp_window` s ahead of the clock; a
    learned model takes effect `model_delay` s after its last measurement."""

    watchdog_timeout: float = option(
        0.1, lower=0.01, upper=600.0, unit="s", doc="time without a speed after which the inputs count as lost"
    )
    stamp_window: float = option(
        0.5, lower=0.05, upper=60.0, unit="s", doc="how far a stamp may run ahead of the clock before it is refused"
    )
    model_delay: float = option(
        0.5, lower=0.0, upper=60.0, unit="s", doc="a learned model takes effect this long after its last measurement"
    )

    def __post_init__(self) -> None:
        check(self)

    @property
    def paced(self) -> bool:
        """Whether the stamps are bound to the clock that the service is told."""
        return self.watchdog_timeout <= LONGEST_REAL_TIME

    @property
    def watch_period(self) -> float:
        """s between two looks at the silence."""
        return min(WATCH_PERIOD, WATCH_SHARE * self.watchdog_timeout)
