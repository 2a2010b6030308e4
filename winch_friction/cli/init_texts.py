"""The texts of `init`: every number is the user's, derived from it, or said to be an estimate with its rule.

The rules scale crane_150t and the model a6vm215_crane2 (paper 2) by size: volumes and flows with the motors' total
displacement, inertia with its power 5/3, a wire with its diameter squared. They begin a file; they do not measure.
"""

import json
from dataclasses import dataclass
from typing import Any

import yaml

from winch_friction.physics.channels import CM3_PER_REV, GRAVITY
from winch_friction.physics.errors import InputError
from winch_friction.physics.winch.crane import Crane

# what the rules scale: crane_150t, its plant and its model
MOTORS, DISPLACEMENT, GEAR = 11, 215.0, 250.0  # cm^3/rev
INERTIA, TORQUE_LIMIT = 1.54, 2000.0  # kg m^2, N m
WIRE, WIRE_MASS, WIRE_STIFFNESS = 77.0, 24.5, 3.0e8  # mm, kg/m, N
FLOW, VOLUME, VALVE, PASSIVE, GAS = 0.0445, 0.06, 1.0e-8, 8, 1.6  # m^3/s, m^3, m^3/s/Pa, motors, m^3
LEAKAGE, CASE, DAMPING = 5.0e-12, 5.0e-13, 1.5e5  # m^3/s/Pa, m^3/s/Pa, N s/m
PASSIVE_PRESSURE = 275e5  # Pa, that carries the load in heave compensation
MODEL_SPREAD = 0.3  # relative 1 sigma of a scaled model's parameters: cranes of one size differ by as much

# what is built, generously: beyond it a figure was meant in another unit
USUAL = {"displacement": (5.0, 5000.0, "cm^3/rev"), "radius": (0.05, 5.0, "m"), "wire": (2.0, 300.0, "mm")}
HOLDS = (0.5, 10.0)  # of the rated load; the shipped crane's motors hold 1.7 times theirs


@dataclass(frozen=True)
class CraneFacts:
    """What a crane file needs to be told; `inertia` kg m^2 or None for an estimate."""

    name: str
    load: float
    motors: int
    displacement: float
    gear_ratio: float
    radius: float
    layers: int
    active: int
    wire: float
    inertia: float | None = None

    def __post_init__(self) -> None:
        numbers = ("load", "motors", "displacement", "gear_ratio", "radius", "layers", "wire")
        wrong = [f"--{name.replace('_', '-')} {getattr(self, name)!r} must be above 0" for name in numbers
                 if not getattr(self, name) > 0]  # fmt: skip
        if not 0 <= self.active < max(self.motors, 1):
            wrong.append(f"--active {self.active} must be 0 ... {self.motors - 1}: the others are passive")
        wrong += [] if wrong else self._unlikely()
        if wrong:
            raise InputError(f"init crane: {'; '.join(wrong)}")

    def _unlikely(self) -> list[str]:
        """Figures that are another unit's: outside what is built, or motors that cannot hold the rated load."""
        found = [
            f"--{name} {getattr(self, name):g} is outside {low:g} ... {high:g} {unit}"
            for name, (low, high, unit) in USUAL.items()
            if not low <= getattr(self, name) <= high
        ]
        share = self.holds / self.load
        if not found and not HOLDS[0] <= share <= HOLDS[1]:
            found.append(
                f"at 300 bar these motors hold {self.holds:.3g} t, {share:.2g} times the rated load of {self.load:g} "
                "t: look at --displacement (per motor), --motors, --gear-ratio and --radius again"
            )
        return found

    @property
    def radii(self) -> list[float]:
        """Rope radius of each layer, m."""
        return [self.radius + 0.87 * 1e-3 * self.wire * k for k in range(self.layers)]

    @property
    def holds(self) -> float:
        """What all motors hold at 300 bar on the outermost layer, t."""
        displacement = self.motors * self.displacement * CM3_PER_REV
        return displacement * 300e5 * self.gear_ratio / (GRAVITY * self.radii[-1]) / 1e3


def _text(word: str) -> str:
    """A word as YAML has it: in quotes where it would be read as something else (`12`, `yes`, `Nord: 7`)."""
    try:
        plain = yaml.safe_load(f"word: {word}") == {"word": word}
    except yaml.YAMLError:
        plain = False
    return word if plain else json.dumps(word, ensure_ascii=False)


