"""A ROS message as it travels."""

from dataclasses import dataclass


@dataclass(frozen=True)
class RawMessage:
    """One serialised ROS message: its full topic, its type, when it was received in ns, its CDR."""

    topic: str
    type_name: str
    receipt: int
    data: bytes
