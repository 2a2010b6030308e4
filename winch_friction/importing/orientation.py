"""Ports and signs, where names do not tell them: by what the crane's physics allows."""

from dataclasses import replace

import numpy as np

from winch_friction.importing.balance import closure, drive_torque, groups_of, opposes_motion, power_ratio, told
from winch_friction.importing.draft import Draft
from winch_friction.importing.guess import in_si
from winch_friction.importing.kinematics import along_speed, rope_over_motor
from winch_friction.importing.mapping import Entry
from winch_friction.importing.names import name_concepts
from winch_friction.importing.units import header_readings, usual_units
from winch_friction.physics.winch.crane import Crane

_GEAR = 0.1  # relative, between the wire's speed and the gear's: an inner layer, not another unit
_BY_MOTION = 0.6  # confidence of a speed that no name says
_TELLING = 0.3  # power over load times speed from which its sign is told: losses are not two thirds of it


def settle_orientation(draft: Draft, said: frozenset[str] = frozenset()) -> None:
    """Ports, groups and signs by what the crane's physics allows."""
    if draft.crane is None:
        return
    if "hook_load" in draft.log_map.columns and "hook_load" not in said:
        _settle_load(draft)
    for name in [n for n in draft.log_map.columns if n.endswith(".displacement") and n not in said]:
        _settle_displacement(draft, name)
    _settle_ports(draft, draft.crane)
    if "motor_speed" in draft.log_map.columns and "motor_speed" not in said:
        _settle_speed(draft, draft.crane)
    for name in [n for n in ("speed_reference", "shaft_angle") if n in draft.log_map.columns and n not in said]:
        _settle_second_speed(draft, name)
    if "mechanical_power" in draft.log_map.columns and "mechanical_power" not in said:
        _settle_power(draft, draft.crane)


def _settle_load(draft: Draft) -> None:
    """A hanging load pulls: a cell that counts it negative counts downwards."""
    loads = np.concatenate([each.columns.get("hook_load", np.zeros(0)) for each in draft.converted()])
    loads = loads[np.isfinite(loads)]
    if len(loads) and np.percentile(loads, 95.0) < 0.0:
        draft.change("hook_load", sign=-1, because="sign turned: a hanging load counts negative in this log")


def _settle_displacement(draft: Draft, name: str) -> None:
    """A motor that never goes over centre, logged with a negative displacement: its sign, where the load says so."""
    values = np.concatenate([each.columns.get(name, np.zeros(0)) for each in draft.converted()])
    values = values[np.isfinite(values)]
    if not len(values) or np.max(values) >= 0.0:
        return
    kept, before = draft.log_map, _mean_mismatch(draft)
    draft.change(name, sign=-1, because="sign turned: the displacement counts negative throughout in this log")
    if not _mean_mismatch(draft) < 0.5 * before:
        draft.log_map = kept


def _settle_speed(draft: Draft, crane: Crane) -> None:
    if _says_out(draft.log_map.columns["motor_speed"].source):
        draft.change("motor_speed", sign=-1, because="sign turned: the name says that paying out counts positive")
        return
    ratios = [r.value for c in draft.converted() if (r := rope_over_motor(c.columns, crane)) is not None]
    if ratios and _friction_denies(draft, crane, float(np.median(ratios))):
        return
    if ratios and np.median(ratios) < 0.0:
        draft.change("motor_speed", sign=-1, because="sign turned: the wire comes in while it counts negative")
        return
    if ratios:
        draft.change("motor_speed", because="its sign agrees with the motion of the wire")
        return
    t_values = [opposes_motion(c.columns, crane) for c in draft.converted()]
    t_value = float(np.median(t_values)) if t_values else 0.0
    groups = groups_of(draft.converted()[0].columns)
    if not told(t_value):
        draft.change(
            "motor_speed",
            draft.log_map.columns["motor_speed"].confidence * 0.9,
            "its sign is not told by the log: hoisting taken as positive",
        )
    elif t_value > 0.0:
        draft.change("motor_speed", because="friction opposes the motion with this sign")
    elif len(groups) <= 1:
        draft.change("motor_speed", sign=-1, because="sign turned: friction would drive the motion otherwise")
    # with several groups swapped ports would do the same: left to the contradictions, as a question


def _settle_second_speed(draft: Draft, name: str) -> None:
    """What tells the motor's speed again counts as it does: of a log that counts paying out positive all are turned."""
    signs = [g for done in draft.converted() if (g := along_speed(done.columns, name)) is not None]
    if signs and float(np.median(signs)) < 0.0:
        sign = -1 * draft.log_map.columns[name].sign
        draft.change(name, sign=sign, because="sign turned: it runs against the motor's speed")


