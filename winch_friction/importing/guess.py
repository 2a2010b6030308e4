"""Which column of a log is which channel: by name, unit and size together, each column for one channel at most."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import combinations

import numpy as np

from winch_friction.importing.expectations import fits
from winch_friction.importing.log import Log, LogColumn, own_name
from winch_friction.importing.names import SHORT, Concepts, name_concepts, name_score, tokens
from winch_friction.importing.units import (
    CHANNEL_UNITS,
    ambiguity,
    conversion,
    fitting_si_unit,
    header_readings,
    is_share,
    says_unit,
    usual_units,
)
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import GROUP_CHANNELS, column_unit
from winch_friction.physics.winch.crane import Crane

FEWEST = 0.14  # score below which a column is left alone: less than a fitting unit with a plausible size has
_UNIT_ALONE = 0.22  # score of a column whose unit fits and whose name says nothing known
_NO_UNIT = 0.9
_WRONG_SIZE = 0.4  # what is left of a score when no reading of the numbers has a plausible size
_OTHER_GROUP, _NO_GROUP, _NO_PORT = 0.02, 0.75, 0.6
_NAMED = 0.5  # how well a name must fit a channel to be its name, whatever it is the unit of
_SURELY = 0.92  # a whole word or part of a compound, no short form and no misspelling
_EXACT = 1.2  # a column that bears the contract's own name

_HYDRAULIC = ("motor_speed", "drum_speed", "rope_speed", "speed_reference", "hook_load", "rope_force", "heave_velocity",
              "oil_temperature", "wire_layer", "wire_out", "shaft_angle")  # fmt: skip
_GROUPS = ("main", "active", "passive")  # of motors, where no crane names them
# channels that a run can do without: one that is wrong misleads, one that is missing does not
_EXTRAS = frozenset({"speed_reference", "rope_force", "heave_velocity", "oil_temperature", "wire_layer", "wire_out",
                     "shaft_angle"})  # fmt: skip
_ELECTRIC = (*_HYDRAULIC, "motor_torque", "load_torque", "mechanical_power", "motor_current")


@dataclass(frozen=True)
class Slot:
    """A channel of the run that wants a column: its contract name, its kind and its motor group."""

    name: str
    channel: str
    group: str = ""


@dataclass(frozen=True)
class Match:
    """A column for a slot: the unit ('' when the log says none) and how good the match is; `why` in words."""

    slot: Slot
    column: LogColumn
    unit: str
    score: float
    why: str

    @property
    def confidence(self) -> float:
        """The score as a share of certainty."""
        return float(min(0.99, self.score))


def matches(log: Log, crane: Crane | None, taken: Iterable[str] = ()) -> dict[str, Match]:
    """The best assignment of columns to channels, over the sets of motor groups that the crane can run with."""
    columns = [c for c in log.columns if c.numeric and c.name not in set(taken) and np.isfinite(c.values).any()]
    best: tuple[float, dict[str, Match]] = (-np.inf, {})
    for groups in group_sets(crane):
        slots = _slots(crane, groups)
        found = _assigned(columns, slots, crane, len(groups))
        lacking = sum(1 for s in slots if s.group and s.name not in found)
        worth = sum(m.score for m in found.values()) - 0.6 * lacking
        if worth > best[0]:
            best = (worth, found)
    return _of_one_kind(best[1])


def _of_one_kind(found: dict[str, Match]) -> dict[str, Match]:
    """The matches without those of a column whose namesake is more surely another kind of channel: two pressures may
    bear one name, a load and a temperature do not.
    """
    kept = dict(found)
    for name, match in found.items():
        kind = match.slot.channel.removesuffix("_a").removesuffix("_b")
        for other in found.values():
            namesakes = other is not match and own_name(other.column.name) == own_name(match.column.name)
            if namesakes and not other.slot.channel.startswith(kind) and other.score >= match.score:
                kept.pop(name, None)
    return kept


def group_sets(crane: Crane | None) -> list[tuple[str, ...]]:
    """The sets of motor groups that may drive at once: each one alone, and those that together are not all of them."""
    if crane is None:
        return [("main",), ("active", "passive"), ()]
    if not crane.drive.hydraulic or not crane.groups:
        return [()]
    names = tuple(crane.groups)
    most = max(crane.groups.values())
    several = [c for k in range(2, len(names) + 1) for c in combinations(names, k)]
    alike = [c for c in several if sum(crane.groups[g] for g in c) <= most]  # 3 active + 8 passive are the 11 of main
    return [(name,) for name in names] + (alike or several)


def _slots(crane: Crane | None, groups: Sequence[str]) -> list[Slot]:
    plain = _HYDRAULIC if crane is not None and crane.drive.hydraulic else _ELECTRIC
    return [Slot(name, name) for name in plain] + [Slot(f"{g}.{c}", c, g) for g in groups for c in GROUP_CHANNELS]


def _assigned(
    columns: Sequence[LogColumn], slots: Sequence[Slot], crane: Crane | None, groups: int
) -> dict[str, Match]:
    from scipy.optimize import linear_sum_assignment

    table = [[_match(column, slot, crane, groups) for slot in slots] for column in columns]
    if not table:
        return {}
    scores = np.array([[m.score if m else 0.0 for m in row] for row in table])
    rows, picks = linear_sum_assignment(-np.where(scores >= FEWEST, scores, 0.0))
    return {
        slots[j].name: match
        for i, j in zip(rows, picks, strict=True)
        if (match := table[i][j]) is not None and match.score >= FEWEST
    }


def _match(column: LogColumn, slot: Slot, crane: Crane | None, groups: int) -> Match | None:
    """The best reading of a column for a slot, None when its unit belongs to something else."""
    best: Match | None = None
    name = own_name(column.name)
    readings = header_readings(name)
    for bare, unit in sorted(readings, key=lambda reading: not reading[1]):
        if not unit and any(says_unit(name, said) for _, said in readings if said):
            break  # a unit that is said is no word of the name; a single letter may be a port
        if unit and column.unit and not says_unit(name, unit):
            continue  # where a row of units says bar, the A of `Druck A` is no ampere
        unit = unit or column.unit
        score, why = _reading_score(column, bare, unit, slot, groups, crane.groups if crane else _GROUPS)
        if score <= 0.0:
            continue
        score, size = _with_size(score, column, unit, slot.channel, crane)
        if best is None or score > best.score:
            best = Match(slot, column, unit, score, why + size)
    return best


def _reading_score(
    column: LogColumn, bare: str, unit: str, slot: Slot, groups: int, known: Iterable[str]
) -> tuple[float, str]:
    if column_unit(bare) is not None and bare.rpartition(".")[0] in ("", *known):
        return (_EXACT, "the contract's own name") if bare == slot.name else (0.0, "")
    fitting = fitting_si_unit(slot.channel, unit) if unit else ""
    if fitting is None or (slot.channel == "rope_speed" and unit and fitting != "m/s"):
        return 0.0, ""
    if slot.channel == "motor_speed" and fitting == "m/s":
        return 0.0, ""  # a speed of the rope has its own slot
    concepts = _concepts(bare)
    if fitting == "1" and not _says_whose_share(slot.channel, unit, concepts):
        return 0.0, ""
    if slot.channel == "rope_speed" and not unit and not any("rope" in token for token in concepts):
        return 0.0, ""
    if slot.channel in _EXTRAS and _is_elsewhere(slot.channel, concepts):
        return 0.0, ""
    if slot.channel == "oil_temperature" and not unit and _is_letter("temperature", concepts):
        return 0.0, ""
    score = max(name_score(slot.channel, concepts), 0.9 * name_score(slot.channel, _concepts(column.note)))
    why = f"name '{bare}'"
    if unit and score < _UNIT_ALONE and _unit_tells(slot.channel, unit) and not _is_other(slot, concepts):
        score, why = _UNIT_ALONE, f"unit '{unit}' alone, the name '{bare}' says nothing known"
    if slot.group and score:
        score *= _group_factor(concepts, bare, slot, groups)
    return score * (1.0 if unit else _NO_UNIT), why + (f", unit '{unit}'" if unit and "unit" not in why else "")


def _says_whose_share(channel: str, unit: str, concepts: Sequence[Concepts]) -> bool:
    """Whether the name of a share says nothing but the channel, as that of a fan's speed in % does not; the drum is
    named. A plain 1 is no share of a speed: it is the end of `min-1`.
    """
    if channel not in ("motor_speed", "drum_speed"):
        return True
    if conversion(channel, unit, "", of=1.0).scale == 1.0:
        return False
    return all(concepts) and (channel == "motor_speed" or any("drum" in token for token in concepts))


def _is_other(slot: Slot, concepts: Sequence[Concepts]) -> bool:
    """Whether a name says something else: what no channel is (a valve, a wind, an energy), or another channel."""
    if any(token.get("other", 0.0) > 0.7 or token.get("energy", 0.0) > 0.7 for token in concepts):
        return True
    return any(name_score(c, list(concepts)) > _NAMED for c in CHANNEL_UNITS if c != slot.channel)


def _is_elsewhere(channel: str, concepts: Sequence[Concepts]) -> bool:
    """Whether a name says what is beside the winch, such as the sea's temperature, or of a reference only a speed."""
    if channel == "speed_reference" and not any("reference" in token for token in concepts):
        return True
    if channel == "shaft_angle" and any("displacement" in token for token in concepts):
        return True  # the angle of a swash plate
    fits = {"oil"} if channel == "oil_temperature" else set()  # the oil of the case, of the pump
    return any(token.get("other", 0.0) > _SURELY for token in concepts) and not any(fits & set(t) for t in concepts)


