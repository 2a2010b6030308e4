"""What a user of the workflow may choose."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from winch_friction.discrepancy.candidates.candidate import Candidate

STEPS = 4  # that `told` hears of


def _silent(_: str) -> None:
    """For who does not watch."""


@dataclass(frozen=True)
class GapOptions:
    """`holdout` is the share of runs locked for the proof; `seed` drives every random choice."""

    holdout: float = 0.25
    seed: int = 0
    effects_file: Path | None = None
    proposals: bool = True  # laws are looked for where no name fits
    plan: bool = True  # look for the experiment that separates rivals
    candidates: tuple[Candidate, ...] = ()  # instead of the catalogue, when given
    told: Callable[[str], None] = _silent  # what begins: for a progress bar
