"""Can these runs be this crane's? The quick part, which `identify`, `replay` and `gap` ask first.

Every channel by itself, the runs against each other, sensors that are not there, a simulation beside its measurement,
and the single mistakes.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache
from itertools import combinations

import numpy as np

from winch_friction.commissioning.channels import (
    FIRST_READINGS,
    SEVERITIES,
    Finding,
    cell_findings,
    clock_findings,
    first_contradiction,
    frozen_findings,
    group_findings,
    reading_findings,
    runs_say,
    told_slow_clock,
    uneven_once,
)
from winch_friction.commissioning.diagnose import diagnose
from winch_friction.commissioning.kinematics import Fit, agreements, exchanged_columns, fit_of, ways
from winch_friction.commissioning.likeliest import likeliest_mistake
from winch_friction.commissioning.mistakes import LARGEST_TARE, PRESSURE_UNITS
from winch_friction.commissioning.other_cranes import known_cranes, same_machine
from winch_friction.commissioning.view import RunView, views_of
from winch_friction.physics.channels import BAR, GRAVITY, RPM
from winch_friction.physics.corrections import corrected
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import FloatArray, Run
from winch_friction.physics.winch.crane import Crane
from winch_friction.records.runs import MEASURED, apart

# -- runs against each other
FEWEST = 3  # runs of a motor group, for most of them to say what is usual
ALIKE = 1.25  # times: boost pressures of one machine differ by less, most of the time
EXACT = 0.05  # relative, by which a unit's factor is met


def lone_units(runs: Sequence[Run]) -> Iterator[Finding]:
    """Port B of a motor group, whose pressure is the boost's, off by exactly a unit in some of the runs: too little to
    upset the torque balance, and no friction whatever."""
    channels = dict.fromkeys(name for run in runs for name in run.columns if name.endswith(".pressure_b"))
    for channel in channels:
        own = [run for run in runs if channel in run.columns]
        medians = np.array([float(np.nanmedian(run[channel])) for run in own])
        if len(own) < FEWEST or not np.all(medians > 0.0):
            continue
        usual = float(np.median(medians))
        alike = (medians < ALIKE * usual) & (medians > usual / ALIKE)
        if 2 * alike.sum() <= len(own):
            continue
        # the load's pressure at port B is ten times the boost's by chance, and port A has the boost's then
        ports_a = np.array([float(np.nanmedian(run.columns.get(f"{channel[:-1]}a", [np.nan]))) for run in own])
        exchanged = (ports_a < ALIKE * usual) & (ports_a > usual / ALIKE)
        for factor, words in PRESSURE_UNITS:
            odd = ~alike & ~exchanged & (np.abs(medians * factor / usual - 1.0) < EXACT)
            if odd.any():
                names = tuple(run.name for run, off in zip(own, odd, strict=True) if off)
                said = (
                    f"{', '.join(names)}: {channel} is {np.median(medians[odd]) / BAR:.3g} bar, in the other runs "
                    f"{usual / BAR:.3g}: {words} there?"
                )
                yield Finding("error", "unit", said, channel, names, {"factor": factor, "usual": usual})


# -- one recording that is given twice
BIN = 1.0  # s; means over it hardly feel the digits and stamps that another export has rounded
SAME = 2e-3  # of what a channel varies by, noise included, that means of two exports differ by; of two drives more
FEWEST_BINS = 10  # in which both have a value: a piece of so many seconds can be told


def same_recordings(runs: Sequence[Run]) -> list[str]:
    """What is to be said of each two runs of which one is the other once more, or a piece of it, in another export: by
    their clocks or from their beginnings on, speed and torque's channels are the same within the digits."""
    means = [(run, _means(run, 0.0), _means(run, run.time[0])) for run in runs]
    return [
        f"{one.name} and {two.name} seem to be one recording, given twice: what one teaches the other cannot prove; "
        "give each run once"
        for (one, *by_one), (two, *by_two) in combinations(means, 2)
        if any(_same(one, a, b) for a, b in zip(by_one, by_two, strict=True))
    ]


_Means = tuple[FloatArray, dict[str, FloatArray]]


def _means(run: Run, origin: float) -> _Means:
    """Whole bins of time from an origin, and the means of what is measured fast in each of them."""
    bins = np.floor((run.time - origin) / BIN)
    starts = np.concatenate([[0], np.flatnonzero(np.diff(bins)) + 1])
    counts = np.diff(np.concatenate([starts, [len(run)]]))
    inner = slice(1, -1)  # the others may be cut
    names = [name for name in run.columns if name.rpartition(".")[2] in MEASURED]
    return bins[starts][inner], {name: (np.add.reduceat(run[name], starts) / counts)[inner] for name in names}


def _same(run: Run, one: _Means, two: _Means) -> bool:
    """Whether the means of two runs, the first of this one, are the same wherever both have a value."""
    _, a, b = np.intersect1d(one[0], two[0], return_indices=True)
    if len(a) < FEWEST_BINS or one[1].keys() != two[1].keys():
        return False
    for name in one[1]:
        off = one[1][name][a] - two[1][name][b]
        good = np.isfinite(off)
        if good.sum() < FEWEST_BINS or np.sqrt(np.mean(off[good] ** 2)) > SAME * np.nanstd(run[name]):
            return False
    return True