def _friction_denies(draft: Draft, crane: Crane, ratio: float) -> bool:
    """Whether the load is held and friction says the opposite of the wire: then it is the wire that counts the other
    way, as what lies on the drum does. Asked; the speed's sign is friction's.
    """
    done = draft.converted()
    t_value = float(np.median([opposes_motion(each.columns, crane) for each in done]))
    several = len(groups_of(done[0].columns)) > 1  # of which one's ports may be swapped
    if "wire_out" not in draft.log_map.columns or several or not told(t_value) or t_value * ratio > 0.0:
        return False
    held = [drive_torque(each.columns, crane) for each in done]
    if not _mean_mismatch(draft) < 1.0 or not all(h is not None and np.nanmean(h) > 0.0 for h in held):
        return False  # ports or units are what is wrong
    draft.change("motor_speed", sign=1 if t_value > 0.0 else -1, because="friction opposes the motion with this sign")
    draft.questions.append(
        f"wire_out: '{draft.log_map.columns['wire_out'].source}' grows where friction and load say that the winch "
        "hoists: is it the wire that lies on the drum? Take wire_out out of the map then; if it is what is paid out, "
        f"turn the speed: --set motor_speed.sign={-1 if t_value > 0.0 else 1}"
    )
    return True


def speed_by_motion(draft: Draft, crane: Crane) -> None:
    """The motor's speed where no name says it: the column whose sum follows the wire, in a unit that fits the gear."""
    used = {*draft.log_map.time_from, *(entry.source for entry in draft.log_map.columns.values())}
    columns = draft.converted()[0].columns
    for column in draft.logs[0].columns:
        if column.name in used or not column.numeric or column.unit:
            continue
        for unit in usual_units("motor_speed"):
            values = in_si(column, unit, "motor_speed", crane)
            ratio = rope_over_motor({**columns, "motor_speed": values}, crane) if values is not None else None
            if ratio is not None and abs(abs(ratio.value) - 1.0) < _GEAR and len(header_readings(column.name)) == 1:
                because = f"no name says it, but its sum follows {ratio.by} as gear and drum have it in {unit}"
                entry = Entry(column.name, unit, confidence=_BY_MOTION, because=because)
                draft.log_map = replace(draft.log_map, columns={"motor_speed": entry, **draft.log_map.columns})
                return


def _says_out(name: str) -> bool:
    """Whether the name of a speed says that it is one of paying out."""
    found = name_concepts(name)
    return any("out" in token for token in found) or any(
        word in name.lower() for word in ("reelout", "payout", "lower")
    )


def _settle_power(draft: Draft, crane: Crane) -> None:
    """The power that lifts a load is positive: it must have the sign of the load's torque times the speed."""
    signs = [g for done in draft.converted() if (g := power_ratio(done.columns, crane)) is not None]
    sign = float(np.median(signs)) if signs else 0.0
    if sign < -_TELLING:
        draft.change("mechanical_power", sign=-1, because="sign turned: lifting the load would give power otherwise")
    elif sign > _TELLING:
        draft.change("mechanical_power", because="lifting the load takes power with this sign")
    else:
        sure = 0.7 * draft.log_map.columns["mechanical_power"].confidence
        draft.change("mechanical_power", sure, "its sign is not told by the log: taken as positive when hoisting")


def _settle_ports(draft: Draft, crane: Crane) -> None:
    """Swap ports that the names do not tell, where only then the motors hold the load."""
    groups = [
        g
        for g in crane.groups
        if all(p in draft.log_map.columns and not draft.log_map.columns[p].constant for p in _ports(g))
    ]
    untold = [g for g in groups if not _ports_told(draft.log_map.columns[f"{g}.pressure_a"].source)]
    for group in untold:
        before = _mean_mismatch(draft)
        a, b = draft.log_map.columns[f"{group}.pressure_a"], draft.log_map.columns[f"{group}.pressure_b"]
        kept = draft.log_map
        draft.change(f"{group}.pressure_a", source=b.source, because="port by the load: the side that holds it")
        draft.change(f"{group}.pressure_b", source=a.source, because="port by the load: the other side")
        after = _mean_mismatch(draft)
        if not (after < 1.0 and after < 0.5 * before):
            draft.log_map = kept
            held = before < 1.0
            why = "port by the load: the side that holds it" if held else "which side is port A is not told"
            for port in ("pressure_a", "pressure_b"):
                name = f"{group}.{port}"
                draft.change(name, draft.log_map.columns[name].confidence * (0.95 if held else 0.6), why)


def _ports(group: str) -> tuple[str, str]:
    return f"{group}.pressure_a", f"{group}.pressure_b"


def _ports_told(name: str) -> bool:
    return any(set(token) & {"port_a", "port_b"} for token in name_concepts(name)) or ".pressure_" in name


def _mean_mismatch(draft: Draft) -> float:
    found = [closure(c.columns, draft.crane) for c in draft.converted()] if draft.crane is not None else []
    known = [f.mismatch for f in found if f is not None]
    return float(np.mean(known)) if known else 0.0
