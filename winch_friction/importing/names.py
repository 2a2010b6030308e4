"""What a column's name says: its words as concepts, and how well they name a channel (the words are in words.yaml).

A name is cut into tokens (`vinsj_hastighet`, `DruckA`), a token into the words of a compound (`Windendrehzahl`); what
is in no list is compared with what is: by spelling, as the beginning of a word, as its consonants.
"""

import difflib
import re
import unicodedata
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib.resources import files
from typing import Any

import yaml

EXACT, SHORT, COMPOUND, BEGINNING, MISSPELT, CONSONANTS = 1.0, 0.9, 0.95, 0.75, 0.8, 0.6
_SIMILAR = 0.82  # share of equal letters from which a word counts as the misspelt other
_CLOSE = 0.85  # the same for the second word of a compound, whose first one is known
_LINKS = ("", "s", "n", "en", "e", "es", "er")  # what German and Norwegian put between the words of a compound
_FOLD = str.maketrans({"ä": "a", "æ": "a", "ö": "o", "ø": "o", "ü": "u", "å": "a", "ß": "ss"})
_TYPE = re.compile(
    r"(?<![^\W\d_])(?:f|r|lr)(?=[A-ZÄÖÜÆØÅ][a-zäöüæøåß])"
)  # a controller's mark of a real number: fHookLoad
_NEUTRAL = frozenset({"actual"})  # says nothing of what is measured

Concepts = Mapping[str, float]  # concept -> how surely a token means it, 0 ... 1


@dataclass(frozen=True)
class Vocabulary:
    """`words` and `short`: folded word -> concepts; `channels`: needs, likes, against; `stop`: no meaning."""

    words: Mapping[str, tuple[str, ...]]
    short: Mapping[str, tuple[str, ...]]
    channels: Mapping[str, Mapping[str, Any]]
    stop: frozenset[str]


@lru_cache(maxsize=1)
def vocabulary() -> Vocabulary:
    """The shipped words."""
    text = files("winch_friction.importing").joinpath("words.yaml").read_text(encoding="utf-8")
    content = yaml.load(text, Loader=yaml.BaseLoader)  # words alone: 'no' is one, not a truth value
    words: dict[str, tuple[str, ...]] = {}
    short: dict[str, tuple[str, ...]] = {}
    for concept, entry in content["concepts"].items():
        for known, table in ((entry["words"], words), (entry["short"], short)):
            for word in known:
                folded = _folded(word).replace("_", "")
                table[folded] = (*table.get(folded, ()), concept)
    stop = frozenset(map(_folded, content["stop"])) - set(words) - set(short)
    return Vocabulary(words, short, content["channels"], stop)


def tokens(name: str) -> list[str]:
    """The folded words of a name: cut at everything that is no letter, and where a capital begins; without a
    controller's mark of the type."""
    text = unicodedata.normalize("NFC", name).replace("°", " ")
    text = _TYPE.sub("", text)
    text = re.sub(r"(?<=[a-zäöüæøåß])(?=[A-ZÄÖÜÆØÅ])", " ", text)
    return [_folded(each) for each in re.findall(r"[^\W\d_]+|\d+", text)]


def _folded(text: str) -> str:
    text = text.casefold().translate(_FOLD)
    text = "".join(c for c in unicodedata.normalize("NFD", text) if not unicodedata.combining(c))
    for pair, letter in (("ae", "a"), ("oe", "o"), ("ue", "u"), ("aa", "a")):
        text = text.replace(pair, letter)
    return text


def name_concepts(name: str) -> list[Concepts]:
    """The concepts of each token of a name, empty for a token that says nothing known; numbers are left out."""
    found: list[Concepts] = []
    parts = [each for each in tokens(name) if not each.isdigit() and each not in vocabulary().stop]
    while parts:  # first as many tokens as make one word: 'ground_tether', 'paid out'
        for count in (3, 2, 1):
            joined = "".join(parts[:count])
            if count == 1:
                found.extend(_token_concepts(joined))
            elif len(parts) >= count and len(joined) > 4 and joined in vocabulary().words:
                found.append(_all(vocabulary().words[joined], EXACT))
            elif len(parts) >= count and _is_symbol(parts[:count]):
                found.append(_all(vocabulary().short[joined], SHORT))
            else:
                continue
            parts = parts[count:]
            break
    return found


def _is_symbol(parts: list[str]) -> bool:
    """Whether letters are a symbol and its index (`V_g`), of which the index alone says nothing."""
    short = vocabulary().short
    return max(map(len, parts)) == 1 and "".join(parts) in short and any(part not in short for part in parts)


