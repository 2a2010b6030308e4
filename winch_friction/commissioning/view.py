"""A run in blocks of a fifth of a second: what the balance and the comparison of speeds are reckoned on."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from winch_friction.physics.channels import GRAVITY, LIMITS
from winch_friction.physics.signals import FloatArray, Run
from winch_friction.physics.winch.crane import Crane

BLOCK = 0.2  # s; shorter than any ramp of a winch, long enough to average an encoder's steps
MOST_BLOCKS = 600  # per run; evenly thinned beyond, so that a dozen runs are checked within a second
BROKEN_SHARE = 0.02  # of a channel's samples beyond what a sensor can say: broken cells; more: a wrong unit
SEEN_SHARE, LEAST_SHARE = 1.5, 0.3  # a winch tested at half its load errs by half; an empty hook's errors stay
# a direction is certain among neighbours: of a wave of 4 s blocks of 0.8 s and more show each way too seldom for them.
# Longer runs are thinned by stretches of 2 s, of which the inner blocks keep theirs
SPARSE, STRETCH = 4, 10  # blocks
MOVING = 0.03  # of the run's largest speed: slower blocks have no certain direction
MOST_NUMBER = 1e12  # in any SI unit: channels without a limit of their own (a Unix time, a shaft angle) stay below
WRAPS = 2.05 * np.pi  # rad; an angle that stays within one turn wraps around and tells no rate


@dataclass(frozen=True)
class GroupView:
    """One motor group: number of motors, pressure drop Pa, p_A + p_B Pa, displacement m^3/rad per motor."""

    count: float
    drop: FloatArray
    pressure_sum: FloatArray
    displacement: FloatArray

    @property
    def torque(self) -> FloatArray:
        """n D dp, N m."""
        return self.count * self.displacement * self.drop


@dataclass(frozen=True)
class RunView:
    """A run as the crane explains it, in blocks; SI.

    `load` is NaN where it is not logged; `load_torque` N m at the shaft stands in for it where it is measured. `rates`
    are other channels' words on the speed: shaft speed rad/s (`shaft_angle`, `speed_reference`), the drum's rad/s
    (`drum_speed`) or wire speed m/s, up positive (`wire_out`, `heave_velocity`). `wire` is the weight of the wire paid
    out, N; None where it is not known.
    `bounce` is the frequency rad/s at which the load swings on its wire; 0 where crane file or log do not tell.
    """

    name: str
    time: FloatArray
    speed: FloatArray
    acceleration: FloatArray
    load: FloatArray
    layer: FloatArray
    radius: FloatArray
    gear_ratio: float
    inertia: float
    motors: float
    max_displacement: float
    heave: FloatArray | None
    heave_acceleration: FloatArray
    groups: Mapping[str, GroupView]
    motor_torque: FloatArray | None = None
    load_torque: FloatArray | None = None
    oil: FloatArray | None = None
    rates: Mapping[str, FloatArray] = field(default_factory=dict)
    wire: FloatArray | None = None
    bounce: float = 0.0
    seen_torque: float = np.inf  # N m, the largest of all runs

    @property
    def lever(self) -> FloatArray:
        """Metres of wire per radian of the motor shaft."""
        return self.radius / self.gear_ratio

    @property
    def drive_torque(self) -> FloatArray:
        """Torque of all motors at the shaft, N m."""
        if self.motor_torque is not None:
            return self.motor_torque * self.motors
        return np.asarray(sum(group.torque for group in self.groups.values()))

    @property
    def error_torque(self) -> float:
        """The scale of ordinary errors, N m: what the runs made of the rated torque, but never a small part of it."""
        return float(np.clip(SEEN_SHARE * self.seen_torque, LEAST_SHARE * self.rated_torque, self.rated_torque))

    @property
    def rated_torque(self) -> float:
        """What all motors give at 300 bar, or what was seen where the drive is electric; N m."""
        if self.groups and self.max_displacement > 0.0:
            return sum(group.count for group in self.groups.values()) * self.max_displacement * 300e5
        seen = np.abs(self.drive_torque)
        return float(np.nanpercentile(seen, 98)) if np.isfinite(seen).any() else 1.0

    @property
    def moving(self) -> np.ndarray:
        """Blocks whose direction is certain: neither they nor their neighbours are slow or of another direction."""
        slow = np.abs(self.speed) <= MOVING * np.nanmax(np.abs(self.speed), initial=1e-9)
        sign = np.sign(self.speed)
        turned = np.zeros(len(sign), bool)
        turned[1:] = sign[1:] != sign[:-1]
        turned[:-1] |= turned[1:]
        return ~(slow | turned) & np.isfinite(self.speed)

    def on(self, crane: Crane) -> "RunView":
        """The same record as another crane would explain it; raises `InputError` where it has not these groups."""
        groups = {name: replace(g, count=float(crane.motor_count(name))) for name, g in self.groups.items()}
        return replace(
            self,
            radius=_radius(self.layer, crane),
            gear_ratio=crane.gear_ratio,
            inertia=crane.inertia,
            groups=groups,
            motors=float(crane.motor_total(tuple(groups))),
            max_displacement=crane.max_displacement,
        )


def view_of(run: Run, crane: Crane) -> RunView:
    """A run in blocks; broken cells are left out, whole channels of a wrong unit are not."""
    blocks = _Blocks(run)
    names = [g for g in run.groups if g in crane.groups]
    groups = {name: _group(blocks, name, float(crane.motor_count(name))) for name in names}
    speed = blocks.mean("motor_speed")
    time = blocks.time
    heave = blocks.mean("heave_velocity") if "heave_velocity" in run else None
    layer = np.round(blocks.mean("wire_layer"))
    view = RunView(
        name=run.name,
        time=time,
        speed=speed,
        acceleration=_slope(speed, time),
        load=blocks.mean("hook_load"),
        layer=layer,
        radius=_radius(layer, crane),
        gear_ratio=crane.gear_ratio,
        inertia=crane.inertia,
        motors=float(crane.motor_total(tuple(names))),
        max_displacement=crane.max_displacement,
        heave=heave,
        heave_acceleration=np.zeros(len(time)) if heave is None else np.nan_to_num(_slope(heave, time)),
        groups=groups,
        motor_torque=None if crane.drive.hydraulic else _measured_torque(blocks, crane),
        load_torque=_load_torque(blocks, crane, layer),
        oil=blocks.mean("oil_temperature") if "oil_temperature" in run else None,
        rates=_rates(blocks, heave),
        bounce=_bounce(blocks, crane),
        wire=crane.wire_mass * GRAVITY * blocks.mean("wire_out") if "wire_out" in run and crane.wire_mass else None,
    )
    return _thinned(view)


def views_of(runs: Sequence[tuple[Run, Crane]]) -> list[RunView]:
    """The runs in blocks, each knowing the largest torque of all of them."""
    views = [view_of(run, crane) for run, crane in runs]
    with np.errstate(all="ignore"):
        seen = [float(np.nanpercentile(np.abs(v.drive_torque), 98)) for v in views if np.isfinite(v.drive_torque).any()]
    largest = max(seen, default=np.inf)
    return [replace(view, seen_torque=largest) for view in views]


def _bounce(blocks: "_Blocks", crane: Crane) -> float:
    mass, length = (blocks.mean(name) for name in ("hook_load", "wire_out"))
    if not (np.isfinite(mass).any() and np.isfinite(length).any() and np.isfinite(crane.wire_stiffness)):
        return 0.0
    springs = float(np.nanmedian(mass)) * float(np.nanmedian(length)) / crane.wire_stiffness
    return springs**-0.5 if springs > 0.0 else 0.0


class _Blocks:
    """Block means of a run's columns."""

    def __init__(self, run: Run) -> None:
        self.run = run
        time = run.time
        step = float(np.median(np.diff(time))) if len(time) > 1 else BLOCK
        self.length = max(BLOCK, step)
        # a wrong clock (ms read as s) may span days: never more blocks than samples
        self.length = max(self.length, float(time[-1] - time[0]) / max(len(time), 1))
        self.index = np.floor((time - time[0]) / self.length + 1e-9).astype(int)
        self.size = int(self.index[-1]) + 1
        self.time = time[0] + (np.arange(self.size) + 0.5) * self.length

    def mean(self, column: str) -> FloatArray:
        """Means of a column, NaN where a block has no value or the run no such column."""
        if column not in self.run:
            return np.full(self.size, np.nan)
        return self.of(usable(column, self.run[column]))

    def of(self, values: FloatArray) -> FloatArray:
        """Means of any values along the run."""
        good = np.isfinite(values)
        count = np.bincount(self.index[good], minlength=self.size)
        total = np.bincount(self.index[good], values[good], minlength=self.size)
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.where(count > 0, total / count, np.nan)


