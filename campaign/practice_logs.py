"""The test cycles of paper 2, Tables 2 and 5, and its two AHC tests, driven on the simulated crane with its sensors."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from winch_friction.physics.channels import CM3_PER_REV, RPM
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import Run
from winch_friction.physics.winch import Crane
from winch_friction.simulation.scenario import Scenario, scenario_from_content
from winch_friction.simulation.simulator import SimulationResult, simulate

# name: displacement per motor cm^3/rev, winch load t (the empty hook weighs about 2 t)
TABLE_2 = {"test_01": (215, 2), "test_02": (215, 77), "test_03": (215, 107), "test_04": (164, 2), "test_05": (164, 77),
           "test_06": (164, 107), "test_07": (200, 2)}  # fmt: skip
TABLE_5 = {
    "test_08": (200, 107),
    "test_09": (146, 77),
    "test_10": (120, 77),
    "test_11": (146, 107),
    "test_12": (102, 2),
}
AHC = {"ahc_215": 215, "ahc_160": 160}
_SPEEDS = (15, 30, 60, 100, 150, 220, 300, 450, 650, 850, 1050, 1300, 1600, 1900)  # rpm
_PUMP_FLOW = 0.0445  # m^3/s
_USED_FLOW = 0.93


@dataclass(frozen=True)
class SensorErrors:
    """Systematic errors of one crane's sensors: displacement and pressure scale, pressure zero error in Pa."""

    displacement_scale: float = 1.0
    pressure_scale: float = 1.0
    pressure_offset: float = 0.0

    @classmethod
    def drawn(cls, generator: np.random.Generator) -> "SensorErrors":
        """docs/simulation.md: 0.25 % transducers of 600 bar, displacement feedback within 1-3 %."""
        return cls(
            displacement_scale=1.0 + 0.01 * generator.standard_normal(),
            pressure_scale=1.0 + 0.0025 * generator.standard_normal(),
            pressure_offset=0.75e5 * generator.standard_normal(),
        )

    def settings(self, *groups: str) -> dict[str, Any]:
        """As a scenario's sensor settings; the zero error sits on side a."""
        sides = [f"{group}.pressure_{side}" for group in groups for side in "ab"]
        return {
            "displacement_scale": {f"{group}.displacement": self.displacement_scale for group in groups},
            "pressure_scale": dict.fromkeys(sides, self.pressure_scale),
            "pressure_offset": {f"{group}.pressure_a": self.pressure_offset for group in groups},
        }


def cycle_scenario(name: str, cm3: float, tonnes: float, errors: SensorErrors, rate: float = 20.0) -> Scenario:
    """One test cycle: every speed that the pump can give, hoisted and lowered, 5 s each (paper 2 Fig 6)."""
    fastest = _USED_FLOW * _PUMP_FLOW / (11 * cm3 * CM3_PER_REV) / RPM
    speeds = [speed for speed in _SPEEDS if speed <= fastest]
    hold, ramp, rest = 5.0, 2.0, 1.0
    return scenario_from_content(
        {
            "schema": "winch_friction.scenario/1",
            "name": name,
            "duration": rest + len(speeds) * (3 * ramp + 2 * hold + rest),
            "mode": "normal",
            "load": {"value": tonnes, "unit": "t"},
            "displacement": {"value": cm3, "unit": "cm^3/rev"},
            "profile": {"plateaus": [s * RPM for s in speeds], "hold": hold, "ramp": ramp, "rest": rest},
            "sensors": {"rate": rate, **errors.settings("main")},
        }
    )


def ahc_scenario(name: str, cm3: float, errors: SensorErrors, rate: float = 50.0) -> Scenario:
    """Paper 2 section 4.3: 55 t on the outer layer, an artificial wave profile, the crane itself at rest."""
    time = np.arange(0.0, 80.0, 0.1)
    amplitude = 0.5 - 0.5 * np.cos(np.pi * np.clip(time / 10.0, 0.0, 1.0))
    wave = 190.0 * np.sin(2 * np.pi * time / 12.0) + 35.0 * np.sin(2 * np.pi * time / 7.3)
    speed = 130.0 * np.tanh(amplitude * wave / 110.0)  # flat tops: stretches of constant speed, as in paper 2 Fig 20
    return scenario_from_content(
        {
            "schema": "winch_friction.scenario/1",
            "name": name,
            "duration": 80.0,
            "mode": "ahc",
            "load": {"value": 55, "unit": "t"},
            "displacement": {"value": cm3, "unit": "cm^3/rev"},
            "passive_displacement": {"value": 70, "unit": "cm^3/rev"},
            "profile": {"points": [[float(t), float(v)] for t, v in zip(time, speed, strict=True)]},
            "sensors": {"rate": rate, **errors.settings("active", "passive")},
        }
    )


def drive_tests(
    tests: dict[str, tuple[float, float]],
    crane: Crane,
    model: FrictionModel,
    seed: int,
    errors: SensorErrors,
    **options: Any,
) -> dict[str, SimulationResult]:
    """Drive tests of a table; the hidden effects of `options['hidden']` are put into the plant."""
    hidden = options.pop("hidden", ())
    results = {}
    for k, (name, (cm3, tonnes)) in enumerate(tests.items()):
        result = simulate(cycle_scenario(name, cm3, tonnes, errors, **options), crane, model, seed * 100 + k, hidden)
        results[name] = replace(result, run=renamed(result.run, name))
    return results


def drive_ahc(crane: Crane, model: FrictionModel, seed: int, errors: SensorErrors, **options: Any) -> dict[str, Run]:
    """Drive both AHC tests."""
    hidden = options.pop("hidden", ())
    return {
        name: renamed(
            simulate(ahc_scenario(name, cm3, errors, **options), crane, model, seed * 100 + 50 + k, hidden).run, name
        )
        for k, (name, cm3) in enumerate(AHC.items())
    }


def renamed(run: Run, name: str) -> Run:
    """The run under the test's name."""
    return replace(run, name=name)