@lru_cache(maxsize=4096)
def _token_concepts(token: str) -> tuple[Concepts, ...]:
    known = vocabulary()
    if token in known.words or token in known.short:
        exact = _all(known.short.get(token, ()), SHORT)
        return ({**exact, **_all(known.words.get(token, ()), EXACT)},)
    compound = _compound(token)
    if compound:
        return tuple(_all(concepts, COMPOUND) for concepts in compound)
    return (_alike(token),)


def _compound(token: str) -> list[tuple[str, ...]] | None:
    """The words of a compound from the left, the longest first; two short forms make one as well (`pA`)."""
    words, short = vocabulary().words, vocabulary().short
    if len(token) == 2 and all(letter in short for letter in token):
        return [short[letter] for letter in token]
    for cut in range(len(token) - 1, 2, -1):
        head, rest = token[:cut], token[cut:]
        if head not in words:
            continue
        for link in _LINKS:
            if not rest.startswith(link):
                continue
            tail = rest[len(link) :]
            if tail not in words and len(tail) > 4:  # the second word misspelt, or a neighbour's language
                tail = next(iter(difflib.get_close_matches(tail, words, 1, _CLOSE)), tail)
            if tail in words or (tail in short and (len(tail) > 2 or tail in ("a", "b"))):
                return [words[head], words.get(tail) or short[tail]]
            further = _compound(tail) if len(tail) > 5 else None
            if further:
                return [words[head], *further]
    return None


def _alike(token: str) -> Concepts:
    """The concepts of words that a token may be a spelling of."""
    found: dict[str, float] = {}
    if len(token) < 3:
        return found
    for word, concepts in vocabulary().words.items():
        quality = _likeness(token, word)
        for concept in concepts if quality else ():
            found[concept] = max(found.get(concept, 0.0), quality)
    best = max(found.values(), default=0.0)
    return {concept: quality for concept, quality in found.items() if quality >= best - 0.05}


def _likeness(token: str, word: str) -> float:
    if len(word) > 3 and token.startswith(word):
        return BEGINNING + 0.1
    if len(word) > 3 and token.endswith(word):
        return BEGINNING + 0.1
    if word.startswith(token):
        return BEGINNING
    if min(len(token), len(word)) > 4 and abs(len(token) - len(word)) <= 2:
        ratio = difflib.SequenceMatcher(None, token, word).ratio()
        if ratio >= _SIMILAR:
            return MISSPELT * ratio
    return CONSONANTS if _is_abbreviation(token, word) else 0.0


def _is_abbreviation(token: str, word: str) -> bool:
    """Whether the token keeps the first letter and the order of the word's letters, and no vowel but the first."""
    if token[0] != word[0] or len(token) * 3 < len(word) or any(letter in "aeiou" for letter in token[1:]):
        return False
    letters = iter(word)
    return all(letter in letters for letter in token)


def _all(concepts: Iterable[str], quality: float) -> dict[str, float]:
    return dict.fromkeys(concepts, quality)


NAMED = 0.5  # how well a name must fit a channel to be taken for its name


def name_score(channel: str, concepts: list[Concepts]) -> float:
    """How well a name's concepts name a channel, 0 (not at all) ... 1; `channel` without its motor group."""
    spec = vocabulary().channels[channel]
    against, likes = spec.get("against", ()), set(spec.get("likes", ())) | _NEUTRAL
    needs = [set(each) for each in spec["needs"]]
    said = [max((token.get(c, 0.0) for token in concepts for c in need), default=0.0) for need in needs]
    score = 0.75 * sum(said) / len(said) + (0.25 if not all(said) else 0.15)
    score += 0.1 * max((token.get(c, 0.0) for token in concepts for c in likes - _NEUTRAL), default=0.0) * all(said)
    if not any(said):
        return 0.0
    for token in concepts:
        score *= _fit_of_token(token, set().union(*needs), likes, against)
    return score * (1.0 if all(said) else 0.5)


def _fit_of_token(token: Concepts, needed: set[str], likes: set[str], against: Iterable[str]) -> float:
    if not token:
        return 0.93  # a word that is in no list
    if set(token) & needed:
        return 1.0
    best = max(token, key=lambda c: token[c])
    if set(token) & likes or best in ("active", "passive", "main", "port_a", "port_b"):
        return 1.0
    return 0.25 if best in against or best == "other" else 0.5
