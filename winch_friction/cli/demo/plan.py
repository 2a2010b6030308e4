"""What the demo does: four phases on the same sea, each with its own compensator."""

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

from winch_friction.physics.friction import FrictionModel, term_named
from winch_friction.physics.winch.crane import Crane
from winch_friction.records.atomic import write_text
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model, save_model

GROUPS = ("active", "passive")
EFFICIENCY = 0.9  # today's practice: the winch is said to be 90 % efficient, whatever it does
SCALE = 0.9  # of the feedforward from a friction model; the factor is used in full, as people do
PATIENCE = 5.0  # s of steady time: a loaded machine may pause, the simulated sea does not mind


@dataclass(frozen=True)
class Phase:
    """One row of the table: what the compensator is told, and the share of its model that it feeds forward."""

    name: str
    title: str
    model: str
    scale: float
    enabled: bool = True
    follow: bool = False

    def as_plan(self) -> dict[str, Any]:
        """The phase for `nodes.stage`."""
        parameters = {"model_file": self.model, "scale": self.scale, "follow_model_topic": self.follow}
        return {"name": self.name, "enabled": self.enabled, "parameters": parameters}


@dataclass(frozen=True)
class DemoPlan:
    """Everything the demo starts from; `write` lays the files for the processes into `out`."""

    out: Path
    crane_name: str
    seed_name: str
    scenario: str
    duration: float
    sea: int
    friction_factor: float
    phases: tuple[Phase, ...] = field(default=())

    @property
    def bag(self) -> Path:
        """The recording."""
        return self.out / "bag"

    @property
    def crane(self) -> Crane:
        """The crane."""
        return load_crane(self.crane_name)

    @property
    def seed(self) -> FrictionModel:
        """What the nodes are told about the friction."""
        return load_model(self.seed_name)

    def write(self) -> tuple[Path, Path]:
        """Parameter file of the nodes and plan of the stage."""
        save_model(efficiency_model(self.crane, EFFICIENCY), self.out / "efficiency.yaml")
        nodes = yaml.safe_dump(self._node_parameters(), sort_keys=False)
        phases = [phase.as_plan() for phase in self.phases]
        plan = {
            "bag": str(self.bag),
            "crane": self.crane_name,
            "groups": GROUPS,
            "phases": phases,
        }
        parameter_file = write_text(self.out / "nodes.yaml", f"# What the demo's nodes were told.\n{nodes}")
        return parameter_file, write_text(self.out / "plan.json", json.dumps(plan, indent=1))

    def _node_parameters(self) -> dict[str, Any]:
        shared = {"crane": self.crane_name, "model_file": self.seed_name, "groups": list(GROUPS)}
        answers = ["compensator/friction_torque", "estimator/friction_torque"]
        simulator = {
            "autostart": False, "scenario": self.scenario, "duration": self.duration, "seed": self.sea,
            "friction_factor": self.friction_factor, "rate": 0.0, "lockstep": True, "lockstep_timeout": 30.0,
            "wait_for": answers, "subscribers": 3,
        }  # fmt: skip
        own = {
            "/**": {**shared, "watchdog_timeout": PATIENCE},
            "/**/compensator": {"autostart": False},
            "/**/estimator": {"checkpoint": str(self.out / "estimator.json")},
            "/**/simulator": simulator,
        }
        return {name: {"ros__parameters": parameters} for name, parameters in own.items()}


def make_plan(out: Path, scenario: str, duration: float, sea: int, factor: float) -> DemoPlan:
    """The demo's plan: no feedforward, constant efficiency factor, seed model, learned model."""
    seed = "a6vm215_crane2"
    phases = (
        Phase("none", "none", seed, SCALE, enabled=False),
        Phase("efficiency", f"efficiency {EFFICIENCY:g}", str(out / "efficiency.yaml"), 1.0),
        Phase("seed", f"seed x {SCALE:g}", seed, SCALE),
        Phase("learned", f"learned x {SCALE:g}", seed, SCALE, follow=True),
    )
    return DemoPlan(out, "crane_150t", seed, scenario, duration, sea, factor, phases)


def efficiency_model(crane: Crane, efficiency: float) -> FrictionModel:
    """Friction as a constant share of the load torque: (1 - efficiency) T_d / i, split over the motors."""
    share = (1.0 - efficiency) / (crane.gear_ratio * crane.motor_total(GROUPS))
    return FrictionModel(
        name=f"efficiency_{efficiency:g}",
        terms=(term_named("gear_load_loss"),),
        values=(share,),
        provenance={"method": "constant efficiency factor, as in today's practice"},
    )
