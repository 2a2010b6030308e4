"""Two mistakes at once: asked where no single one makes the runs fit. A unit beside a sign, ports beside a delay."""

from collections.abc import Iterator, Sequence
from itertools import combinations

from winch_friction.commissioning.mistakes import RARELY, Mistake

BOTH = 10.0  # prior cost of two mistakes beside those of each: as much as of a mistake that some of the runs hold
_WHOLE = ("hook_load", "motor_speed", "pressure", "displacement")  # channels of all groups and both ports


def both(first: Mistake, second: Mistake) -> Mistake:
    """Two mistakes as one: the first is undone, then the second."""
    return Mistake(
        "two", ", ".join(dict.fromkeys(filter(None, (first.channel, second.channel)))),
        f"two mistakes: {first.words}; and {second.words}", first.cost + second.cost + BOTH,
        lambda view: second.undo(first.undo(view)), parts=(first, second),
    )  # fmt: skip


def common_pairs(mistakes: Sequence[Mistake]) -> Iterator[Mistake]:
    """Each two of the common mistakes that do not concern the same thing: of those one alone may point elsewhere."""
    usual = [each for each in mistakes if each.cause in ("sign", "ports", "groups") or _is_usual_unit(each)]
    for first, second in combinations(usual, 2):
        if (first.cause, first.channel) != (second.cause, second.channel):
            yield both(first, second)


def _is_usual_unit(mistake: Mistake) -> bool:
    """A unit of a whole channel, not one of the rare ones."""
    rare = mistake.words.partition(" holds ")[2].startswith(RARELY)
    return mistake.cause == "unit" and mistake.channel in _WHOLE and not rare