# -- channels that nobody measured
WIRE_MOVED = 0.5  # m of wire that came or went while motor_speed stood: five steps of a coarse counter


def dead_findings(runs: Sequence[Run], views: Sequence[RunView]) -> Iterator[Finding]:
    """A speed that stands while the wire runs, a hook load of nothing while the motors hold tonnes, or below nothing.

    `views` are the runs' own, in their order; both of hydraulic winches. Data with either contradict the crane.
    """
    for run, view in zip(runs, views, strict=True):
        yield from _speed(run)
        yield from _load(run, view)


def _speed(run: Run) -> Iterator[Finding]:
    speed = run["motor_speed"][np.isfinite(run["motor_speed"])]
    if not speed.size or np.ptp(speed) > 0.0 or "wire_out" not in run:
        return
    known = run["wire_out"][np.isfinite(run["wire_out"])]
    moved = float(np.ptp(known)) if known.size else 0.0
    if moved > WIRE_MOVED:
        said = (
            f"{run.name}: motor_speed never changes ({speed[0] / RPM:.3g} rpm) though wire_out moves by "
            f"{moved:.3g} m: is the sensor connected?"
        )
        yield Finding("error", "stuck", said, "motor_speed", (run.name,), {"wire_moved": moved})


def _load(run: Run, view: RunView) -> Iterator[Finding]:
    if "hook_load" not in run or not view.groups:
        return
    load, lever = run["hook_load"][np.isfinite(run["hook_load"])], float(np.median(view.lever))
    held = float(np.nanmean(view.drive_torque)) / (GRAVITY * lever)
    least = LARGEST_TARE * view.rated_torque / (GRAVITY * lever)  # what hook, block and wire may weigh
    if load.size and np.ptp(load) == 0.0 and abs(load[0]) < 0.01 * least < held and held > least:
        said = (
            f"{run.name}: hook_load is {load[0] / 1e3:.3g} t throughout though the motors hold about {held / 1e3:.3g} "
            "t: is the load cell connected? (a known load: import --set 'hook_load.constant=... t')"
        )
        yield Finding("error", "cell", said, "hook_load", (run.name,), {"held": held})
    usual = float(np.median(load)) if load.size else 0.0
    if usual < -least:  # swapped ports would close the balance of a mass that is drawn upwards
        said = (
            f"{run.name}: hook_load is {usual / 1e3:.3g} t, and what hangs has no negative mass: turn its sign (import "
            "--set hook_load.sign=-1)"
        )
        yield Finding("error", "sign", said, "hook_load", (run.name,), {"usual": usual})


# -- a user's own simulation beside the measurement: the same signal in the same unit
SIMULATED = "_simulated"
# times the measured one: without any friction, and with the hook alone, a simulation has still a tenth of it; no
# missing effect makes it twice as large
SMALLEST, LARGEST = 0.05, 2.0
MET = 0.1  # relative, by which a unit's factor is met
UNITS = {1e5: "Pa", 14.5: "psi under [bar]", 100.0: "kPa under [bar]", 10.0: "bar under [MPa]", 0.1: "MPa under [bar]",
         1e-3: "kN under [N]", 1e3: "N under [kN]", 1e-5: "bar under [Pa] (a column without a unit is in SI)",
         1e-6: "MPa under [Pa] (a column without a unit is in SI)"}  # fmt: skip


def simulated_findings(runs: Sequence[Run], hydraulic: bool) -> Iterator[Finding]:
    """Simulated columns that are no such thing: another unit, the other sign, nothing at all.

    Of an electric drive, whose friction may be all of its torque, it is said and refutes nothing.
    """
    for name in dict.fromkeys(name for run in runs for name in run.columns if name.endswith(SIMULATED)):
        having = tuple(run.name for run in runs if name in run and _measured(run, name) is not None)
        ratio = _ratio([run for run in runs if run.name in having], name)
        if ratio is None or SMALLEST < ratio < LARGEST:
            continue
        yield Finding(
            "error" if hydraulic else "warning", "simulation", _words(name, ratio), name, having, {"ratio": ratio}
        )


def _words(name: str, ratio: float) -> str:
    measured = name.removesuffix(SIMULATED).replace("pressure_drop", "pressure_a - pressure_b")
    if ratio == 0.0:
        return f"{name} is 0 where {measured} is not: was it written?"
    unit = next((unit for factor, unit in UNITS.items() if abs(abs(ratio) / factor - 1.0) < MET), "")
    why = "it counts the other way" if ratio < -SMALLEST else ""
    why = " and ".join(filter(None, [why, f"it holds {unit}" if unit else ""])) or "is its unit right?"
    return f"{name} is {ratio:.3g} times {measured} over these runs, which no missing effect makes of it: {why}"


