"""All kinds of faults by name, and a draw among them."""

from collections.abc import Callable

import numpy as np

from campaign.faults import plain_kinds as plain
from campaign.faults.mixed_kinds import MIXED
from campaign.faults.plain_kinds import REFERENCE, SPEED, Fault, Messages, one_of
from campaign.faults.sent_kinds import SENT

__all__ = ["KINDS", "REFERENCE", "SPEED", "Fault", "Messages", "draw"]

KINDS: dict[str, Callable[[np.random.Generator], Fault]] = {
    each.__name__: each
    for each in (
        plain.drop_out,
        plain.everything_silent,
        plain.packet_loss,
        plain.not_a_number,
        plain.absurd,
        plain.wrong_unit,
        plain.wrong_sign,
        plain.spikes,
        plain.drift,
        plain.stuck,
        plain.frozen_stamp,
        plain.future_stamp,
        plain.zero_stamp,
        plain.clock_set,
        plain.other_clocks,
        plain.duplicated,
        plain.reordered,
        plain.delayed,
        plain.flood,
        plain.second_publisher,
        *SENT,
        *MIXED,
    )
}


def draw(rng: np.random.Generator) -> Fault:
    """Any fault."""
    return one_of(rng, *KINDS.values())(rng)
