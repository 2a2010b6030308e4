"""A user's own simulation beside the measurement: not the same numbers, but the same signal in the same unit."""

from collections.abc import Iterator, Sequence

import numpy as np

from winch_friction.commissioning.channels import Finding
from winch_friction.physics.signals import FloatArray, Run

SIMULATED = "_simulated"
# times the measured one: without any friction, and with the hook alone, a simulation has still a tenth of it; no
# missing effect makes it twice as large
SMALLEST, LARGEST = 0.05, 2.0
MET = 0.1  # relative, by which a unit's factor is met
UNITS = {1e5: "Pa", 14.5: "psi under [bar]", 100.0: "kPa under [bar]", 10.0: "bar under [MPa]", 0.1: "MPa under [bar]",
         1e-3: "kN under [N]", 1e3: "N under [kN]", 1e-5: "bar under [Pa] (a column without a unit is in SI)",
         1e-6: "MPa under [Pa] (a column without a unit is in SI)"}  # fmt: skip


def simulated_findings(runs: Sequence[Run], hydraulic: bool) -> Iterator[Finding]:
    """Simulated columns that are no such thing: another unit, the other sign, nothing at all.

    Of an electric drive, whose friction may be all of its torque, it is said and refutes nothing.
    """
    for name in dict.fromkeys(name for run in runs for name in run.columns if name.endswith(SIMULATED)):
        having = tuple(run.name for run in runs if name in run and _measured(run, name) is not None)
        ratio = _ratio([run for run in runs if run.name in having], name)
        if ratio is None or SMALLEST < ratio < LARGEST:
            continue
        yield Finding(
            "error" if hydraulic else "warning", "simulation", _words(name, ratio), name, having, {"ratio": ratio}
        )


def _words(name: str, ratio: float) -> str:
    measured = name.removesuffix(SIMULATED).replace("pressure_drop", "pressure_a - pressure_b")
    if ratio == 0.0:
        return f"{name} is 0 where {measured} is not: was it written?"
    unit = next((unit for factor, unit in UNITS.items() if abs(abs(ratio) / factor - 1.0) < MET), "")
    why = "it counts the other way" if ratio < -SMALLEST else ""
    why = " and ".join(filter(None, [why, f"it holds {unit}" if unit else ""])) or "is its unit right?"
    return f"{name} is {ratio:.3g} times {measured} over these runs, which no missing effect makes of it: {why}"


def _ratio(runs: Sequence[Run], name: str) -> float | None:
    """The simulated signal as a multiple of the measured one, by least squares over all runs; None without any."""
    pairs = [(run[name], measured) for run in runs if (measured := _measured(run, name)) is not None]
    if not pairs:
        return None
    simulated, measured = (np.concatenate(each) for each in zip(*pairs, strict=True))
    known = np.isfinite(simulated) & np.isfinite(measured)
    size = float(measured[known] @ measured[known])
    return float(simulated[known] @ measured[known]) / size if size > 0.0 else None


def _measured(run: Run, name: str) -> FloatArray | None:
    """What the simulated column is compared with."""
    own = name.removesuffix(SIMULATED)
    group, _, channel = own.rpartition(".")
    if channel == "pressure_drop":
        ports = [f"{group}.pressure_{port}" for port in "ab"]
        return run[ports[0]] - run[ports[1]] if all(port in run for port in ports) else None
    return run.columns.get(own)
