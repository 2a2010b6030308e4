"""The crane file of `init crane`: the facts that it needs, of each kind of drive, and its text.

The rules scale crane_150t by size: inertia with the motors' total displacement to the power 5/3, a wire with its
diameter squared. Of a drive that is not hydraulic nothing is scaled but the torque that the rated load takes.
A load in n falls is at the drum what one on a single fall of n-th radius is: torque, speed and inertia alike. There the
falls are n ropes side by side, n times as heavy and as stiff.
"""

import json
from dataclasses import dataclass

import yaml

from winch_friction.physics.channels import CM3_PER_REV, GRAVITY
from winch_friction.physics.errors import InputError
from winch_friction.physics.winch.crane import CURRENT, HYDRAULIC, KINDS

# what the rules scale: crane_150t
MOTORS, DISPLACEMENT, GEAR = 11, 215.0, 250.0  # cm^3/rev
INERTIA, TORQUE_LIMIT = 1.54, 2000.0  # kg m^2, N m
WIRE, WIRE_MASS, WIRE_STIFFNESS = 77.0, 24.5, 3.0e8  # mm, kg/m, N

# what is built, generously: beyond it a figure was meant in another unit
USUAL = {"displacement": (5.0, 5000.0, "cm^3/rev"), "radius": (0.05, 5.0, "m"), "wire": (2.0, 300.0, "mm")}
TORQUE_SHARE = 0.3  # of the rated load's torque at the shaft: crane_150t's bound of a feedforward
HOLDS = (0.5, 10.0)  # of the rated load; the shipped crane's motors hold 1.7 times theirs


@dataclass(frozen=True)
class CraneFacts:
    """What a crane file needs to be told; of a hydraulic one `inertia` kg m^2 or None for an estimate."""

    name: str
    load: float
    motors: int
    gear_ratio: float
    radius: float
    layers: int
    wire: float
    displacement: float | None = None
    active: int = 0
    inertia: float | None = None
    drive: str = HYDRAULIC
    torque_constant: float | None = None
    falls: int = 1
    rated_speed: float | None = None  # rpm
    rated_pressure: float | None = None  # bar

    def __post_init__(self) -> None:
        wanted = set(wanted_of(self.drive))
        foreign = {name for name, drives in _OF_ONE_DRIVE.items() if self.drive not in drives} - {"inertia"}
        wrong = [f"--{_flag(each)} is not of --drive {self.drive}" for each in sorted(foreign) if getattr(self, each)]
        numbers = ("load", "motors", "displacement", "gear_ratio", "radius", "layers", "wire", "inertia",
                   "torque_constant", "falls", "rated_speed", "rated_pressure")  # fmt: skip
        values = {name: getattr(self, name) for name in numbers if name in wanted or getattr(self, name) is not None}
        wrong += [f"--{_flag(name)} {value!r} must be above 0" for name, value in values.items()
                  if value is None or not 0 < value < float("inf")]  # fmt: skip
        if self.motors > 0 and not 0 <= self.active < self.motors:
            wrong.append(
                f"--active {self.active} must be 0 ... {self.motors - 1}: the others are passive; where all of them "
                "compensate they are one group: 0"
            )
        wrong += [] if wrong else self._unlikely()
        if wrong:
            raise InputError(*(f"init crane: {each}" for each in wrong))

    def _unlikely(self) -> list[str]:
        """Figures that are another unit's: outside what is built, or motors that cannot hold the rated load."""
        found = [
            f"--{name} {getattr(self, name):g} is outside {low:g} ... {high:g} {unit}"
            for name, (low, high, unit) in USUAL.items()
            if getattr(self, name) is not None and not low <= getattr(self, name) <= high
        ]
        if self.displacement is None:
            return found
        share = self.holds / self.load
        if not found and not HOLDS[0] <= share <= HOLDS[1]:
            found.append(
                f"at 300 bar these motors hold {self.holds:.3g} t, {share:.2g} times the rated load of {self.load:g} "
                "t: look at --displacement (per motor), --motors, --gear-ratio, --radius and --falls again"
            )
        return found

    @property
    def radii(self) -> list[float]:
        """Rope radius of each layer over the number of falls, m."""
        return [(self.radius + 0.87 * 1e-3 * self.wire * k) / self.falls for k in range(self.layers)]

    @property
    def holds(self) -> float:
        """What all motors hold at 300 bar on the outermost layer, t."""
        displacement = self.motors * (self.displacement or 0.0) * CM3_PER_REV
        return displacement * 300e5 * self.gear_ratio / (GRAVITY * self.radii[-1]) / 1e3


# what only some drives are described by
_OF_ONE_DRIVE = {"displacement": (HYDRAULIC,), "active": (HYDRAULIC,), "rated_pressure": (HYDRAULIC,),
                 "torque_constant": (CURRENT,),
                 "inertia": tuple(kind for kind in KINDS if kind != HYDRAULIC)}  # fmt: skip


