"""What a winch's sensor can say at all: a number beyond a channel's limits is a broken sensor, not a measurement.

The limits are wide, several times what any winch does: they keep out what a bus fault, an overflow, a wrong unit make.
"""

from functools import lru_cache

from winch_friction.physics.channels import CHANNELS, UNBOUNDED

LIMITS = {each.name: each.limits for each in CHANNELS}  # channel, without its group -> smallest and largest value, SI


def plausible(channel: str, value: float) -> bool:
    """Whether a value of this channel (a run's column or its short name) is a number that a sensor can mean."""
    lower, upper = limits(channel)
    return lower <= value <= upper  # false for NaN too


@lru_cache(maxsize=1024)
def limits(channel: str) -> tuple[float, float]:
    """Smallest and largest value of a channel, SI."""
    return LIMITS.get(channel.rpartition(".")[2], UNBOUNDED)
