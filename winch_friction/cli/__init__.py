"""The command line, and how much it says: chosen once by `cli.main`, before any library that draws is imported."""


class Modes:
    """The modes of this command line."""

    quiet = False  # nothing but results and errors: no progress, no warnings
    plain = False  # tables as columns between tabs, no frames, no colour: for pipes, screen readers, slow lines
