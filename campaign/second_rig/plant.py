"""The winch with prescribed motion: rope, accumulator, and the pressure that the balance of torques asks for."""

import numpy as np

from campaign.second_rig.crane import ALL_ONE, BAR, GRAVITY, RPM, SPLIT, Crane, Friction
from campaign.second_rig.hidden import Hidden, State
from campaign.second_rig.motion import STEP, Series, creep, followed, joystick, rope_force, sea, staircase
from campaign.second_rig.voyages import CREEP, LEVER, REGULAR, STAIRS, Voyage

COMPENSATED = 0.97  # of the heave
LATE = 0.03  # s by which the compensation follows the sea
RETURN_OF_GAS = 20.0  # bar, low side of the motors on the gas
GAS_ROOM = 10.0  # of the oil that the largest turn moves
POLYTROPIC = 1.2
STILL = 0.02  # rad/s under which the brake holds
ROUNDS = 6  # of the balance: losses that read the pressure


def sail(rng: np.random.Generator, crane: Crane, truth: Friction, voyage: Voyage, hidden: Hidden) -> State:
    """One run in full."""
    run = _moved(rng, crane, truth, voyage, hidden)
    drum_torque = _rope_force(run, hidden) * run.radius
    run.drum_torque = run.mass * GRAVITY * run.radius
    run.turned_over = hidden.turned_over(run)
    _set_displacements(run)
    _balance(run, hidden, drum_torque)
    return run


def _moved(rng: np.random.Generator, crane: Crane, truth: Friction, voyage: Voyage, hidden: Hidden) -> State:
    radius = hidden.radius(crane, voyage.layer, voyage.mass)
    stated = crane.radii[voyage.layer - 1]
    time, reference, heave = _wanted(rng, crane, voyage, stated)
    speed = followed(reference, 6, 0.8) if voyage.at_sea else followed(reference, 1.3, 0.6)
    # a live ripple while it turns, none at rest
    window = np.hanning(161)
    ripple = np.convolve(rng.normal(0, 1, len(time)), window / np.sqrt(np.sum(window**2)), "same")
    speed = speed + ripple * 0.12 * np.clip(np.abs(speed) / 5, 0, 1)
    speed = np.where(np.abs(speed) < STILL, 0.0, speed)
    angle = voyage.angle + np.cumsum(speed) * STEP
    wire_out = voyage.wire_out - (angle - angle[0]) * stated / crane.gear
    wire = float(voyage.wire_weighs) * crane.wire_mass * (wire_out - voyage.wire_out)
    warmed = (1 - np.exp(-time / (voyage.seconds * 0.6))) / (1 - np.exp(-1 / 0.6))
    cold, warm = voyage.celsius
    return State(
        crane, truth, voyage, time, speed, np.abs(speed), np.gradient(speed, STEP), angle, wire_out,
        cold + (warm - cold) * warmed, hidden.mass(voyage.mass, voyage) + wire, voyage.mass + wire, reference, heave,
        _groups(crane, voyage), voyage.boost * BAR + 0 * time, radius,
    )  # fmt: skip


def _wanted(rng: np.random.Generator, crane: Crane, voyage: Voyage, radius: float) -> tuple[Series, Series, Series]:
    """Time (s), wanted speed of the shaft (rad/s), velocity of the tip (m/s)."""
    if voyage.at_sea:
        time, heave = sea(rng, voyage.seconds, voyage.kind == REGULAR, *voyage.wave)
        heave = heave * min(1.0, 0.9 * crane.top_speed * radius / crane.gear / np.abs(heave).max())
        lag = int(LATE / STEP)
        followed_heave = np.concatenate([np.zeros(lag), heave[:-lag]])
        return time, -followed_heave * crane.gear / radius * COMPENSATED, heave
    plans = {
        STAIRS: lambda: staircase(crane.top_speed, voyage.seconds, voyage.steps),
        LEVER: lambda: joystick(rng, crane.top_speed * 0.8, voyage.seconds),
        CREEP: lambda: creep(rng, voyage.seconds),
    }
    time, reference = plans[voyage.kind]()
    return time, reference, np.zeros_like(time)


