"""From a measured run to what every candidate reads."""

from collections.abc import Hashable, Iterable, Mapping
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from typing import Any

import numpy as np
from scipy.ndimage import binary_opening, maximum_filter1d

from winch_friction.discrepancy.engine.noise import Made
from winch_friction.discrepancy.preparation.balance import SHOWS, SPARSEST, Accounted, Balance, Balancing, Groups
from winch_friction.discrepancy.preparation.grid import SIMPSON, Grid, smoothing_of, spikes_of
from winch_friction.discrepancy.preparation.motors import GroupSignals
from winch_friction.discrepancy.preparation.seen import Motion, Seen, see, shared
from winch_friction.discrepancy.preparation.suspended_load import (
    FEWEST_MOVING,
    USUAL_DAMPING,
    Mode,
    SuspendedLoad,
    beside_holes,
    load_seen,
    rung_out,
    settled,
    swinging_mass,
)
from winch_friction.discrepancy.preparation.wire_mode import Swing, swing_share, swinging_load, wire_stiffnesses
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.channels import BAR, CM3_PER_REV, GRAVITY
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.friction.model import completed
from winch_friction.physics.friction.symbols import WINCH_SIGNALS
from winch_friction.physics.signals import FloatArray, Run
from winch_friction.physics.winch import Crane

AS_LOGGED = ("oil_temperature", "wire_layer", "wire_out", "heave_velocity")
# how people read a signal: factor and unit, by the last part of its name
READ_AS = {
    "pressure": (1.0 / BAR, "bar"), "displacement": (1.0 / CM3_PER_REV, "cm^3/rev"), "hook_load": (1e-3, "t"),
    "motor_speed": (1.0, "rad/s"), "acceleration": (1.0, "rad/s^2"), "oil_temperature": (1.0, "degC"),
    "wire_out": (1.0, "m"), "heave_velocity": (1.0, "m/s"), "shaft_angle": (1.0, "rad of drum"), "time": (1.0, "s"),
}  # fmt: skip
# share of a torque's second difference that is lost where it bends between samples: half of it where a speed is a mean
# over its period; nulls at 10 Hz, rigid wires in irregular seas, lost 0.06 to 0.08
BENT_AWAY = 1.0 / 12.0
TURNS = 0.5  # rad of the wire's mode in a sample, from where on its swing bends between samples at any rate
FOLLOWED_FOR = 0.5  # s without a bend, for samples to count
LEAST_FOLLOWED = 0.05  # of a run's moving samples; what is less is no part of the motion, but where it turns
BOTH_SIDES = 0.99  # of two samples that are in the regime or not, as a line between them says: only 1 is both
HEAVIER = 0.01  # relative change of the drum torque for a derivative of the friction: small, but far above rounding
DRUM_TORQUE = [signal.name for signal in WINCH_SIGNALS].index("drum_torque")


