"""Sets of scenarios: the tests of paper 2, and the campaign that the discrepancy workflow is measured with. They are
planned for the 150 t crane of paper 2; `fitted` makes them another crane's.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from winch_friction.physics.channels import CM3_PER_REV
from winch_friction.physics.errors import InputError
from winch_friction.physics.winch.crane import Crane
from winch_friction.simulation.plant_file import PlantFile, load_plant, refuse_others
from winch_friction.simulation.scenario import Jonswap, Regular, Scenario, scenario_from_content

# paper 2 Tables 2 and 5: test -> displacement per motor cm^3/rev, load t (the hook alone weighs about 2 t)
PAPER_TESTS = {
    1: (215, 2), 2: (215, 77), 3: (215, 107), 4: (164, 2), 5: (164, 77), 6: (164, 107), 7: (200, 2), 8: (200, 107),
    9: (146, 77), 10: (120, 77), 11: (146, 107), 12: (102, 2),
}  # fmt: skip
PUMP_SHARES = (0.02, 0.05, 0.1, 0.15, 0.25, 0.4, 0.6, 0.8, 0.95)
CAMPAIGN_START = 1_706_745_600.0  # Unix time of 1 February 2024
DAY = 86400.0  # s


@dataclass(frozen=True)
class _Cycle:
    displacement: float  # cm^3/rev
    load: float  # t
    layer: int
    oil: float  # degC at the start


@dataclass(frozen=True)
class _Compensation:
    displacement: float
    load: float
    layer: int
    oil: float
    sea: dict[str, Any]


_CYCLES = (
    _Cycle(215, 2, 6, 28), _Cycle(215, 77, 6, 36), _Cycle(215, 107, 6, 46), _Cycle(164, 2, 5, 52),
    _Cycle(164, 77, 5, 32), _Cycle(164, 107, 6, 42), _Cycle(120, 55, 4, 50), _Cycle(146, 30, 6, 38),
)  # fmt: skip
_COMPENSATIONS = (
    _Compensation(215, 55, 6, 34, {"kind": "regular", "amplitude": 1.5, "period": 10.0}),
    _Compensation(160, 55, 6, 48, {"kind": "jonswap", "significant_height": 2.0, "peak_period": 9.0}),
    _Compensation(215, 20, 5, 40, {"kind": "jonswap", "significant_height": 1.2, "peak_period": 7.0}),
    _Compensation(215, 90, 6, 54, {"kind": "jonswap", "significant_height": 2.5, "peak_period": 12.0}),
)


def paper_tests() -> list[Scenario]:
    """The twelve constant-speed tests of paper 2, normal mode, both directions over the pump's range."""
    return [
        scenario_from_content(_cycle_content(f"test_{number:02d}", displacement, load))
        for number, (displacement, load) in PAPER_TESTS.items()
    ]


def _cycle_content(name: str, displacement: float, load: float) -> dict[str, Any]:
    return {
        "name": name,
        "duration": 175.0,
        "mode": "normal",
        "load": load * 1e3,
        "displacement": displacement * CM3_PER_REV,
        "profile": {"pump_shares": PUMP_SHARES, "hold": 6.5, "ramp": 1.5, "rest": 1.5},
    }


def gap_campaign(seed: int = 0) -> list[Scenario]:
    """Twelve runs of 175-240 s at 50 Hz over two months: 8 constant-speed cycles and 4 of heave compensation.

    Loads, oil temperatures, wire lengths and plateaus are drawn around the plan from `seed`; simulate each run with a
    seed of its own.
    """
    generator = np.random.default_rng([seed, 12])
    runs = [_drawn_cycle(k, plan, generator) for k, plan in enumerate(_CYCLES)]
    runs += [_drawn_compensation(k + len(_CYCLES), plan, generator) for k, plan in enumerate(_COMPENSATIONS)]
    return [scenario_from_content(content) for content in runs]


def _drawn_cycle(number: int, plan: _Cycle, generator: np.random.Generator) -> dict[str, Any]:
    content = _cycle_content(f"run_{number + 1:02d}_cycle", plan.displacement, plan.load * _around(generator, 0.05))
    shares = np.array(PUMP_SHARES) * generator.uniform(0.9, 1.05, len(PUMP_SHARES))
    content["profile"] = {**content["profile"], "pump_shares": tuple(np.minimum(shares, 1.0).tolist())}
    return content | _circumstances(number, plan, generator)