def _is_letter(concept: str, concepts: Sequence[Concepts]) -> bool:
    """Whether a name says a concept by a short form alone, as the T of a symbol that may be tonnes, beside no oil."""
    said = max((token.get(concept, 0.0) for token in concepts), default=0.0)
    return said <= SHORT and not any("oil" in token for token in concepts)


@lru_cache(maxsize=512)
def _unit_tells(channel: str, unit: str) -> bool:
    """Whether few channels are logged in this unit, so that it tells the channel when the name does not."""
    homes = {c.replace("_b", "_a") for c in CHANNEL_UNITS if fitting_si_unit(c, unit) == CHANNEL_UNITS[c][0]}
    return channel.replace("_b", "_a") in homes and len(homes - {"drum_speed", "speed_reference", "load_torque"}) <= 2


def _group_factor(concepts: Sequence[Concepts], bare: str, slot: Slot, groups: int) -> float:
    """How well the name's words for motor group and port agree with the slot's."""
    factor = 1.0
    if groups > 1 or slot.group != "main":
        said = {c: q for token in concepts for c, q in token.items() if c in ("active", "passive", "main")}
        own = slot.group in tokens(bare) or said.get(slot.group, 0.0) > 0.0
        sure_other = any(
            c != slot.group
            for token in concepts
            for c in token
            if c in ("active", "passive", "main") and len(token) == 1
        )
        factor *= 1.0 if own else (_OTHER_GROUP if sure_other else (_NO_GROUP if said == {} else 0.5))
    elif any(set(token) & {"active", "passive"} and len(token) == 1 for token in concepts):
        factor *= 0.3  # a log that names active and passive groups is no log of the main one
    if slot.channel in ("pressure_a", "pressure_b"):
        ports = {c for token in concepts for c in token if c in ("port_a", "port_b")}
        wanted = slot.channel.replace("pressure", "port")
        factor *= 1.0 if wanted in ports else (_OTHER_GROUP if ports else _NO_PORT)
    return factor


