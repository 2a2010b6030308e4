"""What the demo does: one voyage of several legs, sailed once with each feedforward."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from winch_friction.cli.demo.legs import Leg
from winch_friction.physics.friction import FrictionModel, term_named
from winch_friction.physics.winch.crane import Crane
from winch_friction.records.atomic import write_text
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model, save_model

CRANE, SEED = "crane_150t", "a6vm215_crane2"
GROUPS = ("active", "passive")
SCALE = 0.9  # of the feedforward from a friction model
IN_FULL = 1.0  # of that from an efficiency factor: whoever tunes it puts everything into the factor
PATIENCE = 5.0  # s of steady time: a loaded machine may pause, the simulated sea does not mind


@dataclass(frozen=True)
class Feedforward:
    """One way to compensate: what the compensator is told, and the share of its model that it feeds forward."""

    name: str
    title: str
    model: str
    scale: float
    enabled: bool = True
    follow: bool = False


@dataclass(frozen=True)
class Phase:
    """One leg with one feedforward."""

    feedforward: Feedforward
    leg: Leg

    @property
    def name(self) -> str:
        """Its name in files."""
        return f"{self.feedforward.name}, {self.leg.name}"

    @property
    def title(self) -> str:
        """Its name for people."""
        return f"{self.feedforward.title}, {self.leg.title}"

    def as_plan(self) -> dict[str, Any]:
        """The phase for `nodes.stage`."""
        own = self.feedforward
        parameters = {"model_file": own.model, "scale": own.scale, "follow_model_topic": own.follow}
        return {"name": self.name, "enabled": own.enabled, "parameters": parameters}


@dataclass(frozen=True)
class DemoPlan:
    """Everything the demo starts from; `write` lays the files for the processes into `out`."""

    out: Path
    scenario: str
    legs: tuple[Leg, ...]
    feedforwards: tuple[Feedforward, ...]
    efficiency: float
    duration: float
    sea: int
    friction_factor: float

    @property
    def phases(self) -> tuple[Phase, ...]:
        """The whole voyage with one feedforward after the other."""
        return tuple(Phase(each, leg) for each in self.feedforwards for leg in self.legs)

    @property
    def bag(self) -> Path:
        """The recording."""
        return self.out / "bag"

    @property
    def crane(self) -> Crane:
        """The crane."""
        return load_crane(CRANE)

    @property
    def seed(self) -> FrictionModel:
        """What the nodes are told about the friction."""
        return load_model(SEED)

    def write(self) -> tuple[Path, Path]:
        """Parameter file of the nodes and plan of the stage."""
        save_model(efficiency_model(self.crane, self.efficiency), self.out / "efficiency.yaml")
        scenarios = [str(leg.write(self.out / "legs")) for leg in self.legs]
        nodes = yaml.safe_dump(self._node_parameters(scenarios), sort_keys=False)
        phases = [phase.as_plan() for phase in self.phases]
        plan = {"bag": str(self.bag), "crane": CRANE, "groups": GROUPS, "phases": phases}
        parameter_file = write_text(self.out / "nodes.yaml", f"# What the demo's nodes were told.\n{nodes}")
        return parameter_file, write_text(self.out / "plan.json", json.dumps(plan, indent=1))

    def _node_parameters(self, scenarios: Sequence[str]) -> dict[str, Any]:
        shared = {"crane": CRANE, "model_file": SEED, "groups": list(GROUPS)}
        answers = ["compensator/friction_torque", "estimator/friction_torque"]
        simulator = {
            "autostart": False, "scenario": scenarios[0], "duration": self.duration, "seed": self.sea,
            "friction_factor": self.friction_factor, "rate": 0.0, "lockstep": True, "lockstep_timeout": 30.0,
            "wait_for": answers, "subscribers": 3,
        }  # fmt: skip
        if scenarios[1:]:
            simulator["legs"] = list(scenarios[1:])
        own = {
            "/**": {**shared, "watchdog_timeout": PATIENCE},
            "/**/compensator": {"autostart": False},
            "/**/estimator": {"checkpoint": str(self.out / "estimator.json")},
            "/**/simulator": simulator,
        }
        return {name: {"ros__parameters": parameters} for name, parameters in own.items()}


def make_plan(
    out: Path, scenario: str, legs: Sequence[Leg], efficiency: float, duration: float, sea: int, factor: float
) -> DemoPlan:
    """The demo's plan: no feedforward, the tuned efficiency factor, the seed model, the learned model."""
    feedforwards = (
        Feedforward("none", "none", SEED, SCALE, enabled=False),
        Feedforward("efficiency", f"efficiency {efficiency:.2f}", str(out / "efficiency.yaml"), IN_FULL),
        Feedforward("seed", f"seed × {SCALE:g}", SEED, SCALE),
        Feedforward("learned", f"learned × {SCALE:g}", SEED, SCALE, follow=True),
    )
    return DemoPlan(out, scenario, tuple(legs), feedforwards, efficiency, duration, sea, factor)


def efficiency_model(crane: Crane, efficiency: float) -> FrictionModel:
    """Friction as a constant share of the load torque: (1/efficiency - 1) T_d / i, split over the motors."""
    share = (1.0 / efficiency - 1.0) / (crane.gear_ratio * crane.motor_total(GROUPS))
    return FrictionModel(
        name=f"efficiency_{efficiency:.2f}",
        terms=(term_named("gear_load_loss"),),
        values=(share,),
        provenance={"method": "constant efficiency factor, as in today's practice"},
        crane=crane.name,
    )
