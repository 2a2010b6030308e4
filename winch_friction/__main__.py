"""`python -m winch_friction`: the command line without its console script."""

from winch_friction.cli.entry import main

if __name__ == "__main__":
    main()