def broken_cells(column: str, values: FloatArray) -> np.ndarray:
    """Indices of the few cells beyond what a sensor can say; none where the whole channel is (a wrong unit)."""
    lower, upper = LIMITS.get(column.rpartition(".")[2], (-MOST_NUMBER, MOST_NUMBER))
    lower, upper = max(lower, -MOST_NUMBER), min(upper, MOST_NUMBER)
    beyond = np.flatnonzero((values < lower) | (values > upper))
    return beyond if beyond.size <= max(BROKEN_SHARE * len(values), 1) else beyond[:0]


def usable(column: str, values: FloatArray) -> FloatArray:
    """A column without its broken cells."""
    bad = broken_cells(column, values)
    if not bad.size:
        return values
    values = values.copy()
    values[bad] = np.nan
    return values


def _group(blocks: _Blocks, name: str, count: float) -> GroupView:
    a, b = blocks.mean(f"{name}.pressure_a"), blocks.mean(f"{name}.pressure_b")
    return GroupView(count, a - b, a + b, blocks.mean(f"{name}.displacement"))


def _radius(layer: FloatArray, crane: Crane) -> FloatArray:
    """Rope radius along the record; a layer that the drum has not counts as its nearest (the range check says so)."""
    radii = np.array(crane.drum.layer_radii)
    known = np.where(np.isfinite(layer), layer, len(radii))
    return radii[np.clip(known.astype(int), 1, len(radii)) - 1]


