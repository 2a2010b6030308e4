"""A world as its owner would describe it to the package: a crane file and the seed model, in the documented formats."""

from pathlib import Path

from campaign.rig.truth import CM3_PER_REV, RELATIVE_SIGMA, Friction
from campaign.rig.world import World

TERMS = (
    "motor_viscous", "motor_turbulence", "motor_load_loss", "motor_coulomb", "high_pressure_mixed", "stribeck",
    "viscous", "gear_load_loss",
)  # fmt: skip
UNITS = {
    "K1": "N*m*s/rad", "K2": "N*s^2/m^8", "K3": "1", "K4": "N*m", "K5": "m^5/N",
    "C1": "1", "C3": "N*m", "C4": "rad/s", "C5": "N*m*s/rad", "C6": "1",
}  # fmt: skip


def write_world(folder: Path, world: World) -> tuple[Path, Path]:
    """`crane.yaml` and `model.yaml` in a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    crane, model = folder / "crane.yaml", folder / "model.yaml"
    crane.write_text(crane_text(world))
    model.write_text(model_text(world))
    return crane, model


def crane_text(world: World) -> str:
    """The crane file's text."""
    radii = ", ".join(f"{radius:.6g}" for radius in world.radii)
    return f"""schema: winch_friction.crane/1
name: {world.name}
drive: hydraulic
gear_ratio: {world.gear:.9g}
max_displacement: {{value: {world.max_displacement / CM3_PER_REV:.9g}, unit: cm^3/rev}}
drum:
  layer_radii: [{radii}]
groups:
  main: {world.motors}
  active: {world.active}
  passive: {world.passive}
inertia: {{value: {world.inertia:.9g}, unit: kg*m^2}}
wire_mass: {{value: {world.wire_mass:.9g}, unit: kg/m}}
wire_stiffness: {{value: {world.wire_stiffness:.9g}, unit: N}}
absolute_torque_limit: {{value: {2000 * world.winch_size:.6g}, unit: N*m}}
"""


def model_text(world: World, seed: Friction | None = None) -> str:
    """The seed model's text, with the usual relative standard deviations."""
    seed = seed or world.seed
    lines = [
        f'  {name}: {{value: {value:.9g}, unit: "{UNITS[name]}", std: {value * sigma:.9g}}}'
        for name, value, sigma in zip(seed._fields, seed, RELATIVE_SIGMA, strict=True)
    ]
    return f"""schema: winch_friction.model/1
name: seed_of_{world.name}
terms: [{", ".join(TERMS)}]
constants:
  max_displacement: {{value: {world.max_displacement / CM3_PER_REV:.9g}, unit: cm^3/rev}}
  gear_ratio: {world.gear:.9g}
parameters:
{chr(10).join(lines)}
provenance:
  source: drawn
"""
