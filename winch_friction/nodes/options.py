"""What every node can be told, beside the settings of the object inside it."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from winch_friction.physics.errors import InputError, check, option
from winch_friction.records.input_mapping import InputMapping


@dataclass(frozen=True)
class NodeOptions(InputMapping):
    """Files, conventions of the inputs and the node's own habits. Raises `InputError` for values out of range."""

    autostart: bool = option(True, doc="configure and activate at start, without waiting for a lifecycle manager")
    crane: str = option("crane_150t", doc="crane file, or the name of a shipped crane")
    model_file: str = option("a6vm215_crane2", doc="model file or shipped name: the seed, and what ~/load_model loads")
    terms_file: str = option(
        "", doc="Python file that declares friction terms of your own, which the model files may name; it is run"
    )
    diagnostics_period: float = option(1.0, lower=0.05, upper=60.0, unit="s", doc="time between diagnostics")
    watchdog_timeout: float = option(
        0.1, lower=0.01, upper=600.0, unit="s", doc="time without a speed after which the inputs count as lost"
    )
    watchdog_clock: str = option(
        "steady", choices=("steady", "ros"), doc="clock of the watchdog; ros only where a recording is played"
    )
    stamp_window: float = option(
        0.5, lower=0.05, upper=60.0, unit="s", doc="how far a stamp may run ahead of the clock before it is refused"
    )

    def __post_init__(self) -> None:
        check(self)


READ_WITH_MODEL = ("crane", "model_file", "terms_file")  # may change, and count from the next reading on
FIXED = tuple(name for name in NodeOptions.__dataclass_fields__ if name not in READ_WITH_MODEL)


def refuse_crane_meanwhile(changes: Mapping[str, Any], in_use: str | None) -> None:
    """Raise `InputError` for another crane while a node is built on the one `in_use`; None: on none.

    Files are read again by ~/load_model, the crane by configure alone: the parameter would tell of a machine that
    nothing is computed for, and the next restart of the node's lifecycle change it unasked.
    """
    if in_use is not None and (wanted := changes.get("crane", in_use)) != in_use:
        raise InputError(f"'{wanted}' as crane counts from configure on, '{in_use}' is in use: cleanup first")