def crane_text(f: CraneFacts) -> str:
    """The crane file."""
    size = f.motors * f.displacement / (MOTORS * DISPLACEMENT)
    wire = (f.wire / WIRE) ** 2
    radii, holds = f.radii, f.holds
    inertia = f.inertia or INERTIA * f.motors / MOTORS * (f.displacement / DISPLACEMENT) ** (5.0 / 3.0)
    source = "as given" if f.inertia else "ESTIMATE, scaled from crane_150t: motors, gear and drum, without the load"
    groups = f"  main: {f.motors}"
    if f.active:
        groups += f"\n  active: {f.active}\n  passive: {f.motors - f.active}"
    return f"""# Written by winch-friction init crane. Check what is called an ESTIMATE against the crane's documents.
schema: winch_friction.crane/1
name: {_text(f.name)}
drive: hydraulic                # electric, power and current: docs/interfaces.md
gear_ratio: {f.gear_ratio:g}
max_displacement: {{value: {f.displacement:g}, unit: cm^3/rev}}   # per motor
drum:
  # rope radius per layer in m, innermost first; ESTIMATE beyond the first: 0.87 of a wire diameter per layer
  layer_radii: [{", ".join(f"{r:.4g}" for r in radii)}]
groups:                         # motors per group: normal winch mode has one group, heave compensation two
{groups}
inertia: {{value: {inertia:.3g}, unit: kg*m^2}}    # at the motor shaft; {source}
wire_mass: {{value: {WIRE_MASS * wire:.3g}, unit: kg/m}}          # ESTIMATE from the diameter
wire_stiffness: {{value: {WIRE_STIFFNESS * wire:.3e}, unit: N}}  # EA, ESTIMATE from the diameter
absolute_torque_limit: {{value: {TORQUE_LIMIT * size:.3g}, unit: N*m}}   # bound of any feedforward: YOURS to decide
rated_load: {{value: {f.load:g}, unit: t}}          # all motors hold {holds:.3g} t on the outer layer at 300 bar
"""


def plant_text(crane: Crane, name: str) -> str:
    """The plant file of a crane."""
    total = max(crane.groups.values()) * crane.max_displacement
    size = total / (MOTORS * DISPLACEMENT * CM3_PER_REV)
    one = crane.max_displacement / (DISPLACEMENT * CM3_PER_REV)
    gas = crane.groups.get("passive", 0) * one / PASSIVE
    wire = crane.wire_stiffness / WIRE_STIFFNESS if crane.wire_stiffness < 1e300 else 1.0
    return f"""# Written by winch-friction init plant for crane '{crane.name}': scaled from winch_150t. ESTIMATES.
schema: winch_friction.plant/1
name: {_text(name)}
crane: {_text(crane.name)}             # simulating another crane with it is refused
pump:
  flow: {FLOW * size:.4g}                  # m^3/s at full stroke
  lag: 0.1                      # s; or bandwidth (rad/s) and damping of a second-order pump
active_loop:
  volume: {VOLUME * size:.4g}                # m^3 per side
  bulk_modulus: 1.0e+9          # Pa
  boost_pressure: {{value: 25, unit: bar}}
  relief_pressure: {{value: 350, unit: bar}}
  valve_gain: {VALVE * size:.3e}         # m^3/s/Pa
accumulator:                    # of the passive side; unused in normal mode
  pressure: {{value: 300, unit: bar}}
  low_pressure: {{value: 25, unit: bar}}
  gas_volume: {GAS * (gas or size):.3g}              # m^3 at that pressure
  exponent: 1.2                 # polytropic
leakage: {LEAKAGE * one:.3e}              # m^3/s/Pa per motor, across
case_leakage: {CASE * one:.3e}         # m^3/s/Pa per motor and side
torque_lag: 0.05                # s, of a torque-commanded drive
wire_damping: {DAMPING * wire:.3e}         # N s/m: rope, sheaves and boom
presliding: {{value: 0.2, unit: deg}}   # e-fold of the bristle at the motor shaft
"""


