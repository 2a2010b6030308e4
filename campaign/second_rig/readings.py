"""Sensors, rope and load that differ from the owner's files, and what no catalogue of winch effects holds."""

import numpy as np

from campaign.second_rig.crane import BAR, GRAVITY, Crane, Friction
from campaign.second_rig.hidden import Hidden, State
from campaign.second_rig.laws import Voyages
from campaign.second_rig.motion import Series


def feedback_bent(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """The displacement's feedback has an S-shaped error."""

    def read(run: State, group: str, displacement: Series) -> Series:
        if group == "passive":
            return displacement
        largest = crane.max_displacement
        return displacement + (0.018 * largest * np.sin(np.pi * displacement / largest) + 0.006 * largest)

    return Hidden(read_displacement=read)


def feedback_offset(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """The displacement's feedback reads 1.2 % of the largest one too much."""
    return Hidden(
        read_displacement=lambda run, group, displacement: (
            displacement + (0.012 * crane.max_displacement if group != "passive" else 0)
        )
    )


def zero_warm(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """The zero of side a moves with the temperature, bent."""

    def read(run: State, group: str, side: str, pressure: Series) -> Series:
        if side != "a" or group == "passive":
            return pressure
        warmer = run.celsius - 40
        return pressure + (0.12 * warmer + 0.004 * warmer**2) * BAR

    return Hidden(read_pressure=read)


def zero_constant(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """Side a reads 2.2 bar too much."""
    return Hidden(
        read_pressure=lambda run, group, side, pressure: (
            pressure + 2.2 * BAR if side == "a" and group != "passive" else pressure
        )
    )


def zero_step(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """Side a reads 3 bar too much in the last five runs."""
    since = sorted(voyage.date for voyage in voyages)[7] - 100
    return Hidden(
        read_pressure=lambda run, group, side, pressure: (
            pressure + (3.0 * BAR if run.voyage.date > since else 0) if side == "a" and group != "passive" else pressure
        )
    )


def pressure_gain(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """Transducers that read 2 % too much."""
    return Hidden(
        read_pressure=lambda run, group, side, pressure: pressure * (1.02 if group != "passive" else 1),
    )


def filter_clogged(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """A return filter between motor and transducer: linear and quadratic in the flow."""

    def drop(run: State, group: str) -> Series | float:
        if group == "passive":
            return 0.0
        share = _flow(run, group)
        return 5 * BAR * (0.5 * share + 0.5 * share * share)

    return Hidden(line_drop=drop)


def check_valve(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """A valve in the line that opens at 2.5 bar while lowering."""

    def drop(run: State, group: str) -> Series | float:
        if group == "passive":
            return 0.0
        share = _flow(run, group)
        return np.where(run.speed < 0, 2.5 * BAR * np.tanh(share * 60) + 2.5 * BAR * share, 0)

    return Hidden(line_drop=drop)


def _flow(run: State, group: str) -> Series:
    """Share of the largest flow of a group."""
    return run.displacement[group] * run.speed_abs / (run.crane.max_displacement * run.crane.top_speed)


def slow_transducers(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """Pressures filtered with 120 ms."""
    return Hidden(pressure_filter=0.12)


def late_speed(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """Speed and angle 90 ms late."""
    return Hidden(speed_delay=0.09)


def tare(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """A hook block that the load cell does not weigh."""
    return Hidden(mass=lambda mass, voyage: mass + 0.03 * crane.rated)


def tare_wire(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """A hook block and the wire to it that the load cell does not weigh."""
    return Hidden(mass=lambda mass, voyage: mass + 0.012 * crane.rated + crane.wire_mass * voyage.wire_out)


def load_cell_gain(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """A load cell that weighs 2.4 % too little."""
    return Hidden(mass=lambda mass, voyage: mass * 1.025)


def radius_of_layer(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """One layer lies 3 % lower than stated."""
    wrong = voyages[1].layer
    return Hidden(radius=lambda crane, layer, mass: crane.radii[layer - 1] * (1 - 0.03 * (layer == wrong)))


def radius_sinks(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """Layers sink into each other with the root of the load."""
    return Hidden(
        radius=lambda crane, layer, mass: (
            crane.radii[layer - 1] - (layer - 1) / (crane.layers - 1) * 0.3 * crane.rope * (mass / crane.rated) ** 0.5
        )
    )


def water_drag(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """Outside the catalogue: a load in water."""
    return Hidden(
        load_force=lambda run: (
            0.06 * crane.rated * GRAVITY * np.sign(run.speed) * (run.speed_abs / crane.top_speed) ** 2
        )
    )


def level_wind(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """Outside: the rope rubs on the flange once per 27 m."""
    return Hidden(
        shaft_friction=lambda run: (
            0.03 * run.drum_torque / crane.gear * (1 + np.sin(2 * np.pi * run.wire_out / 27.0)) / 2
        )
    )


def cold_grease(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """Outside: friction that fades with the seconds since the start."""
    return Hidden(winch_friction=lambda run: 9 * crane.size * np.exp(-run.time / 45.0))


def speeding_up(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """Outside: more friction while the winch speeds up."""
    return Hidden(winch_friction=lambda run: 7 * crane.size * np.tanh(run.acceleration * np.sign(run.speed) / 3.0))


def worn_sector(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """Outside: a sector of the drum's rim is worn."""
    return Hidden(
        shaft_friction=lambda run: (
            0.05 * run.drum_torque / crane.gear * (((run.angle / crane.gear) % (2 * np.pi)) < 1.3)
        )
    )


def flange_far_out(crane: Crane, truth: Friction, voyages: Voyages) -> Hidden:
    """Outside: friction that rises beyond 95 m of wire."""
    return Hidden(
        shaft_friction=lambda run: 0.04 * run.drum_torque / crane.gear * np.clip((run.wire_out - 95) / 40, 0, 1)
    )