@dataclass(frozen=True)
class PreparedRun:
    """A run on a uniform grid; SI. `gap` is measured minus predicted drive torque at the shaft in N m."""

    name: str
    start: float  # absolute time of the first sample, s
    dt: float
    time: FloatArray
    speed: FloatArray
    acceleration: FloatArray
    direction: FloatArray
    angle: FloatArray
    load: FloatArray
    tension_measured: bool  # the load is a measured force, which has its mass's inertia in it
    load_acceleration: FloatArray
    radius: FloatArray
    drum_torque: FloatArray
    groups: tuple[GroupSignals, ...]
    model: FrictionModel
    point: tuple[Any, ...]
    states: tuple[FloatArray, ...]  # of the model's terms with memory
    gap: FloatArray
    wire_mode: Mode  # of the load on its wire
    swinging: float  # kg on the wire, while its mode is sought
    swing_left: tuple[float, ...]  # share of what may swing that a swing of each damping ratio would leave
    swing_noise: bool  # whether what swings in the load's acceleration is in the sensors alone
    swing_variance: float  # of what may swing, in the gap's unit squared; 0 where the mode was given
    predicted: FloatArray  # drive torque of the base model, N m
    from_speed: FloatArray  # what of it the shaft's speed tells, N m: all but the acceleration of the heaving crane
    corrections: FloatArray  # change of the gap in N m per unit of each correction of the model, (samples, corrections)
    gear_ratio: float
    inertia: float
    rated_torque: float  # N m at the motor shaft under the rated load on the outermost layer; 0 where nobody rates it
    constants: tuple[tuple[str, float], ...]  # for the candidates' equations
    unit_torque: float  # N m per bar of the balancing group (1 for an electric drive)
    used: np.ndarray  # samples of the regime: moving, or just reversed
    spikes: np.ndarray
    present: frozenset[str]  # columns that the file had; `hook_load` also where a measured force stands for it
    channels: Mapping[str, FloatArray]  # what a gap may depend on, for locating it
    seen: Seen | None = None  # for preparing the same run once more; None where nobody will
    window: int = 1  # samples that speed and torque were smoothed over
    # means of columns over its blocks, for whoever asks for the same ones again; of this very run, and of no copy
    means: dict[Hashable, Any] = field(default_factory=dict, init=False, repr=False, compare=False)

    @property
    def kind(self) -> tuple[str, ...]:
        """Names of the motor groups, by which hoisting and heave compensation are told apart."""
        return tuple(group.name for group in self.groups)

    @property
    def drive_torque(self) -> FloatArray:
        """What the drive gave as it was measured, N m at the shaft."""
        return self.gap + self.predicted

    @property
    def jacobian(self) -> FloatArray:
        """Partial derivatives of the model's torque by its parameters, N m per unit, shape (samples, parameters): a
        third of all that a run would hold, for one who asks once."""
        return self.model.jacobian(self.point, self.states)

    def made(self, size: int) -> Made | None:
        """How a block of `size` samples is made of those of a log so slow that neighbours share some."""
        if self.dt <= SPARSEST:  # four samples and more make a block: its noise is as good as white
            return None
        sample = np.convolve(smoothing_of(self.window), SIMPSON)
        return Made(size, tuple(np.convolve(sample, np.full(size, 1.0 / size)).tolist()))

    @cached_property
    def load_friction(self) -> FloatArray:
        """Friction torque per relative change of the drum torque, N m."""
        more = tuple((1.0 + HEAVIER) * values if k == DRUM_TORQUE else values for k, values in enumerate(self.point))
        heavier, as_it_is = (np.asarray(self.model.torque(x, self.states)) for x in (more, self.point))
        return np.asarray((heavier - as_it_is) / HEAVIER)

    @cached_property
    def top_speed(self) -> float:
        """Largest speed but for outliers, rad/s: a hundred laws ask for it."""
        return float(np.percentile(np.abs(self.speed), 99))

    def at(self, samples: np.ndarray | slice) -> "PreparedRun":
        """What a law without memory reads of these samples alone: operating point, states and time."""
        point, states = samples_of_each(self.point, samples), samples_of_each(self.states, samples)
        return replace(self, time=self.time[samples], point=point, states=states)

    def used_at(self, time: FloatArray) -> np.ndarray:
        """Whether instants, in s from the origin of the run's own time, lie between two samples of the regime."""
        return np.asarray(np.interp(time, self.time + self.start, self.used.astype(float)) > BOTH_SIDES)

    def sharing(self, other: "PreparedRun") -> "PreparedRun":
        """The same run, with the arrays of another that hold the same to the bit: most do not depend on the model, and
        an hour of all of them is 90 MB."""
        return replace(self, **{each.name: shared(getattr(self, each.name), getattr(other, each.name))
                                for each in fields(self) if each.init})  # fmt: skip


def samples_of_each(arrays: Iterable[Any], samples: np.ndarray | slice) -> tuple[Any, ...]:
    """These samples of each; what is one number for a whole run stays one."""
    return tuple(each[samples] if isinstance(each, np.ndarray) and each.ndim else each for each in arrays)