def wanted_of(drive: str) -> list[str]:
    """Names of the facts that a crane of this drive needs; raises `InputError` for no kind of drive.

    The inertia of a hydraulic winch is scaled from one that is known; of others none is, but a motor's sheet says it.
    """
    if drive not in KINDS:
        raise InputError(f"--drive {drive}: use {', '.join(KINDS)}")
    every = ("name", "load", "motors", "displacement", "gear_ratio", "radius", "layers", "active", "wire", "inertia",
             "torque_constant")  # fmt: skip
    return [name for name in every if drive in _OF_ONE_DRIVE.get(name, KINDS)]


def _flag(name: str) -> str:
    return name.replace("_", "-")


def crane_text(f: CraneFacts) -> str:
    """The crane file."""
    wire, radii = f.falls * (f.wire / WIRE) ** 2, f.radii
    falls = f"\n  # {_falls_say(f.falls)}" if f.falls > 1 else ""
    drive, inertia, source, limit, rated = _of_motors(f) if f.displacement else _of_drive(f)
    return f"""# Written by winch-friction init crane. Check what is called an ESTIMATE against the crane's documents.
schema: winch_friction.crane/1
name: {yaml_word(f.name)}
{drive}
gear_ratio: {f.gear_ratio:g}
drum:
  # rope radius per layer in m, innermost first; ESTIMATE beyond the first: 0.87 of a wire diameter per layer{falls}
  layer_radii: [{", ".join(f"{r:.4g}" for r in radii)}]
inertia: {{value: {inertia:.3g}, unit: kg*m^2}}    # at the motor shaft; {source}
wire_mass: {{value: {WIRE_MASS * wire:.3g}, unit: kg/m}}          # ESTIMATE from the diameter
wire_stiffness: {{value: {WIRE_STIFFNESS * wire:.3e}, unit: N}}  # EA, ESTIMATE from the diameter
absolute_torque_limit: {{value: {limit:.3g}, unit: N*m}}   # bound of any feedforward: YOURS to decide
rated_load: {{value: {f.load:g}, unit: t}}          # {rated}
{_ratings(f)}
"""


def _ratings(f: CraneFacts) -> str:
    """What bounds the belief in readings; a line to be filled in of each that nobody has given."""
    slow = "of the motor shaft; of a slow motor, below 955 rpm, it also tells motion from rest"
    known = [("rated_speed", f.rated_speed, 100, "rpm", slow)]
    if f.displacement:
        known.append(("rated_pressure", f.rated_pressure, 350, "bar", "peak of the motors"))
    return "\n".join(
        f"{'' if value else '# '}{name}: {{value: {value or such_as:g}, unit: {unit}}}   # {meaning}"
        for name, value, such_as, unit, meaning in known
    )


def _falls_say(falls: int) -> str:
    return (
        f"DIVIDED by the {falls} falls of the hook; wire_mass and wire_stiffness are of {falls} wires. In runs and "
        f"topics\n  # wire_out is the hook's depth (rope paid out / {falls}), rope_force that of all falls"
    )


def _of_motors(f: CraneFacts) -> tuple[str, float, str, float, str]:
    """Of a hydraulic crane its drive's lines, inertia kg m^2 with its source, torque limit N m, a word on its load."""
    displacement = f.displacement or 0.0
    size = f.motors * displacement / (MOTORS * DISPLACEMENT)
    inertia = f.inertia or INERTIA * f.motors / MOTORS * (displacement / DISPLACEMENT) ** (5.0 / 3.0)
    source = "as given" if f.inertia else "ESTIMATE, scaled from crane_150t: motors, gear and drum, without the load"
    groups = f"  main: {f.motors}"
    if f.active:
        groups += f"\n  active: {f.active}\n  passive: {f.motors - f.active}"
    drive = f"""drive: hydraulic                # electric, power and current: docs/interfaces.md
max_displacement: {{value: {displacement:g}, unit: cm^3/rev}}   # per motor
groups:                         # motors per group: normal winch mode has one group, heave compensation two
{groups}"""
    return drive, inertia, source, TORQUE_LIMIT * size, f"all motors hold {f.holds:.3g} t on the outer layer at 300 bar"


def _of_drive(f: CraneFacts) -> tuple[str, float, str, float, str]:
    """`_of_motors` of a crane whose motors' torque, power or current is logged."""
    torque = f.load * 1e3 * GRAVITY * f.radii[-1] / f.gear_ratio
    kind = f.drive
    if f.drive == CURRENT:
        kind = f"{{kind: current, torque_constant: {f.torque_constant:g}}}   # N m at the motor shaft per A"
    drive = f"""drive: {kind}
groups: {{main: {f.motors}}}               # motors on the shaft"""
    said = f"{torque / f.motors:.3g} N m per motor on the outer layer, without losses"
    return drive, f.inertia or 0.0, "as given", TORQUE_SHARE * torque, said


def yaml_word(word: str) -> str:
    """A word as YAML has it: in quotes where it would be read as something else (`12`, `yes`, `Nord: 7`)."""
    try:
        plain = yaml.safe_load(f"word: {word}") == {"word": word}
    except yaml.YAMLError:
        plain = False
    return word if plain else json.dumps(word, ensure_ascii=False)
