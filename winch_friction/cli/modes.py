"""How much the command line says, and how: chosen once, before any library that draws is imported."""

from collections.abc import Sequence

QUIET, PLAIN = ("--quiet", "-q"), ("--plain",)


class Modes:
    """The modes of this command line."""

    quiet = False  # nothing but results and errors: no progress, no warnings
    plain = False  # tables as columns between tabs, no frames, no colour: for pipes, screen readers, slow lines


def without_modes(arguments: Sequence[str]) -> list[str]:
    """The words without --quiet and --plain, which are taken wherever they stand (not behind `--`)."""
    words = list(arguments)
    end = words.index("--") if "--" in words else len(words)
    Modes.quiet = any(word in QUIET for word in words[:end])
    Modes.plain = any(word in PLAIN for word in words[:end])
    return [word for k, word in enumerate(words) if k >= end or word not in (*QUIET, *PLAIN)]