def model_text(crane: Crane, name: str) -> str:
    """A seed model: a6vm215_crane2's parameters scaled to the crane's motors and gear."""
    from winch_friction.identification.motor_models import GROWTH, grown, room
    from winch_friction.records.model_file import load_model

    seed, size = load_model("a6vm215_crane2"), crane.max_displacement
    one = size / (DISPLACEMENT * CM3_PER_REV)
    shared = MOTORS * GEAR / (max(crane.groups.values()) * crane.gear_ratio)  # of the drum's torque, per motor
    scale = {"C3": one, "C5": one, "C1": shared, "C6": shared, **{name: grown(name, size) for name in GROWTH}}
    lines = []
    for parameter, value in zip(seed.parameters, seed.values, strict=True):
        scaled, upper = value * scale.get(parameter.name, 1.0), room(parameter, size)[1]
        wider = f", upper: {upper:.4g}" if upper > parameter.upper else ""
        entry = f'{{value: {scaled:.4g}, unit: "{parameter.unit}", std: {MODEL_SPREAD * scaled:.3g}{wider}}}'
        lines.append(f"  {parameter.name}: {entry}   # {parameter.doc}")
    body = "\n".join(lines)
    return f"""# Written by winch-friction init model: a6vm215_crane2 scaled to crane '{crane.name}'. A ROUGH SEED.
# winch-friction identify system or practice makes a measured one of it.
schema: winch_friction.model/1
name: {_text(name)}
crane: {_text(crane.name)}
terms: [{", ".join(seed.term_names)}]
constants:
  max_displacement: {{value: {crane.max_displacement / CM3_PER_REV:.6g}, unit: cm^3/rev}}
  gear_ratio: {crane.gear_ratio:g}
parameters:                     # std is one standard deviation
{body}
provenance:
  source: scaled from a6vm215_crane2 by motor size and gear; not measured
"""


def scenario_text(crane: Crane, name: str, plant: str, mode: str, load: float | None) -> str:
    """A scenario of a crane."""
    mass = load if load is not None else _usual_load(crane)
    setting = crane.max_displacement / CM3_PER_REV
    motion = (
        "sea: {kind: regular, amplitude: 1.0, period: 10}    # m, s; or jonswap: significant_height, peak_period"
        if mode == "ahc"
        else "profile:                        # each speed hoisted and lowered\n"
        "  pump_shares: [0.02, 0.05, 0.1, 0.25, 0.5, 0.9]   # of the pump's flow; or plateaus: speeds in rad/s\n"
        "  hold: 6.5                     # s\n  ramp: 1.5\n  rest: 1.5"
    )
    return f"""# Written by winch-friction init scenario. All keys: docs/simulation.md, scenario.schema.json.
schema: winch_friction.scenario/1
name: {_text(name)}
crane: {_text(crane.name)}             # simulating another crane is refused
plant: {_text(plant)}
duration: {240 if mode == "ahc" else 120}                   # s
mode: {mode}                       # normal: one group; ahc: active and passive motors
load: {{value: {mass:.3g}, unit: t}}     # whole hanging mass, hook included
displacement: {{value: {setting:.4g}, unit: cm^3/rev}}   # per driven motor
wire_layer: {len(crane.drum.layer_radii)}                  # from 1, innermost first
wire_out: 50                   # m
oil_temperature: {{start: 40}}   # degC
{motion}
sensors: {{rate: 50}}            # Hz; noise, delay, skew, offsets, drop-outs: docs/simulation.md
"""


def _usual_load(crane: Crane) -> float:
    """A third of what the motors hold at 275 bar on the outer layer, t."""
    torque = max(crane.groups.values()) * crane.max_displacement * PASSIVE_PRESSURE * crane.gear_ratio
    return torque / (3.0 * GRAVITY * crane.drum.layer_radii[-1]) / 1e3


def map_text(crane: Any) -> str:
    """A map to be filled in."""
    groups = list(crane.groups) if crane is not None else ["main"]
    entries = "\n".join(
        f"  {group}.{channel}: {{from: COLUMN, unit: {unit}}}"
        for group in groups
        for channel, unit in (("pressure_a", "bar"), ("pressure_b", "bar"), ("displacement", "cm^3/rev"))
    )
    named = f"crane: {_text(crane.name)}\n" if crane is not None else ""
    return f"""# Written by winch-friction init map: fill in COLUMN with the log's own names, remove the rest.
# winch-friction import LOG --propose --crane CRANE --map MAP.yaml looks at the log and writes all this itself.
schema: winch_friction.map/1
{named}time: {{from: [COLUMN], form: seconds, unit: s}}
columns:
  motor_speed: {{from: COLUMN, unit: rpm, sign: 1}}   # positive must mean hoisting
{entries}
  hook_load: {{from: COLUMN, unit: t}}                # the whole hanging mass
"""
