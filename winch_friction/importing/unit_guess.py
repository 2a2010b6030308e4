"""Units that a log does not say: by the size that its numbers would have, and by the torque balance."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import product

import numpy as np

from winch_friction.importing.balance import closure, power_ratio
from winch_friction.importing.carry_out import convert
from winch_friction.importing.draft import Draft
from winch_friction.importing.expectations import usual_size
from winch_friction.importing.guess import Match, plausible_units
from winch_friction.importing.kinematics import rope_over_motor
from winch_friction.importing.log import Log
from winch_friction.importing.names import name_concepts
from winch_friction.importing.units import CHANNEL_UNITS, ambiguity, conversion, usual_units
from winch_friction.physics.channels import CM3_PER_REV
from winch_friction.physics.errors import InputError
from winch_friction.physics.winch.crane import Crane

_COMBINATIONS = 300  # of units tried against the torque balance
_ASKED = ("motor_speed", "drum_speed", "pressures", "displacements", "hook_load", "rope_force", "mechanical_power")
_TORQUES = ("pressures", "displacements", "hook_load", "rope_force", "motor_torque")  # what closes the balance
_AS_WELL = 0.3  # evidence of another unit over the chosen one's from which the log does not tell them apart
_SLIPS = {"oil_temperature": ("degF",)}  # that a wrong unit may stand for, though none that is said by nothing
_GUESSED = "no unit is said"  # in the reason of an entry
_BRACKET = re.compile(r"[\[({]\s*([^\[\](){}]{1,10}?)\s*[\])}]\s*$")  # what stands where a unit would
_TAG = re.compile(r"[A-Za-z_\-]*\d+[A-Za-z]?")  # a sensor's number
_RARER = 0.6  # prior of each next unit in the order of usual ones


def settle_units(draft: Draft, found: Mapping[str, Match], pooled: Log) -> None:
    """Units that the log does not say, by size, and by the torque balance where several sizes fit."""
    axes: dict[str, list[str]] = {}
    members: dict[str, list[str]] = {}
    for name in list(draft.log_map.columns):
        match = found.get(name) or found.get("rope_speed")
        if match is None:
            continue  # found by its motion, with its unit
        if ambiguity(match.slot.channel, match.unit):
            continue
        options = _options(draft, name, match, pooled)
        shared = {"pressure_a": "pressures", "pressure_b": "pressures", "displacement": "displacements"}
        kind = shared.get(match.slot.channel, name)  # one unit for all of them
        axes[kind] = [u for u in axes.get(kind, options) if u in options] or axes.get(kind, options)
        members.setdefault(kind, []).append(name)
    for kind, options in axes.items():
        for name in members[kind] if len(options) < 2 else ():
            _set_unit(draft, name, options, None)
    open_axes = {kind: options for kind, options in axes.items() if len(options) > 1}
    chosen = _by_balance(draft, open_axes, members) if open_axes else {}
    for kind, options in open_axes.items():
        if kind in _ASKED and chosen and _undecided(draft, chosen, kind, options, members):
            name = members[kind][0]
            draft.questions.append(
                f"{name}: '{draft.log_map.columns[name].source}' says no unit, and the log does not tell "
                f"{' from '.join(options)}; set {name}.unit"
            )
            continue
        for name in members[kind]:
            _set_unit(draft, name, options, chosen.get(kind))
    _ask_odd_pair(draft, members)
    _ask_strange_units(draft)


def _ask_strange_units(draft: Draft) -> None:
    """A unit that was guessed where the header says one that nobody here knows, such as `[sh tn]`: asked."""
    for name, entry in draft.log_map.columns.items():
        said = _BRACKET.search(entry.source)
        if said is None or _GUESSED not in entry.because or _TAG.fullmatch(said[1]):
            continue
        if any(not concepts for concepts in name_concepts(said[1])):
            draft.questions.append(
                f"{name}: '{entry.source}' says '{said[1]}', which is no unit that is known here; {entry.unit or '-'} "
                f"is guessed from its size: set {name}.unit"
            )


def _ask_odd_pair(draft: Draft, members: Mapping[str, list[str]]) -> None:
    """Two kinds of channel without a unit, neither in its most usual one: a factor wrong in one of them, which the
    other's unit makes up for, would look the same.
    """
    odd = []
    for kind, names in members.items():
        entry = draft.log_map.columns[names[0]]
        usual = usual_units(names[0].rpartition(".")[2])
        if kind in _TORQUES and entry.unit and _GUESSED in entry.because and usual and entry.unit != usual[0]:
            odd.append((names[0], entry))
    if len(odd) < 2:
        return
    together = " and ".join(f"{name} in {entry.unit}" for name, entry in odd)
    for name, entry in odd:
        draft.questions.append(
            f"{name}: '{entry.source}' says no unit, and only {together} together would be this crane's: is a gain "
            f"wrong? set {name}.unit"
        )


def _usual_in(channel: str, unit: str, crane: Crane | None) -> str:
    """The usual size of a channel in the log's unit, in SI where the unit alone does not lead there."""
    low, high = usual_size(channel, crane)
    of = crane.max_displacement if crane is not None and channel == "displacement" else 1.0
    try:
        found = conversion(channel, unit, "", of=of or 1.0)
    except InputError:
        return f"{low:.3g} to {high:.3g} {CHANNEL_UNITS[channel][0]}"
    return f"{(low - found.offset) / found.scale:.3g} to {(high - found.offset) / found.scale:.3g} {unit}"


