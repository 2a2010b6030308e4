"""A rope climbs at one place of the drum: what the changes of a run's `wire_layer` take from `gap`, and whether they
can be."""

import numpy as np
import pytest

from winch_friction.commissioning.commissioning import _of_changing_layers
from winch_friction.discrepancy.preparation.grid import beside_climbs
from winch_friction.physics.signals import Run, away_from, layer_changes
from winch_friction.records.crane_file import load_crane

CRANE = load_crane("crane_150t")
TIME = np.arange(0.0, 60.0, 0.02)
TURN = 2.0 * np.pi * CRANE.gear_ratio  # rad of the shaft


def sailed(layer, turns: float, wave: float = 10.0) -> Run:
    """A sea in which the drum goes so many turns to and fro; `layer` by time and the drum's turns."""
    angle = 0.5 * turns * TURN * -np.cos(2.0 * np.pi * TIME / wave)
    return Run("sea", {"time": TIME, "motor_speed": np.gradient(angle, TIME), "wire_layer": layer(TIME, angle / TURN)})


climbs = lambda at: lambda _time, turns: 5.0 + (turns > at)
flips = lambda time, _turns: 5.0 + (time // 2.0) % 2


def said(run: Run) -> list[str]:
    return [f"{each.severity}: {each.sentence}" for each in _of_changing_layers(run, CRANE)]


def test_a_counter_that_flips_is_told_from_a_rope_that_climbs():
    """Two runs of twelve told `gap` nothing, and nobody was told of it."""
    (one,) = said(sailed(flips, 0.6))
    assert one.startswith("warning: sea: wire_layer changes 29 times, where the winch can pass such a place 12 times")
    assert "100% of the samples" in one
    (other,) = said(sailed(climbs(0.1), 0.6))
    assert other.startswith("note: sea: wire_layer changes 12 times; 100% of the samples")


def test_a_rope_that_climbs_in_a_long_hoist_is_nothing_to_say():
    assert layer_changes(sailed(climbs(3.0), 12.0), CRANE.gear_ratio, CRANE.speed_scale).near < 0.2
    assert said(sailed(climbs(3.0), 12.0)) == []
    assert said(sailed(lambda time, _turns: 5.0 + 0.0 * time, 12.0)) == []


def test_a_run_that_the_changes_take_whole_is_left_out_and_said():
    whole, part, sound = sailed(flips, 0.6), sailed(climbs(0.0), 2.0), sailed(climbs(3.0), 12.0)
    kept, notes = beside_climbs([whole, part, sound], CRANE)
    assert kept == [part, sound]
    assert [each.endswith("; left out") for each in notes] == [True, False]
    assert notes[1].startswith("sea: wire_layer changes 12 times; ")


@pytest.mark.parametrize("broken", [np.nan, np.inf])
def test_cells_without_a_number_are_no_change(broken):
    run = sailed(climbs(3.0), 2.0)
    run.columns["wire_layer"][100:200] = broken
    run.columns["motor_speed"][50] = np.nan
    assert layer_changes(run, CRANE.gear_ratio, CRANE.speed_scale) == (0, 0.0, 0)


def test_half_a_turn_of_the_drum_is_away():
    angle = TURN * np.array([0.0, 0.49, 0.51, 2.0, 2.51])
    assert away_from(angle, TURN * np.array([2.0, 0.0]), CRANE.gear_ratio).tolist() == [False, False, True, False, True]
    assert away_from(angle, np.empty(0), CRANE.gear_ratio).all()