def prepare(
    run: Run,
    crane: Crane,
    model: FrictionModel,
    load: float = float("nan"),
    accounted: Accounted | None = None,
    turning: bool = False,
    mode: Mode | None = None,
    spikes: np.ndarray | None = None,
    seen: Seen | None = None,
    before: PreparedRun | None = None,
    wire: float = 0.0,
) -> PreparedRun:
    """Everything the workflow derives from one run; `load` kg where the run has no `hook_load`.

    With what is `accounted` for already, on the run's uniform grid, the pressures that friction is reckoned with come
    close to the true ones. `turning` takes direction and travel from the angle and marks the samples just after
    reversals instead of the moving ones. `mode` is that of the load on its wire if known; otherwise it is looked for,
    with `wire` kg of its own hanging there. `spikes` marks samples to leave out, looked for unless given. What was
    `seen` of this run does not depend on the model; of one as another saw it `before`, what is the same is held once.
    Raises `InputError` for a run that is too short or lacks a channel that the torque balance needs.
    """
    seen = see(run, crane, turning, before.seen if before is not None else seen)
    grid, motion = seen.grid, seen.motion
    balancing = Balancing(run, crane, model, seen, accounted or Accounted())
    swing, hanging, balance = _on_wire(balancing, load_seen(seen, crane, load), mode, wire)
    mode = swing.mode
    used = (
        motion.used
        & settled(grid, mode)
        & rung_out(grid, mode, balance.gap, motion.used)
        & beside_holes(grid, mode, balance.gap, motion.used)
        & balancing.known
        & _followed(grid, motion, hanging, balance, crane, mode)
    )
    if spikes is None:
        spikes = spikes_of(balance.gap, used, grid.dt)
    prepared = PreparedRun(
        name=run.name, start=float(run.time[0]), dt=grid.dt, time=grid.time, speed=motion.speed,
        acceleration=motion.acceleration, direction=motion.direction, angle=motion.angle, load=hanging.mass,
        tension_measured=hanging.tension_measured, load_acceleration=hanging.acceleration, radius=hanging.radius,
        drum_torque=hanging.drum_torque,
        groups=balance.groups, model=model, point=balance.point, states=balance.states, gap=balance.gap, wire_mode=mode,
        swinging=swinging_mass(float(np.median(hanging.mass)), wire), swing_left=swing.left,
        swing_variance=swing.variance / balance.unit_torque**2, swing_noise=swing.noise,
        predicted=balance.predicted,
        corrections=np.empty((len(grid.time), 0)),
        from_speed=balance.simulated_torque - hanging.heave_torque, gear_ratio=crane.gear_ratio, inertia=crane.inertia,
        rated_torque=crane.rated_load * GRAVITY * max(crane.drum.layer_radii) / crane.gear_ratio,
        constants=tuple(sorted(completed(model, crane).constants.items())), unit_torque=balance.unit_torque,
        used=used & grid.valid & ~spikes & hanging.on_one_layer(motion.angle, crane.gear_ratio),
        spikes=spikes, present=frozenset(run.columns) | ({"hook_load"} if hanging.tension_measured else set()),
        channels=channels_of(run, grid, motion, hanging, balance.groups, crane), seen=seen,
        window=motion.window,
    )  # fmt: skip
    return prepared if before is None else prepared.sharing(before)


def _on_wire(
    balancing: Balancing, load: SuspendedLoad, mode: Mode | None, wire: float
) -> tuple[Swing, SuspendedLoad, Balance]:
    """The wire's mode, looked for unless given, what others would leave, the load behind it and the balance with it."""
    if mode is None:
        rigid = balancing.of(load)
        swing = _wire_mode(balancing, load, rigid, wire)
        if swing.mode.damping <= 0.0:
            return swing, load, rigid
    else:
        swing = Swing(mode)
    hanging = load.on_wire(balancing.grid.dt, swing.mode, balancing.grid.columns.get("wire_out"))
    return swing, hanging, balancing.of(hanging)


