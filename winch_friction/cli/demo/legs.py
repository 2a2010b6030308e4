"""The legs of the demo's voyage: the same sea with another load on the hook and another displacement of the motors."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

from winch_friction.physics.channels import CM3_PER_REV
from winch_friction.physics.errors import InputError
from winch_friction.records.atomic import write_text
from winch_friction.records.strict_yaml import read_yaml, shipped
from winch_friction.simulation.scenario import Measured, Scenario, load_scenario, scenario_from_content

# what the legs after the first change; a factor tuned at the first meets a light and a heavy load, and smaller motors
OTHERS = (
    {"load": {"value": 15, "unit": "t"}, "displacement": {"value": 160, "unit": "cm^3/rev"}},
    {"load": {"value": 100, "unit": "t"}, "displacement": {"value": 160, "unit": "cm^3/rev"}},
)
# what belongs to the first leg's load and displacement; the passive side balances each load anew
ONLY_FIRST = ("passive_displacement", "displacement_schedule")


@dataclass(frozen=True)
class Leg:
    """One leg: its scenario file's content and what is in it."""

    name: str
    content: Mapping[str, Any] = field(repr=False)
    scenario: Scenario = field(repr=False)

    @property
    def title(self) -> str:
        """Load and displacement, for people."""
        return f"{self.load:g} t, {self.displacement:g} cm³/rev"

    @property
    def load(self) -> float:
        """The load in t."""
        return float(f"{self.scenario.load / 1e3:.6g}")

    @property
    def displacement(self) -> float:
        """Displacement of the active motors in cm^3/rev."""
        return float(f"{self.scenario.displacement / CM3_PER_REV:.6g}")

    @property
    def key(self) -> tuple[float, float]:
        """Load in t and displacement in cm^3/rev."""
        return self.load, self.displacement

    def write(self, folder: Path) -> Path:
        """The leg as a scenario file."""
        folder.mkdir(parents=True, exist_ok=True)
        text = yaml.safe_dump(dict(self.content), sort_keys=False, allow_unicode=True)
        return write_text(folder / f"{self.name}.yaml", f"# A leg of the demo's voyage.\n{text}")


def voyage_legs(name: str) -> tuple[Leg, ...]:
    """The legs of a voyage that begins with a scenario, by path or shipped name.

    Raises `InputError` for a scenario that is not there, cannot be read or is not heave compensation.
    """
    first = load_scenario(name)
    if first.mode != "ahc":
        raise InputError(f"scenario '{first.name}' is no heave compensation (mode ahc), which the demo is about")
    content = dict(read_yaml(shipped("scenarios", name)))
    if isinstance(first.sea, Measured):  # the legs are written elsewhere than the scenario that names it
        content["sea"] = {**content["sea"], "file": first.sea.file}
    return tuple(_leg(k, content, change) for k, change in enumerate(({}, *OTHERS)))


def _leg(number: int, first: Mapping[str, Any], change: Mapping[str, Any]) -> Leg:
    name = f"leg_{number + 1}"
    kept = {key: value for key, value in first.items() if not change or key not in ONLY_FIRST}
    content = {**kept, **change, "name": name}
    return Leg(name, content, scenario_from_content(content, name))
