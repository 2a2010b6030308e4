"""The declared terms, grouped by the place where the friction arises."""

from winch_friction.physics.friction.terms import (
    drive,
    effects_memory,
    effects_motor,
    effects_winch,
    gear_and_drum,
    laws_motor,
    laws_winch,
    motor,
    paper1,
)

__all__ = [
    "drive",
    "effects_memory",
    "effects_motor",
    "effects_winch",
    "gear_and_drum",
    "laws_motor",
    "laws_winch",
    "motor",
    "paper1",
]