def _with_size(score: float, column: LogColumn, unit: str, channel: str, crane: Crane | None) -> tuple[float, str]:
    """The score after a look at the numbers; for a column without a unit at what they would be in the usual ones."""
    if unit and ambiguity(channel, unit):
        return score, ""
    if plausible_units(column, unit, channel, crane):
        return score, ""
    said = f"; but no usual size in '{unit}'" if unit else "; but no usual size in any usual unit"
    return score * _WRONG_SIZE, said


def plausible_units(column: LogColumn, unit: str, channel: str, crane: Crane | None) -> list[str]:
    """The units in which a column has the size of the channel: of the one that is said, else of the usual ones."""
    if unit and channel != "displacement" and is_share(channel, unit):
        return [unit]  # of what, the person says; then its size is looked at
    return [
        each
        for each in ([unit] if unit else usual_units(channel))
        if (values := in_si(column, each, channel, crane)) is not None and fits(channel, values, crane)
    ]


def in_si(column: LogColumn, unit: str, channel: str, crane: Crane | None) -> np.ndarray | None:
    """A column's values in SI if it were logged in a unit; None when the unit does not fit the channel."""
    if channel == "heave_velocity" and fitting_si_unit(channel, unit) == "m":
        return column.values  # a position of metres: its speed has the same size at a ship's periods
    of = crane.max_displacement if crane is not None and channel == "displacement" else 1.0
    try:
        found = conversion(channel, unit, "", of=of or 1.0)
    except InputError:
        return None
    return column.values * found.scale + found.offset


@lru_cache(maxsize=4096)
def _concepts(name: str) -> list[Concepts]:
    return name_concepts(name) if name else []
