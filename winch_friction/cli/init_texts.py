"""The texts of `init` beside the crane's: every number is derived from it, or said to be an estimate with its rule.

The rules scale crane_150t and the model a6vm215_crane2 (paper 2) by size: volumes and flows with the motors' total
displacement, inertia with its power 5/3, a wire with its diameter squared. They begin a file; they do not measure.
"""

from typing import Any

from winch_friction.cli.init_crane import DISPLACEMENT, GEAR, MOTORS, WIRE_STIFFNESS, yaml_word
from winch_friction.physics.channels import CM3_PER_REV, GRAVITY
from winch_friction.physics.winch.crane import Crane

# what the rules scale beside crane_150t itself: its plant and its model
FLOW, VOLUME, VALVE, PASSIVE, GAS = 0.0445, 0.06, 1.0e-8, 8, 1.6  # m^3/s, m^3, m^3/s/Pa, motors, m^3
LEAKAGE, CASE, DAMPING = 5.0e-12, 5.0e-13, 1.5e5  # m^3/s/Pa, m^3/s/Pa, N s/m
PASSIVE_PRESSURE = 275e5  # Pa, that carries the load in heave compensation
MODEL_SPREAD = 0.3  # relative 1 sigma of a scaled model's parameters: cranes of one size differ by as much


def bare_model_text(crane: Crane, name: str) -> str:
    """A model that assumes nothing: no motor like the crane's is known to scale from."""
    return f"""# Written by winch-friction init model: no friction is assumed. `winch-friction gap` finds it.
schema: winch_friction.model/1
name: {yaml_word(name)}
crane: {yaml_word(crane.name)}
terms: []                       # winch-friction list terms
parameters: {{}}
provenance:
  source: none; no friction is assumed
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
name: {yaml_word(name)}
crane: {yaml_word(crane.name)}             # simulating another crane with it is refused
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
name: {yaml_word(name)}
crane: {yaml_word(crane.name)}
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
name: {yaml_word(name)}
crane: {yaml_word(crane.name)}             # simulating another crane is refused
plant: {yaml_word(plant)}
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
    if crane is not None and not crane.drive.hydraulic:
        return _map_of(crane, _OF_DRIVE[crane.drive.kind])
    groups = list(crane.groups) if crane is not None else ["main"]
    entries = "\n".join(
        f"  {group}.{channel}: {{from: COLUMN, unit: {unit}}}"
        for group in groups
        for channel, unit in (("pressure_a", "bar"), ("pressure_b", "bar"), ("displacement", "cm^3/rev"))
    )
    return _map_of(crane, entries)


_OF_DRIVE = {"electric": "  motor_torque: {from: COLUMN, unit: N*m}              # per motor, positive when it lifts",
             "power": "  mechanical_power: {from: COLUMN, unit: kW}           # of all motors, positive when they lift",
             "current": "  motor_current: {from: COLUMN, unit: A}               # per motor, positive when it lifts",
             }  # fmt: skip


def _map_of(crane: Any, entries: str) -> str:
    named = f"crane: {yaml_word(crane.name)}\n" if crane is not None else ""
    return f"""# Written by winch-friction init map: fill in COLUMN with the log's own names, remove the rest.
# winch-friction import LOG --propose --crane CRANE --map MAP.yaml looks at the log and writes all this itself.
schema: winch_friction.map/1
{named}time: {{from: [COLUMN], form: seconds, unit: s}}
columns:
  motor_speed: {{from: COLUMN, unit: rpm, sign: 1}}   # positive must mean hoisting
{entries}
  hook_load: {{from: COLUMN, unit: t}}                # the whole hanging mass
"""
