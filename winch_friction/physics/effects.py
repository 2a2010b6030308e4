"""What a missing effect is, in words: one entry per effect, in effects.yaml, for reports, command line and docs."""

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path


@dataclass(frozen=True)
class EffectText:
    """An effect: a title, its physics in two sentences, its usual size, and what to look at next."""

    name: str
    title: str
    physics: str
    size: str
    look: str


@lru_cache(maxsize=1)
def effect_texts() -> dict[str, EffectText]:
    """Every described effect by its identifier, in the order of the catalogue."""
    import yaml

    content = yaml.safe_load(Path(__file__).with_suffix(".yaml").read_text(encoding="utf-8"))
    return {name: EffectText(name, **entry) for name, entry in content.items()}


def effect_text(name: str) -> EffectText:
    """The text of an effect; one that is not in the catalogue (a term of a user's own) gets its declaration's words."""
    if name in effect_texts():
        return effect_texts()[name]
    from winch_friction.physics.friction import registered_terms

    term = registered_terms().get(name)
    said = (term.doc or f"The term '{name}' as declared ({term.source}).") if term else f"'{name}' has no description."
    return EffectText(name, name.replace("_", " "), said, "", "See the declaration of the term.")