def _wire_mode(balancing: Balancing, load: SuspendedLoad, rigid: Balance, wire: float) -> Swing:
    """Frequency and damping of the load's swinging, where the wire's stiffness is known, and what other dampings would
    leave."""
    mass, motion, columns = float(np.median(load.mass)), balancing.motion, balancing.grid.columns
    if not np.isfinite(balancing.crane.wire_stiffness) or mass <= 0.0:
        return Swing(Mode(0.0, 0.0))
    stiffness = balancing.crane.wire_stiffness * mass / swinging_mass(mass, wire)  # a lighter load swings faster
    stiffnesses = wire_stiffnesses(stiffness, columns.get("wire_out"))
    slowest = Mode(float(np.sqrt(min(stiffnesses) / mass)), USUAL_DAMPING)
    counts = motion.used & settled(balancing.grid, slowest)
    if counts.sum() < FEWEST_MOVING:
        return Swing(Mode(0.0, 0.0))
    # an inertia that is wrong hides a swing, and beside one that is right its column takes a part of the swing
    swing = swinging_load(
        rigid.gap, counts, load.acceleration, balancing.grid.dt, mass, load.lever, stiffnesses,
        friction=_other_causes(balancing, load, rigid), hiding=motion.acceleration[:, None],
        length=columns.get("wire_out"), share=swing_share(mass, wire),
    )  # fmt: skip
    known = "wire_out" in columns and swing.mode.damping <= 0.0
    mode = Mode(float(np.sqrt(stiffnesses[0] / mass)), 0.0) if known else swing.mode
    return replace(swing, mode=mode._replace(share=swing_share(mass, wire)))


def _other_causes(balancing: Balancing, load: SuspendedLoad, rigid: Balance) -> FloatArray:
    """What else a gap may hold, in columns: friction by speed, and a delay of the speed or of the pressures."""
    motion = balancing.motion
    shifts = np.gradient(rigid.predicted - load.heave_torque), np.gradient(rigid.predicted)
    return np.column_stack([motion.speed, motion.direction * motion.speed**2, *shifts])


def _followed(
    grid: Grid, motion: Motion, load: SuspendedLoad, balance: Balance, crane: Crane, mode: Mode
) -> np.ndarray:
    """Samples in which a slow log can follow what inertia takes: between two of them it bends by less than shows.

    Of a drive without pressures all of them: what its current or power tells is rougher than what is lost.
    """
    rings = mode.damping > 0.0 and mode.frequency * grid.dt > TURNS
    if not crane.drive.hydraulic or (grid.dt <= SPARSEST and not rings):
        return np.ones(len(grid.time), bool)
    torque = np.pad(crane.inertia * motion.acceleration + load.inertial_torque, 1, mode="edge")
    bend = maximum_filter1d(np.abs(np.diff(torque, 2)), 3)
    followed = BENT_AWAY * bend <= SHOWS * LIMITS.least_noise * balance.unit_torque
    # a sample or two between many that it cannot follow are turning points, and no place where it can
    followed = binary_opening(followed, np.ones(max(round(FOLLOWED_FOR / grid.dt), 1), bool))
    return np.asarray(followed & (followed[motion.used].mean() >= LEAST_FOLLOWED if motion.used.any() else True))


def channels_of(
    run: Run, grid: Grid, motion: Motion, load: SuspendedLoad, groups: Groups, crane: Crane
) -> Mapping[str, FloatArray]:
    """Signals over the grid by name; predicted pressures stand for the measured ones, the angle is the drum's, rad."""
    found: dict[str, FloatArray] = {"motor_speed": np.abs(motion.speed), "acceleration": motion.acceleration}
    if crane.drive.hydraulic or load.tension_measured or "hook_load" in grid.columns:
        found["hook_load"] = load.mass
    for group in groups:
        found[f"{group.name}.pressure"] = group.pressure
        found[f"{group.name}.displacement"] = group.displacement
    found |= {name: grid.columns[name] for name in AS_LOGGED if name in grid.columns}
    found["shaft_angle"] = np.mod(motion.angle / crane.gear_ratio, 2.0 * np.pi)
    found["time"] = grid.time
    return found | _aside(run, grid)


def _aside(run: Run, grid: Grid) -> dict[str, FloatArray]:
    """Numeric columns that the package does not know."""
    columns = {name: np.asarray(values) for name, values in run.aside.items()}
    return {
        name: np.interp(grid.time, run.time - run.time[0], np.nan_to_num(values.astype(float)))
        for name, values in columns.items()
        if values.dtype.kind in "fiu" and len(values) == len(run)
    }
