"""The declared terms, grouped by the place where the friction arises."""

from winch_friction.physics.friction.terms import drive, gear_and_drum, motor

__all__ = ["drive", "gear_and_drum", "motor"]
