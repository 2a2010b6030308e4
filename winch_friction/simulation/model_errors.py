"""The errors that a model's corrections speak of, put into plant and sensors: the log then shows what they take out."""

import numpy as np

from winch_friction.physics.corrections import affected, corrected_crane
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction.correction import Correction
from winch_friction.physics.friction.declared_correction import Action
from winch_friction.physics.friction.model import FrictionModel
from winch_friction.physics.winch.crane import Crane
from winch_friction.simulation.scenario import Scenario
from winch_friction.simulation.sensors.channels import MOST_BENDS, Channels

# what the simulated sensors cannot show, and the hidden effect to ask for instead
_HIDDEN_INSTEAD = {
    Action.WARMTH: "accumulator_thermal",
    Action.HEAT: "accumulator_thermal",
    Action.SLIP: "slip_leakage",
    Action.AIR: "entrained_air",
    Action.FILTER: "signal_delay",
}


def put_errors(model: FrictionModel, scenario: Scenario, crane: Crane, plant: np.ndarray, channels: Channels) -> None:
    """Change plant and channel settings, in place, so that the model's corrections give the truth back.

    The crane file is what the log is read with: its radius and inertia are wrong, the plant's are right. Raises
    `InputError` by name for what the sensors cannot show. What was wrong for a time is put into runs that start then.
    """
    for each in model.corrections:
        if not each.holds(scenario.start_time):
            continue
        action = each.declared.action
        if action in _HIDDEN_INSTEAD or each.declared.course:
            raise InputError(
                f"model '{model.name}': correction {each.name} cannot be put into the simulated sensors; take it out "
                f"of the model and use --hide {_HIDDEN_INSTEAD.get(action, 'signal_delay')}"
            )
        if action in (Action.OFFSET, Action.SCALE, Action.CURVATURE, Action.BEND, Action.S_SHAPE, Action.DELAY):
            _put_signal(each, scenario, channels)
        elif action is Action.MASS:
            _put_mass(each, scenario, plant[0])
    _put_geometry(model, scenario, crane, plant[0])
    # a signal that comes early means that all the others come late
    channels.settings["delay"] -= min(0.0, float(channels.settings["delay"].min()))


def _put_signal(correction: Correction, scenario: Scenario, channels: Channels) -> None:
    oil = _oil(correction, scenario) if "oil_temperature" in correction.declared.reads else None
    groups = dict.fromkeys(name.rpartition(".")[0] for name in channels.names if "." in name)
    columns = affected(correction, groups)
    for name, row in zip(channels.names, channels.settings, strict=True):
        if name not in columns:
            continue
        if correction.declared.action is Action.OFFSET:
            row["offset"] += correction.error(scenario.start_time, oil)
        elif correction.declared.action is Action.SCALE:
            row["scale"] *= 1.0 + correction.error(scenario.start_time, oil)
        elif correction.declared.action is Action.CURVATURE:
            row["curvature"] += correction.value
        elif correction.declared.action is Action.BEND:
            _put_bend(correction, row)
        elif correction.declared.action is Action.S_SHAPE:
            if row["swing"] != 0.0 and row["stroke"] != correction.beyond:
                raise InputError(f"correction {correction.name}: a simulated sensor has one stroke (beyond)")
            row["swing"] += correction.value
            row["stroke"] = correction.beyond
        else:
            row["delay"] += correction.value


def _put_bend(correction: Correction, row: np.void) -> None:
    """In order of where they begin, for each is put on what the ones before it have made of the signal."""
    used = int(np.count_nonzero(row["bend"]))
    if used == MOST_BENDS:
        raise InputError(f"correction {correction.name}: a simulated sensor bends in at most {MOST_BENDS} places")
    row["bend"][used], row["beyond"][used] = correction.value, correction.beyond
    order = np.argsort(row["beyond"][: used + 1])
    for name in ("bend", "beyond"):
        row[name][: used + 1] = row[name][order]


def _oil(correction: Correction, scenario: Scenario) -> float:
    """The oil's temperature in degC; a sensor of the simulator has one offset for a whole run."""
    oil = scenario.oil_temperature
    if oil.end not in (None, oil.start):
        raise InputError(
            f"scenario '{scenario.name}': the oil goes from {oil.start:g} to {oil.end:g} degC, and correction "
            f"{correction.name} needs one temperature in the simulator; give start and end alike"
        )
    return float(oil.start)


def _put_mass(correction: Correction, scenario: Scenario, plant: np.void) -> None:
    if "wire_out" in correction.declared.reads:
        plant["wire_mass"] += correction.value
        plant["mass"] += correction.value * scenario.wire_out
    else:
        plant["mass"] += correction.error(scenario.start_time, None)


def _put_geometry(model: FrictionModel, scenario: Scenario, crane: Crane, plant: np.void) -> None:
    true = corrected_crane(crane, model.corrections, model.name)
    ratio = true.drum.radius(scenario.wire_layer) / crane.drum.radius(scenario.wire_layer)
    plant["radius"] *= ratio
    plant["metres_per_radian"] *= ratio
    plant["inertia"] += true.inertia - crane.inertia
