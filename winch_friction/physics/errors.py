"""The one error that bad input raises."""


class InputError(ValueError):
    """Bad input, said in one line: what, where (file, row, column, parameter) and what to do."""
