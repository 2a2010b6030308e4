"""Layers that no drum has and oil that no oil is, asked by the quick check that gap, identify and replay ask first."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from winch_friction.commissioning.check import quick_check
from winch_friction.commissioning.commissioning import check
from winch_friction.commissioning.kinematics import ways
from winch_friction.records.crane_file import load_crane
from winch_friction.records.runs import read_run

RUN = read_run(Path(__file__).parents[2] / "config" / "examples" / "practice_150t" / "test_05.parquet")
CRANE = load_crane("crane_150t")


def said(**columns):
    full = {name: np.broadcast_to(values, len(RUN)).astype(float) for name, values in columns.items()}
    found = quick_check([replace(RUN, columns={**RUN.columns, **full})], CRANE)
    return [(each.severity, each.sentence.removeprefix(f"{RUN.name}: ")) for each in found if each.severity != "note"]


def test_layers_counted_from_zero_are_the_first_thing_to_say():
    layers = np.where(np.arange(len(RUN)) < len(RUN) // 2, 0.0, 5.0)
    (severity, sentence), *_ = said(wire_layer=layers)
    words = (
        "wire_layer is 0 ... 5, the drum has layers 1 ... 6: 1 is the innermost; where the log counts it as 0, add 1"
    )
    assert (severity, sentence) == ("error", words)


@pytest.mark.parametrize(("share", "severity"), [(0.5, "error"), (0.01, "warning")])
def test_a_layer_that_the_drum_has_not_contradicts_it_and_a_counter_not_set_yet_does_not(share, severity):
    layers = np.where(np.arange(len(RUN)) < share * len(RUN), 0.0, 6.0)
    assert (severity, "wire_layer is 0 ... 6, the drum has layers 1 ... 6") in said(wire_layer=layers)


@pytest.mark.parametrize(
    ("oil", "severity", "unit"),
    [(313.0, "error", "kelvin"), (104.0, "warning", "degF"), (60.0, "", ""), (-5.0, "", "")],
)
def test_oil_in_another_unit_is_named(oil, severity, unit):
    words = f"oil of {oil:.3g} ... {oil:.3g} degC: does oil_temperature hold {unit} under [degC]?"
    assert said(oil_temperature=oil) == ([(severity, words)] if unit else [])


def test_check_says_each_of_them_once():
    hot = replace(RUN, columns={**RUN.columns, "oil_temperature": np.full(len(RUN), 104.0)})
    assert sum("degF" in each.sentence for each in check([hot], CRANE).findings) == 1


@pytest.mark.parametrize(
    ("layer", "logged", "told"), [(6, 5, True), (6, 6, False), (3, 2, True), (5, 6, False), (6, 4, False)]
)
def test_layers_counted_from_zero_without_a_zero_are_told_by_the_wire(layer, logged, told):
    """No value is wrong by itself, and 6 % of the load's torque are ordinary to the balance."""
    turned = np.cumsum(RUN["motor_speed"] * np.diff(RUN.time, prepend=RUN.time[0]))
    wire = np.round(60.0 - turned * CRANE.drum.radius(layer) / CRANE.gear_ratio, 2)
    found = [text for severity, text in said(wire_layer=logged, wire_out=wire) if text.startswith("wire_layer")]
    assert bool(found) == told
    if told:
        assert found[0].startswith(f"wire_layer is {logged}, whose radius")
        assert f"moves as on layer {layer}" in found[0]


@pytest.mark.parametrize("spike", [32767.0, -32768.0])
def test_a_broken_cell_of_the_speed_does_not_turn_the_drum(spike):
    """In a lift of 100 s at 100 Hz it was 6 % of the way: the wire "moves as on layer 4" of a log that had 3."""
    wire = 60.0 - np.cumsum(RUN["motor_speed"] * np.diff(RUN.time, prepend=RUN.time[0])) * 0.8 / CRANE.gear_ratio
    broken = RUN["motor_speed"].copy()
    broken[400] = spike
    clean, spiked = ({**RUN.columns, "wire_out": wire, **own} for own in ({}, {"motor_speed": broken}))
    expected = ways(replace(RUN, columns=clean), CRANE)["wire_out"]
    assert ways(replace(RUN, columns=spiked), CRANE)["wire_out"] == pytest.approx(expected, rel=0.01)