def _groups(crane: Crane, voyage: Voyage) -> dict[str, int]:
    if crane.grouping == SPLIT or (crane.grouping != ALL_ONE and voyage.at_sea):
        return {"active": crane.active, "passive": crane.passive}
    return {"main": crane.motors}


def _rope_force(run: State, hidden: Hidden) -> Series:
    """N at the drum, of a load that follows at once or on the rope's spring."""
    extra = hidden.load_force(run)
    above = run.radius / run.crane.gear * run.speed + run.heave
    if run.voyage.stiff:
        return run.mass * (GRAVITY + np.gradient(above, STEP)) + extra
    mass = float(np.mean(run.mass))
    spring = run.crane.wire_stiffness / float(np.mean(run.wire_out + run.voyage.above))
    damper = 2 * run.voyage.damping * float(np.sqrt(spring * mass))
    nothing = np.zeros(len(run.time))
    return rope_force(above, run.mass * GRAVITY, nothing + extra, mass, spring, damper)


def _set_displacements(run: State) -> None:
    crane = run.crane
    steps = len(run.time)
    run.displacement[run.lead] = np.full(steps, crane.max_displacement * run.voyage.displacement)
    if "passive" not in run.groups:
        return
    # the gas carries 0.92 of the load on the stated radius; its oil leaves as the winch hoists
    held = 0.92 * float(np.mean(run.mass)) * GRAVITY * crane.radii[run.voyage.layer - 1] / crane.gear / crane.passive
    size = min(crane.max_displacement, held / min(0.55 * crane.rated_pressure, 250 * BAR))
    run.displacement = {"passive": np.full(steps, size)} | run.displacement
    turned = run.angle - run.angle[0]
    room = GAS_ROOM * crane.passive * size * np.abs(turned).max()
    volume = room + crane.passive * size * turned
    run.pressure["passive"] = held / size * (room / np.maximum(volume, 0.3 * room)) ** POLYTROPIC


def _balance(run: State, hidden: Hidden, drum_torque: Series) -> None:
    """Solve the balance of torques at the shaft for the pressure of the group that leads."""
    crane, truth, speed = run.crane, run.truth, run.speed_abs
    lead, groups = run.lead, run.groups
    run.pressure[lead] = np.full(len(run.time), 1e7)
    stribeck = (truth["C1"] * run.drum_torque + truth["C3"]) * np.exp(-speed / (truth["C4"] * RPM))
    of_winch = stribeck + truth["C5"] * speed + truth["C6"] * run.drum_torque + hidden.winch_friction(run)
    inertia = crane.inertia * hidden.inertia
    carried = drum_torque / crane.gear + inertia * run.acceleration + hidden.one_way(run)
    for _ in range(ROUNDS):
        of_motors = sum(count * _motor_friction(run, group, hidden) for group, count in groups.items())
        friction = of_motors + crane.motors * of_winch + hidden.shaft_friction(run)
        torque = carried + run.turned_over * friction
        for group, count in groups.items():
            if group != lead:
                torque = torque - count * run.displacement[group] * run.pressure[group]
        run.pressure[lead] = torque / (groups[lead] * run.displacement[lead])


def _motor_friction(run: State, group: str, hidden: Hidden) -> Series:
    """N m, of one motor."""
    truth, speed = run.truth, run.speed_abs
    pressure, displacement = np.abs(run.pressure[group]), run.displacement[group]
    loss = truth["K1"] * speed + truth["K2"] * displacement**3 * speed**2 + truth["K3"] * pressure * displacement
    return loss + truth["K4"] + truth["K5"] * pressure * pressure + hidden.motor_friction(run, group)
