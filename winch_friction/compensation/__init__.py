"""The friction feedforward and its limits."""

from winch_friction.compensation.compensator import FeedforwardCompensator
from winch_friction.compensation.config import CompensatorConfig
from winch_friction.compensation.feedforward import Feedforward
from winch_friction.records.sample_stream import InputHold

__all__ = ["CompensatorConfig", "Feedforward", "FeedforwardCompensator", "InputHold"]
