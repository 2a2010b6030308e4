"""Speed as ratios against what one would use instead: `winch-friction bench`, `make bench`."""

# in the order of the table
NAMES = (
    "estimator",
    "compensator",
    "model",
    "simulator",
    "integrators",
    "fits",
    "replay",
    "dds",
    "live",
    "size",
    "verbs",
    "naming",
    "startup",
    "memory",
)
