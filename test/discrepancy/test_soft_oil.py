"""Free air in the oil, from the flow that its compression takes of a commanded speed."""

from functools import cache

import numpy as np
import pytest

from campaign.gap import owner_files
from campaign.gap_cases import Case
from campaign.rig import DRAWN, make_dataset, world_of
from winch_friction.discrepancy.detectors.flow_balance import EXPLAINS, air_untestable, free_air, holds_on, is_air
from winch_friction.discrepancy.detectors.lost_flow import FreeAir
from winch_friction.discrepancy.preparation.prepare import prepare
from winch_friction.physics.fluid import air_compressed
from winch_friction.physics.signals import Run


@cache
def _data(flavour, seed, *effects):
    crane, model = owner_files(Case("single", effects, flavour, seed))
    runs = [Run(f"run_{k}", columns) for k, columns in enumerate(make_dataset(seed, flavour, effects))]
    return runs, [prepare(run, crane, model) for run in runs]


CRANES = [
    ("quiet", 17), (DRAWN, 8_000_278),
    *(pytest.param(*each, marks=pytest.mark.long) for each in (("slow_log", 18), (DRAWN, 26))),
]  # fmt: skip


@pytest.mark.parametrize(("flavour", "seed"), CRANES)
def test_the_volume_of_the_air_is_found(flavour, seed):
    runs, prepared = _data(flavour, seed, ("entrained_air", 1.0))
    found = free_air(runs, prepared)
    assert is_air(found)
    assert holds_on(found, runs[9:], prepared[9:])
    assert found.volume == pytest.approx(0.01 * world_of(seed, flavour).line_volume, rel=0.3)


@pytest.mark.parametrize(("flavour", "seed", "effect"), [
    *(("quiet", 17, effect) for effect in (None, "pressure_offset")),
    *(pytest.param("quiet", 17, effect, marks=pytest.mark.long) for effect in ("signal_delay", "presliding")),
    *(pytest.param(DRAWN, 8_000_278, effect, marks=pytest.mark.long)
      for effect in (None, "presliding", "signal_delay", "pressure_offset")),
    *(pytest.param(*crane, effect, marks=pytest.mark.long)
      for crane in (("slow_log", 18), (DRAWN, 26))
      for effect in (None, "signal_delay", "pressure_offset", "presliding")),
])  # fmt: skip
def test_nothing_else_is_air(flavour, seed, effect):
    runs, prepared = _data(flavour, seed, *([(effect, 1.0)] if effect else []))
    found = free_air(runs, prepared)
    assert found is None or not is_air(found)
    assert found is None or found.gain < 0.5 * EXPLAINS


def test_without_a_command_or_with_a_motor_that_swivels_nothing_can_be_said():
    runs, prepared = _data("quiet", 17, ("entrained_air", 1.0))
    silent = [Run(run.name, {k: v for k, v in run.columns.items() if k != "speed_reference"}) for run in runs]
    assert free_air(silent, prepared) is None
    swivels = [_with(run, lambda d: d * np.linspace(0.5, 1.0, len(d))) for run in runs]
    assert free_air(swivels, prepared) is None
    assert [each.name for each in air_untestable(None)] == ["entrained_air"]


def test_a_hole_in_the_log_is_not_bridged():
    runs, prepared = _data("quiet", 17, ("entrained_air", 1.0))
    whole = free_air(runs, prepared)
    holed = []
    for run in runs:
        keep = np.ones(len(run.time), bool)
        keep[len(keep) // 2 : len(keep) // 2 + 500] = False
        holed.append(Run(run.name, {name: values[keep] for name, values in run.columns.items()}))
    assert free_air(holed, prepared).volume == pytest.approx(whole.volume, rel=0.1)


def test_a_run_with_holes_in_its_values_spoils_no_other():
    runs, prepared = _data("quiet", 17, ("entrained_air", 1.0))
    columns = dict(runs[9].columns)
    columns["speed_reference"] = np.where(np.arange(len(runs[9])) == 700, np.nan, columns["speed_reference"])
    found = free_air([*runs[:9], Run("gap", columns), *runs[10:]], prepared)
    assert is_air(found)
    assert found.volume == pytest.approx(free_air(runs, prepared).volume, rel=0.1)


@pytest.mark.parametrize(("std", "p_value", "after", "found"), [
    (1e-5, 0.001, 0.09, True), (4e-5, 0.001, 0.09, False), (1e-5, 0.1, 0.09, False), (1e-5, 0.001, 0.099, False),
])  # fmt: skip
def test_air_is_named_where_it_is_sure_and_explains_something(std, p_value, after, found):
    assert is_air(FreeAir(2e-4, std, p_value, 0.1, after)) is found


def test_what_would_not_have_shown_is_said():
    runs, prepared = _data("quiet", 17)
    sure = free_air(runs, prepared)
    assert air_untestable(sure) == []
    unsure = FreeAir(0.0, 1e-3, 1.0, 0.1, 0.1)
    assert "0.006 m^3" in air_untestable(unsure)[0].because


def test_air_gives_way_as_an_adiabatic_gas_in_the_line_of_the_higher_pressure():
    low, bar = 15.0, 1e5

    def left(p):
        return p ** (-1.0 / 1.4)

    def taken(a, b):
        return air_compressed(np.array(a) * bar, np.array(b) * bar)

    assert taken([20.0, 40.0], [low, low])[-1] == pytest.approx(left(20.0) - left(40.0))
    assert taken([low, low], [20.0, 40.0])[-1] == pytest.approx(left(40.0) - left(20.0))
    # from 40 bar in one line to 30 bar in the other: both give way to the same flow, from where the boost held them
    crossed = taken([40.0, 14.0], [low, 30.0])[-1]
    assert crossed == pytest.approx((left(40.0) - left(low)) - (left(low) - left(30.0)))
    assert taken([20.0, 40.0, 20.0], [low] * 3)[-1] == pytest.approx(0.0, abs=1e-12)


def _with(run, change):
    columns = dict(run.columns)
    for name in columns:
        if name.endswith("displacement"):
            columns[name] = change(columns[name])
    return Run(run.name, columns)