def _drawn_compensation(number: int, plan: _Compensation, generator: np.random.Generator) -> dict[str, Any]:
    return {
        "name": f"run_{number + 1:02d}_ahc",
        "duration": 240.0,
        "mode": "ahc",
        "load": plan.load * 1e3 * _around(generator, 0.05),
        "displacement": plan.displacement * CM3_PER_REV,
        "sea": plan.sea,
    } | _circumstances(number, plan, generator)


def _circumstances(number: int, plan: _Cycle | _Compensation, generator: np.random.Generator) -> dict[str, Any]:
    oil = plan.oil + generator.uniform(-2.0, 2.0)
    return {
        "wire_layer": plan.layer,
        "wire_out": float(generator.uniform(40.0, 150.0)),
        "oil_temperature": {"start": oil, "end": oil + generator.uniform(4.0, 10.0), "time_constant": 200.0},
        "start_time": CAMPAIGN_START + 5.0 * DAY * number + generator.uniform(0.0, 0.3) * DAY,
    }


def _around(generator: np.random.Generator, share: float) -> float:
    return float(generator.uniform(1.0 - share, 1.0 + share))


# -- the same plans for another crane
PLANNED_FOR, ITS_PLANT = "crane_150t", "winch_150t"
DRIVES = {"normal": ("main",), "ahc": ("active", "passive")}  # which groups turn the winch


def fitted(scenarios: Sequence[Scenario], crane: Crane, plant: PlantFile) -> list[Scenario]:
    """The scenarios of a set for a hydraulic crane and its plant: the same share of the motors' displacement, of the
    load that they hold on the outer layer (of the rated load, where that is less) and of the pump's speed, as many
    layers from the outer one. A sea that asks more speed of this winch than of that one is as much lower; a higher one
    than planned nobody needs.

    Runs in a mode of which the crane has no motors are left out. Of the crane that the sets are planned for, with its
    plant, they come back as they are. Raises `InputError` for a crane that is not hydraulic, or not the plant's.
    """
    from winch_friction.records.crane_file import load_crane

    refuse_others(crane, plant=plant)
    first = load_crane(PLANNED_FOR)
    own = [each for each in scenarios if set(DRIVES[each.mode]) <= set(crane.groups)]
    if not own:
        there = ", ".join(crane.groups) or "none"
        raise InputError(f"crane '{crane.name}' has motor groups {there}: a run needs main, or active and passive")
    speed = 1.0
    if "active" in crane.groups:
        speed = min(_rope_speed(crane, plant) / _rope_speed(first, load_plant(ITS_PLANT)), 1.0)
    return [_fitted(each, crane, first, speed) for each in own]


def _fitted(scenario: Scenario, crane: Crane, planned: Crane, speed: float) -> Scenario:
    layers = len(planned.drum.layer_radii) - len(crane.drum.layer_radii)
    changes: dict[str, Any] = {
        "displacement": scenario.displacement * (crane.max_displacement / planned.max_displacement),
        "load": scenario.load * _load_share(crane, planned, scenario.mode),
        "wire_layer": max(scenario.wire_layer - layers, 1),
    }
    if isinstance(scenario.sea, Regular):
        changes["sea.amplitude"] = scenario.sea.amplitude * speed
    if isinstance(scenario.sea, Jonswap):
        changes["sea.significant_height"] = scenario.sea.significant_height * speed
    return scenario.override(changes)


def _load_share(crane: Crane, planned: Crane, mode: str) -> float:
    held = _held(crane, mode) / _held(planned, mode)
    return min(held, crane.rated_load / planned.rated_load) if crane.rated_load else held


def _held(crane: Crane, mode: str) -> float:
    """What the motors of a mode hold on the outer layer, per pressure, m^2."""
    return crane.motor_total(DRIVES[mode]) * crane.max_displacement * crane.gear_ratio / crane.drum.layer_radii[-1]


def _rope_speed(crane: Crane, plant: PlantFile) -> float:
    """Speed of the rope on the outer layer with the pump's whole flow in the active motors, m/s."""
    active = crane.motor_count("active") * crane.max_displacement
    return plant.pump.flow / active * crane.drum.layer_radii[-1] / crane.gear_ratio


CAMPAIGNS = {"paper_tests": lambda seed: paper_tests(), "gap_campaign": gap_campaign}
