"""An FMU (co-simulation 2.0, pythonfmu) of a user's simulation: friction laws that the package does not have."""

import subprocess
import sys
from pathlib import Path

# tanh instead of a sign, no Stribeck curve; the acceleration from the speed alone, as a simulation driven by it has
SOURCE = """
import math

from pythonfmu import Fmi2Causality, Fmi2Slave, Real


class OwnWinch(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.omega, self.mass, self.swept, self.dp, self.motors = 0.0, 50.0, 215.0, 0.0, 11.0
        self.before, self.alpha = None, 0.0
        for name in ("omega", "mass", "swept"):
            self.register_variable(Real(name, causality=Fmi2Causality.input))
        self.register_variable(Real("dp", causality=Fmi2Causality.output))

    def do_step(self, time, step):
        speed, load = self.omega * math.pi / 30.0, 1000.0 * self.mass
        if self.before is not None:
            self.alpha += (((speed - self.before) / step) - self.alpha) * 0.2
        self.before = speed
        lever = 1.136 / 250.0
        torque = load * 9.80665 * lever + (1.54 + load * lever**2) * self.alpha
        torque += math.tanh(speed / 2.0) * (0.11 * load * 9.80665 * lever + 60.0) + 1.9 * speed
        self.dp = torque / (11.0 * self.swept * 1e-6 / (2.0 * math.pi)) / 1e5
        return True
"""
MAP = """schema: winch_friction.fmu/1
inputs:
  omega: {column: motor_speed, unit: rpm}
  mass: {column: hook_load, unit: t}
  swept: {column: main.displacement, unit: cm^3/rev}
outputs:
  dp: {column: main.pressure_drop_simulated, unit: bar}
"""


def build(folder: Path) -> tuple[Path, Path]:
    """The FMU and its mapping file in a folder; raises `CalledProcessError` when pythonfmu cannot build it."""
    (folder / "own_winch_fmu.py").write_text(SOURCE, encoding="utf-8")
    call = [sys.executable, "-m", "pythonfmu", "build", "-f", "own_winch_fmu.py"]
    subprocess.run(call, cwd=folder, check=True, capture_output=True, timeout=60)
    (folder / "map.yaml").write_text(MAP, encoding="utf-8")
    return folder / "OwnWinch.fmu", folder / "map.yaml"