def _measured_torque(blocks: _Blocks, crane: Crane) -> FloatArray:
    """Torque per motor of a drive without pressures, N m."""
    channels = {name: usable(name, blocks.run[name]) for name in (*crane.drive.channels, "motor_speed")}
    run = replace(blocks.run, columns={**blocks.run.columns, **channels})
    return blocks.of(np.asarray(crane.drive.of_run(run, crane), float)) / crane.motor_total(())


def _load_torque(blocks: _Blocks, crane: Crane, layer: FloatArray) -> FloatArray | None:
    if "load_torque" in blocks.run:
        return blocks.mean("load_torque")
    if "rope_force" in blocks.run:
        return blocks.mean("rope_force") * _radius(layer, crane) / crane.gear_ratio
    return None


def _rates(blocks: _Blocks, heave: FloatArray | None) -> dict[str, FloatArray]:
    run, rates = blocks.run, {}
    if "speed_reference" in run:
        rates["speed_reference"] = blocks.mean("speed_reference")
    if "shaft_angle" in run and np.ptp(usable("shaft_angle", run["shaft_angle"])) > WRAPS:
        rates["shaft_angle"] = _slope(blocks.mean("shaft_angle"), blocks.time)
    if "drum_speed" in run:  # beside the motor's, which alone is used
        rates["drum_speed"] = blocks.mean("drum_speed")
    if "wire_out" in run:
        rates["wire_out"] = -_slope(blocks.mean("wire_out"), blocks.time)
    if heave is not None:
        rates["heave_velocity"] = -heave
    return rates


def _slope(values: FloatArray, time: FloatArray) -> FloatArray:
    return np.gradient(values, time) if len(values) > 2 else np.zeros(len(values))


def _thinned(view: RunView) -> RunView:
    step = -(-len(view.time) // MOST_BLOCKS)
    if step < SPARSE:
        return view if step < 2 else select(view, slice(None, None, step))
    return select(view, np.arange(len(view.time)) // STRETCH % step == 0)


def select(view: RunView, keep: slice | np.ndarray) -> RunView:
    """Some blocks of a view."""

    def cut(values: FloatArray | None) -> FloatArray | None:
        return None if values is None else values[keep]

    return replace(
        view,
        time=view.time[keep],
        speed=view.speed[keep],
        acceleration=view.acceleration[keep],
        load=view.load[keep],
        layer=view.layer[keep],
        radius=view.radius[keep],
        heave=cut(view.heave),
        heave_acceleration=view.heave_acceleration[keep],
        motor_torque=cut(view.motor_torque),
        load_torque=cut(view.load_torque),
        wire=cut(view.wire),
        oil=cut(view.oil),
        groups={
            name: replace(g, drop=g.drop[keep], pressure_sum=g.pressure_sum[keep], displacement=g.displacement[keep])
            for name, g in view.groups.items()
        },
        rates={name: values[keep] for name, values in view.rates.items()},
    )
