"""The inverse plant: the balance of torques at the shaft gives the pressures that a prescribed motion asks for."""

import numpy as np

from campaign.third_rig.crane import CM3_PER_REV, GRAVITY, Friction
from campaign.third_rig.friction import motor_friction, winch_friction
from campaign.third_rig.hidden import Channels, Hidden, Pressed, State
from campaign.third_rig.motion import Series, swinging
from campaign.third_rig.plan import Plan
from campaign.third_rig.runs import Run

ROUNDS = 14  # of the balance: losses that read the pressure
CLOSED = 10.0  # Pa
REFERENCE_LEADS = 0.08  # s
LEAKAGE = 1.5e-12  # m^3/s per Pa, of a motor of 215 cm^3/rev
LINE_VOLUME = 2e-3  # m^3, of 11 motors of 215 cm^3/rev
BULK_MODULUS = 1.2e9  # Pa
USUAL_WINCH = 2365.0  # cm^3/rev of all motors


def solve(plan: Plan, run: Run, hidden: Hidden = ()) -> Channels:
    """What sensors without noise would read in a run."""
    state = _loaded(plan, run, hidden)
    _balance(state, plan.figures.true, hidden)
    channels = _channels(state)
    for effect, size in hidden:
        if effect.sensed:
            effect.sensed(channels, state, size)
    for channel in channels.keys() & plan.zeros.keys():
        channels[channel] = channels[channel] + plan.zeros[channel]
    return channels


def _loaded(plan: Plan, run: Run, hidden: Hidden) -> State:
    crane = plan.crane
    radius: Series | float = crane.radius(run.layer)
    inertia: Series | float = crane.inertia
    mass = run.mass
    for effect, size in hidden:
        radius = radius + size * effect.radius(run, crane) if effect.radius else radius
        inertia = inertia + size * effect.inertia(run, crane) if effect.inertia else inertia
        mass = mass + size * effect.mass(run, crane) if effect.mass else mass
    state = State(run, crane, plan.step, radius, inertia, mass)
    lifted = run.heave_acceleration + radius / crane.gear * run.acceleration
    if plan.options.elastic:
        lifted = swinging(lifted, plan.stiffness / run.wire_out / mass, plan.options.damping, plan.step)
    state.load_torque = mass * (GRAVITY + lifted) * radius / crane.gear
    return state


def _balance(state: State, true: Friction, hidden: Hidden) -> None:
    """Set the pressures: drive = load + inertia + friction, the leading group carries what the gas does not."""
    run = state.run
    lead = run.groups[run.balancing]
    swept = lead.motors * lead.displacement
    gas = sum(g.motors * g.displacement * g.drop for g in run.groups.values() if g.drop is not None)
    drop = (state.load_torque - gas) / swept
    for _ in range(ROUNDS):
        state.groups = _pressed(state, drop)
        opposing, one_way = _losses(state, true, hidden)
        torque = state.load_torque + state.inertia * run.acceleration + run.turned_over * opposing + one_way
        before, drop = drop, (torque - gas) / swept
        if np.max(np.abs(drop - before)) < CLOSED:
            return


def _pressed(state: State, lead_drop: Series) -> dict[str, Pressed]:
    groups = {}
    for name, group in state.run.groups.items():
        drop = lead_drop if group.drop is None else group.drop
        port_a = np.where(drop >= 0, group.low + drop, group.low)
        stroke = group.displacement / state.crane.max_displacement
        groups[name] = Pressed(group.motors, group.displacement, drop, port_a, port_a - drop, stroke)
    return groups


def _losses(state: State, true: Friction, hidden: Hidden) -> tuple[Series, Series | float]:
    """N m at the shaft against the motion, and whatever the motion."""
    opposing = state.crane.motors * winch_friction(true, state.speed, state.drum_torque)
    one_way: Series | float = 0.0
    for group in state.groups.values():
        of_one = motor_friction(true, state.speed, group.displacement, np.abs(group.drop))
        opposing = opposing + group.motors * of_one
    for effect, size in hidden:
        opposing = opposing + size * effect.opposing(state) if effect.opposing else opposing
        one_way = one_way + size * effect.one_way(state) if effect.one_way else one_way
    return opposing, one_way


def _channels(state: State) -> Channels:
    run = state.run
    channels = {
        "motor_speed": run.speed, "hook_load": run.mass, "heave_velocity": run.heave, "oil_temperature": run.celsius,
        "wire_out": run.wire_out, "shaft_angle": run.angle, "speed_reference": _reference(state),
    }  # fmt: skip
    for name, group in state.groups.items():
        channels |= {
            f"{name}.pressure_a": group.port_a, f"{name}.pressure_b": group.port_b,
            f"{name}.displacement": group.displacement,
        }  # fmt: skip
    return channels


def _reference(state: State) -> Series:
    """Commanded speed, rad/s: earlier than the shaft, and more by what leaks and what the oil gives."""
    run, crane, lead = state.run, state.crane, state.lead
    early = np.interp(run.time + REFERENCE_LEADS, run.time, run.speed)
    leaked = LEAKAGE * crane.max_displacement / (215 * CM3_PER_REV) * lead.drop / lead.displacement
    volume = LINE_VOLUME * crane.motors * crane.cm3_per_rev / USUAL_WINCH * lead.motors / crane.motors
    given = volume * np.gradient(lead.drop, state.step) / BULK_MODULUS / (lead.motors * lead.displacement)
    return early + leaked + given


def residual(plan: Plan, run: Run, channels: Channels, true: Friction | None = None) -> Series:
    """What the documented balance on channels leaves, Pa of the leading group; `true` parameters unless others."""
    crane, figures = plan.crane, true or plan.figures.true
    speed, mass = channels["motor_speed"], channels["hook_load"]
    radius = crane.radius(run.layer)
    drum_torque = mass * GRAVITY * radius
    acceleration = np.gradient(speed, plan.step)
    lifted = np.gradient(channels["heave_velocity"], plan.step) + radius / crane.gear * acceleration
    drive: Series | float = 0.0
    friction = crane.motors * winch_friction(figures, np.abs(speed), drum_torque)
    for name, group in run.groups.items():
        displacement = channels[f"{name}.displacement"]
        zero = plan.zeros.get(f"{name}.pressure_a", 0.0)
        drop = channels[f"{name}.pressure_a"] - zero - channels[f"{name}.pressure_b"]
        drive = drive + group.motors * displacement * drop
        friction = friction + group.motors * motor_friction(figures, np.abs(speed), displacement, np.abs(drop))
    needed = (drum_torque + mass * lifted * radius) / crane.gear + crane.inertia * acceleration
    swept = run.groups[run.balancing].motors * channels[f"{run.balancing}.displacement"]
    return (drive - needed - np.sign(speed) * friction) / swept
