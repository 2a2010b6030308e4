"""The one error that bad input raises."""


class InputError(ValueError):
    """Bad input, said in one line: what, where (file, row, column, parameter) and what to do.

    >>> import winch_friction as wf
    >>> try:
    ...     wf.load_crane("no_such_crane")
    ... except wf.InputError as error:
    ...     print("no_such_crane" in str(error), len(str(error).splitlines()))
    True 1
    """