def _ratio(runs: Sequence[Run], name: str) -> float | None:
    """The simulated signal as a multiple of the measured one, by least squares over all runs; None without any."""
    pairs = [(run[name], measured) for run in runs if (measured := _measured(run, name)) is not None]
    if not pairs:
        return None
    simulated, measured = (np.concatenate(each) for each in zip(*pairs, strict=True))
    known = np.isfinite(simulated) & np.isfinite(measured)
    size = float(measured[known] @ measured[known])
    return float(simulated[known] @ measured[known]) / size if size > 0.0 else None


def _measured(run: Run, name: str) -> FloatArray | None:
    """What the simulated column is compared with."""
    own = name.removesuffix(SIMULATED)
    group, _, channel = own.rpartition(".")
    if channel == "pressure_drop":
        ports = [f"{group}.pressure_{port}" for port in "ab"]
        return run[ports[0]] - run[ports[1]] if all(port in run for port in ports) else None
    return run.columns.get(own)


# -- the quick check
Others = Callable[[], Mapping[str, Crane]]  # cranes that runs might be of instead, by name; each is a file to read


def quick_check(
    runs: Sequence[Run], crane: Crane, model: FrictionModel | None = None, others: Others = known_cranes
) -> list[Finding]:
    """What speaks against these runs being this crane's, the likeliest mistake first; below a second for a dozen runs.

    `others` (default: the shipped cranes) is asked where the runs are doubted or say another crane's name, else not. An
    empty list, or one without an `error`, means that ordinary friction and ordinary sensor errors explain the runs."""
    return diagnosed(apart(runs)[0], crane, model, others)[0]


def diagnosed(
    runs: Sequence[Run], crane: Crane, model: FrictionModel | None, others: Others, ranked: bool = False
) -> tuple[list[Finding], Fit]:  # fmt: skip
    """The findings of `quick_check` and how the runs fit: diagnosed where they are doubted or `ranked`."""
    others = cache(others)
    clock = uneven_once([finding for run in runs for finding in clock_findings(run)], len(runs))
    usable = [run for run in runs if not any(run.name in each.runs for each in clock if each.contradicts)]
    own = model if model is not None and model.corrections else None
    views = views_of([corrected(run, crane, own) if own else (run, crane) for run in usable])
    fit = fit_of(views, model)
    diagnosis = None
    if ranked or fit.doubted:
        diagnosis = diagnose(fit, views, crane, model, others())
    told = [{each.channel: each.ratio for each in agreements(view)} for view in views]
    slow = [w for run, rates in zip(usable, told, strict=True) for w in told_slow_clock(run, rates | ways(run, crane))]
    exchanged = [Finding("error", "exchanged", said, at, (name,)) for said, at, name in exchanged_columns(runs)]
    readings = [*reading_findings(runs, crane)]
    findings = [
        *exchanged,
        *_named_crane(runs, crane, others),
        *_counts(crane),
        *(each for each in readings if each.cause in FIRST_READINGS),
        *slow,
        *simulated_findings(runs, crane.drive.hydraulic),
        *(dead_findings(usable, views) if crane.drive.hydraulic else ()),
        *(lone_units(usable) if crane.drive.hydraulic else ()),
        *(group_findings(usable, crane, fit.contradicting) if crane.drive.hydraulic else ()),
        *(() if slow or exchanged or diagnosis is None else likeliest_mistake(diagnosis, crane)),
        *(each for each in readings if each.cause not in FIRST_READINGS),
        *(finding for run in runs if crane.drive.hydraulic for finding in frozen_findings(run)),
        *(finding for run in runs for finding in cell_findings(run)),
        *clock,
    ]
    return sorted(findings, key=lambda finding: SEVERITIES.index(finding.severity)), diagnosis or fit


def _named_crane(runs: Sequence[Run], crane: Crane, others: Others) -> list[Finding]:
    """What the runs themselves say of their crane; a differing name alone is no contradiction, another machine is."""
    said = {run.name: str(run.metadata.get("crane") or "") for run in runs}
    foreign = {name: own for name, own in said.items() if own and own != crane.name}
    known = others() if foreign else {}
    machines = sorted({own for own in foreign.values() if own in known and not same_machine(known[own], crane)})
    if not machines:
        return []
    names = tuple(name for name, own in foreign.items() if own in machines)
    words = f"{runs_say(names, len(runs), 'say')} that they are of crane '{', '.join(machines)}', not of '{crane.name}'"
    return [Finding("error", "crane", words, "", names, {"recorded": machines})]


def _counts(crane: Crane) -> Iterator[Finding]:
    """Motors of normal winch mode that are fewer or more than those of heave compensation: a motor in eleven is within
    what a load cell and a feedback may be off by, and `gap` would name one of these."""
    parts = {name: count for name, count in crane.groups.items() if name != "main"}
    main, together = crane.groups.get("main", 0), sum(parts.values())
    if main and parts and main != together:
        said = f"crane '{crane.name}': main has {main} motors, {' and '.join(parts)} {together}: is each counted once?"
        yield Finding("warning", "groups", said, evidence={"main": main, "others": together})


def refuse(findings: Sequence[Finding]) -> None:
    """Raise `InputError` with the likeliest mistake where the data contradict the crane."""
    if (finding := first_contradiction(findings)) is not None:
        raise InputError(f"{finding.sentence} (see winch-friction check; --force goes on regardless)")
