"""What there is by name, for `list`, `show` and completion."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

Rows = list[dict[str, Any]]


@dataclass(frozen=True)
class Kind:
    """One kind of thing that has a name: how to list it, and the names alone (quickly, for completion)."""

    name: str
    about: str
    rows: Callable[[], Rows]
    names: Callable[[], Iterable[str]]


def _files(folder: str, suffix: str = ".yaml") -> dict[str, Path]:
    from winch_friction.records.strict_yaml import config_directory

    return {path.stem: path for path in sorted((config_directory() / folder).glob(f"*{suffix}"))}


def _models() -> Rows:
    from winch_friction.records.model_file import load_model

    models = [load_model(path) for path in _files("models").values()]
    return [
        {
            "name": m.name,
            "terms": ", ".join(m.term_names),
            "parameters": len(m.values),
            "covariance": "yes" if m.covariance is not None else "no",
            "crane": getattr(m, "crane", "") or "any",
        }
        for m in models
    ]


def models_of(crane: str) -> list[str]:
    """The shipped models that say they are of this crane."""
    return [row["name"] for row in _models() if row["crane"] == crane]


def _cranes() -> Rows:
    from winch_friction.records.crane_file import load_crane

    cranes = [load_crane(path) for path in _files("cranes").values()]
    return [
        {
            "name": c.name,
            "drive": c.drive.kind,
            "gear ratio [-]": c.gear_ratio,
            "motors": ", ".join(f"{group} {count}" for group, count in c.groups.items()) or "1",
            "rope radius [m]": f"{c.drum.layer_radii[0]:g} ... {c.drum.layer_radii[-1]:g}",
            "inertia [kg*m^2]": c.inertia,
        }
        for c in cranes
    ]


def _scenarios() -> Rows:
    from winch_friction.simulation import load_scenario

    found = [(name, load_scenario(str(path))) for name, path in _files("scenarios").items()]
    return [
        {"name": name, "duration [s]": float(s.duration), "about": _comment(_files("scenarios")[name])}
        for name, s in found
    ]


def _comment(path: Path) -> str:
    """A file's first line, and the next where the first one only announces it."""
    said = ""
    for line in path.read_text(encoding="utf-8").splitlines():
        if not line.startswith("#") or (said and not said.endswith(":")):
            break
        said = f"{said} {line.removeprefix('#').strip()}".strip()
    return said


def _suppliers() -> Rows:
    return [{"name": name, "about": _comment(path)} for name, path in _files("suppliers", ".csv").items()]


def _terms() -> Rows:
    from winch_friction.physics.friction import registered_terms

    return [
        {
            "name": name,
            "place": term.place,
            "parameters": ", ".join(f"{p.name} [{p.unit}]" for p in term.parameters),
            "source": term.source,
        }
        for name, term in sorted(registered_terms().items())
    ]


def _effects() -> Rows:
    from winch_friction.physics.effects import effect_texts

    return [{"name": e.name, "what it is": e.title, "usual size": e.size} for e in effect_texts().values()]


def _units() -> Rows:
    from winch_friction.physics.channels import CHANNELS, accepted_units

    return [
        {
            "name": f"<group>.{c.name}" if c.of_group else c.name,
            "SI": c.unit,
            "read as": c.display,
            "also accepted": ", ".join(u for u in accepted_units(c.unit) if u not in (c.unit, c.display)) or "-",
            "about": c.doc,
        }
        for c in CHANNELS
    ]


def _effect_names() -> list[str]:
    from winch_friction.physics.effects import effect_texts

    return list(effect_texts())


def _term_names() -> list[str]:
    from winch_friction.physics.friction import registered_terms

    return sorted(registered_terms())


KINDS = {
    kind.name: kind
    for kind in (
        Kind("models", "friction models that are shipped", _models, lambda: _files("models")),
        Kind("cranes", "cranes that are shipped", _cranes, lambda: _files("cranes")),
        Kind("scenarios", "what the simulator can sail", _scenarios, lambda: _files("scenarios")),
        Kind("suppliers", "suppliers' tables of motor losses", _suppliers, lambda: _files("suppliers", ".csv")),
        Kind("terms", "declared friction terms", _terms, _term_names),
        Kind("effects", "effects that a model can lack", _effects, _effect_names),
        Kind("units", "run columns with their units", _units, lambda: [row["name"] for row in _units()]),
    )
}
_OF_ONE = {"model": "models", "crane": "cranes", "scenario": "scenarios", "term": "terms", "effect": "effects"}
SHOWN = tuple(_OF_ONE)


def kind_of(name: str) -> str | None:
    """Whether a name is a model's, a crane's, a scenario's, an effect's or a term's; None for none of them."""
    for one, kind in _OF_ONE.items():
        if name in KINDS[kind].names():
            return one
    return None


def names_of(one: str) -> Iterable[str]:
    """The names of the models, cranes, scenarios, effects or terms; `one` is the kind's name for one of them."""
    return KINDS[_OF_ONE[one]].names()


def _completion(*kinds: str) -> Callable[[str], list[str]]:
    def complete(incomplete: str) -> list[str]:
        return [name for kind in kinds for name in KINDS[kind].names() if name.startswith(incomplete)]

    return complete


complete_model, complete_crane = _completion("models"), _completion("cranes")
complete_scenario, complete_term = _completion("scenarios"), _completion("terms")
complete_shown = _completion(*_OF_ONE.values())
complete_kind: Callable[[str], list[str]] = lambda incomplete: [k for k in KINDS if k.startswith(incomplete)]