def _options(draft: Draft, name: str, match: Match, pooled: Log) -> list[str]:
    column = pooled.column(match.column.name)
    options = plausible_units(column, match.unit, match.slot.channel, draft.crane)
    if match.unit and not options:  # what the log says gives no usual size: which unit would?
        others = [u for u in (*usual_units(match.slot.channel), *_SLIPS.get(name, ())) if u != match.unit]
        likely = [u for u in others if plausible_units(column, u, match.slot.channel, draft.crane)]
        likely.sort(key=lambda u: -_closing(draft, {name: u}))  # as usual ones as they close the balance alike
        size = float(np.nanpercentile(np.abs(column.values), 95.0))
        hint = f"; '{likely[0]}' would give a usual size: set {name}.unit={likely[0]}" if likely else ""
        draft.questions.append(
            f"{name}: '{match.column.name}' says '{match.unit}', but {size:.4g} {match.unit} is no usual size "
            f"({_usual_in(match.slot.channel, match.unit, draft.crane)}){_of_crane(draft, match.slot.channel)}{hint}"
        )
        return [match.unit]
    if match.unit or options:
        own = CHANNEL_UNITS[match.slot.channel][0]
        named = column.name == name and own in options  # the contract's own name without a unit is SI
        return [own] if named else options
    return []


def _of_crane(draft: Draft, channel: str) -> str:
    """What to say when the crane sets how large a channel may be."""
    crane = draft.crane
    if crane is None or channel not in ("displacement", "wire_layer"):
        return ""
    has = f"{len(crane.drum.layer_radii)} layers" if channel == "wire_layer" else (
        f"motors of {crane.max_displacement / CM3_PER_REV:.4g} cm^3/rev")  # fmt: skip
    return f": is it the log of another crane? '{crane.name}' has {has}"


def _by_balance(draft: Draft, axes: Mapping[str, list[str]], members: Mapping[str, list[str]]) -> dict[str, str]:
    best: tuple[float, dict[str, str]] = (-1.0, {})
    for count, units in enumerate(product(*axes.values())):
        if count >= _COMBINATIONS:
            break
        choice = dict(zip(axes, units, strict=True))
        prior = float(np.prod([_RARER ** axes[kind].index(unit) for kind, unit in choice.items()]))
        worth = prior * _closing(draft, {n: unit for kind, unit in choice.items() for n in members[kind]})
        if worth > best[0]:
            best = (worth, choice)
    return best[1]


def _undecided(
    draft: Draft, chosen: Mapping[str, str], kind: str, options: Sequence[str], members: Mapping[str, list[str]]
) -> bool:
    """Whether another unit of one channel would fit the balance and the wire's motion as well."""

    def evidence(choice: Mapping[str, str]) -> float:
        return _closing(draft, {n: unit for k, unit in choice.items() for n in members[k]})

    best = evidence(chosen)
    return any(evidence({**chosen, kind: unit}) > _AS_WELL * best for unit in options if unit != chosen[kind])


def _closing(draft: Draft, units: Mapping[str, str]) -> float:
    """How well the torque balance and the rope's motion fit with these units, 0 ... 1."""
    if draft.crane is None:
        return 1.0
    entries = {n: replace(e, unit=units.get(n, e.unit)) for n, e in draft.log_map.columns.items()}
    trial = replace(draft.log_map, columns=entries)
    worth = []
    for log in draft.logs[:4]:
        columns = convert(log, trial, draft.crane, strict=False).columns
        found = closure(columns, draft.crane)
        ratio = rope_over_motor(columns, draft.crane)
        off = 0.0 if ratio is None else np.log(max(abs(ratio.value), 1e-9)) / 0.3
        gain = power_ratio(columns, draft.crane)
        if gain is not None:  # a sharper test than the mean torque, which needs a power over a speed near zero
            off, found = np.log(max(abs(gain), 1e-9)) / 0.3, None
        worth.append(np.exp(-0.5 * (min(found.mismatch, 30.0) ** 2 if found else 0.0) - 0.5 * min(off**2, 400.0)))
    return float(np.mean(worth)) + 1e-12


def _set_unit(draft: Draft, name: str, options: Sequence[str], chosen: str | None) -> None:
    entry = draft.log_map.columns[name]
    if entry.unit:
        return
    if not options:
        column = draft.logs[0].column(entry.source)
        size = float(np.nanpercentile(np.abs(column.values), 95.0))
        channel = name.rpartition(".")[2]
        draft.questions.append(
            f"{name}: '{entry.source}' says no unit, and {size:.4g} is no usual size in "
            f"{', '.join(usual_units(channel))}{_of_crane(draft, channel)}; set {name}.unit"
        )
        return
    unit = chosen or options[0]
    if unit == "-" and CHANNEL_UNITS[name.rpartition(".")[2]][0] == "1":
        draft.change(name, unit="")
        return
    if len(options) == 1:
        draft.change(
            name,
            entry.confidence * 0.95,
            f"{_GUESSED}: of the usual ones only {unit} gives a usual size",
            unit=unit,
        )
    else:
        others = ", ".join(u for u in options if u != unit)
        draft.change(
            name,
            entry.confidence * 0.8,
            f"{_GUESSED}: {unit} closes the balance best or is the most usual ({others} possible)",
            unit=unit,
        )
